//! One shape by itself, as checks of the kernels need it: placed, asked for its crossings in any scalar.

use super::draw::unit;
use crate::math::real::{Bool, minus};
use crate::math::{Affine, Real};
use crate::render::frame::{Frame, LinearMap};
use crate::render::ray::Own;
use crate::render::shape::primitive::{Surface, Tables};
use crate::render::shape::{Kind, Primitive, TriangleData, Visit};

/// A shape and the tables that it needs.
#[derive(Clone, Debug)]
pub struct Specimen {
    /// The shape and its frame.
    pub primitive: Primitive,
    map: Option<LinearMap>,
    triangle: Option<TriangleData>,
}

/// The crossings of a line with one shape: (t, part), the way in before the way out, at most four.
#[derive(Clone, Copy, Debug)]
pub struct Crossings<R> {
    count: usize,
    all: [(R, R); 4],
}

impl<R: Copy> Crossings<R> {
    /// Them.
    pub fn as_slice(&self) -> &[(R, R)] {
        &self.all[..self.count]
    }
}

impl Specimen {
    /// A shape in its frame.
    pub fn framed(kind: Kind, world_from_local: &Affine) -> Specimen {
        let mut map = None;
        let frame = Frame::new(world_from_local, |m| {
            map = Some(m);
            0
        });
        let primitive = Primitive { kind, frame, material: 0, space: Primitive::NO_SPACE };
        Specimen { primitive, map, triangle: None }
    }

    /// A triangle of the world.
    pub fn triangle(v: [[f64; 3]; 3]) -> Specimen {
        let at_origin = Specimen::framed(Kind::Triangle(0), &Affine::IDENTITY);
        Specimen { triangle: Some(triangle(v)), ..at_origin }
    }

    /// The corners, of a triangle.
    pub fn corners(&self) -> &[[f64; 3]] {
        self.triangle.as_ref().map_or(&[], |t| &t.v[..])
    }

    /// The linear map of its frame, where it has one.
    pub fn map(&self) -> Option<&LinearMap> {
        self.map.as_ref()
    }

    fn tables(&self) -> Tables<'_> {
        Tables { maps: self.map.as_slice(), triangles: self.triangle.as_slice() }
    }

    /// All crossings of a line, behind its origin too.
    pub fn line<R: Real<Mask = Bool>>(&self, o: [R; 3], d: [R; 3], own: Option<Own<R>>) -> Crossings<R> {
        let mut found = Crossings { count: 0, all: [(R::zero(), R::zero()); 4] };
        let mut keep = |t: R, part: R, ok: Bool| {
            if let (true, Some(place)) = (ok.0, found.all.get_mut(found.count)) {
                *place = (t, part);
                found.count += 1;
            }
        };
        self.visit(o, d, own, &mut keep);
        found
    }

    /// The crossings as the kernel shows them.
    pub fn visit<R: Real>(&self, o: [R; 3], d: [R; 3], own: Option<Own<R>>, visit: &mut impl Visit<R>) {
        self.primitive.crossings::<R, false>(self.tables(), o, d, own, visit);
    }

    /// The crossings of a ray: those at t > 0.
    pub fn ray<R: Real<Mask = Bool>>(&self, o: [R; 3], d: [R; 3], own: Option<Own<R>>) -> Crossings<R> {
        let mut found = self.line(o, d, own);
        let all = found;
        found.count = 0;
        for &(t, part) in all.as_slice() {
            if R::zero().lt(t).0 {
                found.all[found.count] = (t, part);
                found.count += 1;
            }
        }
        found
    }

    /// The surface where a ray is at `t`, on `part`.
    pub fn surface(&self, o: [f64; 3], d: [f64; 3], t: f64, part: f64) -> Surface<f64> {
        self.primitive.surface::<f64, false>(self.tables(), o, d, t, part)
    }
}

/// A triangle with its normal.
pub fn triangle(v: [[f64; 3]; 3]) -> TriangleData {
    let (a, b) = (unit(minus(v[1], v[0])), unit(minus(v[2], v[0])));
    let n = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    TriangleData { v, n: unit(n), shading: None }
}
