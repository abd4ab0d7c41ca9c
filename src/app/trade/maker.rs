//! Makes the picture in one setting, and measures what that takes.

use super::budget::Budget;
use super::clock::Clock;
use super::setting::{Setting, Way};
use crate::app::stats::Rays;
use crate::render::certify::{Control, Pixel, Summary, Target, refine};
use crate::render::{self, Options, Silent, World};
use serde::Serialize;
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};

/// Makes pictures of one world.
pub struct Maker<'m> {
    /// It.
    pub world: &'m World,
    /// Size, threads, and every dial's place in the scene.
    pub options: &'m Options,
    /// What ends the work.
    pub budget: &'m Budget,
}

/// What a picture took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Cost {
    /// Wall-clock seconds: the least of all runs.
    pub seconds: f64,
    /// Seconds on all processors together: the least of all runs; `None` where the system doesn't tell.
    pub cpu_seconds: Option<f64>,
    /// Times that it was made.
    pub runs: u32,
    /// Rays from the camera.
    pub camera_rays: u64,
    /// Rays of all kinds; `None` where only those from the camera are counted.
    pub rays: Option<u64>,
    /// Regions whose light was bounded.
    pub bounds: u64,
}

/// What a picture says of its own error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Claim {
    /// The largest error of any pixel that isn't open, in codes.
    pub codes: f64,
    /// Pixels that keep it for certain.
    pub proved: usize,
    /// Pixels that keep it with the confidence that is asked for.
    pub bounded: usize,
    /// Pixels that keep it as far as samples tell.
    pub estimated: usize,
    /// Pixels of which nothing is said.
    pub open: usize,
}

/// A picture and what it took.
pub struct Made {
    /// Linear light, row by row.
    pub pixels: Vec<[f32; 3]>,
    /// What it took, this once.
    pub cost: Cost,
    /// What it says of its error.
    pub claim: Option<Claim>,
    /// The same pixel by pixel; empty where nothing is said.
    pub certified: Vec<Pixel>,
}

/// Errors that are asked for one after another while there is time, in codes: each halves the one before nearly, so that what is
/// lost with the last is no more than what it took to get there.
pub const LADDER: [f64; 9] = [128.0, 64.0, 32.0, 16.0, 8.0, 4.0, 2.0, 1.0, 0.75];

impl Maker<'_> {
    /// The picture in `setting`; `None` where it wasn't finished within so many seconds.
    pub fn make(&self, setting: &Setting, seconds: f64) -> Option<Made> {
        let options = setting.options(self.options);
        match setting.way {
            Way::Grid(_) => self.grid(&options, seconds),
            Way::Error(codes) => self.certified(&options, &[Target::new(codes)], seconds, false),
            Way::Sampled(codes) => {
                let target = Target { certificates: false, ..Target::new(codes) };
                self.certified(&options, &[target], seconds, false)
            }
            Way::Time(time) => self.certified(&options, &LADDER.map(Target::new), time, true),
        }
    }

    fn grid(&self, options: &Options, seconds: f64) -> Option<Made> {
        let clock = Clock::start();
        let rendered = self.budget.within(seconds, |cancel| render::render(self.world, options, &Silent, cancel))?;
        let cost = Cost {
            camera_rays: rendered.rays.camera,
            rays: Some(Rays::from(rendered.rays).total),
            ..once(&clock)
        };
        Some(Made { pixels: rendered.film.pixels, cost, claim: None, certified: Vec::new() })
    }

    /// One target after another; what the last didn't reach keeps what the one before gave, if it is wanted `unfinished`.
    fn certified(&self, options: &Options, targets: &[Target], seconds: f64, unfinished: bool) -> Option<Made> {
        let clock = Clock::start();
        let mut pixels = vec![Pixel::unknown(); options.width as usize * options.height as usize];
        let done = self.budget.within(seconds, |cancel| climb(self.world, options, targets, &mut pixels, cancel));
        let cost = once(&clock);
        if self.budget.is_interrupted() || !(done || unfinished) {
            return None;
        }
        let asked = if unfinished { f64::INFINITY } else { targets.last()?.codes };
        let summary = Summary::of(&pixels, asked);
        let claim = Claim {
            codes: summary.worst_codes(),
            proved: summary.proved,
            bounded: summary.bounded,
            estimated: summary.estimated,
            open: summary.open,
        };
        let cost = Cost { camera_rays: summary.samples, rays: None, bounds: summary.evaluations, ..cost };
        let light = pixels.iter().map(|p| p.value.map(|v| v as f32)).collect();
        Some(Made { pixels: light, cost, claim: Some(claim), certified: pixels })
    }
}

/// Brings `pixels` to one target after another; whether it got through.
pub fn climb(world: &World, options: &Options, targets: &[Target], pixels: &mut [Pixel], cancel: &AtomicBool) -> bool {
    targets.iter().all(|target| {
        !cancel.load(SeqCst) && refine(world, options, target, pixels, Control { progress: &Silent, cancel })
    })
}

fn once(clock: &Clock) -> Cost {
    let (seconds, cpu_seconds) = clock.read();
    Cost { seconds, cpu_seconds, runs: 1, ..Cost::default() }
}

impl Cost {
    /// The least of two runs.
    pub fn or(self, again: &Cost) -> Cost {
        let less = |a: f64, b: f64| if b < a { b } else { a };
        Cost {
            seconds: less(self.seconds, again.seconds),
            cpu_seconds: self.cpu_seconds.zip(again.cpu_seconds).map(|(a, b)| less(a, b)),
            runs: self.runs + again.runs,
            ..self
        }
    }
}
