//! Rays as the kernels see them: in the frame of one shape, with what rounding left out of the origin.

use crate::math::real::{dot, each3, three};
use crate::math::{Mask, Real};

/// A ray in a shape's own frame. `t` is the same number as in the world.
#[derive(Clone, Copy, Debug)]
pub struct LocalRay<R> {
    /// Origin, rounded.
    pub o: [R; 3],
    /// What `o` misses of the exact origin.
    pub o_lo: [R; 3],
    /// Direction, rounded; any length but 0.
    pub d: [R; 3],
    /// What `d` misses of the exact direction: over a long way even that much turns a ray aside visibly.
    pub d_lo: [R; 3],
}

impl<R: Real> LocalRay<R> {
    /// The way along an axis to the coordinate `level`, rounded once: surfaces in one plane are met at one t, wherever their
    /// frames have their origins.
    #[inline(always)]
    pub fn way_to(&self, axis: usize, level: R) -> R {
        let (way, error) = level.two_sum(-self.o[axis]);
        way + (error - self.o_lo[axis])
    }

    /// The point at `t`: one rounding on the large part, so nothing is lost to the distance of the origin.
    #[inline(always)]
    pub fn at(&self, t: R) -> [R; 3] {
        three!(i => t.mul_add(self.d[i], self.o[i]) + t.mul_add(self.d_lo[i], self.o_lo[i]))
    }

    /// The parameter of the line's point nearest to the frame's origin, rounded, and the line's point [there](LocalRay::moved):
    /// from here a shape is judged as well as from near by, however far the ray starts.
    #[inline(always)]
    pub fn nearest(&self) -> (R, [R; 3]) {
        let t0 = -(dot(self.o, self.d) / dot(self.d, self.d));
        (t0, each3!(self.moved(t0), m => m.0))
    }

    /// The line's point at `t0` with what rounding left out put back (TwoProd, TwoSum), and what that leaves out still: along
    /// a face even that decides where it is crossed.
    #[inline(always)]
    pub fn moved(&self, t0: R) -> [(R, R); 3] {
        three!(i => {
            let (p, e) = t0.two_prod(self.d[i]);
            let (s, se) = self.o[i].two_sum(p);
            s.two_sum(se + (e + t0.mul_add(self.d_lo[i], self.o_lo[i])))
        })
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
    /// Lanes whose rays leave to the outside: the side that the surface's normal points to. From a convex shape they don't
    /// come back.
    pub outward: R::Mask,
}

impl<R: Real> Own<R> {
    /// Where any lane starts `here`; mostly none does, and what follows from it needn't be computed.
    #[inline(always)]
    pub fn of(here: R::Mask, part: R, outward: R::Mask) -> Option<Own<R>> {
        if here.any() { Some(Own { here, part, outward }) } else { None }
    }

    /// Lanes that start on `part` of this primitive.
    #[inline(always)]
    pub fn on(&self, part: R) -> R::Mask {
        self.here & self.part.same(part)
    }
}

/// What a ray that starts on a convex shape can still meet of it. To the outside nothing; to the inside the way out,
/// however near: rounding may put it at the start or behind, but light that went in must come out.
#[inline(always)]
pub fn convex_exit<R: Real>(
    own: &Option<Own<R>>,
    way_in: R::Mask,
    t_out: R,
    way_out: R::Mask,
) -> (R::Mask, R, R::Mask) {
    let Some(own) = own else { return (way_in, t_out, way_out) };
    let inward = own.here & !own.outward;
    let least = R::splat(R::LEAST);
    // A NaN, of a ray that only touches, is the nearest way out too.
    let t_exit = R::select(least.lt(t_out), t_out, least);
    (way_in & !own.here, R::select(inward, t_exit, t_out), (way_out & !own.here) | inward)
}
