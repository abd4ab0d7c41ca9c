//! The metrics of a picture beside the truth.

use super::flip::Flip;
use super::truth::Truth;
use crate::film::{Depth, Developer};
use crate::math::fun;
use crate::scene::color::decode_srgb;

/// What is added to the square of the true light where [`Errors::rel_mse`] divides by it: the usual constant of papers on
/// adaptive sampling since Rousselle, Knaus & Zwicker (*Adaptive Sampling and Reconstruction using Greedy Error
/// Minimization*, 2011). It is the square of a light of 0.1, code 89: what is darker counts by its difference, what is
/// brighter by its share.
const REL_MSE_FLOOR: f64 = 1e-2;

/// A figure that was measured beside a truth which is itself uncertain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// As measured.
    pub value: f64,
    /// The truth's own uncertainty taken off.
    pub least: f64,
    /// The truth's own uncertainty added.
    pub most: f64,
}

/// How far a written picture of 8 bits is from the truth, in codes: steps of 1/255. The truth isn't rounded, so a perfect
/// picture has errors up to half a code.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// The largest of any channel of any pixel.
    pub max: Range,
    /// 99 of 100 pixels have no larger one, whichever channel.
    pub p99: Range,
    /// The root of the mean of its square, over all channels.
    pub rmse: Range,
    /// 20 log10 (255 / RMSE), in decibels; infinite where the RMSE is 0.
    pub psnr: f64,
    /// The mean over all channels of (x - r)² / (r² + 0.01), where x and r are linear light from 0 to 1: an error counts by
    /// its share of the light.
    pub rel_mse: f64,
    /// The mean of [`Flip`], from 0 to 1, between the written codes of both.
    pub flip: f64,
}

impl Errors {
    /// Of a picture's codes, channel by channel, beside the truth and what people see of it. Both are of the same size.
    pub fn of(codes: &[u8], truth: &Truth, seen: &Flip) -> Errors {
        let (triples, _) = codes.as_chunks::<3>();
        let off = |(written, (exact, u)): (&[u8; 3], (&[f64; 3], &f64))| {
            let off = [0, 1, 2].map(|c| (written[c] as f64 - exact[c]).abs());
            (off, *u)
        };
        let all = || triples.iter().zip(truth.codes.iter().zip(&truth.uncertainty)).map(off);
        let channels = larger(3.0 * triples.len() as f64, 1.0);
        let (mut squares, mut uncertain) = (0.0, 0.0);
        for (off, u) in all() {
            squares += off[0] * off[0] + off[1] * off[1] + off[2] * off[2];
            uncertain += 3.0 * u * u;
        }
        let (rmse, about) = ((squares / channels).sqrt(), (uncertain / channels).sqrt());
        // The triangle's inequality holds of roots of mean squares too (Minkowski).
        let rmse = Range { value: rmse, least: larger(rmse - about, 0.0), most: rmse + about };
        let by_pixel = |sign: f64| {
            let one = |(off, u): ([f64; 3], f64)| larger(off.into_iter().fold(0.0, larger) + sign * u, 0.0);
            Spread::of(all().map(one).collect())
        };
        let [value, least, most] = [0.0, -1.0, 1.0].map(by_pixel);
        Errors {
            max: Range { value: value.max, least: least.max, most: most.max },
            p99: Range { value: value.p99, least: least.p99, most: most.p99 },
            rmse,
            psnr: 20.0 * fun::log10(255.0 / rmse.value),
            rel_mse: rel_mse(codes, truth) / channels,
            flip: seen.difference(&Flip::new(codes, truth.width)),
        }
    }
}

/// The ends of a list of errors.
struct Spread {
    max: f64,
    p99: f64,
}

impl Spread {
    fn of(mut errors: Vec<f64>) -> Spread {
        if errors.is_empty() {
            return Spread { max: 0.0, p99: 0.0 };
        }
        // The nearest rank: the smallest error that 99 % aren't above.
        let rank = (99 * errors.len()).div_ceil(100) - 1;
        let (_, p99, above) = errors.select_nth_unstable_by(rank, f64::total_cmp);
        Spread { p99: *p99, max: above.iter().fold(*p99, |max, e| larger(max, *e)) }
    }
}

fn rel_mse(codes: &[u8], truth: &Truth) -> f64 {
    let light: Vec<f64> = (0..=255).map(|code| decode_srgb(code as f64 / 255.0)).collect();
    let one = |(code, exact): (&u8, &f64)| {
        let (x, r) = (light[*code as usize], decode_srgb(*exact / 255.0));
        (x - r) * (x - r) / (r * r + REL_MSE_FLOOR)
    };
    codes.iter().zip(truth.codes.as_flattened()).map(one).sum()
}

/// The largest difference of two pictures in linear light, in codes of 8 bits but hardly rounded: to 1/257 of one.
pub fn change(a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
    let developer = Developer::of(Depth::Sixteen);
    let off = |(a, b): (&f32, &f32)| developer.code(*a).abs_diff(developer.code(*b));
    let most = a.as_flattened().iter().zip(b.as_flattened()).map(off).fold(0, u16::max);
    most as f64 / 257.0
}

fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn truth(codes: &[[f64; 3]], uncertainty: f64) -> Truth {
        let n = codes.len();
        Truth { width: n as u32, height: 1, codes: codes.to_vec(), uncertainty: vec![uncertainty; n] }
    }

    fn errors(codes: &[u8], truth: &Truth) -> Errors {
        Errors::of(codes, truth, &Flip::new(&truth.written(), truth.width))
    }

    #[test]
    fn by_hand() {
        let truth = truth(&[[10.0, 20.0, 30.0], [10.5, 20.0, 30.0]], 0.25);
        let e = errors(&[10, 20, 30, 14, 20, 27], &truth);
        assert_eq!(e.max, Range { value: 3.5, least: 3.25, most: 3.75 });
        let rmse = ((3.5f64 * 3.5 + 9.0) / 6.0).sqrt();
        assert!((e.rmse.value - rmse).abs() < 1e-12 && (e.rmse.most - rmse - 0.25).abs() < 1e-12);
        assert!((e.psnr - 20.0 * fun::log10(255.0 / rmse)).abs() < 1e-9);
        let light = |code: f64| decode_srgb(code / 255.0);
        let square = |x: f64| x * x;
        let part = |x: f64, r: f64| square(light(x) - light(r)) / (square(light(r)) + 0.01);
        assert!((e.rel_mse - (part(14.0, 10.5) + part(27.0, 30.0)) / 6.0).abs() < 1e-15);
        assert!(e.flip > 0.0 && e.flip < 1.0);
    }

    #[test]
    fn nothing_is_off_in_a_perfect_picture_but_rounding() {
        let exact = truth(&[[10.0, 20.0, 30.0]; 5], 0.0);
        let e = errors(&exact.written(), &exact);
        assert_eq!((e.max.most, e.p99.most, e.rmse.most, e.rel_mse, e.flip), (0.0, 0.0, 0.0, 0.0, 0.0));
        assert_eq!(e.psnr, f64::INFINITY);
        let between = truth(&[[10.5, 20.0, 30.0]; 5], 0.0);
        assert_eq!(errors(&between.written(), &between).max.value, 0.5);
    }

    /// One pixel of a hundred may be as wrong as it likes without moving the 99th percentile; two may not.
    #[test]
    fn p99_is_the_nearest_rank() {
        let truth = truth(&[[100.0; 3]; 100], 0.0);
        let mut codes = vec![100; 300];
        codes[7] = 200;
        let e = errors(&codes, &truth);
        assert_eq!((e.max.value, e.p99.value), (100.0, 0.0));
        codes[30] = 90;
        assert_eq!(errors(&codes, &truth).p99.value, 10.0);
    }

    #[test]
    fn changes_are_finer_than_a_code() {
        let light = |code: f64| [decode_srgb(code / 255.0) as f32; 3];
        let off = change(&[light(100.0), light(7.0)], &[light(100.0), light(7.3)]);
        assert!((off - 0.3).abs() < 1.0 / 256.0, "{off}");
        assert_eq!(change(&[light(9.0)], &[light(9.0)]), 0.0);
    }
}
