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
            return Dd::default();
        }
        match (self == Dd::ONE, o == Dd::ONE) {
            (_, true) => self,
            (true, _) => o,
            _ if self.lo == 0.0 && o.lo == 0.0 => {
                let (hi, lo) = two_prod(self.hi, o.hi);
                Dd::fast(hi, lo)
            }
            _ => product(self, o),
        }
    }
}
impl Div for Dd {
    type Output = Dd;
    fn div(self, o: Dd) -> Dd {
        if self.hi == 0.0 { Dd::default() } else { quotient(self, o) }
    }
}

fn sum(a: Dd, b: Dd) -> Dd {
    let (sh, sl) = two_sum(a.hi, b.hi);
    let (th, tl) = two_sum(a.lo, b.lo);
    let v = Dd::fast(sh, sl + th);
    Dd::fast(v.hi, tl + v.lo)
}

fn product(a: Dd, b: Dd) -> Dd {
    let (ch, cl) = two_prod(a.hi, b.hi);
    let t = f64::mul_add(a.hi, b.lo, a.lo * b.lo);
    let t = f64::mul_add(a.lo, b.hi, t);
    Dd::fast(ch, cl + t)
}

fn quotient(a: Dd, b: Dd) -> Dd {
    let q = a.hi / b.hi;
    let r = sum(a, -product(b, Dd::new(q)));
    let q2 = r.hi / b.hi;
    let r2 = sum(r, -product(b, Dd::new(q2)));
    let q3 = r2.hi / b.hi;
    sum(Dd::fast(q, q2), Dd::new(q3))
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
