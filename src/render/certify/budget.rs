//! What certainty may cost: samples that keep a target whatever the scene are many more than those that keep it as far as
//! they can tell. A picture with few pixels that no region settles can afford them; one full of such pixels can't.

use super::super::crew::{share_out, useful};
use super::super::options::Options;
use super::certifier::Certifier;
use super::looks::Found;
use super::memo::Memo;
use super::target::Target;
use crate::math::hash::KeyedHash;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Samples for certainty, for each pixel of the picture on the average: as many as a grid of 23×23.
const AVERAGE: u64 = 512;

/// One pixel of so many by so many is tried.
const STEP: u32 = 8;

/// Tag of what random numbers are for.
const TRIED: u64 = 3;

/// The most samples of a pixel that certainty may cost, that the picture's average may be kept: found by looks at one pixel in
/// 64 of all of the picture, whatever part is asked for.
pub fn affordable(certifier: &Certifier<'_>, options: &Options, target: &Target, cancel: &AtomicBool) -> u32 {
    let [columns, rows] = [options.width.div_ceil(STEP), options.height.div_ceil(STEP)];
    let tried = columns as usize * rows as usize;
    if !target.certificates {
        return 0;
    }
    let going = (0..tried).take_while(|_| !cancel.load(Relaxed));
    let needs = share_out(useful(options.threads, tried), going, Vec::new, |needs, i| {
        let corner = [i as u32 % columns * STEP, i as u32 / columns * STEP];
        let key = KeyedHash::new().with(TRIED).with(i as u64);
        let size = [options.width, options.height];
        let at = [0, 1].map(|k| {
            let side = STEP.min(size[k] - corner[k]);
            corner[k] + (key.with(k as u64).bits() % side as u64) as u32
        });
        if let Found::Planned(plan) = certifier.looks(&mut Memo::default(), at, target, target.samples).found {
            needs.push(plan.total);
        }
    });
    let mut needs = needs.concat();
    needs.sort_unstable();
    let mut left = AVERAGE * tried as u64;
    for need in &needs {
        if *need as u64 > left {
            return *need - 1;
        }
        left -= *need as u64;
    }
    target.samples
}
