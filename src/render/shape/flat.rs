//! Plane and disc: y = 0 of their frame.

use super::{Point, Visit};
use crate::math::Real;
use crate::math::real::three;
use crate::render::ray::{LocalRay, Own};

/// Where the ray passes y = 0; NaN or infinite where it runs along.
#[inline(always)]
fn t_at_level<R: Real>(ray: &LocalRay<R>) -> R {
    (-ray.o[1] - ray.o_lo[1]) / ray.d[1]
}

/// Calls `visit(t, part, valid)` for the crossing of the plane.
#[inline(always)]
pub(super) fn plane_crossing<R: Real>(ray: &LocalRay<R>, own: Option<Own<R>>, visit: &mut impl Visit<R>) {
    visit.crossing(t_at_level(ray), R::zero(), is_met(ray, own));
}

/// Calls `visit(t, part, valid)` for the crossing of the ring between the radii `hole` and `r`.
#[inline(always)]
pub(super) fn disc_crossing<R: Real>(
    r: f64,
    hole: f64,
    ray: &LocalRay<R>,
    own: Option<Own<R>>,
    visit: &mut impl Visit<R>,
) {
    let t = t_at_level(ray);
    // Rounding t alone moves the point by an ulp of the distance, which far away is more than the disc: so the rest that the
    // rounded t leaves of the height goes on as a correction.
    let rest = -(ray.at(t)[1] / ray.d[1]);
    let [x, _, z] = three!(
        i => t.mul_add(ray.d[i], ray.o[i]) + rest.mul_add(ray.d[i], t.mul_add(ray.d_lo[i], ray.o_lo[i]))
    );
    let rho2 = x.mul_add(x, z * z);
    let (r, hole) = (R::splat(r), R::splat(hole));
    let valid = is_met(ray, own) & rho2.le(r * r) & (hole * hole).le(rho2);
    visit.crossing(t, R::zero(), valid);
}

/// Rays neither along the plane nor from it.
#[inline(always)]
fn is_met<R: Real>(ray: &LocalRay<R>, own: Option<Own<R>>) -> R::Mask {
    let crosses = !ray.d[1].same(R::zero());
    match own {
        Some(own) => crosses & !own.here,
        None => crosses,
    }
}

/// The point of the plane under `p`: exactly at level 0.
#[inline(always)]
pub(super) fn point<R: Real>(p: [R; 3]) -> Point<R> {
    let zero = R::zero();
    Point { p: [p[0], zero, p[2]], n: [zero, R::one(), zero], error: [zero; 3] }
}
