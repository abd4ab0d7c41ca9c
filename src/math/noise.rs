//! Smooth noise on space, the same on every machine: gradient noise (Perlin, "Improving noise", SIGGRAPH 2002) over a
//! hashed lattice, its sums over octaves, and cellular noise (Worley, SIGGRAPH 1996).
//!
//! Written with plain products and sums only, so that it has the same bits with and without fused multiply-add.

use super::hash::KeyedHash;
use super::real::{Real, each3, three};

/// Gradient noise in about −1..1, 0 at lattice points; continuous with two derivatives.
pub fn gradient_noise(p: [f64; 3], seed: u64) -> f64 {
    let cell = each3!(p, x => floor(x));
    let f = three!(i => p[i] - cell[i]);
    let w = each3!(f, x => x * x * x * (x * (x * 6.0 - 15.0) + 10.0));
    in_cell(cell, f, w, seed)
}

/// Gradient noise at `f` in the lattice's cell at `cell`, whose corners weigh as `w` says.
#[inline(always)]
pub fn in_cell<R: Real>(cell: [f64; 3], f: [R; 3], w: [R; 3], seed: u64) -> R {
    // The lattice's hash takes one coordinate after another: what corners have in common is hashed once.
    let start = KeyedHash::new().with(seed);
    let from = |axis: usize, d: usize| if d == 0 { f[axis] } else { f[axis] - R::one() };
    let face = [0, 1].map(|dx: usize| {
        let along_x = start.with_f64(cell[0] + dx as f64);
        [0, 1].map(|dy: usize| {
            let along_y = along_x.with_f64(cell[1] + dy as f64);
            [0, 1].map(|dz: usize| {
                let h = along_y.with_f64(cell[2] + dz as f64).bits();
                slope(h, [from(0, dx), from(1, dy), from(2, dz)])
            })
        })
    });
    let lerp = |a: R, b: R, t: R| a + t * (b - a);
    let edge = |dy: usize, dz: usize| lerp(face[0][dy][dz], face[1][dy][dz], w[0]);
    let level = |dz: usize| lerp(edge(0, dz), edge(1, dz), w[1]);
    lerp(level(0), level(1), w[2])
}

/// The largest whole number not above `x`. Without a call, which `f64::floor` is on processors that needn't have the
/// instruction: from 2^52 on every number is whole.
#[inline]
fn floor(x: f64) -> f64 {
    if !(x.abs() < (1u64 << 52) as f64) {
        return x;
    }
    let whole = (x as i64) as f64;
    (if whole > x { whole - 1.0 } else { whole }).copysign(x)
}

/// Perlin's twelve gradients towards the middles of a cube's edges, four of them twice.
#[inline(always)]
fn slope<R: Real>(hash: u64, [x, y, z]: [R; 3]) -> R {
    let h = hash >> 60;
    let u = if h < 8 { x } else { y };
    let v = match h {
        0..4 => y,
        12 | 14 => x,
        _ => z,
    };
    (if h & 1 == 0 { u } else { -u }) + (if h & 2 == 0 { v } else { -v })
}

/// Sum of `octaves` layers, each of half the size and half the strength; in about −1..1.
pub fn fractal_noise(p: [f64; 3], octaves: u32, seed: u64) -> f64 {
    let (mut sum, mut weight, mut total, mut q) = (0.0, 1.0, 0.0, p);
    for k in 0..octaves {
        sum += weight * gradient_noise(q, seed.wrapping_add(k as u64));
        total += weight;
        weight *= 0.5;
        q = q.map(|x| x * 2.0);
    }
    sum / total
}

/// By what the pattern's noise is stretched.
pub const STRETCH: f64 = 0.5 / 0.7;

/// The key of a component of [`vector_noise`], 1 to 3.
pub fn component(seed: u64, k: u64) -> u64 {
    seed ^ k.wrapping_mul(0x9E37_79B9_7F4A_7C15)
}

/// The pattern's noise: [`fractal_noise`] brought to 0..1. Gradient noise seldom leaves ±0.7, so it is stretched by that;
/// what is beyond is cut off.
pub fn unit_noise(p: [f64; 3], octaves: u32, seed: u64) -> f64 {
    (0.5 + fractal_noise(p, octaves, seed) * STRETCH).clamp(0.0, 1.0)
}

/// A displacement, each component in about −1..1, for turbulence.
pub fn vector_noise(p: [f64; 3], octaves: u32, seed: u64) -> [f64; 3] {
    [1u64, 2, 3].map(|k| fractal_noise(p, octaves, component(seed, k)))
}

/// Distance to the nearest of the points scattered one to a unit cell.
pub fn cell_noise(p: [f64; 3], seed: u64) -> f64 {
    let cell = each3!(p, x => floor(x));
    let start = KeyedHash::new().with(seed);
    let mut best = f64::INFINITY;
    for x in [0.0, 1.0, 2.0].map(|dx| cell[0] + dx - 1.0) {
        let along_x = start.with_f64(x);
        for y in [0.0, 1.0, 2.0].map(|dy| cell[1] + dy - 1.0) {
            let along_y = along_x.with_f64(y);
            for z in [0.0, 1.0, 2.0].map(|dz| cell[2] + dz - 1.0) {
                let (c, h) = ([x, y, z], along_y.with_f64(z));
                let d = three!(k => c[k] + h.with(k as u64).unit() - p[k]);
                let d2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
                if d2 < best {
                    best = d2;
                }
            }
        }
    }
    best.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random_point(i: u64) -> [f64; 3] {
        [1, 2, 3].map(|k| KeyedHash::new().with(i).with(k).unit() * 200.0 - 100.0)
    }

    #[test]
    fn smooth_centred_and_zero_on_the_lattice() {
        assert_eq!(gradient_noise([3.0, -7.0, 0.0], 1), 0.0);
        let (mut sum, mut steepest, n) = (0.0, 0.0f64, 5_000);
        for i in 0..n {
            let p = random_point(i);
            let v = gradient_noise(p, 7);
            assert!(v.abs() <= 1.1);
            sum += v;
            let slope = (gradient_noise([p[0] + 1e-4, p[1], p[2]], 7) - v).abs() / 1e-4;
            steepest = if slope > steepest { slope } else { steepest };
        }
        assert!((sum / n as f64).abs() < 0.02 && steepest < 6.0, "{} {steepest}", sum / n as f64);
    }

    #[test]
    fn pattern_noise_uses_its_range() {
        let values: Vec<f64> = (0..5_000).map(|i| unit_noise(random_point(i), 3, 0)).collect();
        assert!(values.iter().all(|v| (0.0..=1.0).contains(v)));
        let low = values.iter().filter(|v| **v < 0.25).count();
        let high = values.iter().filter(|v| **v > 0.75).count();
        assert!(low > 100 && high > 100, "{low} {high}");
    }

    #[test]
    fn every_point_has_a_cell_point_nearby() {
        assert!((0..5_000).map(|i| cell_noise(random_point(i), 3)).all(|d| (0.0..1.75).contains(&d)));
    }
}
