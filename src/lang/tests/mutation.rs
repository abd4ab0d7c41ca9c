//! Every example and every wrong scene of `tests/errors`, damaged in thousands of seeded ways: whatever the text,
//! evaluation ends, and ends in a scene or in messages that can be printed. `RTDSL_MUTATIONS=N` damages N times.

use crate::diag::{Look, print};
use crate::lang::limits::Limits;
use crate::lang::*;
use std::fs;
use std::path::{Path, PathBuf};

/// A few seconds' worth.
const MUTATIONS: u64 = 4_000;

/// Small budgets, so that a runaway mutant is caught at once.
fn small() -> Limits {
    Limits {
        steps: 100_000,
        list_length: 20_000,
        containers: 50_000,
        text_length: 20_000,
        text_total: 1 << 20,
        objects: 20_000,
        instances: 100_000,
        image_texels: 1 << 20,
        ..Limits::default()
    }
}

/// What number literals are replaced by: limits of ranges, and what makes infinities and not-a-numbers of them.
const NUMBERS: [&str; 14] = [
    "0",
    "-1",
    "1e999",
    "1e-200",
    "1e308",
    "(0/0)",
    "sqrt(-1)",
    "1e140",
    "1e-140",
    "0.5",
    "9007199254740993",
    "90deg",
    "1e9",
    "none",
];

/// What is put where nothing should be.
const TOKENS: [&str; 24] = [
    "(", ")", "[", "]", "{", "}", "\"", ",", ";", "\n", "=", "=>", "|>", "..", "/*", "//", "let ", "if ", "for ",
    "fn ", "-", "not ", "é", "\u{0}",
];

struct Dice(u64);

impl Dice {
    fn roll(&mut self, n: usize) -> usize {
        // SplitMix64, after Steele, Lea and Flood 2014.
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % n.max(1) as u64) as usize
    }
    fn pick<'a, T: ?Sized>(&mut self, of: &[&'a T]) -> &'a T {
        of[self.roll(of.len())]
    }
    /// A part of `0..n`.
    fn part(&mut self, n: usize, longest: usize) -> std::ops::Range<usize> {
        let start = self.roll(n + 1);
        start..(start + self.roll(longest)).min(n)
    }
}

/// The ranges of words, numbers, blanks and single signs.
fn tokens(bytes: &[u8]) -> Vec<std::ops::Range<usize>> {
    let class = |b: u8| match b {
        b'0'..=b'9' | b'.' => 1,
        b'a'..=b'z' | b'A'..=b'Z' | b'_' | 0x80.. => 2,
        b' ' => 3,
        _ => 0,
    };
    let mut out: Vec<std::ops::Range<usize>> = Vec::new();
    for (i, b) in bytes.iter().enumerate() {
        match out.last_mut() {
            Some(last) if class(*b) != 0 && class(bytes[last.start]) == class(*b) => last.end = i + 1,
            _ => out.push(i..i + 1),
        }
    }
    out
}

fn damage(text: &mut Vec<u8>, dice: &mut Dice) {
    let tokens = tokens(text);
    let any = |dice: &mut Dice| tokens.get(dice.roll(tokens.len())).cloned().unwrap_or(0..0);
    match dice.roll(10) {
        0 => drop(text.drain(dice.part(text.len(), 4))),
        1 => {
            let at = dice.roll(text.len() + 1);
            text.insert(at, dice.roll(256) as u8);
        }
        2 => drop(text.drain(any(dice))),
        3 => {
            let (copy, to) = (text[any(dice)].to_vec(), any(dice).start);
            drop(text.splice(to..to, copy));
        }
        4 => {
            let (a, b) = (any(dice), any(dice));
            let copy = text[a].to_vec();
            drop(text.splice(b, copy));
        }
        5 | 6 => {
            let numbers: Vec<_> = tokens.iter().filter(|t| text[t.start].is_ascii_digit()).cloned().collect();
            if let Some(at) = numbers.get(dice.roll(numbers.len())) {
                drop(text.splice(at.clone(), dice.pick(&NUMBERS).bytes()));
            }
        }
        7 => {
            let at = any(dice).start;
            drop(text.splice(at..at, dice.pick(&TOKENS).bytes()));
        }
        8 => {
            let mut lines: Vec<Vec<u8>> = text.split(|b| *b == b'\n').map(<[u8]>::to_vec).collect();
            let (a, b) = (dice.roll(lines.len()), dice.roll(lines.len()));
            match dice.roll(3) {
                0 => lines.swap(a, b),
                1 => drop(lines.remove(a)),
                _ => lines.insert(b, lines[a].clone()),
            }
            *text = lines.join(&b'\n');
        }
        _ => text.truncate(dice.roll(text.len() + 1)),
    }
}

/// Evaluates a text, which must end well or in printable messages with places inside their texts.
fn check(bytes: &[u8], folder: &Path) {
    let main = Input::Text { name: "mutant.scene".into(), bytes: bytes.to_vec(), folder: folder.to_owned() };
    let request =
        Request { main, set: vec![("count".into(), "7".into())], allow_read: Vec::new(), record_arguments: false };
    let (diagnostics, sources) = match evaluate_within(&request, small()) {
        Ok(e) => (e.warnings, e.sources),
        Err(f) => {
            assert!(!f.diagnostics.is_empty(), "an error without a message");
            (f.diagnostics, f.sources)
        }
    };
    for d in &diagnostics {
        assert!(!d.message.is_empty());
        for l in &d.labels {
            let text = &sources.get(l.span.file).text;
            assert!(text.get(l.span.range()).is_some(), "{:?} is no part of {text:?}: {d:?}", l.span);
        }
    }
    print(&diagnostics, &sources, Look::Plain);
}

fn seeds() -> Vec<(PathBuf, Vec<u8>)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut out = Vec::new();
    for folder in ["examples", "tests/errors"] {
        for file in fs::read_dir(root.join(folder)).unwrap() {
            let path = file.unwrap().path();
            if path.extension().is_some_and(|e| e == "scene") {
                out.push((path.clone(), fs::read(path).unwrap()));
            }
        }
    }
    out.sort();
    out
}

#[test]
fn no_damage_makes_it_panic_or_hang() {
    let seeds = seeds();
    assert!(seeds.len() > 60);
    let count = std::env::var("RTDSL_MUTATIONS").ok().and_then(|n| n.parse().ok()).unwrap_or(MUTATIONS);
    for i in 0..count {
        let mut dice = Dice(i);
        let (path, bytes) = &seeds[dice.roll(seeds.len())];
        let mut text = bytes.clone();
        for _ in 0..=dice.roll(3) {
            damage(&mut text, &mut dice);
        }
        let folder = path.parent().unwrap_or(Path::new("."));
        let checked = std::panic::catch_unwind(|| check(&text, folder));
        assert!(checked.is_ok(), "mutant {i} of {}:\n{}", path.display(), String::from_utf8_lossy(&text));
    }
}
