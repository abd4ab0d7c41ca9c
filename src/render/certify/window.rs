//! The window of a pixel: from where its light comes, and how it is weighed there.
//!
//! A pixel's value is the integral of the light L times the filter's weight f over its window. For the box that is the mean over the
//! pixel's square. For others each region adds ∫fL, of which more is known than that L lies in a range: the integral of a form is that
//! of its terms, and with the integral of L itself ∫fL = f̄∫L + ∫(f − f̄)(L − L̄), where f̄ is f's mean over the region.

use super::super::bounds::{larger, smaller};
use super::super::filter::{Kernel, OFF, Piece};
use super::bound::{Bound, Span, meet};
use crate::math::Form;

/// Where light comes from, around a pixel's middle.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    /// The weights along each axis; none for the box.
    kernel: Option<Kernel>,
    /// Half the window's side, in pixels.
    radius: f64,
    /// Integral of the weights' magnitudes, rounded upwards.
    size: f64,
}

/// How a region of a window is weighed: integrals over it, in units of the pixel's area.
#[derive(Clone, Copy, Debug)]
pub struct Weights {
    /// Of the magnitude of the weight; of the box the region's area.
    pub size: f64,
    /// Of the weight.
    whole: f64,
    /// Of the weight times the region's coordinates ξ and η.
    tilt: [f64; 2],
    /// No less than that of the weight's distance from its mean.
    apart: f64,
    /// By how much those may be off that ask for a division by the region's half width and half height.
    off: [f64; 2],
    /// Whether it is the box's: the same weight everywhere.
    pub plain: bool,
}

/// A point of a region.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    /// In the picture.
    pub at: [f64; 2],
    /// In the region's coordinates, from −1 to 1.
    pub inner: [f64; 2],
    /// Whether what is seen there counts for the light or against it: 1 or −1.
    pub sign: f64,
}

/// By how much a product of two integrals may be off, and the few roundings of what is made of it: those of each axis are off by [`OFF`],
/// and no factor is above 1.2.
const SLACK: f64 = 4.0 * OFF;

impl Window {
    /// That of a filter.
    pub fn new(kernel: Option<Kernel>) -> Window {
        let radius = kernel.map_or(0.5, |k| k.radius());
        let size = kernel.map_or(1.0, |k| k.size());
        // A unit more than the square's rounding.
        let size = if size > 1.0 { (size * size).next_up() } else { 1.0 };
        Window { kernel, radius, size }
    }

    /// Whether it is the pixel's own square.
    pub fn is_plain(&self) -> bool {
        self.kernel.is_none()
    }

    /// How far it reaches beyond the pixel's square.
    pub fn beyond(&self) -> f64 {
        self.radius - 0.5
    }

    /// The integral of the weights' magnitudes: 1 unless some are negative.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// All of pixel (x, y): left, top, right, bottom.
    pub fn of(&self, [x, y]: [u32; 2]) -> [f64; 4] {
        let [left, top] = [x, y].map(|i| i as f64 - self.beyond());
        let side = 2.0 * self.radius;
        [left, top, left + side, top + side]
    }

    /// The regions with which looks at pixel (x, y) begin: all of the square, or squares as large as pixels, which windows of
    /// neighbours have in common.
    pub fn first_regions(&self, at: [u32; 2]) -> Vec<[f64; 4]> {
        let [left, top, ..] = self.of(at);
        let n = (2.0 * self.radius) as u32;
        let cell = |i: u32| {
            let (x, y) = (left + (i % n) as f64, top + (i / n) as f64);
            [x, y, x + 1.0, y + 1.0]
        };
        (0..n * n).map(cell).collect()
    }

    /// How a region of the window of pixel (x, y) is weighed.
    pub fn weights(&self, at: [u32; 2], rect: [f64; 4]) -> Weights {
        let [left, top, right, bottom] = rect;
        let Some(kernel) = &self.kernel else {
            // Exact: sides are powers of two.
            let area = (right - left) * (bottom - top);
            return Weights { size: area, whole: area, tilt: [0.0; 2], apart: 0.0, off: [0.0; 2], plain: true };
        };
        let [x, y] = self.pieces(kernel, at, rect);
        let half = [0.5 * (right - left), 0.5 * (bottom - top)];
        Weights {
            size: x.size * y.size,
            whole: x.whole * y.whole,
            tilt: [x.tilt / half[0] * y.whole, x.whole * (y.tilt / half[1])],
            // |fg − f̄ḡ| ≤ |f − f̄||g| + |f̄||g − ḡ|
            apart: x.apart * y.size + x.whole.abs() * y.apart + SLACK,
            off: half.map(|h| SLACK + SLACK / h),
            plain: false,
        }
    }

    fn pieces(&self, kernel: &Kernel, at: [u32; 2], [left, top, right, bottom]: [f64; 4]) -> [Piece; 2] {
        let [x, y] = at.map(|i| i as f64 + 0.5);
        [kernel.piece(left - x, right - x), kernel.piece(top - y, bottom - y)]
    }

    /// The point of a region of the window of pixel (x, y) below which shares u and v of its weights' magnitudes lie.
    pub fn spot(&self, at: [u32; 2], [l, t, r, b]: [f64; 4], [u, v]: [f64; 2]) -> Spot {
        let Some(kernel) = &self.kernel else {
            let point = [l + u * (r - l), t + v * (b - t)];
            return Spot { at: point, inner: [2.0 * u - 1.0, 2.0 * v - 1.0], sign: 1.0 };
        };
        let middle = at.map(|i| i as f64 + 0.5);
        let place = |share: f64, axis: usize, from: f64, to: f64| {
            kernel.quantile(share, [from - middle[axis], to - middle[axis]])
        };
        let (x, y) = (place(u, 0, l, r), place(v, 1, t, b));
        // Rounding may not bring it out of the region.
        let point = [smaller(larger(middle[0] + x, l), r), smaller(larger(middle[1] + y, t), b)];
        let inner = [(2.0 * point[0] - (l + r)) / (r - l), (2.0 * point[1] - (t + b)) / (b - t)];
        Spot { at: point, inner, sign: kernel.sign(x) * kernel.sign(y) }
    }

    /// Where the pixel's value lies if its light does there.
    pub fn spanned(&self, [lo, hi]: Span) -> Span {
        if self.size == 1.0 {
            return [lo, hi];
        }
        let (middle, half) = (0.5 * lo + 0.5 * hi, 0.5 * hi - 0.5 * lo);
        let half = self.size * half + 4.0 * f64::EPSILON * (middle.abs() + half);
        sure([middle - half, middle + half])
    }
}

impl Weights {
    /// What a region with such light adds to its pixel, by channel.
    pub fn part(&self, bound: &Bound) -> [Span; 3] {
        [0, 1, 2].map(|c| {
            let mean = bound.sum[c].map(|x| 0.25 * x);
            if self.plain {
                return mean.map(|x| self.size * x);
            }
            let [lo, hi] = bound.range[c];
            let half = 0.5 * (hi - lo);
            // By the range: the middle's share, and the rest times the magnitudes.
            let by_range = self.around(0.5 * lo + 0.5 * hi, self.size * half, half);
            // By the integral: the mean weight's share, and what is left.
            let by_sum = self.around(0.5 * mean[0] + 0.5 * mean[1], 0.0, 0.0);
            let spread = 0.5 * self.whole.abs() * (mean[1] - mean[0]);
            let rest = self.apart * half + SLACK * half + spread;
            let part = meet(by_range, [by_sum[0] - rest, by_sum[1] + rest]);
            let form = bound.form.map(|f| f[c]).filter(|f| f.is_known());
            let by_form = form.map(|f| {
                let linear = f.x * self.tilt[0] + f.y * self.tilt[1];
                let [lo, hi] = self.around(f.c, self.size * f.r, f.r);
                let off = self.off[0] * f.x.abs() + self.off[1] * f.y.abs();
                [lo + linear - off, hi + linear + off]
            });
            sure(by_form.map_or(part, |form| meet(part, form)))
        })
    }

    /// The share of a light `middle` that is off by up to `off` after weighing, itself by numbers as large as `size`; with rounding.
    fn around(&self, middle: f64, off: f64, size: f64) -> Span {
        let (value, off) = (self.whole * middle, off + SLACK * (middle.abs() + size.abs()));
        [value - off, value + off]
    }

    /// The part of a light that is linear over the region, all but exactly.
    pub fn of_linear(&self, f: Form) -> f64 {
        self.whole * f.c + (f.x * self.tilt[0] + f.y * self.tilt[1])
    }
}

/// The same, or all numbers where it isn't one: of infinite light nothing is known.
fn sure([lo, hi]: Span) -> Span {
    if lo <= hi { [lo, hi] } else { [f64::NEG_INFINITY, f64::INFINITY] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::fun;
    use crate::math::hash::KeyedHash;
    use crate::scene::PixelFilter;

    fn random(i: u64, k: u64) -> f64 {
        KeyedHash::new().with(i).with(k).unit() * 2.0 - 1.0
    }

    /// The integral of weight times light over a region, by midpoints of 200 × 200 parts.
    fn sum(kernel: &Kernel, [l, t, r, b]: [f64; 4], light: impl Fn(f64, f64) -> f64) -> f64 {
        let n = 200;
        let at = |i: usize| (2 * i + 1) as f64 / n as f64 - 1.0;
        let (dx, dy) = (0.5 * (r - l), 0.5 * (b - t));
        let weight = |from: f64, half: f64| -> Vec<f64> { (0..n).map(|i| kernel.at(from + half * at(i))).collect() };
        let (across, down) = (weight(0.5 * (l + r), dx), weight(0.5 * (t + b), dy));
        let mut all = 0.0;
        for (j, v) in down.iter().enumerate() {
            for (i, u) in across.iter().enumerate() {
                all += u * v * light(at(i), at(j));
            }
        }
        all * dx * dy * 4.0 / (n * n) as f64
    }

    #[test]
    fn what_a_region_adds_lies_within_its_part() {
        for filter in [PixelFilter::Mitchell, PixelFilter::Gauss] {
            let kernel = Kernel::of(filter).unwrap();
            let window = Window::new(Some(kernel));
            let (mut by_form, mut by_sum) = (0, 0);
            for i in 0..400 {
                let reach = window.radius;
                let side = fun::exp2(-(5.0 * random(i, 0).abs()).floor());
                let place = |k: u64| (0.5 * (random(i, k) + 1.0) * (2.0 * reach - side) * 16.0).floor() / 16.0 - reach;
                let (l, t) = (place(1), place(2));
                // The pixel's middle is at (5.5, 3.5).
                let rect = [5.5 + l, 3.5 + t, 5.5 + l + side, 3.5 + t + side];
                let around = [l, t, l + side, t + side];
                let weights = window.weights([5, 3], rect);
                let region = side * side;
                // A form, and all that it says of values and integral.
                let f = Form { c: random(i, 3), x: random(i, 4), y: random(i, 5), r: 0.1 * random(i, 6).abs() };
                let ripple = |x: f64, y: f64| if (7.0 * x + 3.0 * y).floor() as i64 % 2 == 0 { f.r } else { -f.r };
                let light = |x: f64, y: f64| f.c + f.x * x + f.y * y + ripple(x, y);
                let wide = [f.lo(), f.hi()];
                let bound =
                    Bound { sum: [[4.0 * (f.c - f.r), 4.0 * (f.c + f.r)]; 3], range: [wide; 3], form: Some([f; 3]) };
                let (part, truth) = (weights.part(&bound)[1], sum(&kernel, around, light));
                // The ripple's edges fall between midpoints.
                let coarse = 0.03 * f.r * region + 2e-4 * region;
                assert!(part[0] - coarse <= truth && truth <= part[1] + coarse, "{filter:?} {i}: {part:?} {truth}");
                by_form += (part[1] - part[0] < 2.2 * f.r * weights.size + 1e-9) as u32;
                // An edge, of which the area is known.
                let (a, b, c) = (random(i, 7), random(i, 8), 0.5 * random(i, 9));
                let edge = |x: f64, y: f64| if a * x + b * y > c { 1.0 } else { 0.0 };
                let n = 400;
                let at = |k: usize| (2 * k + 1) as f64 / n as f64 - 1.0;
                let area = (0..n * n).map(|k| edge(at(k % n), at(k / n))).sum::<f64>() * 4.0 / (n * n) as f64;
                let bound = Bound { sum: [[area; 2]; 3], range: [[0.0, 1.0]; 3], form: None };
                let (part, truth) = (weights.part(&bound)[0], sum(&kernel, around, edge));
                let coarse = 0.02 * region;
                assert!(part[0] - coarse <= truth && truth <= part[1] + coarse, "{filter:?} {i}: {part:?} {truth}");
                by_sum += (part[1] - part[0] < 0.5 * weights.size) as u32;
            }
            assert!(by_form > 350 && by_sum > 100, "{filter:?}: both say more than the range: {by_form} {by_sum}");
        }
    }

    #[test]
    fn first_regions_make_the_window() {
        for (filter, n) in [(PixelFilter::Box, 1), (PixelFilter::Mitchell, 16), (PixelFilter::Gauss, 9)] {
            let window = Window::new(Kernel::of(filter));
            let all: Vec<Weights> =
                window.first_regions([7, 9]).iter().map(|rect| window.weights([7, 9], *rect)).collect();
            assert_eq!(all.len(), n);
            let (whole, size) = all.iter().fold((0.0, 0.0), |(w, s), x| (w + x.whole, s + x.size));
            assert!((whole - 1.0).abs() < SLACK && (size - window.size()).abs() < SLACK, "{filter:?} {whole} {size}");
            assert_eq!(window.spanned([0.25, 0.75]) == [0.25, 0.75], window.size() == 1.0);
        }
    }

    #[test]
    fn samples_come_to_the_integral() {
        for filter in [PixelFilter::Mitchell, PixelFilter::Gauss] {
            let kernel = Kernel::of(filter).unwrap();
            let window = Window::new(Some(kernel));
            for (i, rect) in window.first_regions([0, 0]).into_iter().enumerate() {
                let weights = window.weights([0, 0], rect);
                let light = |x: f64, y: f64| 1.0 + 0.5 * x - 0.3 * y + x * y;
                let n = 64;
                let share = |k: usize| (k as f64 + 0.5) / n as f64;
                let spots = (0..n * n).map(|k| window.spot([0, 0], rect, [share(k % n), share(k / n)]));
                let mean = spots.map(|s| s.sign * light(s.inner[0], s.inner[1])).sum::<f64>() / (n * n) as f64;
                let around = rect.map(|x| x - 0.5);
                let truth = sum(&kernel, around, light);
                assert!((weights.size * mean - truth).abs() < 2e-4, "{filter:?} {i}: {} {truth}", weights.size * mean);
            }
        }
    }
}
