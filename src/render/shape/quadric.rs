//! Where a line crosses a quadric: the one recipe behind sphere, ellipsoid, cylinder and cone.
//!
//! The discriminant isn't the problem, the coefficients are: so the origin is moved to the point of the line nearest the
//! frame's origin, with its rounding errors kept (TwoProd, TwoSum), and the quadratic is solved there with Kahan's
//! difference of products and the stable pair of roots q/a, c/q.

use crate::math::real::{difference_of_products, dot, three, two_sum};
use crate::math::{Mask, Real};
use crate::render::ray::LocalRay;

/// A quadratic form of a point, negative inside.
pub trait Quadric<R: Real> {
    /// (a, b, c) of `form(m + τ·d) = a·τ² + 2·b·τ + c`.
    fn coefficients(&self, m: [R; 3], d: [R; 3]) -> (R, R, R);
}

/// The crossings of a line, and how the form behaves between them.
#[derive(Clone, Copy, Debug)]
pub struct Roots<R: Real> {
    /// The smaller root.
    pub lo: R,
    /// The larger root.
    pub hi: R,
    /// Where they are real.
    pub real: R::Mask,
    /// Leading coefficient: the form is negative between the roots where it is positive, outside where it is negative.
    pub a: R,
    /// Where the form is constant along the line, and negative: no crossing, but inside throughout.
    pub always_inside: R::Mask,
}

/// Solves for the crossings of `ray`'s line with `form` = 0.
#[inline(always)]
pub fn roots<R: Real>(ray: &LocalRay<R>, form: &impl Quadric<R>) -> Roots<R> {
    let (zero, d) = (R::zero(), ray.d);
    let t0 = -(dot(ray.o, d) / dot(d, d));
    let m = three(|i| {
        let p = t0 * d[i];
        let e = t0.mul_sub(d[i], p);
        let (s, se) = two_sum(ray.o[i], p);
        s + (se + (e + ray.o_lo[i]))
    });
    let (a, b, c) = form.coefficients(m, d);
    let disc = difference_of_products(b, b, a, c);
    let constant = a.same(zero) & b.same(zero);
    // A form that falls off in both directions (a cone seen steeply) always has crossings; a negative discriminant there
    // is a rounding error at the apex.
    let real = (zero.le(disc) | a.lt(zero)) & !constant;
    let (x, y) = pair(a, b, c, disc);
    let (mut lo, mut hi) = (t0 + x, t0 + y);

    // A crossing much nearer than the point that the coefficients were taken at: its t is a small difference of large
    // numbers. Such rays start near the surface, where the coefficients at the ray's own origin are the good ones. An
    // eighth loses at most three of 53 bits.
    let (eight, shift) = (R::splat(8.0), t0.abs());
    let near_lo = real & (lo.abs() * eight).lt(shift);
    let near_hi = real & (hi.abs() * eight).lt(shift);
    if (near_lo | near_hi).any() {
        let (a, b, c) = form.coefficients(ray.o, d);
        let (x, y) = pair(a, b, c, difference_of_products(b, b, a, c));
        lo = R::select(near_lo, x, lo);
        hi = R::select(near_hi, y, hi);
    }
    Roots { lo, hi, real, a, always_inside: constant & c.le(zero) }
}

/// The two roots of a·τ² + 2·b·τ + c, in order; an infinite one where a = 0.
#[inline(always)]
fn pair<R: Real>(a: R, b: R, c: R, disc: R) -> (R, R) {
    let zero = R::zero();
    let q = -(b + R::select(zero.lt(disc), disc, zero).sqrt().copysign(b));
    let x = q / a;
    let y = R::select(q.same(zero), zero, c / q); // a double root at 0: c is 0 too
    (x.min(y), x.max(y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::shape::sphere::Ball;

    fn ray(o: [f64; 3], d: [f64; 3]) -> LocalRay<f64> {
        LocalRay { o, o_lo: [0.0; 3], d }
    }

    #[test]
    fn far_origin_loses_nothing() {
        // A unit sphere seen from 2^30 away: exact roots 2^30 ∓ 1.
        let d = (1u64 << 30) as f64;
        let r = roots(&ray([0.0, 0.0, d], [0.0, 0.0, -1.0]), &Ball { r: 1.0 });
        assert_eq!((r.lo, r.hi), (d - 1.0, d + 1.0));
    }

    #[test]
    fn crossings_near_the_origin_keep_relative_accuracy() {
        let tiny = 1.0 / (1u64 << 40) as f64;
        let r = roots(&ray([0.0, 0.0, 1.0 - tiny], [0.0, 0.0, 1.0]), &Ball { r: 1.0 });
        assert!((r.hi / tiny - 1.0).abs() < 1e-9, "{}", r.hi);
    }

    #[test]
    fn tangent_is_one_double_root() {
        let r = roots(&ray([1.0, 0.0, 5.0], [0.0, 0.0, -1.0]), &Ball { r: 1.0 });
        assert!(r.real.0);
        assert_eq!((r.lo, r.hi), (5.0, 5.0));
    }
}
