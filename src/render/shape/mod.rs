//! The shapes as the tracer sees them: one kernel a file, written once for every scalar.
//!
//! A kernel visits every crossing of a line with its surface, in the shape's own frame, as (t, part, valid). What is done
//! with a crossing, keeping the nearest or dimming a light, is the caller's. `part` tells the faces of one shape apart.

mod cuboid;
mod flat;
mod mesh;
pub mod primitive;
pub mod quadric;
mod sphere;
mod torus;
pub mod triangle;
mod tube;

use super::ray::{LocalRay, Own};
use crate::math::{Mask, Real};
pub use mesh::Mesh;
pub use primitive::{Kind, Primitive, Surface};
pub use sphere::Ball;
pub use torus::Ring;
pub use triangle::TriangleData;
pub use tube::Tube;

/// The curved side of a shape with caps, and the only part of shapes without.
pub const SIDE: f64 = 0.0;
/// The cap at the lower end.
pub const BOTTOM: f64 = 1.0;
/// The cap at the upper end.
pub const TOP: f64 = 2.0;

/// Is shown every crossing of a line with a surface. A trait and not a closure, so that the hot ones are surely inlined into
/// the kernels.
pub trait Visit<R: Real> {
    /// A crossing at `t`, on `part`, in the lanes of `valid`; elsewhere the numbers mean nothing.
    fn crossing(&mut self, t: R, part: R, valid: R::Mask);

    /// The lanes in which a crossing further on may matter, when one at `t` was found in the lanes of `valid`. In others kernels
    /// save its root and may show it or not, whatever comes of the lanes beside: so it has to be said of each lane by itself.
    #[inline(always)]
    fn needs_further(&self, t: R, valid: R::Mask) -> R::Mask {
        let _ = (t, valid);
        R::Mask::splat(true)
    }
}

impl<R: Real, F: FnMut(R, R, R::Mask)> Visit<R> for F {
    #[inline(always)]
    fn crossing(&mut self, t: R, part: R, valid: R::Mask) {
        self(t, part, valid);
    }
}

/// A kind of shape in its own frame, known to the compiler.
pub trait Kernel: Copy {
    /// Calls `visit(t, part, valid)` for every crossing of the ray's line, behind the origin too.
    fn crossings<R: Real>(self, ray: &LocalRay<R>, own: Option<Own<R>>, visit: &mut impl Visit<R>);
    /// The point of the surface under `p`, on `part`.
    fn point<R: Real>(self, p: [R; 3], part: R) -> Point<R>;
    /// Whether a ray that leaves it to the outside never meets it again.
    fn is_left_for_good(self) -> bool;
}

/// The plane y = 0.
#[derive(Clone, Copy, Debug)]
pub struct Plane;

/// A box, by half its size along each axis.
#[derive(Clone, Copy, Debug)]
pub struct Cuboid(pub [f64; 3]);

impl Kernel for Ball {
    #[inline(always)]
    fn crossings<R: Real>(self, ray: &LocalRay<R>, own: Option<Own<R>>, visit: &mut impl Visit<R>) {
        sphere::crossings(self.r, ray, own, visit);
    }
    #[inline(always)]
    fn point<R: Real>(self, p: [R; 3], _part: R) -> Point<R> {
        sphere::point(self.r, p)
    }
    #[inline(always)]
    fn is_left_for_good(self) -> bool {
        true
    }
}

impl Kernel for Plane {
    #[inline(always)]
    fn crossings<R: Real>(self, ray: &LocalRay<R>, own: Option<Own<R>>, visit: &mut impl Visit<R>) {
        flat::plane_crossing(ray, own, visit);
    }
    #[inline(always)]
    fn point<R: Real>(self, p: [R; 3], _part: R) -> Point<R> {
        flat::point(p)
    }
    #[inline(always)]
    fn is_left_for_good(self) -> bool {
        true
    }
}

impl Kernel for Cuboid {
    #[inline(always)]
    fn crossings<R: Real>(self, ray: &LocalRay<R>, own: Option<Own<R>>, visit: &mut impl Visit<R>) {
        cuboid::crossings(self.0, ray, own, visit);
    }
    #[inline(always)]
    fn point<R: Real>(self, p: [R; 3], part: R) -> Point<R> {
        cuboid::point(self.0, p, part)
    }
    #[inline(always)]
    fn is_left_for_good(self) -> bool {
        true
    }
}

impl Kernel for Tube {
    #[inline(always)]
    fn crossings<R: Real>(self, ray: &LocalRay<R>, own: Option<Own<R>>, visit: &mut impl Visit<R>) {
        tube::crossings(&self, ray, own, visit);
    }
    #[inline(always)]
    fn point<R: Real>(self, p: [R; 3], part: R) -> Point<R> {
        tube::point(&self, p, part)
    }
    #[inline(always)]
    fn is_left_for_good(self) -> bool {
        self.caps
    }
}

/// A point of a surface in the shape's frame.
#[derive(Clone, Copy, Debug)]
pub struct Point<R> {
    /// The point, brought back onto the surface.
    pub p: [R; 3],
    /// Unit normal; outwards for closed shapes.
    pub n: [R; 3],
    /// How far `p` can be from the surface, by component.
    pub error: [R; 3],
}
