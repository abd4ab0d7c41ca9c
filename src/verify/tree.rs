//! The tree of boxes finds what testing every shape finds: the same t, bit for bit, of the same shape.
//!
//! Shapes stand on a grid of whole numbers, so that faces coincide and boxes touch, and rays come from within and from up to 2^30
//! away. The tree's boxes are `f32`, rounded outwards.

use super::draw::{Draw, power, unit};
use super::tally::{Tally, count};
use super::{Bound, Check, Outcome, Size};
use crate::diag::{FileId, Place, Span};
use crate::math::Affine;
use crate::math::real::{Bool, axpy, minus};
use crate::render::World;
use crate::scene::{Camera, Node, NodeId, NodeKind, Scene, Shape};
use glam::DVec3;

/// The check.
pub const CHECK: Check = Check { name: "tree", what: "the tree of boxes against testing every shape", run };

/// Shapes of the scene, within 0..WIDTH of the grid.
const SHAPES: u64 = 300;
const WIDTH: u64 = 12;

const DIFFERENT: usize = 0;
const TIES: usize = 1;

fn run(size: Size) -> Outcome {
    let rays = size.pick(3_000, 1_000_000);
    let scene = scene();
    let world = World::build(&scene, &Camera { from: DVec3::new(-3.0, 2.0, 5.0), ..Camera::default() });
    let tally = Tally::of(rays, |case, tally| {
        let (o, d) = ray(case);
        let (all, tied) = nearest_of_all(&world, o, d);
        let by_tree = nearest_by_tree(&world, o, d);
        tally.tried += all.is_some() as u64;
        tally.wrong[TIES] += tied as u64;
        if all.map(bits) != by_tree.map(bits) {
            tally.fail(DIFFERENT, case, || {
                format!("{case}: {by_tree:?} by the tree, {all:?} of all, from {o:?} along {d:?}")
            });
        }
    });
    Outcome {
        cases: rays,
        figures: vec![
            tally.never(DIFFERENT, "rays that the tree sends elsewhere".into()),
            tally.tried("rays that meet something".into(), rays / 2),
            count(
                "rays that meet two shapes at the same t".into(),
                tally.wrong[TIES],
                Bound::AtLeast(rays as f64 / 50.0),
            ),
        ],
        first_failure: tally.first.map(|f| f.1),
    }
}

fn bits((t, id): (f64, u32)) -> (u64, u32) {
    (t.to_bits(), id)
}

/// The nearest crossing and its shape; of two at the same t, the shape with the lower number.
struct Nearest {
    found: Option<(f64, u32)>,
    tied: bool,
}

impl Nearest {
    fn test(&mut self, world: &World, id: u32, o: [f64; 3], d: [f64; 3]) {
        let mut keep = |t: f64, _: f64, ok: Bool| {
            if !ok.0 || !(t > 0.0) {
                return;
            }
            let nearer = self.found.is_none_or(|(best, of)| t < best || (t == best && id < of));
            self.tied = self.found.is_some_and(|(best, of)| t == best && id != of) || (self.tied && !nearer);
            if nearer {
                self.found = Some((t, id));
            }
        };
        let (primitives, tables) = (world.primitives(), world.tables());
        primitives[id as usize].crossings::<f64, false>(tables, o, d, None, &mut keep);
    }
}

fn nearest_of_all(world: &World, o: [f64; 3], d: [f64; 3]) -> (Option<(f64, u32)>, bool) {
    let mut nearest = Nearest { found: None, tied: false };
    (0..world.primitives().len()).for_each(|id| nearest.test(world, id as u32, o, d));
    (nearest.found, nearest.tied)
}

fn nearest_by_tree(world: &World, o: [f64; 3], d: [f64; 3]) -> Option<(f64, u32)> {
    let mut nearest = Nearest { found: None, tied: false };
    world.tree().traverse(o, d, f64::INFINITY, |id| {
        nearest.test(world, id, o, d);
        nearest.found.map_or(f64::INFINITY, |f| f.0)
    });
    nearest.found
}

/// A ray at a point of the grid or between: from within, or from afar; one in three along an axis.
fn ray(case: u64) -> ([f64; 3], [f64; 3]) {
    let mut x = Draw::new("tree", case);
    let inner = |x: &mut Draw| -> [f64; 3] {
        let on_grid = x.once_in(3);
        [0; 3].map(|_| if on_grid { x.below(2 * WIDTH) as f64 * 0.5 } else { x.between(0.0, WIDTH as f64) })
    };
    let (target, other) = (inner(&mut x), inner(&mut x));
    let distance = power(x.below(31) as i32);
    if x.once_in(3) {
        let d = x.axis();
        return (axpy(-distance, d, target), d);
    }
    let along = minus(target, other);
    let from = axpy(-distance, if along == [0.0; 3] { [1.0, 2.0, 3.0] } else { along }, target);
    (from, unit(minus(target, from)))
}

/// Shapes of every kind, many of them twice in the same place.
fn scene() -> Scene {
    let mut scene = Scene::empty();
    let place = || Place::new(Span::new(FileId(0), 0..0));
    let mut add = |kind: NodeKind| {
        scene.nodes.push(Node { kind, material: None, name: None, place: place() });
        NodeId(scene.nodes.len() as u32 - 1)
    };
    let mut roots = Vec::new();
    for i in 0..SHAPES {
        let mut x = Draw::new("tree's shape", i);
        let mut corner = || DVec3::from_array([0; 3].map(|_| x.below(WIDTH) as f64));
        let (a, b, c, d) = (corner(), corner(), corner(), corner());
        let (r, axis) = (0.5 * (1 + i % 3) as f64, DVec3::AXES[(i / 3 % 3) as usize]);
        let size = DVec3::new(1.0, 1.0 + (i % 2) as f64, 1.0 + (i % 3) as f64);
        let shape = match i % 9 {
            0 | 1 => Shape::Box { from: a, to: a + size },
            2 => Shape::Sphere { at: a, r },
            3 => Shape::Disc { at: a, normal: axis, r: 2.0 * r, hole: 0.0 },
            4 => Shape::Cylinder { from: a, to: a + axis * r, r, caps: true },
            5 => Shape::Cone { from: a, to: a + axis * 2.0 + size, r, top: 0.0, caps: true },
            6 => Shape::Torus { at: a, r, tube: 0.25 * r, axis },
            7 if (b - a).cross(c - a).dot(d - a) != 0.0 => {
                Shape::Tetrahedron { points: Box::new([a, b, c, d].map(|p| a + (p - a) * 0.25)) }
            }
            _ => Shape::Triangle {
                points: Box::new([a, a + axis * 3.0, a + DVec3::new(axis.z, axis.x, axis.y) * 2.0]),
                normals: None,
            },
        };
        let node = add(NodeKind::Shape(shape));
        let stretch = Affine::translation(a * 0.5).compose(&Affine::scaling(DVec3::new(0.5, 0.25, 0.75)));
        roots.push(match i % 5 {
            0 => add(NodeKind::Transformed { child: node, parent_from_child: Box::new(stretch) }),
            _ => node,
        });
        if i % 4 == 0 {
            // Once more, and beside it by a whole number: faces of both coincide.
            let beside = Affine::translation(axis);
            roots.push(node);
            roots.push(add(NodeKind::Transformed { child: node, parent_from_child: Box::new(beside) }));
        }
    }
    scene.roots = roots;
    scene
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tree_finds_what_brute_force_finds() {
        let outcome = run(Size::Quick);
        assert!(outcome.is_within(), "{outcome:#?}");
    }
}
