//! Which surfaces a light lies on: a lamp in a ceiling, a bulb on a ball.
//!
//! A shadow ray to such a light ends on that surface, and rounding alone would decide whether it is met just before the end.
//! So the crossing at the light is taken out, as the one at the start is ([`Own`](super::ray::Own)).

use super::bounds::{Bounds, larger};
use super::shape::primitive::Tables;
use super::shape::{Kind, Primitive, SIDE, Visit};
use crate::math::Real;
use crate::math::real::{dot, minus};

/// How near counts as on, relative to the coordinates that go into a crossing: 64 roundings, several times what those are off.
const NEAR: f64 = 64.0 * f64::EPSILON;

/// A box around a light that surely meets the box of every bounded surface that the light lies on.
pub fn neighbourhood(light: [f64; 3]) -> Bounds {
    let reach = NEAR * light.iter().map(|x| x.abs()).fold(0.0, larger);
    Bounds::around(light, [reach; 3])
}

/// Whether the point lies on the surface, as far as rounding can tell.
pub fn lies_on(primitive: &Primitive, tables: Tables<'_>, point: [f64; 3]) -> bool {
    if let Kind::Triangle(i) = primitive.kind {
        let tri = &tables.triangles[i as usize];
        return lies_on_triangle(tri.v, tri.n, point);
    }
    let p = primitive.frame.localize::<f64, false>(tables.maps, point, [0.0; 3]).o;
    let stretch = match primitive.frame.axes {
        super::frame::Axes::Cyclic(_) => 1.0,
        super::frame::Axes::Linear(m) => {
            tables.maps[m as usize].local_from_world.as_flattened().iter().map(|x| x.abs()).fold(0.0, larger)
        }
    };
    let coordinates = primitive.frame.centre.iter().chain(&point).map(|x| x.abs()).fold(0.0, larger);
    let near = |extent: f64| NEAR * (coordinates * stretch + extent);
    let rho = p[0].mul_add(p[0], p[2] * p[2]).sqrt();
    match &primitive.kind {
        Kind::Sphere(r) => (dot(p, p).sqrt() - r).abs() <= near(*r),
        Kind::Plane | Kind::Disc { .. } => p[1].abs() <= near(0.0),
        Kind::Cuboid(half) => {
            let e = near(half.iter().copied().fold(0.0, larger));
            let beyond = (0..3).map(|i| p[i].abs() - half[i]).fold(f64::NEG_INFINITY, larger);
            beyond.abs() <= e
        }
        Kind::Tube(t) => {
            let e = near(t.radius + (t.slope * (t.top - t.bottom)).abs() + t.top.abs() + t.bottom.abs());
            let beyond_side = (rho - (t.radius + t.slope * p[1])) / (1.0 + t.slope * t.slope).sqrt();
            let beyond_ends = larger(t.bottom - p[1], p[1] - t.top);
            let on_side = beyond_side.abs() <= e && beyond_ends <= e;
            on_side || (t.caps && beyond_ends.abs() <= e && beyond_side <= e)
        }
        Kind::Ring(ring) => {
            let (r, tube) = (ring.r / ring.scale, ring.tube / ring.scale);
            let w = rho - r;
            ((w * w + p[1] * p[1]).sqrt() - tube).abs() <= near(r)
        }
        Kind::Triangle(_) | Kind::Mesh(_) => false,
    }
}

/// Whether the point lies in the plane of the triangle with the corners `v` and the normal `n`. Beside the triangle, but in its
/// plane, no ray to the light crosses it.
pub fn lies_on_triangle(v: [[f64; 3]; 3], n: [f64; 3], point: [f64; 3]) -> bool {
    let size = v.iter().flatten().chain(&point).map(|x| x.abs()).fold(0.0, larger);
    dot(n, minus(point, v[0])).abs() <= NEAR * size
}

/// Shows another visitor all crossings but the one nearest to the end of the rays.
pub struct ButAtTheEnd<'v, R: Real, V> {
    end: R,
    hold: bool,
    held: (R, R, R::Mask),
    inner: &'v mut V,
}

impl<'v, R: Real, V: Visit<R>> ButAtTheEnd<'v, R, V> {
    /// Keeps from `inner` the crossing nearest to `end`, if it shall `hold` any back.
    #[inline(always)]
    pub fn new(end: R, hold: bool, inner: &'v mut V) -> Self {
        let nothing = R::zero().lt(R::zero());
        ButAtTheEnd { end, hold, held: (R::splat(f64::INFINITY), R::splat(SIDE), nothing), inner }
    }
}

impl<R: Real, V: Visit<R>> Visit<R> for ButAtTheEnd<'_, R, V> {
    #[inline(always)]
    fn crossing(&mut self, t: R, part: R, valid: R::Mask) {
        if !self.hold {
            return self.inner.crossing(t, part, valid);
        }
        let (t_held, part_held, valid_held) = self.held;
        let nearer = valid & (t - self.end).abs().lt((t_held - self.end).abs());
        let (held, passed) = ((nearer & valid) | (!nearer & valid_held), (nearer & valid_held) | (!nearer & valid));
        self.held = (R::select(nearer, t, t_held), R::select(nearer, part, part_held), held);
        let other = (R::select(nearer, t_held, t), R::select(nearer, part_held, part));
        self.inner.crossing(other.0, other.1, passed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Affine;
    use crate::math::real::Bool;
    use crate::render::frame::Frame;
    use crate::render::shape::Tube;
    use glam::DVec3;

    #[test]
    fn on_beside_and_above() {
        let at = |kind: Kind, p: [f64; 3]| {
            let frame = Frame::new(&Affine::translation(DVec3::new(0.0, 3.0, 0.0)), |_| 0);
            let primitive = Primitive { kind, frame, material: 0, space: Primitive::NO_SPACE };
            lies_on(&primitive, Tables { maps: &[], triangles: &[] }, p)
        };
        assert!(at(Kind::Plane, [7.0, 3.0, 1.0]) && !at(Kind::Plane, [7.0, 3.0 - 1e-9, 1.0]));
        assert!(at(Kind::Sphere(1.0), [0.6, 3.8, 0.0]) && !at(Kind::Sphere(1.0), [0.0, 3.0, 0.0]));
        let cuboid = Kind::Cuboid([1.0, 0.5, 1.0]);
        assert!(at(cuboid, [0.2, 2.5, 0.3]) && !at(cuboid, [2.0, 2.5, 0.3]), "in a face, not beside it");
        let can = Kind::Tube(Tube { radius: 1.0, slope: 0.0, bottom: 0.0, top: 2.0, caps: true });
        assert!(at(can, [0.2, 5.0, 0.3]) && at(can, [1.0, 4.0, 0.0]) && !at(can, [3.0, 5.0, 0.0]));
    }

    #[test]
    fn the_crossing_at_the_end_is_held_back() {
        let mut seen = Vec::new();
        let mut keep = |t: f64, _: f64, ok: Bool| {
            if ok.0 {
                seen.push(t);
            }
        };
        let mut visit = ButAtTheEnd::new(5.0, true, &mut keep);
        for t in [1.0, 4.999_999, 7.0] {
            visit.crossing(t, 0.0, Bool(true));
        }
        seen.sort_by(f64::total_cmp);
        assert_eq!(seen, [1.0, 7.0]);
    }
}
