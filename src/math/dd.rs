//! Double-double numbers: an unevaluated sum hi + lo of two `f64`, about 106 bits. Transforms are composed in them when
//! the world is built and rounded once, so that a chain of groups costs no accuracy.
//!
//! Algorithms: Joldes, Muller, Popescu, "Tight and rigorous error bounds for basic building blocks of double-word
//! arithmetic", ACM TOMS 44, 2017 (AccurateDWPlusDW, DWTimesDW3, DWDivDW2).

use super::real::{two_prod, two_sum};
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
impl Add for Dd {
    type Output = Dd;
    fn add(self, o: Dd) -> Dd {
        let (sh, sl) = two_sum(self.hi, o.hi);
        let (th, tl) = two_sum(self.lo, o.lo);
        let v = Dd::fast(sh, sl + th);
        Dd::fast(v.hi, tl + v.lo)
    }
}
impl Sub for Dd {
    type Output = Dd;
    fn sub(self, o: Dd) -> Dd {
        self + -o
    }
}
impl Mul for Dd {
    type Output = Dd;
    fn mul(self, o: Dd) -> Dd {
        let (ch, cl) = two_prod(self.hi, o.hi);
        let t = f64::mul_add(self.hi, o.lo, self.lo * o.lo);
        let t = f64::mul_add(self.lo, o.hi, t);
        Dd::fast(ch, cl + t)
    }
}
impl Div for Dd {
    type Output = Dd;
    fn div(self, o: Dd) -> Dd {
        let q = self.hi / o.hi;
        let r = self - o * Dd::new(q);
        let q2 = r.hi / o.hi;
        let r2 = r - o * Dd::new(q2);
        let q3 = r2.hi / o.hi;
        Dd::fast(q, q2) + Dd::new(q3)
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
}
