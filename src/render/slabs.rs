//! Rays against one box, each for itself.

use super::bounds::{Bounds, larger};
use crate::math::Real;
use crate::math::real::{each3, splat3, three};

/// Rays, prepared for boxes.
pub struct Slabs<R> {
    /// The origin for the lower faces and that for the upper.
    o: [[R; 3]; 2],
    inverse: [R; 3],
    /// What the far side is multiplied by.
    widen: R,
}

impl<R: Real> Slabs<R> {
    /// Rays from `o` along `d` that miss no box with a surface that a kernel may see them meet.
    #[inline(always)]
    pub fn new(o: [R; 3], d: [R; 3]) -> Slabs<R> {
        // How far a turned surface may seem off by what its frame makes of an origin this far out: 16 roundings, as many as
        // boxes are wider by for their own distance.
        let reach = R::splat(16.0 * R::UNIT_ROUNDOFF) * o[0].abs().max(o[1].abs()).max(o[2].abs());
        Slabs::wider(o, d, [reach; 3])
    }

    /// Rays from `o` along `d` that are in a box where they are in it exactly, and just beside it: nobody who errs on the side of
    /// keeping thinks that they miss it.
    #[inline(always)]
    pub fn narrow(o: [R; 3], d: [R; 3]) -> Slabs<R> {
        Slabs::wider(o, d, each3!(o, x => R::splat(ROUNDINGS * R::UNIT_ROUNDOFF) * x.abs()))
    }

    #[inline(always)]
    fn wider(o: [R; 3], d: [R; 3], reach: [R; 3]) -> Slabs<R> {
        let o = [three!(i => o[i] + reach[i]), three!(i => o[i] - reach[i])];
        Slabs { o, inverse: each3!(d, x => R::one() / x), widen: R::splat(1.0 + 8.0 * R::UNIT_ROUNDOFF) }
    }

    /// Which rays meet a box at a t from 0 to `t_max`. `t_max` is widened, or a box that begins at the very t of a hit would hide
    /// another one there.
    #[inline(always)]
    pub fn meet(&self, b: &Bounds, t_max: R) -> R::Mask {
        let (mut lo, mut hi) = (b.lo, b.hi);
        if R::UNIT_ROUNDOFF > f64::EPSILON {
            // Box, centre and size were rounded on the way into a shorter format.
            for i in 0..3 {
                let reach = 16.0 * R::UNIT_ROUNDOFF * larger(lo[i].abs(), hi[i].abs());
                (lo[i], hi[i]) = (lo[i] - reach, hi[i] + reach);
            }
        }
        let (enter, leave) = self.stay([splat3(lo), splat3(hi)], (R::zero(), t_max * self.widen));
        enter.le(leave)
    }

    /// From which t to which rays are between lower and upper faces, of the t from `least` to `most`; none where the first is above
    /// the second. Never too short by rounding: the far side is widened (Ize, "Robust BVH ray traversal", JCGT 2(2), 2013); a
    /// NaN (0·∞, a ray within a face) never wins a comparison.
    #[inline(always)]
    pub fn stay(&self, [lo, hi]: [[R; 3]; 2], (least, most): (R, R)) -> (R, R) {
        let (mut near, mut far) = (least, most);
        for i in 0..3 {
            let (t0, t1) = ((lo[i] - self.o[0][i]) * self.inverse[i], (hi[i] - self.o[1][i]) * self.inverse[i]);
            let swap = self.inverse[i].lt(R::zero());
            let (enter, leave) = (R::select(swap, t1, t0), R::select(swap, t0, t1));
            near = enter.max(near);
            far = (leave * self.widen).min(far);
        }
        (near, far)
    }

    /// The same of any t, with faces that were rounded to this format, each for itself.
    #[inline(always)]
    pub fn stay_near(&self, [lo, hi]: [[R; 3]; 2]) -> (R, R) {
        let roundings = R::splat(ROUNDINGS * R::UNIT_ROUNDOFF);
        let (lo, hi) = (each3!(lo, x => x - roundings * x.abs()), each3!(hi, x => x + roundings * x.abs()));
        self.stay([lo, hi], (R::splat(f64::NEG_INFINITY), R::splat(f64::INFINITY)))
    }
}

/// Of a face's or an origin's coordinate: its own, the difference's, and two to spare. Fewer than all who skip boxes allow for.
const ROUNDINGS: f64 = 4.0;
