//! One pixel to its target: regions first, divided where most is unknown; then samples in those that stay wide; then samples
//! alone.

use super::super::bounds::{larger, smaller};
use super::bound::{Bound, Span, hull};
use super::certifier::Certifier;
use super::estimate::estimate;
use super::leaves::{Leaf, Plan, judged, plan, total};
use super::sampler::Sampler;
use super::target::{Pixel, Status, Target, code};
use crate::math::hash::KeyedHash;

/// Tags of what random numbers are for.
const JITTER: u64 = 1;
const REPLICATE: u64 = 2;

/// Samples that one look at a region costs the time of: measured, from 5 on plain surfaces to 40 on edges.
const PRICE: u32 = 20;

impl Certifier<'_> {
    /// Brings pixel (x, y) to its target as far as the target's budgets allow.
    pub fn pixel(&self, sampler: &mut dyn Sampler, [x, y]: [u32; 2], target: &Target) -> Pixel {
        let rect = [x as f64, y as f64, x as f64 + 1.0, y as f64 + 1.0];
        if !target.certificates {
            let range = self.ceiling(self.depth);
            return self.estimated(sampler, [x, y], (range, range), 0, target);
        }
        let mut leaves = vec![self.leaf(rect, 1.0, [1.0; 3])];
        let slopes = total(&leaves).map(slope);
        leaves[0].width = width(&leaves[0].bound, 1.0, slopes);
        let mut evaluations = 1;
        loop {
            let known = total(&leaves);
            let (value, half_width, codes) = judged(known, target);
            if codes <= target.codes {
                return Pixel { value, half_width, codes, status: Status::Proved, evaluations, samples: 0 };
            }
            let spent = evaluations + 4 > target.evaluations;
            let most = if spent { target.samples } else { smaller_u32(evaluations * PRICE / 8, target.samples) };
            // After 1, 5, 9, 17, 33, … looks.
            if (spent || (evaluations == 1 || (evaluations - 1).is_power_of_two()))
                && let Some(plan) = plan(&leaves, target, most)
            {
                return self.sampled(sampler, [x, y], &leaves, (&plan, evaluations), target);
            }
            if spent {
                break;
            }
            let widest = (1..leaves.len()).fold(0, |w, i| if leaves[i].width > leaves[w].width { i } else { w });
            let leaf = leaves.swap_remove(widest);
            let [l, t, r, b] = leaf.rect;
            let (cx, cy) = (0.5 * (l + r), 0.5 * (t + b));
            for rect in [[l, t, cx, cy], [cx, t, r, cy], [l, cy, cx, b], [cx, cy, r, b]] {
                leaves.push(self.leaf(rect, 0.25 * leaf.share, slopes));
            }
            evaluations += 4;
        }
        let range = leaves.iter().fold(leaves[0].bound.range, |r, l| [0, 1, 2].map(|c| hull(r[c], l.bound.range[c])));
        self.estimated(sampler, [x, y], (total(&leaves), range), evaluations, target)
    }

    fn leaf(&self, rect: [f64; 4], share: f64, slopes: [f64; 3]) -> Leaf {
        let bound = self.region(rect);
        Leaf { rect, share, width: width(&bound, share, slopes), bound }
    }

    /// Samples as planned.
    fn sampled(
        &self,
        sampler: &mut dyn Sampler,
        [x, y]: [u32; 2],
        leaves: &[Leaf],
        (plan, evaluations): (&Plan, u32),
        target: &Target,
    ) -> Pixel {
        let key = KeyedHash::new().with(JITTER).with(x as u64).with(y as u64);
        let mut points = Vec::with_capacity(plan.total as usize);
        let mut whose = Vec::with_capacity(plan.total as usize);
        let mut value = [0.0; 3];
        for (i, (leaf, &n)) in leaves.iter().zip(&plan.samples).enumerate() {
            if n == 0 {
                let middle = |c: usize| 0.125 * (leaf.bound.sum[c][0] + leaf.bound.sum[c][1]);
                value = [0, 1, 2].map(|c| value[c] + leaf.share * middle(c));
            }
            let [l, t, r, b] = leaf.rect;
            for k in 0..n {
                // One in each of n upright strips.
                let unit = |axis: u64| key.with(i as u64).with(k as u64).with(axis).unit();
                let (u, v) = ((k as f64 + unit(0)) / n as f64, unit(1));
                points.push([l + u * (r - l), t + v * (b - t)]);
                whose.push((i, [2.0 * u - 1.0, 2.0 * v - 1.0]));
            }
        }
        let rect = [x as f64, y as f64, x as f64 + 1.0, y as f64 + 1.0];
        sampler.trace(rect, &points, &mut |k, light| {
            let (i, [xi, eta]) = whose[k];
            let leaf = &leaves[i];
            let weight = leaf.share / plan.samples[i] as f64;
            for c in 0..3 {
                // The linear part has the mean 0: without it samples are closer together.
                let linear = match leaf.bound.form {
                    Some(f) if f[c].is_known() => f[c].x * xi + f[c].y * eta,
                    _ => 0.0,
                };
                value[c] += weight * (light[c] - linear);
            }
        });
        let known = total(leaves);
        let value = [0, 1, 2].map(|c| value[c].clamp(known[c][0], known[c][1]));
        let interval = |c: usize| {
            let half = plan.half_width[c];
            [larger(value[c] - half, known[c][0]), smaller(value[c] + half, known[c][1])]
        };
        let codes = (0..3).map(|c| target.error(value[c], interval(c))).fold(0.0, larger);
        let status = if codes <= target.codes { Status::Bounded } else { Status::Open };
        Pixel { value, half_width: plan.half_width, codes, status, evaluations, samples: plan.total }
    }

    /// Samples of the whole pixel, where bounds are of no use; its mean is `known` to lie somewhere, and its light in `range`.
    fn estimated(
        &self,
        sampler: &mut dyn Sampler,
        [x, y]: [u32; 2],
        (known, range): ([Span; 3], [Span; 3]),
        evaluations: u32,
        target: &Target,
    ) -> Pixel {
        let rect = [x as f64, y as f64, x as f64 + 1.0, y as f64 + 1.0];
        let key = KeyedHash::new().with(REPLICATE).with(x as u64).with(y as u64);
        let codes = |value: [f64; 3], half: [f64; 3]| {
            let one = |c: usize| {
                let both: Span = [larger(value[c] - half[c], known[c][0]), smaller(value[c] + half[c], known[c][1])];
                target.error(value[c], both)
            };
            (0..3).map(one).fold(0.0, larger)
        };
        let enough = |e: &super::estimate::Estimate| codes(e.value, e.half_width) <= target.codes;
        match estimate(sampler, rect, (target, target.samples), range, key, enough) {
            Some((e, reached)) => {
                let value = [0, 1, 2].map(|c| e.value[c].clamp(known[c][0], known[c][1]));
                let status = if reached { Status::Estimated } else { Status::Open };
                let codes = codes(value, e.half_width);
                Pixel { value, half_width: e.half_width, codes, status, evaluations, samples: e.samples }
            }
            None => {
                let (value, half_width, codes) = judged(known, target);
                Pixel { value, half_width, codes, status: Status::Open, evaluations, samples: 0 }
            }
        }
    }
}

fn smaller_u32(a: u32, b: u32) -> u32 {
    if a < b { a } else { b }
}

/// What is unknown of a region, in codes of the pixel.
fn width(bound: &Bound, share: f64, slopes: [f64; 3]) -> f64 {
    (0..3).map(|c| share * (bound.sum[c][1] - bound.sum[c][0]) * slopes[c]).fold(0.0, larger)
}

/// Codes for a unit of light, over an interval.
fn slope([lo, hi]: Span) -> f64 {
    let hi = larger(hi, lo + 1e-3); // anything small: of a single value, the curve's own slope nearly
    (code(hi) - code(lo)) / (hi - lo)
}
