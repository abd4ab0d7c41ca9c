//! Rays against one box, each for itself.

use crate::math::Real;
use crate::math::real::each3;
use crate::render::bounds::{Bounds, larger};

/// Rays, prepared for boxes.
pub struct Slabs<R> {
    /// The origin for the lower faces and that for the upper.
    o: [[R; 3]; 2],
    inverse: [R; 3],
}

impl<R: Real> Slabs<R> {
    /// Rays from `o` along `d`.
    #[inline(always)]
    pub fn new(o: [R; 3], d: [R; 3]) -> Slabs<R> {
        // How far a turned surface may seem off by what its frame makes of an origin this far out: 16 roundings, as many as
        // boxes are wider by for their own distance.
        let reach = R::splat(16.0 * R::UNIT_ROUNDOFF) * o[0].abs().max(o[1].abs()).max(o[2].abs());
        let o = [each3!(o, x => x + reach), each3!(o, x => x - reach)];
        Slabs { o, inverse: each3!(d, x => R::one() / x) }
    }

    /// Which rays meet a box at a t from 0 to `t_max`. Never misses by rounding: the far side is widened (Ize, "Robust BVH ray
    /// traversal", JCGT 2(2), 2013), and so is `t_max`, or a box that begins at the very t of a hit would hide another one
    /// there; a NaN (0·∞, a ray within a face) never wins a comparison.
    #[inline(always)]
    pub fn meet(&self, b: &Bounds, t_max: R) -> R::Mask {
        let widen = R::splat(1.0 + 8.0 * R::UNIT_ROUNDOFF);
        let (mut near, mut far) = (R::zero(), t_max * widen);
        for i in 0..3 {
            let (mut lo, mut hi) = (b.lo[i], b.hi[i]);
            if R::UNIT_ROUNDOFF > f64::EPSILON {
                // Box, centre and size were rounded on the way into a shorter format.
                let reach = 16.0 * R::UNIT_ROUNDOFF * larger(lo.abs(), hi.abs());
                (lo, hi) = (lo - reach, hi + reach);
            }
            let (lo, hi) = (R::splat(lo), R::splat(hi));
            let (t0, t1) = ((lo - self.o[0][i]) * self.inverse[i], (hi - self.o[1][i]) * self.inverse[i]);
            let swap = self.inverse[i].lt(R::zero());
            let (enter, leave) = (R::select(swap, t1, t0), R::select(swap, t0, t1));
            near = enter.max(near);
            far = (leave * widen).min(far);
        }
        near.le(far)
    }
}
