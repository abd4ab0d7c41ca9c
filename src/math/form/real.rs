//! Forms as [`Real`]: the renderer's own formulas run on them unchanged. Branches that not all of the region takes give what
//! holds either; where that is too wide, the caller asks by [`Tri`] and cuts the region at the branch.

use super::{Form, PRODUCT, SUM, U};
use crate::math::real::{Real, Single};
use crate::math::tri::Tri;
use std::ops::{Add, Div, Mul, Neg, Sub};

impl<const MUTANT: u8> Neg for Form<MUTANT> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Form { c: -self.c, x: -self.x, y: -self.y, r: self.r }
    }
}

impl<const MUTANT: u8> Add for Form<MUTANT> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        let [c, x, y] = [self.c + o.c, self.x + o.x, self.y + o.y];
        // Adding 0 rounds nothing.
        let none = |a: f64, b: f64| a == 0.0 || b == 0.0;
        let rounded = |a: f64, b: f64, sum: f64| if none(a, b) { 0.0 } else { sum.abs() };
        let sizes = rounded(self.c, o.c, c) + rounded(self.x, o.x, x) + rounded(self.y, o.y, y);
        Self::made(SUM, [c, x, y], self.r + o.r, sizes)
    }
}

impl<const MUTANT: u8> Sub for Form<MUTANT> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl<const MUTANT: u8> Form<MUTANT> {
    /// `s` times self.
    #[inline(always)]
    pub fn times(self, s: f64) -> Self {
        if s == 1.0 || s == -1.0 {
            return if s > 0.0 { self } else { -self };
        }
        if (s == 0.0 && self.is_known()) || self == Self::constant(0.0) {
            return Self::constant(0.0);
        }
        let [c, x, y] = [self.c * s, self.x * s, self.y * s];
        Self::made(PRODUCT, [c, x, y], self.r * s.abs(), c.abs() + x.abs() + y.abs())
    }
}

impl<const MUTANT: u8> Mul for Form<MUTANT> {
    type Output = Self;
    /// The product of both linear parts is xx'ξ² + yy'η² + (xy' + yx')ξη; squares lie between 0 and 1, ½ ± ½.
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        if o.is_constant() {
            return self.times(o.c);
        }
        if self.is_constant() {
            return o.times(self.c);
        }
        let (xx, yy) = (self.x * o.x, self.y * o.y);
        let (xy, yx) = (self.x * o.y, self.y * o.x);
        let (cc, cx, xc, cy, yc) = (self.c * o.c, self.c * o.x, self.x * o.c, self.c * o.y, self.y * o.c);
        let (ca, cb) = (self.c.abs(), o.c.abs());
        let (la, lb) = (self.x.abs() + self.y.abs(), o.x.abs() + o.y.abs());
        let squares = 0.5 * (xx.abs() + yy.abs());
        let remainder = squares + (xy + yx).abs() + (ca + la) * o.r + (cb + lb) * self.r + self.r * o.r;
        let sizes = 4.0 * (cc.abs() + squares)
            + 3.0 * (cx.abs() + xc.abs() + cy.abs() + yc.abs())
            + 2.0 * (xy.abs() + yx.abs());
        Self::made(PRODUCT, [cc + 0.5 * (xx + yy), cx + xc, cy + yc], remainder, sizes)
    }
}

impl<const MUTANT: u8> Div for Form<MUTANT> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        Mul::mul(self, o.reciprocal())
    }
}

impl<const MUTANT: u8> Real for Form<MUTANT> {
    type Mask = Tri;
    type Single = Self;
    type Fine = Self;
    const UNIT_ROUNDOFF: f64 = U;
    const LEAST: f64 = f64::MIN_POSITIVE;

    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self::constant(x)
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }
    fn sqrt(self) -> Self {
        self.root_within(0.0, f64::INFINITY)
    }
    fn floor(self) -> Self {
        let (lo, hi) = (self.lo().floor(), self.hi().floor());
        if lo == hi { Self::constant(lo) } else { Self::between(lo, hi) }
    }
    fn abs(self) -> Self {
        if self.lo() >= 0.0 {
            self
        } else if self.hi() <= 0.0 {
            -self
        } else {
            self.positive_part() + (-self).positive_part()
        }
    }
    fn copysign(self, sign: Self) -> Self {
        let size = self.abs();
        match (sign.lo() > 0.0, sign.hi() < 0.0) {
            (true, _) => size,
            (_, true) => -size,
            _ => size.hull(-size), // a 0 has either sign
        }
    }
    /// By the difference: quantities that vary together are told apart.
    fn lt(self, o: Self) -> Tri {
        let d = o - self;
        Tri { certain: d.lo() > 0.0, possible: d.hi() > 0.0 }
    }
    fn le(self, o: Self) -> Tri {
        let d = o - self;
        Tri { certain: d.lo() >= 0.0, possible: d.hi() >= 0.0 }
    }
    fn same(self, o: Self) -> Tri {
        let d = o - self;
        let (lo, hi) = (d.lo(), d.hi());
        Tri { certain: lo == 0.0 && hi == 0.0, possible: lo <= 0.0 && hi >= 0.0 }
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
        self - (self - o).positive_part()
    }
    fn max(self, o: Self) -> Self {
        o + (self - o).positive_part()
    }
    /// Exact arithmetic leaves nothing out.
    #[inline(always)]
    fn two_sum(self, o: Self) -> (Self, Self) {
        (self + o, Self::constant(0.0))
    }
    /// As [`two_sum`](Real::two_sum).
    #[inline(always)]
    fn two_prod(self, o: Self) -> (Self, Self) {
        (self * o, Self::constant(0.0))
    }
    #[inline(always)]
    fn difference_of_products(self, b: Self, c: Self, d: Self) -> Self {
        self * b - c * d
    }
}

impl<const MUTANT: u8> Single for Form<MUTANT> {
    fn magnitude(self) -> f64 {
        self.c.abs() + self.radius()
    }
}
