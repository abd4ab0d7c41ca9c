//! The language end to end: texts in, scenes or messages out.

mod hostile;
mod likeness;
mod memory;
mod mesh;
mod mistake;
mod module;
mod mutation;
mod unused;

use super::limits::Limits;
use super::*;
use crate::scene::{AntiAliasing, NodeKind, PatternKind, PixelFilter, Shape};
use std::path::PathBuf;

fn request(text: &str) -> Request {
    Request {
        main: Input::Text {
            name: "test.scene".into(),
            bytes: text.as_bytes().to_vec(),
            folder: PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/examples")),
        },
        set: Vec::new(),
        allow_read: Vec::new(),
        record_arguments: false,
    }
}

fn scene(text: &str) -> Evaluated {
    evaluate(&request(text)).unwrap_or_else(|f| panic!("{text}\n{}", shown(&f)))
}

fn shown(f: &Failure) -> String {
    f.diagnostics
        .iter()
        .map(|d| {
            let at = d.span().map_or(String::new(), |s| format!("{} `{}` ", f.sources.location(s), f.sources.text(s)));
            let labels: Vec<&str> = d.labels.iter().map(|l| l.text.as_str()).collect();
            let calls = d.place.as_ref().map_or(Vec::new(), |p| p.call_chain(&f.sources));
            format!("{at}{} | {} | {} | {}", d.message, labels.join("; "), d.notes.join("; "), calls.join("; "))
        })
        .collect::<Vec<_>>()
        .join("\n")
}

/// The messages alone.
fn errors(text: &str) -> Vec<String> {
    match evaluate(&request(text)) {
        Ok(_) => panic!("no error in: {text}"),
        Err(f) => f.diagnostics.into_iter().map(|d| d.message).collect(),
    }
}

/// What an expression is, as text.
fn value(expr: &str) -> String {
    let e = scene(&format!("param p: \"{{{expr}}}\""));
    e.params[0].value.trim_matches('"').to_owned()
}

const SEED: &str = r#"rtdsl 1
let shiny = phong(diffuse: 0.8, specular: 0.5, shininess: 20)

camera(from: [0, 0, 0], at: [0, 0, -1], fov: 28.0724869deg)      // the vertical angle
background(linear(0.45, 0.6, 0.8))
ambient(0.2)
light(at: [30, 45, 20])

plane(y: -15, mat: phong(color: checker(linear(0.9, 0.9, 0.85), linear(0.15, 0.35, 0.2), size: 10), diffuse: 0.8, specular: 0))
sphere(at: [0, 0, -115],   r: 13, mat: shiny.with(color: linear(0.1, 0.1, 0.3), reflect: 0.7))
sphere(at: [-23, -5, -100], r: 9, mat: shiny.with(color: image("assets/earth.png", mapping: "normal")))
sphere(at: [23, -6, -95],   r: 9, mat: shiny.with(color: stripes(linear(0.9, 0.5, 0.1), linear(0.2, 0.2, 0.7), axis: "y", size: 1)))
cylinder(from: [10, -15, -75], to: [10, -5, -75], r: 3.5, caps: false, mat: shiny.with(color: linear(0.1, 0.25, 0.1), transmit: 0.7))
cone(from: [-12, -15, -78], to: [-12, -5, -78], r: 4, mat: shiny.with(color: linear(0.8, 0.2, 0.2)))
tetrahedron(points: [[-3, -15, -66], [4, -15, -68], [0.5, -15, -74], [0.7, -8, -69]], mat: shiny.with(color: linear(0.9, 0.8, 0.2)))

render(size: [1280, 720], aa: off, depth: 5)
"#;

const SPIRAL: &str = r#"
param count:   240 in 10..=2000 "spheres on the spiral"
param variant: 1   in 1..=99    "another arrangement"

/// Point on a cone-shaped spiral; u goes 0 → 1 from floor to tip.
fn spiral(u) {
  let a = u * 6turn
  [cos(a), 0, sin(a)] * 4 * (1 - u) + [0, 5 * u, 0]
}
fn bead(u, i) {
  let size = lerp(0.25, 0.06, u) * (0.7 + 0.6 * rand(variant, i, "size"))
  let hue  = 200deg + 140deg * u
  let skin = if rand(variant, i, "kind") < 0.15 { glass(tint: hsv(hue, 0.4, 1)) }
             else { phong(color: hsv(hue, 0.75, 1), reflect: 0.2, shininess: 90) }
  sphere(at: spiral(u) + on_sphere(variant, i, "jitter") * 0.05, r: size, mat: skin)
}
for i in 0..count { bead(i / (count - 1), i) }
plane(y: -0.3, mat: matte(checker(gray(0.85), gray(0.75), size: 0.5)))
camera(from: [7, 4, -9], at: [0, 2.2, 0], fov: 38deg)
light(at: [5, 12, -8])
render(size: [900, 900], aa: grid(2))
"#;

#[test]
fn the_seed_scene_is_read_word_for_word() {
    let e = scene(SEED);
    assert!(e.warnings.is_empty());
    assert_eq!(e.scene.instance_count(), 8);
    assert_eq!((e.scene.settings.width, e.scene.settings.height, e.scene.settings.max_depth), (1280, 720, 5));
    assert_eq!(e.scene.images.len(), 1);
    assert_eq!(e.scene.ambient.0, [0.2; 3]);
    let mut words = Vec::new();
    e.scene.for_each_instance(|i| {
        if let NodeKind::Shape(s) = &e.scene.node(i.node).kind {
            words.push(s.word());
            assert!(e.scene.material(i.material).place.is_some());
        }
    });
    assert_eq!(words, ["plane", "sphere", "sphere", "sphere", "cylinder", "cone", "tetrahedron"]);
    let checkers =
        e.scene.patterns.iter().filter(|p| matches!(p.kind, PatternKind::Checker { size: 10.0, .. })).count();
    assert_eq!(checkers, 1);
    assert_eq!(e.files.len(), 1, "the picture");
}

#[test]
fn filters_have_names() {
    for (name, filter) in ["box", "mitchell", "gauss"].into_iter().zip(PixelFilter::ALL) {
        let e = scene(&format!("rtdsl 1\nsphere()\nrender(filter: \"{name}\")\n"));
        assert_eq!((e.scene.settings.filter, filter.name()), (filter, name));
    }
}

#[test]
fn the_spiral_is_read_word_for_word() {
    let e = scene(SPIRAL);
    assert_eq!(e.scene.instance_count(), 242);
    assert_eq!(e.scene.settings.aa, AntiAliasing::Grid(2));
    assert_eq!(e.scene.settings.filter, PixelFilter::Box);
    assert_eq!(e.params.len(), 2);
    assert_eq!(e.params[0].kind, ParamKind::Number { range: Some((10.0, 2000.0)), whole: true, unit: "" });
    let node = e.scene.node(e.scene.roots[60]);
    let chain = node.place.call_chain(&e.sources);
    assert_eq!(chain, ["called from bead(…) at test.scene:17:21"]);
    let mut r = request(SPIRAL);
    r.set.push(("count".into(), "50".into()));
    r.record_arguments = true;
    let e = evaluate(&r).unwrap_or_else(|f| panic!("{}", shown(&f)));
    assert_eq!(e.scene.instance_count(), 52);
    assert_eq!(e.params[0].value, "50");
    let chain = e.scene.node(e.scene.roots[49]).place.call_chain(&e.sources);
    assert_eq!(chain, ["called from bead(u: 1, i: 49) at test.scene:17:21"]);
}

#[test]
fn the_famous_error_reads_as_promised() {
    let text = SPIRAL.replace(", r: size,", ", raduis: size,");
    let f = evaluate(&request(&text)).unwrap_err();
    assert_eq!(
        shown(&f),
        "test.scene:15:66 `raduis` `sphere` has no property `raduis` | did you mean `r`? | sphere takes: at, r, mat, name | "
    );
    let text = SPIRAL.replace("r: size", "r: size - 0.25");
    let f = evaluate(&request(&text)).unwrap_err();
    assert!(shown(&f).contains("`r` must be above 0, got -"), "{}", shown(&f));
    assert!(shown(&f).contains("called from bead(u: "), "{}", shown(&f));
}

#[test]
fn values_compute() {
    for (expr, expected) in [
        ("1 + 2 * 3", "7"),
        ("[1, 2, 3] + [1, 1, 1] * 2", "[3, 4, 5]"),
        ("[1, 2, 3].y", "2"),
        ("90deg + 0.25turn", "180deg"),
        ("cos(90deg)", "0"),
        ("sin(30deg)", "0.5"),
        ("if 1 < 2 { 3 } else { 4 }", "3"),
        ("[for i in 0..4 { i * i }]", "[0, 1, 4, 9]"),
        ("[for i in 0..6 if i % 2 == 0 { i }]", "[0, 2, 4]"),
        ("[for i in 0..2 { for j in 0..2 { 10 * i + j } }]", "[0, 1, 10, 11]"),
        ("(x => x * x)(5)", "25"),
        ("0..4 |> map(x => x + 1)", "[1, 2, 3, 4]"),
        ("record(a: 1, b: 2).with(a: 5).a", "5"),
        ("[10, 20, 30][1]", "20"),
        ("not true or 1 == 1", "true"),
        ("min(3, 1, 2) + max(1, 5)", "6"),
        ("lerp(2, 4, 50%)", "3"),
        ("phong(reflect: 0.25).reflect", "0.25"),
        ("phong().with(color: #fff).color", "linear(1, 1, 1)"),
        ("(0..=4)[4]", "4"),
        ("red.r", "1"),
        ("{ let a = 2; var b = a; b += 3; b * a }", "10"),
    ] {
        assert_eq!(value(expr), expected, "{expr}");
    }
}

#[test]
fn functions_are_closed_over_what_never_changes() {
    let text = "fn adder(n) = x => x + n\nlet add2 = adder(2)\nfn fact(n) { if n <= 1 { 1 } else { n * fact(n - 1) } }\n\
                fn outer(k) { fn inner(n) { if n == 0 { k } else { inner(n - 1) + 1 } }\n inner(5) }\n\
                fn named(a, b: 10, c: b * 2) = a + b + c\nfn early() = later()\nfn later() = 7\n\
                param p: \"{add2(5)} {fact(5)} {outer(3)} {named(1)} {named(1, c: 0)} {named(a: 2, b: 1)} {early()}\"";
    assert_eq!(scene(text).params[0].value, "\"7 120 8 31 11 5 7\"");
}

#[test]
fn loops_compute_and_shapes_are_collected() {
    let e = scene(
        "var sum = 0\nfor i in 0..5 { sum += i }\nvar n = 0\nwhile n < 10 { n += 3 }\n\
         let s = sphere()\nfor i in 0..3 { s |> move([i, 0, 0]) }\nif sum == 10 and n == 12 { box() }\n\
         group(mat: matte(red)) { s; [for k in 0..2 { s |> scale(2 + k) }] } |> rotate(y: 90deg)",
    );
    assert_eq!(e.scene.instance_count(), 7);
    let spheres = e.scene.nodes.iter().filter(|n| matches!(n.kind, NodeKind::Shape(Shape::Sphere { .. }))).count();
    assert_eq!(spheres, 1, "a shared value is stored once");
}

#[test]
fn patterns_nest_and_compute() {
    let e = scene(
        "let p = checker(0.2, stripes(0.1, 0.9) |> scale(0.5)) |> rotate(z: 30deg)\n\
         sphere(mat: phong(reflect: p * 0.5 + 0.1, color: checker(red, #0f0) * gray(0.5), shininess: 10 + 20 * p))\n\
         sphere(mat: phong(color: 1 - checker(red, blue)))",
    );
    assert!(e.scene.patterns.len() > 8);
    assert_eq!(
        errors("sphere(mat: phong(color: checker(0, 1)))"),
        ["`color` must be a color or a pattern of colors, got a pattern of numbers"]
    );
    assert_eq!(
        errors("sphere(mat: phong(color: 0.5))"),
        ["`color` must be a color or a pattern of colors, got a number (0.5)"]
    );
    let deep = "var p = checker(0, 1)\nfor i in 0..300 { p = p + 0 }";
    assert_eq!(errors(deep), ["patterns are nested more than 200 deep"]);
}

#[test]
fn parameters_are_set_and_checked() {
    let text = "param n: 3 in 1..=9\nparam style: \"matte\" of [\"matte\", \"glass\"]\nparam tilt: 10deg\nparam label: \"a\"\nfor i in 0..n { sphere() }";
    let with = |name: &str, raw: &str| {
        let mut r = request(text);
        r.set.push((name.into(), raw.into()));
        evaluate(&r).map(|e| e.params.into_iter().find(|p| p.name == name).map(|p| p.value)).map_err(|f| shown(&f))
    };
    assert_eq!(with("n", "5"), Ok(Some("5".into())));
    assert_eq!(with("n", "2 * 3"), Ok(Some("6".into())));
    assert_eq!(with("style", "glass"), Ok(Some("\"glass\"".into())));
    assert_eq!(with("style", "\"glass\""), Ok(Some("\"glass\"".into())));
    assert_eq!(with("tilt", "0.25turn"), Ok(Some("90deg".into())));
    assert_eq!(with("label", "any thing (at all"), Ok(Some("\"any thing (at all\"".into())));
    for (name, raw, expected) in [
        ("n", "50", "--set:1:3 `50` parameter `n` must be from 1 to 9, got 50"),
        ("n", "2.5", "must be a whole number"),
        ("n", "(", "never closed"),
        ("tilt", "5", "parameter `tilt` must be an angle"),
        ("style", "wood", "must be \"matte\" or \"glass\""),
        ("lable", "1", "the scene has no parameter `lable` | did you mean `label`?"),
    ] {
        let got = with(name, raw).unwrap_err();
        assert!(got.contains(expected), "{got}");
        assert_eq!(got.lines().count(), 1, "{got}");
    }
}

#[test]
fn every_example_of_the_catalog_runs() {
    for w in catalog::catalog() {
        let e = scene(w.example);
        assert!(!e.scene.cameras.is_empty(), "{}", w.name);
    }
}
