//! The scene: arenas of nodes, materials, patterns and images that refer to each other by id. A value that the text uses
//! twice is stored once; a node may have several parents.

use super::{Camera, Color, Image, Light, Material, MaterialId, Pattern, PatternId, Settings, Shape};
use crate::diag::Place;
use crate::math::Affine;
use std::ops::ControlFlow;

/// Names a node of a [`Scene`]. Children have smaller ids than their parents.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct NodeId(pub u32);

/// Everything a picture needs.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Shapes, lights, groups and transforms.
    pub nodes: Vec<Node>,
    /// What the file's top level was given, in the order of the text.
    pub roots: Vec<NodeId>,
    /// Materials; [`MaterialId`]`(0)` is the default grey.
    pub materials: Vec<Material>,
    /// Patterns.
    pub patterns: Vec<Pattern>,
    /// Pictures that a live pattern shows; others were never opened.
    pub images: Vec<Image>,
    /// At least one; the first is the default.
    pub cameras: Vec<Camera>,
    /// What a ray sees that meets nothing.
    pub background: Color,
    /// Light that reaches every point.
    pub ambient: Color,
    /// Size and quality.
    pub settings: Settings,
}

/// A part of the scene and the text that made it. There may be millions: what only few have stands elsewhere.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// What it is.
    pub kind: NodeKind,
    /// Its material; `None` takes the one around it. Ignored for lights.
    pub material: Option<MaterialId>,
    /// What the author called it.
    pub name: Option<Box<str>>,
    /// The text and the calls.
    pub place: Place,
}

/// What a node is.
#[derive(Clone, Debug, PartialEq)]
pub enum NodeKind {
    /// A surface.
    Shape(Shape),
    /// A light.
    Light(Light),
    /// Several nodes.
    Group(Vec<NodeId>),
    /// A moved, turned or scaled node. The map can be inverted.
    Transformed {
        /// What is moved.
        child: NodeId,
        /// Where it goes.
        parent_from_child: Box<Affine>,
    },
}

/// One shape or light where it stands in the world.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Its node: a shape or a light.
    pub node: NodeId,
    /// All transforms around it.
    pub world_from_object: Affine,
    /// Its own material, or the innermost one around it, or the default.
    pub material: MaterialId,
}

impl Scene {
    /// A scene of nothing, with the default camera, material and settings.
    pub fn empty() -> Scene {
        let mut patterns = Vec::new();
        let plain = Material::plain(|p| {
            patterns.push(p);
            PatternId(patterns.len() as u32 - 1)
        });
        Scene {
            nodes: Vec::new(),
            roots: Vec::new(),
            materials: vec![plain],
            patterns,
            images: Vec::new(),
            cameras: vec![Camera::default()],
            background: Color::BLACK,
            ambient: Color::linear_gray(0.1),
            settings: Settings::default(),
        }
    }

    /// The node named `id`.
    pub fn node(&self, id: NodeId) -> &Node {
        &self.nodes[id.0 as usize]
    }
    /// The material named `id`.
    pub fn material(&self, id: MaterialId) -> &Material {
        &self.materials[id.0 as usize]
    }
    /// The pattern named `id`.
    pub fn pattern(&self, id: PatternId) -> &Pattern {
        &self.patterns[id.0 as usize]
    }

    /// How many [`Instance`]s there are; saturating, and found without visiting them: a few nested groups can make more
    /// than any memory holds.
    pub fn instance_count(&self) -> u64 {
        let counts = self.instance_counts();
        self.roots.iter().fold(0u64, |n, r| n.saturating_add(counts[r.0 as usize]))
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        // Most scenes begin with one; then nothing must be counted.
        let is_one = |id: &NodeId| matches!(self.node(*id).kind, NodeKind::Shape(_) | NodeKind::Light(_));
        !self.roots.iter().any(is_one) && self.instance_count() == 0
    }

    /// How many [`Instance`]s each node makes; saturating.
    fn instance_counts(&self) -> Vec<u64> {
        let mut counts = vec![0u64; self.nodes.len()];
        for (i, node) in self.nodes.iter().enumerate() {
            counts[i] = match &node.kind {
                NodeKind::Shape(_) | NodeKind::Light(_) => 1,
                NodeKind::Group(children) => children.iter().fold(0u64, |n, c| n.saturating_add(counts[c.0 as usize])),
                NodeKind::Transformed { child, .. } => counts[child.0 as usize],
            };
        }
        counts
    }

    /// Calls `visit` for every shape and light, in the order of the text, with its transforms composed.
    pub fn for_each_instance(&self, mut visit: impl FnMut(Instance)) {
        let _ = self.try_for_each_instance(|i| {
            visit(i);
            ControlFlow::<()>::Continue(())
        });
    }

    /// As [`for_each_instance`](Scene::for_each_instance), until `visit` breaks off.
    pub fn try_for_each_instance<B>(&self, visit: impl FnMut(Instance) -> ControlFlow<B>) -> ControlFlow<B> {
        self.try_for_each_instance_from(&Affine::IDENTITY, visit)
    }

    /// As [`try_for_each_instance`](Scene::try_for_each_instance), with the whole scene below a transform: of the camera, say.
    pub fn try_for_each_instance_from<B>(
        &self,
        world_from_scene: &Affine,
        mut visit: impl FnMut(Instance) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        // Groups of nothing can multiply to more than anyone waits for.
        let counts = self.instance_counts();
        let mut around = vec![(self.roots.iter(), *world_from_scene, MaterialId(0))];
        while let Some((nodes, world_from_object, material)) = around.last_mut() {
            let Some(node) = nodes.next() else {
                around.pop();
                continue;
            };
            let mut at = Instance { node: *node, world_from_object: *world_from_object, material: *material };
            while counts[at.node.0 as usize] > 0 {
                let node = self.node(at.node);
                // The innermost material wins, so a node's own replaces what came from around it.
                at.material = node.material.unwrap_or(at.material);
                match &node.kind {
                    NodeKind::Shape(_) | NodeKind::Light(_) => {
                        visit(at)?;
                        break;
                    }
                    NodeKind::Group(children) => {
                        around.push((children.iter(), at.world_from_object, at.material));
                        break;
                    }
                    NodeKind::Transformed { child, parent_from_child } => {
                        at.world_from_object = at.world_from_object.compose(parent_from_child);
                        at.node = *child;
                    }
                }
            }
        }
        ControlFlow::Continue(())
    }
}
