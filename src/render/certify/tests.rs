//! Certificates hold: light at random points of random regions lies within the form and the range, means within the sums; and
//! a bound that is a little too narrow is noticed.

use super::super::dispatch::sampler;
use super::bound::Bound;
use super::{Certifier, Control, Pixel, Status, Summary, Target, certify, code, refine};
use crate::math::hash::KeyedHash;
use crate::math::{Affine, Form};
use crate::render::bounds::smaller;
use crate::render::{Crop, Options, Progress, Silent, World};
use crate::scene::*;
use glam::DVec3;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

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

    fn light(&mut self, at: DVec3, color: [f64; 3]) {
        let node = self.node(NodeKind::Light(Light { at, color: Color(color), power: 1.0 }), None);
        self.0.roots.push(node);
    }
}

fn plain(c: [f64; 3]) -> Look {
    Look { color: PatternKind::Constant(Color(c)), specular: 0.4, reflect: 0.0, transmit: 0.0 }
}

/// Every shape that certificates cover, some turned or stretched, on a checkered floor between a mirror and panes, under two lights.
fn every_shape() -> Scene {
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

/// How certificates are weakened to show that tests notice.
#[derive(Clone, Copy, PartialEq)]
enum Weakened {
    /// Not at all.
    No,
    /// What the form may miss.
    Form,
    /// The values' range.
    Range,
    /// The integral.
    Sum,
}

fn weaken(b: Bound, how: Weakened) -> Bound {
    let narrow = |[lo, hi]: [f64; 2], by: f64| {
        let (m, h) = (0.5 * (lo + hi), 0.5 * (hi - lo) * by);
        [m - h, m + h]
    };
    match how {
        Weakened::No => b,
        Weakened::Form => Bound { form: b.form.map(|f| f.map(|f| Form { r: 0.3 * f.r, ..f })), ..b },
        Weakened::Range => Bound { range: b.range.map(|r| narrow(r, 0.8)), ..b },
        Weakened::Sum => Bound { sum: b.sum.map(|s| narrow(s, 0.2)), ..b },
    }
}

/// What the tracer's own rounding may change of a colour, whose certificate is about exact arithmetic: far more than it does, far less
/// than a code.
const ROUNDING: f64 = 1e-9;

/// What was found in random regions.
#[derive(Debug, Default)]
struct Found {
    regions: u64,
    /// With a form.
    formed: u64,
    points: u64,
    /// Points outside of form or range.
    outside: u64,
    /// Means outside of the integral's bounds, by more than chance.
    means: u64,
}

fn studied(scene: &Scene, (width, height): (u32, u32), regions: std::ops::Range<u64>, how: Weakened) -> Found {
    const SIDE: u64 = 12;
    let world = World::build(scene, &scene.cameras[0]);
    let options = Options { width, height, ..Options::from_settings(&scene.settings) };
    let certifier = Certifier::new(&world, &options);
    let mut sampler = sampler(&world, &options, &NEVER);
    let mut found = Found::default();
    for i in regions {
        let random = |k: u64| KeyedHash::new().with(i).with(k).unit();
        let size = [0.02, 0.1, 0.5, 1.0, 4.0][(random(0) * 5.0) as usize] * (0.5 + random(1));
        let (l, t) = (random(2) * (width as f64 - size), random(3) * (height as f64 - size));
        let rect = [l, t, l + size, t + size * (0.5 + 0.5 * random(4))];
        let bound = weaken(certifier.region(rect), how);
        found.regions += 1;
        found.formed += bound.form.is_some() as u64;
        let place = |j: u64| {
            let unit = |k: u64, axis: u64| (k as f64 + random(100 + 2 * j + axis)) / SIDE as f64;
            [unit(j % SIDE, 0), unit(j / SIDE, 1)]
        };
        let points: Vec<[f64; 2]> = (0..SIDE * SIDE)
            .map(|j| {
                let [u, w] = place(j);
                [rect[0] + u * (rect[2] - rect[0]), rect[1] + w * (rect[3] - rect[1])]
            })
            .collect();
        let (mut sum, mut squares) = ([0.0; 3], [0.0; 3]);
        sampler.trace(rect, &points, &mut |j, light| {
            found.points += 1;
            let [u, w] = place(j as u64);
            let (xi, eta) = (2.0 * u - 1.0, 2.0 * w - 1.0);
            for c in 0..3 {
                sum[c] += light[c];
                squares[c] += light[c] * light[c];
                let [lo, hi] = bound.range[c];
                let in_range = lo - ROUNDING <= light[c] && light[c] <= hi + ROUNDING;
                let in_form = bound.form.is_none_or(|f| {
                    !f[c].is_known() || (light[c] - (f[c].c + f[c].x * xi + f[c].y * eta)).abs() <= f[c].r + ROUNDING
                });
                found.outside += !(in_range && in_form) as u64;
            }
        });
        let n = (SIDE * SIDE) as f64;
        let wrong = (0..3).any(|c| {
            let (mean, variance) = (sum[c] / n, (squares[c] - sum[c] * sum[c] / n) / n);
            // Strata are no worse than independent points; six of their deviations, and what one point may hide.
            let seen = bound.range[c][1] - bound.range[c][0];
            let chance = 6.0 * (if variance > 0.0 { variance } else { 0.0 } / n).sqrt() + smaller(seen, 1.0) / n;
            mean + chance + ROUNDING < 0.25 * bound.sum[c][0] || mean - chance - ROUNDING > 0.25 * bound.sum[c][1]
        });
        found.means += wrong as u64;
    }
    found
}

#[test]
fn light_lies_within_certificates() {
    let found = studied(&every_shape(), (320, 180), 0..1_000, Weakened::No);
    assert_eq!((found.outside, found.means), (0, 0), "{found:?}");
    assert!(found.formed * 2 > found.regions, "{found:?}");
}

#[test]
#[ignore = "minutes"]
fn light_lies_within_many_certificates() {
    for size in [(320, 180), (64, 36), (1280, 720)] {
        let found = studied(&every_shape(), size, 0..200_000, Weakened::No);
        assert_eq!((found.outside, found.means), (0, 0), "{found:?}");
    }
}

#[test]
fn weakened_certificates_are_noticed() {
    let scene = every_shape();
    let wrong = |how| {
        let found = studied(&scene, (320, 180), 0..500, how);
        (found.outside, found.means)
    };
    assert!(wrong(Weakened::Form).0 > 0, "what the form may miss");
    assert!(wrong(Weakened::Range).0 > 0, "the range");
    assert!(wrong(Weakened::Sum).1 > 0, "the integral");
}

/// Nothing is cancelled.
static NEVER: AtomicBool = AtomicBool::new(false);

/// Pixels of a picture that keep their promise, against the mean of 64×64 rays: proved ones always.
fn kept(scene: &Scene, (width, height): (u32, u32), target: &Target) -> (Summary, u64) {
    let world = World::build(scene, &scene.cameras[0]);
    let options = Options { width, height, ..Options::from_settings(&scene.settings) };
    let pixels = certify(&world, &options, target);
    let mut sampler = sampler(&world, &options, &NEVER);
    let mut broken = 0;
    for (i, pixel) in pixels.iter().enumerate().filter(|(i, p)| p.status != Status::Proved || i % 23 == 0) {
        let (x, y) = ((i as u32 % width) as f64, (i as u32 / width) as f64);
        let points: Vec<[f64; 2]> = (0..4096u64)
            .map(|j| {
                let unit =
                    |axis: u64, k: u64| (k as f64 + KeyedHash::new().with(i as u64).with(j).with(axis).unit()) / 64.0;
                [x + unit(0, j % 64), y + unit(1, j / 64)]
            })
            .collect();
        let (mut sum, mut squares) = ([0.0; 3], [0.0; 3]);
        sampler.trace([x, y, x + 1.0, y + 1.0], &points, &mut |_, light| {
            for c in 0..3 {
                sum[c] += light[c];
                squares[c] += light[c] * light[c];
            }
        });
        let wrong = (0..3).any(|c| {
            let (mean, variance) = (sum[c] / 4096.0, (squares[c] - sum[c] * sum[c] / 4096.0) / 4096.0);
            let chance = 5.0 * (if variance > 0.0 { variance } else { 0.0 } / 4096.0).sqrt() + ROUNDING;
            let written = code(pixel.value[c]).round();
            let (lo, hi) = (code(mean - chance), code(mean + chance));
            written - hi > target.codes || lo - written > target.codes
        });
        broken += wrong as u64;
    }
    (Summary::of(&pixels, target.codes), broken)
}

#[test]
fn pictures_keep_their_promise() {
    let scene = every_shape();
    let (sum, broken) = kept(&scene, (64, 36), &Target::new(4.0));
    assert_eq!(broken, 0);
    assert!(sum.proved > 1_900 && sum.open == 0, "{sum:?}");
    // The same from samples alone: none can be sure.
    let sampled = Target { certificates: false, samples: 4096, ..Target::new(8.0) };
    let (sum, broken) = kept(&scene, (32, 18), &sampled);
    assert_eq!((sum.proved + sum.bounded, broken), (0, 0));
    assert!(sum.estimated > 400, "{sum:?}");
}

#[test]
fn the_same_pixels_for_any_number_of_threads_and_in_a_part() {
    let scene = every_shape();
    let world = World::build(&scene, &scene.cameras[0]);
    let options = Options { width: 60, height: 34, ..Options::from_settings(&scene.settings) };
    let target = Target { samples: 256, evaluations: 32, ..Target::new(4.0) };
    let on = |threads| certify(&world, &Options { threads: Some(threads), ..options.clone() }, &target);
    let all = on(1);
    assert!(all == on(3));
    let part = Crop { x: 13, y: 9, width: 21, height: 17 };
    let some = certify(&world, &Options { crop: Some(part), ..options.clone() }, &target);
    for (i, pixel) in some.iter().enumerate() {
        let (x, y) = (i % 21 + 13, i / 21 + 9);
        // Who is charged for a block's evaluation isn't part of the picture.
        assert_eq!(pixel.value, all[y * 60 + x].value);
    }
}

#[test]
fn what_isnt_covered_is_unknown_within_its_range() {
    let mut b = Builder::new();
    b.shape(Shape::Torus { at: v(0.0, 0.0, -20.0), r: 2.0, tube: 0.5, axis: DVec3::Z }, plain([0.5; 3]));
    b.light(v(3.0, 4.0, 5.0), [0.5; 3]);
    let world = World::build(&b.0, &b.0.cameras[0]);
    let options = Options { width: 32, height: 32, ..Options::from_settings(&b.0.settings) };
    let certifier = Certifier::new(&world, &options);
    let bound = certifier.region([4.0, 4.0, 28.0, 28.0]);
    let ceiling = certifier.ceiling(options.max_depth);
    assert!((0..3).all(|c| bound.range[c][0] <= 0.0 + 1e-9 && bound.range[c][1] <= ceiling[c][1] + 1e-9));
    let pixels = certify(&world, &options, &Target::new(8.0));
    assert!(pixels.iter().any(|p| p.status == Status::Proved), "beside it");
    assert!(pixels.iter().any(|p| p.status != Status::Proved), "on it");
}

/// Writes down what it is told, and cancels after some blocks.
struct Witness {
    told: Mutex<Vec<Option<[f32; 3]>>>,
    width: u32,
    left: Mutex<usize>,
    cancel: AtomicBool,
}

impl Witness {
    fn new((width, height): (u32, u32), blocks: usize) -> Witness {
        let told = Mutex::new(vec![None; (width * height) as usize]);
        Witness { told, width, left: Mutex::new(blocks), cancel: AtomicBool::new(false) }
    }
}

impl Progress for Witness {
    fn finished(&self, tile: Crop, rows: &[&mut [[f32; 3]]]) {
        let mut told = self.told.lock().unwrap();
        for (row, y) in rows.iter().zip(tile.y..tile.y + tile.height) {
            for (light, x) in row.iter().zip(tile.x..tile.x + tile.width) {
                let before = told[(y * self.width + x) as usize].replace(*light);
                assert_eq!(before, None, "told twice of ({x}, {y})");
            }
        }
        let mut left = self.left.lock().unwrap();
        *left -= 1;
        if *left == 0 {
            self.cancel.store(true, Relaxed);
        }
    }
}

#[test]
fn what_is_cancelled_can_be_gone_on_with() {
    let scene = every_shape();
    let world = World::build(&scene, &scene.cameras[0]);
    let size = (60, 34);
    let options =
        Options { width: size.0, height: size.1, threads: Some(2), ..Options::from_settings(&scene.settings) };
    let target = Target { samples: 256, evaluations: 32, ..Target::new(8.0) };
    let mut pixels = vec![Pixel::unknown(); (size.0 * size.1) as usize];
    let mut refined = |witness: &Witness| {
        let control = Control { progress: witness, cancel: &witness.cancel };
        (refine(&world, &options, &target, &mut pixels, control), pixels.clone())
    };
    let all = certify(&world, &options, &target);
    let first = Witness::new(size, 7);
    let (whole, part) = refined(&first);
    assert!(!whole && part.contains(&Pixel::unknown()));
    for ((told, found), wanted) in first.told.lock().unwrap().iter().zip(&part).zip(&all) {
        assert!(told.is_none_or(|told| told == wanted.value.map(|x| x as f32)));
        assert!(*found == Pixel::unknown() || found.value == wanted.value);
    }
    let second = Witness::new(size, usize::MAX);
    let (whole, rest) = refined(&second);
    assert!(whole && second.told.lock().unwrap().iter().all(|told| told.is_some()));
    assert!(rest.iter().zip(&all).all(|(a, b)| a.value == b.value && a.codes == b.codes && a.status == b.status));
}

#[test]
fn what_keeps_its_error_is_left_alone() {
    let scene = every_shape();
    let world = World::build(&scene, &scene.cameras[0]);
    let options = Options { width: 40, height: 24, ..Options::from_settings(&scene.settings) };
    let rough = Target { samples: 2048, ..Target::new(16.0) };
    let before = certify(&world, &options, &rough);
    let mut after = before.clone();
    let fine = Target { codes: 3.0, samples: 64, evaluations: 8, ..rough };
    let control = Control { progress: &Silent, cancel: &NEVER };
    assert!(refine(&world, &options, &fine, &mut after, control));
    let mut fell_short = 0;
    for (a, b) in before.iter().zip(&after) {
        if a.keeps(3.0) {
            assert_eq!(a, b);
        } else if !b.keeps(3.0) {
            fell_short += 1;
            assert!(b.value == a.value && b.status == a.status && b.evaluations > a.evaluations, "{a:?} {b:?}");
        }
    }
    assert!(fell_short > 0, "a budget that is too small for some");
    assert!(before.iter().filter(|p| !p.keeps(3.0)).count() > fell_short, "but not for all");
}
