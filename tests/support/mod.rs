//! Scenes made in code, for tests of the renderer alone.
#![allow(dead_code)] // each test binary uses its own part of this

use glam::DVec3;
use rtdsl::diag::{FileId, Place, Span};
use rtdsl::math::Affine;
use rtdsl::scene::*;

/// Builds scenes as the language would.
pub struct Builder {
    pub scene: Scene,
}

/// A vector.
pub fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

impl Builder {
    pub fn new() -> Self {
        Builder { scene: Scene::empty() }
    }
    pub fn pattern(&mut self, kind: PatternKind) -> PatternId {
        self.scene.patterns.push(Pattern { kind, span: None });
        PatternId(self.scene.patterns.len() as u32 - 1)
    }
    pub fn color(&mut self, r: f64, g: f64, b: f64) -> PatternId {
        self.pattern(PatternKind::Constant(Color([r, g, b])))
    }
    pub fn gray(&mut self, x: f64) -> PatternId {
        self.color(x, x, x)
    }
    /// Phong as in the seed scene, with the default ambient.
    pub fn phong(&mut self, color: PatternId, specular: f64, reflect: f64, transmit: f64) -> MaterialId {
        let m = Material {
            color,
            ambient: self.gray(1.0),
            diffuse: self.gray(0.8),
            specular: self.gray(specular),
            shininess: self.gray(20.0),
            reflect: self.gray(reflect),
            transmit: self.gray(transmit),
            ior: None,
            bump: None,
            place: None,
        };
        self.material(m)
    }
    pub fn material(&mut self, m: Material) -> MaterialId {
        self.scene.materials.push(m);
        MaterialId(self.scene.materials.len() as u32 - 1)
    }
    fn node(&mut self, kind: NodeKind, material: Option<MaterialId>) -> NodeId {
        let n = self.scene.nodes.len();
        let place = Place::new(Span::new(FileId(0), n..n + 1));
        self.scene.nodes.push(Node { kind, material, name: None, place });
        NodeId(n as u32)
    }
    pub fn shape(&mut self, shape: Shape, material: MaterialId) -> NodeId {
        let id = self.node(NodeKind::Shape(shape), Some(material));
        self.scene.roots.push(id);
        id
    }
    /// A shape that stands somewhere else than where it was made.
    pub fn placed(&mut self, shape: Shape, material: MaterialId, map: Affine) {
        let child = self.node(NodeKind::Shape(shape), Some(material));
        let id = self.node(NodeKind::Transformed { child, parent_from_child: Box::new(map) }, None);
        self.scene.roots.push(id);
    }
    pub fn light(&mut self, at: DVec3) {
        let light = Light { at, color: Color::WHITE, power: 1.0 };
        let id = self.node(NodeKind::Light(light), None);
        self.scene.roots.push(id);
    }
    pub fn camera(&mut self, from: DVec3, at: DVec3, fov: f64) {
        let projection = Projection::Perspective { fov };
        self.scene.cameras = vec![Camera { from, at, projection, ..Camera::default() }];
    }
}

/// The seed scene, every length times `s` and moved by `by`.
pub fn seed(s: f64, by: DVec3) -> Scene {
    let mut b = Builder::new();
    let at = |x: f64, y: f64, z: f64| v(x, y, z) * s + by;
    b.camera(by, by - DVec3::Z * s, 28.07248693585296);
    b.scene.background = Color([0.45, 0.6, 0.8]);
    b.scene.ambient = Color([0.2; 3]);
    b.light(at(30.0, 45.0, 20.0));

    let (light, dark) = (b.color(0.9, 0.9, 0.85), b.color(0.15, 0.35, 0.2));
    let checker = b.pattern(PatternKind::Checker { a: light, b: dark, size: 10.0 * s });
    let checker = b.pattern(PatternKind::Transformed { child: checker, parent_from_child: Affine::translation(by) });
    let floor = b.phong(checker, 0.0, 0.0, 0.0);
    b.shape(Shape::Plane { through: at(0.0, -15.0, 0.0), normal: DVec3::Y }, floor);

    let c = b.color(0.1, 0.1, 0.3);
    let m = b.phong(c, 0.5, 0.7, 0.0);
    b.shape(Shape::Sphere { at: at(0.0, 0.0, -115.0), r: 13.0 * s }, m);

    b.scene.images.push(earth());
    let image = PatternKind::Image { image: ImageId(0), mapping: Mapping::Normal, filter: Filter::Nearest };
    let c = b.pattern(image);
    let m = b.phong(c, 0.5, 0.0, 0.0);
    b.shape(Shape::Sphere { at: at(-23.0, -5.0, -100.0), r: 9.0 * s }, m);

    let (orange, blue) = (b.color(0.9, 0.5, 0.1), b.color(0.2, 0.2, 0.7));
    let stripes = b.pattern(PatternKind::Stripes { a: orange, b: blue, axis: 1, size: s });
    let stripes = b.pattern(PatternKind::Transformed { child: stripes, parent_from_child: Affine::translation(by) });
    let m = b.phong(stripes, 0.5, 0.0, 0.0);
    b.shape(Shape::Sphere { at: at(23.0, -6.0, -95.0), r: 9.0 * s }, m);

    let c = b.color(0.1, 0.25, 0.1);
    let m = b.phong(c, 0.5, 0.0, 0.7);
    let (from, to) = (at(10.0, -15.0, -75.0), at(10.0, -5.0, -75.0));
    b.shape(Shape::Cylinder { from, to, r: 3.5 * s, caps: false }, m);

    let c = b.color(0.8, 0.2, 0.2);
    let m = b.phong(c, 0.5, 0.0, 0.0);
    let (from, to) = (at(-12.0, -15.0, -78.0), at(-12.0, -5.0, -78.0));
    b.shape(Shape::Cone { from, to, r: 4.0 * s, top: 0.0, caps: true }, m);

    let c = b.color(0.9, 0.8, 0.2);
    let m = b.phong(c, 0.5, 0.0, 0.0);
    let points = [at(-3.0, -15.0, -66.0), at(4.0, -15.0, -68.0), at(0.5, -15.0, -74.0), at(0.7, -8.0, -69.0)];
    b.shape(Shape::Tetrahedron { points: Box::new(points) }, m);

    b.scene.settings.max_depth = 5;
    b.scene
}

/// The picture of the earth that the examples use.
pub fn earth() -> Image {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/assets/earth.png");
    let rgb = ::image::open(path).expect("the examples' picture").into_rgb8();
    let (width, height) = rgb.dimensions();
    Image { path: path.into(), digest: [0; 32], width, height, texels: Texels::Colors(rgb.into_raw()).into() }
}
