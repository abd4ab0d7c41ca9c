//! The whole way from an accuracy to a picture: one round where an error is asked for, rounds from coarse to fine where time is
//! short. What a round has brought to its error stays, whatever becomes of the next.

use super::super::dispatch;
use super::super::options::{Options, Progress, RayCounts, Rendered, Silent};
use super::super::world::World;
use super::{Control, Pixel, Summary, Target, refine};
use crate::film::Film;
use crate::scene::{Accuracy, AntiAliasing};
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
    /// Every pixel that was made, row by row.
    pub pixels: Vec<Pixel>,
}

/// Errors of the rounds under a time limit, in codes: each takes about as long as all before it. A smaller one than the last is
/// only tried if it is asked for.
const ROUNDS: [f64; 4] = [16.0, 4.0, 2.0, 1.0];

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
    let mut picture = Picture::new(world, options, accuracy);
    match deadline {
        None => {
            let codes = picture.asked();
            picture.round(codes, Control { progress, cancel });
        }
        Some(deadline) => {
            picture.sketch(cancel)?;
            let over = AtomicBool::new(false);
            thread::scope(|s| {
                let watchman = s.spawn(|| {
                    while !over.load(Relaxed) && !cancel.load(Relaxed) && Instant::now() < deadline {
                        thread::park_timeout(GLANCE);
                    }
                    over.store(true, Relaxed);
                });
                // Pixels are told of once, and nobody knows in which round they come to their end.
                picture.rounds(Control { progress: &Silent, cancel: &over });
                over.store(true, Relaxed);
                watchman.thread().unpark();
            });
        }
    }
    if cancel.load(Relaxed) { None } else { Some(picture.finished()) }
}

/// A picture on its way.
struct Picture<'w> {
    world: &'w World,
    options: &'w Options,
    accuracy: Accuracy,
    reached: f64,
    pixels: Vec<Pixel>,
    rays: RayCounts,
}

impl<'w> Picture<'w> {
    fn new(world: &'w World, options: &'w Options, accuracy: Accuracy) -> Picture<'w> {
        let part = options.crop_or_all();
        let pixels = vec![Pixel::unknown(); part.width as usize * part.height as usize];
        Picture { world, options, accuracy, reached: 255.0, pixels, rays: RayCounts::default() }
    }

    /// The error of the last round, in codes.
    fn asked(&self) -> f64 {
        self.accuracy.error.map_or(ROUNDS[ROUNDS.len() - 1], |e| 255.0 * e)
    }

    /// One ray a pixel: something to show of every one, whatever the time allows.
    fn sketch(&mut self, cancel: &AtomicBool) -> Option<()> {
        let one = Options { aa: AntiAliasing::Off, accuracy: None, ..self.options.clone() };
        let rendered = dispatch::render(self.world, &one, &Silent, cancel)?;
        self.rays = rendered.rays;
        for (pixel, light) in self.pixels.iter_mut().zip(&rendered.film.pixels) {
            pixel.value = light.map(f64::from);
        }
        Some(())
    }

    /// One round after another, as far as it goes.
    fn rounds(&mut self, control: Control<'_>) {
        let asked = self.asked();
        let coarse = ROUNDS.into_iter().filter(|&codes| codes > asked);
        for (i, codes) in coarse.chain([asked]).enumerate() {
            if i == 0 {
                self.reached = codes;
            }
            if !self.round(codes, control) {
                return;
            }
        }
    }

    /// Brings all pixels to an error, in codes; whether it got through.
    fn round(&mut self, codes: f64, control: Control<'_>) -> bool {
        let (quantum, confidence) = (255.0 * self.options.quantum, self.accuracy.confidence);
        let target = Target { quantum, confidence, ..Target::new(codes) };
        let is_whole = refine(self.world, self.options, &target, &mut self.pixels, control);
        if is_whole {
            self.reached = codes;
        }
        is_whole
    }

    fn finished(self) -> Rendered {
        let Picture { options, accuracy, reached, pixels, mut rays, .. } = self;
        let part = options.crop_or_all();
        let summary = Summary::of(&pixels, reached);
        rays.camera += summary.samples;
        let film = Film {
            width: part.width,
            height: part.height,
            pixels: pixels.iter().map(|p| p.value.map(|v| v as f32)).collect(),
        };
        let certificate = Some(Box::new(Certificate { accuracy, reached, summary, pixels }));
        Rendered { film, rays, threads: 1, certificate }
    }
}
