//! `rtdsl render`: from the text to the picture file.

use super::accuracy;
use super::args::RenderArgs;
use super::load::{load, request, shown_name};
use super::make::{Made, Make, Pixels};
use super::map::{Kind, Map};
use super::picture::{fits, format_of, look, recipe_of, with_accuracy};
use super::progress::Bar;
use super::stats::{self, AccuracyStats, Seconds, Stats};
use super::view::{checked_crop, precision_word};
use super::{Exit, Stop};
use crate::diag::Diagnostic;
use crate::film::{Format, OutputFile, Recipe};
use crate::lang::Evaluated;
use crate::render::{Options, World};
use crate::scene::Precision;
use std::io::{self, Cursor, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Where the picture goes.
enum Output {
    Stdout,
    File(PathBuf),
}

/// Runs the command.
///
/// # Errors
/// The arguments don't fit the scene, the scene is wrong, or a file can't be read or written.
pub fn run(args: &RenderArgs) -> Result<Exit, Stop> {
    let start = Instant::now();
    let (output, format) = output(args)?;
    let mut evaluated = load(&request(&args.scene.file, &args.scene.set, &args.scene.allow_read)?, args.quiet)?;
    let (camera, mut options) = look(&evaluated, &args.view)?;
    let camera = camera.clone();
    options.crop = checked_crop(args.crop, &options)?;
    options.threads = args.threads.map(|n| n as usize);
    args.accuracy.apply(&mut options, format, args.view.precision == Some(Precision::F32))?;
    let target = match &output {
        Output::Stdout => None,
        Output::File(path) => Some(target(path, &evaluated)?),
    };
    let maps = maps(args, &evaluated, &options)?;

    let world_start = Instant::now();
    let world = match options.precision {
        Precision::F64 => World::build_of(&mut evaluated.scene, &camera),
        // What doesn't fit is shown in the text.
        Precision::F32 => World::build(&evaluated.scene, &camera),
    };
    fits(&world, &evaluated, &options)?;
    let world_seconds = world_start.elapsed().as_secs_f64();

    let render_start = Instant::now();
    let part = options.crop_or_all();
    let recipe = recipe_of(&evaluated, &options, &camera, None);
    let bar = Bar::new(part.width as u64 * part.height as u64, args.quiet);
    let make = Make { world: &world, options: &options, bar: &bar, recipe: &recipe, is_hashed: args.stats.is_some() };
    let Some(made) = make.picture(format).map_err(|e| Stop::system("the picture can't be encoded", e))? else {
        return Err(Stop::system("the picture wasn't finished", io::ErrorKind::Interrupted.into()));
    };
    drop(bar);
    let render_seconds = render_start.elapsed().as_secs_f64();

    let encode_start = Instant::now();
    let Made { rays, threads, hash, pixels, certificate } = made;
    let recipe = with_accuracy(recipe, certificate.as_deref());
    match (&output, &target) {
        (Output::File(path), Some(target)) => target
            .write(|out| pixels.write(format, &recipe, out))
            .map_err(|e| Stop::system(format!("`{}` can't be written", path.display()), e))?,
        _ => write_stdout(pixels, format, &recipe)?,
    }
    if let Some(c) = &certificate {
        for map in maps {
            map.write(c, part.width, &recipe)?;
        }
    }
    let encode_seconds = encode_start.elapsed().as_secs_f64();

    if let Some(form) = args.stats {
        let stats = Stats {
            size: [part.width, part.height],
            threads,
            precision: precision_word(options.precision),
            filter: options.filter.name(),
            samples_per_pixel: rays.camera as f64 / (part.width as f64 * part.height as f64),
            accuracy: certificate.as_deref().map(|c| AccuracyStats::of(c, &part)),
            rays: rays.into(),
            seconds: Seconds {
                parse: evaluated.parse_seconds,
                evaluate: evaluated.evaluate_seconds,
                world: world_seconds,
                render: render_seconds,
                encode: encode_seconds,
                total: start.elapsed().as_secs_f64(),
            },
            peak_memory_bytes: stats::peak_memory_bytes(),
            features: world.features(&evaluated.scene).into_iter().filter(|f| f.in_use).map(|f| f.name).collect(),
            image_hash: hash.unwrap_or_default(),
        };
        let text = stats.print(form);
        // Standard output is the picture's where it goes there.
        match output {
            Output::Stdout => io::stderr().write_all(text.as_bytes())?,
            Output::File(_) => io::stdout().write_all(text.as_bytes())?,
        }
    }
    if let Output::File(path) = &output
        && !args.quiet
        && io::stderr().is_terminal()
    {
        let seconds = start.elapsed().as_secs_f64();
        let _ = writeln!(io::stderr(), "{}  {}x{}  {seconds:.2} s", path.display(), part.width, part.height);
    }
    let is_open = certificate.as_ref().is_some_and(|c| c.summary.open > 0);
    if let Some(c) = &certificate
        && !args.quiet
    {
        // A figure that was asked for, on a terminal or not.
        let _ = writeln!(io::stderr(), "{}", accuracy::line(c));
    }
    // The process is about to end, and gives all its memory back at once.
    std::mem::forget((world, evaluated));
    Ok(if args.strict && is_open { Exit::Unmet } else { Exit::Done })
}

/// The maps of the error that are asked for.
fn maps<'a>(args: &'a RenderArgs, evaluated: &Evaluated, options: &Options) -> Result<Vec<Map<'a>>, Stop> {
    let asked = [(&args.error_map, "--error-map", Kind::Error), (&args.status_map, "--status-map", Kind::Status)];
    let given = || asked.into_iter().filter_map(|(path, word, kind)| Some((path.as_deref()?, word, kind)));
    if options.accuracy.is_none()
        && let Some(word) = given().map(|(_, word, _)| word).next().or(args.strict.then_some("--strict"))
    {
        let d = Diagnostic::error(format!("`{word}` is for pictures with a stated error"));
        return Err(Stop::usage(d.note("ask for one: `--max-error 2/255`, or `render(error: 2/255)` in the scene")));
    }
    let mut taken: Vec<&Path> = args.out.as_deref().into_iter().collect();
    for (path, word, _) in given() {
        if taken.contains(&path) {
            return Err(Stop::usage(Diagnostic::error(format!("`{word}` needs a file of its own"))));
        }
        taken.push(path);
    }
    given().map(|(path, _, kind)| Map::new(path, kind, evaluated)).collect()
}

/// Where the picture goes and in what form.
fn output(args: &RenderArgs) -> Result<(Output, Format), Stop> {
    let png = (args.bits, args.compression);
    let from_stdin = args.scene.file == Path::new("-");
    match &args.out {
        Some(path) if path == Path::new("-") => Ok((Output::Stdout, Format::Png(png.0, png.1))),
        Some(path) => Ok((Output::File(path.clone()), format_of(path, png)?)),
        None if from_stdin && io::stdout().is_terminal() => {
            let d = Diagnostic::error("a picture of standard input needs a place to go");
            Err(Stop::usage(d.note("write `-o NAME.png`, or send standard output to a file or another program")))
        }
        None if from_stdin => Ok((Output::Stdout, Format::Png(png.0, png.1))),
        None => {
            let Some(stem) = args.scene.file.file_stem() else {
                let d = Diagnostic::error(format!("`{}` names no file", shown_name(&args.scene.file)));
                return Err(Stop::usage(d));
            };
            let mut name = stem.to_os_string();
            name.push(".png");
            Ok((Output::File(name.into()), Format::Png(png.0, png.1)))
        }
    }
}

/// The file to write, found to be writable before the work begins, and none of those that the scene reads.
pub fn target(path: &Path, evaluated: &Evaluated) -> Result<OutputFile, Stop> {
    spares_sources(path, evaluated)?;
    OutputFile::new(path).map_err(|e| Stop::system(format!("`{}` can't be written", path.display()), e))
}

/// Whether a picture at `path` leaves alone what the scene reads.
///
/// # Errors
/// It is one of those files.
pub fn spares_sources(path: &Path, evaluated: &Evaluated) -> Result<(), Stop> {
    if let Ok(same) = path.canonicalize()
        && evaluated.files.iter().any(|f| f.path.canonicalize().is_ok_and(|f| f == same))
    {
        let d = Diagnostic::error(format!("the picture would overwrite `{}`, which the scene reads", path.display()));
        return Err(Stop::usage(d.note("give it another name with `-o`")));
    }
    Ok(())
}

fn write_stdout(pixels: Pixels, format: Format, recipe: &Recipe) -> Result<(), Stop> {
    let mut memory = Cursor::new(Vec::new());
    pixels.write(format, recipe, &mut memory)?;
    let mut out = io::stdout().lock();
    out.write_all(memory.get_ref())?;
    out.flush()?;
    Ok(())
}
