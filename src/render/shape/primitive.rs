//! One surface of the world: a shape, where it stands, what it is made of.

use super::triangle::Sides;
use super::{Point, Ring, TriangleData, Tube, Visit, cuboid, flat, sphere, torus, triangle, tube};
use crate::math::Real;
use crate::math::real::{dot, each3, scaled, splat3};
use crate::render::frame::{Frame, LinearMap};
use crate::render::ray::Own;

/// A surface of the world.
#[derive(Clone, Copy, Debug)]
pub struct Primitive {
    /// Its shape, in its frame.
    pub kind: Kind,
    /// Where it stands.
    pub frame: Frame,
    /// Its material, by number in the world's table.
    pub material: u32,
    /// Where patterns find the space in which it was made, by number in the world's table; [`NO_SPACE`](Primitive::NO_SPACE)
    /// where no pattern asks.
    pub space: u32,
}

/// A shape in its own frame; all around the origin, axis along y.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// Radius.
    Sphere(f64),
    /// y = 0.
    Plane,
    /// y = 0 between the radii `hole` and `r`.
    Disc {
        /// Outer radius.
        r: f64,
        /// Inner radius.
        hole: f64,
    },
    /// Half its size along each axis.
    Cuboid([f64; 3]),
    /// Cylinder, cone or frustum.
    Tube(Tube),
    /// Torus.
    Ring(Ring),
    /// By number in the world's table. Its corners stand in the world, so the frame isn't used.
    Triangle(u32),
    /// By number in the world's table. Its triangles are surfaces with numbers of their own; it is none itself.
    Mesh(u32),
}

impl Kind {
    /// Whether a ray that leaves it to the outside never meets it again.
    pub fn is_left_for_good(&self) -> bool {
        match self {
            Kind::Sphere(_) | Kind::Plane | Kind::Disc { .. } | Kind::Cuboid(_) | Kind::Triangle(_) => true,
            // A triangle of it is, but another one may be in the way.
            Kind::Mesh(_) => false,
            Kind::Tube(tube) => tube.caps,
            Kind::Ring(_) => false,
        }
    }

    /// Whether shading normals may differ from geometric ones.
    pub fn may_be_smooth(&self) -> bool {
        matches!(self, Kind::Triangle(_) | Kind::Mesh(_))
    }
}

/// The world's tables that primitives refer to.
#[derive(Clone, Copy, Debug)]
pub struct Tables<'w> {
    /// Linear maps of frames.
    pub maps: &'w [LinearMap],
    /// Triangles.
    pub triangles: &'w [TriangleData],
}

/// What shading needs to know of a hit.
#[derive(Clone, Copy, Debug)]
pub struct Surface<R> {
    /// The point, in the camera-relative world.
    pub p: [R; 3],
    /// Geometric unit normal; outwards for closed shapes.
    pub n: [R; 3],
    /// Unit normal for shading, before any bump.
    pub ns: [R; 3],
    /// How far along `n` a new ray must start so that it is surely off this surface.
    pub offset: R,
    /// The point in the shape's frame; for triangles (β, 0, γ). Flat shapes have exactly 0 in the middle.
    pub local: [R; 3],
}

impl Primitive {
    /// [`space`](Primitive::space) of a primitive without patterns.
    pub const NO_SPACE: u32 = u32::MAX;

    /// Calls `visit(t, part, valid)` for every crossing of the line through `o` along `d`, behind the origin too.
    #[inline(always)]
    pub fn crossings<R: Real, const AT_EYE: bool>(
        &self,
        tables: Tables<'_>,
        o: [R; 3],
        d: [R; 3],
        own: Option<Own<R>>,
        visit: &mut impl Visit<R>,
    ) {
        if let Kind::Triangle(i) = self.kind {
            let v = each3!(tables.triangles[i as usize].v, v => splat3(v));
            return triangle::crossing(v, o, d, own, visit);
        }
        let ray = self.frame.localize::<R, AT_EYE>(tables.maps, o, d);
        match &self.kind {
            Kind::Sphere(r) => sphere::crossings(*r, &ray, own, visit),
            Kind::Plane => flat::plane_crossing(&ray, own, visit),
            Kind::Disc { r, hole } => flat::disc_crossing(*r, *hole, &ray, own, visit),
            Kind::Cuboid(half) => cuboid::crossings(*half, &ray, own, visit),
            Kind::Tube(t) => tube::crossings(t, &ray, own, visit),
            Kind::Ring(ring) => torus::crossings(ring, &ray, own, visit),
            Kind::Triangle(_) | Kind::Mesh(_) => {}
        }
    }

    /// The surface where the ray is at `t`, on `part`.
    #[inline(always)]
    pub fn surface<R: Real, const AT_EYE: bool>(
        &self,
        tables: Tables<'_>,
        o: [R; 3],
        d: [R; 3],
        t: R,
        part: R,
    ) -> Surface<R> {
        if let Kind::Triangle(i) = self.kind {
            return surface_of_triangle(tables, i, o, d);
        }
        let p = self.frame.localize::<R, AT_EYE>(tables.maps, o, d).at(t);
        let point = match &self.kind {
            Kind::Sphere(r) => sphere::point(*r, p),
            Kind::Plane | Kind::Disc { .. } | Kind::Triangle(_) | Kind::Mesh(_) => flat::point(p),
            Kind::Cuboid(half) => cuboid::point(*half, p, part),
            Kind::Tube(t) => tube::point(t, p, part),
            Kind::Ring(ring) => torus::point(ring, p),
        };
        surface_at(&self.frame, tables.maps, &point)
    }
}

/// A point of a shape in its frame, in the world.
#[inline(always)]
pub fn surface_at<R: Real>(frame: &Frame, maps: &[LinearMap], point: &Point<R>) -> Surface<R> {
    let error = frame.world_error(maps, point.p, point.error);
    let n = frame.normal_to_world(maps, point.n);
    Surface {
        p: frame.point_to_world(maps, point.p),
        n,
        ns: n,
        offset: dot(each3!(n, x => x.abs()), error),
        local: point.p,
    }
}

/// The surface of triangle number `i` where the ray meets it.
#[inline(always)]
pub fn surface_of_triangle<R: Real>(tables: Tables<'_>, i: u32, o: [R; 3], d: [R; 3]) -> Surface<R> {
    let tri = &tables.triangles[i as usize];
    // No `Option::map`: its closure may be compiled without the lanes' instructions.
    let mut shading = None;
    if let Some(s) = tri.shading {
        shading = Some(each3!(s, n => splat3(n)));
    }
    triangle::surface(Sides { v: each3!(tri.v, v => splat3(v)), n: splat3(tri.n), shading }, o, d)
}

/// The origin of a ray that leaves `p` on the side of `n` for a positive `offset`, on the other for a negative one.
#[inline(always)]
pub fn spawn_point<R: Real>(p: [R; 3], n: [R; 3], offset: R) -> [R; 3] {
    let step = scaled(offset, n);
    [p[0] + step[0], p[1] + step[1], p[2] + step[2]]
}
