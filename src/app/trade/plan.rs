//! Which settings are measured: one dial is turned at a time, all others stay as the scene has them.

use super::axis::Axis;
use super::setting::{Setting, Way};
use crate::scene::{Precision, Settings};

/// Errors that are asked for, in codes of 8 bits, from the cheapest on.
const ERRORS: [f64; 5] = [16.0, 8.0, 4.0, 2.0, 1.0];
/// Rays along a side of a pixel.
const GRIDS: [u32; 10] = [1, 2, 3, 4, 6, 8, 12, 16, 24, 32];
/// The most further rays of a pixel that differs from its neighbours.
const ADAPTIVE: [u32; 5] = [4, 16, 64, 256, 1024];
/// Seconds. The shortest serves small pictures, the longest is left out where the budget is smaller.
const TIMES: [f64; 8] = [0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0];
/// Recursion limits below the scene's own.
const DEPTHS: [u32; 13] = [0, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64];
/// Errors that are also reached by samples alone: they take long.
const SAMPLED: [f64; 2] = [16.0, 4.0];

/// Ways of the mixed settings, from the cheapest to the dearest.
const MIXED: [Way; 6] =
    [Way::Grid(1), Way::Grid(2), Way::Adaptive(16), Way::Adaptive(64), Way::Grid(6), Way::Adaptive(256)];
/// The depth that each of them gets, in sixths of the scene's own: a Latin hypercube (McKay, Beckman, Conover, Technometrics 21, 1979),
/// in which every sixth of a dial is taken once. Of the 720 permutations one without a trend.
const SIXTHS: [u32; 6] = [4, 2, 6, 1, 5, 3];

/// The reference is known this many times better than the smallest error that is swept.
pub const REFERENCE_FACTOR: f64 = 4.0;

/// The smallest error that is swept, in codes.
pub fn smallest_error() -> f64 {
    ERRORS[ERRORS.len() - 1]
}

/// The positions of one dial, from the cheapest to the dearest; `base` itself is among them where it is one of them.
pub fn positions(axis: Axis, base: &Setting) -> Vec<Setting> {
    let way = |way| Setting { way, ..*base };
    match axis {
        Axis::Error => ERRORS.map(|e| way(Way::Error(e))).into(),
        Axis::Samples => {
            let mut grids = GRIDS.to_vec();
            if let Way::Grid(own) = base.way {
                grids.push(own);
            }
            grids.sort_unstable();
            grids.dedup();
            grids.into_iter().map(|n| way(Way::Grid(n))).collect()
        }
        Axis::Adaptive => ADAPTIVE.map(|n| way(Way::Adaptive(n))).into(),
        Axis::Time => TIMES.map(|s| way(Way::Time(s))).into(),
        Axis::Depth => {
            let deeper = (2 * base.depth).clamp(1, Settings::LARGEST_DEPTH);
            let mut depths: Vec<u32> = DEPTHS.into_iter().filter(|d| *d < base.depth).collect();
            depths.extend([base.depth, deeper]);
            depths.dedup();
            depths.into_iter().map(|depth| Setting { depth, ..*base }).collect()
        }
        Axis::Precision => [Precision::F32, Precision::F64].map(|precision| Setting { precision, ..*base }).into(),
        Axis::Mixed => {
            let mix = |(way, sixths): (Way, u32)| Setting { way, depth: (base.depth * sixths).div_ceil(6), ..*base };
            MIXED.into_iter().zip(SIXTHS).map(mix).collect()
        }
        Axis::Certificates => SAMPLED.map(|e| way(Way::Sampled(e))).into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BASE: Setting = Setting { way: Way::Grid(5), depth: 5, precision: Precision::F64 };

    #[test]
    fn one_dial_at_a_time() {
        for axis in Axis::ALL.into_iter().filter(|a| *a != Axis::Mixed) {
            for s in positions(axis, &BASE) {
                let turned = [s.way != BASE.way, s.depth != BASE.depth, s.precision != BASE.precision];
                assert!(turned.iter().filter(|t| **t).count() <= 1, "{axis:?} {s:?}");
            }
        }
        let depths: Vec<u32> = positions(Axis::Depth, &BASE).iter().map(|s| s.depth).collect();
        assert_eq!(depths, [0, 1, 2, 3, 4, 5, 10]);
        let shallow: Vec<u32> = positions(Axis::Depth, &Setting { depth: 0, ..BASE }).iter().map(|s| s.depth).collect();
        assert_eq!(shallow, [0, 1]);
        assert!(positions(Axis::Samples, &BASE).contains(&BASE));
        let mut depths: Vec<u32> =
            positions(Axis::Mixed, &Setting { depth: 6, ..BASE }).iter().map(|s| s.depth).collect();
        depths.sort_unstable();
        assert_eq!(depths, [1, 2, 3, 4, 5, 6]);
    }
}
