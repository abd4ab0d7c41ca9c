//! One pixel to its target: regions first; then samples in those that stay wide; or samples alone.

use super::super::bounds::{larger, smaller};
use super::bound::{Span, hull};
use super::certifier::Certifier;
use super::estimate::{Estimate, estimate};
use super::leaves::{Leaf, Plan, judged, total};
use super::looks::{Found, Looked};
use super::sampler::Sampler;
use super::target::{Pixel, Status, Target, stored};
use crate::math::hash::KeyedHash;

/// Tags of what random numbers are for.
const JITTER: u64 = 1;
const REPLICATE: u64 = 2;

impl Certifier<'_> {
    /// Brings pixel (x, y) to its target as far as the target's budgets allow; with up to `affordable` samples for certainty.
    pub fn pixel(&self, sampler: &mut dyn Sampler, at: [u32; 2], target: &Target, affordable: u32) -> Pixel {
        if !target.certificates {
            let range = self.ceiling(self.depth);
            return self.estimated(sampler, at, (range, range), 0, target);
        }
        let Looked { leaves, evaluations, found } = self.looks(at, target, affordable);
        match found {
            Found::Proved(pixel) => pixel,
            Found::Planned(plan) => self.sampled(sampler, at, &leaves, (&plan, evaluations), target),
            Found::Hopeless => {
                let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
                for leaf in &leaves {
                    range = [0, 1, 2].map(|c| hull(range[c], leaf.bound.range[c]));
                }
                self.estimated(sampler, at, (total(&leaves), range), evaluations, target)
            }
        }
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
        let value = [0, 1, 2].map(|c| stored(value[c].clamp(known[c][0], known[c][1])));
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
        let enough = |e: &Estimate| match codes(e.value, e.half_width) <= target.codes {
            true => Some(true),
            // More samples won't help.
            false => (e.left_out != [0.0; 3] && codes(e.value, e.left_out) > 0.5 * target.codes).then_some(false),
        };
        let onward = self.ceiling(self.depth.saturating_sub(1));
        let brightest = (0..3).map(|c| onward[c][1]).fold(0.0, larger);
        let budget = (target, target.samples);
        sampler.leave_out(if brightest > 0.0 { target.faint() / brightest } else { 0.0 });
        let mut found = estimate(sampler, rect, budget, (range, onward), key, enough);
        sampler.leave_out(0.0);
        if found.as_ref().is_some_and(|(e, reached)| !reached && e.left_out != [0.0; 3]) {
            let traced = found.map_or(0, |(e, _)| e.samples);
            found = estimate(sampler, rect, budget, (range, onward), key, enough);
            found.iter_mut().for_each(|(e, _)| e.samples += traced);
        }
        match found {
            Some((e, reached)) => {
                let value = [0, 1, 2].map(|c| stored(e.value[c].clamp(known[c][0], known[c][1])));
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
