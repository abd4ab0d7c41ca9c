//! Which hits are shaded together: those of surfaces of one material that differ in nothing but where they are.

use super::shape::{Kind, Primitive};
use super::world::{PointLight, World};

impl World {
    /// Finds for every primitive the first one whose hits are shaded with its own. Patterns start from the primitive's own frame,
    /// and a light that lies on a surface is looked at from that one alone: such stay by themselves. So do meshes, whose
    /// triangles differ by lane.
    pub(super) fn find_flocks(&mut self) {
        let mut first_of = vec![[u32::MAX; 2]; self.materials.len()];
        self.flocks = (0..self.primitives.len() as u32)
            .map(|id| {
                let Primitive { kind, material, .. } = &self.primitives[id as usize];
                let material = *material as usize;
                let alone = matches!(kind, Kind::Mesh(_)) || self.materials[material].patterned;
                if alone || self.is_touched(id) {
                    return id;
                }
                let first = &mut first_of[material][kind.may_be_smooth() as usize];
                if *first == u32::MAX {
                    *first = id;
                }
                *first
            })
            .collect();
    }

    fn is_touched(&self, id: u32) -> bool {
        self.lights.iter().any(|light| self.touches(light, id))
    }

    /// Whether the light lies on primitive `id`, or on a triangle of it.
    #[inline(always)]
    pub(super) fn touches(&self, light: &PointLight, id: u32) -> bool {
        !light.touched.is_empty() && light.touched.iter().any(|&t| self.owners.of(t) == id)
    }

    /// The primitive that stands for all those whose hits are shaded together with those of surface `id`.
    #[inline(always)]
    pub(super) fn flock(&self, id: u32) -> u32 {
        self.flocks[self.owners.of(id) as usize]
    }
}
