//! Certificates hold: light at random points of random regions lies within the form and the range, means within the sums; a bound
//! that is a little too narrow is noticed; and pictures keep their promise. Here are the scenes.

mod faint;
mod picture;
mod region;

use crate::math::Affine;
use crate::scene::*;
use glam::DVec3;
use std::sync::atomic::AtomicBool;

/// Nothing is cancelled.
static NEVER: AtomicBool = AtomicBool::new(false);

/// What the tracer's own rounding may change of a colour, whose certificate is about exact arithmetic: far more than it does, far less
/// than a code.
const ROUNDING: f64 = 1e-9;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// A scene under construction.
struct Builder(Scene);

/// What a material is made of: colour, then shares.
struct Look {
    color: PatternKind,
    specular: f64,
    reflect: f64,
    transmit: f64,
}

impl Builder {
    fn new() -> Builder {
        let mut scene = Scene::empty();
        scene.background = Color([0.45, 0.6, 0.8]);
        scene.ambient = Color::linear_gray(0.2);
        scene.cameras[0] = Camera {
            from: DVec3::ZERO,
            at: v(0.0, 0.0, -1.0),
            projection: Projection::Perspective { fov: 30.0 },
            ..Camera::default()
        };
        Builder(scene)
    }

    fn pattern(&mut self, kind: PatternKind) -> PatternId {
        self.0.patterns.push(Pattern { kind, span: None });
        PatternId(self.0.patterns.len() as u32 - 1)
    }

    fn gray(&mut self, x: f64) -> PatternId {
        self.pattern(PatternKind::Constant(Color::linear_gray(x)))
    }

    fn two(&mut self, a: [f64; 3], b: [f64; 3]) -> [PatternId; 2] {
        [a, b].map(|c| self.pattern(PatternKind::Constant(Color(c))))
    }

    fn material(&mut self, look: Look) -> MaterialId {
        let mut m = self.0.materials[0].clone();
        m.color = self.pattern(look.color);
        m.ambient = self.gray(1.0);
        m.diffuse = self.gray(0.8);
        m.shininess = self.gray(20.0);
        (m.specular, m.reflect, m.transmit) =
            (self.gray(look.specular), self.gray(look.reflect), self.gray(look.transmit));
        self.0.materials.push(m);
        MaterialId(self.0.materials.len() as u32 - 1)
    }

    fn node(&mut self, kind: NodeKind, material: Option<MaterialId>) -> NodeId {
        let place = crate::diag::Place::new(crate::diag::Span::new(crate::diag::FileId(0), 0..1));
        self.0.nodes.push(Node { kind, material, name: None, place });
        NodeId(self.0.nodes.len() as u32 - 1)
    }

    fn shape(&mut self, shape: Shape, look: Look) {
        let material = self.material(look);
        let node = self.node(NodeKind::Shape(shape), Some(material));
        self.0.roots.push(node);
    }

    fn turned(&mut self, shape: Shape, look: Look, place: Affine) {
        let material = self.material(look);
        let child = self.node(NodeKind::Shape(shape), Some(material));
        let node = self.node(NodeKind::Transformed { child, parent_from_child: Box::new(place) }, None);
        self.0.roots.push(node);
    }

    /// The material made last.
    fn last(&mut self) -> &mut Material {
        let last = self.0.materials.len() - 1;
        &mut self.0.materials[last]
    }

    fn light(&mut self, at: DVec3, color: [f64; 3]) {
        let node = self.node(NodeKind::Light(Light { at, color: Color(color), power: 1.0 }), None);
        self.0.roots.push(node);
    }
}

fn plain(c: [f64; 3]) -> Look {
    Look { color: PatternKind::Constant(Color(c)), specular: 0.4, reflect: 0.0, transmit: 0.0 }
}

/// Every shape that certificates cover, some turned or stretched, on a checkered floor between a mirror and panes, under two lights.
pub(in crate::render) fn every_shape() -> Scene {
    let mut b = Builder::new();
    let [x, y] = b.two([0.9, 0.9, 0.85], [0.15, 0.35, 0.2]);
    let floor = PatternKind::Checker { a: x, b: y, size: 10.0 };
    b.shape(
        Shape::Plane { through: v(0.0, -15.0, 0.0), normal: DVec3::Y },
        Look { color: floor, specular: 0.0, reflect: 0.1, transmit: 0.0 },
    );
    b.shape(Shape::Sphere { at: v(0.0, 2.0, -120.0), r: 13.0 }, Look { reflect: 0.7, ..plain([0.1, 0.1, 0.3]) });
    let [x, y] = b.two([0.9, 0.5, 0.1], [0.2, 0.2, 0.7]);
    let stripes = PatternKind::Stripes { a: x, b: y, axis: 1, size: 2.0 };
    let turn = |degrees: f64| Affine::rotation_about(v(0.3, 1.0, 0.2), degrees);
    let at = |x: f64, y: f64, z: f64| Affine::translation(v(x, y, z));
    let stretch = Affine::scaling(v(1.0, 0.6, 1.3));
    b.turned(
        Shape::Sphere { at: DVec3::ZERO, r: 8.0 },
        Look { color: stripes, ..plain([0.0; 3]) },
        at(-24.0, -4.0, -100.0).compose(&turn(20.0)).compose(&stretch),
    );
    b.turned(
        Shape::Box { from: v(-5.0, -4.0, -3.0), to: v(5.0, 4.0, 3.0) },
        plain([0.8, 0.3, 0.2]),
        at(22.0, -8.0, -90.0).compose(&turn(35.0)),
    );
    b.shape(
        Shape::Cylinder { from: v(8.0, -15.0, -75.0), to: v(8.0, -5.0, -75.0), r: 3.5, caps: false },
        Look { transmit: 0.7, ..plain([0.1, 0.25, 0.1]) },
    );
    b.shape(
        Shape::Cylinder { from: v(-16.0, -12.0, -72.0), to: v(-9.0, -10.0, -70.0), r: 2.0, caps: true },
        plain([0.3, 0.5, 0.8]),
    );
    b.shape(
        Shape::Cone { from: v(-2.0, -15.0, -70.0), to: v(-2.0, -7.0, -70.0), r: 3.0, top: 0.0, caps: true },
        plain([0.8, 0.2, 0.2]),
    );
    let points = [v(12.0, -15.0, -60.0), v(18.0, -15.0, -61.0), v(15.0, -15.0, -66.0), v(15.0, -9.0, -62.0)];
    b.shape(Shape::Tetrahedron { points: Box::new(points) }, plain([0.9, 0.8, 0.2]));
    b.shape(
        Shape::Disc { at: v(0.0, 20.0, -110.0), normal: v(0.2, -1.0, 0.9), r: 9.0, hole: 3.0 },
        Look { transmit: 0.3, ..plain([0.4, 0.7, 0.5]) },
    );
    b.light(v(30.0, 45.0, 20.0), [0.7, 0.7, 0.6]);
    b.light(v(-40.0, 30.0, -20.0), [0.2, 0.2, 0.4]);
    b.0
}

/// Rings, which aren't followed, over a floor: what passes them by is known.
fn rings() -> Scene {
    let mut b = Builder::new();
    let [x, y] = b.two([0.9, 0.9, 0.85], [0.15, 0.35, 0.2]);
    b.shape(
        Shape::Plane { through: v(0.0, -3.0, 0.0), normal: DVec3::Y },
        Look { color: PatternKind::Checker { a: x, b: y, size: 4.0 }, specular: 0.0, reflect: 0.3, transmit: 0.0 },
    );
    let ring = |at: DVec3, axis: DVec3, r: f64| Shape::Torus { at, r, tube: 0.4 * r, axis };
    b.shape(ring(v(0.0, 0.0, -20.0), v(0.1, 0.2, 1.0), 2.0), plain([0.8, 0.3, 0.2]));
    b.shape(ring(v(4.0, -2.0, -25.0), DVec3::Y, 1.5), plain([0.2, 0.3, 0.8]));
    let turn = Affine::translation(v(-4.0, -1.0, -22.0)).compose(&Affine::scaling(v(1.0, 0.5, 1.7)));
    b.turned(ring(DVec3::ZERO, v(1.0, 1.0, 0.0), 1.0), plain([0.5; 3]), turn);
    b.shape(Shape::Sphere { at: v(0.5, 0.2, -16.0), r: 0.8 }, plain([0.9, 0.8, 0.1]));
    b.light(v(30.0, 45.0, 20.0), [0.7, 0.7, 0.6]);
    b.0
}

/// What is known by range alone: bumps, shares that patterns decide, noise, glass, before a wall and over a floor of them.
fn by_range() -> Scene {
    let mut b = Builder::new();
    let [x, y] = b.two([0.9, 0.9, 0.85], [0.15, 0.35, 0.2]);
    let noise = |a, b, seed| PatternKind::Noise { a, b, octaves: 3, seed };
    let look = |color| Look { color, specular: 0.2, reflect: 0.0, transmit: 0.0 };
    let (none, some) = (b.gray(0.0), b.gray(0.5));
    let share = b.pattern(noise(none, some, 5));
    let checks = b.pattern(PatternKind::Checker { a: some, b: none, size: 0.7 });
    let heights = b.pattern(PatternKind::Brick { mortar: none, brick: some, size: [1.6, 0.7], gap: 0.1 });
    let bumps = b.pattern(noise(none, some, 6));

    b.shape(Shape::Plane { through: v(0.0, -3.0, 0.0), normal: DVec3::Y }, look(noise(x, y, 1)));
    b.last().reflect = share;
    b.shape(Shape::Plane { through: v(0.0, 0.0, -40.0), normal: DVec3::Z }, look(noise(y, x, 2)));
    b.last().bump = Some(heights);
    b.shape(Shape::Sphere { at: v(-3.0, -1.0, -22.0), r: 2.0 }, look(PatternKind::Constant(Color([0.7, 0.4, 0.2]))));
    (b.last().diffuse, b.last().specular, b.last().reflect) = (share, checks, checks);
    b.shape(
        Shape::Sphere { at: v(1.0, -0.5, -19.0), r: 1.5 },
        Look { transmit: 0.9, ..look(PatternKind::Constant(Color([0.0; 3]))) },
    );
    b.last().ior = Some(1.5);
    b.shape(
        Shape::Sphere { at: v(4.5, -1.0, -24.0), r: 2.0 },
        Look { reflect: 0.3, ..look(PatternKind::Cells { a: x, b: y, seed: 3 }) },
    );
    (b.last().bump, b.last().shininess) = (Some(bumps), share);
    b.shape(
        Shape::Disc { at: v(-1.0, 2.5, -18.0), normal: v(0.3, 0.2, 1.0), r: 1.8, hole: 0.0 },
        look(PatternKind::Constant(Color([0.3, 0.5, 0.4]))),
    );
    b.last().transmit = checks;
    b.light(v(30.0, 45.0, 20.0), [0.7, 0.7, 0.6]);
    b.light(v(-20.0, 10.0, 5.0), [0.2, 0.2, 0.4]);
    b.0
}

/// Glass of every closed shape over a checkered floor, before a ball.
fn glasses() -> Scene {
    let mut b = Builder::new();
    let [x, y] = b.two([0.9, 0.9, 0.85], [0.15, 0.35, 0.2]);
    b.shape(
        Shape::Plane { through: v(0.0, -3.0, 0.0), normal: DVec3::Y },
        Look { color: PatternKind::Checker { a: x, b: y, size: 3.0 }, ..plain([0.0; 3]) },
    );
    b.shape(Shape::Sphere { at: v(0.0, 1.0, -40.0), r: 4.0 }, plain([0.8, 0.3, 0.2]));
    let shapes = [
        Shape::Sphere { at: v(0.0, -0.5, -20.0), r: 2.0 },
        Shape::Box { from: v(3.0, -2.9, -22.0), to: v(5.5, 0.5, -19.0) },
        Shape::Cylinder { from: v(-4.0, -2.9, -20.0), to: v(-3.6, 1.0, -21.0), r: 1.2, caps: true },
        Shape::Disc { at: v(2.2, 2.5, -17.0), normal: v(0.3, 0.2, 1.0), r: 1.0, hole: 0.0 },
    ];
    for shape in shapes {
        b.shape(shape, Look { specular: 0.5, reflect: 0.02, transmit: 0.95, ..plain([0.0; 3]) });
        b.last().ior = Some(1.5);
    }
    b.light(v(30.0, 45.0, 20.0), [0.7, 0.7, 0.6]);
    b.0
}
