//! The mean of a checker over a region with many of its cells, in closed form: near the horizon there are more than can be
//! counted.
//!
//! Seen from one point, a flat checker's coordinates are quotients of linear functions of ξ and η. Where the denominator w and one
//! of the coordinates, v, depend on η alone (a camera that isn't rolled), the mean over ξ of the other one's parity is
//! (S(b) − S(a))/(b − a), S being the integral of the square wave: a triangle wave. As a function of z = 1/w all of a, b and v
//! are straight, so from one break of a wave to the next the integral over η is elementary. Far out, where breaks are too many,
//! |S(b) − S(a)| ≤ 1 bounds the rest.

use super::super::bounds::{larger, smaller};
use super::polygon::{AREA_ERROR, Polygon};
use crate::math::Form;

/// Most pieces between breaks that are added up.
const MOST_PIECES: usize = 4000;

/// Parity over a polygon: +1 on even cells, −1 on odd ones; each within ±`off`.
#[derive(Clone, Copy, Debug)]
pub struct Parity {
    /// Its integral.
    pub sum: f64,
    /// Its first moment in η.
    pub eta: f64,
    /// How far both may be off.
    pub off: f64,
}

/// A coordinate along the region's left or right border, or of the rows: start + rate·z.
#[derive(Clone, Copy)]
struct Along {
    start: f64,
    rate: f64,
}

impl Along {
    /// Of (c + y·η)/(w·size) with w = w.c + w.y·η.
    fn new(c: f64, y: f64, w: Form) -> Along {
        let start = y / w.y;
        Along { start, rate: c - start * w.c }
    }
    fn at(self, z: f64) -> f64 {
        self.start + self.rate * z
    }
    /// The next break beyond z, where it becomes whole again, if the whole number below is `k`.
    fn next(self, k: f64) -> f64 {
        let to = if self.rate > 0.0 { k + 1.0 } else { k };
        if self.rate == 0.0 { f64::INFINITY } else { (to - self.start) / self.rate }
    }
    fn step(self) -> f64 {
        if self.rate > 0.0 { 1.0 } else { -1.0 }
    }
    /// The triangle wave as a straight line in z, where the whole number below is `k`.
    fn wave(self, k: f64) -> (f64, f64) {
        if is_even(k) { (self.start - k, self.rate) } else { (k + 1.0 - self.start, -self.rate) }
    }
}

fn is_even(k: f64) -> bool {
    (0.5 * k).floor() * 2.0 == k
}

/// The parity of ⌊u/w⌋ + ⌊v/w⌋ over `p`; `None` where the closed form doesn't apply.
pub fn parity(p: &Polygon, u: Form, v: Form, w: Form) -> Option<Parity> {
    let [top, bottom] = band(p)?;
    // What isn't straight, or varies along ξ where it mustn't.
    let stray = [u.r, v.r + v.x.abs(), w.r + w.x.abs()];
    let (w_top, w_bottom) = (w.c + w.y * top, w.c + w.y * bottom);
    let (near, far) = (larger(w_top, w_bottom), larger(smaller(w_top, w_bottom), 0.0));
    if !(near > 0.0) || w.y == 0.0 || u.x == 0.0 || !(stray[2] < near * RELATIVE) {
        return None;
    }
    let edges = [Along::new(u.c - u.x, u.y, w), Along::new(u.c + u.x, u.y, w)];
    let rows = Along::new(v.c, v.y, w);
    let (first, last) = (1.0 / near, if far > 0.0 { 1.0 / far } else { f64::INFINITY });
    // dη = dz/(z²·|w.y|), and the mean over ξ is (S(b) − S(a))/(2·u.x·z), over a width of 2.
    let factor = 1.0 / (u.x.abs() * w.y.abs());
    let turn = if u.x > 0.0 { 1.0 } else { -1.0 };
    // Further out, what is charged for strays would grow beyond the rest.
    let end = smaller(last, RELATIVE / larger(stray[2], f64::MIN_POSITIVE));
    let mut z = first;
    let mut k = [edges[0].at(z).floor(), edges[1].at(z).floor(), rows.at(z).floor()];
    let waves = [edges[0], edges[1], rows];
    // ∫ s·(S(b) − S(a))·z^-3 and ∫ … z^-4.
    let (mut cubes, mut fourths, mut off) = (0.0, 0.0, 0.0);
    for _ in 0..MOST_PIECES {
        if z >= end {
            break;
        }
        let breaks = [waves[0].next(k[0]), waves[1].next(k[1]), waves[2].next(k[2])];
        let to = smaller(smaller(breaks[0], breaks[1]), smaller(breaks[2], end));
        let to = larger(to, z);
        let ((c0, d0), (c1, d1)) = (edges[0].wave(k[0]), edges[1].wave(k[1]));
        let (c, d) = (c1 - c0, d1 - d0);
        let (i, j) = (1.0 / z, 1.0 / to);
        let sign = if is_even(k[2]) { 1.0 } else { -1.0 };
        cubes += sign * (0.5 * c * (i * i - j * j) + d * (i - j));
        fourths += sign * (c / 3.0 * (i * i * i - j * j * j) + 0.5 * d * (i * i - j * j));
        // Every border of a piece may lie elsewhere by what rounding and strays move it, relatively; S changes as fast as that.
        let moved = ROUNDING + (stray[0] + stray[1]) / (u.c.abs() + u.x.abs() + v.c.abs()) + stray[2] * to;
        let size = 1.0 + c.abs() + d.abs() * to + rows.start.abs() + (rows.rate * to).abs();
        off += 4.0 * moved * size * i * i;
        for (n, b) in breaks.iter().enumerate() {
            if *b <= to {
                k[n] += waves[n].step();
            }
        }
        z = to;
    }
    let mut rest = 0.0;
    if z < last {
        let j = if last < f64::INFINITY { 1.0 / last } else { 0.0 };
        rest = 0.5 * (1.0 / (z * z) - j * j);
    }
    // η = (1/z − w.c)/w.y.
    let sum = factor * turn * cubes;
    let eta = (factor * turn * fourths - w.c * sum) / w.y;
    // The moment's error: that of both sums it is made of. Of what isn't added up, |η| ≤ 1.
    let off = factor * (off * (1.0 + (near + w.c.abs()) / w.y.abs()) + rest) + 4.0 * AREA_ERROR + beyond(p, w);
    Some(Parity { sum, eta, off })
}

/// Relative error of borders from rounding: thousands of roundings.
const ROUNDING: f64 = 1.0 / (1u64 << 40) as f64;

/// What may be stray, relatively.
const RELATIVE: f64 = 1.0 / (1u64 << 24) as f64;

/// Where the polygon is all of the region's width: its top and bottom.
fn band(p: &Polygon) -> Option<[f64; 2]> {
    let corners = p.corners();
    if corners.len() != 4 || !corners.iter().all(|v| v[0].abs() == 1.0) {
        return None;
    }
    let lo = corners.iter().fold(1.0, |m, v| smaller(m, v[1]));
    let hi = corners.iter().fold(-1.0, |m, v| larger(m, v[1]));
    // Two corners at each end, but for rounding.
    let close = |v: &[f64; 2]| smaller((v[1] - lo).abs(), (v[1] - hi).abs()) < AREA_ERROR;
    corners.iter().all(close).then_some([lo, hi])
}

/// The area of the part beyond the horizon, which only a cut's margin lets in.
fn beyond(p: &Polygon, w: Form) -> f64 {
    p.clipped(Form { c: -w.c, x: 0.0, y: -w.y, r: 0.0 }).area()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::hash::KeyedHash;

    #[test]
    fn means_are_those_of_many_points() {
        for case in 0..40u64 {
            let random = |k: u64| KeyedHash::new().with(case).with(k).unit();
            // A floor seen a little below the horizon, in regions of many cells.
            let low = 0.002 + 0.05 * random(0);
            let w = Form { c: low, x: 0.0, y: low * (0.2 + 0.8 * random(1)), r: 0.0 };
            let u = Form { c: random(2) - 0.5, x: 0.05 * (random(3) - 0.5), y: 0.0, r: 0.0 };
            let v = Form { c: 0.3 + random(4), x: 0.0, y: 0.001 * random(5), r: 0.0 };
            let square = Polygon::square();
            let found = parity(&square, u, v, w).expect("applies");
            let n = 1000;
            let (mut sum, mut eta) = (0.0, 0.0);
            for i in 0..n * n {
                let at = |k: u64| 2.0 * k as f64 / n as f64 - 1.0;
                let jitter = |k: u64| 2.0 * KeyedHash::new().with(i).with(k).unit() / n as f64;
                let (x, y) = (at(i % n) + jitter(0), at(i / n) + jitter(1));
                let of = |f: Form| f.c + f.x * x + f.y * y;
                let s = if is_even((of(u) / of(w)).floor() + (of(v) / of(w)).floor()) { 1.0 } else { -1.0 };
                (sum, eta) = (sum + s * 4.0 / (n * n) as f64, eta + y * s * 4.0 / (n * n) as f64);
            }
            // 4/√n is what independent points would be off by; strata leave a fraction of that.
            let noise = 0.012;
            assert!((sum - found.sum).abs() < noise + found.off, "case {case}: {sum} and {found:?}");
            assert!((eta - found.eta).abs() < noise + found.off, "case {case}: {eta} and {found:?}");
            assert!(found.off < 0.01, "case {case}: {found:?}");
        }
    }
}
