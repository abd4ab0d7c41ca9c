//! Machine numbers as [`Real`]: `f64`, and `f32` for drafts.

use super::Dd;
use super::real::{Bool, Elem, Lane, Real, Single, Task};

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
            type Single = f64;
            type Fine = Dd;
            const UNIT_ROUNDOFF: f64 = <$t as Elem>::UNIT_ROUNDOFF;
            const LEAST: f64 = $t::MIN_POSITIVE as f64;
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
            #[inline(always)]
            fn alone<T: Task>(task: T) -> T::Output {
                #[inline(never)]
                fn in_a_function_of_its_own<T: Task>(task: T) -> T::Output {
                    task.run()
                }
                in_a_function_of_its_own(task)
            }
            #[inline(always)]
            fn vectorize<T>(f: impl FnOnce() -> T) -> T {
                #[inline(never)]
                fn in_a_function_of_its_own<T>(f: impl FnOnce() -> T) -> T {
                    f()
                }
                in_a_function_of_its_own(f)
            }
            #[inline(always)]
            fn again<const N: usize, const M: usize>(
                doubt: Bool,
                given: [Self; N],
                rough: [Self; M],
                f: impl FnMut([Dd; N]) -> [Dd; M],
            ) -> [Self; M] {
                if doubt.0 { in_double_double(given, f) } else { rough }
            }
        }
        impl Lane for $t {
            type Elem = $t;
            type Boxes = f32;
            type One = $t;
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

impl Single for f64 {
    #[inline(always)]
    fn magnitude(self) -> f64 {
        self.abs()
    }
}

/// [`again`](Real::again) for one number: seldom called, and kept out of the loops that call it.
#[cold]
#[inline(never)]
fn in_double_double<E: Elem, const N: usize, const M: usize>(
    given: [E; N],
    mut f: impl FnMut([Dd; N]) -> [Dd; M],
) -> [E; M] {
    f(given.map(|x| Dd::new(x.to_f64()))).map(|x| E::from_f64(x.hi))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_free_transforms_are_exact() {
        let (s, e) = 1.0.two_sum(1e-20);
        assert_eq!((s, e), (1.0, 1e-20));
        let x = 1.0 + f64::EPSILON;
        let (p, e) = x.two_prod(x);
        assert_eq!((p, e), (1.0 + 2.0 * f64::EPSILON, f64::EPSILON * f64::EPSILON));
    }

    #[test]
    fn determinant_sign_survives_cancellation() {
        let x = 1.0 + f64::EPSILON;
        assert_eq!(x * x - (x + f64::EPSILON) * 1.0, 0.0, "the plain form loses it");
        assert!(x.difference_of_products(x, x + f64::EPSILON, 1.0) > 0.0);
    }
}
