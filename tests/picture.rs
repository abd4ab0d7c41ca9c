//! The laws of whole pictures: on scenes made to break them, and on the examples.

mod support;

use glam::DVec3;
use rtdsl::lang::{Input, Request, evaluate};
use rtdsl::math::Affine;
use rtdsl::math::hash::KeyedHash;
use rtdsl::render::{Crop, Options, Search, World};
use rtdsl::scene::*;
use rtdsl::verify::picture::{Law, beside, picture, steady};
use std::path::Path;
use support::{Builder, v};

fn example(name: &str) -> Scene {
    let main = Input::File(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name).with_extension("scene"));
    let request = Request { main, set: Vec::new(), allow_read: Vec::new(), record_arguments: false };
    match evaluate(&request) {
        Ok(e) => e.scene,
        Err(_) => panic!("{name} is a valid scene"),
    }
}

fn names() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|f| f.extension().is_some_and(|e| e == "scene"))
        .map(|f| f.file_stem().unwrap().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

fn options(scene: &Scene, width: u32, height: u32) -> Options {
    let settings = Options::from_settings(&scene.settings);
    Options { width, height, aa: AntiAliasing::Off, threads: Some(2), ..settings }
}

/// Lights and panes of many colours in no order, so that every pixel adds and multiplies many numbers: in another order the last
/// bits differ. Some shapes are turned, stretched or lie in one place.
fn lamps_and_panes() -> Scene {
    let mut b = Builder::new();
    let r = |i: u64, k: u64| KeyedHash::new().with(i).with(k).unit() * 2.0 - 1.0;
    let at = |i: u64| v(r(i, 1), r(i, 2), r(i, 3));
    let white = b.gray(0.9);
    let wall = b.phong(white, 0.3, 0.2, 0.0);
    b.shape(Shape::Plane { through: v(0.3, -1.7, 0.2), normal: v(0.1, 1.0, 0.2) }, wall);
    for i in 0..14 {
        let c = [0, 1, 2].map(|k| 0.75 + 0.24 * r(i, 20 + k));
        let (color, transmit) = (b.color(0.1, 0.1 + 0.05 * c[0], 0.1), b.color(c[0], c[1], c[2]));
        let pane = b.phong(color, 0.1, 0.0, 0.0);
        b.scene.materials[pane.0 as usize].transmit = transmit;
        let turn = Affine::rotation_about(at(i + 50), 180.0 * r(i, 4));
        let stretch = Affine::scaling(if i % 3 == 0 { v(1.0, 0.5, 1.3) } else { DVec3::ONE });
        let place = Affine::translation(at(i) * 1.5).compose(&turn).compose(&stretch);
        let shape = match i % 5 {
            0 => Shape::Box { from: v(-0.5, -0.4, -0.3), to: v(0.5, 0.4, 0.3) },
            1 => Shape::Disc { at: DVec3::ZERO, normal: DVec3::Y, r: 0.9, hole: 0.1 },
            2 => Shape::Cone { from: DVec3::ZERO, to: v(0.0, 1.0, 0.0), r: 0.6, top: 0.0, caps: true },
            3 => Shape::Torus { at: DVec3::ZERO, r: 0.6, tube: 0.2, axis: DVec3::X },
            _ => Shape::Triangle {
                points: Box::new([v(-1.0, 0.0, 0.0), v(1.0, 0.0, -0.5), v(0.2, 1.0, 0.3)]),
                normals: None,
            },
        };
        b.placed(shape.clone(), pane, place);
        if i % 4 == 0 {
            b.placed(shape, wall, place); // two in one place: the opaque one is seen
            b.shape(Shape::Sphere { at: at(i + 90), r: 0.3 }, pane);
        }
        if i < 9 {
            let light = Light { at: at(i + 200) * 7.0, color: Color(c), power: 0.3 };
            let node = Node { kind: NodeKind::Light(light), material: None, name: None, ..b.scene.nodes[0].clone() };
            b.scene.nodes.push(node);
            b.scene.roots.push(NodeId(b.scene.nodes.len() as u32 - 1));
        }
    }
    b.camera(v(0.5, 1.25, 6.0), v(0.125, -0.25, 0.0), 40.0);
    b.scene.settings.max_depth = 6;
    b.scene
}

/// The largest move that every law is held to.
const FAR: f64 = (1u64 << 40) as f64;

/// What must not change a bit.
fn exact_laws() -> Vec<Law> {
    let mut laws = Vec::new();
    laws.extend([-400, -301, -63, -1, 1, 64, 399, 400].map(Law::PowerOfTwo));
    let moves = [v(1.0, 0.0, 0.0), v(1024.0, 0.0, -3.0), v(-FAR, 512.0, 65536.0), v(3.0, FAR, -FAR)];
    laws.extend(moves.map(Law::Moved));
    laws.extend([0, 1, 2].map(Law::Mirrored));
    laws.extend([1, 2].map(Law::Shuffled));
    laws.extend([Law::Instanced, Law::Treeless, Law::Threads(1), Law::Threads(3), Law::Tiles(7), Law::Tiles(1)]);
    laws.push(Law::Cropped(Crop { x: 11, y: 5, width: 31, height: 27 }));
    laws
}

/// The same where lengths must stay within what `f32` holds.
fn exact_laws_of_f32() -> Vec<Law> {
    let far = |law: &Law| matches!(law, Law::PowerOfTwo(k) if k.abs() > 20);
    exact_laws().into_iter().filter(|l| !far(l)).chain([-20, 20].map(Law::PowerOfTwo)).collect()
}

/// Fails with the first law that doesn't hold.
#[track_caller]
fn hold(name: &str, scene: &Scene, options: &Options, laws: &[Law]) {
    let before = picture(scene, options);
    for law in laws {
        let difference = law.difference(scene, options, &before).expect("a steady camera can be moved");
        assert!(difference.is_none(), "{name}, {:?}, {law:?}: {difference:?}", options.precision);
    }
}

#[test]
fn no_order_and_no_scale_shows() {
    let scene = lamps_and_panes();
    let o = options(&scene, 64, 48);
    hold("lamps and panes", &scene, &o, &exact_laws());
    // A picture holds `f32`: there the last bit of a sum shows where it was made in `f32`, too.
    let o = Options { precision: Precision::F32, ..o };
    hold("lamps and panes", &scene, &o, &exact_laws_of_f32());
}

#[test]
fn some_examples_obey() {
    for name in ["extremes", "glass", "knot", "sponge"] {
        let scene = steady(&example(name));
        let o = options(&scene, 48, 27);
        let laws = [Law::PowerOfTwo(-400), Law::PowerOfTwo(399), Law::Moved(v(3.0, FAR, -FAR)), Law::Mirrored(0)];
        hold(name, &scene, &o, &laws);
        let o = Options { precision: Precision::F32, ..o };
        let laws =
            [Law::PowerOfTwo(19), Law::Moved(v(-FAR, 7.0, FAR)), Law::Mirrored(1), Law::Treeless, Law::Shuffled(1)];
        hold(name, &scene, &o, &laws);
    }
}

#[test]
fn the_tree_finds_what_testing_everything_finds() {
    for (name, rays) in [("chess", 3_000), ("flake", 500), ("extremes", 10_000), ("figure", 3_000), ("window", 3_000)] {
        let scene = example(name);
        let search = Search::through(&World::build(&scene, &scene.cameras[0]), rays, 1);
        assert!(search.hits * 3 > search.rays && search.differing == 0, "{name}: {search:?}");
    }
    let scene = lamps_and_panes();
    let search = Search::through(&World::build(&scene, &scene.cameras[0]), 50_000, 2);
    assert!(search.hits * 3 > search.rays && search.differing == 0, "{search:?}");
}

/// A prism that was turned on its table: both have a face in one plane, and rays that leave the glass there see the table.
#[test]
fn other_scales_keep_the_picture() {
    for (name, scales) in [("glass", &[1e-6, 1e3][..]), ("extremes", &[1e-3][..])] {
        let scene = beside(&example(name));
        let o = options(&scene, 160, 90);
        let before = picture(&scene, &o);
        for &s in scales {
            let difference = Law::Scaled(s).difference(&scene, &o, &before).expect("any scale will do");
            assert!(difference.visible_share() <= 1e-4, "{name} times {s}: {difference:?}");
        }
    }
}

#[test]
#[ignore = "every law on every example takes minutes"]
fn every_example_obeys() {
    for name in names() {
        let scene = steady(&example(&name));
        let o = options(&scene, 96, 54);
        hold(&name, &scene, &o, &exact_laws());
        hold(&name, &scene, &Options { precision: Precision::F32, ..o.clone() }, &exact_laws_of_f32());
        let world = World::build(&scene, &scene.cameras[0]);
        let rays = 100_000_000 / world.primitives().len().max(100) as u64;
        let search = Search::through(&world, rays, 3);
        assert_eq!(search.differing, 0, "{name}: {search:?}");
        let scene = beside(&scene);
        let o = options(&scene, 320, 180);
        let before = picture(&scene, &o);
        for law in [1e-6, 1e-3, 1e3, 1e6, 1e9].map(Law::Scaled).into_iter().chain([0, 1, 2].map(Law::Turned)) {
            let difference = law.difference(&scene, &o, &before).expect("any camera can be scaled and turned");
            assert!(difference.visible_share() <= 1e-4, "{name}, {law:?}: {difference:?}");
        }
        println!("{name} obeys");
    }
}
