//! The language end to end: texts in, scenes or messages out.

mod mutation;

use super::limits::Limits;
use super::*;
use crate::scene::{AntiAliasing, NodeKind, PatternKind, Shape};
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
fn the_spiral_is_read_word_for_word() {
    let e = scene(SPIRAL);
    assert_eq!(e.scene.instance_count(), 242);
    assert_eq!(e.scene.settings.aa, AntiAliasing::Grid(2));
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
fn every_independent_mistake_is_reported_once() {
    let text = "let a = 1 / 0\nlet b = a + 1\nsphere(r: b)\nsphere(r: -1)\nspere()\nlet c = \nlet d = 5 +\n\
                box(size: [1, 1, 1], mat: red)\nlet e = (1 + 2))\nsphere(at: 5)\nc";
    assert_eq!(
        errors(text),
        [
            "division by 0",
            "`r` must be above 0, got -1",
            "`spere` is unknown",
            "expected a value, but the statement ends here",
            "`mat` must be a material, got a color",
            "`)` closes nothing",
            "`at` must be a point `[x, y, z]`, got a number (5)",
        ]
    );
}

#[test]
fn names_are_checked_before_anything_runs() {
    for (text, expected) in [
        ("fn f() = unknwn", "`unknwn` is unknown"),
        ("let a = 1\nlet a = 2", "`a` is bound twice"),
        ("let a = 1\na = 2", "`a` can't be changed"),
        ("var a = 1\nfn f() = a", "a function can't use the `var` `a` outside it"),
        ("var a = 1\nfn f() { a = 2; 1 }", "a function can't change the `var` `a` outside it"),
        ("a = 2", "there is no variable `a`"),
        ("let b = c\nlet c = 1", "`c` is used before it has a value"),
        ("fn f(x) = x\nlet a = f()", "`f` needs `x`"),
        ("fn f(x) = x\nlet a = f(1, 2)", "`f` has too many arguments"),
        ("fn f(x, y: 2) = x\nlet a = f(1, 2)", "`y` of `f` must be named"),
        ("fn f(x) = x\nlet a = f(1, x: 2)", "`x` of `f` is given twice"),
        ("fn f(x, x) = x", "`x` is bound twice"),
        ("sphere(1)", "`at` of `sphere` must be named"),
        ("let a = checker(1)", "`checker` needs `b`"),
        ("fn f() { camera() }", "`camera` belongs at the top level of the file"),
        ("let c = camera()", "`camera` belongs at the top level of the file"),
        ("group { camera() }", "`camera` belongs at the top level of the file"),
        ("camera()\ncamera()", "`camera` is set twice"),
        ("let f = x => { let y = 1 }", "this block has no value"),
        ("let a = if true { 1 }", "this `if` has no value when its condition is false"),
        ("fn f() { for i in 0..3 { sphere() } }", "a `for` has no value here"),
        ("fn f() { sphere(); box() }\nf()", "this makes a shape that isn't added to anything"),
        ("1 + 2", "a scene is made of shapes and lights"),
        ("let a = std.sphree()", "`std` has no `sphree`"),
        ("rtdsl 2", "this program speaks edition 1 of the language, not `2`"),
        ("let m = phong(collor: red)", "`phong` has no property `collor`"),
        ("let m = phong().with(collor: red)", "a material has no `collor`"),
        ("param p: 5 in 6..=7", "parameter `p` must be from 6 to 7, got 5"),
    ] {
        let found = errors(text);
        assert!(found.contains(&expected.to_owned()), "{text}: {found:?}");
        let most = if text.contains("for i in 0..3 { sphere() } }") { 2 } else { 1 };
        assert!(found.len() <= most, "{text}: {found:?}");
    }
}

#[test]
fn units_and_ranges_are_checked_with_a_fix() {
    let f = evaluate(&request("camera(fov: 30)")).unwrap_err();
    assert_eq!(f.diagnostics[0].message, "`fov` must be an angle, got a number (30)");
    assert_eq!(f.diagnostics[0].fix.as_deref(), Some("30deg"));
    assert_eq!(f.sources.text(f.diagnostics[0].labels[0].span), "30");
    for (text, expected) in [
        ("camera(fov: 180deg)", "`fov` must be above 0deg and below 180deg, got 180deg"),
        ("sphere(r: 30deg)", "`r` must be a number, got an angle (30deg)"),
        ("sphere(r: 1e-200)", "`r` is outside the supported lengths, got 1e-200"),
        ("sphere(r: 0)", "`r` must be above 0, got 0"),
        ("sphere(r: sqrt(-1))", "`sqrt` of -1 isn't a number"),
        ("render(size: [0, 10])", "`size` must be from 1 to 65536, got [0, 10]"),
        ("render(size: [1e9, 1e9])", "`size` must be from 1 to 65536, got [1000000000, 1000000000]"),
        ("render(size: [60000, 60000])", "a picture has at most 268435456 pixels, this one has 3600000000"),
        ("sphere() |> scale(0)", "a factor of 0 leaves nothing"),
        ("sphere() |> scale(1e-100) |> scale(1e-100)", "this sphere is scaled beyond all measure"),
        ("sphere(r: 1e100) |> scale(1e100)", "this sphere is too large or too far away"),
        ("torus(r: 1, tube: 1)", "the `tube` of a torus must be smaller than its `r`"),
        ("triangle(points: [[0, 0, 0], [1, 1, 1], [2, 2, 2]])", "the corners of this triangle are on one line"),
        (
            "tetrahedron(points: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])",
            "the corners of this tetrahedron are in one plane",
        ),
        ("camera(from: [0, 0, 0])", "the camera looks at itself: `from` and `at` are the same point"),
        ("camera(from: [0, 5, 0])", "the camera looks along its `up` direction"),
        ("box(from: [0, 0, 0], to: [1, 0, 1])", "this box has no thickness along y"),
        ("sphere(mat: matte(image(\"nothing.png\")))", "can't read `nothing.png`: there is no such file"),
        ("sphere(mat: matte(image(\"../Cargo.toml\")))", "`../Cargo.toml` is outside the project"),
        ("sphere(at: [1, 2])", "`at` must be a point `[x, y, z]`, got a list of 2"),
    ] {
        assert_eq!(errors(text), [expected], "{text}");
    }
}

#[test]
fn runaway_programs_end_in_an_error() {
    let small = Limits { steps: 10_000, list_length: 1_000, objects: 1_000, instances: 1_000, ..Limits::default() };
    for (text, expected) in [
        ("while true { }", "the scene takes more than 10000 steps to make"),
        ("fn f(n) = f(n + 1)\nf(0)", "calls are nested more than 5000 deep"),
        ("fn f(n) = g(n)\nfn g(n) = f(n)\nf(0)", "calls are nested more than 5000 deep"),
        ("let a = [for i in 0..5000 { i }]", "this list has more than 1000 values"),
        ("for i in 0..5000 { sphere() }", "the scene makes more than 1000 shapes, lights and groups"),
        ("for i in 0..1e9 { }", "the scene takes more than 10000 steps to make"),
        (
            "fn d(s) = group { s; s |> move([1, 0, 0]) }\nlet a = d(d(d(d(d(d(d(d(d(d(sphere()))))))))))\na",
            "the scene has more than 1000 shapes and lights",
        ),
    ] {
        let f = evaluate_within(&request(text), small).unwrap_err();
        assert_eq!(f.diagnostics[0].message, expected, "{text}");
        assert!(!f.diagnostics[0].labels.is_empty());
    }
    for wrap in ["[x]", "[0, x, 0]", "record(a: x)", "() => x", "[for i in 0..1 { x }]", "0..1 |> map(i => y)"] {
        let text = format!("fn f() {{ var x = []; while true {{ let y = x; x = {wrap} }}; x }}\nlet a = f()");
        let found = errors(&text.replace("() => x", "() => y"));
        assert_eq!(found, ["the scene puts more than 1000000 lists, records and functions into others"], "{wrap}");
    }
    assert_eq!(errors(&"(".repeat(100_000)), ["brackets are nested more than 256 deep"]);
    assert_eq!(errors(""), ["the scene is empty"]);
    assert_eq!(errors("// nothing\n"), ["the scene is empty"]);
}

#[test]
fn the_deepest_allowed_nesting_fits_the_stack() {
    let brackets = format!("let a = {}1{}", "(".repeat(255), ")".repeat(255));
    assert!(evaluate(&request(&brackets)).is_ok());
    let sum = format!("let a = {}", vec!["1"; 990].join(" + "));
    let deep = format!(
        "{sum}\nfn f(n) {{ if n == 0 {{ 0 }} else {{ 1 + {} + f(n - 1) }} }}\nlet b = f(40)",
        vec!["1"; 900].join(" + ")
    );
    assert!(evaluate(&request(&deep)).is_ok());
    let deeper = deep.replace("f(40)", "f(400)");
    assert_eq!(errors(&deeper).len(), 1);
    assert!(evaluate(&request("fn f(n) { if n == 0 { 0 } else { 1 + f(n - 1) } }\nlet b = f(4000)")).is_ok());
}

#[test]
fn broken_text_has_a_place() {
    let mut r = request("");
    if let Input::Text { bytes, .. } = &mut r.main {
        *bytes = b"sphere()\nbox\xFF()".to_vec();
    }
    let f = evaluate(&r).unwrap_err();
    assert_eq!(f.diagnostics[0].message, "this file isn't UTF-8 text");
    assert_eq!(f.sources.location(f.diagnostics[0].labels[0].span), "test.scene:2:4");
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
        ("n", "50", "--set n=50:1:1 `50` parameter `n` must be from 1 to 9, got 50"),
        ("n", "2.5", "must be a whole number"),
        ("n", "(", "never closed"),
        ("tilt", "5", "parameter `tilt` is an angle"),
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

#[test]
fn long_chains_end_in_an_error() {
    let sum = vec!["1"; 20_000].join("+");
    assert_eq!(errors(&sum), ["this expression is nested more than 1000 deep"]);
    let minus = format!("{}1", "- ".repeat(20_000));
    assert_eq!(errors(&minus), ["this expression is nested more than 1000 deep"]);
    let power = vec!["1"; 20_000].join("^");
    assert_eq!(errors(&power), ["this expression is nested more than 1000 deep"]);
}

mod modules {
    use super::*;
    use std::fs;

    fn project(files: &[(&str, &str)]) -> tempfile::TempDir {
        let dir = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = dir.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        dir
    }

    fn run(dir: &tempfile::TempDir) -> Result<Evaluated, Failure> {
        let main = Input::File(dir.path().join("main.scene"));
        evaluate(&Request { main, set: Vec::new(), allow_read: Vec::new(), record_arguments: false })
    }

    fn messages(files: &[(&str, &str)]) -> Vec<String> {
        let dir = project(files);
        run(&dir).unwrap_err().diagnostics.into_iter().map(|d| d.message).collect()
    }

    #[test]
    fn have_their_own_scope_and_relative_paths() {
        let dir = project(&[
            (
                "main.scene",
                "import \"lib/tree.scene\" as tree\nimport \"lib/tree.scene\" { oak, trunk as t }\noak(2)\ntree.oak(t)\nlet size = 99",
            ),
            (
                "lib/tree.scene",
                "import \"leaf.scene\" { leaf }\nlet size = 3\nexport let trunk = size\nexport fn oak(n) = group { for i in 0..n { leaf(size) } }\nsphere()\ncamera()",
            ),
            ("lib/leaf.scene", "export fn leaf(r) = sphere(r: r)"),
        ]);
        let e = run(&dir).unwrap_or_else(|f| panic!("{}", shown(&f)));
        assert_eq!(e.scene.instance_count(), 5, "a module's own shapes aren't added");
        assert_eq!(e.files.len(), 4, "the same file is looked for twice: {:?}", e.files);
    }

    #[test]
    fn report_what_is_wrong() {
        let lib = ("lib.scene", "export let oak = 1\nlet ash = 2");
        assert_eq!(
            messages(&[("main.scene", "import \"lib.scene\" { oka }\noka"), lib]),
            ["the module exports no `oka`"]
        );
        assert_eq!(
            messages(&[("main.scene", "import \"lib.scene\" as l\nlet a = l.ash"), lib]),
            ["the module exports no `ash`"]
        );
        assert_eq!(
            messages(&[("main.scene", "import \"no.scene\" as l\nlet a = l.ash")]),
            ["can't read `no.scene`: there is no such file"]
        );
        let circle = messages(&[("main.scene", "import \"a.scene\" as a"), ("a.scene", "import \"main.scene\" as m")]);
        assert_eq!(circle, ["files import each other in a circle"]);
        let broken = messages(&[
            ("main.scene", "import \"a.scene\" as a\nlet x = a.f(1)"),
            ("a.scene", "export fn f(x) = x +\nexport let g = 1"),
        ]);
        assert_eq!(broken.len(), 1, "{broken:?}");
        assert_eq!(
            messages(&[("main.scene", "import \"../other.scene\" as a")])[0],
            "can't read `../other.scene`: there is no such file"
        );
    }

    #[test]
    fn a_missing_main_file_is_not_the_scene_s_fault() {
        let dir = project(&[]);
        let f = run(&dir).unwrap_err();
        assert!(f.main_unreadable);
    }
}

#[test]
fn syntax_errors_say_what_was_expected() {
    let mut wrong = Vec::new();
    for (text, expected) in [
        ("let x = 1 +* 2", "expected a value, found `*`"),
        ("let a = \"{1 + }\"", "expected a value, found `}`"),
        ("@", "expected a value, found `@`"),
        ("fn f(a b) = 1", "expected `:`, `,` or a closing `)`, found `b`"),
        ("sphere(r: 1 2)", "expected `,` or a closing `)`, found `2`"),
        ("sphere(at: [1 2 3])", "expected `,` or a closing `]`, found `2`"),
        ("for i 0..3 { }", "expected `in`, found `0`"),
        ("while true", "expected a block in `{ }`, found the end of the statement"),
        ("let a = (1 + ", "this `(` is never closed"),
        ("sphere(r = 1)", "a named argument is written with `:`"),
        ("x => ", "expected a value, but the statement ends here"),
        ("import tree", "expected a text in quotes, found `tree`"),
        ("let a == 2", "expected `=`, found `==`"),
        ("let a = b ? 1 : 2", "expected an operator or the end of the statement, found `?`"),
        ("sphere{}", "expected an operator or the end of the statement, found `{`"),
        ("let 1a = 2", "expected a name, found `1a`"),
        ("export 5", "expected `let` or `fn`, found `5`"),
        ("let if = 2", "`if` is a word of the language and can't be a name"),
        ("def f(x) = x", "`def` doesn't start a statement"),
        ("let a = 1 && 2", "`&&` isn't an operator"),
    ] {
        let found = errors(text);
        if found != [expected] {
            wrong.push((text, expected, found));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn deep_texts_are_read_without_backtracking() {
    // Each of these would take 2^200 steps in a grammar that tries an inner part twice.
    for (open, close) in [
        ("(", ")"),
        ("(a: ", ")"),
        ("[", "]"),
        ("f(", ")"),
        ("group(mat: ", ")"),
        ("{ ", " }"),
        ("(a => ", ")"),
        ("if ", " { }"),
    ] {
        let deep = format!("let v = {}1{}", open.repeat(200), close.repeat(200));
        let _ = evaluate(&request(&deep));
    }
    let chain = format!("let v = if true {{ 1 }} {} else {{ 2 }}", "else if false { 3 } ".repeat(20_000));
    assert!(evaluate(&request(&chain)).is_ok());
}
