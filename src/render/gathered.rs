//! The light that a tile's pixels gather.

use super::batch::{Column, Column3, PADDING};
use super::run::LaneGroup;
use crate::math::real::Mask;
use crate::math::{Elem, Lane};

/// Where rays leave what they see.
pub struct Gathered<'a, E: Elem> {
    /// Of each pixel of the tile.
    pub radiance: &'a mut Column3<E>,
    /// Whether these rays are the first of their pixels: what is there is forgotten.
    pub first: bool,
    /// Whether ray number i belongs to pixel number i.
    pub in_order: bool,
}

impl<E: Elem> Gathered<'_, E> {
    /// Adds the value of each ray of `group` to its pixel, by `slots`.
    #[inline(always)]
    pub fn add<L: Lane<Elem = E>>(&mut self, group: &LaneGroup, slots: &Column<E>, value: [L; 3]) {
        let g = group.place();
        if self.first && self.in_order {
            let m = L::Mask::from_bits(group.bits);
            let whole = group.bits.count_ones() as usize == L::WIDTH;
            for (column, value) in self.radiance.iter_mut().zip(value) {
                if whole {
                    value.store(&mut column[g..]);
                    continue;
                }
                L::select(m, value, L::load(&column[g..])).store(&mut column[g..]);
            }
            return;
        }
        let mut lanes = [[E::default(); PADDING]; 3];
        for (lanes, value) in lanes.iter_mut().zip(value) {
            value.store(lanes);
        }
        let mut rest = group.bits;
        while rest != 0 {
            let i = rest.trailing_zeros() as usize % PADDING;
            rest &= rest - 1;
            let slot = slots[g + i].to_f64() as usize;
            for (column, lanes) in self.radiance.iter_mut().zip(&lanes) {
                let sum = &mut column[slot];
                *sum = if self.first { lanes[i] } else { E::from_f64(sum.to_f64() + lanes[i].to_f64()) };
            }
        }
    }
}
