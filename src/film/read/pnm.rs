//! Binary PPM and PGM files (Netpbm's *ppm* and *pgm* formats, P6 and P5): a few words, then the samples as they are. Of several
//! pictures in a file the first is read.

use super::{Picture, ReadError};
use crate::scene::Texels;

/// Which of them.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    name: &'static str,
    channels: usize,
}

impl Kind {
    /// P6: red, green and blue.
    pub const PPM: Kind = Kind { name: "PPM", channels: 3 };
    /// P5: gray.
    pub const PGM: Kind = Kind { name: "PGM", channels: 1 };
}

/// The picture, if its size is `allowed`.
///
/// # Errors
/// That of `allowed`, and a file that isn't whole.
pub fn read(
    mut bytes: Vec<u8>,
    kind: Kind,
    allowed: impl Fn(u32, u32) -> Result<(), ReadError>,
) -> Result<Picture, ReadError> {
    let damaged = ReadError::Damaged(kind.name);
    let mut at = 2;
    let (width, height) = (number(&bytes, &mut at).ok_or(damaged)?, number(&bytes, &mut at).ok_or(damaged)?);
    let largest = number(&bytes, &mut at).filter(|n| (1..=u32::from(u16::MAX)).contains(n)).ok_or(damaged)?;
    // A single byte of space, whatever the samples after it look like.
    at += usize::from(bytes.get(at).is_some_and(u8::is_ascii_whitespace));
    allowed(width, height)?;
    let samples = (width as usize).checked_mul(height as usize).and_then(|n| n.checked_mul(kind.channels));
    let is_wide = largest > u32::from(u8::MAX);
    let end = samples.and_then(|n| n.checked_mul(1 + usize::from(is_wide))?.checked_add(at)).ok_or(damaged)?;
    if bytes.len() < end {
        return Err(damaged);
    }
    // The nearest of 256 steps; what is more than the largest is white.
    let step = |sample: u32| ((sample.min(largest) * 510 + largest) / (2 * largest)) as u8;
    let codes = if is_wide {
        bytes[at..end].as_chunks().0.iter().map(|s| step(u16::from_be_bytes(*s).into())).collect()
    } else {
        bytes.truncate(end);
        bytes.drain(..at);
        if largest < u32::from(u8::MAX) {
            bytes.iter_mut().for_each(|s| *s = step((*s).into()));
        }
        bytes
    };
    let texels = if kind.channels == 1 { Texels::gray(codes) } else { Texels::Colors(codes) };
    Ok(Picture { width, height, texels })
}

/// The number at `at`, behind space and comments; `at` moves to its end.
fn number(bytes: &[u8], at: &mut usize) -> Option<u32> {
    loop {
        match bytes.get(*at)? {
            b'#' => *at += bytes[*at..].iter().position(|b| matches!(b, b'\n' | b'\r'))?,
            b if b.is_ascii_whitespace() => *at += 1,
            _ => break,
        }
    }
    let digits = bytes[*at..].iter().take_while(|b| b.is_ascii_digit()).count();
    let text = &bytes[*at..*at + digits];
    *at += digits;
    std::str::from_utf8(text).ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::super::{Picture, ReadError, read};
    use crate::scene::Texels;

    fn of(header: &str, samples: &[u8]) -> Result<Picture, ReadError> {
        read([header.as_bytes(), samples].concat(), |w, h| w * h < 100)
    }

    fn texels(header: &str, samples: &[u8]) -> Vec<[u8; 3]> {
        of(header, samples).unwrap().texels.into_colors()
    }

    #[test]
    fn samples_come_as_they_are() {
        let found = of("P6 2 1 255\n", &[1, 2, 3, 10, 32, 255]).unwrap();
        assert_eq!((found.width, found.height), (2, 1));
        assert_eq!(found.texels, Texels::Colors(vec![1, 2, 3, 10, 32, 255]));
        assert_eq!(texels("P5\n1 2\n255\n", &[10, 35]), [[10; 3], [35; 3]], "a line's end and a `#` are samples here");
        assert_eq!(texels("P6 1 1 255\n", &[7, 8, 9, b'P', b'6']), [[7, 8, 9]], "what follows is another picture");
    }

    #[test]
    fn headers_have_comments() {
        assert_eq!(texels("P5 # by hand\n#\n 1\t# wide\r1 #high\n255 ", &[99]), [[99; 3]]);
    }

    #[test]
    fn other_scales_come_to_the_nearest_step() {
        assert_eq!(texels("P5 3 1 1\n", &[0, 1, 9]), [[0; 3], [255; 3], [255; 3]]);
        assert_eq!(texels("P6 1 1 100\n", &[50, 1, 99]), [[128, 3, 252]]);
        assert_eq!(texels("P5 3 1 65535\n", &[0, 128, 0, 129, 255, 255]), [[0; 3], [1; 3], [255; 3]]);
        assert_eq!(texels("P6 1 1 1000\n", &[1, 244, 3, 232, 255, 255]), [[128, 255, 255]]);
    }

    #[test]
    fn what_is_not_whole_is_damaged() {
        for header in
            ["P6", "P6 2", "P6 2 2", "P6 2 2 255\n", "P6 0 2 255\n", "P6 2 -2 255\n", "P6 1 1 0\n", "P6 1 1 65536\n"]
        {
            assert_eq!(of(header, &[0; 11]), Err(ReadError::Damaged("PPM")), "{header}");
        }
        for header in ["P5 #", "P5 1 1 #", "P5 4 4 255", "P5 9 2 256\n", "P5 99999999999 1 255\n"] {
            assert_eq!(of(header, &[0; 15]), Err(ReadError::Damaged("PGM")), "{header}");
        }
        assert_eq!(of("P5 1000 1000 255\n", &[]), Err(ReadError::TooLarge(1000, 1000)));
    }
}
