//! Only what a scene requires costs: what is made and put nowhere leaves the world as it is, in bytes and abilities, and its
//! picture, in rays and pixels. `benches/features.py` counts instructions besides.

use rtdsl::lang::{Input, Request, evaluate};
use rtdsl::render::{Options, RayCounts, Silent, World, render};
use rtdsl::scene::Scene;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::atomic::AtomicBool;

/// A mirror ball and a globe on a checkered floor: some of what there is, and by far not all.
const SCENE: &str = r#"camera(from: [0, 1.5, 6], at: [0, 0.8, 0], fov: 30deg)
background(linear(0.5, 0.6, 0.8))
light(at: [4, 6, 5])
plane(y: 0, mat: matte(checker(white, black)))
sphere(at: [-1, 1, 0], r: 1, mat: phong(color: image("earth.png"), specular: 0.5))
sphere(at: [1, 1, 0], r: 1, mat: mirror())
render(size: [64, 36])
"#;

/// Statements that make something and put it nowhere, by what they make.
fn unused() -> Vec<(&'static str, String)> {
    let mut values = String::new();
    for i in 0..10_000 {
        let _ = writeln!(values, "let unused{i} = {i} * 2 + 1");
    }
    let one = |what, text: &str| (what, format!("let unused = {text}\n"));
    vec![
        one("a picture", r#"image("other.png")"#),
        one("a picture that isn't there", r#"image("missing.png")"#),
        one("a picture in a material", r#"phong(color: image("other.png"), bump: noise(0, 0.1))"#),
        one("a picture that is used, laid on otherwise", r#"image("earth.png", mapping: "normal", filter: "nearest")"#),
        one("a material", "phong(color: red, specular: 0.3, reflect: 0.2, transmit: 0.4, bump: noise(0, 0.3))"),
        one("glass", "glass()"),
        one("patterns", "mix(noise(red, blue), stripes(cells(), rings(red, blue)), 0.5)"),
        one("a torus", "torus(at: [0, 1, 0]) |> scale([1, 2, 3])"),
        one("a box with a look of its own", "box(size: [1, 1, 1], mat: glass())"),
        one("10,000 balls", "[for i in 0..10000 { sphere(at: [i, 0, 0]) }]"),
        one("10,000 materials", "[for i in 0..10000 { phong(color: gray(i / 10000), reflect: 0.5) }]"),
        ("a function", "fn unused(x) = sphere(at: [x, 0, 0], r: 1, mat: glass())\n".into()),
        ("a function that makes a light", "fn unused(x) = light(at: [x, 9, 0])\n".into()),
        ("10,000 values", values),
    ]
}

/// Two small pictures, so that one can be used and the other not.
fn desk() -> tempfile::TempDir {
    let desk = tempfile::tempdir().unwrap();
    for (name, side) in [("earth.png", 16), ("other.png", 32)] {
        let picture = image::RgbImage::from_fn(side, side, |x, y| image::Rgb([7 * x as u8, 5 * y as u8, 90]));
        picture.save(desk.path().join(name)).unwrap();
    }
    desk
}

fn scene(folder: &Path, text: String) -> Scene {
    let main = Input::Text { name: "a.scene".into(), bytes: text.into_bytes(), folder: folder.to_owned() };
    let request = Request { main, set: Vec::new(), allow_read: Vec::new(), record_arguments: false };
    match evaluate(&request) {
        Ok(e) => e.scene,
        Err(f) => panic!("the scene is valid: {:?}", f.diagnostics),
    }
}

/// What tracing a scene takes and gives.
#[derive(Debug, PartialEq)]
struct Cost {
    bytes: usize,
    features: Vec<(&'static str, bool, String)>,
    rays: RayCounts,
    hash: String,
}

fn cost(folder: &Path, text: String) -> Cost {
    let scene = scene(folder, text);
    let world = World::build(&scene, &scene.cameras[0]);
    let options = Options::from_settings(&scene.settings);
    let rendered = render(&world, &options, &Silent, &AtomicBool::new(false)).unwrap();
    let features = world.features(&scene).into_iter().map(|f| (f.name, f.in_use, f.detail)).collect();
    Cost { bytes: world.memory_bytes(), features, rays: rendered.rays, hash: rendered.film.hash() }
}

#[test]
fn what_is_put_nowhere_costs_nothing() {
    let desk = desk();
    let plain = cost(desk.path(), SCENE.into());
    assert!(plain.rays.reflected > 100 && plain.rays.shadow > 100, "{:?}", plain.rays);
    for (what, text) in unused() {
        assert_eq!(cost(desk.path(), format!("{SCENE}{text}")), plain, "{what}, after the rest");
        assert_eq!(cost(desk.path(), format!("{text}{SCENE}")), plain, "{what}, before the rest");
    }
}

#[test]
fn what_is_put_somewhere_is_told() {
    let desk = desk();
    let plain = cost(desk.path(), SCENE.into());
    for text in [
        "torus(at: [0, 1, 0])\n",
        "sphere(r: 0.1, mat: glass())\n",
        "light(at: [-5, 5, 5])\n",
        "plane(y: -1, mat: phong(color: image(\"other.png\")))\n",
    ] {
        let more = cost(desk.path(), format!("{SCENE}{text}"));
        assert!(more.bytes > plain.bytes, "{text}");
        assert_ne!(more.features, plain.features, "{text}");
    }
}

#[test]
fn explain_says_the_same() {
    let desk = desk();
    let explain = |text: &str| {
        fs::write(desk.path().join("a.scene"), text).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_rtdsl"));
        let out = command.args(["explain", "a.scene"]).current_dir(desk.path()).output().unwrap();
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
        String::from_utf8(out.stdout).unwrap()
    };
    let plain = explain(SCENE);
    assert!(plain.contains("mirror reflection") && plain.contains("held for tracing"), "{plain}");
    for (what, text) in unused() {
        assert_eq!(explain(&format!("{SCENE}{text}")), plain, "{what}");
    }
}
