//! The whole way from an accuracy to a picture: one round where an error is asked for, rounds from coarse to fine where time is
//! short. What a round has brought to its error stays, whatever becomes of the next.

use super::super::options::{Options, Progress, RayCounts, Rendered, Silent};
use super::super::sketch::{Pass, Sketch};
use super::super::world::World;
use super::picture::threads;
use super::{Control, Pixel, Refined, Status, Summary, Target, refine};
use crate::film::Film;
use crate::scene::Accuracy;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread;
use std::time::{Duration, Instant};

/// What can be said of a picture's error.
#[derive(Clone, Debug)]
pub struct Certificate {
    /// What was asked for.
    pub accuracy: Accuracy,
    /// The error that the picture is told by, in codes of 8 bits: the one asked for, or the smallest that the time was enough for.
    pub reached: f64,
    /// How many pixels keep it, how surely.
    pub summary: Summary,
    /// Every pixel that was made, row by row; empty where time was over before anything was known of any.
    pub pixels: Vec<Pixel>,
}

/// Errors of the rounds under a time limit, in codes: each takes about as long as all before it. With a larger one to begin with, more
/// could be said a little earlier; but a value that keeps it for certain may be further from the truth than the sketch's is. A
/// smaller one than the last is only tried if it is asked for.
const ROUNDS: [f64; 3] = [4.0, 2.0, LAST];
/// The last of them, where none is asked for.
const LAST: f64 = 1.0;

/// How often it is looked whether work is to end: unnoticeable, and it costs nothing.
const GLANCE: Duration = Duration::from_millis(2);

/// Makes the picture; `None` where `cancel` was set meanwhile. Without a time limit its bits depend on world, size and accuracy
/// alone.
pub(in crate::render) fn render(
    world: &World,
    options: &Options,
    accuracy: Accuracy,
    (progress, cancel): (&dyn Progress, &AtomicBool),
) -> Option<Rendered> {
    // A time too long for the clock is no limit.
    let deadline = accuracy.time.and_then(|t| Instant::now().checked_add(Duration::from_secs_f64(t)));
    let picture = match deadline {
        None => {
            let mut picture = Picture::new(world, options, accuracy);
            picture.round(accuracy.error.map_or(LAST, |e| 255.0 * e), Control { progress, cancel });
            picture
        }
        Some(deadline) => until(deadline, world, options, accuracy, cancel)?,
    };
    if cancel.load(Relaxed) { None } else { Some(picture.finished()) }
}

/// As good as it gets until then; `None` where `cancel` was set before there was a picture.
fn until<'w>(
    deadline: Instant,
    world: &'w World,
    options: &'w Options,
    accuracy: Accuracy,
    cancel: &AtomicBool,
) -> Option<Picture<'w>> {
    let mut sketch = Sketch::new(world, options, cancel)?;
    let part = options.crop_or_all();
    let is_whole =
        watched(deadline, cancel, |over| Pass::all().into_iter().all(|pass| sketch.pass(pass, (part, &Silent), over)));
    if !is_whole {
        return Some(Picture::sketched(sketch, accuracy));
    }
    let begin = Instant::now();
    let mut picture = Picture::begun(sketch, accuracy);
    // To account for all pixels at the end takes about as long as to write them down.
    let deadline = deadline.checked_sub(begin.elapsed()).unwrap_or(deadline);
    // Pixels are told of once, and nobody knows in which round they come to their end.
    watched(deadline, cancel, |over| picture.rounds(Control { progress: &Silent, cancel: over }));
    Some(picture)
}

/// Works until it is done, or tells it to end when the time is over or `cancel` is set.
fn watched<T>(deadline: Instant, cancel: &AtomicBool, work: impl FnOnce(&AtomicBool) -> T) -> T {
    let over = AtomicBool::new(false);
    thread::scope(|s| {
        let watchman = s.spawn(|| {
            while !over.load(Relaxed) && !cancel.load(Relaxed) && Instant::now() < deadline {
                thread::park_timeout(GLANCE);
            }
            over.store(true, Relaxed);
        });
        let done = work(&over);
        over.store(true, Relaxed);
        watchman.thread().unpark();
        done
    })
}

/// The errors of the rounds, in codes: the last is the one asked for.
fn rounds(accuracy: Accuracy) -> impl Iterator<Item = f64> {
    let asked = accuracy.error.map_or(LAST, |e| 255.0 * e);
    ROUNDS.into_iter().filter(move |&codes| codes > asked).chain([asked])
}

/// A picture on its way.
struct Picture<'w> {
    world: &'w World,
    options: &'w Options,
    accuracy: Accuracy,
    reached: f64,
    pixels: Vec<Pixel>,
    rays: RayCounts,
    /// What it looked like before anything was proved.
    sketch: Option<Film>,
}

/// From what error on, in codes, the sketch's value of a pixel is a better guess than the middle of what is known of it.
const COARSE: f64 = 2.0;

impl<'w> Picture<'w> {
    fn new(world: &'w World, options: &'w Options, accuracy: Accuracy) -> Picture<'w> {
        let part = options.crop_or_all();
        let pixels = vec![Pixel::unknown(); part.width as usize * part.height as usize];
        Picture { world, options, accuracy, reached: 255.0, pixels, rays: RayCounts::default(), sketch: None }
    }

    /// With something to show of every pixel, of none of which anything is known, or will be.
    fn sketched(sketch: Sketch<'w>, accuracy: Accuracy) -> Picture<'w> {
        let Sketch { world, options, film, rays, .. } = sketch;
        let reached = rounds(accuracy).next().unwrap_or(LAST);
        Picture { world, options, accuracy, reached, pixels: Vec::new(), rays, sketch: Some(film) }
    }

    /// With something to show of every pixel.
    fn begun(sketch: Sketch<'w>, accuracy: Accuracy) -> Picture<'w> {
        let pixel = |light: &[f32; 3]| Pixel { value: light.map(f64::from), ..Pixel::unknown() };
        let pixels = sketch.film.pixels.iter().map(pixel).collect();
        Picture { pixels, ..Picture::sketched(sketch, accuracy) }
    }

    /// One round after another, as far as it goes.
    fn rounds(&mut self, control: Control<'_>) {
        for codes in rounds(self.accuracy) {
            if !self.round(codes, control) {
                return;
            }
        }
    }

    /// Brings all pixels to an error, in codes; whether it got through.
    fn round(&mut self, codes: f64, control: Control<'_>) -> bool {
        let target = self.target(codes);
        let Refined { is_whole, rays } = refine(self.world, self.options, &target, &mut self.pixels, control);
        self.rays = self.rays.plus(rays);
        if is_whole {
            self.reached = codes;
        }
        is_whole
    }

    fn target(&self, codes: f64) -> Target {
        let (quantum, confidence) = (255.0 * self.options.quantum, self.accuracy.confidence);
        Target { quantum, confidence, ..Target::new(codes) }
    }

    /// Puts the sketch's values where only a wide interval is known, as far as they keep the error.
    fn take_guesses(&mut self) {
        let (Some(sketch), target) = (self.sketch.take(), self.target(self.reached)) else { return };
        for (pixel, guess) in self.pixels.iter_mut().zip(&sketch.pixels) {
            if pixel.status != Status::Open && pixel.codes > COARSE {
                *pixel = pixel.with_value(guess.map(f64::from), &target);
            }
        }
    }

    fn finished(mut self) -> Rendered {
        if !self.pixels.is_empty() {
            self.take_guesses();
        }
        let Picture { options, accuracy, reached, pixels, rays, sketch, .. } = self;
        let part = options.crop_or_all();
        let (summary, film) = match sketch {
            Some(film) => (Summary { open: film.pixels.len(), ..Summary::default() }, film),
            None => {
                let light = pixels.iter().map(|p| p.value.map(|v| v as f32)).collect();
                (Summary::of(&pixels, reached), Film { width: part.width, height: part.height, pixels: light })
            }
        };
        let certificate = Some(Box::new(Certificate { accuracy, reached, summary, pixels }));
        Rendered { film, rays, threads: threads(options), certificate }
    }
}
