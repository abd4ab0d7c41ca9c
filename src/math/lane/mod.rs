//! Several numbers at once: registers of AVX2 and AVX-512 as [`Lane`](super::Lane)s. Each operation rounds every number as the
//! single one would, so a ray's bits don't depend on the company it travels in.
//!
//! # Safety
//! The intrinsics behind these types are only sound on processors that have them. The types are private to this crate, and
//! code over them is only reached through `render::dispatch`, which asks the processor first. Methods are inlined into functions
//! that are compiled for the right instructions: [`Lane::vectorize`](super::Lane::vectorize) makes one.

#![allow(unsafe_code)]

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "x86_64")]
mod one;

#[cfg(target_arch = "x86_64")]
pub(crate) use avx2::{F32x8, F64x4};
#[cfg(target_arch = "x86_64")]
pub(crate) use avx512::{F32x16, F64x8};
#[cfg(target_arch = "x86_64")]
use one::{F32x1, F64x1};

/// What registers of all sizes have in common: operators, and what is done number by number.
#[cfg(target_arch = "x86_64")]
macro_rules! common {
    ($name:ident, $mask:ident, $elem:ident, $width:literal, $add:ident, $sub:ident, $mul:ident, $div:ident) => {
        common!(@operator $name, Add, add, $add);
        common!(@operator $name, Sub, sub, $sub);
        common!(@operator $name, Mul, mul, $mul);
        common!(@operator $name, Div, div, $div);

        impl $name {
            #[inline(always)]
            fn to_array(self) -> [$elem; $width] {
                let mut a = [0.0; $width];
                crate::math::Lane::store(self, &mut a);
                a
            }

            /// `each` of [`Real`](crate::math::Real).
            #[inline(always)]
            fn number_by_number<const N: usize, const M: usize>(
                v: [Self; N],
                mut f: impl FnMut([f64; N]) -> [f64; M],
            ) -> [Self; M] {
                let (mut given, mut out) = ([[0.0; $width]; N], [[0.0; $width]; M]);
                for (to, from) in given.iter_mut().zip(v) {
                    *to = from.to_array();
                }
                for i in 0..$width {
                    let mut one = [0.0; N];
                    for (to, from) in one.iter_mut().zip(&given) {
                        *to = from[i] as f64;
                    }
                    for (to, from) in out.iter_mut().zip(f(one)) {
                        to[i] = from as $elem;
                    }
                }
                let mut result = [crate::math::Real::splat(0.0); M];
                for (to, from) in result.iter_mut().zip(&out) {
                    *to = crate::math::Lane::load(from);
                }
                result
            }

            /// `again` of [`Real`](crate::math::Real): seldom called, and kept out of the loops that call it.
            #[cold]
            #[inline(never)]
            fn in_double_double<const N: usize, const M: usize>(
                doubt: u32,
                given: &[[$elem; $width]; N],
                rough: &mut [[$elem; $width]; M],
                mut f: impl FnMut([crate::math::Dd; N]) -> [crate::math::Dd; M],
            ) {
                for i in (0..$width).filter(|i| doubt >> i & 1 == 1) {
                    for (to, from) in rough.iter_mut().zip(f(std::array::from_fn(|k| crate::math::Dd::new(given[k][i] as f64)))) {
                        to[i] = from.hi as $elem;
                    }
                }
            }
        }

        impl std::ops::Neg for $name {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                self.flipped()
            }
        }
    };
    (@operator $name:ident, $trait:ident, $method:ident, $intrinsic:ident) => {
        impl std::ops::$trait for $name {
            type Output = Self;
            #[inline(always)]
            fn $method(self, o: Self) -> Self {
                // SAFETY: see the module.
                unsafe { $name($intrinsic(self.0, o.0)) }
            }
        }
    };
    // Of `Real`: what is one instruction each, by the same names.
    (@arithmetic $name:ident, $mask:ident, $elem:ident, $set:ident, $fma:ident, $fms:ident, $sqrt:ident, $and:ident,
     $and_not:ident, $or:ident, $compare:ident, $min:ident, $max:ident) => {
        type Mask = $mask;
        type Single = f64;
        type Fine = Dd;
        const UNIT_ROUNDOFF: f64 = <$elem as Real>::UNIT_ROUNDOFF;
        const LEAST: f64 = <$elem as Real>::LEAST;
        #[inline(always)]
        fn splat(x: f64) -> Self {
            unsafe { $name($set(x as $elem)) }
        }
        #[inline(always)]
        fn mul_add(self, b: Self, c: Self) -> Self {
            unsafe { $name($fma(self.0, b.0, c.0)) }
        }
        #[inline(always)]
        fn mul_sub(self, b: Self, c: Self) -> Self {
            unsafe { $name($fms(self.0, b.0, c.0)) }
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            unsafe { $name($sqrt(self.0)) }
        }
        #[inline(always)]
        fn abs(self) -> Self {
            unsafe { $name($and_not($set(-0.0), self.0)) }
        }
        #[inline(always)]
        fn copysign(self, sign: Self) -> Self {
            unsafe { $name($or($and_not($set(-0.0), self.0), $and($set(-0.0), sign.0))) }
        }
        #[inline(always)]
        fn lt(self, o: Self) -> $mask {
            unsafe { $mask($compare::<_CMP_LT_OQ>(self.0, o.0)) }
        }
        #[inline(always)]
        fn le(self, o: Self) -> $mask {
            unsafe { $mask($compare::<_CMP_LE_OQ>(self.0, o.0)) }
        }
        #[inline(always)]
        fn same(self, o: Self) -> $mask {
            unsafe { $mask($compare::<_CMP_EQ_OQ>(self.0, o.0)) }
        }
        /// The instruction gives its second operand where the two compare equal or either is NaN.
        #[inline(always)]
        fn min(self, o: Self) -> Self {
            unsafe { $name($min(self.0, o.0)) }
        }
        #[inline(always)]
        fn max(self, o: Self) -> Self {
            unsafe { $name($max(self.0, o.0)) }
        }
    };
    // Of `Real`: functions of their own, compiled for these instructions.
    (@functions $instructions:literal) => {
        #[inline(always)]
        fn alone<T: Task>(task: T) -> T::Output {
            // SAFETY: see the module.
            unsafe { super::alone(task) }
        }
        #[inline(always)]
        fn vectorize<T>(f: impl FnOnce() -> T) -> T {
            #[target_feature(enable = $instructions)]
            #[inline(never)]
            fn compiled_for_it<T>(f: impl FnOnce() -> T) -> T {
                f()
            }
            // SAFETY: see the module.
            unsafe { compiled_for_it(f) }
        }
    };
    (@each $mask:ident, $width:literal) => {
        #[inline(always)]
        fn each<const N: usize, const M: usize>(v: [Self; N], f: impl FnMut([f64; N]) -> [f64; M]) -> [Self; M] {
            Self::number_by_number(v, f)
        }
        #[inline(always)]
        fn again<const N: usize, const M: usize>(
            doubt: $mask,
            given: [Self; N],
            rough: [Self; M],
            f: impl FnMut([crate::math::Dd; N]) -> [crate::math::Dd; M],
        ) -> [Self; M] {
            let (mut numbers, mut all_given) = ([[0.0; $width]; M], [[0.0; $width]; N]);
            for (to, from) in numbers.iter_mut().zip(rough) {
                *to = from.to_array();
            }
            for (to, from) in all_given.iter_mut().zip(given) {
                *to = from.to_array();
            }
            Self::in_double_double(crate::math::Mask::bits(doubt), &all_given, &mut numbers, f);
            let mut result = rough;
            for (to, from) in result.iter_mut().zip(&numbers) {
                *to = crate::math::Lane::load(from);
            }
            result
        }
    };
}
#[cfg(target_arch = "x86_64")]
use common;

/// Does a task of single numbers.
///
/// # Safety
/// The processor must have AVX2 and FMA.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
#[inline(never)]
fn alone<T: super::real::Task>(task: T) -> T::Output {
    task.run()
}

/// Whether the processor has AVX2 and FMA.
#[cfg(target_arch = "x86_64")]
pub(crate) fn avx2_is_there() -> bool {
    is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
}

/// Whether the processor has the parts of AVX-512 that the wide registers use.
#[cfg(target_arch = "x86_64")]
pub(crate) fn avx512_is_there() -> bool {
    avx2_is_there()
        && is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("avx512bw")
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;
    use crate::math::hash::KeyedHash;
    use crate::math::{Elem, Lane, Mask, Real};

    /// Ordinary numbers and every strange one.
    fn numbers(i: u64) -> f64 {
        let h = KeyedHash::new().with(i);
        let strange = [0.0, -0.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1.0, -1.5, 2.5, 1e-30, -3e30];
        match h.with(1).bits() % 4 {
            0 => strange[(h.with(2).bits() % 10) as usize],
            _ => (h.with(3).unit() - 0.5) * 16.0,
        }
    }

    fn same<E: Elem>(a: E, b: E) -> bool {
        let (a, b) = (a.to_f64(), b.to_f64());
        a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
    }

    /// Every operation of `L` against that of its numbers alone.
    fn as_alone<L: Lane>()
    where
        L::Elem: Lane<Elem = L::Elem> + std::fmt::Debug,
    {
        type Op<R> = fn(R, R, R) -> R;
        fn ops<R: Lane>() -> [Op<R>; 18] {
            [
                |a, b, _| a + b,
                |a, b, _| a - b,
                |a, b, _| a * b,
                |a, b, _| a / b,
                |a, _, _| -a,
                |a, b, c| a.mul_add(b, c),
                |a, b, c| a.mul_sub(b, c),
                |a, _, _| a.sqrt(),
                |a, _, _| a.floor(),
                |a, _, _| a.abs(),
                |a, b, _| a.copysign(b),
                |a, b, _| a.min(b),
                |a, b, _| a.max(b),
                |a, b, c| R::select(a.lt(b), b, c),
                |a, b, c| R::select(a.le(b), b, c),
                |a, b, c| R::select(a.same(b) | !b.lt(c), b, c),
                |a, b, c| R::select(R::Mask::splat(true) & a.lt(c), b, c),
                |a, b, _| R::each([a, b], |[x, y]| [x + 2.0 * y])[0],
            ]
        }
        let zero = L::Elem::default();
        for round in 0..400u64 {
            let column = |k: u64| -> Vec<L::Elem> {
                (0..L::WIDTH as u64).map(|i| L::Elem::from_f64(numbers(round * 64 + k * 16 + i))).collect()
            };
            let v = [column(0), column(1), column(2)];
            let [a, b, c] = [0, 1, 2].map(|k| L::load(&v[k]));
            for (n, (wide, one)) in ops::<L>().iter().zip(ops::<L::Elem>()).enumerate() {
                let mut out = vec![zero; L::WIDTH];
                wide(a, b, c).store(&mut out);
                for i in 0..L::WIDTH {
                    let alone = one(v[0][i], v[1][i], v[2][i]);
                    assert!(
                        same(out[i], alone),
                        "operation {n} of {:?}: {:?}, alone {alone:?}",
                        v.each_ref().map(|v| v[i]),
                        out[i]
                    );
                }
            }
            let m = a.lt(b);
            let bits = (0..L::WIDTH).filter(|&i| v[0][i] < v[1][i]).fold(0, |s, i| s | 1 << i);
            assert_eq!((m.bits(), m.any()), (bits, bits != 0));
            assert_eq!(L::Mask::from_bits(bits).bits(), bits);
            assert_eq!((!m).bits(), !bits & ((1u64 << L::WIDTH) - 1) as u32);
            let mut packed = vec![zero; L::WIDTH];
            c.compress(m, &mut packed);
            let expected = (0..L::WIDTH).filter(|i| bits >> i & 1 == 1).map(|i| v[2][i]);
            assert!(expected.zip(&packed).all(|(x, y)| same(x, *y)));
        }
        assert_eq!(L::Mask::first(3).bits(), 7);
        assert_eq!(L::Mask::first(L::WIDTH).bits(), L::Mask::splat(true).bits());
        let [twice] = L::again(L::Mask::first(2), [L::splat(3.0)], [L::splat(1.0)], |[x]| [x + x]);
        let mut out = vec![zero; L::WIDTH];
        twice.store(&mut out);
        assert!(out.iter().enumerate().all(|(i, x)| x.to_f64() == if i < 2 { 6.0 } else { 1.0 }));
    }

    #[test]
    fn every_lane_gives_the_bits_of_its_number_alone() {
        if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
            F64x4::vectorize(as_alone::<F64x4>);
            F32x8::vectorize(as_alone::<F32x8>);
        }
        if avx512_is_there() {
            F64x8::vectorize(as_alone::<F64x8>);
            F32x16::vectorize(as_alone::<F32x16>);
        }
    }
}
