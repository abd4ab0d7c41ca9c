//! Decodes picture files: PNG and JPEG, known by their content.

use super::limits::Limits;
use super::load::reason;
use crate::scene::{Image, range};
use image::{ImageFormat, ImageReader};
use std::io::Cursor;
use std::path::Path;

/// Largest picture file: more than an uncompressed one of the most texels.
pub const FILE_BYTES: usize = 1 << 30;

/// The picture that `bytes` are, read at `path`; why they are none, in words, otherwise.
pub fn decode(path: &Path, bytes: &[u8], digest: [u8; 32], limits: &Limits) -> Result<Image, String> {
    let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| reason(&e))?;
    let Some(format @ (ImageFormat::Png | ImageFormat::Jpeg)) = reader.format() else {
        return Err("it is neither a PNG nor a JPEG file".into());
    };
    let damaged =
        || format!("it is damaged: not a complete {} file", if format == ImageFormat::Png { "PNG" } else { "JPEG" });
    let (width, height) = reader.into_dimensions().map_err(|_| damaged())?;
    if width == 0 || height == 0 {
        return Err(damaged());
    }
    if width.max(height) > range::LARGEST_SIDE || u64::from(width) * u64::from(height) > limits.image_texels {
        return Err(format!("it is too large: {width} × {height}"));
    }
    let decoded = ImageReader::with_format(Cursor::new(bytes), format).decode().map_err(|_| damaged())?;
    let rgb = decoded.into_rgb8();
    let texels = rgb.pixels().map(|p| p.0).collect();
    Ok(Image { path: path.to_owned(), digest, width, height, texels })
}
