//! Scenes that nobody would write, from text to picture: each is a picture of finite numbers or an error with a place, never a
//! panic, and neither the order of shapes in the text nor how rays are put together changes anything.

use super::built_in::folder;
use super::writer::{Writer, Written};
use crate::diag::Span;
use crate::film::Film;
use crate::lang::{self, Failure, Input, Request};
use crate::render::{Instructions, Options, Silent, World, render};
use crate::scene::Precision;
use crate::verify::{Bound, Check, Figure, Outcome};
use std::collections::HashSet;
use std::fmt::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

/// The check of strange scenes.
pub const CHECK: Check = Check {
    name: "strange",
    what: "scenes at the edges of what there is: pictures of numbers, or errors with a place",
    run: |size| {
        let cases = size.pick(300, 100_000);
        let Ok(assets) = folder() else {
            let what = "there is no place for the built-in picture".to_string();
            return Outcome { figures: vec![Figure::none_of(what.as_str(), 1)], first_failure: Some(what), cases: 0 };
        };
        let (found, pictures) = faults(&assets.path().join("assets"), 1, cases);
        let (wrong, shown) = ("panics, numbers that aren't, errors without a place", "pictures that show something");
        Outcome {
            cases,
            figures: vec![
                Figure::none_of(wrong, found.len() as u64),
                // Else the errors alone would be looked at.
                Figure::new(shown, pictures as f64, "", Bound::AtLeast(cases as f64 / 5.0)),
            ],
            first_failure: found.into_iter().next(),
        }
    },
};

/// Runs the cases `0..count` of `seed` on all cores. Gives the faults, each shrunk to the fewest statements that show it, and
/// how many pictures showed more than one colour. Pictures that scenes show are read from the folder `assets`.
pub fn faults(assets: &Path, seed: u64, count: u64) -> (Vec<String>, u64) {
    let next = AtomicU64::new(0);
    let pictures = AtomicU64::new(0);
    let workers = std::thread::available_parallelism().map_or(1, |n| n.get());
    let found = std::thread::scope(|s| {
        let work = || {
            let mut found = Vec::new();
            loop {
                let case = next.fetch_add(1, Relaxed);
                if case >= count || found.len() >= 8 {
                    return found;
                }
                let written = Writer::scene(seed, case);
                let (fault, made) = judge(assets, &written);
                pictures.fetch_add(made as u64, Relaxed);
                if fault.is_some() {
                    let least = shrunk(assets, written);
                    let mut text =
                        format!("seed {seed}, case {case}: {}\n", judge(assets, &least).0.unwrap_or_default());
                    let _ = write!(text, "{}", least.text());
                    found.push(text);
                }
            }
        };
        let running: Vec<_> = (0..workers).map(|_| s.spawn(work)).collect();
        // A worker catches the panics of its cases.
        running.into_iter().flat_map(|r| r.join().unwrap_or_else(|_| vec!["a worker's panic".into()])).collect()
    });
    (found, pictures.into_inner())
}

/// What the program makes of a text: its picture, or why there is none.
///
/// # Errors
/// The text is wrong.
pub fn picture(assets: &Path, text: &str) -> Result<Film, Failure> {
    drawn(assets, text, false)
}

/// The same; `otherwise`: of other tiles, and with one ray at a time.
fn drawn(assets: &Path, text: &str, otherwise: bool) -> Result<Film, Failure> {
    let main = Input::Text { name: "try.scene".into(), bytes: text.as_bytes().to_vec(), folder: assets.into() };
    let request = Request { main, set: Vec::new(), allow_read: Vec::new(), record_arguments: false };
    let evaluated = lang::evaluate(&request)?;
    let scene = &evaluated.scene;
    let world = World::build(scene, &scene.cameras[0]);
    let mut options = Options { threads: Some(1), ..Options::from_settings(&scene.settings) };
    if world.beyond_f32().is_some() {
        options.precision = Precision::F64; // the program says so and stops
    }
    if otherwise {
        (options.tile, options.instructions) = (3, Instructions::Common);
    }
    let rendered = render(&world, &options, &Silent, &AtomicBool::new(false));
    Ok(rendered.map_or_else(|| Film::new(0, 0), |r| r.film)) // nothing cancels it
}

/// What is wrong with what the program made of a text, `None` if nothing is; and whether its picture shows anything. Statements with
/// errors are taken out, so that the others are seen too.
fn judge(assets: &Path, written: &Written) -> (Option<String>, bool) {
    let mut made = false;
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        let mut left = Written { head: written.head.clone(), things: written.things.clone() };
        loop {
            match picture(assets, &left.text()) {
                Ok(film) => {
                    made = film.pixels.iter().any(|p| *p != film.pixels[0]);
                    return fault_of_picture(assets, &film, &left);
                }
                Err(f) if f.diagnostics.is_empty() => return Some("no picture, and no message".into()),
                Err(f) => {
                    let lines: Option<HashSet<usize>> = f.diagnostics.iter().map(|d| line(&f, d.span()?)).collect();
                    let Some(lines) = lines else {
                        return Some(format!("an error without a place: {}", f.diagnostics[0].message));
                    };
                    let heads = left.head.len();
                    let without = |all: &[String], first: usize| -> Vec<String> {
                        let kept = all.iter().enumerate().filter(|(i, _)| !lines.contains(&(first + i + 1)));
                        kept.map(|(_, s)| s.clone()).collect()
                    };
                    left = Written { head: without(&left.head, 0), things: without(&left.things, heads) };
                    if left.things.is_empty() {
                        return None;
                    }
                }
            }
        }
    }));
    (outcome.unwrap_or_else(|_| Some("a panic".into())), made)
}

fn fault_of_picture(assets: &Path, film: &Film, of: &Written) -> Option<String> {
    if !film.pixels.as_flattened().iter().all(|x| x.is_finite()) {
        return Some("a pixel isn't a number".into());
    }
    let same = |text: &str, otherwise| drawn(assets, text, otherwise).map(|other| other.hash() == film.hash());
    match same(&of.reversed(), true) {
        Ok(true) => None,
        Ok(false) if same(&of.reversed(), false).is_ok_and(|same| same) => {
            Some("tiles or lanes change the picture".into())
        }
        Ok(false) => Some("the order of shapes changes the picture".into()),
        Err(_) => Some("the order of shapes makes an error".into()),
    }
}

/// The line of the text on which a span starts, from 1; `None` where that is no place of the text.
fn line(failure: &Failure, span: Span) -> Option<usize> {
    failure.sources.location(span).split(':').nth(1).and_then(|n| n.parse().ok())
}

/// The fewest statements of a faulty scene that are faulty still.
fn shrunk(assets: &Path, mut written: Written) -> Written {
    loop {
        let n = written.head.len() + written.things.len();
        // From the end: what comes first may be a parameter of all.
        let smaller = (0..n).rev().find_map(|i| {
            let mut less = Written { head: written.head.clone(), things: written.things.clone() };
            match i.checked_sub(less.head.len()) {
                Some(k) => less.things.remove(k),
                None => less.head.remove(i),
            };
            judge(assets, &less).0.is_some().then_some(less)
        });
        match smaller {
            Some(less) => written = less,
            None => return written,
        }
    }
}
