//! Scenes at the edges of what there is, and beyond: each is a picture of finite numbers or a placed error, never a panic,
//! never a hang, never a NaN.

mod kernels;

use rtdsl::app::verify::strange::{faults, picture};
use rtdsl::film::Film;
use std::path::PathBuf;

/// The folder of the pictures that scenes show.
fn assets() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("examples/assets")
}

#[test]
fn strange_scenes_give_pictures_or_placed_errors() {
    // A long run: `RTDSL_SCENES=1000000 RTDSL_SEED=7 cargo test --release --test degenerate strange`.
    let count = std::env::var("RTDSL_SCENES").ok().and_then(|n| n.parse().ok()).unwrap_or(300);
    let seed = std::env::var("RTDSL_SEED").ok().and_then(|n| n.parse().ok()).unwrap_or(1);
    let (found, pictures) = faults(&assets(), seed, count);
    println!("{count} scenes, {pictures} pictures");
    assert!(found.is_empty(), "\n{}", found.join("\n"));
}

/// The picture of a scene that has one, every pixel of it a number.
fn drawn(text: &str) -> Film {
    let film = match picture(&assets(), text) {
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
        let failure = picture(&assets(), &format!("sphere() |> rotate(y: {digits}{unit})")).unwrap_err();
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
