//! What is too faint to matter: rays that are left out change no more than is said of them, whatever they travel with, and pictures
//! keep their error all the same.

use super::super::super::bounds::larger;
use super::super::super::dispatch::sampler;
use super::super::{Certifier, Pixel, Status, Target, certify, code};
use super::*;
use crate::render::options::{Instructions, Options};
use crate::render::world::World;

/// Two balls of glass, one within the other's sight, before mirrors.
fn glass() -> Scene {
    let mut scene = every_shape();
    for material in &mut scene.materials {
        material.ior = Some(1.5);
    }
    scene
}

#[test]
fn what_is_left_out_changes_no_more_than_is_said() {
    let scene = glass();
    let world = World::build(&scene, &scene.cameras[0]);
    let options = Options { width: 64, height: 36, max_depth: 8, ..Options::from_settings(&scene.settings) };
    let ceiling = Certifier::new(&world, &options).ceiling(options.max_depth - 1);
    let points: Vec<[f64; 2]> = (0..64 * 36).map(|i| [(i % 64) as f64 + 0.3, (i / 64) as f64 + 0.6]).collect();
    let traced = |most: f64, instructions| {
        let options = Options { instructions, ..options.clone() };
        let mut sampler = sampler(&world, &options, &NEVER);
        sampler.leave_out(most);
        let (mut light, mut left_out) = (Vec::new(), Vec::new());
        for point in &points {
            let rect = [point[0], point[1], point[0], point[1]];
            sampler.trace(rect, &[*point], &mut |_, l| light.push(l));
            left_out.push(sampler.left_out());
        }
        // Together they lose as much.
        let all: f64 = left_out.iter().sum();
        sampler.trace([0.0, 0.0, 64.0, 36.0], &points, &mut |i, l| assert_eq!(light[i], l));
        assert!((sampler.left_out() - all).abs() < 1e-9 * all || all == 0.0);
        (light, left_out, sampler.counts())
    };
    let (full, nothing, counts) = traced(0.0, Instructions::Best);
    assert!(nothing.iter().all(|w| *w == 0.0));
    let mut fewer = counts;
    for most in [1e-6, 1e-3, 0.03] {
        let (light, left_out, counts) = traced(most, Instructions::Best);
        assert!(counts.reflected < fewer.reflected && counts.camera == fewer.camera, "{most}: {counts:?}");
        fewer = counts;
        let mut closest = 0.0;
        for ((full, light), lost) in full.iter().zip(&light).zip(&left_out) {
            for c in 0..3 {
                let off = full[c] - light[c];
                assert!(off > -1e-12 && off <= lost * ceiling[c][1] + 1e-12, "{most}: {off} of {lost}");
                closest = larger(closest, if *lost > 0.0 { off / (lost * ceiling[c][1]) } else { 0.0 });
            }
        }
        assert!(closest > 0.1, "{most}: far less than said, {closest}");
        let common = traced(most, Instructions::Common);
        assert!(common.0 == light && common.1 == left_out, "one by one the same is left out");
    }
}

#[test]
fn pictures_without_what_is_faint_keep_their_error() {
    let scene = glass();
    let world = World::build(&scene, &scene.cameras[0]);
    let options = Options { width: 32, height: 18, max_depth: 8, ..Options::from_settings(&scene.settings) };
    let fine = Target { quantum: 0.0, samples: 1 << 14, ..Target::new(1.0) };
    let coarse = Target { quantum: 0.0, ..Target::new(4.0) };
    let truth = certify(&world, &options, &fine);
    let apart = |a: &Pixel, b: &Pixel| (0..3).map(|c| (code(a.value[c]) - code(b.value[c])).abs()).fold(0.0, larger);
    let sure = |p: &Pixel| matches!(p.status, Status::Proved | Status::Bounded);
    // With regions looked at, whatever is bent, and from samples alone.
    for certificates in [true, false] {
        let found = certify(&world, &options, &Target { certificates, ..coarse });
        let beyond = found.iter().zip(&truth).filter(|(a, b)| a.keeps(4.0) && apart(a, b) > a.codes + b.codes).count();
        let kept = found.iter().filter(|p| p.keeps(4.0)).count();
        assert!(kept > 500 && (certificates || found.iter().all(|p| !sure(p))), "{kept}");
        // Estimates are right for most, proofs and bounds for all.
        assert!(beyond <= 2, "{beyond}");
        assert!(found.iter().zip(&truth).all(|(a, b)| !sure(a) || !sure(b) || apart(a, b) <= a.codes + b.codes));
    }
}
