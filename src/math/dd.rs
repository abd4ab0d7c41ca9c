//! Double-double numbers: an unevaluated sum hi + lo of two `f64`, about 106 bits. Transforms are composed in them when
//! the world is built and rounded once, so that a chain of groups costs no accuracy. As a [`Real`] they decide what hangs on
//! the last bits of an `f64`, and are the yardstick of kernels.
//!
//! Algorithms: Joldes, Muller, Popescu, "Tight and rigorous error bounds for basic building blocks of double-word
//! arithmetic", ACM TOMS 44, 2017 (AccurateDWPlusDW, DWTimesDW3, DWDivDW2); root: Lefèvre, Louvet, Muller, Picot, Rideau,
//! "Accurate calculation of Euclidean norms using double-word arithmetic", ACM TOMS 49, 2023 (SQRTDWtoDW).

use super::real::{Bool, Real, Single};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// hi + lo with |lo| at most half an ulp of hi.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dd {
    /// The value rounded to `f64`.
    pub hi: f64,
    /// What `hi` misses.
    pub lo: f64,
}

impl Dd {
    /// The exact value of `x`.
    pub const fn new(x: f64) -> Dd {
        Dd { hi: x, lo: 0.0 }
    }
    /// Exactly 1.
    pub const ONE: Dd = Dd::new(1.0);
    /// Rounded to `f64`.
    pub fn round(self) -> f64 {
        self.hi
    }
    fn fast(a: f64, b: f64) -> Dd {
        let hi = a + b;
        Dd { hi, lo: b - (hi - a) }
    }
}

impl Neg for Dd {
    type Output = Dd;
    fn neg(self) -> Dd {
        Dd { hi: -self.hi, lo: -self.lo }
    }
}

// Most entries of most maps are 0 or 1 and most others plain numbers, and a fused multiply-add may be a call. So the
// operators leave out steps that can't change a bit.

impl Add for Dd {
    type Output = Dd;
    #[inline]
    fn add(self, o: Dd) -> Dd {
        match (self.hi == 0.0, o.hi == 0.0) {
            (false, true) => self,
            (true, false) => o,
            _ => sum(self, o),
        }
    }
}
impl Sub for Dd {
    type Output = Dd;
    #[inline]
    fn sub(self, o: Dd) -> Dd {
        self + -o
    }
}
impl Mul for Dd {
    type Output = Dd;
    #[inline]
    fn mul(self, o: Dd) -> Dd {
        if self.hi == 0.0 || o.hi == 0.0 {
            return Dd::new(if self.hi.is_finite() && o.hi.is_finite() { 0.0 } else { f64::NAN });
        }
        match (self == Dd::ONE, o == Dd::ONE) {
            (_, true) => self,
            (true, _) => o,
            _ if self.lo == 0.0 && o.lo == 0.0 => {
                let (hi, lo) = self.hi.two_prod(o.hi);
                Dd::fast(hi, lo)
            }
            _ => product(self, o),
        }
    }
}
impl Div for Dd {
    type Output = Dd;
    fn div(self, o: Dd) -> Dd {
        if self.hi == 0.0 && o.hi.abs() > 0.0 { Dd::default() } else { quotient(self, o) }
    }
}

// What isn't finite has no low part: that would be NaN, and so would be all that is made from it.

fn sum(a: Dd, b: Dd) -> Dd {
    let (sh, sl) = a.hi.two_sum(b.hi);
    if !sh.is_finite() {
        return Dd::new(sh);
    }
    let (th, tl) = a.lo.two_sum(b.lo);
    let v = Dd::fast(sh, sl + th);
    Dd::fast(v.hi, tl + v.lo)
}

fn product(a: Dd, b: Dd) -> Dd {
    let (ch, cl) = a.hi.two_prod(b.hi);
    if !ch.is_finite() {
        return Dd::new(ch);
    }
    let t = f64::mul_add(a.hi, b.lo, a.lo * b.lo);
    let t = f64::mul_add(a.lo, b.hi, t);
    Dd::fast(ch, cl + t)
}

fn quotient(a: Dd, b: Dd) -> Dd {
    let q = a.hi / b.hi;
    if !q.is_finite() || !b.hi.is_finite() {
        return Dd::new(q);
    }
    let r = sum(a, -product(b, Dd::new(q)));
    let q2 = r.hi / b.hi;
    let r2 = sum(r, -product(b, Dd::new(q2)));
    let q3 = r2.hi / b.hi;
    sum(Dd::fast(q, q2), Dd::new(q3))
}

impl Real for Dd {
    type Mask = Bool;
    type Single = Dd;
    type Fine = Dd;
    /// 2^-104: a little above the largest relative error of the operations here.
    const UNIT_ROUNDOFF: f64 = f64::EPSILON * f64::EPSILON;
    const LEAST: f64 = f64::MIN_POSITIVE;

    fn splat(x: f64) -> Dd {
        Dd::new(x)
    }
    fn mul_add(self, b: Dd, c: Dd) -> Dd {
        self * b + c
    }
    fn sqrt(self) -> Dd {
        let s = f64::sqrt(self.hi);
        if !(s > 0.0) || !s.is_finite() {
            return Dd::new(s);
        }
        let rest = f64::mul_add(-s, s, self.hi) + self.lo;
        Dd::fast(s, rest / (2.0 * s))
    }
    fn floor(self) -> Dd {
        let hi = self.hi.floor();
        if hi == self.hi { Dd::fast(hi, self.lo.floor()) } else { Dd::new(hi) }
    }
    fn abs(self) -> Dd {
        if self.hi.is_sign_negative() { -self } else { self }
    }
    fn copysign(self, sign: Dd) -> Dd {
        if self.hi.is_sign_negative() == sign.hi.is_sign_negative() { self } else { -self }
    }
    fn lt(self, o: Dd) -> Bool {
        Bool(self.hi < o.hi || (self.hi == o.hi && self.lo < o.lo))
    }
    fn le(self, o: Dd) -> Bool {
        Bool(self.hi < o.hi || (self.hi == o.hi && self.lo <= o.lo))
    }
    fn same(self, o: Dd) -> Bool {
        Bool(self.hi == o.hi && self.lo == o.lo)
    }
    fn select(m: Bool, a: Dd, b: Dd) -> Dd {
        if m.0 { a } else { b }
    }
    fn each<const N: usize, const M: usize>(v: [Dd; N], mut f: impl FnMut([Dd; N]) -> [Dd; M]) -> [Dd; M] {
        f(v)
    }
    fn two_sum(self, o: Dd) -> (Dd, Dd) {
        (self + o, Dd::default())
    }
    fn two_prod(self, o: Dd) -> (Dd, Dd) {
        (self * o, Dd::default())
    }
    fn difference_of_products(self, b: Dd, c: Dd, d: Dd) -> Dd {
        self * b - c * d
    }
}

impl Single for Dd {
    fn magnitude(self) -> f64 {
        self.hi.abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_third_three_times_is_one() {
        let third = Dd::new(1.0) / Dd::new(3.0);
        let back = third * Dd::new(3.0) - Dd::new(1.0);
        assert!(back.hi.abs() < 1e-31, "{back:?}");
        assert!((1.0f64 / 3.0 - third.hi).abs() == 0.0 && third.lo != 0.0);
    }

    #[test]
    fn sums_keep_what_f64_drops() {
        let x = Dd::new(1e20) + Dd::new(1.0) - Dd::new(1e20);
        assert_eq!(x, Dd::new(1.0));
    }

    #[test]
    fn roots_are_as_exact_as_products() {
        for x in [2.0, 1e-130, 7e99, 0.3] {
            let root = (Dd::new(x) / Dd::new(3.0)).sqrt();
            let off = (root * root * Dd::new(3.0) - Dd::new(x)).hi / x;
            assert!(off.abs() < 1e-31, "{x}: {off}");
        }
        assert_eq!(Dd::default().sqrt(), Dd::default());
        assert!(Dd::new(-1.0).sqrt().hi.is_nan());
    }

    #[test]
    fn order_and_floor_look_at_both_parts() {
        let (three, tiny) = (Dd::new(3.0), Dd::new(1e-20));
        assert!((three - tiny).lt(three).0 && !three.lt(three - tiny).0 && three.le(three).0);
        assert_eq!((three - tiny).floor(), Dd::new(2.0));
        assert_eq!((tiny - three).abs(), three - tiny);
    }

    #[test]
    fn what_is_left_out_changes_no_bit() {
        let some = [0.0, -0.0, 1.0, -1.0, 2.0, 0.1, -3.7, 1e-130, -1e130, 1.0 / 3.0].map(Dd::new);
        let third = quotient(Dd::new(1.0), Dd::new(3.0));
        let all: Vec<Dd> = some.into_iter().chain([third, -third, product(third, Dd::new(1e100))]).collect();
        // The sign of a low part that is 0 is never read.
        let bits = |x: Dd| (x.hi.to_bits(), (x.lo + 0.0).to_bits());
        for &a in &all {
            for &b in &all {
                assert_eq!(bits(a + b), bits(sum(a, b)), "{a:?} + {b:?}");
                assert_eq!(bits(a * b), bits(product(a, b)), "{a:?} * {b:?}");
                if b.hi != 0.0 {
                    assert_eq!(bits(a / b), bits(quotient(a, b)), "{a:?} / {b:?}");
                }
            }
        }
    }
}
