//! One pixel to its target: regions first; then samples in those that stay wide; or samples alone.

use super::super::bounds::{larger, smaller};
use super::bound::{Span, hull};
use super::certifier::Certifier;
use super::estimate::{Estimate, estimate};
use super::leaves::{Leaf, Plan, judged, total};
use super::looks::{Found, Looked};
use super::memo::Memo;
use super::sampler::Sampler;
use super::target::{Pixel, Status, Target, stored};
use super::window::Spot;
use crate::math::hash::KeyedHash;

/// Tags of what random numbers are for.
const JITTER: u64 = 1;
const REPLICATE: u64 = 2;

impl Certifier<'_> {
    /// Brings pixel (x, y) to its target as far as the target's budgets allow; with up to `affordable` samples for certainty.
    pub fn pixel(
        &self,
        sampler: &mut dyn Sampler,
        memo: &mut Memo,
        at: [u32; 2],
        target: &Target,
        affordable: u32,
    ) -> Pixel {
        if !target.certificates {
            let range = self.ceiling(self.depth).map(|r| self.window.spanned(r));
            return self.estimated(sampler, at, (range, range), 0, target);
        }
        let Looked { leaves, evaluations, found } = self.looks(memo, at, target, affordable);
        match found {
            Found::Proved(pixel) => pixel,
            Found::Planned(plan) => self.sampled(sampler, at, &leaves, (&plan, evaluations), target),
            Found::Hopeless => {
                let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
                for leaf in &leaves {
                    range = [0, 1, 2].map(|c| hull(range[c], leaf.bound.range[c]));
                }
                let range = range.map(|r| self.window.spanned(r));
                self.estimated(sampler, at, (total(&leaves), range), evaluations, target)
            }
        }
    }

    /// Samples as planned.
    fn sampled(
        &self,
        sampler: &mut dyn Sampler,
        at: [u32; 2],
        leaves: &[Leaf],
        (plan, evaluations): (&Plan, u32),
        target: &Target,
    ) -> Pixel {
        let key = KeyedHash::new().with(JITTER).with(at[0] as u64).with(at[1] as u64);
        let mut points = Vec::with_capacity(plan.total as usize);
        let mut whose = Vec::with_capacity(plan.total as usize);
        let mut value = [0.0; 3];
        for (i, (leaf, &n)) in leaves.iter().zip(&plan.samples).enumerate() {
            let settled = |c: usize| match n {
                0 => 0.5 * (leaf.part[c][0] + leaf.part[c][1]),
                _ => leaf.weights.of_linear(leaf.taken_off(c)),
            };
            value = [0, 1, 2].map(|c| value[c] + settled(c));
            for k in 0..n {
                // One in each of n upright strips.
                let unit = |axis: u64| key.with(i as u64).with(k as u64).with(axis).unit();
                let spot = self.window.spot(at, leaf.rect, [(k as f64 + unit(0)) / n as f64, unit(1)]);
                points.push(spot.at);
                whose.push((i, spot));
            }
        }
        sampler.trace(self.window.of(at), &points, &mut |k, light| {
            let (i, Spot { inner: [xi, eta], sign, .. }) = whose[k];
            let leaf = &leaves[i];
            let weight = sign * leaf.weights.size / plan.samples[i] as f64;
            for c in 0..3 {
                // Its integral is known: without it samples are closer together, and as far to both sides.
                let known = leaf.taken_off(c);
                value[c] += weight * (light[c] - (known.c + (known.x * xi + known.y * eta)));
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

    /// Samples of the whole pixel, where bounds are of no use; its value is `known` to lie somewhere, and in `range` by the range of
    /// its light alone.
    fn estimated(
        &self,
        sampler: &mut dyn Sampler,
        at: [u32; 2],
        (known, range): ([Span; 3], [Span; 3]),
        evaluations: u32,
        target: &Target,
    ) -> Pixel {
        let key = KeyedHash::new().with(REPLICATE).with(at[0] as u64).with(at[1] as u64);
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
        let mut found = estimate(sampler, (&self.window, at), budget, (range, onward), key, enough);
        sampler.leave_out(0.0);
        if found.as_ref().is_some_and(|(e, reached)| !reached && e.left_out != [0.0; 3]) {
            let traced = found.map_or(0, |(e, _)| e.samples);
            found = estimate(sampler, (&self.window, at), budget, (range, onward), key, enough);
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
