//! The picture formats: PNG for screens, OpenEXR and Radiance for linear light. Each carries the picture's recipe as text.

use super::{Compression, Depth, Developer, Film, PngWriter, Recipe};
use std::borrow::Cow;
use std::io::{self, Seek, Write};
use std::path::Path;

/// A picture format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// sRGB codes of 8 or 16 bits; everything outside 0..=1 is cut off.
    Png(Depth, Compression),
    /// OpenEXR: the linear 32-bit values themselves.
    Exr,
    /// Radiance RGBE: linear, 8 bits of mantissa with an exponent a pixel; negative channels become 0.
    Hdr,
}

impl Format {
    /// PNG as most programs read it best.
    pub const PNG: Format = Format::Png(Depth::Eight, Compression::Fast);

    /// The format that a file's ending asks for, in either case; `None` for another ending. `png` is the one for PNG.
    pub fn from_path(path: &Path, png: Format) -> Option<Format> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        match ending.as_str() {
            "png" => Some(png),
            "exr" => Some(Format::Exr),
            "hdr" => Some(Format::Hdr),
            _ => None,
        }
    }
}

/// Writes `film` to `out` in `format`, with `recipe` inside.
///
/// # Errors
/// Those of `out`, and a size of 0, which no format can hold.
pub fn encode(film: &Film, format: Format, recipe: &Recipe, out: &mut (impl Write + Seek)) -> io::Result<()> {
    match format {
        Format::Png(depth, compression) => encode_png(film, (depth, compression), recipe, out),
        Format::Exr => encode_exr(film, recipe, out),
        Format::Hdr => encode_hdr(film, recipe, out),
    }
}

fn encode_png(film: &Film, look: (Depth, Compression), recipe: &Recipe, out: &mut impl Write) -> io::Result<()> {
    let mut writer = PngWriter::new(out, (film.width, film.height), look, recipe)?;
    let developer = Developer::of(look.0);
    let mut bytes = Vec::new();
    for row in film.pixels.chunks(film.width.max(1) as usize) {
        bytes.clear();
        developer.develop(row, &mut bytes);
        writer.rows(&bytes)?;
    }
    writer.finish()
}

fn encode_exr(film: &Film, recipe: &Recipe, out: &mut (impl Write + Seek)) -> io::Result<()> {
    use exr::prelude::{Encoding, Image, Layer, LayerAttributes, SpecificChannels, Text, Vec2, WritableImage};
    if film.width == 0 || film.height == 0 {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "the picture has no pixels"));
    }
    let width = film.width as usize;
    let pixel = |at: Vec2<usize>| {
        let [r, g, b] = film.pixels[at.y() * width + at.x()];
        (r, g, b)
    };
    // The standard attribute `comments` holds the recipe: attributes of one's own are written in no fixed order, and
    // equal pictures must make equal files.
    let attributes = LayerAttributes {
        software_name: Text::new_or_none(concat!("rtdsl ", env!("CARGO_PKG_VERSION"))),
        comments: Text::new_or_none(latin(&recipe.lines())),
        ..LayerAttributes::default()
    };
    let size = (width, film.height as usize);
    let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, SpecificChannels::rgb(pixel));
    Image::from_layer(layer).write().to_buffered(out).map_err(|e| match e {
        exr::error::Error::Io(e) => e,
        e => io::Error::other(e),
    })
}

/// OpenEXR's texts are of single bytes; other characters are written as the language writes them in a text.
fn latin(text: &str) -> Cow<'_, str> {
    if text.is_ascii() {
        return text.into();
    }
    text.chars().map(|c| if c.is_ascii() { c.to_string() } else { c.escape_unicode().to_string() }).collect()
}

/// Flat scan lines: a pixel's largest mantissa is at least 128, so none can be taken for a mark of run lengths, which
/// starts with two small bytes (Ward, *Real Pixels*, Graphics Gems II, 1991).
fn encode_hdr(film: &Film, recipe: &Recipe, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "#?RADIANCE")?;
    for line in recipe.lines().lines() {
        writeln!(out, "# {line}")?;
    }
    write!(out, "FORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", film.height, film.width)?;
    for row in film.pixels.chunks(film.width.max(1) as usize) {
        let bytes: Vec<u8> = row.iter().flat_map(|&pixel| rgbe(pixel)).collect();
        out.write_all(&bytes)?;
    }
    Ok(())
}

/// The nearest value of shared exponent: relative to the largest channel, off by 1/256 at most.
fn rgbe(pixel: [f32; 3]) -> [u8; 4] {
    let pixel = pixel.map(|v| match v {
        _ if v >= LARGEST_RGBE => LARGEST_RGBE,
        _ if v > 0.0 => v,
        _ => 0.0,
    });
    let largest = pixel.into_iter().fold(0.0, |m: f32, v| if v > m { v } else { m });
    if largest < 1e-38 {
        return [0; 4]; // below the smallest exponent
    }
    // 2^(exponent - 1) ≤ largest < 2^exponent
    let mut exponent = (largest.to_bits() >> 23) as i32 - 126;
    let mantissa = |v: f32, exponent: i32| (v as f64 * two_to(8 - exponent) + 0.5) as u32;
    if mantissa(largest, exponent) == 256 {
        exponent += 1;
    }
    let [r, g, b] = pixel.map(|v| mantissa(v, exponent) as u8);
    [r, g, b, (exponent + 128) as u8]
}

/// The largest value that a pixel of shared exponent can hold: 255 × 2^119.
const LARGEST_RGBE: f32 = 255.0 * (1u128 << 119) as f32;

/// 2^n, exactly, for the exponents of an `f32`.
fn two_to(n: i32) -> f64 {
    f64::from_bits(((n + 1023) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    /// Bright, dark, negative, and more than white.
    fn picture() -> Film {
        let mut film = Film::new(37, 11);
        for (i, pixel) in film.pixels.iter_mut().enumerate() {
            let v = i as f32 / 300.0;
            *pixel = [v, 0.5 * v * v, if i % 7 == 0 { -0.25 } else { 1.0 - 0.5 * v }];
        }
        film
    }

    fn bytes(film: &Film, format: Format) -> Vec<u8> {
        let mut out = Cursor::new(Vec::new());
        let recipe = Recipe::new().with("rtdsl:scene", "abc").with("rtdsl:parameters", "name=\"Zoë\"");
        encode(film, format, &recipe, &mut out).unwrap();
        out.into_inner()
    }

    #[test]
    fn png_comes_back() {
        let film = picture();
        let looks = [Depth::Eight, Depth::Sixteen].map(|d| [Compression::Fast, Compression::Small].map(|c| (d, c)));
        for (depth, compression) in looks.into_iter().flatten() {
            let file = bytes(&film, Format::Png(depth, compression));
            let mut reader = png::Decoder::new(Cursor::new(&file)).read_info().unwrap();
            let mut data = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut data).unwrap();
            let info = reader.info();
            assert_eq!(info.srgb, Some(png::SrgbRenderingIntent::Perceptual));
            assert_eq!(info.uncompressed_latin1_text[1].text, "abc");
            assert_eq!(info.utf8_text[0].get_text().unwrap(), "name=\"Zoë\"");
            let table = Developer::of(depth);
            let codes = film.pixels.as_flattened().iter().map(|&v| table.code(v));
            match depth {
                Depth::Eight => assert!(codes.eq(data.iter().map(|&b| b as u16))),
                Depth::Sixteen => assert!(codes.eq(data.chunks(2).map(|b| u16::from_be_bytes([b[0], b[1]])))),
            }
        }
    }

    #[test]
    fn exr_holds_the_very_values() {
        let film = picture();
        let file = bytes(&film, Format::Exr);
        assert_eq!(file, bytes(&film, Format::Exr), "the same bytes each time");
        let back = image::load_from_memory_with_format(&file, image::ImageFormat::OpenExr).unwrap();
        assert_eq!(back.to_rgb32f().as_raw(), film.pixels.as_flattened());
        assert!(file.windows(16).any(|w| w == b"rtdsl:scene: abc"));
    }

    #[test]
    fn hdr_is_within_its_error() {
        let mut film = picture();
        film.pixels[3] = [1f32.next_down(), 0.3, 0.0]; // its mantissa rounds up to the next exponent
        film.pixels[4] = [1e-30, 1e30, 0.0];
        film.pixels[5] = [f32::MAX, LARGEST_RGBE, f32::INFINITY];
        film.pixels[6] = [1e-42, 0.0, 0.0];
        let file = bytes(&film, Format::Hdr);
        let back = image::load_from_memory_with_format(&file, image::ImageFormat::Hdr).unwrap().to_rgb32f();
        for (pixel, back) in film.pixels.iter().zip(back.as_raw().chunks(3)) {
            let largest = pixel.iter().fold(1e-37f32, |a, &b| if b > a { b } else { a });
            for (&v, &b) in pixel.iter().zip(back) {
                let (v, b) = (v.clamp(0.0, LARGEST_RGBE) as f64, b as f64);
                assert!((v - b).abs() <= largest as f64 / 256.0, "{pixel:?} {back:?}");
            }
        }
    }

    #[test]
    fn endings_pick_the_format() {
        let of = |p: &str| Format::from_path(Path::new(p), Format::PNG);
        assert_eq!(of("a.b/c.PNG"), Some(Format::PNG));
        assert_eq!((of("x.exr"), of("x.hdr")), (Some(Format::Exr), Some(Format::Hdr)));
        assert_eq!((of("png"), of("x.jpg"), of(".png")), (None, None, None));
    }

    #[test]
    fn no_pixels_is_an_error() {
        for format in [Format::PNG, Format::Exr] {
            let mut out = Cursor::new(Vec::new());
            assert!(encode(&Film::new(0, 4), format, &Recipe::new(), &mut out).is_err());
        }
    }
}
