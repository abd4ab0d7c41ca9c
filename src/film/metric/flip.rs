//! FLIP: how different two pictures look when one sees them in turn, at the same place.
//!
//! Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström & Fairchild, *FLIP: A Difference Evaluator for Alternating Images*,
//! Proc. ACM Comput. Graph. Interact. Tech. 3(2), 2020; the form for pictures of low dynamic range. Colours are blurred as the
//! eye does at that distance and compared in a space in which large differences are even; where edges and points differ, the
//! difference counts for more. Written from the paper's formulas; the tests hold it to figures of the authors' own program.

use super::blur::{Plane, bell, normalized};
use super::opponent::{Spaces, hyab};
use crate::math::fun;
use crate::scene::color::decode_srgb;
use glam::DVec3;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// The paper's default: a screen 0.7 m wide with 3,840 pixels, seen from 0.7 m.
pub const PIXELS_PER_DEGREE: f64 = 3840.0 * PI / 180.0;

/// Contrast sensitivity of the eye as sums of Gaussians a √(π/b) exp(-π² d²/b), d in degrees (the paper's table 1): those of
/// luminance and of red against green have one term; these are their b.
const LUMINANCE_B: f64 = 0.0047;
const RED_GREEN_B: f64 = 0.0053;
/// The two terms (a, b) of yellow against blue.
const YELLOW_BLUE: [(f64, f64); 2] = [(34.1, 0.04), (13.5, 0.025)];

/// Compresses large differences of colour.
const Q_COLOR: f64 = 0.7;
/// Lifts small differences of edges and points.
const Q_FEATURE: f64 = 0.5;
/// Differences up to this share of the largest one …
const P_COLOR: f64 = 0.4;
/// … are stretched over this share of the result.
const P_TARGET: f64 = 0.95;
/// The width of edges that the eye looks for, peak to trough, in degrees.
const FEATURE_WIDTH: f64 = 0.082;

/// What is seen of a picture: made once, compared with any other of its size.
#[derive(Clone, Debug)]
pub struct Flip {
    /// By pixel, the blurred colour in the even space.
    colors: Vec<DVec3>,
    /// By pixel, how much of an edge is there.
    edges: Vec<f64>,
    /// By pixel, how much of a point.
    points: Vec<f64>,
    /// The largest difference of colours: green against blue, compressed.
    largest: f64,
}

impl Flip {
    /// Of a picture `width` pixels wide, of codes of 8 bits channel by channel, seen with [`PIXELS_PER_DEGREE`].
    pub fn new(codes: &[u8], width: u32) -> Flip {
        let spaces = Spaces::new();
        let width = width.max(1) as usize;
        let light: Vec<f64> = (0..=255).map(|code| decode_srgb(code as f64 / 255.0)).collect();
        let opponent: Vec<DVec3> = codes
            .as_chunks()
            .0
            .iter()
            .map(|c: &[u8; 3]| spaces.opponent(DVec3::from(c.map(|c| light[c as usize]))))
            .collect();
        let plane = |pick: fn(&DVec3) -> f64| Plane { width, values: opponent.iter().map(pick).collect() };
        let (luminance, red_green, yellow_blue) = (plane(|c| c.x), plane(|c| c.y), plane(|c| c.z));

        let [by_a, by_b] = YELLOW_BLUE.map(|(a, b)| (sensitivity(b), a * b.sqrt()));
        let both = by_a.1 + by_b.1;
        let blurred = |plane: &Plane, weights: &[f64]| plane.along_rows(weights).along_columns(weights);
        let y = blurred(&luminance, &sensitivity(LUMINANCE_B));
        let x = blurred(&red_green, &sensitivity(RED_GREEN_B));
        let z = blurred(&yellow_blue, &by_a.0).mixed(by_a.1 / both, &blurred(&yellow_blue, &by_b.0), by_b.1 / both);
        let color = |((y, x), z): ((&f64, &f64), &f64)| {
            spaces.hunt(spaces.rgb(DVec3::new(*y, *x, *z)).clamp(DVec3::ZERO, DVec3::ONE))
        };
        let colors = y.values.iter().zip(&x.values).zip(&z.values).map(color).collect();

        let gray = Plane { width, values: luminance.values.iter().map(|y| (y + 16.0) / 116.0).collect() };
        let deviation = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
        let radius = (3.0 * deviation).ceil() as usize;
        let bell = bell(0.5 / (deviation * deviation));
        let around = normalized(radius, &bell);
        let detected = |along: Vec<f64>| {
            let (x, y) =
                (gray.along_columns(&around).along_rows(&along), gray.along_rows(&around).along_columns(&along));
            x.values.iter().zip(&y.values).map(|(x, y)| (x * x + y * y).sqrt()).collect()
        };
        let edges = detected(normalized(radius, |x| -x * bell(x)));
        let points = detected(normalized(radius, |x| (x * x / (deviation * deviation) - 1.0) * bell(x)));
        let largest = fun::pow(hyab(spaces.hunt(DVec3::Y), spaces.hunt(DVec3::Z)), Q_COLOR);
        Flip { colors, edges, points, largest }
    }

    /// The mean difference from another picture of the same size: 0 for the same, 1 at most.
    pub fn difference(&self, other: &Flip) -> f64 {
        let one = |i: usize| {
            let color = self.color(fun::pow(hyab(self.colors[i], other.colors[i]), Q_COLOR));
            let edge = (self.edges[i] - other.edges[i]).abs();
            let point = (self.points[i] - other.points[i]).abs();
            let feature = fun::pow(FRAC_1_SQRT_2 * if edge > point { edge } else { point }, Q_FEATURE);
            fun::pow(color, 1.0 - feature)
        };
        let n = self.colors.len().min(other.colors.len());
        (0..n).map(one).sum::<f64>() / n.max(1) as f64
    }

    /// A compressed difference of colours, brought to 0 to 1.
    fn color(&self, difference: f64) -> f64 {
        let knee = P_COLOR * self.largest;
        match difference < knee {
            true => P_TARGET / knee * difference,
            false => P_TARGET + (difference - knee) / (self.largest - knee) * (1.0 - P_TARGET),
        }
    }
}

/// The weights along one axis of a term of the eye's contrast sensitivity.
fn sensitivity(b: f64) -> Vec<f64> {
    // All terms reach as far as the widest: three standard deviations.
    let radius = (3.0 * (YELLOW_BLUE[0].1 / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE).ceil() as usize;
    normalized(radius, bell(PI * PI / (b * PIXELS_PER_DEGREE * PIXELS_PER_DEGREE)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: u32 = 48;
    const HEIGHT: u32 = 32;

    fn picture(at: impl Fn(u32, u32) -> [u8; 3]) -> Vec<u8> {
        (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y))).flat_map(|(x, y)| at(x, y)).collect()
    }

    fn even(color: [u8; 3]) -> Vec<u8> {
        picture(|_, _| color)
    }

    /// Two slopes and a checker.
    fn colorful(x: u32, y: u32) -> [u8; 3] {
        let checker = if (x / 8 + y / 8) % 2 == 1 { 200 } else { 40 };
        [(5 * x % 256) as u8, (7 * y % 256) as u8, checker]
    }

    fn scattered(i: u32) -> u32 {
        let x = i.wrapping_mul(2_654_435_761);
        let x = (x ^ (x >> 16)).wrapping_mul(0x045d_9f3b);
        x ^ (x >> 16)
    }

    fn noisy(x: u32, y: u32) -> [u8; 3] {
        let mut color = colorful(x, y);
        for (c, v) in (0..).zip(&mut color) {
            *v = v.wrapping_add((scattered((y * WIDTH + x) * 3 + c) % 17) as u8);
        }
        color
    }

    fn flip(a: &[u8], b: &[u8]) -> f64 {
        Flip::new(a, WIDTH).difference(&Flip::new(b, WIDTH))
    }

    /// Figures of `flip-evaluator` 1.7, the authors' own, which computes with 32 bits: hence the distance.
    #[test]
    fn figures_are_those_of_the_authors() {
        let base = picture(colorful);
        let cases = [
            ("noise", &base, picture(noisy), 0.184_445),
            ("a pixel further", &base, picture(|x, y| colorful((x + WIDTH - 1) % WIDTH, y)), 0.182_106),
            ("black and white", &even([0; 3]), even([255; 3]), 0.967_388),
            ("green and blue", &even([0, 255, 0]), even([0, 0, 255]), 1.0),
            ("one code", &even([128; 3]), even([129; 3]), 0.029_863),
            (
                "one pixel",
                &even([128; 3]),
                picture(|x, y| if (x, y) == (24, 16) { [255; 3] } else { [128; 3] }),
                0.002_800,
            ),
        ];
        for (name, a, b, expected) in cases {
            let is = flip(a, &b);
            assert!((is - expected).abs() < 2e-5, "{name}: {is}, not {expected}");
        }
    }

    #[test]
    fn the_same_differs_by_nothing_and_order_does_not_count() {
        let (a, b) = (picture(colorful), picture(noisy));
        assert_eq!(flip(&a, &a), 0.0);
        assert_eq!(flip(&a, &b), flip(&b, &a));
    }

    #[test]
    fn more_noise_looks_worse() {
        let by =
            |share: u8| picture(|x, y| [0, 1, 2].map(|c| 128 + noisy(x, y)[c].wrapping_sub(colorful(x, y)[c]) / share));
        let gray = even([128; 3]);
        assert!(flip(&gray, &by(1)) > flip(&gray, &by(2)) && flip(&gray, &by(2)) > flip(&gray, &by(6)));
    }
}
