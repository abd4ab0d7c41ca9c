//! Looks at a pixel: its regions, divided where most is unknown, and when to stop.

use super::super::bounds::{larger, smaller};
use super::bound::Span;
use super::certifier::Certifier;
use super::leaves::{Leaf, Plan, Sketch, judged, total};
use super::memo::Memo;
use super::target::{Pixel, Status, Target, code};
use crate::math::fun;

/// Samples in the time of one look at a region, on a machine with wide registers: measured, from 30 on plain surfaces to 300 near
/// the horizon.
const PRICE: f64 = 64.0;

/// Looks that show how the unknown shrinks, before anything is given up.
const FIRST_LOOKS: f64 = 16.0;

/// Further looks that a proof is worth, whatever samples would cost.
const PROOF: f64 = 224.0;

/// How many times the price of samples a proof may have.
const WORTH: f64 = 4.0;

/// What is left of the unknown as looks double: half of it, at an edge. Where it shrinks less it may be but a corner.
const EDGE: f64 = 0.5;

/// The same, where looks are to make samples affordable.
const SLOW: f64 = 0.7;

/// With more than that left of it, looks are of no use where samples are far from affordable.
const STUCK: f64 = 0.9;

/// So many times is far, in a picture of many such pixels.
const FAR_OF_MANY: f64 = 1.0;

/// So many times is far where they are few, so that each may take its time.
const FAR_OF_FEW: f64 = 1024.0;

/// What looks at a pixel came to.
pub struct Looked {
    /// Its regions.
    pub leaves: Vec<Leaf>,
    /// How many were looked at.
    pub evaluations: u32,
    /// What they are good for.
    pub found: Found,
}

/// What a pixel's regions are good for.
pub enum Found {
    /// They prove it.
    Proved(Pixel),
    /// So many samples keep the target, with the confidence that is asked for.
    Planned(Plan),
    /// Samples are too many that would.
    Hopeless,
}

impl Certifier<'_> {
    /// Looks at pixel (x, y), divided where most is unknown, until it is proved or up to `affordable` samples are the better
    /// choice.
    pub fn looks(&self, memo: &mut Memo, at: [u32; 2], target: &Target, affordable: u32) -> Looked {
        let mut leaf = |rect: [f64; 4], slopes: [f64; 3]| {
            let (bound, in_rows) = memo.looked_at(self, rect);
            let weights = self.window.weights(at, rect);
            let part = weights.part(&bound);
            Leaf { rect, weights, part, width: width(&part, slopes), bound, in_rows }
        };
        let mut leaves: Vec<Leaf> =
            self.window.first_regions(at).into_iter().map(|rect| leaf(rect, [1.0; 3])).collect();
        let first = leaves.len() as u32;
        let (mut evaluations, mut check, mut slopes) = (first, first, [1.0; 3]);
        // After how many looks, and what was unknown then.
        let mut before = (0.5 * first as f64, 0.0);
        loop {
            let (value, half_width, codes) = judged(total(&leaves), target);
            if codes <= target.codes {
                let pixel = Pixel { value, half_width, codes, status: Status::Proved, evaluations, samples: 0 };
                return Looked { leaves, evaluations, found: Found::Proved(pixel) };
            }
            if evaluations == first {
                // Most pixels come to their end without them.
                slopes = total(&leaves).map(slope);
                leaves.iter_mut().for_each(|leaf| leaf.width = width(&leaf.part, slopes));
                // At first as if it were an edge.
                before.1 = leaves.iter().map(|l| l.width).sum::<f64>() / EDGE;
            }
            let spent = evaluations + 4 > target.evaluations;
            if spent || evaluations >= check {
                let all: f64 = leaves.iter().map(|l| l.width).sum();
                let doublings = fun::log2(evaluations as f64 / before.0);
                let shrunk = fun::pow(all / before.1, 1.0 / doublings);
                let sketch = Sketch::new(&leaves, target);
                let samples = sketch.as_ref().map_or(f64::INFINITY, |s| s.samples);
                let outlook = Outlook { evaluations, price: PRICE / first as f64, width: all, shrunk, samples };
                if spent || !outlook.is_good(target, affordable) {
                    let plan = sketch.and_then(|s| s.plan(&leaves, target, affordable));
                    let found = plan.map_or(Found::Hopeless, Found::Planned);
                    return Looked { leaves, evaluations, found };
                }
                (check, before) = (2 * evaluations, (evaluations as f64, all));
            }
            let widest = (1..leaves.len()).fold(0, |w, i| if leaves[i].width > leaves[w].width { i } else { w });
            let divided = leaves.swap_remove(widest);
            let [l, t, r, b] = divided.rect;
            let (cx, cy) = (0.5 * (l + r), 0.5 * (t + b));
            let rows = [[l, t, r, cy], [l, cy, r, b]];
            let quarters = [[l, t, cx, cy], [cx, t, r, cy], [l, cy, cx, b], [cx, cy, r, b]];
            let parts = if divided.in_rows { &rows[..] } else { &quarters[..] };
            for rect in parts {
                leaves.push(leaf(*rect, slopes));
            }
            evaluations += parts.len() as u32;
        }
    }
}

/// What is to be expected of further looks at a pixel.
struct Outlook {
    /// Looks so far.
    evaluations: u32,
    /// Samples in the time of one: windows that overlap share their looks.
    price: f64,
    /// What is unknown after them, in codes: the sum over all regions.
    width: f64,
    /// That over what it was after half as many.
    shrunk: f64,
    /// Samples that would keep the target now.
    samples: f64,
}

impl Outlook {
    /// Whether further looks are worth more than they cost: because they prove the pixel, or because fewer samples keep the
    /// target then, `affordable` ones. Bounds alone decide, never samples, so that what these say stays true.
    fn is_good(&self, target: &Target, affordable: u32) -> bool {
        let (done, most) = (self.evaluations as f64, target.evaluations as f64);
        let (samples, affordable) = (self.samples, affordable as f64);
        let far = if affordable >= target.samples as f64 { FAR_OF_FEW } else { FAR_OF_MANY };
        if samples > far * affordable && done > 1.0 && self.shrunk > STUCK {
            return false;
        }
        if done < smaller(FIRST_LOOKS, samples / self.price) {
            return true;
        }
        // Of both ends' errors the rounding of codes takes a quarter each, on the average.
        let proved = self.looks_until((2.0 * target.codes - 0.5 * target.quantum) / self.width, EDGE);
        if proved <= most && proved - done <= PROOF + WORTH * smaller(samples, affordable) / self.price {
            return true;
        }
        // As many samples are needed as the square of the width says.
        if samples > affordable {
            return self.looks_until((affordable / samples).sqrt(), SLOW) <= most;
        }
        samples * (1.0 - self.shrunk * self.shrunk) > done * self.price
    }

    /// Looks after which the unknown is this share of what it is, if it goes on shrinking as it did, or `at_least` so fast.
    fn looks_until(&self, share: f64, at_least: f64) -> f64 {
        let doublings = fun::ln(share) / fun::ln(smaller(self.shrunk, at_least));
        self.evaluations as f64 * fun::exp2(larger(doublings, 0.0))
    }
}

/// What is unknown of a region, in codes of the pixel, times 4.
fn width(part: &[Span; 3], slopes: [f64; 3]) -> f64 {
    (0..3).map(|c| 4.0 * (part[c][1] - part[c][0]) * slopes[c]).fold(0.0, larger)
}

/// Codes for a unit of light, over an interval.
fn slope([lo, hi]: Span) -> f64 {
    let hi = larger(hi, lo + 1e-3); // anything small: of a single value, the curve's own slope nearly
    (code(hi) - code(lo)) / (hi - lo)
}
