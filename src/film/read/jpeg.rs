//! JPEG files, as leniently as browsers read them.

use super::{Picture, ReadError};
use crate::scene::Texels;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

const DAMAGED: ReadError = ReadError::Damaged("JPEG");

/// The picture, if its size is `allowed`.
///
/// # Errors
/// That of `allowed`, and a file that isn't whole.
pub fn read(bytes: &[u8], allowed: impl Fn(u32, u32) -> Result<(), ReadError>) -> Result<Picture, ReadError> {
    let options = DecoderOptions::default().set_strict_mode(false);
    let options = options.set_max_width(u16::MAX as usize).set_max_height(u16::MAX as usize);
    let mut decoder = zune_jpeg::JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|_| DAMAGED)?;
    let (width, height) = decoder.dimensions().ok_or(DAMAGED)?;
    allowed(width as u32, height as u32)?;
    let is_gray = decoder.input_colorspace() == Some(ColorSpace::Luma);
    let color = if is_gray { ColorSpace::Luma } else { ColorSpace::RGB };
    decoder.set_options(options.jpeg_set_out_colorspace(color));
    let data = decoder.decode().map_err(|_| DAMAGED)?;
    let texels = if is_gray { Texels::gray(data) } else { Texels::Colors(data) };
    match texels.count() == width * height {
        true => Ok(Picture { width: width as u32, height: height as u32, texels }),
        false => Err(DAMAGED),
    }
}
