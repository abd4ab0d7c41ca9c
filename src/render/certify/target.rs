//! What is asked of a picture, and what is answered: errors are judged after the sRGB curve, in codes.

use super::super::bounds::{larger, smaller};
use super::bound::Span;
use crate::scene::color::{decode_srgb, encode_srgb};

/// What rounding may add to an error, in codes: the curve's two formulas, by which this is judged and that is written, meet to 1e-7
/// of white only.
const CURVE: f64 = 5e-5;

/// What is asked of every pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Largest error between the written code and the true mean of the pixel's light, in codes of 8 bits: steps of 1/255.
    pub codes: f64,
    /// The distance of codes that can be written: 1 in a file of 8 bits, 1/257 of 16 bits, 0 where colours aren't rounded.
    pub quantum: f64,
    /// Probability with which a pixel that is [`Bounded`](Status::Bounded) keeps it.
    pub confidence: f64,
    /// Regions of a pixel that are looked at before sampling is tried in earnest.
    pub evaluations: u32,
    /// Most samples of a pixel.
    pub samples: u32,
    /// Whether regions are looked at. Without them pixels are [`Estimated`](Status::Estimated) at best.
    pub certificates: bool,
    /// The share of each interval's width that is believed: 1, but for the negative control that shows that less is found out.
    pub believed: f64,
}

impl Target {
    /// An error of so many codes in a file of 8 bits, with confidence 0.999 and room enough for what the examples need.
    pub fn new(codes: f64) -> Target {
        Target {
            codes,
            quantum: 1.0,
            confidence: 0.999,
            evaluations: 512,
            samples: 1 << 18,
            certificates: true,
            believed: 1.0,
        }
    }

    /// What is left of the error when the rounding of written codes is taken out, and that of light to the film's numbers: 24
    /// bits, and a code changes by less than 255 of its relative change.
    pub(super) fn before_rounding(&self) -> f64 {
        larger(self.codes - 0.5 * self.quantum - 256.0 / (1u32 << 24) as f64 - CURVE, 0.0)
    }

    /// So little light of a channel changes a middle grey by 1/32 of the error: where rays go on, what brings less is left out, and
    /// counted as unknown.
    pub(super) fn faint(&self) -> f64 {
        self.codes / 32.0 * room(0.2, 1.0)
    }

    /// The largest distance, in codes, between the code written for `value` and any value from `lo` to `hi`.
    pub(super) fn error(&self, value: f64, [lo, hi]: Span) -> f64 {
        self.apart(value, [code(lo), code(hi)])
    }

    /// The same, for codes from `lo` to `hi`.
    fn apart(&self, value: f64, [lo, hi]: Span) -> f64 {
        let code = code(value);
        let written = if self.quantum > 0.0 { (code / self.quantum).round() * self.quantum } else { code };
        let [lo, hi] = [lo, hi].map(|end| code + self.believed * (end - code));
        larger(hi - written, written - lo) + CURVE
    }

    /// The value in an interval that is about half-way between its codes, as it is stored, and its error.
    pub(super) fn settled(&self, [lo, hi]: Span) -> (f64, f64) {
        let codes = [code(lo), code(hi)];
        // Where it is short, the curve is straight.
        let value = match codes[1] - codes[0] > STRAIGHT && lo >= 0.0 && hi <= 1.0 {
            true => decode_srgb((codes[0] + codes[1]) * (0.5 / 255.0)),
            false => 0.5 * lo + 0.5 * hi,
        };
        let value = stored(value);
        (value, self.apart(value, codes))
    }
}

/// Light as the film stores it.
pub(super) fn stored(v: f64) -> f64 {
    v as f32 as f64
}

/// So many codes further on, the curve bends by less than a hundredth of a code: by c²/(8·255·0.42·2.4) at most, where it is darkest.
const STRAIGHT: f64 = 0.25;

/// How sure the error of a pixel is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// It is no larger, for certain.
    Proved,
    /// It isn't, with the probability asked for at least, whatever the scene.
    Bounded,
    /// It isn't, as far as samples can tell: by an interval that is right for many samples of a well-behaved scene.
    Estimated,
    /// The budget was spent before the target was reached. The error is what samples say, if there are any; else nothing is known.
    Open,
}

/// A pixel's value and how far off it may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Linear light.
    pub value: [f64; 3],
    /// By channel, half the width of the interval around the value that the status speaks of, linear.
    pub half_width: [f64; 3],
    /// The largest error of the written codes.
    pub codes: f64,
    /// How sure that is.
    pub status: Status,
    /// Regions looked at.
    pub evaluations: u32,
    /// Rays from the camera.
    pub samples: u32,
}

impl Pixel {
    /// A pixel before anything is known of it. It is black, and no code is further than 255 from that.
    pub const fn unknown() -> Pixel {
        Pixel {
            value: [0.0; 3],
            half_width: [f64::INFINITY; 3],
            codes: 255.0,
            status: Status::Open,
            evaluations: 0,
            samples: 0,
        }
    }

    /// Whether it keeps an error of so many codes.
    pub fn keeps(&self, codes: f64) -> bool {
        self.status != Status::Open && self.codes <= codes
    }

    /// It with another value, or as near to that as its interval and the target allow.
    pub(super) fn with_value(&self, value: [f64; 3], target: &Target) -> Pixel {
        let (mut at, mut half_width, mut codes) = (self.value, self.half_width, 0.0);
        let reach = target.before_rounding();
        for c in 0..3 {
            let (lo, hi) = (self.value[c] - self.half_width[c], self.value[c] + self.half_width[c]);
            // No further from either end than the target is.
            let (least, most) = (larger(code(hi) - reach, code(lo)), smaller(code(lo) + reach, code(hi)));
            let wanted = code(value[c]);
            if least <= wanted && wanted <= most {
                at[c] = stored(value[c]);
            } else if least <= most {
                at[c] = stored(decode_srgb(if wanted < least { least } else { most } / 255.0));
            }
            half_width[c] = larger(hi - at[c], at[c] - lo);
            codes = larger(codes, target.error(at[c], [lo, hi]));
        }
        if codes <= target.codes { Pixel { value: at, half_width, codes, ..*self } } else { *self }
    }

    /// What is known after another attempt. What fell short of its target replaces nothing that is certain or likely.
    pub(super) fn and_then(self, found: Pixel) -> Pixel {
        let falls_short = found.status == Status::Open && (self.status != Status::Open || self.codes <= found.codes);
        Pixel {
            evaluations: self.evaluations.saturating_add(found.evaluations),
            samples: self.samples.saturating_add(found.samples),
            ..if falls_short { self } else { found }
        }
    }
}

/// The code of 8 bits, not rounded, of linear light.
pub fn code(v: f64) -> f64 {
    255.0 * encode_srgb(v.clamp(0.0, 1.0))
}

/// How much more light than `v` a channel may hold without its code growing by more than `codes`: a trifle less.
pub(super) fn room(v: f64, codes: f64) -> f64 {
    let v = v.clamp(0.0, 1.0);
    match code(v) + codes {
        // Beyond the last code all light is the same.
        most if most >= 255.0 => 1.0,
        most => larger(decode_srgb(most / 255.0) - v, 0.0) * (1.0 - 1.0 / (1u64 << 30) as f64),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_those_of_written_codes() {
        let target = Target::new(2.0);
        assert!((target.error(0.5, [0.5, 0.5]) - (code(0.5) - code(0.5).round()).abs()).abs() <= CURVE);
        let exact = Target { quantum: 0.0, ..target };
        assert!(exact.error(0.5, [0.5, 0.5]) <= CURVE);
        for (lo, hi) in [(0.1, 0.2), (0.0, 0.001), (0.003, 0.00302), (0.9, 0.9001), (-1.0, 0.5), (0.5, 3.0)] {
            let (value, error) = exact.settled([lo, hi]);
            let half = 0.5 * (code(hi) - code(lo));
            assert!(
                error >= half - 1e-9 && (lo < 0.0 || hi > 1.0 || error < half + 0.01),
                "{lo} {hi}: {value} {error}"
            );
            assert_eq!(value, value as f32 as f64);
        }
    }

    #[test]
    fn another_value_stays_in_the_interval_and_keeps_the_error() {
        let pixel =
            Pixel { value: [0.5; 3], half_width: [0.02; 3], status: Status::Proved, codes: 5.0, ..Pixel::unknown() };
        let wide = Target::new(16.0);
        let moved = pixel.with_value([0.51, 0.5, 0.9], &wide);
        assert_eq!((moved.value[0], moved.value[1], moved.status), (stored(0.51), 0.5, Status::Proved));
        assert!((moved.value[2] - 0.52).abs() < 1e-6 && (moved.half_width[2] - 0.04).abs() < 1e-6);
        assert!(moved.codes > wide.error(0.5, [0.48, 0.52]) && moved.codes <= 16.0);
        // Of a tighter target it goes less far.
        let tight = Target::new(6.0);
        let less = pixel.with_value([0.9; 3], &tight);
        assert!(less.value[0] > 0.5 && less.value[0] < 0.52 && less.codes <= 6.0 && less.codes > 5.0, "{less:?}");
        assert_eq!(pixel.with_value([0.9; 3], &Target::new(3.0)), pixel, "it doesn't keep that itself");
    }

    #[test]
    fn there_is_more_room_in_the_light() {
        let rooms = [0.0, 0.01, 0.2, 0.9].map(|v| room(v, 2.0));
        assert!(rooms.windows(2).all(|w| w[1] > w[0]), "{rooms:?}");
        assert!((code(0.2 + rooms[2]) - code(0.2) - 2.0).abs() < 1e-6);
        assert!(
            (0..1000)
                .all(|i| code(i as f64 * 0.00099 + room(i as f64 * 0.00099, 0.5)) - code(i as f64 * 0.00099) <= 0.5)
        );
    }
}
