//! Gradient noise over a region: its polynomial in each of the few lattice cells that the region lies in, to first order.

use super::polygon::Polygon;
use crate::math::Form;
use crate::math::noise::{STRETCH, component, in_cell};

/// No value of gradient noise is further from 0. A gradient's product with the way from its corner is at most the sum of the two
/// longest sides of that way; weighted as the corners are, such sums come to 1.0363 at most, where the sides are .355, .48 and .5; this is what a test
/// of it can be sure of.
const AMPLITUDE: f64 = 1.06;

/// Wider than that, in cells, a polynomial says no more than the amplitude does.
const WIDEST: f64 = 0.75;

/// Most cells that are looked at: further ones are hardly ever of use.
const MOST_CELLS: usize = 4;

/// The pattern's noise at the points `q` of `p`: as [`unit_noise`](crate::math::noise::unit_noise). `None` where nothing is known.
pub fn unit(p: &Polygon, q: [Form; 3], octaves: u32, seed: u64) -> Option<Form> {
    let sum = fractal(p, q, octaves, seed)?.times(STRETCH) + Form::constant(0.5);
    Some(sum.share())
}

/// A displacement: as [`vector_noise`](crate::math::noise::vector_noise).
pub fn vector(p: &Polygon, q: [Form; 3], octaves: u32, seed: u64) -> Option<[Form; 3]> {
    let along = |k: u64| fractal(p, q, octaves, component(seed, k));
    Some([along(1)?, along(2)?, along(3)?])
}

fn fractal(p: &Polygon, q: [Form; 3], octaves: u32, seed: u64) -> Option<Form> {
    let (mut sum, mut weight, mut total) = (Form::constant(0.0), 1.0, 0.0);
    for k in 0..octaves {
        let scale = (1u64 << k) as f64;
        match gradient(p, q.map(|x| x.times(scale)), seed.wrapping_add(k as u64)) {
            Some(noise) => sum = sum + noise.times(weight),
            None if k == 0 => return None,
            // All finer ones together: each is half as strong as the one before.
            None => {
                let rest = AMPLITUDE * weight * (2.0 - fine(octaves - 1 - k));
                sum = sum + Form::between(-rest, rest);
                total += weight * (2.0 - fine(octaves - 1 - k));
                break;
            }
        }
        total += weight;
        weight *= 0.5;
    }
    Some(sum / Form::constant(total))
}

/// 2^−k.
fn fine(k: u32) -> f64 {
    1.0 / (1u64 << k) as f64
}

/// One octave; `None` where its amplitude says as much.
fn gradient(p: &Polygon, q: [Form; 3], seed: u64) -> Option<Form> {
    let mut cells = [[0.0; 2]; 3];
    let mut count = 1;
    for (cell, x) in cells.iter_mut().zip(q) {
        let (lo, hi) = p.range(x);
        if !(hi - lo < WIDEST && lo.abs() < FARTHEST) {
            return None;
        }
        *cell = [lo.floor(), hi.floor()];
        count *= if cell[0] == cell[1] { 1 } else { 2 };
    }
    if count > MOST_CELLS {
        return None;
    }
    // In each part of the region one of the polynomials holds; where they meet they are alike.
    let mut any: Option<Form> = None;
    let ends = |axis: usize| &cells[axis][..if cells[axis][0] == cells[axis][1] { 1 } else { 2 }];
    for &x in ends(0) {
        for &y in ends(1) {
            for &z in ends(2) {
                let cell = [x, y, z];
                let f = [0, 1, 2].map(|i| q[i] - Form::constant(cell[i]));
                let noise = in_cell(cell, f, f.map(fade), seed);
                any = Some(any.map_or(noise, |other| other.hull(noise)));
            }
        }
    }
    any.filter(|f| f.r < AMPLITUDE)
}

/// Cells further out have no numbers of their own.
const FARTHEST: f64 = (1u64 << 40) as f64;

/// x³(10 − 15x + 6x²) by its tangent in the middle and Taylor's remainders of second and third order.
fn fade(x: Form) -> Form {
    let (c, reach) = (x.c, x.radius());
    let value = c * c * c * (c * (c * 6.0 - 15.0) + 10.0);
    let first = 30.0 * c * c * (c - 1.0) * (c - 1.0);
    let second = 30.0 * c * (2.0 * c - 1.0) * (c - 1.0) * reach * reach;
    // The third derivative is 60(6x² − 6x + 1): largest at an end, or −30 in between.
    let third = |x: f64| (60.0 * (6.0 * x * (x - 1.0) + 1.0)).abs();
    let ends = [third(x.lo()), third(x.hi()), 30.0];
    let most = ends.iter().fold(0.0, |m, e| if *e > m { *e } else { m });
    let third = most / 6.0 * reach * reach * reach;
    // Some twenty roundings of terms that are no larger than this.
    let size = (1.0 + c.abs()) * (1.0 + c.abs()) * (1.0 + c.abs());
    let rounded =
        ROUNDING * (36.0 * size * (1.0 + c.abs()) * (1.0 + c.abs()) + 300.0 * size * reach * (1.0 + reach) + third);
    let off = third + rounded;
    let (least, most) = if second < 0.0 { (second, 0.0) } else { (0.0, second) };
    (x - Form::constant(c)).times(first) + Form::between(value + least - off, value + most + off)
}

/// Some twenty roundings, generously: 2^-46.
const ROUNDING: f64 = 1.0 / (1u64 << 46) as f64;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::hash::KeyedHash;
    use crate::math::noise::{gradient_noise, unit_noise, vector_noise};

    /// Forms of a random small region, and points of it.
    fn tried(case: u64, mut judge: impl FnMut(&Polygon, [Form; 3], &dyn Fn(u64) -> ([f64; 3], [f64; 2]))) {
        let random = |k: u64| KeyedHash::new().with(case).with(k).unit();
        let size = [0.003, 0.03, 0.15][(random(0) * 3.0) as usize];
        let form = |i: u64| Form {
            c: 20.0 * random(4 * i + 1) - 10.0,
            x: size * (random(4 * i + 2) - 0.5),
            y: size * (random(4 * i + 3) - 0.5),
            r: 0.1 * size * random(4 * i + 4),
        };
        let q = [form(0), form(1), form(2)];
        let point = |j: u64| {
            let at = [0, 1].map(|k| 2.0 * random(100 + 7 * j + k) - 1.0);
            let off = |i: u64| 2.0 * random(102 + 7 * j + i) - 1.0;
            ([0, 1, 2].map(|i| q[i].c + q[i].x * at[0] + q[i].y * at[1] + q[i].r * off(i as u64)), at)
        };
        judge(&Polygon::square(), q, &point);
    }

    fn holds(f: Form, [x, y]: [f64; 2], value: f64) -> bool {
        (value - (f.c + f.x * x + f.y * y)).abs() <= f.r + 1e-12
    }

    #[test]
    fn noise_lies_within_its_forms() {
        let (mut known, mut narrow) = (0, 0);
        for case in 0..3_000 {
            tried(case, |p, q, point| {
                let seed = case % 5;
                let forms = (unit(p, q, 4, seed), vector(p, q, 2, seed), gradient(p, q, seed));
                known += forms.0.is_some() as u64;
                narrow += forms.2.is_some_and(|f| f.r < 0.02) as u64;
                for j in 0..40 {
                    let (at, place) = point(j);
                    assert!(forms.0.is_none_or(|f| holds(f, place, unit_noise(at, 4, seed))), "case {case}: {q:?}");
                    assert!(forms.2.is_none_or(|f| holds(f, place, gradient_noise(at, seed))), "case {case}: {q:?}");
                    let v = vector_noise(at, 2, seed);
                    assert!(forms.1.is_none_or(|f| (0..3).all(|i| holds(f[i], place, v[i]))), "case {case}: {q:?}");
                }
            });
        }
        assert!(known > 2_900 && narrow > 1_000, "{known} {narrow}");
    }

    #[test]
    fn what_is_left_out_of_a_form_is_noticed() {
        let mut outside = 0;
        for case in 0..500 {
            tried(case, |p, q, point| {
                let Some(f) = gradient(p, q, 1) else { return };
                let weak = Form { r: 0.3 * f.r, ..f };
                outside += (0..40).filter(|j| !holds(weak, point(*j).1, gradient_noise(point(*j).0, 1))).count();
            });
        }
        assert!(outside > 0);
    }

    /// The amplitude on a grid. Along an axis a weight changes by 15/8 at most and what it weighs by 1, or by 1 itself: so in between
    /// there is no more than 3·(15/8 + 1) times half the grid's step beyond it.
    #[test]
    fn no_noise_is_beyond_its_amplitude() {
        let fade = |x: f64| x * x * x * (x * (x * 6.0 - 15.0) + 10.0);
        let n = 120;
        let mut most = 0.0;
        for i in 0..n * n * n {
            let f = [i % n, i / n % n, i / n / n].map(|k| 0.5 * (k as f64 + 0.5) / n as f64);
            let sum: f64 = (0..8u32)
                .map(|corner| {
                    let far = |axis: usize| corner >> axis & 1 == 1;
                    let side = [0, 1, 2].map(|a| if far(a) { 1.0 - f[a] } else { f[a] });
                    let weight = |a: usize| if far(a) { fade(f[a]) } else { 1.0 - fade(f[a]) };
                    let least = side.iter().fold(1.0, |m: f64, s| if *s < m { *s } else { m });
                    weight(0) * weight(1) * weight(2) * (side[0] + side[1] + side[2] - least)
                })
                .sum();
            most = if sum > most { sum } else { most };
        }
        assert!(most > 1.036 && most + 3.0 * (15.0 / 8.0 + 1.0) * 0.25 / (n as f64) < AMPLITUDE, "{most}");
    }
}
