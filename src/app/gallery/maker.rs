//! One scene: from its file to the bytes of its picture.

use super::manifest::{Figures, ParamRow, Times, Used};
use super::project::Project;
use super::scene_file::SceneFile;
use super::shrink::{scaled, shrink};
use crate::app::Stop;
use crate::app::args::ViewArgs;
use crate::app::load::request;
use crate::app::params::allowed;
use crate::app::picture::{fits, look, recipe_of};
use crate::app::progress::Bar;
use crate::app::render::spares_sources;
use crate::app::view::precision_word;
use crate::diag::Diagnostic;
use crate::film::{self, Film, Format, Recipe};
use crate::lang::{self, Evaluated, Memory};
use crate::render::{self, Retracer};
use crate::scene::{AntiAliasing, PixelFilter, range};
use std::io::{self, Cursor};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Instant;

/// What became of a scene.
pub enum Made {
    /// Its picture.
    Picture(Box<Picture>),
    /// None: it only exports, for others to import.
    Library(Vec<Used>),
    /// The run was interrupted.
    Nothing,
}

/// A picture, ready to be written.
pub struct Picture {
    /// The files that it was made of.
    pub used: Vec<Used>,
    /// What is told about it.
    pub figures: Figures,
    /// The very bytes that `rtdsl render` writes.
    pub file: Vec<u8>,
    /// The small picture, where the picture is a large one.
    pub thumbnail: Option<Vec<u8>>,
    /// Seconds that making it took.
    pub seconds: f64,
}

/// Pixels across of small pictures: three beside each other, on a screen of twice the usual density.
pub const THUMBNAIL_WIDTH: u32 = 480;

/// How a scene is made.
pub struct Maker<'a> {
    /// What it belongs to.
    pub project: &'a Project,
    /// Threads that trace one picture.
    pub threads: usize,
    /// Told of what is done.
    pub bar: &'a Bar,
    /// Set when the run is interrupted.
    pub cancel: &'a AtomicBool,
    /// Whether warnings are left out.
    pub quiet: bool,
}

impl Maker<'_> {
    /// Makes the picture of `scene`.
    ///
    /// # Errors
    /// The scene is wrong, or can't be drawn at the size asked for.
    pub fn make(&self, scene: &SceneFile) -> Result<Made, Stop> {
        let start = Instant::now();
        let request = request(&scene.path, &[], &self.project.allow_read)?;
        let Some(evaluated) = lang::evaluate_again(&request, &mut Memory::default(), self.cancel) else {
            return Ok(Made::Nothing);
        };
        let evaluated = evaluated?;
        let used = self.project.used(scene, &evaluated);
        if evaluated.is_library {
            return Ok(Made::Library(used));
        }
        if !self.quiet {
            self.bar.pause(|| crate::app::stop::print_diagnostics(&evaluated.warnings, &evaluated.sources));
        }
        // Where pictures lie beside their scenes, a scene might show its own.
        for name in [scene.picture(), scene.thumbnail()] {
            spares_sources(&self.project.shelf.path(&name), &evaluated)?;
        }
        let (camera, mut options) = look(&evaluated, &self.view(&evaluated)?)?;
        options.threads = Some(self.threads);
        let world_start = Instant::now();
        let Some(built) = Retracer::default().build(&evaluated.scene, camera, self.cancel) else {
            return Ok(Made::Nothing);
        };
        let world = built.world();
        fits(world, &evaluated, &options)?;
        let world_time = world_start.elapsed();

        self.bar.lengthen(options.width as u64 * options.height as u64);
        let render_start = Instant::now();
        let Some(rendered) = render::render(world, &options, self.bar, self.cancel) else {
            return Ok(Made::Nothing);
        };
        let render_time = render_start.elapsed();

        let encode_start = Instant::now();
        let film = rendered.film;
        let file = png(&film, &recipe_of(&evaluated, &options, camera, rendered.certificate.as_deref()))?;
        let encode_time = encode_start.elapsed();
        if self.cancel.load(Relaxed) {
            return Ok(Made::Nothing);
        }
        let small =
            (film.width > THUMBNAIL_WIDTH && self.project.has_thumbnail(scene)).then(|| shrink(&film, THUMBNAIL_WIDTH));
        let thumbnail = small.as_ref().map(|small| png(small, &of_a_thumbnail(&film))).transpose()?;

        let rays = rendered.rays;
        let figures = Figures {
            size: [film.width, film.height],
            view: self.project.view_words([film.width, film.height]),
            thumbnail: small.map(|s| [s.width, s.height]),
            grid: options.aa.side(),
            adaptive: if let AntiAliasing::Adaptive(n) = options.aa { Some(n) } else { None },
            filter: (options.filter != PixelFilter::Box).then(|| options.filter.name().into()),
            max_depth: options.max_depth,
            precision: precision_word(options.precision).into(),
            rays: [rays.camera, rays.shadow, rays.reflected, rays.transmitted],
            features: world.features(&evaluated.scene).iter().filter(|f| f.in_use).map(|f| f.name.into()).collect(),
            image_hash: film.hash(),
            params: params(&evaluated),
            times: Times {
                parse: (evaluated.parse_seconds * 1e6) as u64,
                evaluate: (evaluated.evaluate_seconds * 1e6) as u64,
                world: world_time.as_micros() as u64,
                render: render_time.as_micros() as u64,
                encode: encode_time.as_micros() as u64,
                threads: rendered.threads,
            },
        };
        let seconds = start.elapsed().as_secs_f64();
        Ok(Made::Picture(Box::new(Picture { used, figures, file, thumbnail, seconds })))
    }

    /// The view that the options ask for.
    fn view(&self, evaluated: &Evaluated) -> Result<ViewArgs, Stop> {
        let settings = &evaluated.scene.settings;
        let size = self.project.width.map(|width| (width, scaled(settings.height, width, settings.width)));
        if let Some((w, h)) = size
            && (h > range::LARGEST_SIDE || w as u64 * h as u64 > range::MOST_PIXELS)
        {
            let d =
                Diagnostic::error(format!("{w} pixels across, this picture would have {h} down: that is too large"));
            let note = format!("the scene's own size is {}x{}", settings.width, settings.height);
            return Err(Stop::scene(d.note(note), &evaluated.sources));
        }
        Ok(ViewArgs {
            size,
            aa: self.project.aa,
            filter: self.project.filter,
            max_depth: None,
            camera: None,
            precision: None,
        })
    }
}

fn params(evaluated: &Evaluated) -> Vec<ParamRow> {
    let row = |p: &crate::lang::Param| ParamRow {
        name: p.name.clone(),
        value: p.value.clone(),
        allowed: allowed(&p.kind),
        description: p.description.clone().unwrap_or_default(),
    };
    evaluated.params.iter().map(row).collect()
}

fn of_a_thumbnail(film: &Film) -> Recipe {
    Recipe::new().with("rtdsl:thumbnail", format!("of {}x{}", film.width, film.height))
}

/// The bytes of a PNG file with 8 bits a channel.
pub fn png(film: &Film, recipe: &Recipe) -> io::Result<Vec<u8>> {
    let mut memory = Cursor::new(Vec::new());
    film::encode(film, Format::PNG, recipe, &mut memory)?;
    Ok(memory.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::args::{Cli, Command};
    use crate::app::later::Later;
    use clap::Parser;
    use std::fs;

    /// Makes the only scene of a folder, whose pictures would lie beside it.
    fn made(text: &str, interrupted: bool) -> Result<Made, Stop> {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a.scene"), text).unwrap();
        let picture = png(&Film::new(4, 4), &Recipe::new()).unwrap();
        fs::write(folder.path().join("a.png"), picture).unwrap();
        let dir = folder.path().to_str().unwrap();
        let Command::Gallery(Later(args)) = Cli::parse_from(["rtdsl", "gallery", dir, "-o", dir]).command else {
            panic!("another command")
        };
        let project = Project::open(&args).unwrap();
        let cancel = AtomicBool::new(interrupted);
        let bar = Bar::new(0, true);
        let maker = Maker { project: &project, threads: 1, bar: &bar, cancel: &cancel, quiet: true };
        maker.make(&project.scenes[0])
    }

    const SCENE: &str = "rtdsl 1\nsphere()\nlight(at: [0, 0, 5])\nrender(size: [8, 8])\n";

    #[test]
    fn interruptions_end_it_anywhere() {
        assert!(matches!(made(SCENE, false), Ok(Made::Picture(_))));
        assert!(matches!(made(SCENE, true), Ok(Made::Nothing)));
        // The evaluation itself would take its time.
        let slow = format!("{SCENE}var i = 0\nfor k in 1..=100000000 {{ i = i + 1 }}\n");
        assert!(matches!(made(&slow, true), Ok(Made::Nothing)));
    }

    #[test]
    fn a_scene_doesn_t_lose_what_it_reads() {
        let text = SCENE.replace("sphere()", "sphere(mat: matte(image(\"a.png\")))");
        let Err(stop) = made(&text, false) else { panic!("it was made") };
        assert!(stop.text().contains("the picture would overwrite") && stop.text().contains("which the scene reads"));
        assert_eq!(stop.exit, crate::app::Exit::Usage);
    }
}
