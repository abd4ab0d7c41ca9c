//! Pictures of a picture's error: how large it is at most, and how sure that is.

use super::Stop;
use super::picture::format_of;
use super::render::target;
use crate::film::{self, Compression, Depth, Film, Format, OutputFile, Recipe};
use crate::lang::Evaluated;
use crate::render::certify::{Certificate, Pixel, Status};
use crate::scene::color::decode_srgb;
use std::path::Path;

/// A map and its file.
pub struct Map<'p> {
    path: &'p Path,
    file: OutputFile,
    format: Format,
    kind: Kind,
}

/// What a map shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The error that each pixel keeps.
    Error,
    /// How sure that is.
    Status,
}

/// Colours of 8 bits that colour-blind readers tell apart, too (Okabe, Ito, "Color Universal Design", 2008): bluish green, sky
/// blue, orange, vermilion; in the order of [`Status`].
const COLORS: [[u8; 3]; 4] = [[0, 158, 115], [86, 180, 233], [230, 159, 0], [213, 94, 0]];

impl<'p> Map<'p> {
    /// A map at `path`, whose file is found to be writable.
    ///
    /// # Errors
    /// It can't be written, or would overwrite what the scene reads, or has a form in which it says nothing.
    pub fn new(path: &'p Path, kind: Kind, evaluated: &Evaluated) -> Result<Map<'p>, Stop> {
        let format = format_of(path, (Depth::Eight, Compression::Fast))?;
        Ok(Map { path, file: target(path, evaluated)?, format, kind })
    }

    /// Writes it; `width` is the picture's.
    ///
    /// # Errors
    /// The file can't be written.
    pub fn write(self, certificate: &Certificate, width: u32, recipe: &Recipe) -> Result<(), Stop> {
        let pixel = |i| certificate.pixels.get(i).copied().unwrap_or(Pixel::unknown());
        let color = |i| self.color(&pixel(i), certificate.reached);
        let pixels: Vec<[f32; 3]> = (0..certificate.summary.pixels()).map(color).collect();
        let film = Film { width, height: pixels.len() as u32 / width.max(1), pixels };
        self.file
            .write(|out| film::encode(&film, self.format, recipe, out))
            .map_err(|e| Stop::system(format!("`{}` can't be written", self.path.display()), e))
    }

    /// The linear colour of a pixel, where `codes` is the error that was to be kept.
    fn color(&self, pixel: &Pixel, codes: f64) -> [f32; 3] {
        let shown = |color: [u8; 3]| color.map(|c| decode_srgb(c as f64 / 255.0) as f32);
        match (self.kind, self.format) {
            (Kind::Status, _) if !pixel.keeps(codes) => shown(COLORS[Status::Open as usize]),
            (Kind::Status, _) => shown(COLORS[pixel.status as usize]),
            // Numbers for programs.
            (Kind::Error, Format::Exr | Format::Hdr) => [(pixel.codes / 255.0) as f32; 3],
            (Kind::Error, Format::Png(..)) if !pixel.keeps(codes) => shown([255, 0, 0]),
            // At most 255: the pixel keeps what was asked for.
            (Kind::Error, Format::Png(..)) => shown([(255.0 * pixel.codes / codes).round() as u8; 3]),
        }
    }
}
