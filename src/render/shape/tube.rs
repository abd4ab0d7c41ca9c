//! Cylinder, cone and frustum: the solid that a straight profile makes around the y axis, between two planes across it.
//!
//! A ray's stay inside is the overlap of its stay inside the quadric and between the planes. Which crossing is side and which
//! cap is read from that overlap by comparison alone, so side and cap can't leave a gap between them. Open shapes are
//! the same with the caps left out.

use super::quadric::{Coefficients, Crossing, Quadric, on_side, roots};
use super::{BOTTOM, Point, SIDE, TOP, Visit};
use crate::math::real::{each3, three};
use crate::math::{Mask, Real};
use crate::render::ray::{LocalRay, Own, convex_exit};

/// A profile: at height y the radius is `radius + slope·y`, for y from `bottom` to `top`. Nowhere in between negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tube {
    /// Radius at y = 0: the frame's origin is the apex of a pointed cone (then 0), else the centre of the bottom.
    pub radius: f64,
    /// Growth of the radius with y; 0 for a cylinder.
    pub slope: f64,
    /// Lower end.
    pub bottom: f64,
    /// Upper end.
    pub top: f64,
    /// Whether the ends are closed.
    pub caps: bool,
}

impl Quadric for Tube {
    /// Of x² + z² − (radius + slope·y)².
    #[inline(always)]
    fn coefficients<R: Real>(&self, m: [R; 3], d: [R; 3]) -> Coefficients<R> {
        let slope = R::splat(self.slope);
        let w = slope.mul_add(m[1], R::splat(self.radius));
        let s = slope * d[1];
        let (d2, m2) = (d[0].mul_add(d[0], d[2] * d[2]), m[0].mul_add(m[0], m[2] * m[2]));
        Coefficients {
            a: d[0].mul_add(d[0], d[2].mul_sub(d[2], s * s)),
            b: m[0].mul_add(d[0], m[2].mul_sub(d[2], w * s)),
            c: m[0].mul_add(m[0], m[2].mul_sub(m[2], w * w)),
            sizes: [s.mul_add(s, d2), w.mul_add(w, m2)],
        }
    }
}

/// Calls `visit(t, part, valid)` for the way in and the way out.
#[inline(always)]
pub(super) fn crossings<R: Real>(tube: &Tube, ray: &LocalRay<R>, own: Option<Own<R>>, visit: &mut impl Visit<R>) {
    let zero = R::zero();
    // Between the planes. Crossings are compared by τ, which is as good from afar; t is taken from the ray's own origin.
    let dy = ray.d[1];
    let (bottom, top) = (R::splat(tube.bottom), R::splat(tube.top));
    let (to_bottom, to_top) = (ray.way_to(1, bottom), ray.way_to(1, top));
    let up = zero.lt(dy);
    let level = dy.same(zero);
    let level_inside = to_bottom.le(zero) & zero.le(to_top);
    let (t_bottom, t_top) = (to_bottom / dy, to_top / dy);
    // Seen from the line's point nearest to the axis, but between the planes: however slim the shape is, that point is as near
    // to where it is crossed as the shape is wide. From the point nearest to the frame's origin, a slim shape's two sides
    // are a small difference of large numbers.
    let t_axis = -(ray.o[0].mul_add(ray.d[0], ray.o[2] * ray.d[2]) / ray.d[0].mul_add(ray.d[0], ray.d[2] * ray.d[2]));
    let within = t_axis.min(t_bottom.max(t_top)).max(t_bottom.min(t_top));
    let t0 = R::select(level, t_axis, within);
    let from = ray.moved(t0);
    let near = (t0, each3!(from, m => m.0));
    let x = roots(
        ray,
        near,
        tube,
        on_side(&own, SIDE),
        #[inline(always)]
        |_, _| R::Mask::splat(true),
    );
    if !(x.real | x.always_inside).any() && own.is_none() {
        return; // the line passes by
    }
    let (m, m_lo) = from[1];
    let at_bottom = Crossing { tau: ((bottom - m) - m_lo) / dy, t: t_bottom };
    let at_top = Crossing { tau: ((top - m) - m_lo) / dy, t: t_top };
    let (before_all, after_all) = (Crossing::never(-1.0), Crossing::never(1.0));
    let slab_in = Crossing::select(level, before_all, Crossing::select(up, at_bottom, at_top));
    let slab_out = Crossing::select(level, after_all, Crossing::select(up, at_top, at_bottom));

    // Inside the quadric: between the roots, or, where the form falls off in both directions, on the half-line that lies
    // on our side of the apex: the one that overlaps the slab.
    let steep = x.a.lt(zero);
    let before = (slab_out.tau - x.hi.tau).lt(x.lo.tau - slab_in.tau);
    let side_in = Crossing::select(steep, Crossing::select(before, before_all, x.hi), x.lo);
    let side_out = Crossing::select(steep, Crossing::select(before, x.lo, after_all), x.hi);
    let side_in = Crossing::select(x.always_inside, before_all, side_in);
    let side_out = Crossing::select(x.always_inside, after_all, side_out);

    let in_by_side = slab_in.tau.le(side_in.tau);
    let out_by_side = side_out.tau.le(slab_out.tau);
    let enter = Crossing::select(in_by_side, side_in, slab_in);
    let leave = Crossing::select(out_by_side, side_out, slab_out);
    let crosses = (x.real | x.always_inside) & enter.tau.le(leave.tau) & (!level | level_inside);

    let (side, low, high) = (R::splat(SIDE), R::splat(BOTTOM), R::splat(TOP));
    let part_in = R::select(in_by_side, side, R::select(up, low, high));
    let part_out = R::select(out_by_side, side, R::select(up, high, low));
    let t_out = R::select(crosses, leave.t, zero); // of a ray that starts on it, but seems beside it: the nearest
    let (mut way_in, t_out, mut way_out) = convex_exit(&own, crosses, t_out, crosses);
    if !tube.caps {
        way_in = way_in & in_by_side;
        way_out = way_out & out_by_side;
    }
    visit.crossing(enter.t, part_in, way_in);
    visit.crossing(t_out, part_out, way_out);
}

/// The point of the surface under `p`, on `part`.
#[inline(always)]
pub(super) fn point<R: Real>(tube: &Tube, p: [R; 3], part: R) -> Point<R> {
    let (zero, one) = (R::zero(), R::one());
    let on_side = part.same(R::splat(SIDE));
    let on_bottom = part.same(R::splat(BOTTOM));
    let slope = R::splat(tube.slope);

    let rho = p[0].mul_add(p[0], p[2] * p[2]).sqrt();
    let at_axis = rho.same(zero);
    let away = one / R::select(at_axis, one, rho);
    let (ex, ez) = (p[0] * away, p[2] * away);
    let w = slope.mul_add(p[1], R::splat(tube.radius));
    // Normal of the side: the gradient, exact everywhere but the apex, where it is taken along the axis.
    let tilt = one / R::splat(tube.slope * tube.slope + 1.0).sqrt();
    let side_n = [ex * tilt, -slope * tilt, ez * tilt];
    let apex_n = [zero, one.copysign(-slope), zero];
    let cap_n = [zero, R::select(on_bottom, -one, one), zero];
    let cap_y = R::select(on_bottom, R::splat(tube.bottom), R::splat(tube.top));

    let pick = |side: R, apex: R, cap: R| R::select(on_side, R::select(at_axis, apex, side), cap);
    let q = [R::select(on_side, ex * w, p[0]), R::select(on_side, p[1], cap_y), R::select(on_side, ez * w, p[2])];
    let n = three!(i => pick(side_n[i], apex_n[i], cap_n[i]));
    // Radius 2, of the sum's larger part; dot and root 3, quotient 1, products 2, and one to spare. A cap's height is exact.
    let gamma = R::splat(9.0 * R::UNIT_ROUNDOFF);
    let reach = gamma * (R::splat(tube.radius) + (slope * p[1]).abs());
    let error = |e: R| R::select(on_side, reach * e.abs(), zero);
    Point { p: q, n, error: [error(ex), zero, error(ez)] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::real::Bool;

    fn hits(tube: &Tube, o: [f64; 3], d: [f64; 3]) -> Vec<(f64, f64)> {
        let mut out = Vec::new();
        let ray = LocalRay { o, o_lo: [0.0; 3], d, d_lo: [0.0; 3] };
        crossings(tube, &ray, None, &mut |t: f64, part: f64, ok: Bool| {
            if ok.0 && t > 0.0 {
                out.push((t, part));
            }
        });
        out
    }

    const CONE: Tube = Tube { radius: 0.0, slope: -0.5, bottom: -2.0, top: 0.0, caps: true };
    const CAN: Tube = Tube { radius: 1.0, slope: 0.0, bottom: 0.0, top: 2.0, caps: true };

    #[test]
    fn cylinder_sides_and_caps() {
        assert_eq!(hits(&CAN, [5.0, 1.0, 0.0], [-1.0, 0.0, 0.0]), [(4.0, SIDE), (6.0, SIDE)]);
        assert_eq!(hits(&CAN, [0.5, 5.0, 0.0], [0.0, -1.0, 0.0]), [(3.0, TOP), (5.0, BOTTOM)]);
        assert_eq!(hits(&CAN, [1.5, 5.0, 0.0], [0.0, -1.0, 0.0]), []);
        assert_eq!(hits(&CAN, [5.0, 2.5, 0.0], [-1.0, 0.0, 0.0]), []);
        let open = Tube { caps: false, ..CAN };
        assert_eq!(hits(&open, [0.5, 5.0, 0.0], [0.0, -1.0, 0.0]), []);
        assert_eq!(hits(&open, [0.0, 5.0, 0.0], [0.25, -1.0, 0.0]), [(4.0, SIDE)], "in through the opening");
    }

    #[test]
    fn cone_from_all_around() {
        assert_eq!(hits(&CONE, [5.0, -1.0, 0.0], [-1.0, 0.0, 0.0]), [(4.5, SIDE), (5.5, SIDE)]);
        assert_eq!(hits(&CONE, [0.25, 5.0, 0.0], [0.0, -1.0, 0.0]), [(5.5, SIDE), (7.0, BOTTOM)]);
        assert_eq!(hits(&CONE, [0.0, -5.0, 0.0], [0.0, 1.0, 0.0]), [(3.0, BOTTOM), (5.0, SIDE)], "through the apex");
        assert_eq!(hits(&CONE, [5.0, 0.5, 0.0], [-1.0, 0.0, 0.0]), [], "the other nappe isn't ours");
        assert_eq!(hits(&CONE, [1.5, 5.0, 0.0], [0.0, -1.0, 0.0]), []);
    }

    #[test]
    fn own_crossing_is_taken_out() {
        let o = [1.0, 1.0, 0.0];
        let ray = LocalRay { o, o_lo: [0.0; 3], d: [-1.0, 0.0, 0.0], d_lo: [0.0; 3] };
        let mut left = Vec::new();
        let own = Own { here: Bool(true), part: SIDE, outward: Bool(false) };
        crossings(&CAN, &ray, Some(own), &mut |t: f64, _: f64, ok: Bool| {
            if ok.0 {
                left.push(t);
            }
        });
        assert_eq!(left, [2.0]);
    }
}
