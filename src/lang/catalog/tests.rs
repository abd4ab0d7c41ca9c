//! The tables are complete and consistent, and the words do what they say.

use super::*;
use crate::lang::limits::Limits;
use crate::lang::word::{Default, Run};
use crate::lang::{Input, Request, evaluate, evaluate_within};
use crate::scene::{NodeKind, PatternId, PatternKind, Shape};

fn request(text: &str) -> Request {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples").into();
    let main = Input::Text { name: "test.scene".into(), bytes: text.as_bytes().to_vec(), folder };
    Request { main, set: Vec::new(), allow_read: Vec::new(), record_arguments: false }
}

/// What an expression is, as text; its message, if it has none.
fn value(expr: &str) -> String {
    match evaluate(&request(&format!("param p: \"{{{expr}}}\""))) {
        Ok(e) => e.params[0].value.trim_matches('"').to_owned(),
        Err(f) => f.diagnostics[0].message.clone(),
    }
}

/// The message of a wrong scene.
fn error(text: &str) -> String {
    evaluate(&request(text)).map_or_else(|f| f.diagnostics[0].message.clone(), |_| "no error".into())
}

#[test]
fn every_word_is_documented_once() {
    assert_eq!(tables().ids.len(), catalog().len(), "a word stands twice");
    for w in catalog() {
        assert!(w.doc.ends_with('.') && w.doc.len() > 5, "{}: {}", w.name, w.doc);
        assert!(!w.example.is_empty(), "{} has no example", w.name);
        assert!(w.example.contains(w.name), "{}'s example doesn't show it", w.name);
        for p in w.params {
            assert!(!p.doc.is_empty(), "{}.{}", w.name, p.name);
        }
    }
}

#[test]
fn parameters_follow_the_rules() {
    for w in catalog() {
        let positional: Vec<bool> = w.params.iter().map(|p| p.positional).collect();
        assert!(positional.is_sorted_by(|a, b| a >= b), "{}: what goes by position comes first", w.name);
        assert!(w.params.iter().rev().skip(1).all(|p| !p.rest), "{}: rest is last", w.name);
        if let Run::Constant(_) = w.run {
            assert!(w.params.is_empty());
        }
        assert!(w.params.iter().all(|p| p.default != Default::Required || p.positional), "{}", w.name);
    }
}

#[test]
fn words_compute() {
    for (expr, expected) in [
        // angles: exact where they can be
        ("asin(0.5)", "30deg"),
        ("acos(-0.5)", "120deg"),
        ("atan(1)", "45deg"),
        ("atan2(-1, -1)", "-135deg"),
        ("tan(2 * atan(0.25) / 2)", "0.25"),
        ("asin(1.5)", "`x` must be from -1 to 1, got 1.5"),
        ("tan(90deg)", "the tangent of 90deg is infinite"),
        ("90deg / 1deg", "90"),
        // numbers
        ("[sign(-3), sign(0), sign(0.1)]", "[-1, 0, 1]"),
        ("[floor(-1.5), ceil(-1.5), round(-1.5)]", "[-2, -1, -2]"),
        ("[sqrt(9), cbrt(-27), hypot(3, 4)]", "[3, -3, 5]"),
        ("[log2(8), log10(1000), log(e)]", "[3, 3, 1]"),
        ("log(0)", "0 has no logarithm"),
        ("pow(2, 10)", "1024"),
        ("pow(-1, 0.5)", "-1 ^ 0.5 isn't a number"),
        ("[clamp(5, 0, 1), clamp(-5, 0, 1), clamp(0.5, 0, 1)]", "[1, 0, 0.5]"),
        ("[smoothstep(0, 1, -1), smoothstep(0, 1, 0.5), smoothstep(2, 4, 9)]", "[0, 0.5, 1]"),
        ("smoothstep(1, 1, 0)", "`low` must be below `high`"),
        ("lerp(10deg, 20deg, 0.5)", "15deg"),
        ("lerp([0, 0], [2, 4], 0.5)", "[1, 2]"),
        ("tau / pi", "2"),
        // vectors
        ("[length([0, 3, 4]), distance([1, 1, 1], [1, 1, 3]), dot([1, 2, 3], [1, 1, 1])]", "[5, 2, 6]"),
        ("cross([0, 1, 0], [0, 0, 1])", "[1, 0, 0]"),
        ("normalize([0, 0, -3])", "[0, 0, -1]"),
        ("normalize([0, 0, 0])", "`v` has no direction: it is [0, 0, 0]"),
        ("length([1e140, 0, 0])", "1e140"),
        // colors
        ("rebeccapurple == #663399", "true"),
        ("hsv(120deg, 1, 1) == lime", "true"),
        ("oklch(1, 0, 0deg).r > 0.99999", "true"),
        ("oklch(0.7, 1, 140deg).r >= 0", "true"),
        ("mix(black, linear(1, 0.5, 0), 0.5)", "linear(0.5, 0.25, 0)"),
        ("mix(1, 3, 0.25)", "1.5"),
        ("mix(0, linear(1), linear(0.1, 0.2, 0.3))", "linear(0.1, 0.2, 0.3)"),
        ("blend([1, 2, 5], by: 0.75)", "3.5"),
        ("blend([1, 2], by: 7)", "2"),
        ("blend([black, 1], by: 0.5)", "linear(0.5, 0.5, 0.5)"),
        ("blend([1], by: 0)", "`stops` must be a list of at least two numbers, colors or patterns, got a list of 1"),
        // lists
        ("[len([]), len(0..5), len(\"größe\"), len(record(a: 1))]", "[0, 5, 5, 1]"),
        ("0..6 |> filter(x => x % 2 == 0) |> map(x => x * x)", "[0, 4, 16]"),
        ("filter([1], x => x)", "the function must give true or false, got a number"),
        ("fold(1..=5, 1, (a, b) => a * b)", "120"),
        ("fold([3, 9, 2], 0, max)", "9"),
        ("[sum([]), sum(1..=4), sum([0.5, 0.25])]", "[0, 10, 0.75]"),
        ("sum([[1, 2, 3], [1, 1, 1]])", "[2, 3, 4]"),
        ("steps(0deg, 90deg, 3)", "[0deg, 45deg, 90deg]"),
        ("steps(1, 2, 1)", "`n` must be from 2 to 10000000, got 1"),
        ("zip(0..2, [red, blue])[1][1] == blue", "true"),
        ("zip([1], [1, 2])", "lists of 1 and of 2 have no pairs"),
        ("enumerate([7, 8])", "[[0, 7], [1, 8]]"),
        ("sort([3, -1, 2.5])", "[-1, 2.5, 3]"),
        ("sort([[0, 2], [1, 1]], by: p => p[1])", "[[1, 1], [0, 2]]"),
        ("sort([2, 30deg])", "`sort` can't order a number and an angle"),
        ("sort([red])", "`sort` can't order a color"),
        ("reverse(0..3)", "[2, 1, 0]"),
        ("concat([1], 5..7, [])", "[1, 5, 6]"),
        ("slice([1, 2, 3, 4], 2)", "[3, 4]"),
        ("slice([1, 2], 1, 3)", "the list has 2 values, `to` is beyond them"),
        ("slice([1, 2], 2, 1)", "`from` is after the end of the slice"),
        ("[first(3..9), last(3..9)]", "[3, 8]"),
        ("last([])", "the list is empty"),
        ("[contains(0..3, 2), contains([red], blue), contains(\"marble\", \"arb\")]", "[true, false, true]"),
        ("join([1, \"a\", true], by: \"-\")", "1-a-true"),
        // random: pinned, for it belongs to the language's edition
        ("rand(1) == rand(1) and rand(1) != rand(2)", "true"),
        ("contains(0..3, pick(0..3, 7))", "true"),
        ("pick([], 7)", "the list is empty"),
        ("sort(shuffle(0..9, 1))", "[0, 1, 2, 3, 4, 5, 6, 7, 8]"),
        ("shuffle(0..9, 1) == shuffle(0..9, 2)", "false"),
        ("abs(length(on_sphere(4)) - 1) < 1e-12", "true"),
        ("length(in_sphere(4)) < 1", "true"),
        ("in_box([1, 2, 3], [1, 2, 3], 5)", "[1, 2, 3]"),
        ("rand(sin)", "a function can't be a key of something random"),
        ("noise_at([0, 0, 0], octaves: 1)", "0.5"),
        ("scatter([1, 2, 3], [1, 2, 3], 1)", "[[1, 2, 3]]"),
        ("scatter([0, 0, 0], [1e30, 0, 0], 1)", "`distance` is too small for this region"),
    ] {
        assert_eq!(value(expr), expected, "{expr}");
    }
}

#[test]
fn scattered_points_keep_their_distance_and_leave_no_gap() {
    let e = evaluate(&request("for p in scatter([-5, 0, -4], [5, 0, 4], 0.5, key: 3) { sphere(at: p) }"));
    let nodes = e.map(|e| e.scene.nodes).unwrap_or_default();
    let points: Vec<glam::DVec3> = nodes
        .iter()
        .filter_map(|n| match n.kind {
            NodeKind::Shape(Shape::Sphere { at, .. }) => Some(at),
            _ => None,
        })
        .collect();
    assert!(points.iter().all(|p| p.x.abs() <= 5.0 && p.y == 0.0 && p.z.abs() <= 4.0));
    for (i, p) in points.iter().enumerate() {
        assert!(points[..i].iter().all(|q| p.distance(*q) >= 0.5));
        // One at twice the distance would have been found.
        assert!(points.iter().any(|q| p != q && p.distance(*q) < 1.0));
    }
    // Random discs that leave room for no other cover 55 % of a plane (Rényi): 223 here, and some more at the border.
    assert!((180..260).contains(&points.len()), "{}", points.len());
}

#[test]
fn values_made_by_words_use_up_the_budgets_too() {
    let deep = "fn f() { var x = [1]; while true { x = enumerate(x) }; x }\nlet a = f()";
    assert_eq!(error(deep), "the scene puts more than 1000000 lists, records and functions into others");
    let small = Limits { steps: 10_000, list_length: 1_000, ..Limits::default() };
    for (text, expected) in [
        ("let a = map(0..1e12, x => x)", "this list has more than 1000 values"),
        ("let a = concat(0..900, 0..900)", "this list has more than 1000 values"),
        ("let a = sum(0..1e12)", "the scene takes more than 10000 steps to make"),
        ("let a = scatter([0, 0, 0], [1, 1, 1], 1e-9)", "the scene takes more than 10000 steps to make"),
    ] {
        let message = evaluate_within(&request(text), small).map_err(|f| f.diagnostics[0].message.clone());
        assert_eq!(message.err().as_deref(), Some(expected), "{text}");
    }
}

#[test]
fn patterns_are_of_numbers_unless_colors_come_in() {
    for p in [
        "gradient()",
        "noise()",
        "cells()",
        "rings(0, 1)",
        "brick(1, 0)",
        "mix(0, 1, noise())",
        "blend([0, 1, 0], by: cells())",
    ] {
        assert_eq!(error(&format!("sphere(mat: phong(bump: {p}))")), "no error");
        let message = error(&format!("sphere(mat: phong(color: {p}))"));
        assert_eq!(message, "`color` must be a color or a pattern of colors, got a pattern of numbers", "{p}");
    }
    for p in ["gradient(red, blue)", "noise(red, noise())", "mix(0, 1, checker(red, blue))", "rings(0, red)"] {
        assert_eq!(error(&format!("sphere(mat: matte({p} |> scale(2) |> turbulence(0.3)))")), "no error", "{p}");
    }
}

#[test]
fn patterns_keep_their_arguments() {
    let text = "let p = brick(1, 0.5, size: [3, 1], gap: 0.2)\nlet q = noise(0, 2, octaves: 6, seed: 9)\n\
        sphere(mat: phong(reflect: p, bump: q))";
    let patterns = evaluate(&request(text)).map(|e| e.scene.patterns).unwrap_or_default();
    let red = |id: PatternId| match patterns[id.0 as usize].kind {
        PatternKind::Constant(c) => c.0[0],
        _ => f64::NAN,
    };
    assert!(patterns.iter().any(|p| match p.kind {
        PatternKind::Brick { mortar, brick, size, gap } =>
            (red(mortar), red(brick), size, gap) == (0.5, 1.0, [3.0, 1.0], 0.2),
        _ => false,
    }));
    assert!(patterns.iter().any(|p| match p.kind {
        PatternKind::Noise { a, b, octaves, seed } => (red(a), red(b), octaves, seed) == (0.0, 2.0, 6, 9),
        _ => false,
    }));
}

#[test]
fn patterns_of_patterns_have_a_limit() {
    let grown =
        |n: u32| format!("var p = noise()\nfor i in 0..{n} {{ p = mix(p, p, p) }}\nsphere(mat: phong(reflect: p))");
    assert_eq!(error(&grown(8)), "no error");
    assert_eq!(error(&grown(12)), "this pattern is made of more than 100000 patterns");
}
