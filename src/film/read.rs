//! Picture files to codes of 8 bits: PNG and JPEG, known by their content. The way back from [`png`](super::png), and how
//! scenes read pictures.

use std::io::Cursor;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// A picture as a file holds it, brought to three channels of 8 bits.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Texels across; at least 1.
    pub width: u32,
    /// Texels down; at least 1.
    pub height: u32,
    /// `width × height` texels, row by row; row 0 is the top.
    pub texels: Vec<[u8; 3]>,
}

/// Why a file gives no picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReadError {
    /// It is of another kind, or no picture.
    Unknown,
    /// It isn't complete, or doesn't keep the rules of its kind, which is named.
    Damaged(&'static str),
    /// It has more texels than it may have: its width and height.
    TooLarge(u32, u32),
}

/// The picture that `bytes` are, if `may_be` allows its width and height.
///
/// # Errors
/// It is none, or may not be.
pub fn read(bytes: &[u8], may_be: impl Fn(u32, u32) -> bool) -> Result<Picture, ReadError> {
    let allowed = |width, height, kind| match (width, height) {
        (0, _) | (_, 0) => Err(ReadError::Damaged(kind)),
        (w, h) if may_be(w, h) => Ok(()),
        (w, h) => Err(ReadError::TooLarge(w, h)),
    };
    if bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
        read_png(bytes, |w, h| allowed(w, h, "PNG"))
    } else if bytes.starts_with(b"\xFF\xD8\xFF") {
        read_jpeg(bytes, |w, h| allowed(w, h, "JPEG"))
    } else {
        Err(ReadError::Unknown)
    }
}

fn read_png(bytes: &[u8], allowed: impl Fn(u32, u32) -> Result<(), ReadError>) -> Result<Picture, ReadError> {
    let damaged = |_| ReadError::Damaged("PNG");
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::EXPAND);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let mut reader = decoder.read_info().map_err(damaged)?;
    let (width, height) = reader.info().size();
    allowed(width, height)?;
    let form = reader.output_color_type();
    if form == (png::ColorType::Rgb, png::BitDepth::Eight) {
        // Where they stay: copying a large picture takes a good part of the time of decoding it.
        let mut texels = vec![[0; 3]; width as usize * height as usize];
        reader.next_frame(texels.as_flattened_mut()).map_err(damaged)?;
        return Ok(Picture { width, height, texels });
    }
    let mut data = vec![0; reader.output_buffer_size().ok_or(ReadError::Damaged("PNG"))?];
    reader.next_frame(&mut data).map_err(damaged)?;
    let (samples, wide) = (form.0.samples(), form.1 == png::BitDepth::Sixteen);
    let texel = |texel: &[u8]| {
        let at = |i: usize| match wide {
            false => texel[i],
            // The nearest of 256 steps.
            true => ((u16::from_be_bytes([texel[2 * i], texel[2 * i + 1]]) as u32 + 128) / 257) as u8,
        };
        if samples < 3 { [at(0); 3] } else { [at(0), at(1), at(2)] }
    };
    let texels = data.chunks_exact(samples << u32::from(wide)).map(texel).collect();
    Ok(Picture { width, height, texels })
}

fn read_jpeg(bytes: &[u8], allowed: impl Fn(u32, u32) -> Result<(), ReadError>) -> Result<Picture, ReadError> {
    const DAMAGED: ReadError = ReadError::Damaged("JPEG");
    // As lenient as browsers are.
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
    let texels: Vec<[u8; 3]> = match is_gray {
        true => data.into_iter().map(|v| [v; 3]).collect(),
        false => data.as_chunks().0.into(),
    };
    match texels.len() == width * height {
        true => Ok(Picture { width: width as u32, height: height as u32, texels }),
        false => Err(DAMAGED),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{DynamicImage, ImageFormat};

    /// What the `image` crate, which goes through the same decoders, makes of a file.
    fn theirs(file: &[u8]) -> Picture {
        let rgb = image::load_from_memory(file).unwrap().into_rgb8();
        Picture { width: rgb.width(), height: rgb.height(), texels: rgb.pixels().map(|p| p.0).collect() }
    }

    fn any(_: u32, _: u32) -> bool {
        true
    }

    /// Every channel's every step, in some order.
    fn colorful() -> DynamicImage {
        let at = |x: u32, y: u32| (x * 7919 + y * 104_729) as u16;
        image::ImageBuffer::from_fn(97, 41, |x, y| image::Rgba([at(x, y), at(y, x), at(x + 5, y), at(x, y + 9)])).into()
    }

    #[test]
    fn every_form_of_png() {
        let full = colorful();
        let forms = [
            full.to_luma8().into(),
            full.to_luma16().into(),
            full.to_luma_alpha8().into(),
            full.to_luma_alpha16().into(),
            full.to_rgb8().into(),
            full.to_rgb16().into(),
            full.to_rgba8().into(),
            full.clone(),
        ];
        for form in forms {
            let form: DynamicImage = form;
            let mut file = Cursor::new(Vec::new());
            form.write_to(&mut file, ImageFormat::Png).unwrap();
            let file = file.into_inner();
            assert_eq!(read(&file, any), Ok(theirs(&file)), "{:?}", form.color());
            assert_eq!(read(&file[..file.len() / 2], any), Err(ReadError::Damaged("PNG")));
        }
    }

    #[test]
    fn few_bits_and_palettes() {
        use png::{BitDepth::*, ColorType::*};
        for (color, depth) in [(Grayscale, One), (Grayscale, Two), (Grayscale, Four), (Indexed, One), (Indexed, Eight)]
        {
            let mut file = Vec::new();
            let mut encoder = png::Encoder::new(&mut file, 16, 2);
            encoder.set_color(color);
            encoder.set_depth(depth);
            if color == Indexed {
                encoder.set_palette((0..=255).flat_map(|i| [i, 255 - i, i / 2]).collect::<Vec<u8>>());
                encoder.set_trns(vec![0, 128]);
            }
            let data: Vec<u8> = (0..4 * depth as u8).map(|i| i.wrapping_mul(37)).collect();
            encoder.write_header().unwrap().write_image_data(&data).unwrap();
            assert_eq!(read(&file, any), Ok(theirs(&file)), "{color:?} {depth:?}");
        }
    }

    #[test]
    fn jpegs_with_and_without_color() {
        for form in [colorful().to_rgb8().into(), DynamicImage::from(colorful().to_luma8())] {
            let mut file = Cursor::new(Vec::new());
            form.write_to(&mut file, ImageFormat::Jpeg).unwrap();
            let file = file.into_inner();
            assert_eq!(read(&file, any), Ok(theirs(&file)), "{:?}", form.color());
            assert_eq!(read(&file[..20], any), Err(ReadError::Damaged("JPEG")));
        }
    }

    #[test]
    fn what_is_no_picture_or_too_large() {
        assert_eq!(read(b"GIF89a", any), Err(ReadError::Unknown));
        assert_eq!(read(b"\x89PNG\r\n\x1a\n", any), Err(ReadError::Damaged("PNG")));
        let mut file = Cursor::new(Vec::new());
        colorful().to_rgb8().write_to(&mut file, ImageFormat::Png).unwrap();
        assert_eq!(read(file.get_ref(), |w, h| w * h < 100), Err(ReadError::TooLarge(97, 41)));
    }
}
