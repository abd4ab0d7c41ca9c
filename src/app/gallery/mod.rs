//! `rtdsl gallery`: the pictures of a folder of scenes, and pages that show them with their text.
//!
//! [`project`] is what a run works on; [`refresh`] makes what changed, [`check`] compares. [`manifest`] is what one run leaves
//! for the next, [`shelf`] the folder that both write to; [`maker`] makes one picture, [`site`] all pages.

pub mod check;
pub mod crew;
pub mod difference;
pub mod link;
pub mod listing;
pub mod maker;
pub mod manifest;
pub mod mark;
pub mod page;
pub mod project;
pub mod refresh;
pub mod scene_file;
pub mod shelf;
pub mod shrink;
pub mod site;
pub mod summary;
pub mod title;

use super::args::GalleryArgs;
use super::{Exit, Stop};
use project::Project;
use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Instant;

/// Runs the command: 0 all pictures are there, 1 a scene is wrong, 3 a file can't be read or written, 4 with `--check`, a
/// picture isn't what its scene makes.
///
/// # Errors
/// There is nothing to make, a file can't be written, or the run was interrupted.
pub fn run(args: &GalleryArgs) -> Result<Exit, Stop> {
    let start = Instant::now();
    let project = Project::open(args)?;
    let cancel = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&cancel);
    // Where there is no handler to be had, an interrupt ends the program at once, which leaves every file whole too. So does
    // the second one: what was made meanwhile is then made again by the next run.
    let _ = ctrlc::set_handler(move || {
        if flag.swap(true, Relaxed) {
            std::process::exit(Exit::System as i32);
        }
    });
    let mut summary = match args.check {
        true => check::check(&project, args, &cancel)?,
        false => refresh::refresh(&project, args, &cancel)?,
    };
    summary.seconds = start.elapsed().as_secs_f64();
    if args.json {
        let text = serde_json::to_string_pretty(&summary).map_err(io::Error::from)?;
        writeln!(io::stdout(), "{text}")?;
    } else if !args.quiet {
        write!(io::stdout(), "{}", summary.text())?;
    }
    Ok(summary.exit())
}
