//! The sphere; ellipsoids are spheres in a stretched frame.

use super::quadric::{Coefficients, Quadric, on_side, roots};
use super::{Point, SIDE, Visit};
use crate::math::Real;
use crate::math::real::{dot, each3};
use crate::render::ray::{LocalRay, Own, convex_exit};

/// |p|² − r².
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    /// Its radius.
    pub r: f64,
}

impl Quadric for Ball {
    #[inline(always)]
    fn coefficients<R: Real>(&self, m: [R; 3], d: [R; 3]) -> Coefficients<R> {
        let (a, m2) = (dot(d, d), dot(m, m));
        let r2 = R::splat(self.r) * R::splat(self.r);
        Coefficients { a, b: dot(m, d), c: m2 - r2, sizes: [a, m2 + r2] }
    }
}

/// Calls `visit(t, part, valid)` for both crossings.
#[inline(always)]
pub(super) fn crossings<R: Real>(r: f64, ray: &LocalRay<R>, own: Option<Own<R>>, visit: &mut impl Visit<R>) {
    let part = R::splat(SIDE);
    let x = roots(
        ray,
        ray.nearest(),
        &Ball { r },
        on_side(&own, SIDE),
        #[inline(always)]
        |t, real| visit.needs_further(t, real),
    );
    let (way_in, t_out, way_out) = convex_exit(&own, x.real, x.hi.t, x.real);
    visit.crossing(x.lo.t, part, way_in);
    if x.further || own.is_some() {
        visit.crossing(t_out, part, way_out);
    }
}

/// The point of the sphere under `p`.
#[inline(always)]
pub(super) fn point<R: Real>(r: f64, p: [R; 3]) -> Point<R> {
    let scale = R::one() / dot(p, p).sqrt();
    let n = each3!(p, x => x * scale);
    let p = each3!(n, x => x * R::splat(r));
    // dot 3, root 1, quotient 1, products 2, and one to spare
    let gamma = R::splat(8.0 * R::UNIT_ROUNDOFF);
    Point { p, n, error: each3!(p, x => gamma * x.abs()) }
}
