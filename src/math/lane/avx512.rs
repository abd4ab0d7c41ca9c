//! Registers of 512 bits: eight `f64`, sixteen `f32`.

use super::common;
use crate::math::real::Task;
use crate::math::{Dd, Lane, Mask, Real};
use std::arch::x86_64::*;

macro_rules! register {
    ($name:ident, $one:ident, $mask:ident, $elem:ident, $bits:ident, $width:literal, $register:ident, $add:ident, $sub:ident, $mul:ident, $div:ident,
     $set:ident, $load:ident, $store:ident, $fma:ident, $fms:ident, $sqrt:ident, $round:ident, $xor:ident, $and:ident,
     $and_not:ident, $or:ident, $compare:ident, $blend:ident, $compress:ident, $min:ident, $max:ident) => {
        /// Several numbers.
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct $name($register);

        /// One bit a number.
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct $mask($bits);

        // SAFETY, of every block in this file: see the module above. Loads and stores check their slices first.

        impl std::ops::BitAnd for $mask {
            type Output = Self;
            #[inline(always)]
            fn bitand(self, o: Self) -> Self {
                $mask(self.0 & o.0)
            }
        }
        impl std::ops::BitOr for $mask {
            type Output = Self;
            #[inline(always)]
            fn bitor(self, o: Self) -> Self {
                $mask(self.0 | o.0)
            }
        }
        impl std::ops::Not for $mask {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                $mask(!self.0)
            }
        }
        impl Mask for $mask {
            #[inline(always)]
            fn splat(value: bool) -> Self {
                $mask(if value { $bits::MAX } else { 0 })
            }
            #[inline(always)]
            fn from_bits(bits: u32) -> Self {
                $mask(bits as $bits)
            }
            #[inline(always)]
            fn bits(self) -> u32 {
                self.0 as u32
            }
        }

        common!($name, $mask, $elem, $width, $add, $sub, $mul, $div);

        impl $name {
            #[inline(always)]
            fn flipped(self) -> Self {
                unsafe { $name($xor(self.0, $set(-0.0))) }
            }
        }

        impl Real for $name {
            common!(
                @arithmetic $name, $mask, $elem, $set, $fma, $fms, $sqrt, $and, $and_not, $or, $compare, $min, $max
            );
            #[inline(always)]
            fn floor(self) -> Self {
                // Scale 0, towards minus infinity.
                unsafe { $name($round::<_MM_FROUND_TO_NEG_INF>(self.0)) }
            }
            #[inline(always)]
            fn select(m: $mask, a: Self, b: Self) -> Self {
                unsafe { $name($blend(m.0, b.0, a.0)) }
            }
            common!(@each $mask, $width);
            common!(@functions "avx512f,avx512dq,avx512vl,avx512bw,avx2,fma,bmi1,bmi2,lzcnt,popcnt");
        }

        impl Lane for $name {
            type Elem = $elem;
            type Boxes = super::F32x8;
            type One = super::$one;
            const WIDTH: usize = $width;
            #[inline(always)]
            fn load(src: &[$elem]) -> Self {
                unsafe { $name($load(src[..$width].as_ptr())) }
            }
            #[inline(always)]
            fn store(self, dst: &mut [$elem]) {
                unsafe { $store(dst[..$width].as_mut_ptr(), self.0) }
            }
            #[inline(always)]
            fn compress(self, m: $mask, dst: &mut [$elem]) {
                // Packed in a register and stored whole: storing packed is slow on some processors.
                unsafe { $store(dst[..$width].as_mut_ptr(), $compress(m.0, self.0)) }
            }
        }
    };
}

register!(
    F64x8,
    F64x1,
    Mask8,
    f64,
    u8,
    8,
    __m512d,
    _mm512_add_pd,
    _mm512_sub_pd,
    _mm512_mul_pd,
    _mm512_div_pd,
    _mm512_set1_pd,
    _mm512_loadu_pd,
    _mm512_storeu_pd,
    _mm512_fmadd_pd,
    _mm512_fmsub_pd,
    _mm512_sqrt_pd,
    _mm512_roundscale_pd,
    _mm512_xor_pd,
    _mm512_and_pd,
    _mm512_andnot_pd,
    _mm512_or_pd,
    _mm512_cmp_pd_mask,
    _mm512_mask_blend_pd,
    _mm512_maskz_compress_pd,
    _mm512_min_pd,
    _mm512_max_pd
);
register!(
    F32x16,
    F32x1,
    Mask16,
    f32,
    u16,
    16,
    __m512,
    _mm512_add_ps,
    _mm512_sub_ps,
    _mm512_mul_ps,
    _mm512_div_ps,
    _mm512_set1_ps,
    _mm512_loadu_ps,
    _mm512_storeu_ps,
    _mm512_fmadd_ps,
    _mm512_fmsub_ps,
    _mm512_sqrt_ps,
    _mm512_roundscale_ps,
    _mm512_xor_ps,
    _mm512_and_ps,
    _mm512_andnot_ps,
    _mm512_or_ps,
    _mm512_cmp_ps_mask,
    _mm512_mask_blend_ps,
    _mm512_maskz_compress_ps,
    _mm512_min_ps,
    _mm512_max_ps
);
