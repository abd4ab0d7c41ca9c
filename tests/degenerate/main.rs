//! Scenes at the edges of what there is, and beyond: each is a picture of finite numbers or a placed error, never a panic,
//! never a hang, never a NaN.

mod kernels;
mod writer;

use rtdsl::diag::Span;
use rtdsl::film::Film;
use rtdsl::lang::{self, Failure, Input, Request};
use rtdsl::render::{Options, Silent, World, render};
use rtdsl::scene::Precision;
use std::collections::HashSet;
use std::fmt::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use writer::{Writer, Written};

/// What the program makes of a text: its picture, or why there is none.
fn picture(text: &str) -> Result<Film, Failure> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/assets");
    let main = Input::Text { name: "try.scene".into(), bytes: text.as_bytes().to_vec(), folder };
    let request = Request { main, set: Vec::new(), allow_read: Vec::new(), record_arguments: false };
    let evaluated = lang::evaluate(&request)?;
    let scene = &evaluated.scene;
    let world = World::build(scene, &scene.cameras[0]);
    let mut options = Options { threads: Some(1), ..Options::from_settings(&scene.settings) };
    if world.beyond_f32().is_some() {
        options.precision = Precision::F64; // the program says so and stops
    }
    Ok(render(&world, &options, &Silent, &AtomicBool::new(false)).expect("nothing cancels it").film)
}

/// What is wrong with what the program made of a text, `None` if nothing is; and whether its picture shows anything. Statements with
/// errors are taken out, so that the others are seen too.
fn judge(written: &Written) -> (Option<String>, bool) {
    let mut made = false;
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        let mut left = Written { head: written.head.clone(), things: written.things.clone() };
        loop {
            match picture(&left.text()) {
                Ok(film) => {
                    made = film.pixels.iter().any(|p| *p != film.pixels[0]);
                    return fault_of_picture(&film, &left);
                }
                Err(f) if f.diagnostics.is_empty() => return Some("no picture, and no message".into()),
                Err(f) => {
                    let lines: Option<HashSet<usize>> =
                        f.diagnostics.iter().map(|d| Some(line(&f, d.span()?))).collect();
                    let Some(lines) = lines else {
                        return Some(format!("an error without a place: {}", f.diagnostics[0].message));
                    };
                    let heads = left.head.len();
                    let without = |all: &[String], first: usize| -> Vec<String> {
                        let kept = all.iter().enumerate().filter(|(i, _)| !lines.contains(&(first + i + 1)));
                        kept.map(|(_, s)| s.clone()).collect()
                    };
                    left = Written { head: without(&left.head, 0), things: without(&left.things, heads) };
                    if left.things.is_empty() {
                        return None;
                    }
                }
            }
        }
    }));
    (outcome.unwrap_or_else(|_| Some("a panic".into())), made)
}

fn fault_of_picture(film: &Film, of: &Written) -> Option<String> {
    if !film.pixels.as_flattened().iter().all(|x| x.is_finite()) {
        return Some("a pixel isn't a number".into());
    }
    match picture(&of.reversed()) {
        Ok(other) if other.hash() == film.hash() => None,
        Ok(_) => Some("the order of shapes changes the picture".into()),
        Err(_) => Some("the order of shapes makes an error".into()),
    }
}

/// The line of the text on which a span starts, from 1.
fn line(failure: &Failure, span: Span) -> usize {
    let location = failure.sources.location(span);
    let line = location.split(':').nth(1).and_then(|n| n.parse().ok());
    line.unwrap_or_else(|| panic!("{location} is no place"))
}

/// The fewest statements of a faulty scene that are faulty still.
fn shrunk(mut written: Written) -> Written {
    loop {
        let n = written.head.len() + written.things.len();
        // From the end: what comes first may be a parameter of all.
        let smaller = (0..n).rev().find_map(|i| {
            let mut less = Written { head: written.head.clone(), things: written.things.clone() };
            match i.checked_sub(less.head.len()) {
                Some(k) => less.things.remove(k),
                None => less.head.remove(i),
            };
            judge(&less).0.is_some().then_some(less)
        });
        match smaller {
            Some(less) => written = less,
            None => return written,
        }
    }
}

/// Runs cases `0..count` of `seed` on all cores; the faults, shrunk, and how many were pictures.
fn faults(seed: u64, count: u64) -> (Vec<String>, u64) {
    let next = AtomicU64::new(0);
    let pictures = AtomicU64::new(0);
    let workers = std::thread::available_parallelism().map_or(1, |n| n.get());
    let found = std::thread::scope(|s| {
        let work = || {
            let mut found = Vec::new();
            loop {
                let case = next.fetch_add(1, Relaxed);
                if case >= count || found.len() >= 8 {
                    return found;
                }
                let written = Writer::scene(seed, case);
                let (fault, made) = judge(&written);
                pictures.fetch_add(made as u64, Relaxed);
                if fault.is_some() {
                    let least = shrunk(written);
                    let mut text = format!("seed {seed}, case {case}: {}\n", judge(&least).0.unwrap_or_default());
                    let _ = write!(text, "{}", least.text());
                    found.push(text);
                }
            }
        };
        let running: Vec<_> = (0..workers).map(|_| s.spawn(work)).collect();
        running.into_iter().flat_map(|r| r.join().expect("a worker")).collect()
    });
    (found, pictures.into_inner())
}

#[test]
fn strange_scenes_give_pictures_or_placed_errors() {
    // A long run: `RTDSL_SCENES=1000000 RTDSL_SEED=7 cargo test --release --test degenerate strange`.
    let count = std::env::var("RTDSL_SCENES").ok().and_then(|n| n.parse().ok()).unwrap_or(300);
    let seed = std::env::var("RTDSL_SEED").ok().and_then(|n| n.parse().ok()).unwrap_or(1);
    let (found, pictures) = faults(seed, count);
    println!("{count} scenes, {pictures} pictures");
    assert!(found.is_empty(), "\n{}", found.join("\n"));
}

/// The picture of a scene that has one, every pixel of it a number.
fn drawn(text: &str) -> Film {
    let film = match picture(text) {
        Ok(film) => film,
        Err(f) => panic!("{text}\n{}", rtdsl::diag::print(&f.diagnostics, &f.sources, rtdsl::diag::Look::Plain)),
    };
    assert!(film.pixels.as_flattened().iter().all(|x| x.is_finite()), "{text}");
    film
}

const SMALL: &str = "render(size: [24, 18], depth: 6)\nbackground(skyblue)\n";
/// Materials of every way in which light goes on.
const LOOKS: [&str; 5] = ["matte(red)", "plastic(tomato)", "mirror()", "glass()", "phong(color: green, transmit: 0.5)"];

#[test]
fn cameras_and_lights_may_be_anywhere() {
    let solids =
        ["sphere(", "box(size: [2, 2, 2], ", "cylinder(from: [0, -1, 0], to: [0, 1, 0], ", "torus(tube: 0.5, "];
    // In the middle, on a surface, at a corner, in the tube.
    let places = ["[0, 0, 0]", "[0, 1, 0]", "[1, 1, 1]", "[1, 0, 0]", "[0, 0, 5]", "[0, 0.5, 0]"];
    for solid in solids {
        for look in LOOKS {
            for (i, camera) in places.into_iter().enumerate() {
                let mut text = format!("{SMALL}camera(from: {camera}, at: [0.3, 0.2, -7])\n{solid}mat: {look})\n");
                // In two places, and twice in one; at the camera too.
                for light in [places[i], places[(i + 1) % 6], places[(i + 1) % 6]] {
                    text += &format!("light(at: {light})\n");
                }
                drawn(&text);
            }
        }
    }
}

#[test]
fn mirrors_that_amplify_stay_numbers() {
    let facing = "mat: phong(color: black, reflect: 1e6)";
    let text = format!(
        "render(size: [8, 6], depth: 100)\ncamera(from: [0, 0, 5], at: [0, 0.0001, 0])\nbackground(white)\n\
         disc(at: [0, 0, -1], r: 3, normal: [0, 0, 1], {facing})\ndisc(at: [0, 0, 10], r: 3, normal: [0, 0, 1], {facing})\n"
    );
    for precision in ["f64", "f32"] {
        let film = drawn(&text.replace("depth: 100", &format!("depth: 100, precision: \"{precision}\"")));
        assert!(film.pixels.as_flattened().iter().any(|x| *x > 1e5), "the background, amplified");
    }
}

#[test]
fn angles_beyond_all_numbers_are_errors() {
    for unit in ["turn", "rad"] {
        let digits = "9".repeat(308);
        let failure = picture(&format!("sphere() |> rotate(y: {digits}{unit})")).unwrap_err();
        assert_eq!(failure.diagnostics[0].message, "this number is too large");
        assert!(failure.diagnostics[0].span().is_some());
    }
}

#[test]
fn minus_zero_is_zero() {
    let text = format!(
        "{SMALL}camera(from: [ZERO, 1, 6], at: [ZERO, ZERO, ZERO], up: [ZERO, 1, ZERO])
        ambient(ZERO)
        sphere(at: [ZERO, ZERO, ZERO], mat: matte(checker(red, linear(ZERO, 1, ZERO)) |> move([ZERO, 1, ZERO])))
        sphere(at: [ZERO, ZERO, ZERO], mat: matte(blue))
        plane(y: ZERO, mat: phong(color: white, specular: ZERO, bump: noise(ZERO, 1)))
        box(from: [ZERO, ZERO, ZERO], to: [1, 1, 1]) |> rotate(x: ZERO * 1deg) |> move([-2, ZERO, ZERO])
        cone(from: [2, ZERO, ZERO], to: [2, 1, ZERO], top: ZERO)
        disc(at: [ZERO, 2, ZERO], normal: [ZERO, 1, ZERO], hole: ZERO)
        triangle(points: [[ZERO, ZERO, 2], [1, ZERO, 2], [ZERO, 1, 2]], normals: [[ZERO, ZERO, 1], [ZERO, ZERO, 1], [1, ZERO, 1]])
        light(at: [ZERO, 9, ZERO], color: linear(1, ZERO, ZERO))\nlight(at: [5, 9, 9])"
    );
    let plain = drawn(&text.replace("ZERO", "0"));
    assert_eq!(plain.hash(), drawn(&text.replace("ZERO", "(-0)")).hash());
    assert_eq!(plain.hash(), drawn(&text.replace("ZERO", "(0 * -1)")).hash());
    assert!(plain.pixels.iter().any(|p| *p != plain.pixels[0]));
}

#[test]
fn what_coincides_is_drawn_the_same_in_every_order() {
    let camera = "camera(from: [3, 3, 6], at: [0, 0.5, 0])\n";
    for (a, b) in [
        ("sphere(mat: matte(red))", "sphere(mat: matte(blue))"),
        ("box(at: [0, 0.5, 0], mat: plastic(red))", "plane(y: 0, mat: matte(checker(white, black)))"),
        ("box(at: [0, 0.5, 0], mat: glass())", "plane(y: 0, mat: matte(checker(white, black)))"),
        ("sphere(mat: glass())", "sphere(mat: mirror())"),
        ("disc(mat: matte(red))", "disc(r: 2, normal: [0, -1, 0], mat: matte(blue))"),
        ("tetrahedron(mat: matte(red))", "tetrahedron(mat: glass())"),
        ("cylinder(r: 1, mat: matte(red))", "cone(r: 1, top: 1.0000000000000002, mat: matte(blue))"),
        ("light(at: [0, 5, 0], power: 0.3)", "light(at: [0, 5, 0], color: red)"),
        ("group { }", "group { group { } }"),
    ] {
        let text = |a: &str, b: &str| {
            format!("{SMALL}{camera}{a}\n{b}\nsphere(at: [0, -2, 0], r: 0.5)\nlight(at: [4, 8, 6])\n")
        };
        assert_eq!(drawn(&text(a, b)).hash(), drawn(&text(b, a)).hash(), "{a} and {b}");
    }
}

#[test]
fn a_heap_of_coincident_triangles_is_one_triangle() {
    let one = "triangle(points: [[-1, 0, 0], [1, 0, 0], [0, 2, 0]])";
    let scene = |shapes: &str| format!("{SMALL}{shapes}\nlight(at: [4, 8, 6])\n");
    let film = drawn(&scene(one));
    assert!(film.pixels.iter().any(|p| *p != film.pixels[0]));
    assert_eq!(film.hash(), drawn(&scene(&format!("for i in 0..10000 {{ {one} }}"))).hash());
}

#[test]
fn what_is_tiny_or_huge_on_the_way_counts_where_it_stands() {
    let plain = drawn(&format!("{SMALL}sphere()\nlight(at: [4, 8, 6])\n"));
    for way in [
        // Powers of two, so that nothing is rounded.
        "sphere(r: 2 ^ -400) |> scale(2 ^ 400)",
        "sphere(r: 2 ^ 400) |> scale(2 ^ -300) |> scale(2 ^ -100)",
        "sphere() |> scale(2 ^ -450) |> scale(2 ^ -450) |> scale(2 ^ 450) |> scale(2 ^ 450)",
        "sphere() |> move([2 ^ 400, 0, 0]) |> scale(2 ^ 60) |> scale(2 ^ -60) |> move([-(2 ^ 400), 0, 0])",
        "sphere() |> scale([2 ^ 400, 1, 2 ^ -400]) |> scale([2 ^ -400, 1, 2 ^ 400])",
    ] {
        let film = drawn(&format!("{SMALL}{way}\nlight(at: [4, 8, 6])\n"));
        if way.contains("move") {
            continue; // of a radius of 1 nothing is left so far away
        }
        assert_eq!(film.hash(), plain.hash(), "{way}");
    }
}
