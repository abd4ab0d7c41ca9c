//! Convex parts of a region: its square, clipped where something changes.
//!
//! A region has coordinates ξ and η from −1 to 1. Where a test g ≥ 0 is undecided, its linear part cuts the polygon in two; what
//! the cut can't tell apart, the strip |g| ≤ r, belongs to both, and its area is charged by whoever cuts.

use super::super::bounds::{larger, smaller};
use crate::math::Form;
use std::cell::OnceCell;

/// Most corners: 4, and one more for every cut; further cuts aren't made.
const MOST: usize = 20;

/// By how much the area of a polygon within the square, or one of its first moments, may be off: some 100 roundings of numbers up to
/// 4, generously.
pub const AREA_ERROR: f64 = 1.0 / (1u64 << 42) as f64;

/// How much further than the strip a cut is moved, relative to the size of g: far more than the rounding of g at a corner, or of a
/// corner's place.
const CUT_MARGIN: f64 = 1.0 / (1u64 << 46) as f64;

/// A convex polygon within the region's square, counter-clockwise.
#[derive(Clone, Debug)]
pub struct Polygon {
    n: usize,
    v: [[f64; 2]; MOST],
    /// Whether it is all of the square: then nothing need go round its corners.
    whole: bool,
    /// Once they were asked for: they are, again and again.
    moments: OnceCell<Moments>,
}

/// Area and first moments.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// Integral of 1.
    pub area: f64,
    /// Integral of ξ.
    pub x: f64,
    /// Integral of η.
    pub y: f64,
}

impl Polygon {
    /// All of the region.
    pub fn square() -> Polygon {
        let mut v = [[0.0; 2]; MOST];
        (v[0], v[1], v[2], v[3]) = ([-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]);
        let moments = Moments { area: 4.0, x: 0.0, y: 0.0 };
        Polygon { n: 4, v, whole: true, moments: OnceCell::from(moments) }
    }

    /// Nothing.
    pub fn empty() -> Polygon {
        Polygon { n: 0, v: [[0.0; 2]; MOST], whole: false, moments: OnceCell::new() }
    }

    /// Its corners.
    pub fn corners(&self) -> &[[f64; 2]] {
        &self.v[..self.n]
    }

    /// Whether nothing is left.
    pub fn is_empty(&self) -> bool {
        self.n < 3
    }

    /// Whether it has all the corners that there is room for.
    pub fn is_full(&self) -> bool {
        self.n >= MOST - 1
    }

    /// Lower and upper bound of a form on it.
    #[inline]
    pub fn range(&self, f: Form) -> (f64, f64) {
        let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
        if self.whole {
            // Rounding knows no sign: that is what the four corners give, to the bit.
            hi = f.x.abs() + f.y.abs();
            lo = -hi;
        } else {
            for [x, y] in self.corners() {
                let linear = f.x * x + f.y * y;
                (lo, hi) = (smaller(lo, linear), larger(hi, linear));
            }
        }
        // Two products and two sums here, two sums more below.
        let slack = 8.0 * f64::EPSILON * (f.c.abs() + f.x.abs() + f.y.abs());
        let (lo, hi) = (f.c + lo - f.r - slack, f.c + hi + f.r + slack);
        if f.is_known() && self.n > 0 { (lo, hi) } else { (f64::NEG_INFINITY, f64::INFINITY) }
    }

    /// The part where the form may be 0 or more: all of it, by a wide margin over rounding.
    pub fn clipped(&self, g: Form) -> Polygon {
        let mut out = Polygon::empty();
        self.clip(g, &mut out);
        out
    }

    /// The same, written over `out`: who cuts again and again needs no room for each cut.
    pub fn clip(&self, g: Form, out: &mut Polygon) {
        let margin = CUT_MARGIN * (g.c.abs() + g.x.abs() + g.y.abs() + g.r);
        let c = g.c + g.r + margin;
        let height = |p: [f64; 2]| c + (g.x * p[0] + g.y * p[1]);
        (out.n, out.whole, out.moments) = (0, false, OnceCell::new());
        let Some(&last) = self.corners().last() else { return };
        let (mut a, mut ga) = (last, height(last));
        for &b in self.corners() {
            let gb = height(b);
            if (ga >= 0.0) != (gb >= 0.0) {
                let t = ga / (ga - gb);
                out.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
            }
            if gb >= 0.0 {
                out.push(b);
            }
            (a, ga) = (b, gb);
        }
        if out.n < 3 {
            out.n = 0;
        }
    }

    fn push(&mut self, p: [f64; 2]) {
        if let Some(free) = self.v.get_mut(self.n) {
            *free = p;
            self.n += 1;
        }
    }

    /// Area and first moments, each off by up to [`AREA_ERROR`].
    #[inline]
    pub fn moments(&self) -> Moments {
        *self.moments.get_or_init(|| self.integrated())
    }

    fn integrated(&self) -> Moments {
        let mut m = Moments::default();
        if self.is_empty() {
            return m;
        }
        let a = self.v[0];
        for pair in self.v[1..self.n].windows(2) {
            let (b, c) = (pair[0], pair[1]);
            let t = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
            m.area += t;
            m.x += t * (a[0] + b[0] + c[0]) / 3.0;
            m.y += t * (a[1] + b[1] + c[1]) / 3.0;
        }
        m
    }

    /// Its area, off by up to [`AREA_ERROR`].
    pub fn area(&self) -> f64 {
        self.moments().area
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::hash::KeyedHash;

    fn random(i: u64, k: u64) -> f64 {
        KeyedHash::new().with(i).with(k).unit() * 2.0 - 1.0
    }

    #[test]
    fn the_square_is_as_its_corners_say() {
        let square = Polygon::square();
        let same = Polygon { whole: false, moments: OnceCell::new(), ..square.clone() };
        assert_eq!(square.moments(), same.moments());
        for i in 0..3_000 {
            let [c, x, y] = [0, 1, 2].map(|k| random(i, k) * if i % 7 == k { 0.0 } else { 1.0 });
            let f = Form { c, x, y, r: random(i, 3).abs() };
            assert_eq!(square.range(f), same.range(f), "case {i}");
        }
        assert_eq!(square.range(Form::ALL), same.range(Form::ALL));
    }

    #[test]
    fn moments_of_a_triangle() {
        let half = Polygon::square().clipped(Form { c: 0.0, x: 1.0, y: 1.0, r: 0.0 });
        let m = half.moments();
        assert!((m.area - 2.0).abs() < 1e-12 && (m.x - 2.0 / 3.0).abs() < 1e-12 && (m.y - 2.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn every_point_where_the_form_may_be_positive_stays() {
        let (mut inside, mut outside) = (0, 0);
        for i in 0..3_000 {
            let mut p = Polygon::square();
            let cuts: Vec<Form> = (0..4)
                .map(|k| Form {
                    c: random(i, k),
                    x: random(i, 10 + k),
                    y: random(i, 20 + k),
                    r: random(i, 30 + k).abs() * 0.1,
                })
                .collect();
            for g in &cuts {
                p = p.clipped(*g);
            }
            for k in 0..50 {
                let at = [random(i, 100 + 2 * k), random(i, 101 + 2 * k)];
                let may = cuts.iter().all(|g| g.c + g.x * at[0] + g.y * at[1] + g.r >= 0.0);
                // Left of every edge.
                let corners = p.corners();
                let is_in = !corners.is_empty()
                    && (0..corners.len()).all(|e| {
                        let (a, b) = (corners[e], corners[(e + 1) % corners.len()]);
                        (b[0] - a[0]) * (at[1] - a[1]) - (b[1] - a[1]) * (at[0] - a[0]) >= -1e-13
                    });
                assert!(!may || is_in, "case {i}: {at:?}");
                if is_in {
                    inside += 1
                } else {
                    outside += 1
                }
                let f = Form { c: 1.0, x: random(i, 50), y: random(i, 51), r: 0.0 };
                let (lo, hi) = p.range(f);
                let v = f.c + f.x * at[0] + f.y * at[1];
                assert!(!is_in || (lo <= v + 1e-12 && v - 1e-12 <= hi));
            }
        }
        assert!(inside > 1_000 && outside > 1_000, "{inside} {outside}");
    }

    #[test]
    fn both_sides_of_a_cut_and_the_strip_make_the_whole() {
        for i in 0..2_000 {
            let g = Form { c: random(i, 0) * 0.5, x: random(i, 1), y: random(i, 2), r: 0.0 };
            let p = Polygon::square().clipped(Form { c: 0.8, x: random(i, 3), y: random(i, 4), r: 0.0 });
            let both = p.clipped(g).area() + p.clipped(-g).area();
            assert!(both >= p.area() - AREA_ERROR && both <= p.area() + 1e-11, "case {i}");
        }
    }
}
