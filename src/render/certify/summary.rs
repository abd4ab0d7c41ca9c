//! A certified picture in a few numbers.

use super::super::bounds::larger;
use super::target::{Pixel, Status};

/// How many pixels of a picture have which status, how far off they may be, and what that took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Summary {
    /// Pixels that keep the error for certain.
    pub proved: usize,
    /// Pixels that keep it with the confidence asked for, whatever the scene.
    pub bounded: usize,
    /// Pixels that keep it as far as samples can tell.
    pub estimated: usize,
    /// Pixels that don't keep it, or of which nothing is known.
    pub open: usize,
    /// The worst pixel of each of the first three kinds; `None` where there is none of that kind.
    pub worst: [Option<Worst>; 3],
    /// Regions looked at.
    pub evaluations: u64,
    /// Rays from the camera.
    pub samples: u64,
}

/// The pixel that may be furthest off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worst {
    /// Its largest error, in codes of 8 bits.
    pub codes: f64,
    /// Its number, row by row, from 0: the first of those that are equally bad.
    pub at: usize,
}

impl Summary {
    /// Of pixels that are to keep an error of `codes`; those that don't count as open, whatever holds of the error that they do
    /// keep. With `f64::INFINITY`: of what was reached, wherever that is.
    pub fn of(pixels: &[Pixel], codes: f64) -> Summary {
        let mut sum = Summary::default();
        for (at, p) in pixels.iter().enumerate() {
            sum.evaluations += p.evaluations as u64;
            sum.samples += p.samples as u64;
            let kind = match p.status {
                Status::Proved => 0,
                Status::Bounded => 1,
                Status::Estimated => 2,
                Status::Open => 3,
            };
            if kind == 3 || !(p.codes <= codes) {
                sum.open += 1;
                continue;
            }
            *[&mut sum.proved, &mut sum.bounded, &mut sum.estimated][kind] += 1;
            let worst = &mut sum.worst[kind];
            if worst.is_none_or(|w| p.codes > w.codes) {
                *worst = Some(Worst { codes: p.codes, at });
            }
        }
        sum
    }

    /// All pixels.
    pub fn pixels(&self) -> usize {
        self.proved + self.bounded + self.estimated + self.open
    }

    /// The largest error in codes that a pixel may have which isn't open; 0 without one.
    pub fn worst_codes(&self) -> f64 {
        self.worst.iter().flatten().fold(0.0, |m, w| larger(m, w.codes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_doesnt_keep_the_error_is_open() {
        let pixel = |status, codes| Pixel { status, codes, evaluations: 2, samples: 3, ..Pixel::unknown() };
        let pixels = [
            pixel(Status::Proved, 0.5),
            pixel(Status::Proved, 1.5),
            pixel(Status::Bounded, 2.5),
            pixel(Status::Estimated, 1.75),
            pixel(Status::Proved, 1.5),
            Pixel::unknown(),
        ];
        let at_2 = Summary::of(&pixels, 2.0);
        assert_eq!((at_2.proved, at_2.bounded, at_2.estimated, at_2.open), (3, 0, 1, 2));
        assert_eq!(at_2.worst, [Some(Worst { codes: 1.5, at: 1 }), None, Some(Worst { codes: 1.75, at: 3 })]);
        assert_eq!((at_2.worst_codes(), at_2.evaluations, at_2.samples), (1.75, 10, 15));
        let reached = Summary::of(&pixels, f64::INFINITY);
        assert_eq!((reached.bounded, reached.open, reached.worst_codes(), reached.pixels()), (1, 1, 2.5, 6));
    }
}
