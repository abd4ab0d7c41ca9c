//! The sphere; ellipsoids are spheres in a stretched frame.

use super::quadric::{Quadric, roots};
use super::{Point, SIDE, Visit};
use crate::math::Real;
use crate::math::real::{dot, each3};
use crate::render::ray::{LocalRay, Own};

/// |p|² − r².
pub(super) struct Ball<R> {
    pub(super) r: R,
}

impl<R: Real> Quadric<R> for Ball<R> {
    #[inline(always)]
    fn coefficients(&self, m: [R; 3], d: [R; 3]) -> (R, R, R) {
        (dot(d, d), dot(m, d), dot(m, m) - self.r * self.r)
    }
}

/// Calls `visit(t, part, valid)` for both crossings.
#[inline(always)]
pub(super) fn crossings<R: Real>(r: f64, ray: &LocalRay<R>, own: Option<Own<R>>, visit: &mut impl Visit<R>) {
    let part = R::splat(SIDE);
    let x = roots(ray, &Ball { r: R::splat(r) });
    let (mut near, mut far) = (x.real, x.real);
    if let Some(own) = own {
        let nearest_is_lo = x.lo.abs().lt(x.hi.abs());
        near = near & !(own.here & nearest_is_lo);
        far = far & !(own.here & !nearest_is_lo);
    }
    visit.crossing(x.lo, part, near);
    visit.crossing(x.hi, part, far);
}

/// The point of the sphere under `p`.
#[inline(always)]
pub(super) fn point<R: Real>(r: f64, p: [R; 3]) -> Point<R> {
    let scale = R::one() / dot(p, p).sqrt();
    let n = each3(p, |x| x * scale);
    let p = each3(n, |x| x * R::splat(r));
    // dot 3, root 1, quotient 1, products 2, and one to spare
    let gamma = R::splat(8.0 * R::UNIT_ROUNDOFF);
    Point { p, n, error: each3(p, |x| gamma * x.abs()) }
}
