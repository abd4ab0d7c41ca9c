//! rtdsl reads a scene written as text and ray-traces its picture. This page is the map of the house: how data goes through
//! it, which part may know which, and where to add something.
//!
//! # The way of the data
//!
//! ```text
//! text ──lang──▶ Scene ──render──▶ World ──render──▶ Film ──film──▶ picture file
//!      (parse,    (plain data,      (only what this    (linear     (PNG, OpenEXR, Radiance,
//!      evaluate)   f64, places)      scene requires)    colour)     with its recipe inside)
//! ```
//!
//! One direction, no way back.
//!
//! 1. [`lang::evaluate`] turns a text into a [`scene::Scene`]. Mistakes in the text end here, as [`diag::Diagnostic`]s. A
//!    `Scene` that exists is valid: all numbers are finite and in range, all ids point at something.
//! 2. [`render::World::build`] keeps what the scene requires as seen by one camera, laid out for tracing, and finds out
//!    which abilities of the renderer are needed. What no live ability reads isn't stored.
//! 3. [`render::render`] traces batches of rays, tile by tile, into a [`film::Film`] of linear colours. It can't fail.
//! 4. [`film::encode`] makes a picture file of it; [`film::OutputFile`] writes the file whole or not at all.
//!
//! [`render::stream`] does without the film where only a PNG is wanted: rows are encoded by [`film::PngWriter`] while others
//! are traced, and memory is needed for those alone that are on the way.
//!
//! Watching goes the same way again and again, and keeps what stays true: [`lang::Memory`] parsed files and decoded pictures,
//! [`render::Retracer`] the tree over unchanged shapes and every tile that a change can't have moved. Both give, bit for bit,
//! what starting anew gives.
//!
//! Every node, material and camera carries the [`diag::Place`] of the text that made it, so that even a late message and
//! `rtdsl explain` point at a line.
//!
//! # Floors
//!
//! A file imports only from a lower floor or from its own folder. [`lang`] and [`render`] never import each other: they meet
//! in [`scene`]. `tests/architecture.rs` checks it.
//!
//! | floor | folder | what it is |
//! |---|---|---|
//! | 0 | [`math`] | scalars, affine maps, elementary functions with the same bits everywhere, the keyed hash |
//! | 0 | [`diag`] | texts, places in them, messages, and how messages are printed |
//! | 1 | [`scene`] | what a picture is of: plain data, no tracing |
//! | 1 | [`film`] | linear picture, display codes, file formats, atomic files; may use `scene`'s colours |
//! | 2 | [`lang`] | grammar, evaluation, vocabulary: text to scene |
//! | 2 | [`render`] | world, rays, shapes, materials, integrator, tiles: scene to film |
//! | 3 | [`verify`] | the programme of proofs: checks of kernels and pictures at the extremes; never [`lang`] |
//! | 4 | [`app`] | one file or folder a command: arguments, exit codes, everything that prints, watches or serves |
//!
//! # Rules that hold everywhere
//!
//! - **No panic, whatever the input.** A mistake in a scene is a [`diag::Diagnostic`] with a place; a fault of the system is
//!   an [`std::io::Error`]. Only [`app`] prints or ends the program.
//! - **The same bits** on every machine, for every number of threads, tile size and order of objects. So elementary
//!   functions come from [`math::fun`] alone; `clippy.toml` forbids the platform's.
//! - **Only what the scene requires.** An image that nothing shows isn't opened; without lights there are no shadow rays.
//! - **One place for each thing**: one grammar, one table of the vocabulary, one formula a shape, one way to report.
//!
//! # Where to add things
//!
//! - *A word of the language*: its entry in the catalog of [`lang`] (name, parameters, units, ranges, documentation,
//!   example), and the function that makes its value. Messages, `rtdsl help` and `docs/language.md` come from the entry.
//! - *A shape*: a variant of [`scene::Shape`], a file of its own among the shapes of [`render`], a word.
//! - *A pattern*: a variant of [`scene::PatternKind`], its evaluation in [`render`], a word.
//! - *A setting*: a field of [`scene::Settings`] and of [`render::Options`], a word, an argument in [`app::args`].
//! - *A picture format*: a variant of [`film::Format`].
//! - *A command*: a file in [`app`] and a variant of [`app::args::Command`].
//! - *A message*: build a [`diag::Diagnostic`] where the mistake is found; its exact printed form goes into the tests.

pub mod app;
pub mod diag;
pub mod film;
pub mod lang;
pub mod math;
pub mod render;
pub mod scene;
pub mod verify;
