//! The closed form of filters beyond the box: of a rectangle along the picture's axes, a pixel sees the product of the filter's
//! integrals along both. They are summed here from the filters as they are published, by a rule that has nothing in common with how
//! certificates integrate them.

use super::closed_form::{Ask, Known, ask, before, grays, random_point};
use super::covered::Square;
use crate::math::fun;
use crate::render::bounds::{larger, smaller};
use crate::render::certify::Target;
use crate::scene::{PixelFilter, Shape};
use crate::verify::draw::Draw;
use crate::verify::{Check, Outcome, Size};
use glam::DVec3;

/// The check.
pub const CHECK: Check = Check {
    name: "filtered",
    what: "pixels of filters beyond the box keep the error that is stated of them, where their true value is a closed form",
    run,
};

fn run(size: Size) -> Outcome {
    let mut outcome = Outcome::default();
    let seeds = size.pick(2, 100);
    let once = Target { evaluations: 1, ..Target::new(4.0) };
    let asks = || {
        vec![
            Ask { what: "4/255", target: Target::new(4.0) },
            Ask { what: "1/255", target: Target::new(1.0) },
            Ask { what: "4/255 after one look, confidence 99.9 %", target: once },
            Ask { what: "4/255 without certificates", target: Target { certificates: false, ..Target::new(4.0) } },
        ]
    };
    let mitchell = (PixelFilter::Mitchell, of_mitchell as fn(&mut Draw) -> Known);
    for (filter, make) in [mitchell, (PixelFilter::Gauss, of_gauss)] {
        ask(&mut outcome, asks(), seeds, (filter, &[(filter.name(), make)]), &format!("{}, ", filter.name()));
    }
    outcome
}

fn of_mitchell(draw: &mut Draw) -> Known {
    // Mitchell, Netravali: B = C = 1/3, each formula over 6.
    let near = |x: f64| (7.0 * x * x * x - 12.0 * x * x + 16.0 / 3.0) / 6.0;
    let far = |x: f64| (-7.0 / 3.0 * x * x * x + 12.0 * x * x - 20.0 * x + 32.0 / 3.0) / 6.0;
    rectangles(draw, 2.0, &|x| if x < 1.0 { near(x) } else { far(x) })
}

fn of_gauss(draw: &mut Draw) -> Known {
    let bell = |x: f64| fun::exp(-x * x / (2.0 * 0.5 * 0.5)) - fun::exp(-1.5 * 1.5 / (2.0 * 0.5 * 0.5));
    rectangles(draw, 1.5, &bell)
}

/// Three rectangles, one behind another but nowhere in one place, from lines to half of the picture: as boxes of one gray.
fn rectangles(draw: &mut Draw, radius: f64, weight: &dyn Fn(f64) -> f64) -> Known {
    let grays = grays(draw);
    let mut all: Vec<Square> = Vec::new();
    // Bands one above another, so that no two have a place in common.
    let mut low = -8.0;
    for _ in 0..3 {
        let bottom = low + draw.magnitude(-5, 1);
        let top = bottom + draw.magnitude(-5, 2);
        let [x, _] = random_point(draw);
        let width = draw.magnitude(-5, 4);
        all.push([x - width, bottom, x + width, top]);
        low = top;
    }
    let shapes = all
        .iter()
        .map(|[x0, y0, x1, y1]| Shape::Box { from: DVec3::new(*x0, *y0, -1.0), to: DVec3::new(*x1, *y1, 1.0) })
        .collect();
    let whole = 2.0 * below(radius, weight, radius);
    let share = |from: f64, to: f64| (below(to, weight, radius) - below(from, weight, radius)) / whole;
    let seen = |square: Square| {
        let [x, y] = [0.5 * (square[0] + square[2]), 0.5 * (square[1] + square[3])];
        all.iter().map(|[x0, y0, x1, y1]| share(x0 - x, x1 - x) * share(y0 - y, y1 - y)).sum()
    };
    before(grays, shapes, seen)
}

/// The integral of a symmetric weight from 0 to `x`, by Gauss and Legendre's rule of five points in quarters of a unit: exact for
/// cubics, whose formulas change at whole numbers, and all but exact for the bell.
fn below(x: f64, weight: &dyn Fn(f64) -> f64, radius: f64) -> f64 {
    // Nodes and weights (Abramowitz, Stegun, table 25.4).
    const RULE: [(f64, f64); 5] = [
        (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
        (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (0.906_179_845_938_664, 0.236_926_885_056_189_1),
    ];
    let end = smaller(x.abs(), radius);
    let parts = (4.0 * end).ceil() as u32;
    let mut sum = 0.0;
    for k in 0..parts {
        let (a, b) = (0.25 * k as f64, smaller(0.25 * (k + 1) as f64, end));
        let (middle, half) = (0.5 * (a + b), larger(0.5 * (b - a), 0.0));
        sum += RULE.iter().map(|(node, w)| w * weight(middle + half * node)).sum::<f64>() * half;
    }
    if x < 0.0 { -sum } else { sum }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_those_that_are_known() {
        // √(π/2)/2 · erf(3/√2), and what is taken off.
        let bell = |x: f64| fun::exp(-2.0 * x * x);
        let half = 0.5 * (0.5 * std::f64::consts::PI).sqrt() * 0.997_300_203_936_739_8;
        assert!((below(1.5, &bell, 1.5) - half).abs() < 1e-12);
        assert!((below(-9.0, &|x| x * x * x, 2.0) + 4.0).abs() < 1e-14);
    }
}
