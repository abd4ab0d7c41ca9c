//! One formula, many scalars. A kernel is written once over [`Real`] and instantiated for each scalar it is needed in;
//! [`Lane`] adds what a ray batch needs on top: loading, storing and compressing several values at a time.
//!
//! Comparisons give a [`Mask`] and branches are written as [`Real::select`], so that the same text serves one value or
//! several. Only operations that IEEE 754 rounds correctly appear here, so every instance of one precision gives the
//! same bits on every machine.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// The stored form of a scalar: `f64` or `f32`.
pub trait Elem: Copy + PartialOrd + Default + Send + Sync + 'static {
    /// Half an ulp of 1: the largest relative error of one rounded operation.
    const UNIT_ROUNDOFF: f64;
    /// The value as `f64`, exactly.
    fn to_f64(self) -> f64;
    /// The nearest value of this type.
    fn from_f64(x: f64) -> Self;
}

/// The result of comparing [`Real`]s: a truth value for each lane.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// The same truth value in every lane.
    fn splat(value: bool) -> Self;
    /// True in the first `n` lanes.
    fn first(n: usize) -> Self;
    /// One bit a lane, lane 0 lowest.
    fn bits(self) -> u32;
    /// Whether any lane is true.
    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }
}

/// A scalar that formulas are written in.
///
/// `mul_add` is always fused (one rounding). The binary operators round once each and are never contracted.
pub trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// What comparisons give.
    type Mask: Mask;
    /// Half an ulp of 1 in this precision.
    const UNIT_ROUNDOFF: f64;

    /// The constant `x`, rounded to this precision.
    fn splat(x: f64) -> Self;
    /// `self * b + c` with one rounding.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// Square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// The largest integer not above.
    fn floor(self) -> Self;
    /// Magnitude.
    fn abs(self) -> Self;
    /// Magnitude of `self`, sign of `sign`.
    fn copysign(self, sign: Self) -> Self;
    /// `self < o`; false for NaN.
    fn lt(self, o: Self) -> Self::Mask;
    /// `self <= o`; false for NaN.
    fn le(self, o: Self) -> Self::Mask;
    /// `self == o`; false for NaN.
    fn same(self, o: Self) -> Self::Mask;
    /// `a` where `m`, else `b`.
    fn select(m: Self::Mask, a: Self, b: Self) -> Self;
    /// A function of N values that gives M, applied lane by lane in `f64`: for elementary functions, look-ups in tables,
    /// and whatever branches too much to be written with masks.
    fn each<const N: usize, const M: usize>(v: [Self; N], f: impl FnMut([f64; N]) -> [f64; M]) -> [Self; M];

    /// Zero.
    #[inline(always)]
    fn zero() -> Self {
        Self::splat(0.0)
    }
    /// One.
    #[inline(always)]
    fn one() -> Self {
        Self::splat(1.0)
    }
    /// [`each`](Real::each) of one value.
    #[inline(always)]
    fn map(self, mut f: impl FnMut(f64) -> f64) -> Self {
        Self::each([self], |[x]| [f(x)])[0]
    }
    /// `self * b - c` with one rounding.
    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        self.mul_add(b, -c)
    }
    /// The smaller; `o` when they compare equal or `self` is NaN.
    #[inline(always)]
    fn min(self, o: Self) -> Self {
        Self::select(self.lt(o), self, o)
    }
    /// The larger; `o` when they compare equal or `self` is NaN.
    #[inline(always)]
    fn max(self, o: Self) -> Self {
        Self::select(o.lt(self), self, o)
    }
}

/// A [`Real`] that moves between registers and the arrays of a ray batch.
pub trait Lane: Real {
    /// The stored form.
    type Elem: Elem;
    /// How many values one `Lane` holds.
    const WIDTH: usize;

    /// The first [`WIDTH`](Lane::WIDTH) values of `src`, which must hold that many.
    fn load(src: &[Self::Elem]) -> Self;
    /// Writes [`WIDTH`](Lane::WIDTH) values to the front of `dst`.
    fn store(self, dst: &mut [Self::Elem]);
    /// Packs the lanes that `m` selects to the front of `dst`; lanes after them may be overwritten, so `dst` must hold
    /// [`WIDTH`](Lane::WIDTH) values.
    fn compress(self, m: Self::Mask, dst: &mut [Self::Elem]);
}

/// The mask of a single value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bool(pub bool);

impl BitAnd for Bool {
    type Output = Bool;
    #[inline(always)]
    fn bitand(self, o: Bool) -> Bool {
        Bool(self.0 & o.0)
    }
}
impl BitOr for Bool {
    type Output = Bool;
    #[inline(always)]
    fn bitor(self, o: Bool) -> Bool {
        Bool(self.0 | o.0)
    }
}
impl Not for Bool {
    type Output = Bool;
    #[inline(always)]
    fn not(self) -> Bool {
        Bool(!self.0)
    }
}
impl Mask for Bool {
    #[inline(always)]
    fn splat(value: bool) -> Bool {
        Bool(value)
    }
    #[inline(always)]
    fn first(n: usize) -> Bool {
        Bool(n > 0)
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0 as u32
    }
}

macro_rules! scalar {
    ($t:ident) => {
        impl Elem for $t {
            const UNIT_ROUNDOFF: f64 = $t::EPSILON as f64 / 2.0;
            #[inline(always)]
            fn to_f64(self) -> f64 {
                self as f64
            }
            #[inline(always)]
            fn from_f64(x: f64) -> $t {
                x as $t
            }
        }
        impl Real for $t {
            type Mask = Bool;
            const UNIT_ROUNDOFF: f64 = <$t as Elem>::UNIT_ROUNDOFF;
            #[inline(always)]
            fn splat(x: f64) -> Self {
                x as $t
            }
            #[inline(always)]
            fn mul_add(self, b: Self, c: Self) -> Self {
                $t::mul_add(self, b, c)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                $t::sqrt(self)
            }
            #[inline(always)]
            fn floor(self) -> Self {
                $t::floor(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $t::abs(self)
            }
            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                $t::copysign(self, sign)
            }
            #[inline(always)]
            fn lt(self, o: Self) -> Bool {
                Bool(self < o)
            }
            #[inline(always)]
            fn le(self, o: Self) -> Bool {
                Bool(self <= o)
            }
            #[inline(always)]
            fn same(self, o: Self) -> Bool {
                Bool(self == o)
            }
            #[inline(always)]
            fn select(m: Bool, a: Self, b: Self) -> Self {
                if m.0 { a } else { b }
            }
            #[inline(always)]
            fn each<const N: usize, const M: usize>(
                v: [Self; N],
                mut f: impl FnMut([f64; N]) -> [f64; M],
            ) -> [Self; M] {
                let (mut given, mut out) = ([0.0; N], [0.0; M]);
                for (to, from) in given.iter_mut().zip(v) {
                    *to = from as f64;
                }
                for (to, from) in out.iter_mut().zip(f(given)) {
                    *to = from as $t;
                }
                out
            }
        }
        impl Lane for $t {
            type Elem = $t;
            const WIDTH: usize = 1;
            #[inline(always)]
            fn load(src: &[$t]) -> Self {
                src[0]
            }
            #[inline(always)]
            fn store(self, dst: &mut [$t]) {
                dst[0] = self;
            }
            #[inline(always)]
            fn compress(self, m: Bool, dst: &mut [$t]) {
                if m.0 {
                    dst[0] = self;
                }
            }
        }
    };
}
scalar!(f64);
scalar!(f32);

/// `a + b` and its exact rounding error (Knuth's TwoSum; Ogita, Rump, Oishi, SIAM J. Sci. Comput. 26, 2005).
#[inline(always)]
pub fn two_sum<R: Real>(a: R, b: R) -> (R, R) {
    let s = a + b;
    let bb = s - a;
    (s, (a - (s - bb)) + (b - bb))
}

/// `a * b` and its exact rounding error, by a fused multiply-add (barring under- and overflow).
#[inline(always)]
pub fn two_prod<R: Real>(a: R, b: R) -> (R, R) {
    let p = a * b;
    (p, a.mul_sub(b, p))
}

/// `a·b − c·d` to within 2 units of roundoff, so its sign is exact (Kahan; Jeannerod, Louvet, Muller, Math. Comp. 82, 2013).
#[inline(always)]
pub fn difference_of_products<R: Real>(a: R, b: R, c: R, d: R) -> R {
    let w = c * d;
    let e = (-c).mul_add(d, w);
    a.mul_sub(b, w) + e
}

/// Bound on the relative error of `n` rounded operations in sequence: n·u / (1 − n·u) (Higham, *Accuracy and Stability
/// of Numerical Algorithms*, section 3.1).
pub const fn gamma(n: f64, unit_roundoff: f64) -> f64 {
    n * unit_roundoff / (1.0 - n * unit_roundoff)
}

/// The three values of `f`. In place of an array's `map`, so that it is surely inlined: kernels are compiled for more
/// instructions than the standard library, whose functions would call the slow forms.
#[inline(always)]
pub fn three<T>(f: impl Fn(usize) -> T) -> [T; 3] {
    [f(0), f(1), f(2)]
}

/// `f` of each of three values; see [`three`].
#[inline(always)]
pub fn each3<T: Copy, U>(v: [T; 3], f: impl Fn(T) -> U) -> [U; 3] {
    [f(v[0]), f(v[1]), f(v[2])]
}

/// Dot product of 3-vectors; fused, in a fixed order.
#[inline(always)]
pub fn dot<R: Real>(a: [R; 3], b: [R; 3]) -> R {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

/// `a + s·b` for 3-vectors.
#[inline(always)]
pub fn axpy<R: Real>(s: R, b: [R; 3], a: [R; 3]) -> [R; 3] {
    [s.mul_add(b[0], a[0]), s.mul_add(b[1], a[1]), s.mul_add(b[2], a[2])]
}

/// `s·a` for a 3-vector.
#[inline(always)]
pub fn scaled<R: Real>(s: R, a: [R; 3]) -> [R; 3] {
    [s * a[0], s * a[1], s * a[2]]
}

/// `a − b` for 3-vectors.
#[inline(always)]
pub fn minus<R: Real>(a: [R; 3], b: [R; 3]) -> [R; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// A constant 3-vector in every lane.
#[inline(always)]
pub fn splat3<R: Real>(v: [f64; 3]) -> [R; 3] {
    each3(v, R::splat)
}

/// `a` where `m`, else `b`, for 3-vectors.
#[inline(always)]
pub fn select3<R: Real>(m: R::Mask, a: [R; 3], b: [R; 3]) -> [R; 3] {
    [R::select(m, a[0], b[0]), R::select(m, a[1], b[1]), R::select(m, a[2], b[2])]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_free_transforms_are_exact() {
        let (s, e) = two_sum(1.0f64, 1e-20);
        assert_eq!((s, e), (1.0, 1e-20));
        let x = 1.0 + f64::EPSILON;
        let (p, e) = two_prod(x, x);
        assert_eq!((p, e), (1.0 + 2.0 * f64::EPSILON, f64::EPSILON * f64::EPSILON));
    }

    #[test]
    fn determinant_sign_survives_cancellation() {
        let x = 1.0 + f64::EPSILON;
        assert_eq!(x * x - (x + f64::EPSILON) * 1.0, 0.0, "the plain form loses it");
        assert!(difference_of_products(x, x, x + f64::EPSILON, 1.0) > 0.0);
    }
}
