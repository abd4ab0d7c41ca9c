//! What is known of the true picture.

use crate::film::{Depth, Developer};
use crate::scene::color::encode_srgb;

/// The true picture, as far as it is known: codes that aren't rounded, and how far off each pixel may be.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Codes of 8 bits before they are rounded, 0 to 255, row by row from the top.
    pub codes: Vec<[f64; 3]>,
    /// By pixel, the largest distance in codes from the true one, of any channel.
    pub uncertainty: Vec<f64>,
}

impl Truth {
    /// Of linear light and the uncertainty of its codes, pixel by pixel: `width × height` of them.
    pub fn new(width: u32, height: u32, pixels: impl IntoIterator<Item = ([f64; 3], f64)>) -> Truth {
        let code = |v: f64| 255.0 * encode_srgb(v.clamp(0.0, 1.0));
        let (codes, uncertainty) = pixels.into_iter().map(|(light, off)| (light.map(code), off)).unzip();
        Truth { width, height, codes, uncertainty }
    }

    /// The codes that a picture of it would be written with, channel by channel.
    pub fn written(&self) -> Vec<u8> {
        // From 0 to 255, so that the cast only rounds.
        self.codes.as_flattened().iter().map(|code| code.round() as u8).collect()
    }

    /// The largest uncertainty of any pixel, in codes.
    pub fn worst(&self) -> f64 {
        self.uncertainty.iter().fold(0.0, |worst, u| if *u > worst { *u } else { worst })
    }
}

/// The codes of 8 bits that linear light is written with, channel by channel.
pub fn written(pixels: &[[f32; 3]]) -> Vec<u8> {
    let mut codes = Vec::with_capacity(3 * pixels.len());
    Developer::of(Depth::Eight).develop(pixels, &mut codes);
    codes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::color::decode_srgb;

    #[test]
    fn codes_are_those_of_the_light() {
        let light = |code: f64| decode_srgb(code / 255.0);
        let truth = Truth::new(2, 1, [([light(3.25), light(200.5), 7.0], 0.25), ([-1.0, 0.0, light(254.75)], 0.5)]);
        let expected = [[3.25, 200.5, 255.0], [0.0, 0.0, 254.75]];
        for (is, expected) in truth.codes.as_flattened().iter().zip(expected.as_flattened()) {
            assert!((is - expected).abs() < 1e-4, "{is} {expected}");
        }
        assert_eq!(truth.worst(), 0.5);
        assert_eq!((truth.written()[0], truth.written()[5]), (3, 255));
    }
}
