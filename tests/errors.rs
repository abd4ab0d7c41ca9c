//! Wrong scenes with the exact messages that they are told: `tests/errors/NAME.scene` and `NAME.txt` beside it are the
//! specification of what the language says. `RTDSL_BLESS=1 cargo test --test errors` writes the messages anew; read every
//! line of the difference as the scene's author would.
//!
//! Lines `// --set NAME=VALUE` and `// --allow-read DIR` at the top of a scene are its command line.

use rtdsl::diag::{Look, print, summary};
use rtdsl::lang::{self, Input, Request};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Fewer would leave a kind of mistake out.
const LEAST: usize = 60;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/errors")
}

/// What is asked of the language for the scene `name`; the current folder is [`folder`].
fn request(name: &str, bytes: &[u8]) -> Request {
    let text = String::from_utf8_lossy(bytes);
    let options = |option: &str| {
        let lines = text.lines().map_while(|l| l.strip_prefix("// --"));
        let prefix = format!("{option} ");
        lines.filter_map(|l| l.strip_prefix(&prefix).map(str::to_owned)).collect::<Vec<_>>()
    };
    Request {
        main: Input::File(PathBuf::from(format!("{name}.scene"))),
        set: options("set").iter().filter_map(|s| s.split_once('=')).map(|(n, v)| (n.into(), v.into())).collect(),
        allow_read: options("allow-read").into_iter().map(PathBuf::from).collect(),
        record_arguments: false,
    }
}

/// What the author of the scene is told.
fn told(name: &str, bytes: &[u8]) -> String {
    match lang::evaluate(&request(name, bytes)) {
        Ok(e) => print(&e.warnings, &e.sources, Look::Plain),
        Err(f) => {
            assert!(!f.diagnostics.is_empty(), "{name}: an error without a message");
            format!("{}\n{}\n", print(&f.diagnostics, &f.sources, Look::Plain), summary(&f.diagnostics))
        }
    }
}

fn names(ending: &str) -> BTreeSet<String> {
    let files = fs::read_dir(folder()).unwrap().map(|f| f.unwrap().path());
    let wanted = files.filter(|p| p.extension().is_some_and(|e| e == ending));
    wanted.map(|p| p.file_stem().unwrap().to_str().unwrap().to_owned()).collect()
}

#[test]
fn every_message_is_as_written() {
    std::env::set_current_dir(folder()).unwrap();
    let bless = std::env::var_os("RTDSL_BLESS").is_some();
    let scenes = names("scene");
    assert!(scenes.len() >= LEAST, "only {} scenes", scenes.len());
    let mut wrong = Vec::new();
    for name in &scenes {
        let told = told(name, &fs::read(format!("{name}.scene")).unwrap());
        let file = format!("{name}.txt");
        if bless {
            fs::write(&file, &told).unwrap();
        }
        let expected = fs::read_to_string(&file).unwrap_or_default();
        if told != expected {
            wrong.push(format!("{name}\n--- expected\n{expected}--- found\n{told}"));
        }
    }
    assert!(wrong.is_empty(), "{} differ; RTDSL_BLESS=1 rewrites them\n\n{}", wrong.len(), wrong.join("\n"));
    let stray: Vec<_> = names("txt").difference(&scenes).cloned().collect();
    assert!(stray.is_empty(), "messages without a scene: {stray:?}");
}

/// A file that no scene names would seem to be tested.
#[test]
fn nothing_lies_about() {
    let mut files = Vec::new();
    for part in ["", "modules", "pictures"] {
        let here = fs::read_dir(folder().join(part)).unwrap().map(|f| f.unwrap().path());
        files.extend(here.filter(|p| p.is_file()));
    }
    let is_scene = |p: &PathBuf| p.extension().is_some_and(|e| e == "scene");
    let texts: String = files
        .iter()
        .filter(|p| is_scene(p))
        .map(|p| String::from_utf8_lossy(&fs::read(p).unwrap()).into_owned())
        .collect();
    for file in &files {
        let name = file.file_name().unwrap().to_str().unwrap();
        let beside = file.parent() == Some(&folder()) && (name.ends_with(".scene") || name.ends_with(".txt"));
        assert!(beside || texts.contains(name), "{} isn't used", file.display());
    }
}

/// Words of the program, not of the language.
const RUST: [&str; 16] = [
    "Option", "Vec", "None", "Some", "Err", "Ok", "panicked", "unwrap", "usize", "u32", "str", "String", "Value",
    "NaN", "inf", "pest",
];

#[test]
fn no_message_speaks_rust() {
    for name in names("txt") {
        let text = fs::read_to_string(folder().join(format!("{name}.txt"))).unwrap();
        // What the scene itself says doesn't count: excerpts stand after `|`.
        let own = text.lines().filter(|l| !l.contains(" | ") || l.trim_start().starts_with('|'));
        for line in own {
            for word in line.split(|c: char| !c.is_alphanumeric() && c != '_') {
                assert!(!RUST.contains(&word), "{name}: `{word}` in: {line}");
            }
        }
    }
}
