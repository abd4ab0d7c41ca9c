//! Pictures: whether their pixels keep what they claim, and what going on with them changes.

use super::super::super::dispatch::sampler;
use super::super::{Control, Pixel, Status, Summary, Target, certify, code, refine};
use super::*;
use crate::math::hash::KeyedHash;
use crate::render::filter::Kernel;
use crate::render::{Crop, Options, Progress, Silent, World};
use std::sync::Mutex;
use std::sync::atomic::Ordering::Relaxed;

/// Pixels of a picture that keep their promise, against the mean of 64×64 rays: proved ones always.
fn kept(scene: &Scene, size: (u32, u32), target: &Target) -> (Summary, u64) {
    kept_with(PixelFilter::Box, scene, size, target)
}

/// The same of a filter: rays all over its window, each with its weight.
fn kept_with(filter: PixelFilter, scene: &Scene, (width, height): (u32, u32), target: &Target) -> (Summary, u64) {
    let kernel = Kernel::of(filter);
    let reach = kernel.map_or(0.5, |k| k.radius());
    let world = World::build(scene, &scene.cameras[0]);
    let options = Options { width, height, filter, ..Options::from_settings(&scene.settings) };
    let pixels = certify(&world, &options, target);
    let mut sampler = sampler(&world, &options, &NEVER);
    let mut broken = 0;
    for (i, pixel) in pixels.iter().enumerate().filter(|(i, p)| p.status != Status::Proved || i % 23 == 0) {
        let (x, y) = ((i as u32 % width) as f64, (i as u32 / width) as f64);
        let points: Vec<[f64; 2]> = (0..4096u64)
            .map(|j| {
                let unit =
                    |axis: u64, k: u64| (k as f64 + KeyedHash::new().with(i as u64).with(j).with(axis).unit()) / 64.0;
                let place = |at: f64, unit: f64| at + 0.5 + reach * (2.0 * unit - 1.0);
                [place(x, unit(0, j % 64)), place(y, unit(1, j / 64))]
            })
            .collect();
        let area = 4.0 * reach * reach;
        let weight = |[u, v]: [f64; 2]| kernel.map_or(1.0, |k| area * k.at(u - x - 0.5) * k.at(v - y - 0.5));
        let (mut sum, mut squares) = ([0.0; 3], [0.0; 3]);
        let window = [x + 0.5 - reach, y + 0.5 - reach, x + 0.5 + reach, y + 0.5 + reach];
        sampler.trace(window, &points, &mut |j, light| {
            for c in 0..3 {
                let light = weight(points[j]) * light[c];
                sum[c] += light;
                squares[c] += light * light;
            }
        });
        let wrong = (0..3).any(|c| {
            let (mean, variance) = (sum[c] / 4096.0, (squares[c] - sum[c] * sum[c] / 4096.0) / 4096.0);
            let chance = 5.0 * (if variance > 0.0 { variance } else { 0.0 } / 4096.0).sqrt() + ROUNDING;
            let written = code(pixel.value[c]).round();
            let (lo, hi) = (code(mean - chance), code(mean + chance));
            written - hi > target.codes || lo - written > target.codes
        });
        broken += wrong as u64;
    }
    (Summary::of(&pixels, target.codes), broken)
}

#[test]
fn pictures_keep_their_promise() {
    let scene = every_shape();
    let (sum, broken) = kept(&scene, (64, 36), &Target::new(4.0));
    assert_eq!(broken, 0);
    assert!(sum.proved > 1_900 && sum.open == 0, "{sum:?}");
    // The same from samples alone: none can be sure.
    let sampled = Target { certificates: false, samples: 4096, ..Target::new(8.0) };
    let (sum, broken) = kept(&scene, (32, 18), &sampled);
    assert_eq!((sum.proved + sum.bounded, broken), (0, 0));
    assert!(sum.estimated > 400, "{sum:?}");
}

#[test]
fn filtered_pictures_keep_their_promise() {
    let scene = every_shape();
    for filter in [PixelFilter::Mitchell, PixelFilter::Gauss] {
        let (sum, broken) = kept_with(filter, &scene, (48, 27), &Target::new(4.0));
        assert_eq!(broken, 0, "{filter:?} {sum:?}");
        assert!(sum.proved > 500 && sum.bounded > 50 && sum.open == 0, "{filter:?} {sum:?}");
        let sampled = Target { certificates: false, samples: 4096, ..Target::new(8.0) };
        let (sum, broken) = kept_with(filter, &scene, (24, 14), &sampled);
        assert_eq!((sum.proved + sum.bounded, broken), (0, 0), "{filter:?}");
        assert!(sum.estimated > 150, "{filter:?} {sum:?}");
        // Of whose bounds a tenth is believed are found out.
        let weak = Target { believed: 0.1, ..Target::new(4.0) };
        assert!(kept_with(filter, &scene, (48, 27), &weak).1 > 0, "{filter:?}");
    }
}

#[test]
fn filtered_pixels_depend_on_nothing_but_themselves() {
    let scene = every_shape();
    let world = World::build(&scene, &scene.cameras[0]);
    for filter in [PixelFilter::Mitchell, PixelFilter::Gauss] {
        let options = Options { width: 40, height: 24, filter, ..Options::from_settings(&scene.settings) };
        let target = Target { samples: 256, evaluations: 64, ..Target::new(8.0) };
        let on = |threads| certify(&world, &Options { threads: Some(threads), ..options.clone() }, &target);
        let all = on(1);
        assert!(all == on(3), "{filter:?}");
        let part = Crop { x: 13, y: 9, width: 11, height: 9 };
        let some = certify(&world, &Options { crop: Some(part), ..options.clone() }, &target);
        for (i, pixel) in some.iter().enumerate() {
            assert_eq!(pixel.value, all[(i / 11 + 9) * 40 + i % 11 + 13].value);
        }
    }
}

#[test]
fn the_same_pixels_for_any_number_of_threads_and_in_a_part() {
    let scene = every_shape();
    let world = World::build(&scene, &scene.cameras[0]);
    let options = Options { width: 60, height: 34, ..Options::from_settings(&scene.settings) };
    let target = Target { samples: 256, evaluations: 32, ..Target::new(4.0) };
    let on = |threads| certify(&world, &Options { threads: Some(threads), ..options.clone() }, &target);
    let all = on(1);
    assert!(all == on(3));
    let part = Crop { x: 13, y: 9, width: 21, height: 17 };
    let some = certify(&world, &Options { crop: Some(part), ..options.clone() }, &target);
    for (i, pixel) in some.iter().enumerate() {
        let (x, y) = (i % 21 + 13, i / 21 + 9);
        // Who is charged for a block's evaluation isn't part of the picture.
        assert_eq!(pixel.value, all[y * 60 + x].value);
    }
}

#[test]
fn pixels_beside_rings_are_proved() {
    let (sum, broken) = kept(&rings(), (48, 27), &Target { samples: 4096, ..Target::new(8.0) });
    assert_eq!(broken, 0);
    assert!(sum.proved > 800, "beside the rings and their shadows: {sum:?}");
}

/// Writes down what it is told, and cancels after some blocks.
struct Witness {
    told: Mutex<Vec<Option<[f32; 3]>>>,
    width: u32,
    left: Mutex<usize>,
    cancel: AtomicBool,
}

impl Witness {
    fn new((width, height): (u32, u32), blocks: usize) -> Witness {
        let told = Mutex::new(vec![None; (width * height) as usize]);
        Witness { told, width, left: Mutex::new(blocks), cancel: AtomicBool::new(false) }
    }
}

impl Progress for Witness {
    fn finished(&self, tile: Crop, rows: &[&mut [[f32; 3]]]) {
        let mut told = self.told.lock().unwrap();
        for (row, y) in rows.iter().zip(tile.y..tile.y + tile.height) {
            for (light, x) in row.iter().zip(tile.x..tile.x + tile.width) {
                let before = told[(y * self.width + x) as usize].replace(*light);
                assert_eq!(before, None, "told twice of ({x}, {y})");
            }
        }
        let mut left = self.left.lock().unwrap();
        *left -= 1;
        if *left == 0 {
            self.cancel.store(true, Relaxed);
        }
    }
}

#[test]
fn what_is_cancelled_can_be_gone_on_with() {
    let scene = every_shape();
    let world = World::build(&scene, &scene.cameras[0]);
    let size = (60, 34);
    let options =
        Options { width: size.0, height: size.1, threads: Some(2), ..Options::from_settings(&scene.settings) };
    let target = Target { samples: 256, evaluations: 32, ..Target::new(8.0) };
    let mut pixels = vec![Pixel::unknown(); (size.0 * size.1) as usize];
    let mut refined = |witness: &Witness| {
        let control = Control { progress: witness, cancel: &witness.cancel };
        (refine(&world, &options, &target, &mut pixels, control).is_whole, pixels.clone())
    };
    let all = certify(&world, &options, &target);
    let first = Witness::new(size, 7);
    let (whole, part) = refined(&first);
    assert!(!whole && part.contains(&Pixel::unknown()));
    for ((told, found), wanted) in first.told.lock().unwrap().iter().zip(&part).zip(&all) {
        assert!(told.is_none_or(|told| told == wanted.value.map(|x| x as f32)));
        assert!(*found == Pixel::unknown() || found.value == wanted.value);
    }
    let second = Witness::new(size, usize::MAX);
    let (whole, rest) = refined(&second);
    assert!(whole && second.told.lock().unwrap().iter().all(|told| told.is_some()));
    assert!(rest.iter().zip(&all).all(|(a, b)| a.value == b.value && a.codes == b.codes && a.status == b.status));
}

#[test]
fn what_keeps_its_error_is_left_alone() {
    let scene = every_shape();
    let world = World::build(&scene, &scene.cameras[0]);
    let options = Options { width: 40, height: 24, ..Options::from_settings(&scene.settings) };
    let rough = Target { samples: 2048, ..Target::new(16.0) };
    let before = certify(&world, &options, &rough);
    let mut after = before.clone();
    let fine = Target { codes: 3.0, samples: 64, evaluations: 8, ..rough };
    let control = Control { progress: &Silent, cancel: &NEVER };
    assert!(refine(&world, &options, &fine, &mut after, control).is_whole);
    let mut fell_short = 0;
    for (a, b) in before.iter().zip(&after) {
        if a.keeps(3.0) {
            assert_eq!(a, b);
        } else if !b.keeps(3.0) {
            fell_short += 1;
            assert!(b.value == a.value && b.status == a.status && b.evaluations > a.evaluations, "{a:?} {b:?}");
        }
    }
    assert!(fell_short > 0, "a budget that is too small for some");
    assert!(before.iter().filter(|p| !p.keeps(3.0)).count() > fell_short, "but not for all");
}
