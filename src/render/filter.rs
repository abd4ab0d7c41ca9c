//! How light is weighed along one axis of the picture: the filters beyond the box, their integrals in closed form, and points that
//! stand for them.
//!
//! A filter's weight at a point is the product of its weights along both axes, so all of it is said here for one. Distances are in
//! pixels, from the pixel's middle.

use super::bounds::{larger, smaller};
use crate::math::fun;
use crate::scene::PixelFilter;

/// The weights of a filter that reaches beyond the pixel, along one axis: symmetric, continuous, smooth within its reach, 1 in all.
#[derive(Clone, Copy, Debug)]
pub struct Kernel {
    shape: Shape,
}

#[derive(Clone, Copy, Debug)]
enum Shape {
    Mitchell,
    Gauss {
        /// What makes it 1 in all.
        scale: f64,
    },
}

/// Integrals over a part of the axis, each off by less than [`OFF`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Piece {
    /// Of the weight.
    pub whole: f64,
    /// Of its magnitude.
    pub size: f64,
    /// Of the weight times the distance from the part's middle.
    pub tilt: f64,
    /// No less than that of the weight's distance from its mean over the part.
    pub apart: f64,
}

/// More than rounding of numbers up to 2, some 50 of them, and the library's functions, which are right within 1 unit of their last
/// place: 2^-46.
pub const OFF: f64 = 1.0 / (1u64 << 46) as f64;

/// Where the cubic crosses 0: beyond, its weights are negative.
const CROSSING: f64 = 8.0 / 7.0;

/// Where the cubic's formula changes or its sign does.
const BREAKS: [f64; 5] = [-CROSSING, -1.0, 0.0, 1.0, CROSSING];

/// How far the bell reaches: three times its standard deviation of ½, where it is down to 1.1 % of its height. (The width that
/// Pharr, Jakob and Humphreys give it, *Physically Based Rendering*, 4th edition, 2023.)
const BELL: f64 = 1.5;

/// No second derivative is larger: 4 of the cubic, at 0, where the bell's is 3.3.
const BEND: f64 = 4.0;

/// The bell, e^(−2u²), at its end.
fn bell_end() -> f64 {
    fun::exp(-2.0 * BELL * BELL)
}

/// Integral of the bell less its value at its end, from 0 to u, not scaled.
fn bell_below(u: f64) -> f64 {
    // √(π/8) erf(√2 u)
    const ROOT: f64 = 0.626_657_068_657_750_1;
    ROOT * fun::erf(std::f64::consts::SQRT_2 * u) - bell_end() * u
}

impl Kernel {
    /// That of a filter; `None` for the box, which needs none.
    pub fn of(filter: PixelFilter) -> Option<Kernel> {
        let shape = match filter {
            PixelFilter::Box => return None,
            PixelFilter::Mitchell => Shape::Mitchell,
            PixelFilter::Gauss => Shape::Gauss { scale: 0.5 / bell_below(BELL) },
        };
        Some(Kernel { shape })
    }

    /// Weights are 0 from here on; a multiple of ½.
    pub fn radius(&self) -> f64 {
        match self.shape {
            Shape::Mitchell => 2.0,
            Shape::Gauss { .. } => BELL,
        }
    }

    /// The integral of the weights' magnitudes, rounded upwards: 1 unless some are negative.
    pub fn size(&self) -> f64 {
        match self.shape {
            // Both rims hold −6/343.
            Shape::Mitchell => (367.0f64 / 343.0).next_up(),
            Shape::Gauss { .. } => 1.0,
        }
    }

    /// Whether some weights are negative.
    pub fn has_negative(&self) -> bool {
        matches!(self.shape, Shape::Mitchell)
    }

    /// The weight at `u`.
    pub fn at(&self, u: f64) -> f64 {
        match self.shape {
            _ if u.abs() >= self.radius() => 0.0,
            Shape::Mitchell => cubic(u)[0],
            Shape::Gauss { scale } => scale * (fun::exp(-2.0 * u * u) - bell_end()),
        }
    }

    /// Its sign at `u`, 1 or −1.
    pub fn sign(&self, u: f64) -> f64 {
        if self.has_negative() && u.abs() > CROSSING { -1.0 } else { 1.0 }
    }

    /// The integrals from `a` to `b`, both within the reach, a < b.
    pub fn piece(&self, a: f64, b: f64) -> Piece {
        let (middle, width) = (0.5 * (a + b), b - a);
        let (mut whole, mut size, mut tilt) = (0.0, 0.0, 0.0);
        let slope;
        match self.shape {
            Shape::Mitchell => {
                let inner = BREAKS.into_iter().filter(|x| a < *x && *x < b);
                let mut from = a;
                for to in inner.chain([b]) {
                    // Between breaks it is one cubic around the part's own middle.
                    let (m, h) = (0.5 * (from + to), 0.5 * (to - from));
                    let [p0, p1, p2, p3] = cubic(m);
                    let part = 2.0 * h * (p0 + h * h * p2 / 3.0);
                    whole += part;
                    size += part.abs();
                    tilt += h * h * h * (2.0 / 3.0 * p1 + 0.4 * h * h * p3) + (m - middle) * part;
                    from = to;
                }
                slope = cubic(middle)[1];
            }
            Shape::Gauss { scale } => {
                let bell = |u: f64| fun::exp(-2.0 * u * u);
                whole = scale * (bell_below(b) - bell_below(a));
                size = larger(whole, 0.0);
                let first = 0.25 * (bell(a) - bell(b)) - bell_end() * width * middle;
                tilt = scale * first - middle * whole;
                slope = -4.0 * scale * middle * bell(middle);
            }
        }
        // f(c + t) = f(c) + f′(c)t + ρ with |ρ| ≤ BEND·t²/2, and the same of the mean.
        let curved = width * width * (0.25 * slope.abs() + BEND / 12.0 * width);
        Piece { whole, size, tilt, apart: smaller(size + whole.abs(), curved) }
    }

    /// Where between `a` and `b` a share `t` of the weights' magnitudes lies below.
    pub fn quantile(&self, t: f64, [a, b]: [f64; 2]) -> f64 {
        let below = |u: f64| self.size_below(u);
        let (start, end) = (below(a), below(b));
        let wanted = start + t * (end - start);
        let (mut lo, mut hi, mut u) = (a, b, a + t * (b - a));
        // Newton's steps, and halves where they leave what is left; far more than either takes.
        for _ in 0..64 {
            let off = below(u) - wanted;
            if off > 0.0 {
                hi = u
            } else {
                lo = u
            }
            let step = off / self.at(u).abs();
            let next = u - step;
            let next = if lo < next && next < hi { next } else { 0.5 * (lo + hi) };
            // What is left is less than anyone sees of a point's place.
            if (next - u).abs() <= 1.0 / (1u64 << 40) as f64 {
                return next;
            }
            u = next;
        }
        u
    }

    /// Integral of the weights' magnitudes from 0 to `u`, negative where u is.
    fn size_below(&self, u: f64) -> f64 {
        let v = u.abs();
        let below = match self.shape {
            Shape::Gauss { scale } => scale * bell_below(v),
            Shape::Mitchell if v <= 1.0 => v * (16.0 / 3.0 + v * v * (1.75 * v - 4.0)) / 6.0,
            Shape::Mitchell => {
                // From v to 2.
                let w = larger(2.0 - v, 0.0);
                let rest = w * w * w * (1.75 * w - 2.0) / 18.0;
                if v <= CROSSING { 0.5 - rest } else { 0.5 + 12.0 / 343.0 + rest }
            }
        };
        if u < 0.0 { -below } else { below }
    }
}

/// The value of the cubic at `u`, and its first three derivatives over 1, 2 and 6.
fn cubic(u: f64) -> [f64; 4] {
    let v = u.abs();
    let [a, b, c, d] = if v < 1.0 { [16.0 / 3.0, 0.0, -12.0, 7.0] } else { [32.0 / 3.0, -20.0, 12.0, -7.0 / 3.0] };
    let mirror = if u < 0.0 { -1.0 } else { 1.0 };
    [
        (a + v * (b + v * (c + v * d))) / 6.0,
        mirror * (b + v * (2.0 * c + v * (3.0 * d))) / 6.0,
        (c + v * (3.0 * d)) / 6.0,
        mirror * d / 6.0,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::hash::KeyedHash;

    const BOTH: [PixelFilter; 2] = [PixelFilter::Mitchell, PixelFilter::Gauss];

    /// The midpoint rule with `n` points: off by BEND/24 of the square of their distance.
    fn sum(a: f64, b: f64, n: u32, f: impl Fn(f64) -> f64) -> f64 {
        let step = (b - a) / n as f64;
        (0..n).map(|i| f(a + (i as f64 + 0.5) * step)).sum::<f64>() * step
    }

    #[test]
    fn weights_are_one_in_all_and_symmetric() {
        for filter in BOTH {
            let k = Kernel::of(filter).unwrap();
            let r = k.radius();
            let all = k.piece(-r, r);
            assert!((all.whole - 1.0).abs() < OFF && all.tilt.abs() < OFF, "{filter:?} {all:?}");
            assert!((all.size - k.size()).abs() < OFF && k.size() >= all.size - OFF);
            assert_eq!((k.at(r), k.at(-2.5), k.at(0.3)), (0.0, 0.0, k.at(-0.3)));
            assert!(k.at(r - 1e-9).abs() < 1e-8, "it ends at 0");
        }
        let mitchell = Kernel::of(PixelFilter::Mitchell).unwrap();
        assert!((mitchell.at(0.0) - 16.0 / 18.0).abs() < 1e-15 && (mitchell.at(1.0) - 1.0 / 18.0).abs() < 1e-15);
        // It is 1 at whole distances together, wherever they begin (Mitchell, Netravali).
        let comb = |t: f64| (-3..3).map(|i| mitchell.at(i as f64 + t)).sum::<f64>();
        assert!((0..100).all(|i| (comb(i as f64 * 0.01) - 1.0).abs() < 1e-14));
        assert!(Kernel::of(PixelFilter::Box).is_none());
    }

    #[test]
    fn integrals_are_those_of_sums() {
        for filter in BOTH {
            let k = Kernel::of(filter).unwrap();
            for i in 0..300 {
                let draw = |j: u64| (KeyedHash::new().with(i).with(j).unit() * 2.0 - 1.0) * k.radius();
                let (p, q) = (draw(0), draw(1));
                let (a, b) = (smaller(p, q), larger(p, q));
                let (middle, n) = (0.5 * (a + b), 4000);
                let got = k.piece(a, b);
                let whole = sum(a, b, n, |u| k.at(u));
                // The points' distance is 1/1000 at most, and a sign may change between two of them.
                assert!((got.whole - whole).abs() < 2e-6, "{filter:?} {a} {b}: {got:?} {whole}");
                assert!((got.size - sum(a, b, n, |u| k.at(u).abs())).abs() < 2e-6);
                assert!((got.tilt - sum(a, b, n, |u| k.at(u) * (u - middle))).abs() < 4e-6);
                let mean = got.whole / (b - a);
                let apart = sum(a, b, n, |u| (k.at(u) - mean).abs());
                assert!(got.apart >= apart - 2e-6, "{filter:?} {a} {b}: {got:?} {apart}");
                // And where it is short, not much more.
                assert!(b - a > 0.05 || got.apart <= apart + 0.7 * (b - a) * (b - a) * (b - a));
            }
        }
    }

    #[test]
    fn quantiles_part_the_weights() {
        for filter in BOTH {
            let k = Kernel::of(filter).unwrap();
            let r = k.radius();
            for (a, b) in [(-r, r), (-0.5, 0.25), (0.5, r), (1.0, 1.25), (-r, -1.25)] {
                let all = k.piece(a, b).size;
                let mut last = a;
                for i in 1..200 {
                    let t = i as f64 / 200.0;
                    let u = k.quantile(t, [a, b]);
                    assert!(u > last && u < b, "{filter:?} {a} {b} {t}: {u}");
                    assert!((k.piece(a, u).size - t * all).abs() < 1e-11, "{filter:?} {a} {b} {t}: {u}");
                    assert_eq!(k.sign(u), if k.at(u) < 0.0 { -1.0 } else { 1.0 });
                    last = u;
                }
            }
        }
    }
}
