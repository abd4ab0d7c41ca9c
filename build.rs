//! Names the sources that decide pictures and those that decide pages, so that `rtdsl gallery` knows which of its work of an
//! earlier run still holds. A version number alone wouldn't do: it stays the same from one commit to the next.

use std::fs;
use std::path::{Path, PathBuf};

/// What a picture's bytes depend on: the language, the renderer, and what looks a picture up in a scene and writes its recipe.
/// `diag` holds the texts, whose digest stands in the recipe.
const PICTURES: [&str; 12] = [
    "Cargo.lock",
    "grammar",
    "src/app/gallery/maker.rs",
    "src/app/gallery/shrink.rs",
    "src/app/picture.rs",
    "src/app/view.rs",
    "src/diag",
    "src/film",
    "src/lang",
    "src/math",
    "src/render",
    "src/scene",
];
/// What a page depends on besides.
const PAGES: [&str; 3] = ["src/app/gallery", "src/app/params.rs", "src/app/words.rs"];

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rustc-env=RTDSL_PICTURES={:032x}", digest(&PICTURES));
    println!("cargo:rustc-env=RTDSL_PAGES={:032x}", digest(&PAGES));
}

/// The digest of all files at `places`: their paths and contents, in the order of the paths. A place that doesn't exist, as a
/// lock file may, counts as empty.
fn digest(places: &[&str]) -> u128 {
    let mut files: Vec<(String, PathBuf)> = Vec::new();
    for place in places {
        println!("cargo:rerun-if-changed={place}");
        collect(place.to_string(), Path::new(place), &mut files);
    }
    files.sort();
    let mut hash = OFFSET;
    for (name, path) in files {
        let content = fs::read(path).unwrap_or_default();
        // Git may check files out with other line ends; a picture doesn't depend on them.
        let content: Vec<u8> = content.into_iter().filter(|b| *b != b'\r').collect();
        for part in [name.as_bytes(), &content] {
            hash = fnv(hash, &(part.len() as u64).to_le_bytes());
            hash = fnv(hash, part);
        }
    }
    hash
}

fn collect(name: String, path: &Path, into: &mut Vec<(String, PathBuf)>) {
    match fs::read_dir(path) {
        Ok(entries) => {
            for entry in entries.flatten() {
                // Tests decide nothing.
                if entry.path().file_stem().is_some_and(|stem| stem == "tests") {
                    continue;
                }
                let below = format!("{name}/{}", entry.file_name().to_string_lossy());
                collect(below, &entry.path(), into);
            }
        }
        Err(_) if path.is_file() => into.push((name, path.to_path_buf())),
        Err(_) => {}
    }
}

/// FNV-1a with 128 bits: Fowler, Noll, Vo, *The FNV Non-Cryptographic Hash Algorithm* (RFC 9923).
fn fnv(hash: u128, bytes: &[u8]) -> u128 {
    bytes.iter().fold(hash, |h, b| (h ^ *b as u128).wrapping_mul(PRIME))
}

const OFFSET: u128 = 0x6c62272e07bb014262b821756295c58d;
const PRIME: u128 = 0x0000000001000000000000000000013b;
