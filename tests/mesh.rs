//! Meshes: a file's triangles make the picture that the same triangles make as words, wherever they stand and whatever they are
//! made of; no ray passes between them; and watching goes on as with any shape.

use rtdsl::film::Film;
use rtdsl::lang::{Evaluated, Input, Request, evaluate};
use rtdsl::math::fun::{cos_deg, sin_deg};
use rtdsl::math::hash::KeyedHash;
use rtdsl::render::{Options, Retracer, Search, Silent, World, probe, render};
use rtdsl::scene::{AntiAliasing, Precision};
use std::fmt::Write;
use std::path::Path;
use std::sync::atomic::AtomicBool;

static NEVER: AtomicBool = AtomicBool::new(false);

fn scene(text: &str, folder: &Path) -> Evaluated {
    let main = Input::Text { name: "m.scene".into(), bytes: text.into(), folder: folder.to_owned() };
    let request = Request { main, set: Vec::new(), allow_read: Vec::new(), record_arguments: false };
    evaluate(&request).unwrap_or_else(|f| panic!("{text}\n{:?}", f.diagnostics))
}

fn options(e: &Evaluated, precision: Precision) -> Options {
    let settings = Options::from_settings(&e.scene.settings);
    Options { width: 64, height: 48, aa: AntiAliasing::Off, precision, ..settings }
}

fn picture(e: &Evaluated, precision: Precision) -> Film {
    let world = World::build(&e.scene, &e.scene.cameras[0]);
    render(&world, &options(e, precision), &Silent, &NEVER).expect("not cancelled").film
}

/// A ball with dents: points of exact decimals, directions of halves, and the triangles between them.
struct Ball {
    points: Vec<[f64; 3]>,
    directions: Vec<[f64; 3]>,
    faces: Vec<[usize; 3]>,
}

impl Ball {
    const AROUND: usize = 9;
    const UP: usize = 6;

    fn new() -> Ball {
        let dent = |i: usize| 1.0 + (KeyedHash::new().with(i as u64).unit() * 64.0).floor() / 256.0;
        let (mut points, mut faces) = (vec![[0.0, 1.25, 0.0], [0.0, -1.125, 0.0]], Vec::new());
        for j in 1..Ball::UP {
            for i in 0..Ball::AROUND {
                let (turn, tilt) = (i as f64 * 40.0, j as f64 * 30.0);
                let r = dent(points.len()) * sin_deg(tilt);
                let p = [r * cos_deg(turn), cos_deg(tilt), r * sin_deg(turn)];
                points.push(p.map(|x| (x * 256.0).round() / 256.0));
            }
        }
        let at = |i: usize, j: usize| 2 + (j - 1) * Ball::AROUND + i % Ball::AROUND;
        for i in 0..Ball::AROUND {
            faces.push([0, at(i + 1, 1), at(i, 1)]);
            for j in 1..Ball::UP - 1 {
                let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
                faces.extend([[a, d, c], [a, c, b]]);
            }
            faces.push([at(i, Ball::UP - 1), at(i + 1, Ball::UP - 1), 1]);
        }
        let directions = points.iter().map(|p| p.map(|x| (x * 2.0).round() / 2.0 + 0.125)).collect();
        Ball { points, directions, faces }
    }

    fn write(&self, folder: &Path) {
        let mut text = String::new();
        self.points.iter().for_each(|[x, y, z]| writeln!(text, "v {x} {y} {z}").unwrap());
        self.directions.iter().for_each(|[x, y, z]| writeln!(text, "vn {x} {y} {z}").unwrap());
        for [a, b, c] in self.faces.iter().map(|f| f.map(|i| i + 1)) {
            writeln!(text, "f {a}//{a} {b}//{b} {c}//{c}").unwrap();
        }
        std::fs::write(folder.join("ball.obj"), text).unwrap();
    }

    /// The same triangles as words.
    fn words(&self, smooth: bool) -> String {
        let mut text = String::new();
        for face in &self.faces {
            let normals = face.map(|i| self.directions[i]);
            let normals = if smooth { format!(", normals: {normals:?}") } else { String::new() };
            writeln!(text, "triangle({:?}{normals})", face.map(|i| self.points[i])).unwrap();
        }
        text
    }
}

const REST: &str = "sphere(at: [0, 2.6, 0.3], r: 0.6, mat: mirror())\nplane(y: -1.3, mat: mirror())\nambient(0.2)\nlight(at: [4, 6, 5])\n\
                    light(at: [-5, 3, 4], power: 0.4)\ncamera(from: [0.3, 1.7, 6.1], at: [0, 0.4, 0], fov: 40deg)\n";

#[test]
fn a_mesh_is_its_triangles() {
    let dir = tempfile::tempdir().unwrap();
    let ball = Ball::new();
    ball.write(dir.path());
    let places =
        ["", " |> rotate(y: 33deg) |> move([0.3, 0.1, -0.2])", " |> scale([1.2, 0.7, -1.1]) |> rotate(x: 20deg)"];
    let looks =
        ["phong(color: #c84, specular: 0.4)", "phong(color: #c84, reflect: 0.4)", "phong(transmit: 0.6, ior: 1.3)"];
    let mut checked = 0;
    for (place, look) in places.into_iter().zip(looks) {
        for smooth in [false, true] {
            let as_mesh = format!("group(mat: {look}) {{ mesh(\"ball.obj\", smooth: {smooth}) }}{place}\n{REST}");
            let as_words = format!("group(mat: {look}) {{\n{}}}{place}\n{REST}", ball.words(smooth));
            let (mesh, words) = (scene(&as_mesh, dir.path()), scene(&as_words, dir.path()));
            for precision in [Precision::F64, Precision::F32] {
                assert!(picture(&mesh, precision) == picture(&words, precision), "{as_mesh} in {precision:?}");
                checked += 1;
            }
        }
    }
    assert_eq!(checked, 12);
}

#[test]
fn patterns_lie_on_a_mesh_in_the_space_of_its_file() {
    let dir = tempfile::tempdir().unwrap();
    // A box as a mesh: where a pattern is asked for, both say the same but for rounding.
    let corner = |i: usize| [i & 1, i >> 1 & 1, i >> 2].map(|b| b as f64 * 2.0 - 1.0);
    let mut text: String = (0..8).map(corner).map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect();
    text += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    std::fs::write(dir.path().join("box.obj"), text).unwrap();
    let look =
        "phong(color: checker(white, #223, size: 0.37) |> rotate(z: 17deg), bump: (noise() |> scale(0.3)) * 0.05)";
    let rest = format!(" |> rotate(y: 31deg)\n{REST}");
    let [mesh, solid] = ["mesh(\"box.obj\"", "box(size: [2, 2, 2]"]
        .map(|shape| picture(&scene(&format!("{shape}, mat: {look}){rest}"), dir.path()), Precision::F64));
    let far = |a: &[f32; 3], b: &[f32; 3]| (0..3).any(|c| (a[c] - b[c]).abs() > 1e-4);
    let differing = mesh.pixels.iter().zip(&solid.pixels).filter(|(a, b)| far(a, b)).count();
    let colors = mesh.pixels.iter().map(|p| p.map(f32::to_bits)).collect::<std::collections::HashSet<_>>().len();
    assert!(differing <= 3 && colors > 300, "{differing} of {colors}"); // a pixel on an edge may go to either side
}

#[test]
fn no_ray_passes_between_its_triangles_and_the_tree_loses_none() {
    let dir = tempfile::tempdir().unwrap();
    Ball::new().write(dir.path());
    // From within, nothing but the mesh is seen; its corners are aimed at, and its edges.
    for turn in 0..40 {
        let text = format!(
            "mesh(\"ball.obj\") |> rotate(y: {turn}deg)\ncamera(from: [0, 0, 0], at: [1, {}, 0.3], fov: 120deg)",
            turn as f64 * 0.05 - 1.0
        );
        let e = scene(&text, dir.path());
        let world = World::build(&e.scene, &e.scene.cameras[0]);
        let options = options(&e, Precision::F64);
        for (x, y) in (0..8).flat_map(|x| (0..6).map(move |y| (x * 8 + turn % 8, y * 8 + turn / 8))) {
            assert!(probe(&world, &options, x, y).is_some(), "turn {turn}, pixel {x} {y}");
        }
        let film = render(&world, &options, &Silent, &NEVER).expect("not cancelled").film;
        assert!(film.pixels.iter().all(|p| *p != [0.0; 3]), "turn {turn}");
    }
    let e = scene(&format!("mesh(\"ball.obj\")\nmesh(\"ball.obj\") |> move([1, 0, 1])\n{REST}"), dir.path());
    let world = World::build(&e.scene, &e.scene.cameras[0]);
    let search = Search::through(&world, 20_000, 1);
    assert!(search.differing == 0 && search.hits > 5_000, "{search:?}");
}

#[test]
fn watching_traces_what_changed_and_no_less() {
    let dir = tempfile::tempdir().unwrap();
    Ball::new().write(dir.path());
    let mesh = |mat: &str, x: f64| format!("mesh(\"ball.obj\", mat: {mat}) |> move([{x}, 0, 0])\n");
    let steps = [
        mesh("matte(red)", 0.0),
        mesh("matte(blue)", 0.0),
        mesh("matte(blue)", 0.0) + &mesh("matte(gray(0.5))", 2.0),
        "sphere(at: [-2, 0, 0], r: 0.3)\n".to_owned() + &mesh("matte(blue)", 0.0) + &mesh("matte(gray(0.5))", 2.0),
        "sphere(at: [-2, 0, 0], r: 0.4)\n".to_owned() + &mesh("matte(blue)", 0.0) + &mesh("matte(gray(0.5))", 2.0),
        "sphere(at: [-2, 0, 0], r: 0.4)\n".to_owned() + &mesh("phong(transmit: 0.5)", 2.0),
        "sphere(at: [-2, 0, 0], r: 0.4)\n".to_owned(),
    ];
    let mut retracer = Retracer::default();
    let mut kept = 0;
    for step in steps {
        let e = scene(&(step + &REST.replace("mirror()", "matte(white)")), dir.path());
        let options = Options { tile: 8, ..options(&e, Precision::F64) };
        let built = retracer.build(&e.scene, &e.scene.cameras[0], &NEVER).expect("not cancelled");
        let plan = retracer.plan(&built, &options, &NEVER);
        kept += plan.tiles() - plan.traced();
        let film = retracer.render(built, &options, plan, &Silent, &NEVER).expect("not cancelled").film;
        let world = World::build(&e.scene, &e.scene.cameras[0]);
        assert!(*film == render(&world, &options, &Silent, &NEVER).expect("not cancelled").film);
    }
    assert!(kept > 30, "{kept} tiles stayed");
}
