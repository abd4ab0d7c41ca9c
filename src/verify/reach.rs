//! By which powers of two a scene can be scaled within the lengths that rtdsl supports.

use crate::scene::range::{LARGEST, SMALLEST};
use crate::scene::{NodeKind, Projection, Scene, Shape};
use glam::DVec3;
use std::ops::RangeInclusive;

/// Lengths of a scene, in the world.
struct Lengths {
    /// Not above the smallest size.
    least: f64,
    /// Not below the largest coordinate or size.
    most: f64,
}

impl Lengths {
    fn size(&mut self, x: f64, [least, most]: [f64; 2]) {
        if x > 0.0 && x * least < self.least {
            self.least = x * least;
        }
        if x * most > self.most {
            self.most = x * most;
        }
    }

    fn point(&mut self, p: DVec3) {
        self.size(p.abs().max_element(), [f64::INFINITY, 1.0]);
    }

    /// Points whose differences are sizes.
    fn points(&mut self, points: &[DVec3], scale: [f64; 2]) {
        for (i, p) in points.iter().enumerate() {
            self.size(p.abs().max_element(), [f64::INFINITY, scale[1]]);
            points[..i].iter().for_each(|q| self.size((*p - *q).abs().max_element(), scale));
        }
    }
}

/// The exponents k, at most ±400, for which all lengths times 2^k stay within the supported range.
pub fn reach(scene: &Scene) -> RangeInclusive<i32> {
    let mut lengths = Lengths { least: 1.0, most: 1.0 };
    for camera in &scene.cameras {
        lengths.points(&[camera.from, camera.at], [1.0, 1.0]);
        if let Projection::Orthographic { height } = camera.projection {
            lengths.size(height, [1.0, 1.0]);
        }
    }
    scene.for_each_instance(|instance| {
        let map = instance.world_from_object;
        lengths.point(DVec3::from_array(map.shift_f64()));
        let rows = map.linear_f64();
        let columns = [0, 1, 2].map(|c| DVec3::from_array(rows.map(|row| row[c])).length());
        let [x, y, z] = columns;
        let scale = [if x < y { x } else { y }, if x > y { x } else { y }];
        let scale = [if z < scale[0] { z } else { scale[0] }, if z > scale[1] { z } else { scale[1] }];
        match &scene.node(instance.node).kind {
            NodeKind::Light(light) => lengths.points(&[light.at], scale),
            NodeKind::Shape(shape) => shape_lengths(shape, scale, &mut lengths),
            NodeKind::Group(_) | NodeKind::Transformed { .. } => {}
        }
    });
    // Whole doublings that fit between, with one to spare for what isn't counted, such as a diagonal.
    let doublings = |ratio: f64| (crate::math::fun::log2(ratio) as i32 - 1).clamp(0, 400);
    -doublings(lengths.least / SMALLEST)..=doublings(LARGEST / lengths.most)
}

fn shape_lengths(shape: &Shape, scale: [f64; 2], lengths: &mut Lengths) {
    let (points, sizes): (&[DVec3], &[f64]) = match shape {
        Shape::Sphere { at, r } => (&[*at], &[*r]),
        Shape::Plane { through, .. } => (&[*through], &[]),
        Shape::Box { from, to } => (&[*from, *to], &[to.x - from.x, to.y - from.y, to.z - from.z]),
        Shape::Disc { at, r, hole, .. } => (&[*at], &[*r, *hole]),
        Shape::Cylinder { from, to, r, .. } => (&[*from, *to], &[*r]),
        Shape::Cone { from, to, r, top, .. } => (&[*from, *to], &[*r, *top]),
        Shape::Torus { at, r, tube, .. } => (&[*at], &[*r, *tube]),
        Shape::Triangle { points, .. } => (&points[..], &[]),
        Shape::Tetrahedron { points } => (&points[..], &[]),
    };
    lengths.points(points, scale);
    sizes.iter().for_each(|s| lengths.size(*s, scale));
}

#[cfg(test)]
mod tests {
    use super::super::stage::{Stage, Surface};
    use super::*;

    #[test]
    fn what_is_far_or_small_can_be_scaled_less() {
        let of = |at: f64, r: f64| {
            let mut stage = Stage::new();
            stage.shape(Shape::Sphere { at: DVec3::X * at, r }, Surface::default());
            reach(&stage.scene)
        };
        assert_eq!(of(5.0, 1.0), -400..=400);
        let (far, small) = (of(1e30, 1.0), of(1.0, 1e-30));
        assert!(*far.end() > 350 && *far.end() < 366 && *far.start() == -400, "{far:?}");
        assert!(*small.start() < -350 && *small.start() > -366 && *small.end() == 400, "{small:?}");
    }
}
