//! The picture that all others are measured against: as near to the truth as the budget allows, with its own uncertainty.

use super::clock::Clock;
use super::maker::{Made, Maker, reach};
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
    /// What was learnt of the price of certificates.
    pub climb: Climb,
}

/// How far certificates came, and when: each error in codes with the seconds until it was reached, from the largest on; and the
/// seconds until the end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Climb {
    /// Errors and seconds.
    pub reached: Vec<(f64, f64)>,
    /// Seconds until it was over.
    pub seconds: f64,
}

impl Climb {
    /// Seconds that an error of so many codes will take: those until it or a smaller one was reached; twice all there were, where
    /// none was.
    pub fn expected(&self, codes: f64) -> f64 {
        let reached = self.reached.iter().find(|(error, _)| *error <= codes);
        reached.map_or(2.0 * self.seconds, |(_, seconds)| *seconds)
    }
}

/// How a reference was made.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase", tag = "kind")]
pub enum Kind {
    /// Certified: each pixel's uncertainty is what is proved, bounded or estimated of it.
    Certified {
        /// The smallest error that all its pixels were brought to, as far as they could be, in codes.
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
            Some(grid) if grid.truth.worst() < certified.truth.worst() => Reference { climb: certified.climb, ..grid },
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
    let asked = smallest_error() / REFERENCE_FACTOR;
    let mut pixels = vec![Pixel::unknown(); options.width as usize * options.height as usize];
    let mut climb = Climb::default();
    let clock = Clock::start();
    maker.budget.within(CERTIFIED_SHARE * maker.budget.left(), |cancel| {
        for codes in RUNGS.into_iter().chain([asked, asked / BEYOND]) {
            // Its codes aren't rounded: it is no file.
            let target = Target { quantum: 0.0, ..Target::new(codes) };
            if !reach(maker.world, &options, &target, &mut pixels, cancel).is_whole {
                break;
            }
            climb.reached.push((codes, clock.read().0));
        }
    });
    climb.seconds = clock.read().0;
    // What was asked of it last, and reached.
    let asked = climb.reached.last().map_or(RUNGS[0], |(codes, _)| *codes);
    let Summary { proved, bounded, estimated, open, .. } = Summary::of(&pixels, f64::INFINITY);
    let kind = Kind::Certified { asked, proved, bounded, estimated, open };
    let known = pixels.iter().map(|p| (p.value, p.codes));
    finish(Truth::new(options.width, options.height, known), kind, climb)
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
    let made = finish(Truth { uncertainty, ..fine }, Kind::Grid { side }, Climb::default());
    Some(Reference { seconds: before - maker.budget.left(), ..made })
}

fn finish(truth: Truth, kind: Kind, climb: Climb) -> Reference {
    let seen = Flip::new(&truth.written(), truth.width);
    Reference { truth, seen, kind, seconds: climb.seconds, climb }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_certificates_will_take() {
        let climb = Climb { reached: vec![(16.0, 1.0), (4.0, 3.0)], seconds: 10.0 };
        assert_eq!([16.0, 8.0, 4.0, 2.0].map(|codes| climb.expected(codes)), [1.0, 3.0, 3.0, 20.0]);
    }
}
