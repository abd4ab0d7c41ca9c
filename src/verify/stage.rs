//! Small scenes made in code, seen by one ray: what closed forms are compared with.

use crate::diag::{FileId, Place, Span};
use crate::render::{Options, World, radiance};
use crate::scene::{
    Camera, Color, Light, Material, MaterialId, Node, NodeId, NodeKind, Pattern, PatternId, Scene, Shape,
};
use glam::DVec3;

/// A scene under construction, black at first. Its picture is one pixel; its camera stands at the origin and looks along -z.
pub struct Stage {
    /// The scene.
    pub scene: Scene,
}

/// A white surface, as gray values of its slots.
#[derive(Clone, Copy, Debug, Default)]
pub struct Surface {
    /// Share of ambient light that is given back.
    pub ambient: f64,
    /// Share of direct light that is scattered.
    pub diffuse: f64,
    /// Weight of the mirror image.
    pub reflect: f64,
    /// Weight of what lies behind.
    pub transmit: f64,
    /// Refractive index of the inside.
    pub ior: Option<f64>,
}

impl Stage {
    /// Nothing but the camera.
    pub fn new() -> Stage {
        let mut scene = Scene::empty();
        (scene.settings.width, scene.settings.height) = (1, 1);
        (scene.background, scene.ambient) = (Color::BLACK, Color::BLACK);
        scene.cameras = vec![Camera { from: DVec3::ZERO, at: -DVec3::Z, ..Camera::default() }];
        Stage { scene }
    }

    fn gray(&mut self, x: f64) -> PatternId {
        self.scene.patterns.push(Pattern::constant(Color::linear_gray(x)));
        PatternId(self.scene.patterns.len() as u32 - 1)
    }

    fn node(&mut self, kind: NodeKind, material: Option<MaterialId>) {
        let place = Place::new(Span::new(FileId(0), 0..0));
        self.scene.roots.push(NodeId(self.scene.nodes.len() as u32));
        self.scene.nodes.push(Node { kind, material, name: None, place });
    }

    /// Puts a shape there.
    pub fn shape(&mut self, shape: Shape, surface: Surface) {
        let material = Material {
            color: self.gray(1.0),
            ambient: self.gray(surface.ambient),
            diffuse: self.gray(surface.diffuse),
            specular: self.gray(0.0),
            shininess: self.gray(1.0),
            reflect: self.gray(surface.reflect),
            transmit: self.gray(surface.transmit),
            ior: surface.ior,
            bump: None,
            place: None,
        };
        self.scene.materials.push(material);
        let material = MaterialId(self.scene.materials.len() as u32 - 1);
        self.node(NodeKind::Shape(shape), Some(material));
    }

    /// Puts a white light there.
    pub fn light(&mut self, at: DVec3) {
        self.node(NodeKind::Light(Light { at, color: Color::WHITE, power: 1.0 }), None);
    }

    /// What the ray through the middle of the picture sees, by up to `depth` reflections and transmissions.
    pub fn seen(&self, depth: u32) -> f64 {
        let options = Options { max_depth: depth, ..Options::from_settings(&self.scene.settings) };
        let world = World::build(&self.scene, &self.scene.cameras[0]);
        radiance(&world, &options, 0, 0)[0]
    }
}
