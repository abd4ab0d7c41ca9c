//! A setting that was measured.

use super::axis::Axis;
use super::maker::{Claim, Cost};
use super::setting::Setting;
use crate::film::metric::Truth;
use crate::film::metric::{Errors, Range};
use crate::render::certify::{Pixel, Status};

/// A setting, what it took and how far its picture is from the truth.
#[derive(Clone, Debug)]
pub struct Point {
    /// The setting.
    pub setting: Setting,
    /// The dials of which it is a position; none for the scene's own setting that no dial has.
    pub axes: Vec<Axis>,
    /// What it took.
    pub cost: Cost,
    /// What its picture says of its own error.
    pub claim: Option<Claim>,
    /// How many pixels break that.
    pub broken: Broken,
    /// How far its picture is from the truth.
    pub errors: Errors,
    /// The largest difference, in codes, from the picture of the scene's own setting.
    pub change: f64,
    /// The codes of its picture, channel by channel.
    pub codes: Vec<u8>,
}

/// Pixels that are further from the truth than was said of them, the truth's own uncertainty taken off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Broken {
    /// Of those that were proved.
    pub proved: usize,
    /// Of those that were bounded.
    pub bounded: usize,
    /// Of those that were estimated.
    pub estimated: usize,
}

impl Point {
    /// Where it stands: seconds and an error.
    pub fn place(&self, error: impl Fn(&Errors) -> Range) -> (f64, f64) {
        (self.cost.seconds, error(&self.errors).value)
    }
}

impl Broken {
    /// Of a picture whose codes were written as `codes`.
    pub fn count(codes: &[u8], certified: &[Pixel], truth: &Truth) -> Broken {
        let mut broken = Broken::default();
        let all = certified.iter().zip(codes.as_chunks::<3>().0).zip(truth.codes.iter().zip(&truth.uncertainty));
        for ((pixel, written), (exact, uncertainty)) in all {
            let is_broken = |c: usize| (written[c] as f64 - exact[c]).abs() - uncertainty > pixel.codes + SLACK;
            if (0..3).any(is_broken) {
                match pixel.status {
                    Status::Proved => broken.proved += 1,
                    Status::Bounded => broken.bounded += 1,
                    Status::Estimated => broken.estimated += 1,
                    Status::Open => {}
                }
            }
        }
        broken
    }
}

/// In codes: pictures are kept in 32 bits, which moves a code by half this at most.
const SLACK: f64 = 1e-4;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::color::decode_srgb;

    #[test]
    fn only_what_is_surely_broken_counts() {
        let light = |code: f64| [decode_srgb(code / 255.0); 3];
        let truth =
            Truth::new(4, 1, [(light(100.0), 0.5), (light(100.0), 0.5), (light(100.0), 0.5), (light(9.0), 0.5)]);
        let pixel = |codes, status| Pixel { codes, status, ..Pixel::unknown() };
        let certified = [
            pixel(2.0, Status::Proved),
            pixel(2.0, Status::Proved),
            pixel(2.0, Status::Bounded),
            pixel(2.0, Status::Open),
        ];
        let codes: Vec<u8> = [102u8, 103, 97, 200].into_iter().flat_map(|c| [c; 3]).collect();
        let broken = Broken::count(&codes, &certified, &truth);
        assert_eq!(broken, Broken { proved: 1, bounded: 1, estimated: 0 });
    }
}
