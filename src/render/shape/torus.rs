//! The torus: a quartic, whose roots are isolated between the roots of its derivatives and polished on the distance to the
//! tube, which stays well-conditioned where the quartic doesn't.
//!
//! Root isolation after Yuksel, "High-performance polynomial root finding for graphics", HPG 2022.

use super::{Point, SIDE, Visit};
use crate::math::Real;
use crate::math::affine::reciprocal_power;
use crate::math::fun::sqrt;
use crate::math::real::{dot, each3, three, two_sum};
use crate::render::bounds::larger;
use crate::render::ray::{LocalRay, Own};

/// A ring around the y axis, of unit magnitude: fourth powers of its lengths stay in range whatever the scene's scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// Radius of the circle in the middle of the tube, times `scale`.
    pub r: f64,
    /// Radius of the tube, times `scale`.
    pub tube: f64,
    /// The power of two that brings `r` into 1..2; multiplying by it is exact.
    pub scale: f64,
}

impl Ring {
    /// The ring with these radii.
    pub fn new(r: f64, tube: f64) -> Ring {
        let scale = reciprocal_power(r);
        Ring { r: r * scale, tube: tube * scale, scale }
    }
}

/// Calls `visit(t, part, valid)` for up to four crossings.
#[inline(always)]
pub(super) fn crossings<R: Real>(ring: &Ring, ray: &LocalRay<R>, own: Option<Own<R>>, visit: &mut impl Visit<R>) {
    // A missing root is NaN, which no comparison lets through.
    let [o, lo, d] = [ray.o, ray.o_lo, ray.d];
    let t = R::each([o[0], o[1], o[2], lo[0], lo[1], lo[2], d[0], d[1], d[2]], |v| {
        let at = |i: usize| three(|k| v[i + k] * ring.scale);
        let d = at(6);
        // The direction is brought to unit magnitude, too: its length is the world's, and its fourth power is needed.
        let longest = larger(d[0].abs(), larger(d[1].abs(), d[2].abs()));
        let k = reciprocal_power(longest);
        let mut t = ring_roots(ring, at(0), at(3), three(|i| d[i] * k));
        for x in &mut t {
            *x *= k; // from lengths of the shortened direction to those of the ray's
        }
        t
    });
    let nearest = t.iter().skip(1).fold(t[0], |best, &x| R::select(x.abs().lt(best.abs()), x, best));
    for x in t {
        let mut valid = x.same(x);
        if let Some(own) = own {
            valid = valid & !(own.here & x.same(nearest));
        }
        visit.crossing(x, R::splat(SIDE), valid);
    }
}

/// The point of the ring under `p`.
#[inline(always)]
pub(super) fn point<R: Real>(ring: &Ring, p: [R; 3]) -> Point<R> {
    let (to_unit, to_scene) = (R::splat(ring.scale), R::splat(1.0 / ring.scale));
    let p = each3(p, |x| x * to_unit);
    let rho = p[0].mul_add(p[0], p[2] * p[2]).sqrt();
    let s = R::splat(ring.r) / rho;
    let c = [p[0] * s, R::zero(), p[2] * s];
    let v = [p[0] - c[0], p[1], p[2] - c[2]];
    let scale = R::one() / dot(v, v).sqrt();
    let n = each3(v, |x| x * scale);
    let tube = R::splat(ring.tube);
    let q = three(|i| tube.mul_add(n[i], c[i]));
    // Circle 5 of r, tube 8 of its radius, their sum 1.
    let u = R::UNIT_ROUNDOFF;
    let error = R::splat(6.0 * u * ring.r + 9.0 * u * ring.tube);
    Point { p: each3(q, |x| x * to_scene), n, error: [error * to_scene; 3] }
}

/// The up to four t at which a line meets the ring, in order; NaN for those that don't exist.
#[inline(always)]
fn ring_roots(ring: &Ring, o: [f64; 3], lo: [f64; 3], d: [f64; 3]) -> [f64; 4] {
    let none = [f64::NAN; 4];
    let dd = dot(d, d);
    let t0 = -(dot(o, d) / dd);
    // The point of the line nearest the centre, with what rounding left out.
    let m = three(|i| {
        let p = t0 * d[i];
        let e = f64::mul_add(t0, d[i], -p);
        let (s, se) = two_sum(o[i], p);
        s + (se + (e + lo[i]))
    });
    let reach = ring.r + ring.tube;
    let span2 = (reach * reach - dot(m, m)) / dd;
    if !(span2 >= 0.0) {
        return none;
    }
    let span = sqrt(span2) * 1.0625; // a little beyond the bounding sphere, so that no root is on the border
    let quartic = quartic_at(ring, m, d);
    let mut found = [f64::NAN; 4];
    let n = isolate(&quartic, span, &mut found);
    // Polished on distance to the tube. Near the ray's own origin, t itself is the good variable: the difference t0 + τ would
    // keep only its absolute accuracy.
    let mut out = none;
    for k in 0..n {
        let near = (t0 + found[k]).abs() < t0.abs() / 8.0;
        let (from, start) = if near { (o, t0 + found[k]) } else { (m, found[k]) };
        let tau = polish(ring, from, d, start);
        out[k] = if near { tau } else { t0 + tau };
    }
    out
}

/// Coefficients, highest first, of (|p|² + R² − r²)² − 4R²(x² + z²) along m + τ·d.
#[inline(always)]
fn quartic_at(ring: &Ring, m: [f64; 3], d: [f64; 3]) -> [f64; 5] {
    let (r2, t2) = (ring.r * ring.r, ring.tube * ring.tube);
    let (a, b) = (dot(d, d), dot(m, d));
    let c = dot(m, m) + (r2 - t2);
    let e = d[0].mul_add(d[0], d[2] * d[2]);
    let f = m[0].mul_add(d[0], m[2] * d[2]);
    let g = m[0].mul_add(m[0], m[2] * m[2]);
    [a * a, 4.0 * a * b, 4.0 * b * b + 2.0 * a * c - 4.0 * r2 * e, 4.0 * b * c - 8.0 * r2 * f, c * c - 4.0 * r2 * g]
}

/// All roots of the quartic in −span..span, in order: between consecutive roots of the derivative there is at most one.
#[inline(always)]
fn isolate(q: &[f64; 5], span: f64, out: &mut [f64; 4]) -> usize {
    let cubic = [4.0 * q[0], 3.0 * q[1], 2.0 * q[2], q[3]];
    let quadratic = [3.0 * cubic[0], 2.0 * cubic[1], cubic[2]];
    let mut turns2 = [0.0; 2];
    let n2 = quadratic_roots(quadratic, &mut turns2);
    let mut turns3 = [0.0; 3];
    let n3 = roots_between(&cubic, &turns2[..n2], span, &mut turns3);
    roots_between(q, &turns3[..n3], span, out)
}

#[inline(always)]
fn quadratic_roots([a, b, c]: [f64; 3], out: &mut [f64; 2]) -> usize {
    let h = b / 2.0;
    let disc = h.mul_add(h, -(a * c));
    if !(disc > 0.0) {
        return 0;
    }
    let q = -(h + sqrt(disc).copysign(h));
    let (x, y) = (q / a, c / q);
    *out = if x < y { [x, y] } else { [y, x] };
    2
}

/// Roots of the polynomial within −span..span, given where its derivative is zero, in order.
#[inline(always)]
fn roots_between(poly: &[f64], turns: &[f64], span: f64, out: &mut [f64]) -> usize {
    let mut n = 0;
    let (mut x0, mut y0) = (-span, horner(poly, -span).0);
    for x1 in turns.iter().copied().filter(|x| x.abs() < span).chain([span]) {
        let y1 = horner(poly, x1).0;
        if y1 == 0.0 || (y0 < 0.0) != (y1 < 0.0) && y0 != 0.0 {
            out[n] = bracketed_root(poly, x0, y0, x1);
            n += 1;
            if n == out.len() {
                break;
            }
        }
        (x0, y0) = (x1, y1);
    }
    n
}

/// Newton's method that falls back to halving whenever a step leaves the bracket.
#[inline(always)]
fn bracketed_root(poly: &[f64], mut lo: f64, y_lo: f64, mut hi: f64) -> f64 {
    let mut x = 0.5 * (lo + hi);
    // 64 halvings alone reduce any bracket to neighbouring numbers; Newton usually ends after five steps.
    for _ in 0..64 {
        let (y, dy) = horner(poly, x);
        if y == 0.0 {
            return x;
        }
        if (y < 0.0) == (y_lo < 0.0) {
            lo = x
        } else {
            hi = x
        }
        let newton = x - y / dy;
        let next = if newton > lo && newton < hi { newton } else { 0.5 * (lo + hi) };
        if next == x {
            break;
        }
        x = next;
    }
    x
}

/// Value and derivative.
#[inline(always)]
fn horner(poly: &[f64], x: f64) -> (f64, f64) {
    poly[1..].iter().fold((poly[0], 0.0), |(y, dy), &c| (y.mul_add(x, c), dy.mul_add(x, y)))
}

/// Three Newton steps on h(τ) = |(√(x² + z²) − R, y)| − r: distance to the tube, linear near the surface.
#[inline(always)]
fn polish(ring: &Ring, from: [f64; 3], d: [f64; 3], start: f64) -> f64 {
    let mut tau = start;
    for _ in 0..3 {
        let p = three(|i| tau.mul_add(d[i], from[i]));
        let rho = sqrt(p[0].mul_add(p[0], p[2] * p[2]));
        let w = rho - ring.r;
        let dist = sqrt(w.mul_add(w, p[1] * p[1]));
        let slope = (w * (p[0] * d[0] + p[2] * d[2]) / rho + p[1] * d[1]) / dist;
        let step = (dist - ring.tube) / slope;
        // Near a tangent the slope vanishes and the isolated root is as good as it gets: a step of a quarter of the tube
        // leads elsewhere.
        if !(step.abs() * sqrt(dot(d, d)) <= 0.25 * ring.tube) {
            break;
        }
        tau -= step;
    }
    tau
}

#[cfg(test)]
mod tests {
    use super::*;

    const RING: Ring = Ring { r: 1.0, tube: 0.25, scale: 1.0 };

    #[test]
    fn four_two_or_no_crossings() {
        let at = |y: f64| ring_roots(&RING, [5.0, y, 0.0], [0.0; 3], [-1.0, 0.0, 0.0]);
        for (found, exact) in at(0.0).iter().zip([3.75, 4.25, 5.75, 6.25]) {
            assert!((found - exact).abs() <= 2e-15 * exact, "{found} {exact}");
        }
        let above = ring_roots(&RING, [1.0, 5.0, 0.0], [0.0; 3], [0.0, -1.0, 0.0]);
        assert!((above[0] - 4.75).abs() < 1e-14 && (above[1] - 5.25).abs() < 1e-14 && above[2].is_nan());
        assert!(at(0.3).iter().all(|t| t.is_nan()));
        assert!(ring_roots(&RING, [0.0, 5.0, 0.0], [0.0; 3], [0.0, -1.0, 0.0]).iter().all(|t| t.is_nan()), "the hole");
    }

    #[test]
    fn scale_is_the_reciprocal_power_of_two() {
        let power = |n: i64| f64::from_bits(((1023 + n) as u64) << 52);
        for (r, scale) in [(1.0, 1.0), (1.9, 1.0), (2.0, 0.5), (0.3, 4.0), (1e140, power(-465)), (1e-140, power(466))] {
            assert_eq!(Ring::new(r, r / 2.0).scale, scale, "{r}");
        }
    }

    #[test]
    fn far_away_and_thin_it_still_counts_right() {
        let ring = Ring::new(1.0, 1e-3);
        let found = ring_roots(&ring, [1e6, 0.0, 0.0], [0.0; 3], [-1.0, 0.0, 0.0]);
        for (t, exact) in found.iter().zip([1e6 - 1.001, 1e6 - 0.999, 1e6 + 0.999, 1e6 + 1.001]) {
            assert!((t - exact).abs() < 3e-10, "{t} {exact}");
        }
    }
}
