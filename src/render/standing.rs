//! The shapes of a scene where they stand, before they have numbers.

use super::digest::LengthKey;
use super::pattern_point::MadeDetail;
use super::place::{Placed, place};
use super::world::{Made, MadeSpace, PointLight};
use crate::math::real::three;
use crate::math::{Affine, Dd};
use crate::scene::{Camera, MaterialId, NodeId, NodeKind, Scene, Shape};
use glam::DVec3;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// The shapes of a scene where they stand.
pub struct Standing<'s> {
    pub scene: &'s Scene,
    /// Node, material, and the number of its transform.
    pub shapes: Vec<(NodeId, MaterialId, u32)>,
    /// From objects to the camera-relative world.
    transforms: Vec<Affine>,
}

impl<'s> Standing<'s> {
    /// Finds every shape and light, and where it stands.
    pub fn visit(scene: &'s Scene, camera: &Camera, cancel: &AtomicBool) -> Option<(Standing<'s>, Vec<PointLight>)> {
        let to_camera = Affine::translation(-camera.from);
        let mut standing = Standing { scene, shapes: Vec::new(), transforms: vec![to_camera] };
        let mut lights = Vec::new();
        // From the camera down: what moves both scene and camera cancels first, exactly.
        let visited = scene.try_for_each_instance_from(&to_camera, |i| {
            match &scene.node(i.node).kind {
                NodeKind::Light(light) => {
                    let at = i.world_from_object.apply(light.at).to_array();
                    let color = (light.color * light.power).0;
                    if color != [0.0; 3] {
                        lights.push(PointLight { at, color, touched: Box::default(), node: i.node });
                    }
                }
                NodeKind::Shape(_) => {
                    if standing.transforms.last() != Some(&i.world_from_object) {
                        standing.transforms.push(i.world_from_object);
                    }
                    standing.shapes.push((i.node, i.material, standing.transforms.len() as u32 - 1));
                }
                NodeKind::Group(_) | NodeKind::Transformed { .. } => {}
            }
            if cancel.load(Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        lights.sort_by_cached_key(|l| LengthKey::new(l.color.into_iter(), l.at.into_iter()));
        visited.is_continue().then_some((standing, lights))
    }

    /// Part `part` of shape number `shape`.
    pub fn part(&self, Part { shape, part }: Part) -> Option<(Placed, &Shape, &Affine)> {
        let (node, _, transform) = self.shapes[shape as usize];
        let NodeKind::Shape(shape) = &self.scene.node(node).kind else { return None };
        let world_from_object = &self.transforms[transform as usize];
        Some((place(shape, world_from_object, part as usize), shape, world_from_object))
    }
}

/// A shape, or one face of it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Part {
    pub shape: u32,
    pub part: u8,
}

pub fn made_space(placed: &Placed, made: &Made, detailed: bool) -> MadeSpace {
    let detail = || {
        let back = made.world_from_object.inverse().unwrap_or(Affine::IDENTITY);
        Box::new(MadeDetail {
            made_normal_from_world: transposed(&made.world_from_object),
            world_normal_from_made: transposed(&back),
            from_centre: three!(i => (placed.made_from_local.shift[i] - made.centre[i]).round()),
            half_height: made.half_height,
        })
    };
    MadeSpace {
        made_from_local: placed.made_from_local,
        rescale: placed.rescale.map(Box::new),
        detail: detailed.then(detail),
    }
}

/// How the space lies in which a shape was made.
pub fn made(scene: &Scene, shape: &Shape, world_from_object: &Affine) -> Made {
    let (centre, half_height) = middle(shape, scene);
    Made { world_from_object: *world_from_object, centre, half_height }
}

/// Centre and half height of a shape in the space in which it is made; a plane's point and ½.
fn middle(shape: &Shape, scene: &Scene) -> ([Dd; 3], f64) {
    use Shape::*;
    let exactly = |p: &DVec3| p.to_array().map(Dd::new);
    let of_points = |points: &[DVec3]| {
        let (lo, hi) = points.iter().fold((points[0], points[0]), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
        // The middle of two numbers far out may lie between two numbers.
        let half = ((hi - lo) * 0.5).to_array();
        (three!(i => exactly(&lo)[i] + Dd::new(half[i])), half[1])
    };
    let (centre, half) = match shape {
        Sphere { at, r } => (exactly(at), *r),
        Plane { through, .. } => (exactly(through), 0.5),
        Box { from, to } => of_points(&[*from, *to]),
        Disc { at, r, .. } => (exactly(at), *r),
        Cylinder { from, to, .. } | Cone { from, to, .. } => of_points(&[*from, *to]),
        Torus { at, tube, .. } => (exactly(at), *tube),
        Triangle { points, .. } => of_points(&points[..]),
        Tetrahedron { points } => of_points(&points[..]),
        Mesh { mesh, .. } => of_points(&scene.mesh(*mesh).data.bounds),
    };
    (centre, if half > 0.0 { half } else { 0.5 })
}

/// The transposed linear part: normals go by the inverse transposed.
fn transposed(map: &Affine) -> [[f64; 3]; 3] {
    let m = map.linear_f64();
    std::array::from_fn(|r| std::array::from_fn(|c| m[c][r]))
}
