//! Laws that every picture obeys, whatever it shows: what must not change a bit, and what must agree with arithmetic.

mod support;

use glam::DVec3;
use rtdsl::film::Film;
use rtdsl::math::Affine;
use rtdsl::render::{Crop, Options, Silent, World, probe, render};
use rtdsl::scene::*;
use std::sync::atomic::AtomicBool;
use support::{Builder, seed, v};

fn options(scene: &Scene, width: u32, height: u32) -> Options {
    Options { width, height, threads: Some(2), ..Options::from_settings(&scene.settings) }
}

fn picture(scene: &Scene, options: &Options) -> Film {
    let world = World::build(scene, &scene.cameras[0]);
    let film = render(&world, options, &Silent, &AtomicBool::new(false)).expect("not cancelled").film;
    assert!(film.pixels.as_flattened().iter().all(|x| x.is_finite()), "no NaN and no infinity in a picture");
    film
}

fn small(scene: &Scene) -> Film {
    picture(scene, &options(scene, 160, 90))
}

/// Fails with the first pixels that differ, rather than with both pictures.
#[track_caller]
fn assert_same(a: &Film, b: &Film, what: &str) {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let differing: Vec<usize> = (0..a.pixels.len()).filter(|&i| a.pixels[i] != b.pixels[i]).collect();
    let show = |&i: &usize| {
        let (x, y) = (i as u32 % a.width, i as u32 / a.width);
        format!("({x}, {y}): {:?} and {:?}", a.pixels[i], b.pixels[i])
    };
    let first: Vec<String> = differing.iter().take(4).map(show).collect();
    assert!(differing.is_empty(), "{what}: {} pixels differ: {}", differing.len(), first.join("; "));
}

/// Share of pixels that differ by more than `codes` of 255 in any channel, after the transfer curve.
fn share_that_differs(a: &Film, b: &Film, codes: f64) -> f64 {
    let code = |x: f32| rtdsl::scene::color::encode_srgb((x as f64).clamp(0.0, 1.0)) * 255.0;
    let far = |p: &[f32; 3], q: &[f32; 3]| p.iter().zip(q).any(|(x, y)| (code(*x) - code(*y)).abs() > codes);
    let n = a.pixels.iter().zip(&b.pixels).filter(|(p, q)| far(p, q)).count();
    n as f64 / a.pixels.len() as f64
}

/// A scene with something of everything: glass, mirrors, patterns that move, transparent patterns, stretched shapes.
fn everything() -> Scene {
    let mut b = Builder::new();
    b.scene.background = Color([0.3, 0.4, 0.6]);
    b.scene.ambient = Color([0.15; 3]);
    b.camera(v(1.0, 3.0, 9.0), v(0.0, 0.8, 0.0), 45.0);
    b.light(v(5.0, 9.0, 6.0));
    b.light(v(-7.0, 4.0, 3.0));
    let (white, dark, red) = (b.gray(0.9), b.gray(0.2), b.color(0.8, 0.2, 0.1));
    let checker = b.pattern(PatternKind::Checker { a: white, b: dark, size: 0.7 });
    let noise = b.pattern(PatternKind::Noise { a: dark, b: red, octaves: 3, seed: 5 });
    let map = Affine::scaling(v(0.3, 0.3, 0.3)).compose(&Affine::rotation(2, 33.0));
    let noise = b.pattern(PatternKind::Transformed { child: noise, parent_from_child: map });
    let bent = b.pattern(PatternKind::Turbulence { child: noise, amount: 0.4, octaves: 2, seed: 1 });
    let floor = b.phong(checker, 0.0, 0.1, 0.0);
    b.shape(Shape::Plane { through: v(0.0, -0.5, 0.0), normal: DVec3::Y }, floor);
    let marble = b.phong(bent, 0.4, 0.0, 0.0);
    let tilt = Affine::rotation_about(v(1.0, 2.0, 0.5), 40.0);
    let torus = Shape::Torus { at: DVec3::ZERO, r: 0.8, tube: 0.3, axis: DVec3::Y };
    b.placed(torus, marble, Affine::translation(v(-2.0, 0.8, 0.0)).compose(&tilt));
    let ellipsoid = Affine::translation(v(0.3, 0.6, 1.0)).compose(&tilt).compose(&Affine::scaling(v(0.5, 1.2, 0.8)));
    let mirror = b.phong(red, 0.6, 0.6, 0.0);
    b.placed(Shape::Sphere { at: DVec3::ZERO, r: 1.0 }, mirror, ellipsoid);
    let glass = b.phong(dark, 0.5, 0.0, 0.9);
    b.scene.materials.last_mut().unwrap().ior = Some(1.5);
    b.shape(Shape::Sphere { at: v(2.1, 0.4, 1.5), r: 0.9 }, glass);
    let holes = b.pattern(PatternKind::Stripes { a: white, b: dark, axis: 1, size: 0.2 });
    let lattice = b.phong(red, 0.0, 0.0, 0.0);
    b.scene.materials.last_mut().unwrap().transmit = holes;
    let (from, to) = (v(3.2, -0.5, -1.0), v(3.6, 2.5, -1.5));
    b.shape(Shape::Cylinder { from, to, r: 0.6, caps: true }, lattice);
    b.shape(Shape::Cone { from: v(-3.5, -0.5, -2.0), to: v(-3.0, 2.0, -2.5), r: 1.0, top: 0.3, caps: true }, marble);
    let turned = Affine::translation(v(0.0, 0.3, -2.0)).compose(&Affine::rotation(1, 30.0));
    b.placed(Shape::Box { from: v(-0.8, -0.8, -0.8), to: v(0.8, 0.8, 0.8) }, marble, turned);
    b.shape(Shape::Disc { at: v(0.0, 2.6, -2.0), normal: v(0.2, -1.0, 0.3), r: 0.9, hole: 0.3 }, mirror);
    for i in 0..40 {
        let a = i as f64 * 9.0;
        let at = v(4.5 * rtdsl::math::fun::cos_deg(a), -0.3, 4.5 * rtdsl::math::fun::sin_deg(a));
        b.shape(Shape::Sphere { at, r: 0.2 }, if i % 3 == 0 { glass } else { marble });
    }
    let corners = [v(-4.0, 0.0, 1.0), v(-3.0, 0.0, 2.0), v(-4.5, 1.5, 1.0)];
    b.shape(Shape::Triangle { points: Box::new(corners), normals: None }, mirror);
    b.scene
}

#[test]
fn threads_tiles_and_crops_change_nothing() {
    for scene in [seed(1.0, DVec3::ZERO), everything()] {
        let base = Options { aa: AntiAliasing::Grid(2), ..options(&scene, 96, 54) };
        let whole = picture(&scene, &base);
        for (threads, tile) in [(1, 16), (3, 7), (2, 32), (8, 1)] {
            let same = picture(&scene, &Options { threads: Some(threads), tile, ..base.clone() });
            assert_same(&whole, &same, &format!("{threads} threads, tiles of {tile}"));
        }
        let crop = Crop { x: 37, y: 20, width: 31, height: 23 };
        let part = picture(&scene, &Options { crop: Some(crop), ..base.clone() });
        for y in 0..crop.height {
            let from = ((crop.y + y) * whole.width + crop.x) as usize;
            let row = (y * crop.width) as usize;
            let n = crop.width as usize;
            assert_eq!(whole.pixels[from..from + n], part.pixels[row..row + n], "row {y}");
        }
    }
}

#[test]
fn the_order_of_objects_changes_nothing() {
    for mut scene in [seed(1.0, DVec3::ZERO), everything()] {
        // Two surfaces in the same place, too.
        let (at, normal, r) = in_view(&scene);
        for material in [MaterialId(1), MaterialId(2)] {
            let shape = Shape::Disc { at, normal, r, hole: 0.0 };
            let place = scene.nodes[0].place.clone();
            scene.nodes.push(Node { kind: NodeKind::Shape(shape), material: Some(material), name: None, place });
            scene.roots.push(NodeId(scene.nodes.len() as u32 - 1));
        }
        let there = small(&scene);
        scene.roots.reverse();
        assert_same(&there, &small(&scene), "the other way round");
        let n = scene.roots.len() / 3;
        scene.roots.rotate_left(n);
        assert_same(&there, &small(&scene), "the last third first");
    }
}

/// A disc that the camera sees: centre, normal, radius.
fn in_view(scene: &Scene) -> (DVec3, DVec3, f64) {
    let c = &scene.cameras[0];
    let forward = (c.at - c.from).normalize();
    (c.from + forward * 5.0 + DVec3::Y * 0.3, -forward, 0.4)
}

#[test]
fn powers_of_two_change_nothing_and_moves_next_to_nothing() {
    let here = small(&seed(1.0, DVec3::ZERO));
    for k in [-400i32, -90, -20, -1, 1, 20, 90, 400] {
        let scaled = seed((0..k.abs()).fold(1.0, |x, _| if k < 0 { x / 2.0 } else { x * 2.0 }), DVec3::ZERO);
        assert_same(&here, &small(&scaled), &format!("lengths times 2^{k}"));
    }
    // A move that rounds no coordinate changes nothing, whether the text is moved or the whole scene.
    let short = |by: DVec3| {
        let mut scene = seed(1.0, by);
        let points = scene.nodes.iter_mut().find_map(|n| match &mut n.kind {
            NodeKind::Shape(Shape::Tetrahedron { points }) => Some(points),
            _ => None,
        });
        points.expect("the seed scene has one")[3] = by + v(0.75, -8.0, -69.0); // for 0.7
        scene
    };
    let there = small(&short(DVec3::ZERO));
    let far = (1u64 << 40) as f64;
    for by in [v(1024.0, 0.0, 0.0), v(-4096.0, 512.0, 65536.0), v(0.0, 1048576.0, 0.0), v(far, 1.0, -far)] {
        assert_same(&there, &small(&short(by)), &format!("text moved by {by}"));
        let moved = rtdsl::verify::picture::moved(&seed(1.0, DVec3::ZERO), by).expect("its camera is at round numbers");
        assert_same(&here, &small(&moved), &format!("moved by {by}"));
    }
    // Where it rounds coordinates of the text that aren't short binary fractions, such as 0.7, single pixels may change.
    for by in [v(1024.0, 0.0, 0.0), v(-4096.0, 512.0, 65536.0), v(0.0, 1048576.0, 0.0)] {
        let moved = small(&seed(1.0, by));
        assert!(share_that_differs(&here, &moved, 2.0) <= 2e-4, "moved by {by}");
    }
}

#[test]
fn other_scales_keep_the_picture() {
    let here = small(&seed(1.0, DVec3::ZERO));
    for s in [1e-100, 1e-6, 1e-3, 1e3, 1e6, 1e9, 1e100] {
        let share = share_that_differs(&here, &small(&seed(s, DVec3::ZERO)), 2.0);
        // Rows of pixels whose floor lies exactly on an edge of the checker may fall on either side of it.
        assert!(share < 0.012, "{s}: {share}");
    }
}

#[test]
fn single_precision_shows_the_same_scene() {
    for scene in [seed(1.0, DVec3::ZERO), everything()] {
        let exact = options(&scene, 160, 90);
        let short = Options { precision: Precision::F32, ..exact.clone() };
        let share = share_that_differs(&picture(&scene, &exact), &picture(&scene, &short), 3.0);
        assert!(share < 0.03, "{share}");
    }
}

/// A floor in the checker's own boundary plane, turned in many ways.
#[test]
fn a_floor_on_a_cell_boundary_has_no_speckle() {
    let turns = [
        Affine::IDENTITY,
        Affine::rotation(0, 30.0),
        Affine::rotation(2, 77.7),
        Affine::rotation_about(v(1.0, 1.0, 0.3), 123.0),
        Affine::translation(v(0.1, 0.2, 0.3)).compose(&Affine::rotation_about(v(-1.0, 0.4, 0.3), 200.0)),
    ];
    for turn in turns {
        // Turned as a whole, and: the plane given by its normal, the pattern turned to match.
        for by_normal in [false, true] {
            let mut b = Builder::new();
            let (white, black) = (b.gray(1.0), b.gray(0.0));
            let mut checker = b.pattern(PatternKind::Checker { a: white, b: black, size: 0.5 });
            let normal = turn.apply_vector(DVec3::Y);
            let through = turn.apply(DVec3::ZERO);
            if by_normal {
                checker = b.pattern(PatternKind::Transformed { child: checker, parent_from_child: turn });
            }
            let m = b.phong(checker, 0.0, 0.0, 0.0);
            b.scene.ambient = Color::WHITE;
            match by_normal {
                true => drop(b.shape(Shape::Plane { through, normal }, m)),
                false => b.placed(Shape::Plane { through: DVec3::ZERO, normal: DVec3::Y }, m, turn),
            }
            let (from, at) = (turn.apply(v(0.37, 4.0, 0.21)), turn.apply(v(0.37, 0.0, 0.22)));
            b.camera(from, at, 40.0);
            let film = small(&b.scene);
            // Every pixel is all white or all black, and has a neighbour of its own colour on either side or across.
            let at = |x: u32, y: u32| film.pixels[(y * film.width + x) as usize][0];
            let mut lonely = 0;
            for y in 1..film.height - 1 {
                for x in 1..film.width - 1 {
                    let c = at(x, y);
                    assert!(c == 0.0 || c == 1.0);
                    let around = [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)];
                    lonely += !around.iter().any(|p| at(p.0, p.1) == c) as u32;
                }
            }
            assert_eq!(lonely, 0, "{turn:?}, by normal: {by_normal}");
        }
    }
}

/// Shapes of many kinds, whose faces lie on the boundaries of their checkers, scaled as a whole.
#[test]
fn scaled_groups_keep_their_patterns_and_every_shape() {
    let scene = |s: f64| {
        let mut b = Builder::new();
        let (white, black) = (b.gray(1.0), b.gray(0.0));
        let checker = b.pattern(PatternKind::Checker { a: white, b: black, size: 0.2 });
        let m = b.phong(checker, 0.3, 0.0, 0.0);
        let map = Affine::scaling(DVec3::splat(s));
        let turned = map.compose(&Affine::rotation(0, 40.0));
        b.placed(Shape::Box { from: v(-1.0, -0.05, -1.0), to: v(1.0, 0.0, 1.0) }, m, map);
        b.placed(Shape::Cylinder { from: v(-0.7, 0.0, 0.0), to: v(-0.7, 0.6, 0.0), r: 0.2, caps: true }, m, map);
        b.placed(Shape::Cone { from: v(0.7, 0.0, 0.0), to: v(0.7, 0.6, 0.0), r: 0.3, top: 0.1, caps: true }, m, map);
        b.placed(Shape::Torus { at: v(0.0, 0.3, 0.0), r: 0.3, tube: 0.1, axis: DVec3::Y }, m, turned);
        b.placed(Shape::Disc { at: v(0.0, 0.2, 0.6), normal: DVec3::Y, r: 0.2, hole: 0.05 }, m, map);
        b.light(v(3.0, 4.0, 5.0) * s);
        b.camera(v(0.3, 1.5, 3.0) * s, v(0.0, 0.2, 0.0) * s, 40.0);
        b.scene.ambient = Color([0.3; 3]);
        small(&b.scene)
    };
    let here = scene(1.0);
    for s in [1e-130, 1e-80, 1e-6, 1e-3, 3.7, 1e3, 1e6, 1e9, 1e80, 1e130] {
        let share = share_that_differs(&here, &scene(s), 2.0);
        assert!(share <= 5e-4, "{s}: {share}");
    }
}

#[test]
fn the_tree_finds_what_brute_force_finds() {
    // Enough spheres for the tree in every tile; the same scene in tiles of one pixel uses short lists.
    let mut b = Builder::new();
    let c = b.color(0.7, 0.5, 0.3);
    let m = b.phong(c, 0.3, 0.3, 0.0);
    let clear = b.phong(c, 0.3, 0.0, 0.5);
    for i in 0..600 {
        let r = |k: u64| rtdsl::math::hash::KeyedHash::new().with(i).with(k).unit() - 0.5;
        let at = v(r(1), r(2), r(3)) * 8.0;
        b.shape(Shape::Sphere { at, r: 0.15 + 0.1 * (r(4) + 0.5) }, if i % 7 == 0 { clear } else { m });
    }
    b.light(v(9.0, 9.0, 9.0));
    b.light(v(-9.0, 3.0, 2.0));
    b.camera(v(0.0, 0.0, 14.0), DVec3::ZERO, 45.0);
    b.scene.settings.max_depth = 4;
    let base = options(&b.scene, 64, 64);
    let by_tree = picture(&b.scene, &Options { tile: 16, ..base.clone() });
    let by_list = picture(&b.scene, &Options { tile: 1, ..base });
    assert_same(&by_tree, &by_list, "tree and list");
}

#[test]
fn a_sphere_under_a_light_has_the_radiance_of_the_formula() {
    let mut b = Builder::new();
    let c = b.color(0.5, 0.25, 1.0);
    let m = b.phong(c, 0.5, 0.0, 0.0);
    b.shape(Shape::Sphere { at: DVec3::ZERO, r: 2.0 }, m);
    b.light(v(0.0, 0.0, 10.0));
    b.scene.ambient = Color([0.1; 3]);
    b.camera(v(0.0, 0.0, 10.0), DVec3::ZERO, 30.0);
    let film = picture(&b.scene, &options(&b.scene, 1, 1));
    // Looking straight on, n = l = v: color × (0.1 + 0.8) + 0.5.
    let expected = [0.5 * 0.9 + 0.5, 0.25 * 0.9 + 0.5, 0.9 + 0.5];
    for (got, expected) in film.pixels[0].iter().zip(expected) {
        assert!((*got as f64 - expected).abs() < 1e-7, "{got} {expected}");
    }
}

#[test]
fn what_lies_behind_is_added_once_for_each_surface() {
    // Three panes before a bright background: 0.5³ of it, plus each pane's own colour times what is before it.
    let mut b = Builder::new();
    let c = b.gray(0.1);
    let m = b.phong(c, 0.0, 0.0, 0.5);
    b.scene.ambient = Color::WHITE;
    b.scene.background = Color([8.0; 3]);
    for z in [0.0, -1.0, -1.0 - 1e-9] {
        b.shape(Shape::Plane { through: v(0.0, 0.0, z), normal: DVec3::Z }, m);
    }
    b.camera(v(0.3, 0.2, 5.0), v(0.3, 0.2, 0.0), 30.0);
    let film = picture(&b.scene, &options(&b.scene, 3, 3));
    let expected = 0.1 + 0.5 * (0.1 + 0.5 * (0.1 + 0.5 * 8.0));
    assert!(film.pixels.iter().all(|p| (p[0] as f64 - expected).abs() < 1e-6), "{:?}", film.pixels);
    b.scene.settings.max_depth = 2;
    let shallow = picture(&b.scene, &options(&b.scene, 1, 1));
    assert!((shallow.pixels[0][0] as f64 - (0.1 + 0.5 * (0.1 + 0.5 * 0.1))).abs() < 1e-6, "the recursion ends there");
}

#[test]
fn glass_that_stands_on_a_table_shows_the_table() {
    // The bottom of each lies in the very plane of the table. Wherever they stand, which of both is met isn't left to chance.
    for k in 0..20 {
        let mut b = Builder::new();
        let red = b.color(0.9, 0.1, 0.1);
        let x = 0.01 * k as f64;
        let table = b.phong(red, 0.0, 0.0, 0.0);
        let black = b.gray(0.0);
        let clear = b.phong(black, 0.0, 0.0, 1.0);
        b.shape(Shape::Plane { through: DVec3::ZERO, normal: DVec3::Y }, table);
        b.shape(Shape::Box { from: v(x - 1.0, 0.0, -1.0), to: v(x, 1.0, 1.0) }, clear);
        b.shape(
            Shape::Cone { from: v(x + 0.5, 0.0, 0.0), to: v(x + 0.5, 1.0, 0.0), r: 0.4, top: 0.0, caps: true },
            clear,
        );
        b.light(v(1.0, 8.0, 1.0));
        b.camera(v(0.3, 6.0, 0.4), v(0.0, 0.0, 0.0), 20.0);
        b.scene.background = Color::linear_gray(7.0);
        let film = small(&b.scene);
        assert!(film.pixels.iter().all(|p| p[0] > 0.0 && p[0] < 1.0), "{x}: what lies below is seen");
    }
}

#[test]
fn shadows_let_through_what_the_object_transmits() {
    for (transmit, expected) in [(0.0, 0.0), (0.5, 0.25), (1.0, 1.0)] {
        let mut b = Builder::new();
        let white = b.gray(1.0);
        let floor = b.phong(white, 0.0, 0.0, 0.0);
        b.shape(Shape::Plane { through: DVec3::ZERO, normal: DVec3::Y }, floor);
        let black = b.gray(0.0);
        let pane = b.phong(black, 0.0, 0.0, transmit);
        b.shape(Shape::Sphere { at: v(0.0, 5.0, 0.0), r: 1.0 }, pane);
        b.light(v(0.0, 10.0, 0.0));
        b.scene.ambient = Color::BLACK;
        b.camera(v(0.0, 2.0, 6.0), DVec3::ZERO, 20.0);
        let film = picture(&b.scene, &options(&b.scene, 1, 1));
        // In through one surface and out through another; the floor scatters 0.8.
        assert!((film.pixels[0][0] as f64 - 0.8 * expected).abs() < 1e-6, "{transmit}: {:?}", film.pixels[0]);
    }
}

/// A lamp that lies in a ceiling, in a face, on a ball: what it shines on is lit throughout, not speckled.
#[test]
fn a_light_in_a_surface_shines_without_speckle() {
    for height in [2.0, 3.0, 3.3] {
        let at = v(1.0, height, 2.0);
        for kind in 0..4 {
            let mut b = Builder::new();
            let c = b.gray(0.8);
            let m = b.phong(c, 0.3, 0.0, 0.0);
            b.shape(Shape::Plane { through: DVec3::ZERO, normal: DVec3::Y }, m);
            let surface = match kind {
                0 => Shape::Plane { through: v(0.0, height, 0.0), normal: DVec3::Y },
                1 => Shape::Disc { at, normal: DVec3::Y, r: 0.7, hole: 0.0 },
                2 => Shape::Box { from: at - v(2.0, 0.0, 2.0), to: at + v(2.0, 0.5, 2.0) },
                _ => Shape::Sphere { at: at + v(0.0, 0.5, 0.0), r: 0.5 },
            };
            b.shape(surface, m);
            b.light(at);
            b.scene.ambient = Color::BLACK;
            b.camera(v(0.0, 1.0, 8.0), v(0.5, 0.3, 0.0), 60.0);
            let film = small(&b.scene);
            // Below the horizon all is floor, and all of it is lit.
            let floor = &film.pixels[(60 * film.width) as usize..];
            let dark = floor.iter().filter(|p| p[0] < 0.01).count();
            assert_eq!(dark, 0, "surface {kind} at {height}: of {} pixels", floor.len());
        }
    }
}

#[test]
fn a_glass_ball_of_index_one_is_not_there() {
    let mut b = Builder::new();
    let black = b.gray(0.0);
    let m = b.phong(black, 0.0, 0.0, 1.0);
    b.scene.materials.last_mut().unwrap().ior = Some(1.0);
    b.shape(Shape::Sphere { at: DVec3::ZERO, r: 1.0 }, m);
    b.scene.background = Color([0.25, 0.5, 0.75]);
    b.camera(v(0.0, 0.0, 4.0), DVec3::ZERO, 40.0);
    let film = small(&b.scene);
    assert!(film.pixels.iter().flatten().zip([0.25, 0.5, 0.75].iter().cycle()).all(|(x, e)| (x - e).abs() < 1e-6));
}

#[test]
fn probing_names_the_node_and_its_lights() {
    let scene = seed(1.0, DVec3::ZERO);
    let world = World::build(&scene, &scene.cameras[0]);
    let o = options(&scene, 1280, 720);
    let hit = probe(&world, &o, 640, 250).expect("the mirror ball");
    assert!(matches!(scene.node(hit.node).kind, NodeKind::Shape(Shape::Sphere { r: 13.0, .. })));
    assert_eq!(hit.lights.len(), 1);
    assert_eq!(hit.lights[0].1, [1.0; 3]);
    let radius = DVec3::from_array(hit.point).distance(v(0.0, 0.0, -115.0));
    assert!((radius - 13.0).abs() < 1e-13, "{radius}");
    assert!(probe(&world, &o, 640, 10).is_none(), "the sky");
    let shaded = probe(&world, &o, 640, 520).expect("the lower side of the ball");
    assert_eq!(shaded.lights[0].1, [0.0; 3]);
}

#[test]
fn only_what_a_scene_requires_is_prepared() {
    let mut scene = seed(1.0, DVec3::ZERO);
    let world = World::build(&scene, &scene.cameras[0]);
    let used = |world: &World, scene: &Scene, name: &str| {
        world.features(scene).iter().find(|f| f.name == name).expect("a feature").in_use
    };
    assert!(used(&world, &scene, "pictures") && used(&world, &scene, "shadows") && !used(&world, &scene, "refraction"));
    // Without its light there are no shadows and no highlights, whatever the materials say.
    scene.roots.retain(|r| !matches!(scene.nodes[r.0 as usize].kind, NodeKind::Light(_)));
    let dark = World::build(&scene, &scene.cameras[0]);
    assert!(!used(&dark, &scene, "shadows") && !used(&dark, &scene, "highlights"));
    let o = options(&scene, 32, 18);
    let rays = render(&dark, &o, &Silent, &AtomicBool::new(false)).unwrap().rays;
    assert_eq!(rays.shadow, 0);
}
