//! The scenes that are looked at where none is given: they are part of the program.

use crate::app::Stop;
use crate::app::load::{load, request};
use crate::verify::Subject;
use std::fs;
use std::io;
use tempfile::TempDir;

/// A scene's name, its text, and the hash of its small picture, which is the same on every machine.
const SCENES: [(&str, &str, &str); 3] = [
    (
        "cosc363.scene",
        include_str!("../../../examples/cosc363.scene"),
        "70d59bbefe4d8fb1352b505f2b686b09d2694a5079c6b46a34b458953c1a03f8",
    ),
    (
        "extremes.scene",
        include_str!("../../../examples/extremes.scene"),
        "d92663a7a28bdaf19ee171b2706eddd624660e3bd625646438144add3936d49f",
    ),
    (
        "patterns.scene",
        include_str!("../../../examples/patterns.scene"),
        "053a1f51a0a8f1fabf2dfb3bdf2f28bbb72a61b5e24bc17530191caef13fa33d",
    ),
];

/// A file that they show.
const PICTURE: (&str, &[u8]) = ("assets/earth.png", include_bytes!("../../../examples/assets/earth.png"));

/// A folder with the picture that they show, which is gone when the value is dropped.
///
/// # Errors
/// There is no place for temporary files.
pub fn folder() -> io::Result<TempDir> {
    let folder = tempfile::tempdir()?;
    fs::create_dir(folder.path().join("assets"))?;
    fs::write(folder.path().join(PICTURE.0), PICTURE.1)?;
    Ok(folder)
}

/// The scenes, by way of a folder of their own, which is gone when this returns.
///
/// # Errors
/// There is no place for temporary files.
pub fn built_in() -> Result<Vec<Subject>, Stop> {
    let no_place = |e: io::Error| Stop::system("there is no place for the built-in scenes", e);
    let folder = folder().map_err(no_place)?;
    let path = |name: &str| folder.path().join(name);
    SCENES
        .iter()
        .map(|&(name, text, hash)| {
            fs::write(path(name), text).map_err(no_place)?;
            let evaluated = load(&request(&path(name), &[], &[])?, false)?;
            Ok(Subject { name: name.into(), scene: evaluated.scene, hash: Some(hash) })
        })
        .collect()
}
