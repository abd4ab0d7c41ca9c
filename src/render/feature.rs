//! What the renderer can do, and which of it a scene requires.

use super::material::{Slot, Surfacing};
use super::options::Feature;
use super::shape::Kind;
use super::world::World;
use crate::diag::Place;
use crate::scene::{NodeId, Scene};

impl World {
    /// What the renderer can do, and which of it this scene requires, by the first text that does, where the scene still knows.
    pub fn features(&self, scene: &Scene) -> Vec<Feature> {
        let node_place = |id: NodeId| scene.nodes.get(id.0 as usize).map(|node| node.place.clone());
        // The first in the text, not in our numbering.
        let first = |wanted: &dyn Fn(usize) -> bool| -> Option<usize> {
            (0..self.primitives.len()).filter(|&i| wanted(i)).min_by_key(|&i| self.origins[i].0)
        };
        let surfacing = |i: usize| -> &Surfacing { self.surfacing(i as u32) };
        let by_shape = |name, what: &str, wanted: &dyn Fn(&Kind) -> bool| {
            let at = first(&|i| wanted(&self.primitives[i].kind));
            let count = self.primitives.iter().filter(|p| wanted(&p.kind)).count();
            feature(name, at.and_then(|i| node_place(self.origins[i].0)), count > 0, counted(count, "surface") + what)
        };
        let by_material = |name, detail: &str, wanted: &dyn Fn(&Surfacing) -> bool| {
            let at = first(&|i| wanted(surfacing(i)));
            let place = at.and_then(|i| {
                let (node, material) = self.origins[i];
                scene.material(material).place.clone().or_else(|| node_place(node))
            });
            feature(name, place, at.is_some(), detail.to_owned())
        };
        let is_pattern = |s: Slot| matches!(s, Slot::Pattern(_));
        let light = self.lights.iter().min_by_key(|l| l.node).and_then(|l| node_place(l.node));
        let lit = self.primitives.iter().any(|p| self.materials[p.material as usize].lit);
        let texels = self.patterns.textures.iter().map(|t| t.memory_bytes()).sum::<usize>();
        let linear = self.maps.len();
        let triangles = self.meshes.iter().map(|m| m.len()).sum();
        vec![
            by_shape("spheres", "", &|k| matches!(k, Kind::Sphere(_))),
            by_shape("planes", ", without bounds: tested for every tile", &|k| matches!(k, Kind::Plane)),
            by_shape("discs", "", &|k| matches!(k, Kind::Disc { .. })),
            by_shape("boxes", "", &|k| matches!(k, Kind::Cuboid(_))),
            by_shape("cylinders and cones", "", &|k| matches!(k, Kind::Tube(_))),
            by_shape("tori", "", &|k| matches!(k, Kind::Ring(_))),
            by_shape("triangles", "", &|k| matches!(k, Kind::Triangle(_))),
            by_shape("meshes", &format!(", {}", counted(triangles, "triangle")), &|k| matches!(k, Kind::Mesh(_))),
            feature("turned or stretched frames", None, linear > 0, counted(linear, "map")),
            feature("shadows", light, lit, counted(self.lights.len(), "light")),
            by_material("highlights", "one power for each light and hit", &|m| !m.specular.is_zero()),
            by_material("mirror reflection", "one ray more for each hit", &|m| !m.reflect.is_zero()),
            by_material("transparency", "one ray more for each hit, dimmed shadows", &|m| m.lets_through()),
            by_material("refraction", "Fresnel's formulas and one mirrored ray for each hit", &|m| m.ior.is_some()),
            by_material("patterns", &format!("{} compiled", self.patterns.nodes.len()), &|m| m.patterned),
            by_material("patterned transparency", "evaluated at every crossing of a shadow ray", &|m| {
                is_pattern(m.transmit)
            }),
            by_material("pictures", &format!("{} loaded, {texels} bytes", self.patterns.textures.len()), &|m| {
                m.pictured
            }),
            by_material("bumps", "six evaluations of the pattern for each hit", &|m| m.bump.is_some()),
        ]
    }
}

fn counted(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

fn feature(name: &'static str, required_by: Option<Place>, in_use: bool, detail: String) -> Feature {
    let (required_by, detail) = if in_use { (required_by, detail) } else { (None, String::new()) };
    Feature { name, required_by, in_use, detail }
}
