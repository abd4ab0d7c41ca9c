//! Rays as the kernels see them: in the frame of one shape, with what rounding left out of the origin.

use crate::math::Real;
use crate::math::real::three;

/// A ray in a shape's own frame. `t` is the same number as in the world.
#[derive(Clone, Copy, Debug)]
pub struct LocalRay<R> {
    /// Origin, rounded.
    pub o: [R; 3],
    /// What `o` misses of the exact origin.
    pub o_lo: [R; 3],
    /// Direction; any length but 0.
    pub d: [R; 3],
}

impl<R: Real> LocalRay<R> {
    /// The point at `t`: one rounding on the large part, so nothing is lost to the distance of the origin.
    #[inline(always)]
    pub fn at(&self, t: R) -> [R; 3] {
        three(|i| t.mul_add(self.d[i], self.o[i]) + self.o_lo[i])
    }
}

/// Where a ray starts on a surface: the crossing that it starts from is taken out of that surface's roots, so that no
/// distance has to be called too short ("deflation").
#[derive(Clone, Copy, Debug)]
pub struct Own<R: Real> {
    /// Lanes that start on this primitive.
    pub here: R::Mask,
    /// The part of it that they start on.
    pub part: R,
}

impl<R: Real> Own<R> {
    /// Lanes that start on `part` of this primitive.
    #[inline(always)]
    pub fn on(&self, part: R) -> R::Mask {
        self.here & self.part.same(part)
    }
}
