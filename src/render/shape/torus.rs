//! The torus: a quartic, whose roots are isolated between the roots of its derivatives and polished on the distance to the
//! tube, which stays well-conditioned where the quartic doesn't.
//!
//! Root isolation after Yuksel, "High-performance polynomial root finding for graphics", HPG 2022.

use super::{Point, SIDE, Visit};
use crate::math::affine::reciprocal_power;
use crate::math::real::{Task, dot, each3, three};
use crate::math::{Mask, Real, Single};
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
    let (zero, one) = (R::zero(), R::one());
    // 1 and -1 for rays that leave the ring to the outside and to the inside, 0 for those from elsewhere.
    let leaves = match own {
        Some(own) => R::select(own.here, R::select(own.outward, one, -one), zero),
        None => zero,
    };
    let LocalRay { o, o_lo: lo, d, d_lo: e } = *ray;
    let given = [o[0], o[1], o[2], lo[0], lo[1], lo[2], d[0], d[1], d[2], e[0], e[1], e[2], leaves];
    let found = R::each(
        given,
        #[inline(always)]
        |given| R::alone(RingCrossings { ring, given }),
    );
    for k in 0..4 {
        visit.crossing(found[k], R::splat(SIDE), !found[4 + k].same(zero));
    }
}

/// [`ring_crossings`] to be found: by far the largest kernel.
struct RingCrossings<'r, S> {
    ring: &'r Ring,
    given: [S; 13],
}

impl<S: Single> Task for RingCrossings<'_, S> {
    type Output = [S; 8];
    #[inline(always)]
    fn run(self) -> [S; 8] {
        ring_crossings(self.ring, self.given)
    }
}

/// Four t and, for each, 1 where the line meets the ring there, else 0.
#[inline(always)]
fn ring_crossings<S: Single>(ring: &Ring, v: [S; 13]) -> [S; 8] {
    let to_unit = S::splat(ring.scale);
    let at = |i: usize| three!(k => v[i + k] * to_unit);
    let d = at(6);
    // The direction is brought to unit magnitude, too: its length is the world's, and its fourth power is needed.
    let longest = larger(d[0].magnitude(), larger(d[1].magnitude(), d[2].magnitude()));
    let k = S::splat(reciprocal_power(longest));
    let ray = LocalRay { o: at(0), o_lo: at(3), d: each3!(d, x => x * k), d_lo: each3!(at(9), x => x * k) };
    if !v[12].same(S::zero()).any() {
        let mut found = numbers(roots_from(ring, &ray, v[12]), k);
        if v[12].lt(S::zero()).any() {
            // A way out that rounding puts at the very start is a way out all the same.
            for t in &mut found[..4] {
                *t = S::select(t.same(S::zero()), S::splat(S::LEAST), *t);
            }
        }
        return found;
    }
    let (found, doubt) = ring_roots(ring, &ray);
    let LocalRay { o, o_lo: l, d, d_lo: e } = ray;
    let given = [o[0], o[1], o[2], l[0], l[1], l[2], d[0], d[1], d[2], e[0], e[1], e[2], k];
    S::again(doubt, given, numbers(found, k), |w| {
        let (whole, nothing) = (|i: usize| three!(k => w[i + k] + w[i + 3 + k]), [Real::zero(); 3]);
        let exact = LocalRay { o: whole(0), o_lo: nothing, d: whole(6), d_lo: nothing };
        numbers(ring_roots(ring, &exact).0, w[12])
    })
}

/// Roots times `k`, which leads from lengths of the shortened direction to those of the ray's, and then what they are.
#[inline(always)]
fn numbers<S: Single>(found: Found<S>, k: S) -> [S; 8] {
    let mut out = [S::zero(); 8];
    for (i, (t, is_root)) in found.into_iter().enumerate() {
        (out[i], out[4 + i]) = (t * k, is_root);
    }
    out
}

/// The point of the ring under `p`.
#[inline(always)]
pub(super) fn point<R: Real>(ring: &Ring, p: [R; 3]) -> Point<R> {
    let (to_unit, to_scene) = (R::splat(ring.scale), R::splat(1.0 / ring.scale));
    let p = each3!(p, x => x * to_unit);
    let rho = p[0].mul_add(p[0], p[2] * p[2]).sqrt();
    let s = R::splat(ring.r) / rho;
    let c = [p[0] * s, R::zero(), p[2] * s];
    let v = [p[0] - c[0], p[1], p[2] - c[2]];
    let scale = R::one() / dot(v, v).sqrt();
    let n = each3!(v, x => x * scale);
    let tube = R::splat(ring.tube);
    let q = three!(i => tube.mul_add(n[i], c[i]));
    // By component, for both are stretched or shortened rather than turned: circle 5 of it, tube 8, their sum 1.
    let (u6, u9) = (R::splat(6.0 * R::UNIT_ROUNDOFF), R::splat(9.0 * R::UNIT_ROUNDOFF));
    let error = three!(i => (u6 * c[i].abs() + u9 * (tube * n[i]).abs()) * to_scene);
    Point { p: each3!(q, x => x * to_scene), n, error }
}

/// Roots, and 1 for each that there is.
type Found<S> = [(S, S); 4];

/// In units of roundoff of the fourth power of the ring's reach: the error of the form between the ends of the span, where
/// its terms add up to less than 64 such powers, each of less than 16 roundings.
const DOUBT: f64 = (1 << 10) as f64;

/// Where a line meets the ring, in order; and whether it comes so near to touching that rounding may decide.
#[inline(always)]
fn ring_roots<S: Single>(ring: &Ring, ray: &LocalRay<S>) -> (Found<S>, S::Mask) {
    let (zero, d) = (S::zero(), ray.d);
    let mut found = [(zero, zero); 4];
    let never = zero.lt(zero);
    let (t0, m) = ray.nearest();
    let reach = S::splat(ring.r + ring.tube) * beyond();
    let reach2 = reach * reach;
    let span2 = (reach2 - dot(m, m)) / dot(d, d);
    if !zero.le(span2).any() {
        return (found, never);
    }
    let span = span2.max(zero).sqrt();
    let quartic = quartic_at(ring, m, d);
    if let Some(enclosed) = S::enclosed_roots(&quartic, span) {
        return (enclosed.map(|(tau, is_root)| (t0 + tau, is_root)), never);
    }
    let mut taus = [zero; 4];
    let (n, least) = isolate(&quartic, span, &mut taus);
    let doubt = least.le(S::splat(DOUBT * S::UNIT_ROUNDOFF) * (reach2 * reach2));
    // Polished on distance to the tube. Near the ray's own origin, t itself is the good variable: the difference t0 + τ would
    // keep only its absolute accuracy.
    for k in 0..n {
        let rough = t0 + taus[k];
        let near = (rough.abs() * S::splat(8.0)).lt(t0.abs()).any();
        let t = if near { polish(ring, ray.o, d, rough, zero) } else { t0 + polish(ring, m, d, taus[k], zero) };
        found[k] = (t, S::one());
    }
    (found, doubt)
}

/// Where a ray that starts on the ring meets it again: the root at the start is divided out. `leaves` is positive where the ray
/// leaves to the outside, which is the sign of the form right after the start, whatever rounding makes of it: so a ray
/// to the outside meets the ring an even number of times, one to the inside an odd number.
#[inline(always)]
fn roots_from<S: Single>(ring: &Ring, ray: &LocalRay<S>, leaves: S) -> Found<S> {
    let zero = S::zero();
    let LocalRay { o, d, .. } = *ray;
    let reach = S::splat(2.0 * (ring.r + ring.tube));
    let span = reach * beyond() / dot(d, d).sqrt();
    let [q4, q3, q2, q1, _] = quartic_at(ring, o, d);
    let cubic = [q4, q3, q2, q1.copysign(leaves)];
    if let Some(enclosed) = S::enclosed_roots(&cubic, span) {
        return enclosed;
    }
    let mut taus = [zero; 3];
    let n = isolate_cubic(&cubic, span, &mut taus);
    // The start itself is a rounding error off the ring: the other crossings are those of the ring through it.
    let level = distance(ring, o, d, zero).0;
    let mut found = [(zero, zero); 4];
    for k in 0..n {
        let polished = polish(ring, o, d, taus[k], level);
        // From a root close to the start, Newton's method may find the start.
        let moved = (polished - taus[k]).abs() * S::splat(2.0);
        found[k] = (if moved.lt(taus[k].abs()).any() { polished } else { taus[k] }, S::one());
    }
    found
}

/// A little beyond a bounding sphere, so that no root is on the border.
#[inline(always)]
fn beyond<S: Real>() -> S {
    S::splat(17.0) / S::splat(16.0)
}

/// Coefficients, highest first, of (|p|² + R² − r²)² − 4R²(x² + z²) along m + τ·d.
#[inline(always)]
fn quartic_at<S: Real>(ring: &Ring, m: [S; 3], d: [S; 3]) -> [S; 5] {
    let (r, tube) = (S::splat(ring.r), S::splat(ring.tube));
    let (r2, t2, two, four) = (r * r, tube * tube, S::splat(2.0), S::splat(4.0));
    let (a, b) = (dot(d, d), dot(m, d));
    let c = dot(m, m) + (r2 - t2);
    let e = d[0].mul_add(d[0], d[2] * d[2]);
    let f = m[0].mul_add(d[0], m[2] * d[2]);
    let g = m[0].mul_add(m[0], m[2] * m[2]);
    [
        a * a,
        four * a * b,
        four * b * b + two * a * c - four * r2 * e,
        four * b * c - S::splat(8.0) * r2 * f,
        c * c - four * r2 * g,
    ]
}

/// All roots of the quartic in −span..span, in order: between consecutive roots of the derivative there is at most one. And the
/// least magnitude that it turns round at.
#[inline(always)]
fn isolate<S: Single>(q: &[S; 5], span: S, out: &mut [S; 4]) -> (usize, S) {
    let cubic = [S::splat(4.0) * q[0], S::splat(3.0) * q[1], S::splat(2.0) * q[2], q[3]];
    let mut turns = [S::zero(); 3];
    let n = isolate_cubic(&cubic, span, &mut turns);
    let least = turns[..n].iter().fold(S::splat(f64::INFINITY), |least, &x| horner(q, x).0.abs().min(least));
    (roots_between(q, &turns[..n], span, out), least)
}

/// All roots of the cubic in −span..span, in order.
#[inline(always)]
fn isolate_cubic<S: Single>(q: &[S; 4], span: S, out: &mut [S; 3]) -> usize {
    let quadratic = [S::splat(3.0) * q[0], S::splat(2.0) * q[1], q[2]];
    let mut turns = [S::zero(); 2];
    let n = quadratic_roots(quadratic, &mut turns);
    roots_between(q, &turns[..n], span, out)
}

#[inline(always)]
fn quadratic_roots<S: Single>([a, b, c]: [S; 3], out: &mut [S; 2]) -> usize {
    let h = b / S::splat(2.0);
    let disc = h.mul_add(h, -(a * c));
    if !S::zero().lt(disc).any() {
        return 0;
    }
    let q = -(h + disc.sqrt().copysign(h));
    let (x, y) = (q / a, c / q);
    *out = [x.min(y), x.max(y)];
    2
}

/// Roots of the polynomial within −span..span, given where its derivative is zero, in order.
#[inline(always)]
fn roots_between<S: Single>(poly: &[S], turns: &[S], span: S, out: &mut [S]) -> usize {
    let zero = S::zero();
    let is = |m: S::Mask| m.any();
    let mut n = 0;
    let (mut x0, mut y0) = (-span, horner(poly, -span).0);
    for x1 in turns.iter().copied().filter(|x| is(x.abs().lt(span))).chain([span]) {
        let y1 = horner(poly, x1).0;
        if is(y1.same(zero)) || is(y0.lt(zero)) != is(y1.lt(zero)) && !is(y0.same(zero)) {
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
fn bracketed_root<S: Single>(poly: &[S], mut lo: S, y_lo: S, mut hi: S) -> S {
    let (zero, two) = (S::zero(), S::splat(2.0));
    let mut x = (lo + hi) / two;
    // 128 halvings alone reduce any bracket to neighbouring numbers; Newton usually ends after five steps.
    for _ in 0..128 {
        let (y, dy) = horner(poly, x);
        if y.same(zero).any() {
            return x;
        }
        if y.lt(zero).any() == y_lo.lt(zero).any() {
            lo = x
        } else {
            hi = x
        }
        let newton = x - y / dy;
        let next = if (lo.lt(newton) & newton.lt(hi)).any() { newton } else { (lo + hi) / two };
        if next.same(x).any() {
            break;
        }
        x = next;
    }
    x
}

/// Value and derivative.
#[inline(always)]
fn horner<S: Real>(poly: &[S], x: S) -> (S, S) {
    poly[1..].iter().fold((poly[0], S::zero()), |(y, dy), &c| (y.mul_add(x, c), dy.mul_add(x, y)))
}

/// Three Newton steps on the distance to the tube, linear near the surface, down to `level`.
#[inline(always)]
fn polish<S: Single>(ring: &Ring, from: [S; 3], d: [S; 3], start: S, level: S) -> S {
    let mut tau = start;
    let longest = S::splat(ring.tube) / (S::splat(4.0) * dot(d, d).sqrt());
    for _ in 0..3 {
        let (distance, slope) = distance(ring, from, d, tau);
        let step = (distance - level) / slope;
        // Near a tangent the slope vanishes and the isolated root is as good as it gets: a step of a quarter of the tube
        // leads elsewhere.
        if !step.abs().le(longest).any() {
            break;
        }
        tau = tau - step;
    }
    tau
}

/// |(√(x² + z²) − R, y)| − r at from + τ·d, and its derivative by τ.
#[inline(always)]
fn distance<S: Real>(ring: &Ring, from: [S; 3], d: [S; 3], tau: S) -> (S, S) {
    let p = three!(i => tau.mul_add(d[i], from[i]));
    let rho = p[0].mul_add(p[0], p[2] * p[2]).sqrt();
    let w = rho - S::splat(ring.r);
    let to_circle = w.mul_add(w, p[1] * p[1]).sqrt();
    let slope = (w * (p[0] * d[0] + p[2] * d[2]) / rho + p[1] * d[1]) / to_circle;
    (to_circle - S::splat(ring.tube), slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RING: Ring = Ring { r: 1.0, tube: 0.25, scale: 1.0 };

    fn roots(ring: &Ring, o: [f64; 3], d: [f64; 3]) -> Vec<f64> {
        let found = ring_roots(ring, &LocalRay { o, o_lo: [0.0; 3], d, d_lo: [0.0; 3] }).0;
        found.into_iter().filter(|x| x.1 == 1.0).map(|x| x.0).collect()
    }

    #[test]
    fn four_two_or_no_crossings() {
        let at = |y: f64| roots(&RING, [5.0, y, 0.0], [-1.0, 0.0, 0.0]);
        for (found, exact) in at(0.0).iter().zip([3.75, 4.25, 5.75, 6.25]) {
            assert!((found - exact).abs() <= 2e-15 * exact, "{found} {exact}");
        }
        let above = roots(&RING, [1.0, 5.0, 0.0], [0.0, -1.0, 0.0]);
        assert!((above[0] - 4.75).abs() < 1e-14 && (above[1] - 5.25).abs() < 1e-14 && above.len() == 2);
        assert!(at(0.3).is_empty());
        assert!(roots(&RING, [0.0, 5.0, 0.0], [0.0, -1.0, 0.0]).is_empty(), "the hole");
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
        let found = roots(&ring, [1e6, 0.0, 0.0], [-1.0, 0.0, 0.0]);
        for (t, exact) in found.iter().zip([1e6 - 1.001, 1e6 - 0.999, 1e6 + 0.999, 1e6 + 1.001]) {
            assert!((t - exact).abs() < 3e-10, "{t} {exact}");
        }
    }
}
