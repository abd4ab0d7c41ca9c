//! The thread that makes pictures of a watched scene: text to scene, coarse picture, final picture, file.

use super::canvas::{Canvas, enlarged};
use super::desk::{Desk, Leash, Order};
use super::encoder::{encode, hand_on};
use super::follower::{Follower, Means};
use super::interrupt::Unwhole;
use super::show::{Coarse, Show};
use super::teller::{Finished, Teller};
use crate::app::Stop;
use crate::app::accuracy;
use crate::app::args::WatchArgs;
use crate::app::picture::{fits, look, recipe_of};
use crate::app::progress::Bar;
use crate::app::render::target;
use crate::film::{Film, Format, Recipe};
use crate::lang::{self, Dependency, Evaluated, Failure, Input, Memory, Request};
use crate::render::{Built, Options, Plan, Retraced, Retracer};
use crate::scene::{Camera, Precision};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

/// Makes the pictures.
pub struct Painter<'w> {
    args: &'w WatchArgs,
    /// Where finished pictures go, and in what form.
    output: Option<(PathBuf, Format)>,
    unwhole: Unwhole,
    follower: &'w Follower,
    show: Show,
    teller: Teller,
    memory: Memory,
    retracer: Retracer,
    /// Number of the newest text.
    text: u64,
    /// The last good scene, while its picture isn't finished.
    unfinished: Option<Sketch>,
    /// When the last finished picture was made.
    last_good: Option<String>,
    /// How changes are noticed, as far as the user was told.
    means: Option<Means>,
}

/// A scene whose picture is to be made.
struct Sketch {
    evaluated: Arc<Evaluated>,
    camera: Camera,
    options: Options,
    text: u64,
    why: String,
    start: Instant,
}

/// It was told to stop.
struct Cancelled;

impl<'w> Painter<'w> {
    /// A painter that has made nothing yet.
    pub fn new(
        args: &'w WatchArgs,
        output: Option<(PathBuf, Format)>,
        unwhole: Unwhole,
        follower: &'w Follower,
        show: Show,
        teller: Teller,
    ) -> Self {
        Painter {
            args,
            output,
            unwhole,
            follower,
            show,
            teller,
            memory: Memory::default(),
            retracer: Retracer::default(),
            text: 0,
            unfinished: None,
            last_good: None,
            means: None,
        }
    }

    /// Works off orders until the desk closes.
    pub fn work(mut self, desk: &Desk) {
        while let Some((order, leash)) = desk.take() {
            let painted = self.paint(order, &leash);
            self.tell_means();
            if painted.is_err() {
                let after = leash.since_cancelled().map_or(0.0, |d| d.as_secs_f64());
                self.teller.cancelled(self.text, after);
            }
        }
    }

    /// Says where the system can't tell of changes.
    fn tell_means(&mut self) {
        let means = Some(self.follower.means());
        if means == self.means {
            return;
        }
        if let Some(Means::Fallback { every, reason }) = &means {
            let every = every.as_secs_f64();
            self.teller.note(&format!("looking for changes every {every} s: the system can't tell of them ({reason})"));
        }
        self.means = means;
    }

    fn paint(&mut self, order: Order, leash: &Arc<Leash>) -> Result<(), Cancelled> {
        let start = Instant::now();
        self.text += 1;
        self.show.begin(self.text);
        let (result, set) = self.evaluate(&order, leash).ok_or(Cancelled)?;
        let files: &[Dependency] = match &result {
            Ok(e) => &e.files,
            Err(f) => &f.files,
        };
        self.follower.follow(files);
        let why = self.why(&order);
        let sketch = result.map_err(Stop::from).and_then(|e| self.sketch(e, why.clone(), start));
        match sketch {
            Ok(sketch) => {
                let e = &sketch.evaluated;
                self.teller.messages(self.text, &e.warnings, &e.sources);
                self.show.evaluated(e, &set);
                self.unfinished = Some(sketch);
            }
            Err(stop) => {
                self.teller.messages(self.text, stop.diagnostics(), stop.sources());
                self.teller.failed(&why, self.last_good.as_deref());
                self.show.failed(stop.diagnostics(), stop.sources());
            }
        }
        // Of a wrong text there is no picture; then the one before is finished, if it wasn't.
        let Some(sketch) = self.unfinished.take() else { return Ok(()) };
        let drawn = self.draw(&sketch, leash);
        match drawn {
            Ok(()) => Ok(()),
            Err(Some(stop)) => {
                self.teller.messages(sketch.text, stop.diagnostics(), stop.sources());
                self.teller.failed(&sketch.why, self.last_good.as_deref());
                self.show.failed(stop.diagnostics(), stop.sources());
                Ok(())
            }
            Err(None) => {
                self.unfinished = Some(sketch);
                Err(Cancelled)
            }
        }
    }

    /// The scene with the order's parameters, and those that it has. `None` where it was told to stop.
    #[expect(clippy::type_complexity, reason = "a result and the parameters that led to it")]
    fn evaluate(
        &mut self,
        order: &Order,
        leash: &Arc<Leash>,
    ) -> Option<(Result<Evaluated, Failure>, Vec<(String, String)>)> {
        let mut run = |set: &[(String, String)]| {
            let request = Request {
                main: Input::File(self.args.scene.file.clone()),
                set: set.to_vec(),
                allow_read: self.args.scene.allow_read.clone(),
                record_arguments: self.show.is_on(), // pages ask what a pixel sees
            };
            lang::evaluate_again(&request, &mut self.memory, leash.cancel())
        };
        let result = run(&order.set)?;
        if result.is_ok() || order.from_page.is_empty() {
            return Some((result, order.set.clone()));
        }
        // A page may have set a parameter that an edit has taken out since.
        let own: Vec<_> = order.set.iter().filter(|s| !order.from_page.contains(&s.0)).cloned().collect();
        if let Ok(e) = run(&own)? {
            let is_there =
                |s: &&(String, String)| !order.from_page.contains(&s.0) || e.params.iter().any(|p| p.name == s.0);
            let kept: Vec<_> = order.set.iter().filter(is_there).cloned().collect();
            if kept.len() < order.set.len() {
                return Some((run(&kept)?, kept));
            }
        }
        Some((result, order.set.clone()))
    }

    fn sketch(&self, e: Evaluated, why: String, start: Instant) -> Result<Sketch, Stop> {
        let (camera, mut options) = look(&e, &self.args.view)?;
        let camera = camera.clone();
        options.threads = self.args.threads.map(|n| n as usize);
        let format = self.output.as_ref().map_or(Format::PNG, |o| o.1);
        self.args.accuracy.apply(&mut options, format, self.args.view.precision == Some(Precision::F32))?;
        if let Some((path, _)) = &self.output {
            target(path, &e)?;
        }
        Ok(Sketch { evaluated: Arc::new(e), camera, options, text: self.text, why, start })
    }

    /// Why there is a new picture, in words.
    fn why(&self, order: &Order) -> String {
        let name = self.args.scene.file.display();
        match (&order.changed[..], &order.asked[..]) {
            ([], []) => format!("{name}"),
            ([], asked) => format!("{} set", asked.join(", ")),
            ([one], _) => format!("{one} changed"),
            ([first, rest @ ..], _) => format!("{first} and {} more changed", rest.len()),
        }
    }

    /// Makes the picture; `Err(None)` where it was told to stop.
    fn draw(&mut self, s: &Sketch, leash: &Arc<Leash>) -> Result<(), Option<Stop>> {
        let world_start = Instant::now();
        let built = self.retracer.build(&s.evaluated.scene, &s.camera, leash.cancel()).ok_or(None)?;
        fits(built.world(), &s.evaluated, &s.options)?;
        let world = Arc::clone(built.world());
        let plan = self.retracer.plan(&built, &s.options, leash.cancel());
        let world_seconds = world_start.elapsed().as_secs_f64();

        let tiles = (plan.traced(), plan.tiles());
        let coarse = self.show.coarse(&world, s.text, &s.options, &plan, leash);
        if let Coarse::Shown(_) = coarse {
            self.teller.coarse(s.text);
        }
        let render_start = Instant::now();
        let Retraced { film, rays, certificate } = self.trace(built, s, plan, coarse, leash).ok_or(None)?;
        let render_seconds = render_start.elapsed().as_secs_f64();

        let recipe = recipe_of(&s.evaluated, &s.options, &s.camera, certificate.as_deref());
        let png = Format::PNG;
        let shown = match self.show.is_on() {
            true => Some(encode(&film, png, &recipe, leash).ok_or(None)?.map_err(Stop::from)?),
            false => None,
        };
        let bytes = shown.as_ref().map_or(0, Vec::len);
        if let Some(file) = &shown {
            self.show.finished(file, (s.text, &s.evaluated, &world, &s.options));
            leash.shown();
        }
        let out = match self.write(&film, &recipe, s, shown, leash) {
            // The picture is made, only its file isn't.
            Err(Some(stop)) => {
                self.teller.messages(s.text, stop.diagnostics(), stop.sources());
                None
            }
            other => other?,
        };
        let e = &s.evaluated;
        let all = rays.camera + rays.shadow + rays.reflected + rays.transmitted;
        let finished = Finished {
            text: s.text,
            why: s.why.clone(),
            parse: e.parse_seconds,
            evaluate: e.evaluate_seconds,
            world: world_seconds,
            render: render_seconds,
            total: s.start.elapsed().as_secs_f64(),
            rays: all,
            tiles,
            size: [film.width, film.height],
            accuracy: certificate.as_deref().map(accuracy::line),
            out,
        };
        self.show.report(&finished, bytes);
        self.teller.finished(&finished);
        self.last_good = Some(super::teller::time_of_day());
        Ok(())
    }

    /// Traces the picture, and meanwhile shows how far it has come.
    fn trace(&mut self, built: Built, s: &Sketch, plan: Plan, coarse: Coarse, leash: &Arc<Leash>) -> Option<Retraced> {
        let pixels = plan.pixels(&s.options);
        let (width, height) = (s.options.width, s.options.height);
        let is_seen = self.show.is_on() && pixels > 0;
        let held = plan.film().filter(|_| is_seen).cloned();
        let before = move || match (coarse, held) {
            (Coarse::Shown(film), _) => enlarged(&film, width, height),
            (Coarse::NotNeeded, Some(film)) => Arc::unwrap_or_clone(film),
            (Coarse::NotNeeded, None) => Film::new(width, height),
        };
        let canvas = Arc::new(Canvas::new(pixels, is_seen, Bar::new(pixels, self.teller.json)));
        self.show.follow(&canvas, before, s.text, leash);
        let traced = self.retracer.render(built, &s.options, plan, &*canvas, leash.cancel());
        canvas.end();
        traced
    }

    /// Writes the picture's file; how messages name it, and `Err(None)` where it was told to stop. `png` is the picture as a
    /// PNG of 8 bits, if it has been made.
    fn write(
        &self,
        film: &Arc<Film>,
        recipe: &Recipe,
        s: &Sketch,
        png: Option<Vec<u8>>,
        leash: &Arc<Leash>,
    ) -> Result<Option<String>, Option<Stop>> {
        let Some((path, format)) = &self.output else { return Ok(None) };
        let name = path.display().to_string();
        let fault = |e| Some(Stop::system(format!("`{name}` can't be written"), e));
        let file = match (png, *format) {
            (Some(file), Format::PNG) => file,
            (_, format) => encode(film, format, recipe, leash).ok_or(None)?.map_err(fault)?,
        };
        let written = target(path, &s.evaluated)?.write(|out| {
            self.unwhole.set(Some(out.get_ref().path()));
            hand_on(&file, out, leash)
        });
        self.unwhole.set(None);
        match written {
            Ok(()) => Ok(Some(name)),
            Err(_) if leash.is_pulled() => Err(None),
            Err(e) => Err(fault(e)),
        }
    }
}
