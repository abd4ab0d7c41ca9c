//! Texts that mean harm: endless programs, deep nesting, long lines, damaged pictures, ways out of the project.

use super::*;
use crate::diag::{Look, print};
use std::fs;
use std::path::Path;

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
fn long_chains_end_in_an_error() {
    let sum = vec!["1"; 20_000].join("+");
    assert_eq!(errors(&sum), ["this expression is nested more than 1000 deep"]);
    let minus = format!("{}1", "- ".repeat(20_000));
    assert_eq!(errors(&minus), ["this expression is nested more than 1000 deep"]);
    let power = vec!["1"; 20_000].join("^");
    assert_eq!(errors(&power), ["this expression is nested more than 1000 deep"]);
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

/// Whatever the text, evaluation ends in a scene or in printable messages.
fn ends(text: &str) {
    if let Err(f) = evaluate(&request(text)) {
        assert!(!f.diagnostics.is_empty());
        assert!(print(&f.diagnostics, &f.sources, Look::Plain).len() < 200_000);
    }
}

#[test]
fn a_hundred_thousand_of_anything_ends() {
    const N: usize = 100_000;
    for open in
        ["(", "[", "{", "\"{", "f(", "sphere(at: [", "group { ", "if true { ", "for i in 0..1 { ", "(x) => ", "x => "]
    {
        ends(&open.repeat(N));
        ends(&format!("let a = {}", open.repeat(N)));
    }
    for (open, close) in [("(", ")"), ("[", "]"), ("{", "}"), ("\"{", "}\""), ("if true { ", " }"), ("group { ", " }")]
    {
        ends(&format!("let a = {}1{}", open.repeat(N), close.repeat(N)));
    }
    for prefix in
        ["-", "- ", "not ", "if ", "let ", "not -", "..", "/*", "1 + ", "export ", "#", "\\", ".5", "a.", "a[0]."]
    {
        ends(&format!("{}1", prefix.repeat(N)));
        ends(&format!("let a = {}1", prefix.repeat(N)));
    }
    for link in [" |> move([0, 0, 0])", " + 1", " ^ 2", " .. 1", " and true", "(1)", "[0]", ".x", " == 1"] {
        ends(&format!("let a = 1{}", link.repeat(N)));
    }
    for line in ["}\n", ")\n", "{\n", "\"\n", "let a = 1\n", "lett a = 1\n", "a b\n", "sphere(\n", "else\n", "|> f\n"] {
        ends(&line.repeat(N));
    }
}

#[test]
fn long_lines_and_long_files_end() {
    ends(&format!("let a = [{}]", "1, ".repeat(300_000)));
    ends(&format!("sphere(name: \"{}\")", "x".repeat(1_000_000)));
    ends(&format!("sphere({} r: 1)", " ".repeat(1_000_000)));
    ends(&"x".repeat(1_000_000));
    ends(&"9".repeat(1_000_000));
    ends(&"\u{1F300}".repeat(250_000));
    ends(&"// a line of ten megabytes of comment\n".repeat(270_000));
    ends(&format!("fn f() {{\n{}}}", "  let x = 1 2\n".repeat(20_000)));
    ends(&format!("let x = 1 2\n{}", "sphere(r: 0.5)\n".repeat(100_000)));
}

/// A scene that shows the picture `name` of `folder`.
fn shows(folder: &Path, name: &str, allow_read: &[&Path]) -> Result<Evaluated, Failure> {
    let text = format!("sphere(mat: matte(image(\"{name}\")))");
    let main = Input::Text { name: "test.scene".into(), bytes: text.into_bytes(), folder: folder.to_owned() };
    let allow_read = allow_read.iter().map(|p| p.to_path_buf()).collect();
    evaluate(&Request { main, set: Vec::new(), allow_read, record_arguments: false })
}

#[test]
fn damaged_pictures_are_refused_or_shown() {
    let dir = tempfile::tempdir().unwrap();
    let picture = image::RgbImage::from_fn(9, 7, |x, y| image::Rgb([x as u8 * 20, y as u8 * 30, 99]));
    picture.save(dir.path().join("good.png")).unwrap();
    picture.save(dir.path().join("good.jpg")).unwrap();
    image::DynamicImage::from(picture.clone()).to_luma8().save(dir.path().join("gray.png")).unwrap();
    fs::write(dir.path().join("good.ppm"), [&b"P6 9 7 255\n"[..], &picture.as_raw()[..]].concat()).unwrap();
    for name in ["good.png", "gray.png", "good.jpg", "good.ppm"] {
        assert!(shows(dir.path(), name, &[]).is_ok());
        let bytes = fs::read(dir.path().join(name)).unwrap();
        let mut refused = 0;
        let cut = (0..bytes.len()).step_by(7).map(|n| bytes[..n].to_vec());
        let flipped = (0..bytes.len()).step_by(5).map(|n| {
            let mut bytes = bytes.clone();
            bytes[n] ^= 1 << (n % 8);
            bytes
        });
        let doubled = (0..bytes.len()).step_by(31).map(|n| [&bytes[..n], &bytes[..]].concat());
        for bad in cut.chain(flipped).chain(doubled) {
            fs::write(dir.path().join("bad"), &bad).unwrap();
            if let Err(f) = shows(dir.path(), "bad", &[]) {
                refused += 1;
                assert_eq!(f.diagnostics.len(), 1);
                assert!(f.diagnostics[0].message.starts_with("can't show `bad`: "), "{}", f.diagnostics[0].message);
            }
        }
        assert!(refused > bytes.len() / 10, "{name}: {refused}");
    }
}

#[test]
fn nothing_outside_the_project_is_read() {
    let dir = tempfile::tempdir().unwrap();
    let (inside, outside) = (dir.path().join("project"), dir.path().join("other"));
    fs::create_dir_all(inside.join("sub")).unwrap();
    fs::create_dir_all(&outside).unwrap();
    image::RgbImage::new(2, 2).save(outside.join("secret.png")).unwrap();
    image::RgbImage::new(2, 2).save(inside.join("own.png")).unwrap();
    let refused = |name: &str, allow: &[&Path]| {
        let f = shows(&inside, name, allow).unwrap_err();
        assert_eq!(f.diagnostics[0].message, format!("`{name}` is outside the project"));
    };
    let absolute = outside.join("secret.png").display().to_string();
    refused("../other/secret.png", &[]);
    refused("sub/../../other/secret.png", &[]);
    refused(&absolute, &[]);
    refused("../other/secret.png", &[&inside.join("sub")]);
    assert!(shows(&inside, "sub/../own.png", &[]).is_ok(), "`..` within the project is no escape");
    assert!(shows(&inside, "../other/secret.png", &[&outside]).is_ok());
    assert!(shows(&inside, &absolute, &[&outside]).is_ok());
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(outside.join("secret.png"), inside.join("link.png")).unwrap();
        std::os::unix::fs::symlink(&outside, inside.join("folder")).unwrap();
        std::os::unix::fs::symlink(inside.join("own.png"), inside.join("alias.png")).unwrap();
        refused("link.png", &[]);
        refused("folder/secret.png", &[]);
        assert!(shows(&inside, "alias.png", &[]).is_ok());
        assert!(shows(&inside, "link.png", &[&outside]).is_ok());
    }
}
