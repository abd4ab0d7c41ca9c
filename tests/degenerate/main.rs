//! Scenes at the edges of what there is, and beyond: each is a picture of finite numbers or a placed error, never a panic,
//! never a hang, never a NaN.

mod writer;

use rtdsl::diag::Span;
use rtdsl::film::Film;
use rtdsl::lang::{self, Failure, Input, Request};
use rtdsl::render::{Options, Silent, World, render};
use rtdsl::scene::Precision;
use std::collections::HashSet;
use std::fmt::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use writer::{Writer, Written};

/// What the program makes of a text: its picture, or why there is none.
fn picture(text: &str) -> Result<Film, Failure> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/assets");
    let main = Input::Text { name: "try.scene".into(), bytes: text.as_bytes().to_vec(), folder };
    let request = Request { main, set: Vec::new(), allow_read: Vec::new(), record_arguments: false };
    let evaluated = lang::evaluate(&request)?;
    let scene = &evaluated.scene;
    let world = World::build(scene, &scene.cameras[0]);
    let mut options = Options { threads: Some(1), ..Options::from_settings(&scene.settings) };
    if world.beyond_f32().is_some() {
        options.precision = Precision::F64; // the program says so and stops
    }
    Ok(render(&world, &options, &Silent, &AtomicBool::new(false)).expect("nothing cancels it").film)
}

fn fault(written: &Written) -> Option<String> {
    judge(written).0
}

/// What is wrong with what the program made of a text, `None` if nothing is; and whether it made a picture. Statements with
/// errors are taken out, so that the others are seen too.
fn judge(written: &Written) -> (Option<String>, bool) {
    let mut made = false;
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        let mut left = Written { head: written.head.clone(), things: written.things.clone() };
        loop {
            match picture(&left.text()) {
                Ok(film) => {
                    made = true;
                    return fault_of_picture(&film, &left);
                }
                Err(f) if f.diagnostics.is_empty() => return Some("no picture, and no message".into()),
                Err(f) => {
                    let lines: Option<HashSet<usize>> = f.diagnostics.iter().map(|d| Some(line(&f, d.span()?))).collect();
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

fn fault_of_picture(film: &Film, of: &Written) -> Option<String> {
    if !film.pixels.as_flattened().iter().all(|x| x.is_finite()) {
        return Some("a pixel isn't a number".into());
    }
    match picture(&of.reversed()) {
        Ok(other) if other.hash() == film.hash() => None,
        Ok(_) => Some("the order of shapes changes the picture".into()),
        Err(_) => Some("the order of shapes makes an error".into()),
    }
}

/// The line of the text on which a span starts, from 1.
fn line(failure: &Failure, span: Span) -> usize {
    let location = failure.sources.location(span);
    let line = location.split(':').nth(1).and_then(|n| n.parse().ok());
    line.unwrap_or_else(|| panic!("{location} is no place"))
}

/// The fewest statements of a faulty scene that are faulty still.
fn shrunk(mut written: Written) -> Written {
    loop {
        let n = written.head.len() + written.things.len();
        // From the end: what comes first may be a parameter of all.
        let smaller = (0..n).rev().find_map(|i| {
            let mut less = Written { head: written.head.clone(), things: written.things.clone() };
            match i.checked_sub(less.head.len()) {
                Some(k) => less.things.remove(k),
                None => less.head.remove(i),
            };
            judge(&less).0.is_some().then_some(less)
        });
        match smaller {
            Some(less) => written = less,
            None => return written,
        }
    }
}

/// Runs cases `0..count` of `seed` on all cores; the faults, shrunk, and how many were pictures.
fn faults(seed: u64, count: u64) -> (Vec<String>, u64) {
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
                let (fault, made) = judge(&written);
                pictures.fetch_add(made as u64, Relaxed);
                if fault.is_some() {
                    let least = shrunk(written);
                    let mut text = format!("seed {seed}, case {case}: {}\n", judge(&least).0.unwrap_or_default());
                    let _ = write!(text, "{}", least.text());
                    found.push(text);
                }
            }
        };
        let running: Vec<_> = (0..workers).map(|_| s.spawn(work)).collect();
        running.into_iter().flat_map(|r| r.join().expect("a worker")).collect()
    });
    (found, pictures.into_inner())
}

#[test]
fn strange_scenes_give_pictures_or_placed_errors() {
    let count = std::env::var("RTDSL_SCENES").ok().and_then(|n| n.parse().ok()).unwrap_or(300);
    let seed = std::env::var("RTDSL_SEED").ok().and_then(|n| n.parse().ok()).unwrap_or(1);
    let (found, pictures) = faults(seed, count);
    println!("{count} scenes, {pictures} pictures");
    assert!(found.is_empty(), "\n{}", found.join("\n"));
}
