//! What is asked of the language, and what it gives back.

use crate::diag::{Diagnostics, Sources, Span};
use crate::scene::{Color, Scene};
use std::path::PathBuf;

/// A scene to evaluate.
#[derive(Clone, Debug)]
pub struct Request {
    /// The main text.
    pub main: Input,
    /// Values for the scene's parameters, by name, as typed on the command line: `--set count=50`.
    pub set: Vec<(String, String)>,
    /// Folders that may be read besides the project's.
    pub allow_read: Vec<PathBuf>,
    /// Whether call chains carry arguments for every shape, not only in errors: slower, for `explain`.
    pub record_arguments: bool,
}

/// Where the main text comes from.
#[derive(Clone, Debug)]
pub enum Input {
    /// A file.
    File(PathBuf),
    /// A text that has been read already: standard input, a test, a documentation sample.
    Text {
        /// How messages name it.
        name: String,
        /// The bytes, which needn't be valid UTF-8.
        bytes: Vec<u8>,
        /// The folder that its relative paths start from; also the project's folder.
        folder: PathBuf,
    },
}

/// A valid scene and what was learned on the way.
#[derive(Clone, Debug)]
pub struct Evaluated {
    /// The scene.
    pub scene: Scene,
    /// The texts that its places refer to.
    pub sources: Sources,
    /// The main file's parameters, in the order of the text.
    pub params: Vec<Param>,
    /// Things worth a look.
    pub warnings: Diagnostics,
    /// Whether it shows nothing but exports something: a file for others to import. Its one warning, that there is nothing
    /// to show, matters only where a picture is wanted.
    pub is_library: bool,
    /// Every file that was read or looked for, the main one first: what a picture depends on.
    pub files: Vec<Dependency>,
    /// Seconds spent parsing.
    pub parse_seconds: f64,
    /// Seconds spent evaluating, images included.
    pub evaluate_seconds: f64,
}

/// Why there is no scene.
#[derive(Clone, Debug)]
pub struct Failure {
    /// At least one error; warnings too.
    pub diagnostics: Diagnostics,
    /// The texts that they refer to.
    pub sources: Sources,
    /// Every file that was read or looked for.
    pub files: Vec<Dependency>,
    /// The main file itself couldn't be read: a fault of files, not of the scene.
    pub main_unreadable: bool,
}

/// A file that was read or looked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dependency {
    /// Its path as the text named it, in the folder of the file that named it; links not followed.
    pub path: PathBuf,
    /// BLAKE3 of the bytes that were read; `None` where none were.
    pub digest: Option<[u8; 32]>,
    /// Whether something was there, read or not: it may be too large, or not allowed.
    pub found: bool,
}

/// A declared parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Param {
    /// Its name.
    pub name: String,
    /// What it is for, from the declaration.
    pub description: Option<String>,
    /// Its values.
    pub kind: ParamKind,
    /// The default, as text of the language.
    pub default: String,
    /// The value of this run, as text of the language.
    pub value: String,
    /// The value, if it is a number; of an angle, its degrees.
    pub number: Option<f64>,
    /// The value, if it is a colour.
    pub color: Option<Color>,
    /// The declaration.
    pub span: Span,
}

/// The values that a parameter may take.
#[derive(Clone, Debug, PartialEq)]
pub enum ParamKind {
    /// A number (or an angle), perhaps within a range, perhaps whole.
    Number {
        /// Smallest and largest allowed.
        range: Option<(f64, f64)>,
        /// Whether only whole numbers are allowed: default and range are whole.
        whole: bool,
        /// `""` or an angle's `"deg"`.
        unit: &'static str,
    },
    /// One of a list.
    Choice(Vec<String>),
    /// `true` or `false`.
    Switch,
    /// A colour.
    Color,
    /// Any text.
    Text,
    /// Anything else: set by an expression of the language.
    Other,
}
