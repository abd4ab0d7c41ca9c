//! One number alone among registers: as `f64` and `f32` are, but on the instructions of those it came from. For rays that go
//! their own way through a tree.

use super::common;
use crate::math::real::{Bool, Task};
use crate::math::{Dd, Lane, Real};
use std::ops::{Add, Div, Mul, Neg, Sub};

macro_rules! one {
    ($name:ident, $elem:ident) => {
        /// One number.
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct $name($elem);

        one!(@operator $name, Add, add);
        one!(@operator $name, Sub, sub);
        one!(@operator $name, Mul, mul);
        one!(@operator $name, Div, div);

        impl Neg for $name {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                $name(-self.0)
            }
        }

        impl Real for $name {
            type Mask = Bool;
            type Single = f64;
            type Fine = Dd;
            const UNIT_ROUNDOFF: f64 = <$elem as Real>::UNIT_ROUNDOFF;
            const LEAST: f64 = <$elem as Real>::LEAST;
            #[inline(always)]
            fn splat(x: f64) -> Self {
                $name(x as $elem)
            }
            #[inline(always)]
            fn mul_add(self, b: Self, c: Self) -> Self {
                $name($elem::mul_add(self.0, b.0, c.0))
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                $name($elem::sqrt(self.0))
            }
            #[inline(always)]
            fn floor(self) -> Self {
                $name($elem::floor(self.0))
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $name($elem::abs(self.0))
            }
            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                $name($elem::copysign(self.0, sign.0))
            }
            #[inline(always)]
            fn lt(self, o: Self) -> Bool {
                Bool(self.0 < o.0)
            }
            #[inline(always)]
            fn le(self, o: Self) -> Bool {
                Bool(self.0 <= o.0)
            }
            #[inline(always)]
            fn same(self, o: Self) -> Bool {
                Bool(self.0 == o.0)
            }
            #[inline(always)]
            fn select(m: Bool, a: Self, b: Self) -> Self {
                if m.0 { a } else { b }
            }
            #[inline(always)]
            fn each<const N: usize, const M: usize>(v: [Self; N], f: impl FnMut([f64; N]) -> [f64; M]) -> [Self; M] {
                let mut given = [0.0; N];
                for (to, from) in given.iter_mut().zip(v) {
                    *to = from.0;
                }
                let mut out = [Self::splat(0.0); M];
                for (to, from) in out.iter_mut().zip($elem::each(given, f)) {
                    *to = $name(from);
                }
                out
            }
            #[inline(always)]
            fn again<const N: usize, const M: usize>(
                doubt: Bool,
                given: [Self; N],
                rough: [Self; M],
                f: impl FnMut([Dd; N]) -> [Dd; M],
            ) -> [Self; M] {
                let (mut numbers, mut all) = ([0.0; N], [0.0; M]);
                for (to, from) in numbers.iter_mut().zip(given) {
                    *to = from.0;
                }
                for (to, from) in all.iter_mut().zip(rough) {
                    *to = from.0;
                }
                let mut out = rough;
                for (to, from) in out.iter_mut().zip($elem::again(doubt, numbers, all, f)) {
                    *to = $name(from);
                }
                out
            }
            common!(@functions "avx2,fma,bmi1,bmi2,lzcnt,popcnt");
        }

        impl Lane for $name {
            type Elem = $elem;
            type Boxes = super::F32x8;
            type One = Self;
            const WIDTH: usize = 1;
            #[inline(always)]
            fn load(src: &[$elem]) -> Self {
                $name(src[0])
            }
            #[inline(always)]
            fn store(self, dst: &mut [$elem]) {
                dst[0] = self.0;
            }
            #[inline(always)]
            fn compress(self, m: Bool, dst: &mut [$elem]) {
                if m.0 {
                    dst[0] = self.0;
                }
            }
        }
    };
    (@operator $name:ident, $trait:ident, $method:ident) => {
        impl $trait for $name {
            type Output = Self;
            #[inline(always)]
            fn $method(self, o: Self) -> Self {
                $name($trait::$method(self.0, o.0))
            }
        }
    };
}

one!(F64x1, f64);
one!(F32x1, f32);
