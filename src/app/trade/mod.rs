//! `rtdsl trade`: what accuracy costs in this scene on this machine, measured.
//!
//! [`plan`] says which settings are tried, [`sweep`](mod@sweep) measures them with the [`maker`] against the [`reference`](mod@reference), within the
//! [`budget`]; [`front`] and [`verdict`] draw the conclusions; [`report`], [`table`], [`plot`] and [`page`] tell of them.

pub mod axis;
pub mod budget;
pub mod clock;
pub mod front;
pub mod image;
pub mod maker;
pub mod page;
pub mod plan;
pub mod plot;
pub mod point;
pub mod reference;
pub mod report;
pub mod scale;
pub mod setting;
pub mod sweep;
pub mod table;
pub mod verdict;

use super::accuracy::Quality;
use super::args::TradeArgs;
use super::load::{load, request, shown_name};
use super::picture::{fits, look};
use super::progress::Steps;
use super::render::spares_sources;
use super::verify::report::Machine;
use super::{Exit, Stop};
use crate::diag::Diagnostic;
use crate::film::OutputFile;
use crate::lang::Evaluated;
use crate::render::World;
use axis::Axis;
use budget::Budget;
use maker::Maker;
use report::{Report, reference_row, rows};
use setting::Setting;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;
use sweep::{Sweep, Told, sweep};
use verdict::{Verdict, suggestion};

/// The files that are made, in this order.
const FILES: [&str; 4] = ["trade.csv", "trade.json", "trade.svg", "index.html"];

/// Runs the command: 4 where something doesn't hold that must, or no setting keeps the error that is asked for.
///
/// # Errors
/// The arguments don't fit the scene, the scene is wrong, a file can't be read or written, or the user wanted no more.
pub fn run(args: &TradeArgs) -> Result<Exit, Stop> {
    let start = Instant::now();
    let folder = folder(args)?;
    let evaluated = load(&request(&args.scene.file, &args.scene.set, &args.scene.allow_read)?, args.quiet)?;
    let (camera, mut options) = look(&evaluated, &args.view)?;
    options.threads = args.threads.map(|n| n as usize);
    let world = World::build(&evaluated.scene, camera);
    fits(&world, &evaluated, &options)?;
    let files = files(&folder, &evaluated)?;

    let budget = Budget::new(args.budget);
    let bar = Bar((!args.quiet).then(|| Steps::new(0)));
    let user = budget.clone();
    // Where there is no handler to be had, an interrupt ends the program at once, and leaves no file half. So does the second one.
    let _ = ctrlc::set_handler(move || {
        if user.is_interrupted() {
            std::process::exit(Exit::System as i32);
        }
        user.interrupt();
    });
    let mut axes: Vec<Axis> = if args.axis.is_empty() { Axis::ALL.into() } else { args.axis.clone() };
    // What 32 bits can't hold isn't traced with them.
    axes.retain(|axis| *axis != Axis::Precision || world.beyond_f32().is_none());
    let maker = Maker { world: &world, options: &options, budget: &budget };
    let swept = sweep(&maker, Setting::of(&options), &axes, &bar);
    bar.clear();
    let Some(swept) = swept else {
        return Err(match budget.is_interrupted() {
            true => Stop::system("nothing was measured", io::ErrorKind::Interrupted.into()),
            false => {
                let d = Diagnostic::error("the scene's own picture takes longer than all that is to be measured may");
                Stop::usage(d.note("give it more time with `--budget`, or a smaller picture with `--size`"))
            }
        });
    };

    let named = || [Quality::Draft, Quality::Good, Quality::Fine].map(Quality::max_error).to_vec();
    let wanted = args.suggest.map_or_else(named, |share| vec![share]);
    let verdict = Verdict::of(&swept);
    let report = Report {
        schema: 1,
        version: env!("CARGO_PKG_VERSION"),
        scene: shown_name(&args.scene.file),
        size: [options.width, options.height],
        machine: Machine::this(),
        threads: options.threads.unwrap_or_else(rayon::current_num_threads),
        budget: args.budget,
        seconds: start.elapsed().as_secs_f64(),
        interrupted: budget.is_interrupted(),
        reference: reference_row(&swept),
        pixels_per_degree: crate::film::metric::PIXELS_PER_DEGREE,
        points: rows(&swept, &verdict),
        axes: swept.rows.clone(),
        verdict,
        left_out: swept.left_out.clone(),
        suggestions: wanted.into_iter().map(|share| suggestion(&swept.points, 255.0 * share)).collect(),
        asked: args.suggest.is_some(),
    };
    let json = serde_json::to_string_pretty(&report).map_err(io::Error::from)? + "\n";
    write(&files, &swept, &report, &json)?;
    if args.json {
        io::stdout().write_all(json.as_bytes())?;
    } else if !args.quiet {
        let text = table::heading(&report) + &table::body(&report);
        anstream::stdout().write_all(text.as_bytes())?;
        writeln!(io::stdout(), "{}", folder.join(FILES[3]).display())?;
    }
    if !args.json && (!args.quiet || report.asked) {
        io::stdout().write_all(table::recommendation(&report).as_bytes())?;
    }
    match (report.interrupted, report.is_met()) {
        (true, _) => Err(Stop::system("not every setting was measured", io::ErrorKind::Interrupted.into())),
        (false, true) => Ok(Exit::Done),
        (false, false) => {
            // Quiet or not, this is what the exit code is about.
            for violation in report.verdict.violations.iter().filter(|_| args.quiet || args.json) {
                let _ = writeln!(io::stderr(), "doesn't hold: {violation}");
            }
            Ok(Exit::Unmet)
        }
    }
}

/// Where the files go.
fn folder(args: &TradeArgs) -> Result<PathBuf, Stop> {
    if let Some(folder) = &args.out {
        return Ok(folder.clone());
    }
    let file = &args.scene.file;
    match file.file_stem() {
        Some(stem) if file != Path::new("-") => {
            let mut name = stem.to_os_string();
            name.push("-trade");
            Ok(name.into())
        }
        _ => {
            let d = Diagnostic::error(format!("where shall the files of `{}` go?", shown_name(file)));
            Err(Stop::usage(d.note("name a folder with `-o DIR`")))
        }
    }
}

/// The files to write, found to be writable before the work begins, and none of those that the scene reads.
fn files(folder: &Path, evaluated: &Evaluated) -> Result<[OutputFile; 4], Stop> {
    fs::create_dir_all(folder).map_err(|e| Stop::system(format!("`{}` can't be made", folder.display()), e))?;
    let file = |name: &str| {
        let path = folder.join(name);
        spares_sources(&path, evaluated)?;
        OutputFile::new(&path).map_err(|e| Stop::system(format!("`{}` can't be written", path.display()), e))
    };
    let [a, b, c, d] = FILES.map(file);
    Ok([a?, b?, c?, d?])
}

fn write(files: &[OutputFile; 4], swept: &Sweep, report: &Report, json: &str) -> Result<(), Stop> {
    let plot = plot::svg(report);
    let page = page::page(swept, report, &plot).map_err(|e| Stop::system("the page can't be made", e))?;
    let texts = [report.csv(), json.into(), plot, page];
    for ((file, text), name) in files.iter().zip(&texts).zip(FILES) {
        let written = file.write(|out| out.write_all(text.as_bytes()));
        written.map_err(|e| Stop::system(format!("`{name}` can't be written"), e))?;
    }
    Ok(())
}

/// The bar, where somebody may see it.
struct Bar(Option<Steps>);

impl Bar {
    fn clear(&self) {
        if let Some(steps) = &self.0 {
            steps.clear();
        }
    }
}

impl Told for Bar {
    fn expect(&self, steps: usize) {
        if let Some(bar) = &self.0 {
            bar.lengthen(steps as u64);
        }
    }

    fn begin(&self, what: &'static str) {
        if let Some(bar) = &self.0 {
            bar.begin(what);
        }
    }

    fn end(&self) {
        if let Some(bar) = &self.0 {
            bar.end();
        }
    }
}
