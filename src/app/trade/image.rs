//! Pictures within a page: as a PNG in the text of a link.

use crate::film::{Compression, Depth, PngWriter, Recipe};
use std::io::{self, Cursor};

/// How many times a difference is shown: one code becomes visible, sixteen are white.
pub const GAIN: u8 = 16;

/// The differences of two pictures' codes, channel by channel, [`GAIN`] times.
pub fn difference(a: &[u8], b: &[u8]) -> Vec<u8> {
    a.iter().zip(b).map(|(a, b)| a.abs_diff(*b).saturating_mul(GAIN)).collect()
}

/// The link that holds a picture of codes, channel by channel, as `data:` has it (RFC 2397).
///
/// # Errors
/// Those of the encoder.
pub fn link(codes: &[u8], size: [u32; 2]) -> io::Result<String> {
    let mut file = Cursor::new(Vec::new());
    let mut writer = PngWriter::new(&mut file, (size[0], size[1]), (Depth::Eight, Compression::Small), &Recipe::new())?;
    writer.rows(codes)?;
    writer.finish()?;
    Ok(format!("data:image/png;base64,{}", base64(file.get_ref())))
}

/// Bytes as letters, digits, `+` and `/` (RFC 4648).
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let at = |i: usize| *chunk.get(i).unwrap_or(&0) as u32;
        let bits = at(0) << 16 | at(1) << 8 | at(2);
        for i in 0..4 {
            // n bytes fill n + 1 letters.
            let letter = LETTERS[(bits >> (18 - 6 * i)) as usize & 63] as char;
            text.push(if i <= chunk.len() { letter } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The vectors of RFC 4648, section 10.
    #[test]
    fn letters_of_bytes() {
        let cases =
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg=="), ("foobar", "Zm9vYmFy")];
        for (bytes, text) in cases {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
        assert_eq!(base64(&[251, 255, 191]), "+/+/");
    }

    #[test]
    fn differences_are_raised_and_end_at_white() {
        assert_eq!(difference(&[10, 20, 0], &[11, 20, 255]), [16, 0, 255]);
    }

    #[test]
    fn a_link_holds_the_picture() {
        let link = link(&[1, 2, 3, 4, 5, 6], [2, 1]).unwrap();
        assert!(link.starts_with("data:image/png;base64,iVBORw0KGgo"), "{link}");
    }
}
