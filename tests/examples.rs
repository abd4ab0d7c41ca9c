//! The examples: every one evaluates without a complaint, says what it is, and makes a picture worth the name; and the
//! gallery has a picture of each.

use rtdsl::film::Film;
use rtdsl::lang::{Evaluated, Input, Request, evaluate};
use rtdsl::render::{Options, Silent, World, render};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// Small enough for some seconds all together, large enough to show that a picture isn't empty.
const WIDTH: u32 = 96;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples")
}

/// The scenes of a folder, in alphabetical order.
fn scenes(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("the folder can be read");
    let mut files: Vec<PathBuf> = entries.map(|e| e.expect("its entries can be read").path()).collect();
    files.retain(|f| f.extension().is_some_and(|e| e == "scene"));
    files.sort();
    files
}

fn name(file: &Path) -> String {
    file.file_stem().expect("a file has a name").to_string_lossy().into_owned()
}

fn text(file: &Path) -> String {
    std::fs::read_to_string(file).expect("an example can be read")
}

/// Evaluates a scene; fails with its messages.
fn evaluated(file: &Path, set: &[(&str, &str)]) -> Evaluated {
    let request = Request {
        main: Input::File(file.to_owned()),
        set: set.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect(),
        allow_read: Vec::new(),
        record_arguments: false,
    };
    match evaluate(&request) {
        Ok(e) => {
            let warnings: Vec<&str> = e.warnings.iter().map(|d| d.message.as_str()).collect();
            assert!(warnings.is_empty(), "{}: {warnings:?}", name(file));
            e
        }
        Err(f) => {
            let errors: Vec<&str> = f.diagnostics.iter().map(|d| d.message.as_str()).collect();
            panic!("{}: {errors:?}", name(file));
        }
    }
}

/// A small picture in the scene's own proportions, with one ray a pixel.
fn picture(e: &Evaluated, threads: usize) -> Film {
    let settings = &e.scene.settings;
    let height = (WIDTH * settings.height).div_ceil(settings.width);
    let options = Options {
        width: WIDTH,
        height,
        aa: rtdsl::scene::AntiAliasing::Off,
        threads: Some(threads),
        ..Options::from_settings(settings)
    };
    let world = World::build(&e.scene, &e.scene.cameras[0]);
    render(&world, &options, &Silent, &AtomicBool::new(false)).expect("not cancelled").film
}

#[test]
fn every_example_makes_a_picture() {
    let examples = scenes(&folder());
    assert!(examples.len() >= 10, "{} examples", examples.len());
    for file in examples {
        let e = evaluated(&file, &[]);
        let film = picture(&e, 2);
        assert!(film.pixels.as_flattened().iter().all(|x| x.is_finite()), "{}", name(&file));
        let mut colors: Vec<[u8; 3]> =
            film.pixels.iter().map(|p| p.map(|x| (x.clamp(0.0, 1.0) * 15.0) as u8)).collect();
        colors.sort_unstable();
        colors.dedup();
        // Even the plainest has a dozen clearly different colours; an empty or black picture has one or two.
        assert!(colors.len() >= 12, "{}: only {} colours", name(&file), colors.len());
    }
}

#[test]
fn every_example_has_the_same_bits_on_any_number_of_threads() {
    for file in scenes(&folder()) {
        let e = evaluated(&file, &[]);
        let [one, two] = [1, 2].map(|threads| picture(&e, threads));
        assert!(one.pixels == two.pixels, "{}", name(&file));
    }
}

#[test]
fn every_example_says_what_it_is() {
    for file in scenes(&folder()) {
        let text = text(&file);
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some("rtdsl 1"), "{}", name(&file));
        let title = lines.next().and_then(|l| l.strip_prefix("// ")).unwrap_or_default();
        assert!(title.ends_with('.') && title.len() < 120, "{}: no title but `{title}`", name(&file));
        let more = lines.take_while(|l| l.starts_with("// ")).count();
        assert!((1..=3).contains(&more), "{}: {more} lines of explanation", name(&file));
    }
}

/// What the comments of examples suggest to try works.
#[test]
fn suggested_parameters_are_accepted() {
    let mut tried = 0;
    for file in scenes(&folder()) {
        let text = text(&file);
        for suggestion in text.split('`').filter(|part| part.starts_with("--set ")) {
            let set: Vec<(&str, &str)> = suggestion.split("--set ").filter_map(|s| s.trim().split_once('=')).collect();
            assert!(!set.is_empty(), "{}: {suggestion}", name(&file));
            evaluated(&file, &set);
            tried += 1;
        }
    }
    assert!(tried >= 3, "{tried} suggestions");
}

/// Modules make no picture of their own, but each is used by an example.
#[test]
fn every_module_is_used() {
    let texts: Vec<String> = scenes(&folder()).iter().map(|f| text(f)).collect();
    for module in scenes(&folder().join("lib")) {
        let path = format!("\"lib/{}.scene\"", name(&module));
        assert!(texts.iter().any(|t| t.contains(&format!("import {path}"))), "{path} isn't imported");
    }
}

#[test]
fn the_gallery_shows_every_example() {
    let gallery = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/gallery");
    for file in scenes(&folder()) {
        let picture = gallery.join(name(&file)).with_extension("png");
        assert!(picture.is_file(), "{} is missing: `rtdsl gallery` makes it", picture.display());
    }
}
