//! Mirrors and lenses: where light goes at a surface, and how much of it.

use crate::math::Real;
use crate::math::real::{axpy, dot, scaled};

/// The direction `d` mirrored at a surface of unit normal `n`; as long as `d`.
#[inline(always)]
pub fn mirrored<R: Real>(d: [R; 3], n: [R; 3]) -> [R; 3] {
    let along = dot(n, d);
    axpy(-(along + along), n, d)
}

/// What a smooth boundary between two media does with a ray.
pub struct Refracted<R> {
    /// Share of the light that is mirrored; 1 beyond the critical angle.
    pub reflectance: R,
    /// Where the rest goes; of unit length. Means nothing where all is mirrored.
    pub direction: [R; 3],
}

/// Refraction by Snell's law and unpolarised reflectance by Fresnel's formulas (Born, Wolf, *Principles of Optics*, 1.5).
/// `n` faces the viewer, `inside` says where the ray comes from the denser side's shape.
#[inline(always)]
pub fn dielectric<R: Real>(d: [R; 3], n: [R; 3], ior: f64, inside: R::Mask) -> Refracted<R> {
    let (zero, one) = (R::zero(), R::one());
    let d = scaled(one / dot(d, d).sqrt(), d);
    // η: index on this side over index beyond.
    let eta = R::select(inside, R::splat(ior), R::splat(1.0 / ior));
    let cos_i = (-dot(n, d)).max(zero).min(one);
    let sin2_t = eta * eta * (one - cos_i * cos_i);
    let total = one.le(sin2_t);
    let cos_t = (one - sin2_t).max(zero).sqrt();
    let ratio = |a: R, b: R| (a - b) / (a + b);
    let (s, p) = (ratio(eta * cos_i, cos_t), ratio(eta * cos_t, cos_i));
    let half = (s * s + p * p) * R::splat(0.5);
    let reflectance = R::select(total, one, half.min(one));
    let direction = axpy(eta * cos_i - cos_t, n, scaled(eta, d));
    Refracted { reflectance, direction }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::fun;
    use crate::math::real::Bool;

    const N: [f64; 3] = [0.0, 0.0, 1.0];

    fn incoming(degrees: f64) -> [f64; 3] {
        [3.0 * fun::sin_deg(degrees), 0.0, -3.0 * fun::cos_deg(degrees)]
    }

    #[test]
    fn straight_on_loses_the_textbook_four_per_cent() {
        let r = dielectric(incoming(0.0), N, 1.5, Bool(false));
        assert!((r.reflectance - 0.04).abs() < 1e-15 && r.direction == [0.0, 0.0, -1.0]);
    }

    #[test]
    fn snell_brewster_and_total_reflection() {
        let r = dielectric(incoming(40.0), N, 1.5, Bool(false));
        assert!((r.direction[0] - fun::sin_deg(40.0) / 1.5).abs() < 1e-15);
        assert!((dot(r.direction, r.direction) - 1.0).abs() < 1e-14);
        // At Brewster's angle only the s part is mirrored: ((1 − n²)/(1 + n²))², halved.
        let brewster = fun::atan(1.5).to_degrees();
        let r = dielectric(incoming(brewster), N, 1.5, Bool(false));
        assert!((r.reflectance - 0.5 * (1.25f64 / 3.25) * (1.25 / 3.25)).abs() < 1e-14, "{}", r.reflectance);
        let critical = fun::asin(1.0 / 1.5).to_degrees();
        assert!(dielectric(incoming(critical - 0.1), N, 1.5, Bool(true)).reflectance < 1.0);
        assert_eq!(dielectric(incoming(critical + 0.1), N, 1.5, Bool(true)).reflectance, 1.0);
    }

    #[test]
    fn reflectance_is_the_same_both_ways() {
        let there = dielectric(incoming(50.0), N, 1.5, Bool(false));
        let back = dielectric(there.direction.map(|x| -x), [0.0, 0.0, -1.0], 1.5, Bool(true));
        assert!((there.reflectance - back.reflectance).abs() < 1e-14);
    }
}
