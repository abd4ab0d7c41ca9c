//! The picture that all others are measured against: as near to the truth as the budget allows, with its own uncertainty.

use super::maker::{Made, Maker, climb};
use super::plan::{REFERENCE_FACTOR, smallest_error};
use super::setting::{Setting, Way};
use crate::film::metric::{Flip, Truth};
use crate::render::certify::{Pixel, Summary, Target};
use crate::scene::{AntiAliasing, Precision};
use serde::Serialize;

/// The truth as far as it is known.
pub struct Reference {
    /// Codes and their uncertainty.
    pub truth: Truth,
    /// What people see of it.
    pub seen: Flip,
    /// How it was made.
    pub kind: Kind,
    /// Seconds that it took.
    pub seconds: f64,
}

/// How a reference was made.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase", tag = "kind")]
pub enum Kind {
    /// Certified: each pixel's uncertainty is what is proved, bounded or estimated of it.
    Certified {
        /// The error that was asked for, in codes.
        asked: f64,
        /// Pixels that keep what is said of them for certain.
        proved: usize,
        /// Pixels that keep it with the confidence of 0.999.
        bounded: usize,
        /// Pixels that keep it as far as samples tell.
        estimated: usize,
        /// Pixels of which nothing is known but that they lie between black and white.
        open: usize,
    },
    /// The largest grid of rays that fitted the budget: each pixel's uncertainty is its distance from a grid half as fine, which
    /// is an estimate.
    Grid {
        /// Rays along a side of a pixel.
        side: u32,
    },
}

/// The share of the budget that a certified reference may take.
const CERTIFIED_SHARE: f64 = 0.35;
/// The share that a grid may take in its place.
const GRID_SHARE: f64 = 0.25;
/// Errors on the way to the reference's own, in codes: what isn't reached keeps the last of them.
const RUNGS: [f64; 3] = [16.0, 4.0, 1.0];
/// How many times smaller an error is tried in the end, if there is time: it makes the bars smaller.
const BEYOND: f64 = 4.0;

impl Reference {
    /// The best that a share of the budget affords; `base_seconds` is what the scene's own setting took. `None` where the user
    /// wants no more.
    pub fn make(maker: &Maker<'_>, base: &Setting, base_seconds: f64) -> Option<Reference> {
        let certified = certified(maker, base);
        if maker.budget.is_interrupted() {
            return None;
        }
        // As good as the smallest error that is swept, every pixel of it: no grid tells as much of itself.
        if certified.truth.worst() <= smallest_error() {
            return Some(certified);
        }
        Some(match grid(maker, base, base_seconds) {
            Some(grid) if grid.truth.worst() < certified.truth.worst() => grid,
            _ => certified,
        })
    }

    /// In words.
    pub fn words(&self) -> String {
        match self.kind {
            Kind::Certified { asked, proved, bounded, estimated, open } => {
                let all = (proved + bounded + estimated + open).max(1);
                let share = |n: usize| format!("{:.2} %", 100.0 * n as f64 / all as f64);
                format!(
                    "certified at {asked}/255: {} of its pixels proved, {} bounded, {} estimated, {open} open",
                    share(proved),
                    share(bounded),
                    share(estimated)
                )
            }
            Kind::Grid { side } => format!(
                "{side}×{side} rays a pixel, the largest grid that fitted; its uncertainty is an estimate, its distance from {0}×{0}",
                side / 2
            ),
        }
    }
}

fn certified(maker: &Maker<'_>, base: &Setting) -> Reference {
    let options = Setting { precision: Precision::F64, ..*base }.options(maker.options);
    let mut asked = smallest_error() / REFERENCE_FACTOR;
    // Its codes aren't rounded: it is no file.
    let target = |codes: f64| Target { quantum: 0.0, ..Target::new(codes) };
    let targets: Vec<Target> = RUNGS.into_iter().chain([asked]).map(target).collect();
    let mut pixels = vec![Pixel::unknown(); options.width as usize * options.height as usize];
    let before = maker.budget.left();
    maker.budget.within(CERTIFIED_SHARE * before, |cancel| {
        if climb(maker.world, &options, &targets, &mut pixels, cancel)
            && climb(maker.world, &options, &[target(asked / BEYOND)], &mut pixels, cancel)
        {
            asked /= BEYOND;
        }
    });
    let Summary { proved, bounded, estimated, open, .. } = Summary::of(&pixels, f64::INFINITY);
    let kind = Kind::Certified { asked, proved, bounded, estimated, open };
    let known = pixels.iter().map(|p| (p.value, p.codes));
    finish(Truth::new(options.width, options.height, known), kind, before - maker.budget.left())
}

/// The largest grid that fits and has one half as fine beside it.
fn grid(maker: &Maker<'_>, base: &Setting, base_seconds: f64) -> Option<Reference> {
    let before = maker.budget.left();
    let rays = |side: u32| (side * side) as f64;
    let own = match base.way {
        Way::Grid(n) => rays(n),
        // Whatever it was, a ray a pixel is hardly dearer.
        _ => 1.0,
    };
    // Both grids together take 5/4 of the larger.
    let fits = |side: &u32| 1.25 * base_seconds * rays(*side) / own <= GRID_SHARE * before;
    let side = (1..=AntiAliasing::LARGEST_GRID / 2).map(|half| 2 * half).take_while(fits).last()?;
    let make = |side: u32| {
        let setting = Setting { way: Way::Grid(side), precision: Precision::F64, ..*base };
        maker.make(&setting, f64::INFINITY).map(|Made { pixels, .. }| pixels)
    };
    let (coarse, fine) = (make(side / 2)?, make(side)?);
    let [coarse, fine] = [coarse, fine].map(|pixels| {
        let known = pixels.into_iter().map(|light| (light.map(f64::from), 0.0));
        Truth::new(maker.options.width, maker.options.height, known)
    });
    let distance = |(a, b): (&[f64; 3], &[f64; 3])| {
        (0..3).map(|c| (a[c] - b[c]).abs()).fold(0.0, |most, d| if d > most { d } else { most })
    };
    let uncertainty = coarse.codes.iter().zip(&fine.codes).map(distance).collect();
    Some(finish(Truth { uncertainty, ..fine }, Kind::Grid { side }, before - maker.budget.left()))
}

fn finish(truth: Truth, kind: Kind, seconds: f64) -> Reference {
    let seen = Flip::new(&truth.written(), truth.width);
    Reference { truth, seen, kind, seconds }
}
