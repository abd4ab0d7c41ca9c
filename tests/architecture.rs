//! The floors of the house, checked: who may import whom, a heading in every file, no file too long to read. And the rule of
//! the kernels: no absolute constant.

use std::fs;
use std::path::{Path, PathBuf};

/// Folders of `src` from the ground up. A file imports from lower floors; `lang` and `render` share one and never meet.
const FLOORS: [(&str, u32); 8] =
    [("math", 0), ("diag", 0), ("scene", 1), ("film", 1), ("lang", 2), ("render", 2), ("verify", 3), ("app", 4)];

/// Folders that a folder doesn't know although they lie below it: what is verified are scenes, whoever made them.
const UNKNOWN: [(&str, &str); 1] = [("verify", "lang")];

/// Folders of one floor that may be used all the same: pictures are developed with the scene's colour formulas.
const SAME_FLOOR: [(&str, &str); 1] = [("film", "scene")];

/// Where the formulas of rays and shapes stand: files and folders of `src`. No constant of theirs may have a size, or they
/// would be right at one scale alone.
const KERNELS: [&str; 5] = ["render/shape/", "render/ray.rs", "render/frame.rs", "render/touch.rs", "math/real.rs"];

/// Numbers of this size and below count things: dimensions, coefficients, roundings.
const LARGEST_COUNT: f64 = 64.0;

/// A file longer than this holds more than one idea.
const MOST_LINES: usize = 400;

fn floor(folder: &str) -> Option<u32> {
    FLOORS.iter().find(|(name, _)| *name == folder).map(|(_, floor)| *floor)
}

fn allowed(from: &str, to: &str) -> bool {
    match (floor(from), floor(to)) {
        _ if from == to || SAME_FLOOR.contains(&(from, to)) => true,
        _ if UNKNOWN.contains(&(from, to)) => false,
        (Some(a), Some(b)) => b < a,
        _ => false,
    }
}

/// `text` with comments and the contents of string and character literals blanked out; line ends stay.
fn code_of(text: &str) -> String {
    let chars: Vec<char> = text.chars().collect();
    let at = |i: usize| chars.get(i).copied().unwrap_or('\0');
    let mut out = String::with_capacity(text.len());
    let mut i = 0;
    while i < chars.len() {
        let end = match at(i) {
            '/' if at(i + 1) == '/' => (i..chars.len()).find(|&k| at(k) == '\n').unwrap_or(chars.len()),
            '/' if at(i + 1) == '*' => end_of_block_comment(&chars, i),
            '"' => end_of_string(&chars, i),
            'r' if raw_hashes(&chars, i).is_some() => end_of_raw_string(&chars, i),
            '\'' if at(i + 1) == '\\' => (i + 3..chars.len()).find(|&k| at(k) == '\'').map_or(chars.len(), |k| k + 1),
            '\'' if at(i + 2) == '\'' => i + 3,
            c => {
                out.push(c);
                i += 1;
                continue;
            }
        };
        let end = end.min(chars.len());
        out.extend(chars[i..end].iter().map(|&c| if c == '\n' { '\n' } else { ' ' }));
        i = end;
    }
    out
}

fn end_of_block_comment(chars: &[char], start: usize) -> usize {
    let (mut depth, mut i) = (0, start);
    while i + 1 < chars.len() {
        match (chars[i], chars[i + 1]) {
            ('/', '*') => (depth, i) = (depth + 1, i + 2),
            ('*', '/') => (depth, i) = (depth - 1, i + 2),
            _ => i += 1,
        }
        if depth == 0 {
            return i;
        }
    }
    chars.len()
}

fn end_of_string(chars: &[char], start: usize) -> usize {
    let mut i = start + 1;
    while i < chars.len() && chars[i] != '"' {
        i += if chars[i] == '\\' { 2 } else { 1 };
    }
    i + 1
}

/// How many `#` the raw string has that starts at `i`; `None` if none starts there.
fn raw_hashes(chars: &[char], i: usize) -> Option<usize> {
    let in_a_word = i > 0 && (chars[i - 1] == '_' || chars[i - 1].is_alphanumeric() && chars[i - 1] != 'b');
    let hashes = chars[i + 1..].iter().take_while(|&&c| c == '#').count();
    (!in_a_word && chars.get(i + 1 + hashes) == Some(&'"')).then_some(hashes)
}

fn end_of_raw_string(chars: &[char], start: usize) -> usize {
    let hashes = raw_hashes(chars, start).unwrap_or(0);
    let close: Vec<char> = std::iter::once('"').chain(std::iter::repeat_n('#', hashes)).collect();
    let from = start + 2 + hashes;
    (from..chars.len()).find(|&k| chars[k..].starts_with(&close)).map_or(chars.len(), |k| k + close.len())
}

/// The folders that a file names, each with its line: by `crate::…`, and by `super::…` that reaches the crate's root.
/// `path` is relative to `src`, with `/`.
fn folders_used(path: &str, text: &str) -> Vec<(usize, String)> {
    let code = code_of(text);
    // As many `super` lead from the file to the root, and one more from a module inside it (tests).
    let depth = path.trim_end_matches(".rs").trim_end_matches("/mod").split('/').count();
    let mut used = Vec::new();
    for start in ["crate::", "super::"] {
        for (i, _) in code.match_indices(start) {
            // Not within a longer name, and a chain of `super` only from its beginning.
            if code[..i].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':') {
                continue;
            }
            let mut tree = &code[i + start.len()..];
            let mut ups = 1;
            while let Some(rest) = tree.strip_prefix("super::") {
                (tree, ups) = (rest, ups + 1);
            }
            if start == "crate::" || ups == depth || ups == depth + 1 {
                let line = code[..i].matches('\n').count() + 1;
                used.extend(first_names(tree).into_iter().map(|name| (line, name)));
            }
        }
    }
    used.retain(|(_, name)| floor(name).is_some());
    used
}

/// The first names of a use tree: `a::b` gives a; `{a::b, c}` gives a and c.
fn first_names(tree: &str) -> Vec<String> {
    let word = |s: &str| s.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let Some(list) = tree.strip_prefix('{') else {
        return vec![word(tree)];
    };
    let mut names = vec![word(list)];
    let mut depth = 0;
    for (i, c) in list.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => names.push(word(&list[i + 1..])),
            _ => {}
        }
    }
    names
}

/// The float literals of a kernel that aren't small whole numbers or their halves, each with its line. Tests at the end of
/// the file may have any.
fn absolute_constants(text: &str) -> Vec<(usize, String)> {
    let code = code_of(text);
    let code = code.split("#[cfg(test)]").next().unwrap_or("");
    let mut found = Vec::new();
    let mut before = ' ';
    let mut rest = code;
    while let Some(c) = rest.chars().next() {
        let starts = c.is_ascii_digit() && !(before.is_alphanumeric() || before == '_');
        let length = if starts { literal_length(rest, before) } else { c.len_utf8() };
        let (word, after) = rest.split_at(length);
        if starts && !is_count(word) {
            found.push((code[..code.len() - rest.len()].matches('\n').count() + 1, word.to_owned()));
        }
        before = word.chars().next_back().unwrap_or(' ');
        rest = after;
    }
    found
}

/// How many bytes the number has that `text` starts with. After a dot it is a field's, with none of its own.
fn literal_length(text: &str, before: char) -> usize {
    let bytes = text.as_bytes();
    let digit = |i: usize| bytes.get(i).is_some_and(|b| b.is_ascii_alphanumeric() || *b == b'_');
    let mut i = 0;
    let exponent = |i: usize| matches!(bytes[i - 1], b'e' | b'E') && !text.starts_with("0x");
    while digit(i) || (i > 0 && matches!(bytes.get(i), Some(b'+' | b'-')) && exponent(i)) {
        i += 1;
    }
    // `1.0`, but not `1..2` or `1.max(2)`.
    let fraction =
        bytes.get(i) == Some(&b'.') && bytes.get(i + 1).is_none_or(|b| !b.is_ascii_alphabetic() && *b != b'.');
    if before == '.' || !fraction {
        return i;
    }
    i += 1;
    while digit(i) || (matches!(bytes.get(i), Some(b'+' | b'-')) && exponent(i)) {
        i += 1;
    }
    i
}

/// Whether a literal is no float, or one that counts: whole or a half, written without an exponent, and small.
fn is_count(literal: &str) -> bool {
    let radix = ["0x", "0b", "0o"].iter().any(|p| literal.starts_with(p));
    let plain = literal.replace('_', "");
    let digits = plain.trim_end_matches("f64").trim_end_matches("f32");
    let is_float = !radix && (digits.len() < plain.len() || digits.contains(['.', 'e', 'E']));
    let counts = |x: f64| x <= LARGEST_COUNT && (2.0 * x).fract() == 0.0;
    !is_float || (!digits.contains(['e', 'E']) && digits.parse().is_ok_and(counts))
}

/// What is wrong with one file; empty if nothing is.
fn faults(path: &str, text: &str) -> Vec<String> {
    let mut faults = Vec::new();
    if !text.starts_with("//!") {
        faults.push(format!("{path}: doesn't open with `//!`: what it is and why"));
    }
    let lines = text.lines().count();
    if lines > MOST_LINES {
        faults.push(format!("{path}: {lines} lines; split it by idea"));
    }
    if KERNELS.iter().any(|k| path == *k || (k.ends_with('/') && path.starts_with(k))) {
        for (line, constant) in absolute_constants(text) {
            faults.push(format!("{path}:{line}: `{constant}` in a kernel: no absolute constants"));
        }
    }
    let Some((folder, _)) = path.split_once('/') else {
        return faults; // lib.rs and main.rs stand above all floors
    };
    if floor(folder).is_none() {
        faults.push(format!("{path}: the folder `{folder}` has no floor"));
    }
    for (line, to) in folders_used(path, text) {
        if !allowed(folder, &to) {
            faults.push(format!("{path}:{line}: `{folder}` must not know `{to}`"));
        }
    }
    faults
}

fn rust_files(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, into);
        } else if path.extension().is_some_and(|e| e == "rs") {
            into.push(path);
        }
    }
}

#[test]
fn the_house_stands() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&src, &mut files);
    assert!(files.len() > 20, "the sources were found");
    let mut all = Vec::new();
    for file in &files {
        let name = file.strip_prefix(&src).unwrap().to_str().unwrap().replace('\\', "/");
        all.extend(faults(&name, &fs::read_to_string(file).unwrap()));
    }
    assert!(all.is_empty(), "\n{}", all.join("\n"));
}

#[test]
fn violations_are_found() {
    let found = |path: &str, code: &str| faults(path, &format!("//! Heading.\n{code}\n"));
    for (path, code) in [
        ("lang/a.rs", "use crate::render::World;"),
        ("render/shape/a.rs", "use crate::{math::Affine, lang};"),
        ("math/a.rs", "use crate::scene::Color;"),
        ("math/a.rs", "use crate::diag::Span;"),
        ("scene/a.rs", "fn f() -> crate::film::Film {}"),
        ("film/a.rs", "use super::super::render;"),
        ("film/mod.rs", "use super::lang::evaluate;"),
        ("film/a.rs", "mod tests { use super::super::super::app; }"),
        ("render/a.rs", "use crate::{math::{Affine, Real}, app::run};"),
        ("verify/a.rs", "use crate::lang::evaluate;"),
        ("render/a.rs", "use crate::verify;"),
        ("cellar/a.rs", ""),
        ("lang/a.rs", "/* \" */ use crate::render;"),
        ("lang/a.rs", "let c = '\"'; use crate::render;"),
        ("math/a.rs", &"\n".repeat(MOST_LINES)),
        ("render/shape/a.rs", "const EPSILON: f64 = 1e-9;"),
        ("render/shape/a.rs", "let x = 1.0e+3;"),
        ("render/touch.rs", "let x = R::splat(0.001);"),
        ("render/frame.rs", "let x = 65.0;"),
        ("render/ray.rs", "let x = t.0+0.25;"),
        ("math/real.rs", "let x = 1_0e5f64;"),
        ("math/real.rs", "let x = 1000f32;"),
        ("math/real.rs", "let x = [1.0,.5,2.0, 3.25];"),
    ] {
        assert_eq!(found(path, code).len(), 1, "{path}: {code}");
    }
    assert_eq!(faults("math/a.rs", "use std::fmt;\n").len(), 1, "no heading");
    for (path, code) in [
        ("film/a.rs", "use crate::scene::color::decode_srgb;"),
        ("app/a.rs", "use crate::{lang, render::World};"),
        ("app/a.rs", "use crate::verify::picture;"),
        ("verify/a.rs", "use crate::{render::World, film::Film, math::Affine};"),
        ("lang/a/b.rs", "use super::super::value::Value; use super::lang; use crate::lang::parse;"),
        ("lang/a.rs", "// crate::render\n/* crate::render /* nested */ crate::app */ let s = \"crate::render\";"),
        ("lang/a.rs", "let s = r#\"\" crate::render::World\"#; let c = ['\"', '\\'', '/']; let x: &'static str;"),
        ("main.rs", "use crate::app;"),
        ("math/a.rs", "let x = 1e-9;"),
        ("render/shape/a.rs", "let x = 64.0 * f64::EPSILON + 0.5 + 2. - 1.5_f64; // 1e-9"),
        ("render/shape/a.rs", "let k = 1_000_000 + 0x1e9 + v.0.1 + x1e5; for i in 0..100 { 300.max(i) }"),
        ("render/shape/a.rs", "#[cfg(test)]\nmod tests { const NEAR: f64 = 1e-9; }"),
    ] {
        assert_eq!(found(path, code), Vec::<String>::new(), "{path}: {code}");
    }
}
