//! Where no bound is useful: independent replicates of a scrambled sequence, and Student's interval for their mean.
//!
//! Each look costs a share of the error probability, and the interval is never narrower than what n samples that all agree
//! leave open: a feature of up to 3/n of the pixel (the rule of three), as bright as anything can be there.

use super::super::bounds::{larger, smaller};
use super::super::sobol;
use super::bound::Span;
use super::sampler::Sampler;
use super::target::Target;
use super::window::{Spot, Window};
use crate::math::fun;
use crate::math::hash::KeyedHash;

/// Independent sequences. With fewer of them their points are better spread, and Student's factor is larger: with 8 the interval is
/// about as wide again where light varies at random, and a third wider along edges.
const REPLICATES: usize = 32;

/// Points of each sequence at the first look.
const FIRST: u32 = 8;

/// A mean and the interval around it.
pub struct Estimate {
    /// Linear light.
    pub value: [f64; 3],
    /// Half the interval.
    pub half_width: [f64; 3],
    /// How much of that is for rays that were left out.
    pub left_out: [f64; 3],
    /// Rays.
    pub samples: u32,
}

/// Samples pixel `at`, twice as often each time, until `is_enough` says whether that is so, or the budget is spent. `range` is where its
/// value lies by the range of its light alone, `onward` where the light of any ray lies that goes on.
pub fn estimate(
    sampler: &mut dyn Sampler,
    (window, at): (&Window, [u32; 2]),
    (target, budget): (&Target, u32),
    (range, onward): ([Span; 3], [Span; 3]),
    key: KeyedHash,
    is_enough: impl Fn(&Estimate) -> Option<bool>,
) -> Option<(Estimate, bool)> {
    let looks = (budget / (FIRST * REPLICATES as u32)).checked_ilog2()? + 1;
    // All channels and looks together are to keep the confidence.
    let t = student(REPLICATES - 1, (1.0 - target.confidence) / (3.0 * looks as f64));
    let mut sums = [[0.0; 3]; REPLICATES];
    let (mut done, mut left_out) = (0, 0.0);
    sampler.left_out();
    let rect = window.of(at);
    // With negative weights, what all points have in common is left out of their sum: the less is left to chance.
    let common = if window.size() > 1.0 { middle(sampler, at) } else { [0.0; 3] };
    let (mut points, mut signs) = (Vec::new(), Vec::new());
    for look in 0..looks {
        let n = FIRST << look;
        for (replicate, sum) in sums.iter_mut().enumerate() {
            let key = key.with(replicate as u64);
            points.clear();
            signs.clear();
            for i in done..n {
                let Spot { at, sign, .. } = window.spot(at, rect, sobol::point(i, key));
                points.push(at);
                signs.push(sign);
            }
            sampler.trace(rect, &points, &mut |i, light| {
                for c in 0..3 {
                    sum[c] += signs[i] * (light[c] - common[c]);
                }
            });
        }
        done = n;
        let samples = n * REPLICATES as u32;
        left_out += sampler.left_out();
        let lost = window.size() * (left_out / samples as f64);
        let mut e = Estimate { value: [0.0; 3], half_width: [0.0; 3], left_out: [0.0; 3], samples };
        for c in 0..3 {
            let means = sums.map(|s| common[c] + window.size() * (s[c] / n as f64));
            let mean = means.iter().sum::<f64>() / REPLICATES as f64;
            let squares: f64 = means.iter().map(|m| (m - mean) * (m - mean)).sum();
            let deviation = (squares / ((REPLICATES - 1) * REPLICATES) as f64).sqrt();
            let unseen = (range[c][1] - range[c][0]) * 3.0 / samples as f64;
            // Weights of rays are negative where light may be, too; then its range is as wide to both sides. As it is with negative
            // weights of points.
            let [lo, hi] = onward[c];
            let (middle, off) =
                if lo < 0.0 || window.size() > 1.0 { (0.0, lost * hi) } else { (0.5 * lost * hi, 0.5 * lost * hi) };
            e.value[c] = larger(smaller(mean + middle, range[c][1]), range[c][0]);
            e.half_width[c] = larger(t * deviation, unseen) + off;
            e.left_out[c] = off;
        }
        if let Some(is_enough) = is_enough(&e).or((look + 1 == looks).then_some(false)) {
            return Some((e, is_enough));
        }
    }
    None
}

/// The light in the middle of a pixel.
fn middle(sampler: &mut dyn Sampler, at: [u32; 2]) -> [f64; 3] {
    let [x, y] = at.map(f64::from);
    let mut found = [0.0; 3];
    sampler.trace([x, y, x + 1.0, y + 1.0], &[[x + 0.5, y + 0.5]], &mut |_, light| found = light);
    sampler.left_out();
    found
}

/// The t that Student's distribution with an odd number of degrees of freedom exceeds, in magnitude, with probability `alpha`
/// (Abramowitz, Stegun, 26.7.3).
fn student(freedom: usize, alpha: f64) -> f64 {
    let root = (freedom as f64).sqrt();
    let within = |t: f64| {
        let theta = fun::atan(t / root);
        let cos = 1.0 / (1.0 + t / root * (t / root)).sqrt();
        // 1 + 2/3 cos² (1 + 4/5 cos² (1 + … )), up to the factor (n − 3)/(n − 2).
        let series =
            (2..freedom - 1).step_by(2).rev().fold(1.0, |s, k| 1.0 + k as f64 / (k + 1) as f64 * cos * cos * s);
        std::f64::consts::FRAC_2_PI * (theta + t / root * cos * cos * series)
    };
    let (mut lo, mut hi) = (0.0, 1e6);
    for _ in 0..64 {
        let middle = 0.5 * (lo + hi);
        if within(middle) < 1.0 - alpha { lo = middle } else { hi = middle }
    }
    hi
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (freedom, alpha, t) in [
            (7, 0.1, 1.895),
            (7, 0.05, 2.365),
            (7, 0.01, 3.499),
            (7, 0.001, 5.408),
            (3, 0.05, 3.182),
            (31, 0.01, 2.744),
        ] {
            assert!((student(freedom, alpha) - t).abs() < 6e-4, "{freedom}, {alpha}: {}", student(freedom, alpha));
        }
    }
}
