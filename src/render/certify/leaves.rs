//! A pixel divided into regions, and how few samples in which of them bring its error down (Hoeffding, "Probability
//! inequalities for sums of bounded random variables", JASA 58, 1963).
//!
//! How many samples there are and where depends on bounds alone, never on what samples show: so the inequality holds
//! as it stands, however the regions came about.

use super::super::bounds::{larger, smaller};
use super::bound::{Bound, Span};
use super::target::{Target, middle, room};
use crate::math::fun;

/// A region of a pixel.
pub struct Leaf {
    /// Its rectangle in the picture.
    pub rect: [f64; 4],
    /// Its share of the pixel's area.
    pub share: f64,
    /// What is known of it.
    pub bound: Bound,
    /// Its share of what isn't known, in codes.
    pub width: f64,
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
    /// What is known of the mean over the region.
    fn mean(&self, c: usize) -> Span {
        self.bound.sum[c].map(|x| 0.25 * x)
    }

    /// How far apart samples can be, less what the form says of them.
    fn spread(&self, c: usize) -> f64 {
        let [lo, hi] = self.bound.range[c];
        match self.bound.form {
            Some(f) if f[c].is_known() => smaller(2.0 * f[c].r, hi - lo),
            _ => hi - lo,
        }
    }
}

/// Bounds of the pixel's mean, by channel.
pub fn total(leaves: &[Leaf]) -> [Span; 3] {
    [0, 1, 2].map(|c| {
        let (mut lo, mut hi, mut size) = (0.0, 0.0, 0.0);
        for leaf in leaves {
            let [l, h] = leaf.mean(c);
            (lo, hi, size) = (lo + leaf.share * l, hi + leaf.share * h, size + leaf.share * larger(l.abs(), h.abs()));
        }
        // Every sum is off by as many roundings as it has terms, at most.
        let slack = 4.0 * f64::EPSILON * leaves.len() as f64 * size;
        [lo - slack, hi + slack]
    })
}

/// The cheapest plan found that keeps the target with up to `most` samples: the widest leaves are sampled, in proportion to their
/// width.
pub fn plan(leaves: &[Leaf], target: &Target, most: u32) -> Option<Plan> {
    let log = 0.5 * fun::ln(2.0 * 3.0 / (1.0 - target.confidence));
    let known = total(leaves);
    let codes = target.before_rounding();
    // The curve is steepest where it is darkest.
    let room = known.map(|k| room(k[0], codes));
    if !room.iter().all(|r| *r > 0.0) {
        return None;
    }
    let weight = |leaf: &Leaf| (0..3).map(|c| leaf.share * leaf.spread(c) / room[c]).fold(0.0, larger);
    let mut order: Vec<usize> = (0..leaves.len()).collect();
    order.sort_by(|&a, &b| leaves[b].width.total_cmp(&leaves[a].width).then(a.cmp(&b)));
    let halves = |leaf: &Leaf, c: usize| {
        let [lo, hi] = leaf.mean(c);
        0.5 * leaf.share * (hi - lo)
    };
    let mut settled: [f64; 3] = [0, 1, 2].map(|c| leaves.iter().map(|l| halves(l, c)).sum());
    let (mut weights, mut best) = (0.0, None::<(usize, f64, f64)>);
    for (k, &i) in order.iter().enumerate() {
        settled = [0, 1, 2].map(|c| settled[c] - halves(&leaves[i], c));
        weights += weight(&leaves[i]);
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
    let (sampled, _, n) = best?;
    if !(n <= most as f64) {
        return None;
    }
    let weights: f64 = order[..sampled].iter().map(|&i| weight(&leaves[i])).sum();
    let mut samples = vec![0; leaves.len()];
    for &i in &order[..sampled] {
        samples[i] = larger((n * weight(&leaves[i]) / weights).ceil(), 1.0) as u32;
    }
    let total = samples.iter().sum();
    let half_width = [0, 1, 2].map(|c| {
        let (mut squares, mut rest) = (0.0, 0.0);
        for (leaf, &n) in leaves.iter().zip(&samples) {
            match n {
                0 => rest += halves(leaf, c),
                n => {
                    let spread = leaf.share * leaf.spread(c);
                    squares += spread * spread / n as f64;
                }
            }
        }
        // A few roundings of each term.
        (rest + (log * squares).sqrt()) * (1.0 + 1.0 / (1u64 << 30) as f64)
    });
    (total <= most && (0..3).all(|c| half_width[c] <= room[c])).then_some(Plan { samples, total, half_width })
}

/// The value in the middle of what is known, its half widths, and the error of its codes.
pub fn judged(known: [Span; 3], target: &Target) -> ([f64; 3], [f64; 3], f64) {
    let both = known.map(middle);
    let codes = (0..3).map(|c| target.error(both[c].0, known[c])).fold(0.0, larger);
    (both.map(|b| b.0), both.map(|b| b.1), codes)
}
