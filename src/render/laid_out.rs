//! A world whose shapes have their places and numbers, before it has a tree: what is needed of the scene is then known.

use super::ball::{Ball, ball_radius};
use super::bounds::Bounds;
use super::bvh::{Bvh, Company};
use super::census::{PrimitiveKey, same_geometry, surfaces_renumbered};
use super::shape::{Kind, Primitive};
use super::world::World;
use std::sync::atomic::AtomicBool;

/// A world without a tree.
pub struct LaidOut {
    pub world: World,
    /// None where nobody wants them.
    pub keys: Vec<PrimitiveKey>,
    /// What goes into the tree, but for balls.
    pub bounded: Vec<(u32, Bounds)>,
}

impl LaidOut {
    /// The whole world, and the keys; `None` where `cancel` was set meanwhile.
    pub fn grow(
        self,
        before: Option<(&World, &[PrimitiveKey])>,
        cancel: &AtomicBool,
    ) -> Option<(World, Vec<PrimitiveKey>)> {
        let LaidOut { mut world, keys, bounded } = self;
        world.has_rings = world.primitives.iter().any(|p| matches!(p.kind, Kind::Ring(_)));
        // Boxes are relative to the camera's place.
        let before = before.filter(|(old, _)| old.eye == world.eye);
        world.bvh = match before.and_then(|b| grafted(b, (&world, &keys), &bounded)) {
            Some(bvh) => bvh,
            None => {
                let balls = (world.owners.primitives, |id| world.box_of_ball(id));
                Bvh::build_with_balls(balls, bounded, |id| world.company(id), cancel)?
            }
        };
        // What is met of a swarm is all but surely met: its ball isn't worth keeping.
        if !world.bvh.has_swarms() {
            world.balls = world.primitives.iter().map(|p| Ball::around(p, &world.maps)).collect();
        }
        world.find_touched_surfaces();
        world.find_flocks();
        Some((world, keys))
    }
}

impl World {
    /// With what surface `id` may share a leaf of the tree.
    fn company(&self, id: u32) -> Company {
        match self.primitives.get(id as usize) {
            None => Company::Triangles,
            Some(primitive) if ball_radius(&primitive.kind, &primitive.frame).is_some() => Company::Balls,
            Some(_) => Company::Alone,
        }
    }

    /// The box of primitive `id`, if it is a ball.
    fn box_of_ball(&self, id: u32) -> Option<Bounds> {
        let Primitive { kind, frame, .. } = self.primitives.get(id as usize)?;
        Some(Bounds::around(frame.centre, [ball_radius(kind, frame)?; 3]))
    }
}

/// The old world's tree, with what became of its primitives.
fn grafted(
    (old, old_keys): (&World, &[PrimitiveKey]),
    (new, keys): (&World, &[PrimitiveKey]),
    bounded: &[(u32, Bounds)],
) -> Option<Bvh> {
    let renumbered = same_geometry(old_keys, keys);
    let mut is_new = vec![true; keys.len()];
    renumbered.iter().filter(|&&id| id != u32::MAX).for_each(|&id| is_new[id as usize] = false);
    let balls = (0..keys.len() as u32).filter_map(|id| Some((id, new.box_of_ball(id)?)));
    let added = bounded.iter().copied().chain(balls).filter(|b| is_new[new.owners.of(b.0) as usize]).collect();
    old.bvh.grafted(&surfaces_renumbered(renumbered, old, new), added)
}
