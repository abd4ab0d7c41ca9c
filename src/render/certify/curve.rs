//! The sRGB curve and its inverse, as often as pixels are judged by them: powers by a table and a short series, to a few ulp,
//! several times as fast as the library's.
//!
//! x = 2^e·m with m from 1 to 2: of each m the power of a nearby m' stands in a table, and (m/m')^p is (1 + u)^p with u below
//! 1/128, of whose binomial series seven terms are enough. Nothing but sums and products, so the same bits on every machine.

use crate::math::fun;
use crate::scene::color::{decode_srgb, encode_srgb};
use std::sync::LazyLock;

/// Values of m in the table.
const STEPS: usize = 64;

/// Powers of two: from 1 down to below the start of the curve's power in either direction.
const OCTAVES: usize = 12;

/// Terms of the series: the next one is below 2^-53.
const TERMS: usize = 7;

/// x^p for x from 2^(1 − OCTAVES) to 1.
struct Power {
    /// 2^(−ep) for e = 0, 1, …
    octaves: [f64; OCTAVES],
    /// m', 1/m' and m'^p.
    steps: [[f64; 3]; STEPS],
    /// Binomial coefficients.
    series: [f64; TERMS],
}

impl Power {
    fn new(p: f64) -> Power {
        let mut series = [1.0; TERMS];
        for k in 1..TERMS {
            series[k] = series[k - 1] * (p - (k - 1) as f64) / k as f64;
        }
        let step = |i: usize| {
            let m = 1.0 + (i as f64 + 0.5) / STEPS as f64;
            [m, 1.0 / m, fun::pow(m, p)]
        };
        let octave = |e: usize| fun::exp2(-(e as f64) * p);
        Power { octaves: std::array::from_fn(octave), steps: std::array::from_fn(step), series }
    }

    /// `None` beyond both ends.
    fn of(&self, x: f64) -> Option<f64> {
        let bits = x.to_bits();
        // The sign's bit brings what is negative out of the table, too.
        let octave = self.octaves.get(1023usize.wrapping_sub((bits >> 52) as usize))?;
        let [middle, inverse, power] = self.steps[(bits >> 46) as usize % STEPS];
        let m = f64::from_bits(bits & ((1 << 52) - 1) | 1.0f64.to_bits());
        let u = (m - middle) * inverse;
        let [_, a, b, c, d, e, f] = self.series;
        let series = u * (a + u * (b + u * (c + u * (d + u * (e + u * f)))));
        let power = power * octave;
        Some(power + power * series)
    }
}

static UP: LazyLock<Power> = LazyLock::new(|| Power::new(1.0 / 2.4));
static DOWN: LazyLock<Power> = LazyLock::new(|| Power::new(2.4));

/// As [`encode_srgb`], to a few ulp; from 0 to 1.
pub fn encoded(x: f64) -> f64 {
    match if x > 0.0031308 { UP.of(x) } else { None } {
        Some(power) => 1.055 * power - 0.055,
        None => encode_srgb(x),
    }
}

/// As [`decode_srgb`], likewise.
pub fn decoded(x: f64) -> f64 {
    match if x > 0.04045 { DOWN.of((x + 0.055) / 1.055) } else { None } {
        Some(power) => power,
        None => decode_srgb(x),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::hash::KeyedHash;

    #[test]
    fn curves_are_those_of_the_library() {
        let ends =
            [0.0, 1.0, 0.0031308, 0.0031308f64.next_up(), 0.04045, 0.04045f64.next_up(), 0.5, 0.25, 1.0f64.next_down()];
        let random = (0..200_000).map(|i| KeyedHash::new().with(i).unit());
        let steps = (0..=4096).map(|i| i as f64 / 4096.0);
        let mut worst = 0.0;
        for x in ends.into_iter().chain(steps).chain(random) {
            for (ours, theirs) in [(encoded(x), encode_srgb(x)), (decoded(x), decode_srgb(x))] {
                let off = (ours - theirs).abs() / theirs.max(f64::MIN_POSITIVE);
                worst = if off > worst { off } else { worst };
            }
        }
        assert!(worst < 16.0 * f64::EPSILON, "{worst}");
        for x in [f64::NAN, -0.5, 3.0, f64::INFINITY, 1e-300] {
            assert_eq!(encoded(x).to_bits(), encode_srgb(x).to_bits());
            assert_eq!(decoded(x).to_bits(), decode_srgb(x).to_bits());
        }
    }
}
