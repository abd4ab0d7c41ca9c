//! Counts which stated errors are kept.

use super::binomial::{lower_limit, upper_limit};
use crate::diag::thousands;
use crate::render::certify::{Pixel, Status, Target};
use crate::verify::{Bound, Figure};

/// Pixels that were told to keep an error, and those of them that don't; by [`Status`], but without open ones.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Kept {
    told: [u64; 3],
    broken: [u64; 3],
    /// Pixels that were told to be open: they promise nothing.
    pub open: u64,
    /// The largest ratio of a proved pixel's error and the one stated.
    pub nearest: f64,
}

impl Kept {
    /// Counts a pixel whose written codes are off by `error` codes, give or take `unsure`; whether it breaks its word.
    pub fn count(&mut self, pixel: &Pixel, target: &Target, error: f64, unsure: f64) -> bool {
        if !pixel.keeps(target.codes) {
            self.open += 1;
            return false;
        }
        let kind = pixel.status as usize;
        // Rounding of the closed forms and of the curve, in codes.
        let slack = unsure + 1e-6;
        let is_broken = !(error <= target.codes + slack);
        self.told[kind] += 1;
        self.broken[kind] += is_broken as u64;
        if pixel.status == Status::Proved && error / target.codes > self.nearest {
            self.nearest = error / target.codes;
        }
        is_broken && pixel.status != Status::Estimated
    }

    /// Both together.
    pub fn and(self, o: Kept) -> Kept {
        Kept {
            told: [0, 1, 2].map(|k| self.told[k] + o.told[k]),
            broken: [0, 1, 2].map(|k| self.broken[k] + o.broken[k]),
            open: self.open + o.open,
            nearest: if self.nearest > o.nearest { self.nearest } else { o.nearest },
        }
    }

    /// All pixels.
    pub fn cases(&self) -> u64 {
        self.told.iter().sum::<u64>() + self.open
    }

    /// The figures of `what`, where bounded pixels were to keep their error with probability `confidence`.
    pub fn figures(&self, what: &str, confidence: f64) -> Vec<Figure> {
        let [proved, bounded, estimated] = self.told;
        let mut figures = Vec::new();
        if proved > 0 {
            let text = format!("{what}: of {} proved, beyond", thousands(proved));
            figures.push(Figure::none_of(text, self.broken[0]));
            let text = format!("{what}: largest error of a proved pixel, of the one stated");
            figures.push(Figure::new(text, self.nearest, "", Bound::AtMost(1.0 + 1e-5)));
        }
        if bounded > 0 {
            // Few cases can't show that a small probability isn't larger: then that it is would have to show.
            let allowed = 1.0 - confidence;
            let is_enough = upper_limit(0, bounded, 0.05) <= allowed;
            let (limit, word) = match is_enough {
                true => (upper_limit(self.broken[1], bounded, 0.05), "upper"),
                false => (lower_limit(self.broken[1], bounded, 0.05), "lower"),
            };
            let text =
                format!("{what}: of {} bounded, {} beyond; {word} 95 % limit", thousands(bounded), self.broken[1]);
            figures.push(Figure::new(text, 100.0 * limit, "%", Bound::AtMost(100.0 * allowed)));
        }
        if estimated > 0 {
            let text = format!("{what}: of {} estimated, beyond", thousands(estimated));
            figures.push(Figure::new(text, 100.0 * self.broken[2] as f64 / estimated as f64, "%", Bound::None));
        }
        if self.open > 0 {
            figures.push(Figure::new(format!("{what}: open"), self.open as f64, "", Bound::None));
        }
        figures
    }

    /// Broken words of proved and bounded pixels.
    pub fn broken(&self) -> u64 {
        self.broken[0] + self.broken[1]
    }
}
