//! Intervals: what a formula gives for all values of its inputs at once, rounding included. The instance of kernels that
//! proves something.
//!
//! Rust knows no rounding modes, so every bound is rounded to nearest and then moved one number outwards, unless the error is
//! known to be 0 or to lie on the inner side (Moore, *Interval Analysis*, 1966; Rump, Ogita, Morikura, Oishi, "Interval arithmetic with
//! fixed rounding mode", NOLTA 7(3), 2016). So an interval holds the exact value of a formula as well as what `f64` makes of it.

use super::real::{Real, Single};
use super::tri::Tri;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// All numbers from `lo` to `hi`; infinite bounds where nothing is known.
///
/// `MUTANT` is 0. Any other number up to [`MUTANTS`](Interval::MUTANTS) makes one bound of one operation two numbers too narrow: to
/// show that tests notice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval<const MUTANT: u8 = 0> {
    /// Lower bound.
    pub lo: f64,
    /// Upper bound.
    pub hi: f64,
}

// The large operations are calls: only checks compute with them, and kernels hold hundreds, which would take long to compile.

/// Operations whose bounds are rounded, as mutants count them: the lower bound is 2·op − 1, the upper 2·op.
const SUM: u8 = 1;
const PRODUCT: u8 = 2;
const QUOTIENT: u8 = 3;
const ROOT: u8 = 4;
const FUSED: u8 = 5;
const SUM_ERROR: u8 = 6;
const PRODUCT_ERROR: u8 = 7;

/// Below this, 2^-960, a product's error may itself be rounded away: such bounds are always moved.
const TINY: f64 = f64::from_bits((1023 - 960) << 52);

/// Cells in which the roots of a polynomial are looked for: a compromise of time and width.
const CELLS: usize = 64;

impl<const MUTANT: u8> Interval<MUTANT> {
    /// How many mutants there are.
    pub const MUTANTS: u8 = 2 * PRODUCT_ERROR;
    /// Every number.
    pub const ALL: Self = Interval { lo: f64::NEG_INFINITY, hi: f64::INFINITY };

    /// From `lo` to `hi`, in either order.
    pub fn new(lo: f64, hi: f64) -> Self {
        if lo <= hi { Interval { lo, hi } } else { Interval { lo: hi, hi: lo } }
    }
    /// Whether it holds `x`.
    pub fn contains(self, x: f64) -> bool {
        self.lo <= x && x <= self.hi
    }
    /// The smallest interval that holds both.
    pub fn hull(self, o: Self) -> Self {
        Interval { lo: smaller(self.lo, o.lo), hi: larger(self.hi, o.hi) }
    }

    /// Bounds of an operation's result, each rounded outwards already; NaN (∞ − ∞) becomes every number.
    #[inline(always)]
    fn bounds(op: u8, lo: f64, hi: f64) -> Self {
        let lo = if MUTANT == 2 * op - 1 { lo.next_up().next_up() } else { lo };
        let hi = if MUTANT == 2 * op { hi.next_down().next_down() } else { hi };
        Interval {
            lo: if lo.is_nan() { f64::NEG_INFINITY } else { lo },
            hi: if hi.is_nan() { f64::INFINITY } else { hi },
        }
    }
}

/// The smaller; a NaN gives way.
#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    if b < a || a.is_nan() { b } else { a }
}
/// The larger; a NaN gives way.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if b > a || a.is_nan() { b } else { a }
}

/// A result and its error, rounded down.
#[inline(always)]
fn down((x, error): (f64, f64)) -> f64 {
    if error >= 0.0 { x } else { x.next_down() }
}
/// A result and its error, rounded up.
#[inline(always)]
fn up((x, error): (f64, f64)) -> f64 {
    if error <= 0.0 { x } else { x.next_up() }
}

/// A product of bounds and its error, NaN where that isn't known. A bound of ∞ isn't a value: times 0 it is 0.
#[inline(always)]
fn product(a: f64, b: f64) -> (f64, f64) {
    if a == 0.0 || b == 0.0 {
        return (0.0, 0.0);
    }
    let (p, e) = a.two_prod(b);
    (p, if p.abs() < TINY { f64::NAN } else { e })
}

/// a·b + c, its error 0 or unknown.
#[inline(always)]
fn fused(a: f64, b: f64, c: f64) -> (f64, f64) {
    if a == 0.0 || b == 0.0 { (c, 0.0) } else { (a.mul_add(b, c), f64::NAN) }
}

/// Smallest, rounded down, and largest, rounded up, of what `f` makes of the four pairs of bounds.
#[inline(always)]
fn corners(a: [f64; 2], b: [f64; 2], f: impl Fn(f64, f64) -> (f64, f64)) -> (f64, f64) {
    let all = [f(a[0], b[0]), f(a[0], b[1]), f(a[1], b[0]), f(a[1], b[1])];
    let mut out = (down(all[0]), up(all[0]));
    for x in &all[1..] {
        out = (smaller(out.0, down(*x)), larger(out.1, up(*x)));
    }
    out
}

impl<const MUTANT: u8> Neg for Interval<MUTANT> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Interval { lo: -self.hi, hi: -self.lo }
    }
}
impl<const MUTANT: u8> Add for Interval<MUTANT> {
    type Output = Self;
    #[inline(never)]
    fn add(self, o: Self) -> Self {
        Self::bounds(SUM, down(self.lo.two_sum(o.lo)), up(self.hi.two_sum(o.hi)))
    }
}
impl<const MUTANT: u8> Sub for Interval<MUTANT> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}
impl<const MUTANT: u8> Mul for Interval<MUTANT> {
    type Output = Self;
    #[inline(never)]
    fn mul(self, o: Self) -> Self {
        let (lo, hi) = corners([self.lo, self.hi], [o.lo, o.hi], product);
        Self::bounds(PRODUCT, lo, hi)
    }
}
impl<const MUTANT: u8> Div for Interval<MUTANT> {
    type Output = Self;
    #[inline(never)]
    fn div(self, o: Self) -> Self {
        if o.contains(0.0) {
            return Self::ALL;
        }
        let quotient = |a: f64, b: f64| if a == 0.0 { (0.0, 0.0) } else { (a / b, f64::NAN) };
        let (lo, hi) = corners([self.lo, self.hi], [o.lo, o.hi], quotient);
        Self::bounds(QUOTIENT, lo, hi)
    }
}

impl<const MUTANT: u8> Real for Interval<MUTANT> {
    type Mask = Tri;
    type Single = Self;
    type Fine = Self;
    const UNIT_ROUNDOFF: f64 = <f64 as Real>::UNIT_ROUNDOFF;
    const LEAST: f64 = f64::MIN_POSITIVE;

    fn splat(x: f64) -> Self {
        Interval { lo: x, hi: x }
    }
    #[inline(never)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        let (lo, _) = corners([self.lo, self.hi], [b.lo, b.hi], |x, y| fused(x, y, c.lo));
        let (_, hi) = corners([self.lo, self.hi], [b.lo, b.hi], |x, y| fused(x, y, c.hi));
        Self::bounds(FUSED, lo, hi)
    }
    /// Of the part that isn't negative.
    fn sqrt(self) -> Self {
        if self.hi < 0.0 {
            return Interval { lo: 0.0, hi: f64::INFINITY };
        }
        let root = |x: f64| {
            let r = larger(x, 0.0).sqrt();
            (r, if r == 0.0 { 0.0 } else { f64::NAN })
        };
        let out = Self::bounds(ROOT, down(root(self.lo)), up(root(self.hi)));
        Interval { lo: larger(out.lo, 0.0), ..out }
    }
    fn floor(self) -> Self {
        Interval { lo: self.lo.floor(), hi: self.hi.floor() }
    }
    fn abs(self) -> Self {
        let (a, b) = (self.lo.abs(), self.hi.abs());
        Interval { lo: if self.contains(0.0) { 0.0 } else { smaller(a, b) }, hi: larger(a, b) }
    }
    fn copysign(self, sign: Self) -> Self {
        let size = self.abs();
        match (sign.lo > 0.0, sign.hi < 0.0) {
            (true, _) => size,
            (_, true) => -size,
            _ => size.hull(-size), // a 0 has either sign
        }
    }
    fn lt(self, o: Self) -> Tri {
        Tri { certain: self.hi < o.lo, possible: self.lo < o.hi }
    }
    fn le(self, o: Self) -> Tri {
        Tri { certain: self.hi <= o.lo, possible: self.lo <= o.hi }
    }
    fn same(self, o: Self) -> Tri {
        let certain = self.lo == self.hi && o.lo == o.hi && self.lo == o.lo;
        Tri { certain, possible: self.lo <= o.hi && o.lo <= self.hi }
    }
    fn select(m: Tri, a: Self, b: Self) -> Self {
        match m {
            Tri { certain: true, .. } => a,
            Tri { possible: false, .. } => b,
            _ => a.hull(b),
        }
    }
    fn each<const N: usize, const M: usize>(v: [Self; N], mut f: impl FnMut([Self; N]) -> [Self; M]) -> [Self; M] {
        f(v)
    }
    fn min(self, o: Self) -> Self {
        Interval { lo: smaller(self.lo, o.lo), hi: smaller(self.hi, o.hi) }
    }
    fn max(self, o: Self) -> Self {
        Interval { lo: larger(self.lo, o.lo), hi: larger(self.hi, o.hi) }
    }
    /// The error of exact arithmetic, 0, and that of `f64`, up to half an ulp of the sum.
    fn two_sum(self, o: Self) -> (Self, Self) {
        let s = self + o;
        (s, s.error(SUM_ERROR))
    }
    /// As [`two_sum`](Real::two_sum).
    fn two_prod(self, o: Self) -> (Self, Self) {
        let p = self * o;
        (p, p.error(PRODUCT_ERROR))
    }
    /// The plain form. Kahan's rounds the second product, the difference and the sum with what the product left out: the
    /// last is below half an ulp of the product, so it takes no result past the bounds of the first two.
    fn difference_of_products(self, b: Self, c: Self, d: Self) -> Self {
        self * b - c * d
    }
}

impl<const MUTANT: u8> Interval<MUTANT> {
    /// What rounding may leave out of a result in this interval.
    fn error(self, op: u8) -> Self {
        let size = Single::magnitude(self);
        if size == 0.0 {
            return Self::splat(0.0);
        }
        // Half an ulp of the largest power of two in reach, which is no more than a unit of roundoff of `size`.
        let e = size * Self::UNIT_ROUNDOFF;
        Self::bounds(op, -e, e)
    }

    /// Value of a polynomial, highest coefficient first.
    fn horner(poly: &[Self], x: Self) -> Self {
        poly[1..].iter().fold(poly[0], |y, &c| y * x + c)
    }
}

impl<const MUTANT: u8> Single for Interval<MUTANT> {
    fn magnitude(self) -> f64 {
        larger(self.lo.abs(), self.hi.abs())
    }

    /// Cells in which the polynomial can't be shown to have a sign, joined where they touch.
    fn enclosed_roots(poly: &[Self], span: Self) -> Option<[(Self, Self); 4]> {
        let (zero, one) = (Self::splat(0.0), Self::splat(1.0));
        let reach = span.hi.next_up();
        let border = |k: usize| (2.0 * k as f64 / CELLS as f64 - 1.0) * reach;
        let sign_at = |k: usize| {
            let y = Self::horner(poly, Self::splat(border(k)));
            (y.lo > 0.0) as i8 - (y.hi < 0.0) as i8
        };
        let may_vanish = |k: usize| Self::horner(poly, Interval::new(border(k), border(k + 1))).contains(0.0);
        // Numbers find their roots to a few roundings of the span; sixteen hold them.
        let margin = reach * (16.0 * Self::UNIT_ROUNDOFF);
        let mut out = [(zero, zero); 4];
        let (mut n, mut k) = (0, 0);
        while k < CELLS {
            if !may_vanish(k) {
                k += 1;
                continue;
            }
            let first = k;
            // The last place takes all that is left.
            let end = |k: usize| k == CELLS || (n < 3 && !may_vanish(k));
            while !end(k) {
                k += 1;
            }
            let within = Interval::new(border(first) - margin, border(k) + margin);
            let odd = sign_at(first) * sign_at(k) < 0;
            out[n] = (within, if odd { one } else { Interval::new(0.0, 1.0) });
            n += 1;
        }
        Some(out)
    }
}
