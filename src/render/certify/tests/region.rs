//! Regions: what certificates say of them, and points in them.

use super::super::super::dispatch::sampler;
use super::super::bound::Bound;
use super::super::{Certifier, Sampler, Status, Target, certify};
use super::*;
use crate::math::Form;
use crate::math::hash::KeyedHash;
use crate::render::bounds::smaller;
use crate::render::{Options, World};

/// How certificates are weakened to show that tests notice.
#[derive(Clone, Copy, PartialEq)]
enum Weakened {
    /// Not at all.
    No,
    /// What the form may miss.
    Form,
    /// The values' range.
    Range,
    /// The integral.
    Sum,
}

fn weaken(b: Bound, how: Weakened) -> Bound {
    let narrow = |[lo, hi]: [f64; 2], by: f64| {
        let (m, h) = (0.5 * (lo + hi), 0.5 * (hi - lo) * by);
        [m - h, m + h]
    };
    match how {
        Weakened::No => b,
        Weakened::Form => Bound { form: b.form.map(|f| f.map(|f| Form { r: 0.3 * f.r, ..f })), ..b },
        Weakened::Range => Bound { range: b.range.map(|r| narrow(r, 0.8)), ..b },
        Weakened::Sum => Bound { sum: b.sum.map(|s| narrow(s, 0.2)), ..b },
    }
}

/// What was found in random regions.
#[derive(Debug, Default)]
struct Found {
    regions: u64,
    /// With a form.
    formed: u64,
    points: u64,
    /// Points outside of form or range.
    outside: u64,
    /// Means outside of the integral's bounds, by more than chance.
    means: u64,
}

/// Points along each side of a region, from one attempt to judge its mean to the next.
const SIDES: [u64; 3] = [12, 96, 768];

/// What points of a region say of its mean.
struct Mean {
    mean: [f64; 3],
    /// Of the points' mean, by chance.
    deviation: [f64; 3],
}

/// One light at a random place of each of `side`² squares of a rectangle.
fn mean(
    sampler: &mut dyn Sampler,
    rect: [f64; 4],
    (key, side): (KeyedHash, u64),
    see: &mut dyn FnMut([f64; 2], [f64; 3]),
) -> Mean {
    let (mut sum, mut squares) = ([0.0; 3], [0.0; 3]);
    for row in 0..side {
        let place = |column: u64| {
            let unit = |k: u64, axis: u64| (k as f64 + key.with(row).with(column).with(axis).unit()) / side as f64;
            [unit(column, 0), unit(row, 1)]
        };
        let [l, t, r, b] = rect;
        let at = |[u, w]: [f64; 2]| [l + u * (r - l), t + w * (b - t)];
        let points: Vec<[f64; 2]> = (0..side).map(|column| at(place(column))).collect();
        sampler.trace(rect, &points, &mut |j, light| {
            for c in 0..3 {
                sum[c] += light[c];
                squares[c] += light[c] * light[c];
            }
            see(place(j as u64), light);
        });
    }
    let n = (side * side) as f64;
    let variance = [0, 1, 2].map(|c| (squares[c] - sum[c] * sum[c] / n) / n);
    // Strata are no worse than independent points.
    Mean { mean: sum.map(|s| s / n), deviation: variance.map(|v| (if v > 0.0 { v } else { 0.0 } / n).sqrt()) }
}

/// Whether a region's mean is outside the integral's bounds by more than chance: by more than six deviations, and what
/// points may have missed altogether. Of a part p of the region n points miss all with probability (1 − p)^n at most: for p = 16/n
/// that is 10^-7. So wide an allowance hides much where points are few: then a suspect, by a tenth of it, is judged by more.
fn is_wrong(sampler: &mut dyn Sampler, rect: [f64; 4], bound: &Bound, (key, first): (KeyedHash, Mean)) -> bool {
    let beyond = |m: &Mean, side: u64, part: f64| {
        (0..3).any(|c| {
            let seen = smaller(bound.range[c][1] - bound.range[c][0], 1.0);
            let chance = part * (6.0 * m.deviation[c] + seen * 16.0 / (side * side) as f64) + ROUNDING;
            m.mean[c] + chance < 0.25 * bound.sum[c][0] || m.mean[c] - chance > 0.25 * bound.sum[c][1]
        })
    };
    let mut found = first;
    for (k, side) in SIDES.into_iter().enumerate() {
        if k > 0 {
            found = mean(sampler, rect, (key, side), &mut |_, _| {});
        }
        if !beyond(&found, side, 0.1) {
            return false;
        }
        if beyond(&found, side, 1.0) {
            return true;
        }
    }
    false
}

fn studied(scene: &Scene, (width, height): (u32, u32), regions: std::ops::Range<u64>, how: Weakened) -> Found {
    let world = World::build(scene, &scene.cameras[0]);
    let options = Options { width, height, ..Options::from_settings(&scene.settings) };
    let certifier = Certifier::new(&world, &options);
    let mut sampler = sampler(&world, &options, &NEVER);
    let mut found = Found::default();
    for i in regions {
        let key = KeyedHash::new().with(i);
        let random = |k: u64| key.with(k).unit();
        let size = [0.02, 0.1, 0.5, 1.0, 4.0][(random(0) * 5.0) as usize] * (0.5 + random(1));
        let (l, t) = (random(2) * (width as f64 - size), random(3) * (height as f64 - size));
        let rect = [l, t, l + size, t + size * (0.5 + 0.5 * random(4))];
        let bound = weaken(certifier.region(rect), how);
        found.regions += 1;
        found.formed += bound.form.is_some() as u64;
        let first = mean(&mut *sampler, rect, (key, SIDES[0]), &mut |[u, w], light| {
            found.points += 1;
            let (xi, eta) = (2.0 * u - 1.0, 2.0 * w - 1.0);
            for c in 0..3 {
                let [lo, hi] = bound.range[c];
                let in_range = lo - ROUNDING <= light[c] && light[c] <= hi + ROUNDING;
                let in_form = bound.form.is_none_or(|f| {
                    !f[c].is_known() || (light[c] - (f[c].c + f[c].x * xi + f[c].y * eta)).abs() <= f[c].r + ROUNDING
                });
                found.outside += !(in_range && in_form) as u64;
            }
        });
        found.means += is_wrong(&mut *sampler, rect, &bound, (key, first)) as u64;
        if how != Weakened::No && found.outside + found.means > 0 {
            break; // it was noticed
        }
    }
    found
}

#[test]
fn light_lies_within_certificates() {
    let found = studied(&every_shape(), (320, 180), 0..1_000, Weakened::No);
    assert_eq!((found.outside, found.means), (0, 0), "{found:?}");
    assert!(found.formed * 2 > found.regions, "{found:?}");
}

#[test]
#[ignore = "minutes"]
fn light_lies_within_many_certificates() {
    for size in [(320, 180), (64, 36), (1280, 720)] {
        let found = studied(&every_shape(), size, 0..200_000, Weakened::No);
        assert_eq!((found.outside, found.means), (0, 0), "{found:?}");
    }
}

#[test]
fn weakened_certificates_are_noticed() {
    let scene = every_shape();
    let wrong = |how| {
        let found = studied(&scene, (320, 180), 0..500, how);
        (found.outside, found.means)
    };
    assert!(wrong(Weakened::Form).0 > 0, "what the form may miss");
    assert!(wrong(Weakened::Range).0 > 0, "the range");
    assert!(wrong(Weakened::Sum).1 > 0, "the integral");
}

#[test]
fn what_passes_a_ring_by_is_known() {
    let found = studied(&rings(), (160, 90), 0..1_500, Weakened::No);
    assert_eq!((found.outside, found.means), (0, 0), "{found:?}");
}

#[test]
fn what_is_known_by_range_is() {
    let scene = by_range();
    let found = studied(&scene, (160, 90), 0..1_500, Weakened::No);
    assert_eq!((found.outside, found.means), (0, 0), "{found:?}");
    let narrow = studied(&scene, (160, 90), 0..1_500, Weakened::Range);
    assert!(narrow.outside > 0, "{narrow:?}");
}

#[test]
fn what_glass_bends_is_followed() {
    let scene = glasses();
    let found = studied(&scene, (160, 90), 0..1_500, Weakened::No);
    assert_eq!((found.outside, found.means), (0, 0), "{found:?}");
    let world = World::build(&scene, &scene.cameras[0]);
    let options = Options { width: 160, height: 90, ..Options::from_settings(&scene.settings) };
    // Through the middle of the ball: a quarter of what the scene can give.
    let bound = Certifier::new(&world, &options).region([79.0, 46.0, 79.5, 46.5]);
    assert!(bound.range.iter().all(|r| r[1] - r[0] < 0.4), "{bound:?}");
}

/// A surface's own range is what is left of the scene's where more isn't known.
#[test]
fn what_lies_elsewhere_widens_nothing() {
    let range = |scene: &Scene, rect| {
        let world = World::build(scene, &scene.cameras[0]);
        let options = Options { width: 32, height: 32, ..Options::from_settings(&scene.settings) };
        Certifier::new(&world, &options).region(rect).range
    };
    let mut b = Builder::new();
    let [x, y] = b.two([0.5; 3], [0.1; 3]);
    let heights = b.pattern(PatternKind::Noise { a: x, b: y, octaves: 2, seed: 1 });
    b.shape(Shape::Plane { through: v(0.0, 0.0, -9.0), normal: DVec3::Z }, plain([0.5; 3]));
    b.last().bump = Some(heights);
    b.light(v(3.0, 4.0, 5.0), [0.5; 3]);
    let alone = range(&b.0, [4.0, 4.0, 9.0, 9.0]);
    // Behind the camera, and far brighter.
    b.shape(Shape::Sphere { at: v(0.0, 0.0, 60.0), r: 1.0 }, Look { reflect: 1.0, ..plain([9.0; 3]) });
    assert_eq!(alone, range(&b.0, [4.0, 4.0, 9.0, 9.0]));
    assert!(alone.iter().all(|r| r[0] >= 0.09 && r[1] < 0.6), "its ambient light at least: {alone:?}");
}

#[test]
fn what_isnt_covered_is_unknown_within_its_range() {
    let mut b = Builder::new();
    b.shape(Shape::Torus { at: v(0.0, 0.0, -20.0), r: 2.0, tube: 0.5, axis: DVec3::Z }, plain([0.5; 3]));
    b.light(v(3.0, 4.0, 5.0), [0.5; 3]);
    let world = World::build(&b.0, &b.0.cameras[0]);
    let options = Options { width: 32, height: 32, ..Options::from_settings(&b.0.settings) };
    let certifier = Certifier::new(&world, &options);
    let bound = certifier.region([4.0, 4.0, 28.0, 28.0]);
    let ceiling = certifier.ceiling(options.max_depth);
    assert!((0..3).all(|c| bound.range[c][0] <= 0.0 + 1e-9 && bound.range[c][1] <= ceiling[c][1] + 1e-9));
    let pixels = certify(&world, &options, &Target::new(8.0));
    assert!(pixels.iter().any(|p| p.status == Status::Proved), "beside it");
    assert!(pixels.iter().any(|p| p.status != Status::Proved), "on it");
}
