//! A pixel divided into regions, and how few samples in which of them bring its error down (Hoeffding, "Probability
//! inequalities for sums of bounded random variables", JASA 58, 1963).
//!
//! How many samples there are and where depends on bounds alone, never on what samples show: so the inequality holds
//! as it stands, however the regions came about.

use super::super::bounds::{larger, smaller};
use super::bound::{Bound, Span};
use super::target::{Target, room};
use super::window::Weights;
use crate::math::{Form, fun};

/// A region of a pixel.
pub struct Leaf {
    /// Its rectangle in the picture.
    pub rect: [f64; 4],
    /// How it is weighed.
    pub weights: Weights,
    /// What is known of it.
    pub bound: Bound,
    /// What it adds to the pixel's value, by channel.
    pub part: [Span; 3],
    /// Its share of what isn't known, in codes.
    pub width: f64,
    /// Whether it is better divided into rows than into quarters.
    pub in_rows: bool,
}

/// Which leaves are best sampled, and what that costs.
pub struct Sketch {
    /// Leaves, the widest first.
    order: Vec<usize>,
    /// How many of them are sampled.
    sampled: usize,
    /// About how many samples keep the target.
    pub samples: f64,
    /// By how much light each channel may be off.
    room: [f64; 3],
}

/// A plan for samples.
pub struct Plan {
    /// How many samples each leaf gets; 0 where its bound's middle is taken.
    pub samples: Vec<u32>,
    /// All of them.
    pub total: u32,
    /// How far the estimate may be off, by channel.
    pub half_width: [f64; 3],
}

impl Leaf {
    /// What is taken off the light of samples: a form from which it is less far than its range is wide, or the range's middle.
    pub fn taken_off(&self, c: usize) -> Form {
        let [lo, hi] = self.bound.range[c];
        let form = self.bound.form.map(|f| f[c]).filter(|f| f.is_known() && 2.0 * f.r <= hi - lo);
        let form = form.unwrap_or_else(|| Form { r: 0.5 * (hi - lo), ..Form::constant(0.5 * lo + 0.5 * hi) });
        // Where all weights are the same, what is the same everywhere makes no difference.
        if self.weights.plain { Form { c: 0.0, ..form } } else { form }
    }

    /// How far apart samples can be, less that.
    fn spread(&self, c: usize) -> f64 {
        2.0 * self.taken_off(c).r
    }

    /// How far the middle of its part may be off.
    fn half(&self, c: usize) -> f64 {
        let [lo, hi] = self.part[c];
        0.5 * (hi - lo)
    }

    /// Its need for samples: by how much they may move the pixel's mean, over the room there is.
    fn weight(&self, room: &[f64; 3]) -> f64 {
        (0..3).map(|c| self.weights.size * self.spread(c) / room[c]).fold(0.0, larger)
    }
}

/// Bounds of the pixel's value, by channel.
pub fn total(leaves: &[Leaf]) -> [Span; 3] {
    [0, 1, 2].map(|c| {
        let (mut lo, mut hi, mut size) = (0.0, 0.0, 0.0);
        for leaf in leaves {
            let [l, h] = leaf.part[c];
            (lo, hi, size) = (lo + l, hi + h, size + larger(l.abs(), h.abs()));
        }
        // Every sum is off by as many roundings as it has terms, at most.
        let slack = 4.0 * f64::EPSILON * leaves.len() as f64 * size;
        [lo - slack, hi + slack]
    })
}

/// The logarithm in Hoeffding's inequality, for both sides of three channels together.
fn log(target: &Target) -> f64 {
    0.5 * fun::ln(2.0 * 3.0 / (1.0 - target.confidence))
}

impl Sketch {
    /// The cheapest found that keeps the target: the widest leaves are sampled, in proportion to their width.
    pub fn new(leaves: &[Leaf], target: &Target) -> Option<Sketch> {
        let log = log(target);
        let codes = target.before_rounding();
        // The curve is steepest where it is darkest.
        let room = total(leaves).map(|k| room(k[0], codes));
        if !room.iter().all(|r| *r > 0.0) {
            return None;
        }
        let mut order: Vec<usize> = (0..leaves.len()).collect();
        order.sort_by(|&a, &b| leaves[b].width.total_cmp(&leaves[a].width).then(a.cmp(&b)));
        let mut settled: [f64; 3] = [0, 1, 2].map(|c| leaves.iter().map(|l| l.half(c)).sum());
        let (mut weights, mut best) = (0.0, None::<(usize, f64, f64)>);
        for (k, &i) in order.iter().enumerate() {
            settled = [0, 1, 2].map(|c| settled[c] - leaves[i].half(c));
            weights += leaves[i].weight(&room);
            let left = (0..3).map(|c| 1.0 - larger(settled[c], 0.0) / room[c]).fold(1.0, smaller);
            if !(left > 0.05) {
                continue; // what isn't sampled leaves too little
            }
            // n samples shared out by weight leave √(log·weights²/n) of the room.
            let n = larger(log * weights * weights / (left * left), (k + 1) as f64);
            if n + (k as f64) < best.map_or(f64::INFINITY, |b| b.1) {
                best = Some((k + 1, n + k as f64, n));
            }
        }
        let (sampled, _, samples) = best?;
        Some(Sketch { order, sampled, samples, room })
    }

    /// The plan in numbers; `None` where so many samples don't suffice.
    pub fn plan(&self, leaves: &[Leaf], target: &Target, most: u32) -> Option<Plan> {
        if !(self.samples <= most as f64) {
            return None;
        }
        let sampled = &self.order[..self.sampled];
        let weights: f64 = sampled.iter().map(|&i| leaves[i].weight(&self.room)).sum();
        let mut samples = vec![0; leaves.len()];
        for &i in sampled {
            samples[i] = larger((self.samples * leaves[i].weight(&self.room) / weights).ceil(), 1.0) as u32;
        }
        let total = samples.iter().sum();
        let half_width = [0, 1, 2].map(|c| {
            let (mut squares, mut rest) = (0.0, 0.0);
            for (leaf, &n) in leaves.iter().zip(&samples) {
                match n {
                    0 => rest += leaf.half(c),
                    n => {
                        let spread = leaf.weights.size * leaf.spread(c);
                        squares += spread * spread / n as f64;
                    }
                }
            }
            // A few roundings of each term.
            (rest + (log(target) * squares).sqrt()) * (1.0 + 1.0 / (1u64 << 30) as f64)
        });
        let holds = total <= most && (0..3).all(|c| half_width[c] <= self.room[c]);
        holds.then_some(Plan { samples, total, half_width })
    }
}

/// The value in the middle of what is known, its half widths, and the error of its codes.
pub fn judged(known: [Span; 3], target: &Target) -> ([f64; 3], [f64; 3], f64) {
    let each = known.map(|k| target.settled(k));
    let half = |c: usize| larger(each[c].0 - known[c][0], known[c][1] - each[c].0);
    (each.map(|e| e.0), [0, 1, 2].map(half), each.iter().fold(0.0, |m, e| larger(m, e.1)))
}
