//! Makes the picture of one world: as a file already where that can be done row by row, as a film otherwise.

use super::progress::Bar;
use crate::film::buffer::{from_bytes, to_bytes};
use crate::film::{self, Compression, Depth, Developer, Digest, Film, Format, PngWriter, Recipe};
use crate::render::certify::Certificate;
use crate::render::{self, Options, RayCounts, Rendered, World};
use std::io::{self, Seek, Write};
use std::sync::atomic::AtomicBool;
use tempfile::{SpooledData, SpooledTempFile};

/// What is to be made.
pub struct Make<'m> {
    /// Of this world.
    pub world: &'m World,
    /// Traced so.
    pub options: &'m Options,
    /// Told of the progress.
    pub bar: &'m Bar,
    /// Written into the file.
    pub recipe: &'m Recipe,
    /// Whether the picture's hash is wanted.
    pub is_hashed: bool,
}

/// A picture.
pub struct Made {
    /// Rays by kind.
    pub rays: RayCounts,
    /// Threads that traced.
    pub threads: usize,
    /// [`Film::hash`], where it was wanted.
    pub hash: Option<String>,
    /// The picture itself.
    pub pixels: Pixels,
    /// What can be said of its error, where that was asked for.
    pub certificate: Option<Box<Certificate>>,
}

/// The pixels of a picture.
pub enum Pixels {
    /// In linear light.
    Film(Film),
    /// A file already, but nowhere that anyone could see it. A large one lies on a disk, without a name.
    File(SpooledTempFile),
}

/// Bytes of a file that are kept in memory before they go to the disk.
const IN_MEMORY: usize = 8 << 20;

impl Make<'_> {
    /// Makes the picture for a file of `format`; `None` where it wasn't finished.
    ///
    /// # Errors
    /// A file can't be made of it.
    pub fn picture(&self, format: Format) -> io::Result<Option<Made>> {
        if let Format::Png(depth, compression) = format
            && self.options.is_by_tiles()
        {
            return self.png(depth, compression);
        }
        let rendered = render::render(self.world, self.options, self.bar, &AtomicBool::new(false));
        Ok(rendered.map(|Rendered { film, rays, threads, certificate }| {
            let hash = self.is_hashed.then(|| film.hash());
            Made { rays, threads, hash, pixels: Pixels::Film(film), certificate }
        }))
    }

    fn png(&self, depth: Depth, compression: Compression) -> io::Result<Option<Made>> {
        let part = self.options.crop_or_all();
        let developer = Developer::of(depth);
        let mut file = SpooledTempFile::new(IN_MEMORY);
        let mut writer = PngWriter::new(&mut file, (part.width, part.height), (depth, compression), self.recipe)?;
        let mut digest = self.is_hashed.then(|| Digest::new(part.width, part.height));
        let cancel = AtomicBool::new(false);
        let stream = |pixel, take: &mut (dyn FnMut(&[u8]) -> io::Result<()> + Send)| {
            render::stream(self.world, self.options, (self.bar, &cancel), pixel, take)
        };
        let streamed = match &mut digest {
            None => {
                let codes = |pixels: &[[f32; 3]], out: &mut Vec<u8>| developer.develop(pixels, out);
                stream((3 * depth.bytes(), &codes), &mut |rows| writer.rows(rows))
            }
            // The hash is of the pixels before they are developed, in their order.
            Some(digest) => {
                let (mut pixels, mut codes) = (Vec::new(), Vec::new());
                stream((12, &to_bytes), &mut |rows| {
                    digest.add(rows);
                    pixels.clear();
                    from_bytes(rows, &mut pixels);
                    codes.clear();
                    developer.develop(&pixels, &mut codes);
                    writer.rows(&codes)
                })
            }
        }?;
        let Some(streamed) = streamed else { return Ok(None) };
        writer.finish()?;
        let hash = digest.map(Digest::end);
        Ok(Some(Made {
            rays: streamed.rays,
            threads: streamed.threads,
            hash,
            pixels: Pixels::File(file),
            certificate: None,
        }))
    }
}

impl Pixels {
    /// Writes the file: the same `format` and `recipe` that it was made for.
    ///
    /// # Errors
    /// Those of `out`, and of the disk where a large file lies.
    pub fn write(self, format: Format, recipe: &Recipe, out: &mut (impl Write + Seek)) -> io::Result<()> {
        match self {
            Pixels::Film(film) => film::encode(&film, format, recipe, out),
            Pixels::File(file) => match file.into_inner() {
                SpooledData::InMemory(file) => out.write_all(file.get_ref()),
                SpooledData::OnDisk(mut file) => {
                    file.rewind()?;
                    io::copy(&mut file, out).map(|_| ())
                }
            },
        }
    }
}
