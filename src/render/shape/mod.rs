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

/// A point of a surface in the shape's frame.
#[derive(Clone, Copy, Debug)]
struct Point<R> {
    /// The point, brought back onto the surface.
    p: [R; 3],
    /// Unit normal; outwards for closed shapes.
    n: [R; 3],
    /// How far `p` can be from the surface, by component.
    error: [R; 3],
}
