//! The box: the overlap of three slabs around its centre.

use super::{Point, Visit};
use crate::math::Real;
use crate::render::ray::{LocalRay, Own};

/// Parts are numbered 2·axis for the lower face, 2·axis + 1 for the upper one.
#[inline(always)]
pub(super) fn crossings<R: Real>(half: [f64; 3], ray: &LocalRay<R>, own: Option<Own<R>>, visit: &mut impl Visit<R>) {
    let zero = R::zero();
    let infinity = R::splat(f64::INFINITY);
    let (mut t_in, mut t_out) = (-infinity, infinity);
    let (mut part_in, mut part_out) = (zero, zero);
    let mut inside = zero.same(zero);
    for (axis, &extent) in half.iter().enumerate() {
        let (h, o, lo, d) = (R::splat(extent), ray.o[axis], ray.o_lo[axis], ray.d[axis]);
        let (to_lower, to_upper) = ((-h - o) - lo, (h - o) - lo);
        let (tl, tu) = (to_lower / d, to_upper / d);
        let up = zero.lt(d);
        let level = d.same(zero);
        // Along the slab it is inside throughout or not at all; the quotients there are not used.
        inside = inside & (!level | (to_lower.le(zero) & zero.le(to_upper)));
        let (lower, upper) = (R::splat(2.0 * axis as f64), R::splat(2.0 * axis as f64 + 1.0));
        let (enter, leave) = (R::select(up, tl, tu), R::select(up, tu, tl));
        let later = !level & t_in.lt(enter);
        t_in = R::select(later, enter, t_in);
        part_in = R::select(later, R::select(up, lower, upper), part_in);
        let sooner = !level & leave.lt(t_out);
        t_out = R::select(sooner, leave, t_out);
        part_out = R::select(sooner, R::select(up, upper, lower), part_out);
    }
    let crosses = inside & t_in.le(t_out);
    let (mut way_in, mut way_out) = (crosses, crosses);
    if let Some(own) = own {
        way_in = way_in & !own.on(part_in);
        way_out = way_out & !own.on(part_out);
    }
    visit.crossing(t_in, part_in, way_in);
    visit.crossing(t_out, part_out, way_out);
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
            &LocalRay { o, o_lo: [0.0; 3], d },
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
