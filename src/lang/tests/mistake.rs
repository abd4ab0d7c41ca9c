//! Messages of single mistakes; tests/errors holds whole ones.

use super::*;

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
        ("sphere(r: sqrt(-1))", "-1 has no square root"),
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
fn syntax_errors_say_what_was_expected() {
    let mut wrong = Vec::new();
    for (text, expected) in [
        ("let x = 1 +* 2", "expected a value, found `*`"),
        ("let a = \"{1 + }\"", "expected a value, found `}`"),
        ("@", "`@` isn't a sign of the language"),
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
        ("let a = b ? 1 : 2", "`?` isn't an operator"),
        ("sphere{}", "`sphere` doesn't take a block"),
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
