//! The nearest crossing of each ray of a register, as far as surfaces were tested.

use super::batch::{HitColumns, NONE};
use super::shape::Visit;
use crate::math::{Lane, Real};

/// Keeps the nearest crossing; of two at the same t, that of the primitive with the lower number.
#[derive(Clone, Copy)]
pub struct Nearest<R> {
    /// Where it is along the ray; infinite for none.
    pub t: R,
    /// The surface, or [`NONE`].
    pub id: R,
    /// The part of it.
    pub part: R,
    /// The surface that is tested.
    pub current: R,
}

impl<L: Lane> Nearest<L> {
    /// Nothing found yet.
    #[inline(always)]
    pub fn none() -> Nearest<L> {
        Nearest { t: L::splat(f64::INFINITY), id: L::splat(NONE), part: L::zero(), current: L::zero() }
    }

    /// What the rays from number `g` on met so far.
    #[inline(always)]
    pub fn load(hits: &HitColumns<L::Elem>, g: usize) -> Nearest<L> {
        Nearest {
            t: L::load(&hits.t[g..]),
            id: L::load(&hits.id[g..]),
            part: L::load(&hits.part[g..]),
            current: L::zero(),
        }
    }

    /// Writes it there.
    #[inline(always)]
    pub fn store(&self, hits: &mut HitColumns<L::Elem>, g: usize) {
        self.t.store(&mut hits.t[g..]);
        self.id.store(&mut hits.id[g..]);
        self.part.store(&mut hits.part[g..]);
    }
}

impl<R: Real> Visit<R> for Nearest<R> {
    #[inline(always)]
    fn needs_further(&self, t: R, valid: R::Mask) -> R::Mask {
        valid & !R::zero().lt(t)
    }

    #[inline(always)]
    fn crossing(&mut self, t: R, part: R, valid: R::Mask) {
        let nearer = t.lt(self.t) | (t.same(self.t) & self.current.lt(self.id));
        let m = valid & R::zero().lt(t) & nearer;
        self.t = R::select(m, t, self.t);
        self.id = R::select(m, self.current, self.id);
        self.part = R::select(m, part, self.part);
    }
}
