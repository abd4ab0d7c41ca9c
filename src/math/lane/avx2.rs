//! Registers of 256 bits: four `f64`, eight `f32`.

use super::common;
use crate::math::real::Task;
use crate::math::{Dd, Lane, Mask, Real};
use std::arch::x86_64::*;

/// For each mask of `WIDTH` lanes, which words of 32 bits go to the front, and in which order.
const fn packing<const WIDTH: usize, const MASKS: usize>() -> [[i32; 8]; MASKS] {
    let words = 8 / WIDTH;
    let (mut orders, mut mask) = ([[0; 8]; MASKS], 0);
    while mask < MASKS {
        let (mut lane, mut to) = (0, 0);
        while lane < WIDTH {
            if mask >> lane & 1 == 1 {
                let mut word = 0;
                while word < words {
                    orders[mask][to] = (lane * words + word) as i32;
                    (to, word) = (to + 1, word + 1);
                }
            }
            lane += 1;
        }
        mask += 1;
    }
    orders
}

macro_rules! register {
    ($name:ident, $one:ident, $mask:ident, $elem:ident, $int:ident, $width:literal, $register:ident, $add:ident, $sub:ident, $mul:ident, $div:ident,
     $set:ident, $zero:ident, $load:ident, $store:ident, $fma:ident, $fms:ident, $sqrt:ident, $floor:ident, $xor:ident, $and:ident,
     $and_not:ident, $or:ident, $compare:ident, $blend:ident, $bits:ident, $min:ident, $max:ident, $set_int:ident, $load_int:ident,
     $same_int:ident, $from_int:ident, $as_words:path, $from_words:path) => {
        /// Several numbers.
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct $name($register);

        /// All bits of a number set where true.
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct $mask($register);

        // SAFETY, of every block in this file: see the module above. Loads and stores check their slices first.

        impl std::ops::BitAnd for $mask {
            type Output = Self;
            #[inline(always)]
            fn bitand(self, o: Self) -> Self {
                unsafe { $mask($and(self.0, o.0)) }
            }
        }
        impl std::ops::BitOr for $mask {
            type Output = Self;
            #[inline(always)]
            fn bitor(self, o: Self) -> Self {
                unsafe { $mask($or(self.0, o.0)) }
            }
        }
        impl std::ops::Not for $mask {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                unsafe { $mask($xor(self.0, $compare::<_CMP_EQ_OQ>($zero(), $zero()))) }
            }
        }
        impl Mask for $mask {
            #[inline(always)]
            fn splat(value: bool) -> Self {
                Self::from_bits(if value { u32::MAX } else { 0 })
            }
            #[inline(always)]
            fn from_bits(bits: u32) -> Self {
                const ONE_A_LANE: [$int; $width] = {
                    let (mut a, mut i) = ([0; $width], 0);
                    while i < $width {
                        a[i] = 1 << i;
                        i += 1;
                    }
                    a
                };
                unsafe {
                    let lane = $load_int(ONE_A_LANE.as_ptr().cast());
                    let here = _mm256_and_si256($set_int(bits as $int), lane);
                    $mask($from_int($same_int(here, lane)))
                }
            }
            #[inline(always)]
            fn bits(self) -> u32 {
                unsafe { $bits(self.0) as u32 }
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
                unsafe { $name($floor(self.0)) }
            }
            #[inline(always)]
            fn select(m: $mask, a: Self, b: Self) -> Self {
                unsafe { $name($blend(b.0, a.0, m.0)) }
            }
            common!(@each $mask, $width);
            common!(@functions "avx2,fma,bmi1,bmi2,lzcnt,popcnt");
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
                static PACK: [[i32; 8]; 1 << $width] = packing::<$width, { 1 << $width }>();
                unsafe {
                    let order = _mm256_loadu_si256(PACK[m.bits() as usize % (1 << $width)].as_ptr().cast());
                    let packed = $from_words(_mm256_permutevar8x32_ps($as_words(self.0), order));
                    $store(dst[..$width].as_mut_ptr(), packed)
                }
            }
        }
    };
}

register!(
    F64x4,
    F64x1,
    Mask4,
    f64,
    i64,
    4,
    __m256d,
    _mm256_add_pd,
    _mm256_sub_pd,
    _mm256_mul_pd,
    _mm256_div_pd,
    _mm256_set1_pd,
    _mm256_setzero_pd,
    _mm256_loadu_pd,
    _mm256_storeu_pd,
    _mm256_fmadd_pd,
    _mm256_fmsub_pd,
    _mm256_sqrt_pd,
    _mm256_floor_pd,
    _mm256_xor_pd,
    _mm256_and_pd,
    _mm256_andnot_pd,
    _mm256_or_pd,
    _mm256_cmp_pd,
    _mm256_blendv_pd,
    _mm256_movemask_pd,
    _mm256_min_pd,
    _mm256_max_pd,
    _mm256_set1_epi64x,
    _mm256_loadu_si256,
    _mm256_cmpeq_epi64,
    _mm256_castsi256_pd,
    _mm256_castpd_ps,
    _mm256_castps_pd
);
register!(
    F32x8,
    F32x1,
    Mask8,
    f32,
    i32,
    8,
    __m256,
    _mm256_add_ps,
    _mm256_sub_ps,
    _mm256_mul_ps,
    _mm256_div_ps,
    _mm256_set1_ps,
    _mm256_setzero_ps,
    _mm256_loadu_ps,
    _mm256_storeu_ps,
    _mm256_fmadd_ps,
    _mm256_fmsub_ps,
    _mm256_sqrt_ps,
    _mm256_floor_ps,
    _mm256_xor_ps,
    _mm256_and_ps,
    _mm256_andnot_ps,
    _mm256_or_ps,
    _mm256_cmp_ps,
    _mm256_blendv_ps,
    _mm256_movemask_ps,
    _mm256_min_ps,
    _mm256_max_ps,
    _mm256_set1_epi32,
    _mm256_loadu_si256,
    _mm256_cmpeq_epi32,
    _mm256_castsi256_ps,
    std::convert::identity,
    std::convert::identity
);
