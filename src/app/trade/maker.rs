//! Makes the picture in one setting, and measures what that takes.

use super::budget::Budget;
use super::clock::Clock;
use super::setting::{Setting, Way};
use crate::app::stats::Rays;
use crate::render::certify::{Control, Pixel, Refined, Summary, Target, refine};
use crate::render::{self, Options, Silent, World};
use serde::Serialize;
use std::sync::atomic::AtomicBool;

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
    /// Rays of all kinds.
    pub rays: u64,
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

impl Maker<'_> {
    /// The picture in `setting`; `None` where it wasn't finished within so many seconds.
    pub fn make(&self, setting: &Setting, seconds: f64) -> Option<Made> {
        let options = setting.options(self.options);
        if let Way::Sampled(codes) = setting.way {
            return self.sampled(&options, codes, seconds);
        }
        let clock = Clock::start();
        let rendered = self.budget.within(seconds, |cancel| render::render(self.world, &options, &Silent, cancel))?;
        let mut cost = once(&clock);
        (cost.camera_rays, cost.rays) = (rendered.rays.camera, Rays::from(rendered.rays).total);
        let pixels = rendered.film.pixels;
        let Some(certificate) = rendered.certificate else {
            return Some(Made { pixels, cost, claim: None, certified: Vec::new() });
        };
        cost.bounds = certificate.summary.evaluations;
        let claim = Some(Claim::of(&certificate.summary));
        Some(Made { pixels, cost, claim, certified: certificate.pixels })
    }

    /// The same as an error that is asked for, without bounds of regions.
    fn sampled(&self, options: &Options, codes: f64, seconds: f64) -> Option<Made> {
        let clock = Clock::start();
        let target = Target { certificates: false, ..Target::new(codes) };
        let mut certified = vec![Pixel::unknown(); options.width as usize * options.height as usize];
        let work = |cancel: &AtomicBool| reach(self.world, options, &target, &mut certified, cancel);
        let Refined { is_whole, rays } = self.budget.within(seconds, work);
        if !is_whole {
            return None;
        }
        let cost = once(&clock);
        let summary = Summary::of(&certified, codes);
        let (camera_rays, rays) = (rays.camera, Rays::from(rays).total);
        let cost = Cost { camera_rays, rays, bounds: summary.evaluations, ..cost };
        let pixels = certified.iter().map(|p| p.value.map(|v| v as f32)).collect();
        Some(Made { pixels, cost, claim: Some(Claim::of(&summary)), certified })
    }
}

/// Brings `pixels` to a target.
pub fn reach(world: &World, options: &Options, target: &Target, pixels: &mut [Pixel], cancel: &AtomicBool) -> Refined {
    refine(world, options, target, pixels, Control { progress: &Silent, cancel })
}

impl Claim {
    fn of(summary: &Summary) -> Claim {
        let Summary { proved, bounded, estimated, open, .. } = *summary;
        Claim { codes: summary.worst_codes(), proved, bounded, estimated, open }
    }
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
