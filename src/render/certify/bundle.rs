//! Rays of a region: origins and directions as forms.

use super::super::bounds::{Bounds, larger};
use super::super::cull::{Cone, Shaft, margin};
use super::super::frame::LinearMap;
use super::super::ray::LocalRay;
use super::super::shape::Primitive;
use super::certifier::Certifier;
use super::polygon::Polygon;
use crate::math::real::{minus, three};
use crate::math::{Form, Real};

/// Most surfaces that a bundle may meet; with more, pixels are cheaper sampled.
const MOST_CANDIDATES: usize = 24;

/// Numbers of surfaces that a bundle may meet, in place: they are asked for at every look and at every light.
#[derive(Clone, Debug)]
pub struct Few {
    n: usize,
    ids: [u32; MOST_CANDIDATES],
}

impl Few {
    /// No surface.
    pub fn none() -> Few {
        Few { n: 0, ids: [0; MOST_CANDIDATES] }
    }

    /// Adds one; whether there was room.
    pub fn push(&mut self, id: u32) -> bool {
        let free = self.ids.get_mut(self.n);
        let fits = free.is_some();
        if let Some(free) = free {
            (*free, self.n) = (id, self.n + 1);
        }
        fits
    }
}

impl std::ops::Deref for Few {
    type Target = [u32];
    fn deref(&self) -> &[u32] {
        &self.ids[..self.n]
    }
}

/// The surface that rays start on.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// Its number.
    pub id: u32,
    /// The part of it.
    pub part: f64,
    /// Whether they leave it to the outside.
    pub outward: bool,
}

/// Rays of a region.
#[derive(Clone, Copy, Debug)]
pub struct Bundle {
    /// Origins.
    pub o: [Form; 3],
    /// Directions, of any length but 0.
    pub d: [Form; 3],
    /// Where they start, unless that is the camera or a light.
    pub start: Option<Start>,
    /// The rectangle of the picture that they pass through, if they come from the camera.
    pub rect: Option<[f64; 4]>,
}

impl Bundle {
    /// The rays in a primitive's frame.
    pub fn localized(&self, primitive: &Primitive, maps: &[LinearMap]) -> LocalRay<Form> {
        primitive.frame.localize::<Form, false>(maps, self.o, self.d)
    }

    /// Where the rays are at `t`.
    pub fn at(&self, t: Form) -> [Form; 3] {
        three!(i => t.mul_add(self.d[i], self.o[i]))
    }

    /// The surfaces that rays on `p` may meet; `None` where there are too many.
    pub fn candidates(&self, scene: &Certifier<'_>, p: &Polygon) -> Option<Few> {
        let margin = margin(f64::EPSILON);
        if let Some(rect) = self.rect {
            let (grid, frustum) = (&scene.grid, scene.grid.frustum(rect, margin));
            let plane = |n, offset| grid.may_meet_plane(rect, n, offset, margin);
            return scene.gather(|b| frustum.may_meet(b), plane);
        }
        let origins = bounds_of(p, self.o)?;
        let directions = bounds_of(p, self.d)?;
        let axis = directions.centre();
        let length = (axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]).sqrt();
        // The sine of the widest angle to the axis.
        let sine = directions.radius() / length;
        let cos = if sine < 1.0 { (1.0 - sine * sine).sqrt() - margin } else { -1.0 };
        let axis = axis.map(|x| x / length);
        let cone = Cone::of_directions(origins.centre(), origins.radius(), axis, cos, margin);
        scene.gather(|b| cone.may_meet(b), |n, offset| cone.may_reach(&origins, n, offset))
    }

    /// The surfaces that may stand between a light and points of `p`; the bundle's rays come from the light.
    pub fn occluders(scene: &Certifier<'_>, light: [f64; 3], points: &Bounds) -> Option<Few> {
        let shaft = Shaft::new(points, light, margin(f64::EPSILON));
        scene.gather(|b| shaft.may_meet(b), |n, offset| shaft.may_cross(points, n, offset))
    }
}

/// A box around all values on `p`; `None` where they aren't bounded.
pub fn bounds_of(p: &Polygon, v: [Form; 3]) -> Option<Bounds> {
    let ranges = v.map(|f| p.range(f));
    let bounds = Bounds { lo: ranges.map(|r| r.0), hi: ranges.map(|r| r.1) };
    let reach = ranges.iter().fold(0.0, |m, r| larger(m, larger(r.0.abs(), r.1.abs())));
    (reach < f64::INFINITY).then_some(bounds)
}

/// `a − b`, one of them constant.
pub fn from_constant(a: [f64; 3], b: [Form; 3]) -> [Form; 3] {
    minus(a.map(Form::constant), b)
}
