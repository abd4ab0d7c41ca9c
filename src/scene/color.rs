//! Scene-linear colours with the primaries and white of sRGB (ITU-R BT.709, D65), and the encodings that people write.

use crate::math::fun;
use std::ops::{Add, Mul};

/// Linear light; 1 is the brightest that a picture file shows. May exceed 1 and, in patterns, be negative.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Color(pub [f64; 3]);

impl Color {
    /// No light.
    pub const BLACK: Color = Color([0.0; 3]);
    /// Full white.
    pub const WHITE: Color = Color([1.0; 3]);

    /// The same linear value in all three channels.
    pub const fn linear_gray(v: f64) -> Color {
        Color([v; 3])
    }
    /// From sRGB-encoded channels in 0..=1.
    pub fn from_srgb(c: [f64; 3]) -> Color {
        Color(c.map(decode_srgb))
    }
    /// From `#rrggbb`'s bytes.
    pub fn from_srgb8(c: [u8; 3]) -> Color {
        Color::from_srgb(c.map(|v| v as f64 / 255.0))
    }
    /// sRGB-encoded channels; not clamped.
    pub fn to_srgb(self) -> [f64; 3] {
        self.0.map(encode_srgb)
    }
    /// From hue in degrees (any), saturation and value in 0..=1: sRGB-encoded, as colour pickers have it (Smith, SIGGRAPH 1978).
    pub fn from_hsv(hue: f64, s: f64, v: f64) -> Color {
        let h = hue.rem_euclid(360.0) / 60.0;
        let f = |n: f64| {
            let k = (n + h) % 6.0;
            let m = if k < 4.0 - k { k } else { 4.0 - k };
            v - v * s * m.clamp(0.0, 1.0)
        };
        Color::from_srgb([f(5.0), f(3.0), f(1.0)])
    }
    /// From Oklch: lightness 0..=1, chroma 0..≈0.4, hue in degrees (Ottosson, *A perceptual color space*, 2020). Colours
    /// outside sRGB come out with channels below 0 or above 1.
    pub fn from_oklch(l: f64, chroma: f64, hue: f64) -> Color {
        let (a, b) = (chroma * fun::cos_deg(hue), chroma * fun::sin_deg(hue));
        let cube = |x: f64| x * x * x;
        let l_ = cube(l + 0.3963377774 * a + 0.2158037573 * b);
        let m_ = cube(l - 0.1055613458 * a - 0.0638541728 * b);
        let s_ = cube(l - 0.0894841775 * a - 1.2914855480 * b);
        Color([
            4.0767416621 * l_ - 3.3077115913 * m_ + 0.2309699292 * s_,
            -1.2684380046 * l_ + 2.6097574011 * m_ - 0.3413193965 * s_,
            -0.0041960863 * l_ - 0.7034186147 * m_ + 1.7076147010 * s_,
        ])
    }
    /// Relative luminance (ITU-R BT.709).
    pub fn luminance(self) -> f64 {
        0.2126 * self.0[0] + 0.7152 * self.0[1] + 0.0722 * self.0[2]
    }
    /// Whether all channels are exactly 0.
    pub fn is_black(self) -> bool {
        self.0 == [0.0; 3]
    }
}

impl Add for Color {
    type Output = Color;
    fn add(self, o: Color) -> Color {
        Color(std::array::from_fn(|i| self.0[i] + o.0[i]))
    }
}
impl Mul for Color {
    type Output = Color;
    fn mul(self, o: Color) -> Color {
        Color(std::array::from_fn(|i| self.0[i] * o.0[i]))
    }
}
impl Mul<f64> for Color {
    type Output = Color;
    fn mul(self, s: f64) -> Color {
        Color(self.0.map(|v| v * s))
    }
}

/// sRGB code value in 0..=1 to linear light (IEC 61966-2-1).
pub fn decode_srgb(x: f64) -> f64 {
    if x <= 0.04045 { x / 12.92 } else { fun::pow((x + 0.055) / 1.055, 2.4) }
}

/// Linear light to an sRGB code value (IEC 61966-2-1).
pub fn encode_srgb(x: f64) -> f64 {
    if x <= 0.0031308 { x * 12.92 } else { 1.055 * fun::pow(x, 1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encodings_round_trip_and_agree() {
        for i in 0..=255u8 {
            let c = Color::from_srgb8([i; 3]);
            assert_eq!((c.to_srgb()[0] * 255.0).round() as u8, i);
        }
        assert_eq!(Color::from_hsv(0.0, 1.0, 1.0), Color([1.0, 0.0, 0.0]));
        assert_eq!(Color::from_hsv(-240.0, 1.0, 1.0), Color([0.0, 1.0, 0.0]));
        assert_eq!(Color::from_hsv(99.0, 0.0, 1.0), Color::WHITE);
        let white = Color::from_oklch(1.0, 0.0, 0.0);
        assert!(white.0.iter().all(|v| (v - 1.0).abs() < 1e-6), "{white:?}");
    }
}
