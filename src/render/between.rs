//! What a shadow ray meets between its start and the light.

use super::shape::Visit;
use crate::math::Real;

/// Whether anything lies between a point and the light.
pub struct Blocked<R: Real> {
    /// How far the light is.
    pub distance: R,
    /// From whom it is hidden.
    pub blocked: R::Mask,
}

impl<R: Real> Visit<R> for Blocked<R> {
    #[inline(always)]
    fn needs_further(&self, t: R, valid: R::Mask) -> R::Mask {
        valid & !R::zero().lt(t)
    }

    #[inline(always)]
    fn crossing(&mut self, t: R, _part: R, valid: R::Mask) {
        self.blocked = self.blocked | (valid & R::zero().lt(t) & t.lt(self.distance));
    }
}

/// Remembers the crossings in between: at most four, a torus'.
pub struct Met<R: Real> {
    /// How far the light is.
    pub distance: R,
    /// How far away, on which part, and in which lanes.
    pub crossings: [(R, R, R::Mask); 4],
    /// How many there are.
    pub n: usize,
}

impl<R: Real> Visit<R> for Met<R> {
    #[inline(always)]
    fn crossing(&mut self, t: R, part: R, valid: R::Mask) {
        if self.n < self.crossings.len() {
            self.crossings[self.n] = (t, part, valid & R::zero().lt(t) & t.lt(self.distance));
            self.n += 1;
        }
    }
}
