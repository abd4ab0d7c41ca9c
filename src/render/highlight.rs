//! The power that makes a highlight of the cosine between mirrored ray and light (Phong, "Illumination for computer generated
//! pictures", CACM 18, 1975).

use super::material::Slot;
use crate::math::{Lane, fun};

/// x^exponent for 0 < x ≤ 1. A constant whole exponent goes by squaring.
#[inline(always)]
pub fn power<L: Lane>(x: L, exponent: L, slot: Slot) -> L {
    match slot {
        // Beyond 4096 the pinned function is as fast.
        Slot::Constant([e, ..]) if e.fract() == 0.0 && (0.0..=4096.0).contains(&e) => {
            let (mut n, mut square, mut product) = (e as u32, x, L::one());
            while n > 0 {
                if n & 1 == 1 {
                    product = product * square;
                }
                square = square * square;
                n >>= 1;
            }
            product
        }
        _ => L::each([x, exponent], |[x, e]| [if x > 0.0 { fun::pow(x, e) } else { 0.0 }])[0],
    }
}
