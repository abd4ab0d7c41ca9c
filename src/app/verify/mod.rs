//! `rtdsl verify`: the programme of proofs on the user's own machine, and on the user's own scenes.

pub mod built_in;
pub mod report;
pub mod strange;
pub mod table;
mod writer;

use super::args::VerifyArgs;
use super::load::{load, request, shown_name};
use super::progress::Steps;
use super::view::nearest;
use super::{Exit, Stop};
use crate::diag::Diagnostic;
use crate::verify::{Check, Outcome, PictureCheck, Size, Subject, pictures, programme};
use built_in::built_in;
use report::{Checked, Machine, Report, size_word};
use std::io::{self, Write};
use std::time::Instant;

/// The checks of `--coverage`.
const COVERAGE: [&str; 3] = ["coverage", "filtered", "stated"];

/// A check of either kind.
#[derive(Clone, Copy)]
enum Task {
    Formula(Check),
    Picture(PictureCheck),
}

impl Task {
    fn all() -> Vec<Task> {
        let formulas = programme().into_iter().chain([strange::CHECK]).map(Task::Formula);
        formulas.chain(pictures().into_iter().map(Task::Picture)).collect()
    }
    fn words(&self) -> (&'static str, &'static str) {
        match self {
            Task::Formula(c) => (c.name, c.what),
            Task::Picture(c) => (c.name, c.what),
        }
    }
    fn run(&self, subjects: &[Subject], size: Size) -> Outcome {
        match self {
            Task::Formula(c) => (c.run)(size),
            Task::Picture(c) => (c.run)(subjects, size),
        }
    }
}

/// Runs the command: 4 if a figure is out of its bound.
///
/// # Errors
/// There is no check of that name, a scene is wrong or can't be read, or standard output fails.
pub fn run(args: &VerifyArgs) -> Result<Exit, Stop> {
    let start = Instant::now();
    let tasks = match args.coverage {
        true => chosen(&COVERAGE.map(String::from))?,
        false => chosen(&args.only)?,
    };
    let subjects = subjects(args, &tasks)?;
    let size = if args.extremes || args.coverage { Size::Long } else { Size::Quick };
    let steps = Steps::new(tasks.len() as u64);
    let at_end = steps.clone();
    // Nothing is written, so nothing is left behind. Where there is no handler to be had, the system ends the program.
    let _ = ctrlc::set_handler(move || {
        at_end.clear();
        Stop::system("not every check was made", io::ErrorKind::Interrupted.into()).print();
        std::process::exit(Exit::System as i32);
    });

    let mut report = Report {
        schema: 1,
        version: env!("CARGO_PKG_VERSION"),
        size: size_word(size),
        machine: Machine::this(),
        scenes: subjects.iter().map(|s| s.name.clone()).collect(),
        kept: true,
        seconds: 0.0,
        checks: Vec::new(),
    };
    let for_people = !args.json && !args.markdown;
    let print = |text: String| match for_people {
        true => steps.pause(|| anstream::stdout().write_all(text.as_bytes())),
        false => Ok(()),
    };
    print(table::heading(report.version, report.size, &report.machine))?;
    for task in tasks {
        let (name, what) = task.words();
        steps.begin(name);
        let begun = Instant::now();
        let outcome = task.run(&subjects, size);
        let checked = Checked::new(name, what, begun.elapsed().as_secs_f64(), outcome);
        print(table::block(&checked))?;
        report.kept &= checked.kept;
        report.checks.push(checked);
        steps.end();
    }
    report.seconds = start.elapsed().as_secs_f64();
    steps.clear();
    print(table::footing(&report))?;
    if args.json {
        let text = serde_json::to_string_pretty(&report).map_err(io::Error::from)?;
        writeln!(io::stdout(), "{text}")?;
    }
    if args.markdown {
        let option = match (args.extremes, args.coverage) {
            (true, _) => " --extremes",
            (_, true) => " --coverage",
            _ => "",
        };
        let text = table::markdown(&report, &format!("rtdsl verify{option}"));
        io::stdout().write_all(text.as_bytes())?;
    }
    Ok(if report.kept { Exit::Done } else { Exit::Unmet })
}

/// The checks that are asked for, in the order of the programme; all where none is named.
fn chosen(only: &[String]) -> Result<Vec<Task>, Stop> {
    let all = Task::all();
    let names: Vec<&str> = all.iter().map(|t| t.words().0).collect();
    if let Some(unknown) = only.iter().find(|name| !names.contains(&name.as_str())) {
        let mut d = Diagnostic::error(format!("there is no check `{unknown}`"));
        if let Some(near) = nearest(unknown, &names) {
            d = d.note(format!("did you mean `{near}`?"));
        }
        return Err(Stop::usage(d.note(format!("the checks are: {}", names.join(", ")))));
    }
    let is_asked = |t: &Task| only.is_empty() || only.iter().any(|name| name == t.words().0);
    Ok(all.into_iter().filter(is_asked).collect())
}

/// The scenes whose pictures are checked: those of the command line, or the built-in ones.
fn subjects(args: &VerifyArgs, tasks: &[Task]) -> Result<Vec<Subject>, Stop> {
    if !tasks.iter().any(|t| matches!(t, Task::Picture(_))) {
        if args.files.is_empty() {
            return Ok(Vec::new());
        }
        let d = Diagnostic::error("none of the checks that `--only` names looks at pictures");
        let names: Vec<&str> = pictures().iter().map(|c| c.name).collect();
        return Err(Stop::usage(
            d.note(format!("those that look at the pictures of scenes are: {}", names.join(", "))),
        ));
    }
    if args.files.is_empty() {
        return built_in();
    }
    let subject = |file| {
        let evaluated = load(&request(file, &[], &args.allow_read)?, false)?;
        Ok(Subject { name: shown_name(file), scene: evaluated.scene, hash: None })
    };
    args.files.iter().map(|file| subject(file.as_path())).collect()
}
