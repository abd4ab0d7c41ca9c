//! Whole scenes: pictures at a stated error against one at a small fraction of it.

use super::closed_form::off;
use super::kept::Kept;
use crate::render::bounds::larger;
use crate::render::certify::{Pixel, Status, Target, certify};
use crate::render::{Options, World};
use crate::scene::AntiAliasing;
use crate::verify::{Bound, Figure, Outcome, PictureCheck, Size, Subject};

/// The check.
pub const CHECK: PictureCheck = PictureCheck {
    name: "stated",
    what: "pixels keep the error that is stated of them, against a picture of a quarter of a code or 4,096 rays a pixel",
    run,
};

/// Errors of the pictures that are tried, in codes.
const TARGETS: [f64; 3] = [16.0, 4.0, 2.0];

fn run(subjects: &[Subject], size: Size) -> Outcome {
    let mut outcome = Outcome::default();
    for subject in subjects {
        let s = &subject.scene.settings;
        let width = size.pick(20, 64) as u32;
        let height = (width as u64 * s.height as u64).div_ceil(s.width.max(1) as u64).clamp(1, 2 * width as u64) as u32;
        let options = Options { width, height, aa: AntiAliasing::Off, ..Options::from_settings(s) };
        let world = World::build(&subject.scene, &subject.scene.cameras[0]);
        let samples = size.pick(512, 4_096) as u32;
        let fine = Target { quantum: 0.0, samples, ..Target::new(0.25) };
        let reference = certify(&world, &options, &fine);
        for codes in TARGETS {
            // Where little is proved, a picture is tried whose samples don't take longer than the reference's.
            let target = Target { samples, ..Target::new(codes) };
            let pixels = certify(&world, &options, &target);
            let mut kept = Kept::default();
            let (mut unknown, mut first) = (0, None);
            for (i, (pixel, truth)) in pixels.iter().zip(&reference).enumerate() {
                if truth.status == Status::Open && truth.codes > codes {
                    unknown += 1;
                    continue;
                }
                let error = off_by(pixel, truth, target.quantum);
                if kept.count(pixel, &target, error, truth.codes) && first.is_none() {
                    let (x, y) = (i as u32 % width, i as u32 / width);
                    let (name, status) = (&subject.name, pixel.status);
                    first = Some(format!("{name}, {codes}/255, pixel {x},{y}: {status:?}, off by {error:.4}/255"));
                }
            }
            outcome.cases += kept.cases();
            let what = format!("{}, {codes}/255", subject.name);
            outcome.figures.extend(kept.figures(&what, target.confidence));
            if unknown > 0 {
                let text = format!("{what}: not compared, for the reference is unsure");
                outcome.figures.push(Figure::new(text, unknown as f64, "", Bound::None));
            }
            outcome.first_failure = outcome.first_failure.or(first);
        }
    }
    outcome
}

/// How far the codes written for a pixel are from those of `truth`, which are exact but for its own error.
fn off_by(pixel: &Pixel, truth: &Pixel, quantum: f64) -> f64 {
    let one = |c: usize| off(&Pixel { value: [pixel.value[c]; 3], ..*pixel }, truth.value[c], quantum);
    (0..3).map(one).fold(0.0, larger)
}
