//! Where a line crosses a quadric: the one recipe behind sphere, ellipsoid, cylinder and cone.
//!
//! The discriminant isn't the problem, the coefficients are: so the origin is moved to the point of the line nearest the
//! frame's origin, with its rounding errors kept, and the quadratic is solved there with Kahan's difference of products and
//! the stable pair of roots q/a, c/q. Where the line all but touches, the same formula is evaluated in double-double.

use crate::math::real::three;
use crate::math::{Mask, Real};
use crate::render::ray::{LocalRay, Own};

/// A quadratic form of a point, negative inside.
pub trait Quadric {
    /// Its coefficients along the line m + τ·d.
    fn coefficients<R: Real>(&self, m: [R; 3], d: [R; 3]) -> Coefficients<R>;
}

/// `form(m + τ·d) = a·τ² + 2·b·τ + c`.
#[derive(Clone, Copy, Debug)]
pub struct Coefficients<R> {
    /// Of τ².
    pub a: R,
    /// Half of that of τ.
    pub b: R,
    /// The constant.
    pub c: R,
    /// Sum of the magnitudes that `a` was summed from, and of those of `c`: rounding errors are relative to these.
    pub sizes: [R; 2],
}

/// A crossing of a line.
#[derive(Clone, Copy, Debug)]
pub struct Crossing<R> {
    /// From the line's point nearest to the frame's origin: for comparing crossings of one shape.
    pub tau: R,
    /// From the ray's origin.
    pub t: R,
}

impl<R: Real> Crossing<R> {
    /// A crossing without end, on the side of `sign`.
    #[inline(always)]
    pub fn never(sign: f64) -> Self {
        let far = R::splat(sign * f64::INFINITY);
        Crossing { tau: far, t: far }
    }

    /// `a` where `m`, else `b`.
    #[inline(always)]
    pub fn select(m: R::Mask, a: Self, b: Self) -> Self {
        Crossing { tau: R::select(m, a.tau, b.tau), t: R::select(m, a.t, b.t) }
    }
}

/// The crossings of a line with a quadric, and how the form behaves between them.
#[derive(Clone, Copy, Debug)]
pub struct Roots<R: Real> {
    /// The smaller root.
    pub lo: Crossing<R>,
    /// The larger root.
    pub hi: Crossing<R>,
    /// Where they are real.
    pub real: R::Mask,
    /// Leading coefficient: the form is negative between the roots where it is positive, outside where it is negative.
    pub a: R,
    /// Where the form is constant along the line, and negative: no crossing, but inside throughout.
    pub always_inside: R::Mask,
    /// Whether the larger root is needed, and known, in any lane.
    pub further: bool,
}

/// In units of roundoff, relative to what it was computed from: a discriminant below this is evaluated again in
/// double-double. Its own error is below 16 of them. Up to 2^12 its relative error, which half of goes into the roots' distance,
/// is worth removing, too: no more than one ray in 2^40 comes so near to a tangent.
const DOUBT: f64 = (1 << 12) as f64;

/// Solves for the crossings of `ray`'s line with `form` = 0 from its point `m` at `t0`, which is near the shape. Of rays that
/// start on the quadric itself, the lanes of `own`, one root is exactly 0. `needs_further` is told the t of the smaller roots, and where
/// they are real, and says in which lanes the larger one is needed; in others it is infinite.
#[inline(always)]
pub fn roots<R: Real>(
    ray: &LocalRay<R>,
    (t0, m): (R, [R; 3]),
    form: &impl Quadric,
    own: Option<R::Mask>,
    needs_further: impl FnOnce(R, R::Mask) -> R::Mask,
) -> Roots<R> {
    let (zero, d) = (R::zero(), ray.d);
    let Coefficients { a, b, c, sizes } = form.coefficients(m, d);
    let disc = b.difference_of_products(b, a, c);
    let constant = a.same(zero) & b.same(zero);
    // A form that falls off in both directions (a cone seen steeply) always has crossings; a negative discriminant there
    // is a rounding error at the apex.
    let real = (zero.le(disc) | a.lt(zero)) & !constant;
    let doubt = disc.abs().le(R::splat(DOUBT * R::UNIT_ROUNDOFF) * (sizes[0] * sizes[1])) & !constant;
    let starts_here = matches!(own, Some(own) if own.any());
    if !starts_here && !(real | doubt).any() {
        // Most registers of a tile pass by most of its shapes: no root, no quotient.
        let always_inside = constant & c.le(zero);
        return Roots { lo: Crossing::never(-1.0), hi: Crossing::never(1.0), real, a, always_inside, further: false };
    }
    let pair = Pair::new(a, b, c, disc);
    let x = pair.smaller();
    let (mut lo, mut hi) = (Crossing { tau: x, t: t0 + x }, Crossing::never(1.0));
    // A crossing much nearer than the point that the coefficients were taken at: its t is a small difference of large
    // numbers, and its sign means nothing yet.
    let needed = (real & is_small(lo.t, t0)) | needs_further(lo.t, real);
    let further = needed.any();
    if further {
        let y = pair.larger();
        // Rounding may exchange two that are all but one. Not in lanes that don't need the other: whether it is computed there
        // depends on the lanes beside.
        let (x, y) = (R::select(needed, x.min(y), x), R::select(needed, x.max(y), hi.tau));
        (lo, hi) = (Crossing { tau: x, t: t0 + x }, Crossing { tau: y, t: t0 + y });
    }
    let mut found = Roots { lo, hi, real, a, always_inside: constant & c.le(zero), further };

    // Such rays start near the surface, where the coefficients at the ray's own origin are the good ones.
    let (near_lo, near_hi) = (real & is_small(lo.t, t0), real & is_small(hi.t, t0));
    if (near_lo | near_hi).any() {
        let k = form.coefficients(ray.o, d);
        let pair = Pair::new(k.a, k.b, k.c, k.b.difference_of_products(k.b, k.a, k.c));
        let (x, y) = (pair.smaller(), pair.larger());
        lo.t = R::select(near_lo, x.min(y), lo.t);
        hi.t = R::select(near_hi, x.max(y), hi.t);
        (found.lo, found.hi) = (lo, hi);
    }
    if doubt.any() {
        found = judged_again(ray, t0, form, doubt, found);
        found.further = true;
    }
    if let Some(own) = own {
        found = deflated(ray, t0, form, own, found);
    }
    found
}

/// The two roots of a·τ² + 2·b·τ + c: q/a and c/q, with the q of which no digits cancel. An infinite one where a = 0.
struct Pair<R: Real> {
    a: R,
    c: R,
    q: R,
    /// Where q/a, which lies further from 0, is the smaller one.
    first: R::Mask,
}

impl<R: Real> Pair<R> {
    #[inline(always)]
    fn new(a: R, b: R, c: R, disc: R) -> Pair<R> {
        let zero = R::zero();
        let q = -(b + R::select(zero.lt(disc), disc, zero).sqrt().copysign(b));
        let (down, falling) = (q.lt(zero), a.lt(zero));
        Pair { a, c, q, first: (down & !falling) | (!down & falling) }
    }

    #[inline(always)]
    fn smaller(&self) -> R {
        self.root(self.first)
    }

    #[inline(always)]
    fn larger(&self) -> R {
        self.root(!self.first)
    }

    /// q/a in the lanes of `by_a`, c/q elsewhere.
    #[inline(always)]
    fn root(&self, by_a: R::Mask) -> R {
        let root = R::select(by_a, self.q, self.c) / R::select(by_a, self.a, self.q);
        let double = !by_a & self.q.same(R::zero()); // at 0: c is 0 too
        R::select(double, R::zero(), root)
    }
}

/// Whether `t` is much smaller than `t0`: under an eighth, which loses at most three of 53 bits.
#[inline(always)]
fn is_small<R: Real>(t: R, t0: R) -> R::Mask {
    (t.abs() * R::splat(8.0)).lt(t0.abs())
}

/// The same roots from the ray's exact origin in a finer scalar, in the lanes of `doubt`.
#[inline(always)]
fn judged_again<R: Real>(ray: &LocalRay<R>, t0: R, form: &impl Quadric, doubt: R::Mask, rough: Roots<R>) -> Roots<R> {
    let LocalRay { o, o_lo, d, d_lo } = *ray;
    let (l, e) = (o_lo, d_lo);
    let given = [o[0], o[1], o[2], l[0], l[1], l[2], d[0], d[1], d[2], e[0], e[1], e[2], t0];
    let (one, zero) = (R::one(), R::zero());
    let real = R::select(rough.real, one, zero);
    let rough_numbers = [rough.lo.tau, rough.lo.t, rough.hi.tau, rough.hi.t, real];
    let [lo_tau, lo_t, hi_tau, hi_t, real] = R::again(doubt, given, rough_numbers, |v| {
        let (whole, nothing) = (|k: usize| three!(i => v[k + i] + v[k + 3 + i]), [Real::zero(); 3]);
        let exact = LocalRay { o: whole(0), o_lo: nothing, d: whole(6), d_lo: nothing };
        let x = roots(&exact, exact.nearest(), form, None, |_, _| Mask::splat(true));
        let real = Real::select(x.real, Real::one(), Real::zero());
        [x.lo.t - v[12], x.lo.t, x.hi.t - v[12], x.hi.t, real]
    });
    Roots {
        lo: Crossing { tau: lo_tau, t: lo_t },
        hi: Crossing { tau: hi_tau, t: hi_t },
        real: !real.same(zero),
        ..rough
    }
}

/// The roots of rays that start on the quadric: 0, taken out of a·τ² + 2·b·τ, and −2·b/a.
#[inline(always)]
fn deflated<R: Real>(ray: &LocalRay<R>, t0: R, form: &impl Quadric, own: R::Mask, found: Roots<R>) -> Roots<R> {
    let zero = R::zero();
    let k = form.coefficients(ray.o, ray.d);
    let other = -((k.b + k.b) / k.a);
    // Along a generator of a cylinder or cone there is no other crossing: 0/0.
    let other = R::select(other.same(other), other, R::splat(f64::INFINITY));
    let (lo, hi) = (other.min(zero), other.max(zero));
    Roots {
        lo: Crossing::select(own, Crossing { tau: lo - t0, t: lo }, found.lo),
        hi: Crossing::select(own, Crossing { tau: hi - t0, t: hi }, found.hi),
        real: found.real | own,
        always_inside: found.always_inside & !own,
        ..found
    }
}

/// The lanes that start on the part `side` of this shape.
#[inline(always)]
pub fn on_side<R: Real>(own: &Option<Own<R>>, side: f64) -> Option<R::Mask> {
    own.as_ref().map(|own| own.on(R::splat(side)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::shape::sphere::Ball;

    fn ray(o: [f64; 3], d: [f64; 3]) -> LocalRay<f64> {
        LocalRay { o, o_lo: [0.0; 3], d, d_lo: [0.0; 3] }
    }

    /// With the unit sphere.
    fn of(ray: &LocalRay<f64>) -> Roots<f64> {
        roots(ray, ray.nearest(), &Ball { r: 1.0 }, None, |_, _| Mask::splat(true))
    }

    #[test]
    fn far_origin_loses_nothing() {
        // A unit sphere seen from 2^30 away: exact roots 2^30 ∓ 1.
        let d = (1u64 << 30) as f64;
        let r = of(&ray([0.0, 0.0, d], [0.0, 0.0, -1.0]));
        assert_eq!((r.lo.t, r.hi.t), (d - 1.0, d + 1.0));
    }

    #[test]
    fn crossings_near_the_origin_keep_relative_accuracy() {
        let tiny = 1.0 / (1u64 << 40) as f64;
        let r = of(&ray([0.0, 0.0, 1.0 - tiny], [0.0, 0.0, 1.0]));
        assert!((r.hi.t / tiny - 1.0).abs() < 1e-9, "{}", r.hi.t);
    }

    #[test]
    fn tangent_is_one_double_root() {
        let r = of(&ray([1.0, 0.0, 5.0], [0.0, 0.0, -1.0]));
        assert!(r.real.0);
        assert_eq!((r.lo.t, r.hi.t), (5.0, 5.0));
    }
}
