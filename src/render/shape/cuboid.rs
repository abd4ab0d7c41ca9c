//! The box: the overlap of three slabs around its centre.

use super::{Point, Visit};
use crate::math::{Mask, Real};
use crate::render::ray::{LocalRay, Own, convex_exit};

/// Parts are numbered 2·axis for the lower face, 2·axis + 1 for the upper one.
///
/// Which face comes first is judged from the line's point nearest to the centre, so that edges are as sharp from afar; t is
/// then taken from the ray's own origin.
#[inline(always)]
pub(super) fn crossings<R: Real>(half: [f64; 3], ray: &LocalRay<R>, own: Option<Own<R>>, visit: &mut impl Visit<R>) {
    let zero = R::zero();
    let nearest = ray.moved(ray.nearest().0);
    let mut enter: Wall<R> = Wall::at(-f64::INFINITY);
    let mut leave: Wall<R> = Wall::at(f64::INFINITY);
    let mut inside = zero.same(zero);
    for (axis, &extent) in half.iter().enumerate() {
        let (h, d) = (R::splat(extent), ray.d[axis]);
        let (m, m_lo) = nearest[axis];
        let up = zero.lt(d);
        let level = d.same(zero);
        // Along the slab it is inside throughout or not at all; the quotients there are not used.
        let (to_lower, to_upper) = (ray.way_to(axis, -h), ray.way_to(axis, h));
        inside = inside & (!level | (to_lower.le(zero) & zero.le(to_upper)));
        let inverse = R::one() / d;
        let lower = Wall { tau: ((-h - m) - m_lo) * inverse, to: to_lower, d, part: R::splat(2.0 * axis as f64) };
        let upper = Wall { tau: ((h - m) - m_lo) * inverse, to: to_upper, d, part: R::splat(2.0 * axis as f64 + 1.0) };
        let (first, second) = (Wall::select(up, lower, upper), Wall::select(up, upper, lower));
        enter = Wall::select(!level & enter.tau.lt(first.tau), first, enter);
        leave = Wall::select(!level & second.tau.lt(leave.tau), second, leave);
    }
    let crosses = inside & enter.tau.le(leave.tau);
    if own.is_none() && !crosses.any() {
        return; // the line passes by
    }
    let t_in = enter.to / enter.d;
    let Some(own) = own else {
        visit.crossing(t_in, enter.part, crosses);
        if visit.needs_further(t_in, crosses).any() {
            visit.crossing(t_in.max(leave.to / leave.d), leave.part, crosses);
        }
        return;
    };
    // Of an edge, rounding may put the way out before the way in, and then it would matter whether it was asked for.
    let t_out = leave.to / leave.d;
    let t_out = R::select(own.here, t_out, t_in.max(t_out));
    let (way_in, t_out, way_out) = convex_exit(&Some(own), crosses, t_out, crosses);
    visit.crossing(t_in, enter.part, way_in);
    visit.crossing(t_out, leave.part, way_out);
}

/// Where a line passes a face's plane.
#[derive(Clone, Copy)]
struct Wall<R> {
    /// From the line's point nearest to the centre.
    tau: R,
    /// The way there across the plane, from the ray's origin, and the direction's share of it.
    to: R,
    d: R,
    part: R,
}

impl<R: Real> Wall<R> {
    #[inline(always)]
    fn at(tau: f64) -> Self {
        Wall { tau: R::splat(tau), to: R::splat(tau), d: R::one(), part: R::zero() }
    }
    #[inline(always)]
    fn select(m: R::Mask, a: Self, b: Self) -> Self {
        let pick = |x: R, y: R| R::select(m, x, y);
        Wall { tau: pick(a.tau, b.tau), to: pick(a.to, b.to), d: pick(a.d, b.d), part: pick(a.part, b.part) }
    }
}

/// The point of face `part` under `p`: exactly on that face.
#[inline(always)]
pub(super) fn point<R: Real>(half: [f64; 3], p: [R; 3], part: R) -> Point<R> {
    let zero = R::zero();
    let (mut q, mut n) = (p, [zero; 3]);
    for (axis, &extent) in half.iter().enumerate() {
        let lower = part.same(R::splat(2.0 * axis as f64));
        let upper = part.same(R::splat(2.0 * axis as f64 + 1.0));
        q[axis] = R::select(lower, R::splat(-extent), R::select(upper, R::splat(extent), q[axis]));
        n[axis] = R::select(lower, -R::one(), R::select(upper, R::one(), zero));
    }
    Point { p: q, n, error: [zero; 3] }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hits(o: [f64; 3], d: [f64; 3]) -> Vec<(f64, f64)> {
        let mut out = Vec::new();
        crossings(
            [1.0, 2.0, 3.0],
            &LocalRay { o, o_lo: [0.0; 3], d, d_lo: [0.0; 3] },
            None,
            &mut |t: f64, part: f64, ok: crate::math::real::Bool| {
                if ok.0 {
                    out.push((t, part));
                }
            },
        );
        out
    }

    #[test]
    fn faces_and_grazing_rays() {
        assert_eq!(hits([0.0, 0.0, 5.0], [0.0, 0.0, -1.0]), [(2.0, 5.0), (8.0, 4.0)]);
        assert_eq!(hits([-4.0, 2.0, 0.0], [1.0, 0.0, -0.0]), [(3.0, 0.0), (5.0, 1.0)], "along a face");
        assert_eq!(hits([-4.0, 2.1, 0.0], [1.0, 0.0, 0.0]), []);
        assert_eq!(hits([-4.0, 0.0, 3.5], [1.0, 0.1, 0.0]), []);
    }
}
