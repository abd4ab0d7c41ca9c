//! Plane and disc: y = 0 of their frame.

use super::{Point, Visit};
use crate::math::Real;
use crate::render::ray::{LocalRay, Own};

/// Where the ray passes y = 0; NaN or infinite where it runs along.
#[inline(always)]
fn t_at_level<R: Real>(ray: &LocalRay<R>) -> R {
    (-ray.o[1] - ray.o_lo[1]) / ray.d[1]
}

/// Calls `visit(t, part, valid)` for the crossing of the plane.
#[inline(always)]
pub(super) fn plane_crossing<R: Real>(ray: &LocalRay<R>, own: Option<Own<R>>, visit: &mut impl Visit<R>) {
    let mut valid = !ray.d[1].same(R::zero());
    if let Some(own) = own {
        valid = valid & !own.here;
    }
    visit.crossing(t_at_level(ray), R::zero(), valid);
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
    let p = ray.at(t);
    let rho2 = p[0].mul_add(p[0], p[2] * p[2]);
    let (r, hole) = (R::splat(r), R::splat(hole));
    let mut valid = !ray.d[1].same(R::zero()) & rho2.le(r * r) & (hole * hole).le(rho2);
    if let Some(own) = own {
        valid = valid & !own.here;
    }
    visit.crossing(t, R::zero(), valid);
}

/// The point of the plane under `p`: exactly at level 0.
#[inline(always)]
pub(super) fn point<R: Real>(p: [R; 3]) -> Point<R> {
    let zero = R::zero();
    Point { p: [p[0], zero, p[2]], n: [zero, R::one(), zero], error: [zero; 3] }
}
