//! Picture files to codes of 8 bits: PNG, JPEG and binary PPM and PGM, known by their content. The way back from
//! [`png`](super::png), and how scenes read pictures.

mod jpeg;
mod png;
mod pnm;

use crate::scene::Texels;

/// A picture as a file holds it, brought to three channels of 8 bits.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Texels across; at least 1.
    pub width: u32,
    /// Texels down; at least 1.
    pub height: u32,
    /// `width × height` texels, row by row; row 0 is the top.
    pub texels: Texels,
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

/// The picture that `bytes` are, if `may_be` allows its width and height. They are the reader's to keep: a file may hold its
/// texels as they are needed.
///
/// # Errors
/// It is none, or may not be.
pub fn read(bytes: Vec<u8>, may_be: impl Fn(u32, u32) -> bool) -> Result<Picture, ReadError> {
    let allowed = |width, height, kind| match (width, height) {
        (0, _) | (_, 0) => Err(ReadError::Damaged(kind)),
        (w, h) if may_be(w, h) => Ok(()),
        (w, h) => Err(ReadError::TooLarge(w, h)),
    };
    if bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
        png::read(&bytes, |w, h| allowed(w, h, "PNG"))
    } else if bytes.starts_with(b"\xFF\xD8\xFF") {
        jpeg::read(&bytes, |w, h| allowed(w, h, "JPEG"))
    } else if bytes.starts_with(b"P6") {
        pnm::read(bytes, pnm::Kind::PPM, |w, h| allowed(w, h, "PPM"))
    } else if bytes.starts_with(b"P5") {
        pnm::read(bytes, pnm::Kind::PGM, |w, h| allowed(w, h, "PGM"))
    } else {
        Err(ReadError::Unknown)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::image::{DynamicImage, ImageFormat};
    use std::io::Cursor;

    /// What the `image` crate, which goes through the same decoders, makes of a file.
    fn theirs(file: &[u8]) -> Picture {
        let rgb = ::image::load_from_memory(file).unwrap().into_rgb8();
        Picture { width: rgb.width(), height: rgb.height(), texels: Texels::Colors(rgb.into_raw()) }
    }

    fn any(_: u32, _: u32) -> bool {
        true
    }

    /// Every channel's every step, in some order.
    fn colorful() -> DynamicImage {
        let at = |x: u32, y: u32| (x * 7919 + y * 104_729) as u16;
        ::image::ImageBuffer::from_fn(97, 41, |x, y| ::image::Rgba([at(x, y), at(y, x), at(x + 5, y), at(x, y + 9)]))
            .into()
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
            assert_eq!(read(file.clone(), any), Ok(theirs(&file)), "{:?}", form.color());
            assert_eq!(read(file[..file.len() / 2].to_vec(), any), Err(ReadError::Damaged("PNG")));
        }
    }

    #[test]
    fn few_bits_and_palettes() {
        use ::png::{BitDepth::*, ColorType::*};
        for (color, depth) in [(Grayscale, One), (Grayscale, Two), (Grayscale, Four), (Indexed, One), (Indexed, Eight)]
        {
            let mut file = Vec::new();
            let mut encoder = ::png::Encoder::new(&mut file, 16, 2);
            encoder.set_color(color);
            encoder.set_depth(depth);
            if color == Indexed {
                encoder.set_palette((0..=255).flat_map(|i| [i, 255 - i, i / 2]).collect::<Vec<u8>>());
                encoder.set_trns(vec![0, 128]);
            }
            let data: Vec<u8> = (0..4 * depth as u8).map(|i| i.wrapping_mul(37)).collect();
            encoder.write_header().unwrap().write_image_data(&data).unwrap();
            assert_eq!(read(file.clone(), any), Ok(theirs(&file)), "{color:?} {depth:?}");
        }
    }

    #[test]
    fn every_filter_of_one_byte() {
        use ::png::Filter;
        let gray = colorful().to_luma8();
        for filter in [Filter::NoFilter, Filter::Sub, Filter::Up, Filter::Avg, Filter::Paeth, Filter::Adaptive] {
            let mut file = Vec::new();
            let mut encoder = ::png::Encoder::new(&mut file, gray.width(), gray.height());
            encoder.set_filter(filter);
            encoder.write_header().unwrap().write_image_data(&gray).unwrap();
            assert_eq!(read(file.clone(), any), Ok(theirs(&file)), "{filter:?}");
            let damaged = [&file[..60], &[file[60] ^ 1], &file[61..]].concat();
            assert_eq!(read(damaged, any), Err(ReadError::Damaged("PNG")));
        }
    }

    #[test]
    fn jpegs_with_and_without_color() {
        for form in [colorful().to_rgb8().into(), DynamicImage::from(colorful().to_luma8())] {
            let mut file = Cursor::new(Vec::new());
            form.write_to(&mut file, ImageFormat::Jpeg).unwrap();
            let file = file.into_inner();
            assert_eq!(read(file.clone(), any), Ok(theirs(&file)), "{:?}", form.color());
            assert_eq!(read(file[..20].to_vec(), any), Err(ReadError::Damaged("JPEG")));
        }
    }

    #[test]
    fn what_is_no_picture_or_too_large() {
        assert_eq!(read(b"GIF89a".to_vec(), any), Err(ReadError::Unknown));
        assert_eq!(read(b"\x89PNG\r\n\x1a\n".to_vec(), any), Err(ReadError::Damaged("PNG")));
        let mut file = Cursor::new(Vec::new());
        colorful().to_rgb8().write_to(&mut file, ImageFormat::Png).unwrap();
        assert_eq!(read(file.into_inner(), |w, h| w * h < 100), Err(ReadError::TooLarge(97, 41)));
    }
}
