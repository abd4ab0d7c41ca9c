//! The laws of whole pictures, on the examples.

use glam::DVec3;
use rtdsl::film::Film;
use rtdsl::lang::{Input, Request, evaluate};
use rtdsl::render::{Crop, Options};
use rtdsl::scene::{AntiAliasing, Precision, Scene};
use rtdsl::verify::picture::{Law, beside, picture, steady};
use std::path::Path;

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

#[test]
#[ignore]
fn survey() {
    let only = std::env::var("ONLY").ok();
    for name in names() {
        if only.as_ref().is_some_and(|o| !o.split(',').any(|o| o == name)) {
            continue;
        }
        let scene = steady(&example(&name));
        let o = options(&scene, 96, 54);
        let before = picture(&scene, &o);
        let big = (1u64 << 40) as f64;
        let mut laws = Vec::new();
        laws.extend([-400, -301, -63, -1, 1, 64, 399, 400].map(Law::PowerOfTwo));
        laws.extend(
            [DVec3::X, DVec3::new(1024.0, 0.0, -3.0), DVec3::new(-big, 512.0, 65536.0), DVec3::new(3.0, big, -big)]
                .map(Law::Moved),
        );
        laws.extend([0, 1, 2].map(Law::Mirrored));
        laws.extend([0, 1, 2].map(Law::Turned));
        laws.extend([1, 2].map(Law::Shuffled));
        laws.extend([Law::Instanced, Law::Treeless, Law::Threads(3), Law::Tiles(7), Law::Tiles(1)]);
        laws.push(Law::Cropped(Crop { x: 11, y: 5, width: 61, height: 37 }));
        report(&name, "f64", &scene, &o, &before, &laws);
        let o = Options { precision: Precision::F32, ..o };
        let before = picture(&scene, &o);
        let mut laws = vec![Law::PowerOfTwo(-20), Law::PowerOfTwo(20), Law::Instanced, Law::Treeless, Law::Shuffled(1)];
        laws.extend([0, 1, 2].map(Law::Mirrored));
        laws.extend([DVec3::X, DVec3::new(3.0, big, -big)].map(Law::Moved));
        report(&name, "f32", &scene, &o, &before, &laws);
        let scene = beside(&scene);
        let o = options(&scene, 320, 180);
        let before = picture(&scene, &o);
        report(&name, "f64", &scene, &o, &before, &[1e-6, 1e-3, 1e3, 1e6, 1e9].map(Law::Scaled));
    }
}

fn report(name: &str, what: &str, scene: &Scene, o: &Options, before: &Film, laws: &[Law]) {
    for law in laws {
        match law.difference(scene, o, before) {
            None => println!("{name} {what} {law:?}: CAN'T"),
            Some(d) if d.bits > 0 => {
                println!(
                    "{name} {what} {law:?}: bits {} visible {} ({:.4} %) codes {:.3} first {:?}",
                    d.bits,
                    d.visible,
                    100.0 * d.visible_share(),
                    d.codes,
                    d.first
                )
            }
            Some(_) => {}
        }
    }
    println!("{name} {what} done {}", laws.len());
}
