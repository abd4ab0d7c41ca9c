//! Linear light to the display codes of sRGB, exactly: the code is the one whose encoded value lies nearest. No formula is
//! evaluated per pixel: the places where one code gives way to the next are computed once, from the same
//! [`decode_srgb`] that reads colours, and looked up. So the codes have the same bits
//! everywhere, and writing a picture takes milliseconds.

use crate::scene::color::decode_srgb;

/// Bits of a channel in a picture file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// 0 to 255.
    Eight,
    /// 0 to 65,535.
    Sixteen,
}

impl Depth {
    /// The code of full white.
    pub fn white(self) -> u16 {
        match self {
            Depth::Eight => u8::MAX as u16,
            Depth::Sixteen => u16::MAX,
        }
    }

    /// Bits of the mantissa that, with the exponent, make a bucket: at 1, where codes are densest, 8-bit buckets hold one
    /// threshold at most, 16-bit ones about four.
    fn bucket_bits(self) -> u32 {
        match self {
            Depth::Eight => 8,
            Depth::Sixteen => 12,
        }
    }
}

/// Mantissa bits of an `f32`.
const MANTISSA_BITS: u32 = 23;

/// The table for one depth.
pub struct Developer {
    /// `thresholds[k]` is the smallest `f32` whose code is `k + 1` or more; increasing.
    thresholds: Vec<f32>,
    /// The code of each bucket's first value; buckets divide the values from `thresholds[0]` to 1 by their leading bits.
    codes: Vec<u16>,
    /// The first bucket's number.
    first_bucket: u32,
    /// Bits of a value that don't choose its bucket.
    shift: u32,
}

impl Developer {
    /// The table for `depth`.
    pub fn new(depth: Depth) -> Developer {
        let white = depth.white();
        // Half-way between two codes in encoded space; a value exactly there takes the brighter.
        let thresholds: Vec<f32> =
            (1..=white).map(|k| at_least(decode_srgb((k as f64 - 0.5) / white as f64))).collect();
        let shift = MANTISSA_BITS - depth.bucket_bits();
        let first_bucket = thresholds[0].to_bits() >> shift;
        let last_bucket = 1f32.to_bits() >> shift;
        let code = |bucket: u32| {
            let start = f32::from_bits(bucket << shift);
            thresholds.partition_point(|&t| t <= start) as u16
        };
        // One more than there are buckets, so that each has an end.
        let codes = (first_bucket..=last_bucket + 1).map(code).collect();
        Developer { thresholds, codes, first_bucket, shift }
    }

    /// The code of a linear value; below 0 is 0, above 1 is white. (NaN, which no picture holds, is 0.)
    #[inline]
    pub fn code(&self, v: f32) -> u16 {
        if v.is_nan() || v < self.thresholds[0] {
            return 0;
        }
        if v >= 1.0 {
            return self.thresholds.len() as u16;
        }
        let bucket = ((v.to_bits() >> self.shift) - self.first_bucket) as usize;
        let (mut code, end) = (self.codes[bucket], self.codes[bucket + 1]);
        while code < end && self.thresholds[code as usize] <= v {
            code += 1;
        }
        code
    }
}

/// The smallest `f32` that isn't below `x`, which is positive and normal.
fn at_least(x: f64) -> f32 {
    let near = x as f32;
    if (near as f64) < x { near.next_up() } else { near }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::color::encode_srgb;

    #[test]
    fn thresholds_are_exact() {
        for depth in [Depth::Eight, Depth::Sixteen] {
            let table = Developer::new(depth);
            let white = depth.white();
            for k in 1..=white {
                let half_way = decode_srgb((k as f64 - 0.5) / white as f64);
                let above = at_least(half_way);
                assert!(above as f64 >= half_way && (above.next_down() as f64) < half_way);
                assert_eq!(table.code(above), k);
                assert_eq!(table.code(above.next_down()), k - 1);
            }
        }
    }

    #[test]
    fn codes_are_the_nearest() {
        for depth in [Depth::Eight, Depth::Sixteen] {
            let table = Developer::new(depth);
            let white = depth.white() as f64;
            for i in 0..=100_000 {
                let v = i as f32 / 100_000.0;
                let exact = encode_srgb(v as f64) * white;
                let distance = (table.code(v) as f64 - exact).abs();
                // The two formulas of the standard meet only to 1e-7 of white, hence the slack, in codes.
                assert!(distance <= 0.5 + 1e-7 * white, "{v}: {distance}");
            }
        }
    }

    #[test]
    fn codes_come_back_and_the_ends_hold() {
        for depth in [Depth::Eight, Depth::Sixteen] {
            let table = Developer::new(depth);
            let white = depth.white();
            for k in 0..=white {
                assert_eq!(table.code(decode_srgb(k as f64 / white as f64) as f32), k);
            }
            for dark in [0.0, -0.0, -1.0, f32::NEG_INFINITY, f32::NAN, f32::MIN_POSITIVE, f32::from_bits(1)] {
                assert_eq!(table.code(dark), 0);
            }
            for bright in [1.0, 1.5, f32::MAX, f32::INFINITY, 1f32.next_down()] {
                assert_eq!(table.code(bright), white);
            }
        }
    }
}
