//! The surface where the rays of a region meet a sheet.
//!
//! Points are homogeneous: P/w. Of flat sheets w is 1/t, so that P and w are as straight as the rays and nothing is divided;
//! and the horizon, where w is 0, is a place like any other. Of curved ones w is 1.

use super::super::material::Surfacing;
use super::super::shape::primitive::surface_of_triangle;
use super::super::shape::{Kind, Primitive, SIDE};
use super::super::world::World;
use super::bundle::{Bundle, Start};
use super::polygon::Polygon;
use super::sheet::Sheet;
use crate::math::Form;
use crate::math::real::{dot, each3, three};

/// A surface that rays have met.
pub struct Met<'w> {
    /// Its primitive.
    pub primitive: &'w Primitive,
    /// What it is made of.
    pub surfacing: &'w Surfacing,
    /// The point, times [`w`](Met::w).
    pub p: [Form; 3],
    /// The point's denominator; not negative where it counts.
    pub w: Form,
    /// Unit normal on the viewer's side.
    pub n: [Form; 3],
    /// Unit normal for shading, on the same side; where it is another.
    pub bent: Option<[Form; 3]>,
    /// The point in the shape's frame, times `w`.
    pub local: [Form; 3],
    /// The rays' directions.
    pub d: [Form; 3],
    /// The point itself, where it is known.
    pub at: Option<[Form; 3]>,
    /// For rays that leave it on the viewer's side.
    pub start: Start,
}

impl<'w> Met<'w> {
    /// Where `ray` meets `sheet`; `None` where nothing useful can be said.
    pub fn new(world: &'w World, ray: &Bundle, sheet: &Sheet) -> Option<Met<'w>> {
        let (primitive, surfacing) = (world.primitive(sheet.id), world.surfacing(sheet.id));
        let start = Start { id: sheet.id, part: sheet.part, outward: !sheet.inside };
        let at = sheet.t.is_known().then(|| ray.at(sheet.t));
        let (p, w) = match sheet.flat {
            true => (three!(i => ray.o[i] * sheet.nearness + ray.d[i]), sheet.nearness),
            false => (at?, Form::constant(1.0)),
        };
        let face = |n: [Form; 3]| if sheet.inside { n.map(|x| -x) } else { n };
        let base = Met { primitive, surfacing, p, w, n: p, bent: None, local: p, d: ray.d, at, start };
        if let Kind::Triangle(_) | Kind::Mesh(_) = primitive.kind {
            let flat = match primitive.kind {
                Kind::Triangle(i) => {
                    let tri = &world.triangles[i as usize];
                    tri.shading.is_none().then_some(tri.n)
                }
                _ => {
                    let (mesh, k) = world.triangle(sheet.id);
                    mesh.is_flat().then(|| mesh.normal(k))
                }
            };
            if let Some(n) = flat
                && !surfacing.patterned
            {
                return Some(Met { n: face(n.map(Form::constant)), ..base });
            }
            let surface = match primitive.kind {
                Kind::Triangle(i) => surface_of_triangle::<Form>(world.tables(), i, ray.o, ray.d),
                _ => {
                    let (mesh, k) = world.triangle(sheet.id);
                    mesh.surface(k, (ray.o, ray.d))
                }
            };
            let bent = flat.is_none().then_some(face(surface.ns));
            let local = three!(i => surface.local[i] * w);
            return Some(Met { n: face(surface.n), bent, local, ..base });
        }
        let frame = &primitive.frame;
        let maps = world.tables().maps;
        let r = ray.localized(primitive, maps);
        let mut local = match sheet.flat {
            true => three!(i => (r.o[i] + r.o_lo[i]) * w + (r.d[i] + r.d_lo[i])),
            false => r.at(sheet.t),
        };
        let (zero, one) = (Form::constant(0.0), Form::constant(1.0));
        let n = match &primitive.kind {
            Kind::Sphere(radius) => each3!(local, x => x / Form::constant(*radius)),
            Kind::Tube(tube) if sheet.part == SIDE => {
                // There the distance from the axis is the profile's.
                let away = (local[1].times(tube.slope) + Form::constant(tube.radius)).reciprocal();
                let slope = Form::constant(tube.slope);
                let tilt = (slope * slope + one).reciprocal_root();
                [local[0] * away * tilt, -slope * tilt, local[2] * away * tilt]
            }
            Kind::Tube(tube) => {
                let top = sheet.part != super::super::shape::BOTTOM;
                local[1] = w.times(if top { tube.top } else { tube.bottom });
                [zero, if top { one } else { -one }, zero]
            }
            Kind::Cuboid(half) => {
                let (axis, upper) = (sheet.part as usize / 2, sheet.part as usize % 2 == 1);
                let sign = if upper { 1.0 } else { -1.0 };
                local[axis] = w.times(sign * half[axis]);
                three!(i => if i == axis { Form::constant(sign) } else { zero })
            }
            _ => {
                local[1] = zero;
                [zero, one, zero]
            }
        };
        Some(Met { n: face(frame.normal_to_world(maps, n)), local, ..base })
    }

    /// Whether rays that leave it to the inside may meet it again.
    pub fn is_curved(&self) -> bool {
        matches!(self.primitive.kind, Kind::Sphere(_) | Kind::Cuboid(_) | Kind::Tube(_) | Kind::Ring(_))
    }

    /// Whether its normals are all known well enough to be of any use on `p`.
    pub fn is_useful(&self, p: &Polygon) -> bool {
        self.n.iter().all(|f| f.is_known()) && p.range(dot(self.n, self.n)).1 < 4.0
    }
}
