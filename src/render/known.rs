//! A surface of which the compiler knows what kind of shape it is, and that it stands upright: for loops over many rays.
//!
//! A [`Primitive`] decides for each register of rays which kernel they need. That, and what the ways of all kernels have in common,
//! takes as many instructions as a kernel itself. What is here is decided once, by [`with_known`], and compiled for each kind.

use super::frame::{Axes, Frame};
use super::ray::Own;
use super::shape::primitive::{Tables, surface_at, surface_of_triangle};
use super::shape::{Kernel, Primitive, Surface, TriangleData, Visit, triangle};
use crate::math::Real;
use crate::math::real::{each3, splat3};

/// A surface.
pub trait Known: Copy {
    /// As [`Primitive::crossings`].
    fn crossings<R: Real, const AT_EYE: bool>(
        self,
        tables: Tables<'_>,
        ray: ([R; 3], [R; 3]),
        own: Option<Own<R>>,
        visit: &mut impl Visit<R>,
    );
    /// As [`Primitive::surface`].
    fn surface<R: Real, const AT_EYE: bool>(self, tables: Tables<'_>, ray: ([R; 3], [R; 3]), at: (R, R)) -> Surface<R>;
    /// Whether a ray that leaves it to the outside never meets it again.
    fn is_left_for_good(self) -> bool;
}

/// A shape whose axes are the world's.
#[derive(Clone, Copy)]
pub struct Upright<K> {
    kernel: K,
    frame: Frame,
}

impl<K: Kernel> Upright<K> {
    /// A shape that stands in `frame`, whose axes are those of the world.
    #[inline(always)]
    pub fn new(kernel: K, frame: &Frame) -> Upright<K> {
        // Said again, so that the compiler knows it too.
        Upright { kernel, frame: Frame { axes: Axes::Cyclic(0), ..*frame } }
    }
}

impl<K: Kernel> Known for Upright<K> {
    #[inline(always)]
    fn crossings<R: Real, const AT_EYE: bool>(
        self,
        _: Tables<'_>,
        (o, d): ([R; 3], [R; 3]),
        own: Option<Own<R>>,
        visit: &mut impl Visit<R>,
    ) {
        self.kernel.crossings(&self.frame.localize::<R, AT_EYE>(&[], o, d), own, visit);
    }
    #[inline(always)]
    fn surface<R: Real, const AT_EYE: bool>(
        self,
        _: Tables<'_>,
        (o, d): ([R; 3], [R; 3]),
        (t, part): (R, R),
    ) -> Surface<R> {
        let p = self.frame.localize::<R, AT_EYE>(&[], o, d).at(t);
        surface_at(&self.frame, &[], &self.kernel.point(p, part))
    }
    #[inline(always)]
    fn is_left_for_good(self) -> bool {
        self.kernel.is_left_for_good()
    }
}

/// A triangle, by number in the world's table.
#[derive(Clone, Copy)]
pub struct Triangle(pub u32);

impl Known for Triangle {
    #[inline(always)]
    fn crossings<R: Real, const AT_EYE: bool>(
        self,
        tables: Tables<'_>,
        (o, d): ([R; 3], [R; 3]),
        own: Option<Own<R>>,
        visit: &mut impl Visit<R>,
    ) {
        let TriangleData { v, .. } = &tables.triangles[self.0 as usize];
        triangle::crossing(each3!(*v, v => splat3(v)), o, d, own, visit);
    }
    #[inline(always)]
    fn surface<R: Real, const AT_EYE: bool>(
        self,
        tables: Tables<'_>,
        (o, d): ([R; 3], [R; 3]),
        _: (R, R),
    ) -> Surface<R> {
        surface_of_triangle(tables, self.0, o, d)
    }
    #[inline(always)]
    fn is_left_for_good(self) -> bool {
        true
    }
}

/// Any other: decided for each register.
impl Known for &Primitive {
    #[inline(always)]
    fn crossings<R: Real, const AT_EYE: bool>(
        self,
        tables: Tables<'_>,
        (o, d): ([R; 3], [R; 3]),
        own: Option<Own<R>>,
        visit: &mut impl Visit<R>,
    ) {
        Primitive::crossings::<R, AT_EYE>(self, tables, o, d, own, visit);
    }
    #[inline(always)]
    fn surface<R: Real, const AT_EYE: bool>(
        self,
        tables: Tables<'_>,
        (o, d): ([R; 3], [R; 3]),
        (t, part): (R, R),
    ) -> Surface<R> {
        Primitive::surface::<R, AT_EYE>(self, tables, o, d, t, part)
    }
    #[inline(always)]
    fn is_left_for_good(self) -> bool {
        self.kind.is_left_for_good()
    }
}

/// Does `$body` with `$known`, which is the surface `$primitive` as the compiler knows it: once for each of the commonest kinds of shape
/// that stand upright, and once for all others. A macro, for a closure isn't surely inlined.
macro_rules! with_known {
    ($primitive:expr, $known:ident => $body:expr) => {{
        use crate::render::frame::Axes;
        use crate::render::known::{Triangle, Upright};
        use crate::render::shape::{Ball, Cuboid, Kind, Plane, Primitive};
        let primitive: &Primitive = $primitive;
        let frame = &primitive.frame;
        match (primitive.kind, primitive.frame.axes) {
            (Kind::Sphere(r), Axes::Cyclic(0)) => {
                let $known = Upright::new(Ball { r }, frame);
                $body
            }
            (Kind::Plane, Axes::Cyclic(0)) => {
                let $known = Upright::new(Plane, frame);
                $body
            }
            (Kind::Cuboid(half), Axes::Cyclic(0)) => {
                let $known = Upright::new(Cuboid(half), frame);
                $body
            }
            (Kind::Tube(tube), Axes::Cyclic(0)) => {
                let $known = Upright::new(tube, frame);
                $body
            }
            (Kind::Triangle(i), _) => {
                let $known = Triangle(i);
                $body
            }
            _ => {
                let $known = primitive;
                $body
            }
        }
    }};
}
pub(super) use with_known;
