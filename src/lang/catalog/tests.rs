//! The tables are complete and consistent, and the words do what they say.

use super::*;
use crate::lang::word::{Default, Run};
use crate::lang::{Input, Request, evaluate};
use crate::scene::{PatternId, PatternKind};

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
        ("log(0)", "`log` of 0 isn't a number"),
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
    ] {
        assert_eq!(value(expr), expected, "{expr}");
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
    let e =
        evaluate(&request("let p = brick(1, 0.5, size: [3, 1], gap: 0.2)\nlet q = noise(0, 2, octaves: 6, seed: 9)"));
    let patterns = e.map(|e| e.scene.patterns).unwrap_or_default();
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
