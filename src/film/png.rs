//! PNG files, written row by row as the picture comes. The `png` crate writes what is around the pixels.

use super::{Depth, Recipe};
use flate2::write::ZlibEncoder;
use std::io::{self, Write};

/// How much a PNG is compressed; the picture in it is the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compression {
    /// In less time than reading the scene takes.
    Fast,
    /// About a third smaller, in many times the time.
    Small,
}

/// A PNG file on its way.
pub struct PngWriter<W: Write> {
    deflate: Deflate<W>,
    /// Bytes a pixel.
    pixel: usize,
    /// The last row, and black before there is one.
    above: Vec<u8>,
    /// A row as it is compressed: the number of its filter first.
    filtered: Vec<u8>,
    /// Rows still to come.
    missing: u32,
}

enum Deflate<W: Write> {
    Fast(fdeflate::Compressor<Chunks<W>>),
    Small(ZlibEncoder<Chunks<W>>),
}

/// The compressed bytes, cut into chunks of the file.
struct Chunks<W: Write> {
    writer: png::Writer<W>,
    bytes: Vec<u8>,
}

/// Compressed bytes a chunk: a picture for a screen is one chunk.
const CHUNK: usize = 1 << 20;

/// The filter's number in the file. Of the filters it makes the smallest files, choosing one for each row included.
const PAETH: u8 = 4;

impl<W: Write> PngWriter<W> {
    /// Writes what comes before the pixels.
    ///
    /// # Errors
    /// Those of `out`, and a size of 0, which no PNG can hold.
    pub fn new(
        out: W,
        (width, height): (u32, u32),
        (depth, compression): (Depth, Compression),
        recipe: &Recipe,
    ) -> io::Result<PngWriter<W>> {
        let mut encoder = png::Encoder::new(out, width, height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(match depth {
            Depth::Eight => png::BitDepth::Eight,
            Depth::Sixteen => png::BitDepth::Sixteen,
        });
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        for (name, value) in recipe.entries() {
            // tEXt is Latin-1 and read by more programs; iTXt is UTF-8.
            let (name, value) = (name.to_string(), value.to_string());
            if value.is_ascii() { encoder.add_text_chunk(name, value) } else { encoder.add_itxt_chunk(name, value) }?;
        }
        let chunks = Chunks { writer: encoder.write_header()?, bytes: Vec::new() };
        let deflate = match compression {
            Compression::Fast => Deflate::Fast(fdeflate::Compressor::new(chunks)?),
            Compression::Small => Deflate::Small(ZlibEncoder::new(chunks, flate2::Compression::default())),
        };
        let pixel = 3 * depth.bytes();
        let row = width as usize * pixel;
        Ok(PngWriter { deflate, pixel, above: vec![0; row], filtered: vec![PAETH; 1 + row], missing: height })
    }

    /// Writes rows of pixels, as [`Developer::develop`](super::Developer::develop) gives them.
    ///
    /// # Errors
    /// Those of what is written to.
    pub fn rows(&mut self, rows: &[u8]) -> io::Result<()> {
        let length = self.above.len();
        let mut above = &self.above[..];
        for row in rows.chunks_exact(length) {
            paeth(self.pixel, above, row, &mut self.filtered[1..]);
            match &mut self.deflate {
                Deflate::Fast(deflate) => deflate.write_data(&self.filtered)?,
                Deflate::Small(deflate) => deflate.write_all(&self.filtered)?,
            }
            self.missing = self.missing.saturating_sub(1);
            above = row;
        }
        if let Some(last) = rows.chunks_exact(length).next_back() {
            self.above.copy_from_slice(last);
        }
        Ok(())
    }

    /// Ends the file.
    ///
    /// # Errors
    /// Those of what is written to, and fewer rows than the picture has.
    pub fn finish(self) -> io::Result<()> {
        if self.missing > 0 {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        let mut chunks = match self.deflate {
            Deflate::Fast(deflate) => deflate.finish()?,
            Deflate::Small(deflate) => deflate.finish()?,
        };
        chunks.flush()?;
        Ok(chunks.writer.finish()?)
    }
}

impl<W: Write> Write for Chunks<W> {
    #[inline]
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.bytes.extend_from_slice(bytes);
        if self.bytes.len() >= CHUNK {
            self.flush()?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        if !self.bytes.is_empty() {
            self.writer.write_chunk(png::chunk::IDAT, &self.bytes)?;
            self.bytes.clear();
        }
        Ok(())
    }
}

/// What each byte of `row` is off from the one of left (a), above (b) and left above (c) that is nearest to a + b - c
/// (Paeth, *Image File Compression Made Easy*, Graphics Gems II, 1991), in 8 bits throughout (Versari, *FPNGE*, 2021).
fn paeth(pixel: usize, above: &[u8], row: &[u8], out: &mut [u8]) {
    let first = pixel.min(row.len());
    for ((out, x), b) in out.iter_mut().zip(row).zip(above).take(first) {
        *out = x.wrapping_sub(*b);
    }
    let rest = out[first..].iter_mut().zip(&row[first..]).zip(row).zip(&above[first..]).zip(above);
    for ((((out, x), &a), &b), &c) in rest {
        // |b - c| and |a - c| are how far a and b are. How far c is, |a + b - 2c|, counts only where c is between a and b;
        // then it is their difference.
        let (far_a, far_b) = (b.max(c) - b.min(c), a.max(c) - a.min(c));
        let far_c = if (a < c) == (c < b) { far_a.max(far_b) - far_a.min(far_b) } else { u8::MAX };
        let nearest = if far_a <= far_b && far_a <= far_c {
            a
        } else if far_b <= far_c {
            b
        } else {
            c
        };
        *out = x.wrapping_sub(nearest);
    }
}
