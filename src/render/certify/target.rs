//! What is asked of a picture, and what is answered: errors are judged after the sRGB curve, in codes.

use super::super::bounds::larger;
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
            evaluations: 256,
            samples: 1 << 17,
            certificates: true,
            believed: 1.0,
        }
    }

    /// What is left of the error when the rounding of written codes is taken out.
    pub(super) fn before_rounding(&self) -> f64 {
        larger(self.codes - 0.5 * self.quantum, 0.0)
    }

    /// The largest distance, in codes, between the code written for `value` and any value from `lo` to `hi`.
    pub(super) fn error(&self, value: f64, [lo, hi]: [f64; 2]) -> f64 {
        let code = code(value as f32 as f64); // as the film holds it
        let written = if self.quantum > 0.0 { (code / self.quantum).round() * self.quantum } else { code };
        let [lo, hi] = [lo, hi].map(|end| value + self.believed * (end - value));
        larger(self::code(hi) - written, written - self::code(lo)) + CURVE
    }
}

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

/// The value in an interval that is half-way between its codes, and how far its ends are.
pub(super) fn middle([lo, hi]: [f64; 2]) -> (f64, f64) {
    let value = match lo >= 0.0 && hi <= 1.0 {
        true => decode_srgb((code(lo) + code(hi)) * (0.5 / 255.0)).clamp(lo, hi),
        false => 0.5 * lo + 0.5 * hi,
    };
    (value, larger(value - lo, hi - value))
}

/// How much more light than `v` a channel may hold without its code growing by more than `codes`.
pub(super) fn room(v: f64, codes: f64) -> f64 {
    let v = v.clamp(0.0, 1.0);
    let (mut least, mut most) = (0.0, 1.0);
    for _ in 0..40 {
        let middle = 0.5 * (least + most);
        if code(v + middle) - code(v) <= codes && v + middle <= 1.0 {
            least = middle;
        } else {
            most = middle;
        }
    }
    least
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
        let (value, half) = middle([0.1, 0.2]);
        assert!(code(value) - code(0.1) - (code(0.2) - code(value)) < 1e-9 && half > 0.05);
    }

    #[test]
    fn there_is_more_room_in_the_light() {
        let rooms = [0.0, 0.01, 0.2, 0.9].map(|v| room(v, 2.0));
        assert!(rooms.windows(2).all(|w| w[1] > w[0]), "{rooms:?}");
        assert!((code(0.2 + rooms[2]) - code(0.2) - 2.0).abs() < 1e-6);
    }
}
