//! The triangle, watertight: edges are judged by determinants whose sign is exact, and two triangles that share an edge
//! compute the same determinant, so no ray passes between them.
//!
//! Woop, Benthin, Wald, "Watertight ray/triangle intersection", JCGT 2(1), 2013, with Kahan's difference of products in
//! place of their double-precision fallback.

use super::{Surface, Visit};
use crate::math::real::{axpy, dot, each3, minus, scaled, select3, three};
use crate::math::{Mask, Real};
use crate::render::ray::Own;
use crate::render::slabs::Slabs;

/// A triangle's corners relative to the camera, with what a hit needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleData {
    /// Corners.
    pub v: [[f64; 3]; 3],
    /// Unit normal, towards the side from which the corners go round counter-clockwise.
    pub n: [f64; 3],
    /// Shading normals at the corners, in the world, of unit length.
    pub shading: Option<[[f64; 3]; 3]>,
}

/// The determinants of the three edges, each opposite to its corner, their sum, and t.
struct Edges<R: Real> {
    e: [R; 3],
    det: R,
    t: R,
    hit: R::Mask,
}

/// The axes renamed so that the ray's main one is z.
#[inline(always)]
fn turned<R: Real>(z_most: R::Mask, x_most: R::Mask, v: [R; 3]) -> [R; 3] {
    three!(i => R::select(z_most, v[i], R::select(x_most, v[(i + 1) % 3], v[(i + 2) % 3])))
}

/// Whether a ray through the edge from `p` to `q` counts as one through this triangle.
#[inline(always)]
fn is_ours<R: Real>(clockwise: R::Mask, p: (R, R), q: (R, R)) -> R::Mask {
    let (up, down) = (p.1.lt(q.1), q.1.lt(p.1));
    let (left, right) = (p.1.same(q.1) & q.0.lt(p.0), p.1.same(q.1) & p.0.lt(q.0));
    (clockwise & (down | right)) | (!clockwise & (up | left))
}

#[inline(always)]
fn edges<R: Real>(v: [[R; 3]; 3], ray: ([R; 3], [R; 3])) -> Edges<R> {
    let (o, d) = ray;
    let zero = R::zero();
    // The axis along which the ray goes furthest becomes z, so that the shear never divides by something small.
    let (ax, ay, az) = (d[0].abs(), d[1].abs(), d[2].abs());
    let z_most = ax.le(az) & ay.le(az);
    let x_most = !z_most & ay.le(ax);
    let d = turned::<R>(z_most, x_most, d);
    let sz = R::one() / d[2];
    let (sx, sy) = (d[0] * sz, d[1] * sz);
    let [a, b, c] = each3!(v, v => turned::<R>(z_most, x_most, minus(v, o)));
    let [(ax, ay), (bx, by), (cx, cy)] = each3!([a, b, c], v => ((-sx).mul_add(v[2], v[0]), (-sy).mul_add(v[2], v[1])));
    let e = [
        cx.difference_of_products(by, cy, bx),
        ax.difference_of_products(cy, ay, cx),
        bx.difference_of_products(ay, by, ax),
    ];
    let negative = e[0].lt(zero) | e[1].lt(zero) | e[2].lt(zero);
    let positive = zero.lt(e[0]) | zero.lt(e[1]) | zero.lt(e[2]);
    let det = e[0] + e[1] + e[2];
    let mut hit = !(negative & positive) & !det.same(zero);
    let on_edge = each3!(e, x => x.same(zero));
    if (hit & (on_edge[0] | on_edge[1] | on_edge[2])).any() {
        // As if the ray passed a little to the left and, less still, above: so of triangles that share the edge or corner,
        // exactly one is met.
        let clockwise = zero.lt(det);
        let (a, b, c) = ((ax, ay), (bx, by), (cx, cy));
        let ours = each3!([(b, c), (c, a), (a, b)], (p, q) => is_ours::<R>(clockwise, p, q));
        hit = hit & (!on_edge[0] | ours[0]) & (!on_edge[1] | ours[1]) & (!on_edge[2] | ours[2]);
    }
    if !hit.any() {
        return Edges { e, det, t: zero, hit };
    }
    // Weights before the sum: products of an edge's determinant with a length would leave the range that squares allow.
    let inverse = R::one() / det;
    let w = each3!(e, x => x * inverse);
    let depth = w[0].mul_add(a[2], w[1].mul_add(b[2], w[2] * c[2]));
    let mut t = depth * sz;
    let furthest = a[2].abs().max(b[2].abs()).max(c[2].abs());
    let cancelled = hit & (R::splat(CANCELLED) * depth.abs()).lt(furthest);
    if cancelled.any() {
        let (enter, leave) = stay(v, ray);
        t = R::select(cancelled, t.max(enter).min(leave), t);
        hit = hit & (!cancelled | enter.le(leave));
    }
    Edges { e, det, t, hit }
}

/// Depths of corners this many times that of a crossing leave so much of their rounding errors in it that it may lie outside the
/// triangle's box, where it would depend on the order of tests whether it is seen.
const CANCELLED: f64 = (1 << 8) as f64;

/// From which t to which rays are in the box around the corners.
#[inline(always)]
fn stay<R: Real>([a, b, c]: [[R; 3]; 3], (o, d): ([R; 3], [R; 3])) -> (R, R) {
    let faces = [three!(i => a[i].min(b[i]).min(c[i])), three!(i => a[i].max(b[i]).max(c[i]))];
    Slabs::narrow(o, d).stay_near(faces)
}

/// Calls `visit(t, part, valid)` for the crossing with the triangle between the corners `v`: one for all lanes, or one a lane.
#[inline(always)]
pub fn crossing<R: Real>(v: [[R; 3]; 3], o: [R; 3], d: [R; 3], own: Option<Own<R>>, visit: &mut impl Visit<R>) {
    let x = edges(v, (o, d));
    let mut valid = x.hit;
    if !valid.any() {
        return;
    }
    if let Some(own) = own {
        valid = valid & !own.here;
    }
    visit.crossing(x.t, R::zero(), valid);
}

/// What shading knows of a triangle, for each lane of one of its own.
pub struct Sides<R> {
    /// Corners.
    pub v: [[R; 3]; 3],
    /// Unit normal.
    pub n: [R; 3],
    /// Shading normals at the corners, all 0 where it is flat.
    pub shading: Option<[[R; 3]; 3]>,
}

/// The surface where the ray meets the triangle; its local point is (β, 0, γ), the weights of the second and third corner.
#[inline(always)]
pub fn surface<R: Real>(tri: Sides<R>, o: [R; 3], d: [R; 3]) -> Surface<R> {
    let Sides { v, n, shading } = tri;
    let x = edges(v, (o, d));
    let (beta, gamma) = (x.e[1] / x.det, x.e[2] / x.det);
    // From the first corner along the edges: a coordinate that all corners share is then met exactly.
    let (along, across) = (minus(v[1], v[0]), minus(v[2], v[0]));
    let p = axpy(gamma, across, axpy(beta, along, v[0]));
    // An error of the weights moves the point within the plane, which does no harm. Across it: the edges 1, two sums 2, the
    // addition that follows 1, and one to spare. A ray that starts here and runs into a neighbour finds its t from the
    // corners' distances, with another six roundings of those.
    let (u5, u6) = (R::splat(5.0 * R::UNIT_ROUNDOFF), R::splat(6.0 * R::UNIT_ROUNDOFF));
    let (b, c) = (beta.abs(), gamma.abs());
    let error = three!(i => {
        let (e1, e2) = (along[i].abs(), across[i].abs());
        u5 * b.mul_add(e1, c.mul_add(e2, v[0][i].abs())) + u6 * (e1 + e2)
    });
    let ns = match shading {
        Some(s) => shading_normal(s, (beta, gamma), n),
        None => n,
    };
    Surface { p, n, ns, offset: dot(each3!(n, x => x.abs()), error), local: [beta, R::zero(), gamma] }
}

/// The interpolated shading normal at (β, γ), of unit length; `n` where it is 0.
#[inline(always)]
fn shading_normal<R: Real>(s: [[R; 3]; 3], (b, c): (R, R), n: [R; 3]) -> [R; 3] {
    let a = R::one() - b - c;
    let m = axpy(c, s[2], axpy(b, s[1], scaled(a, s[0])));
    let len = dot(m, m).sqrt();
    let none = len.same(R::zero());
    let inverse = R::one() / R::select(none, R::one(), len);
    select3(none, n, scaled(inverse, m))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::hash::KeyedHash;

    fn tri(v: [[f64; 3]; 3]) -> TriangleData {
        TriangleData { v, n: [0.0, 0.0, 1.0], shading: None }
    }

    fn hit(t: &TriangleData, o: [f64; 3], d: [f64; 3]) -> Option<f64> {
        let mut out = None;
        crossing(t.v, o, d, None, &mut |t: f64, _: f64, ok: crate::math::real::Bool| out = ok.0.then_some(t));
        out
    }

    #[test]
    fn both_sides_and_every_main_axis() {
        let t = tri([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_eq!(hit(&t, [0.2, 0.2, 3.0], [0.0, 0.0, -1.0]), Some(3.0));
        assert_eq!(hit(&t, [0.2, 0.2, -3.0], [0.0, 0.0, 1.0]), Some(3.0));
        assert_eq!(hit(&t, [0.7, 0.7, 3.0], [0.0, 0.0, -1.0]), None);
        let t = tri([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        assert_eq!(hit(&t, [-2.0, 0.2, 0.2], [1.0, 0.0, 0.0]), Some(2.0));
        let t = tri([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]);
        assert_eq!(hit(&t, [0.2, 7.0, 0.2], [0.0, -1.0, 0.0]), Some(7.0));
    }

    #[test]
    fn no_ray_passes_between_triangles_that_share_an_edge() {
        let random = |i: u64, k: u64| KeyedHash::new().with(i).with(k).unit();
        let mut far_from_edge = 0;
        for i in 0..20_000 {
            let far = if i % 2 == 0 { [0.0; 3] } else { [148_376.0, 1_234.0, -223_423.0] };
            let point = |k: u64| [0, 1, 2].map(|c| random(i, 3 * k + c) * 2.0 - 1.0 + far[c as usize]);
            let (a, b, c, d, o) = (point(0), point(1), point(2), point(3), point(4));
            let s = random(i, 99);
            let on_edge = [0, 1, 2].map(|k| a[k] + s * (b[k] - a[k]));
            let dir = minus(on_edge, o);
            let (left, right) = (hit(&tri([a, b, c]), o, dir), hit(&tri([b, a, d]), o, dir));
            // Where both triangles lie on one side of the edge, seen from here, a ray may pass beside both.
            let side = |p: [f64; 3]| {
                let m = |u: [f64; 3], v: [f64; 3]| {
                    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
                };
                let n = m(minus(a, o), minus(b, o));
                let q = minus(p, o);
                n[0] * q[0] + n[1] * q[1] + n[2] * q[2]
            };
            if side(c) * side(d) < -1e-6 {
                far_from_edge += 1;
                assert!(left.is_some() || right.is_some(), "ray {i} slips through");
            }
        }
        assert!(far_from_edge > 5_000);
    }
}
