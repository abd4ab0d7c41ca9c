//! A picture brought to its target: regions of many pixels first, then pixel by pixel. Every pixel depends on the world, the
//! options and the target alone, so the picture has the same bits for any number of threads.

use super::super::bounds::larger;
use super::super::options::{Crop, Options};
use super::super::world::World;
use super::bound::Span;
use super::certifier::Certifier;
use super::leaves::judged;
use super::sampler::Sampler;
use super::target::{Pixel, Status, Target};
use crate::math::Form;
use rayon::prelude::*;

/// Side of the largest regions, in pixels.
const BLOCK: u32 = 8;

/// Brings every pixel of the picture, or of the options' part of it, to the target; row by row.
pub fn certify(world: &World, options: &Options, target: &Target) -> Vec<Pixel> {
    let certifier = Certifier::new(world, options);
    let part = options.crop_or_all();
    // Blocks are those of the whole picture, whatever part is asked for.
    let starts = |from: u32, length: u32| (from / BLOCK * BLOCK..from + length).step_by(BLOCK as usize);
    let blocks: Vec<[u32; 2]> =
        starts(part.y, part.height).flat_map(|y| starts(part.x, part.width).map(move |x| [x, y])).collect();
    let done: Vec<Vec<([u32; 2], Pixel)>> = blocks
        .par_iter()
        .map_init(
            || Sampler::new(world, options),
            |sampler, at| {
                let mut pixels = Vec::new();
                let picture = [options.width, options.height];
                certifier
                    .block(sampler, (*at, BLOCK), (picture, &part), target, &mut |at, pixel| pixels.push((at, pixel)));
                pixels
            },
        )
        .collect();
    let nothing =
        Pixel { value: [0.0; 3], half_width: [0.0; 3], codes: 0.0, status: Status::Open, evaluations: 0, samples: 0 };
    let mut out = vec![nothing; part.width as usize * part.height as usize];
    for ([x, y], pixel) in done.into_iter().flatten() {
        out[(y - part.y) as usize * part.width as usize + (x - part.x) as usize] = pixel;
    }
    out
}

impl Certifier<'_> {
    /// The pixels of `part` in the block of `side`² pixels at `at`, of a picture of the given size.
    fn block(
        &self,
        sampler: &mut Sampler<'_>,
        (at, side): ([u32; 2], u32),
        (picture, part): ([u32; 2], &Crop),
        target: &Target,
        put: &mut dyn FnMut([u32; 2], Pixel),
    ) {
        let [x, y] = at;
        let beside = x >= part.x + part.width || y >= part.y + part.height || x + side <= part.x || y + side <= part.y;
        if beside || x >= picture[0] || y >= picture[1] {
            return;
        }
        let inside =
            |x: u32, y: u32| (part.x..part.x + part.width).contains(&x) && (part.y..part.y + part.height).contains(&y);
        if side == 1 {
            return put(at, self.pixel(sampler, at, target));
        }
        // Blocks that reach beyond the picture are looked at in parts.
        let within = x + side <= picture[0] && y + side <= picture[1];
        let rect = [x as f64, y as f64, (x + side) as f64, (y + side) as f64];
        if within
            && let Some(form) = self.form(rect)
            && let Some(pixels) = all_proved(form, side, target)
        {
            for (i, pixel) in (0..).zip(pixels) {
                let at = [x + i % side, y + i / side];
                if inside(at[0], at[1]) {
                    put(at, pixel);
                }
            }
            return;
        }
        let half = side / 2;
        for [dx, dy] in [[0, 0], [half, 0], [0, half], [half, half]] {
            self.block(sampler, ([x + dx, y + dy], half), (picture, part), target, put);
        }
    }
}

/// The pixels of a block whose light is `form` all over; `None` unless that proves every one of them.
fn all_proved(form: [Form; 3], side: u32, target: &Target) -> Option<Vec<Pixel>> {
    if form.iter().any(|f| !f.is_known()) {
        return None;
    }
    let mut pixels = Vec::with_capacity((side * side) as usize);
    for j in 0..side {
        for i in 0..side {
            let centre = |k: u32| (2 * k + 1) as f64 / side as f64 - 1.0;
            let known: [Span; 3] = form.map(|f| {
                let mean = f.c + (f.x * centre(i) + f.y * centre(j));
                // Two products and two sums, and the interval's ends.
                let off = f.r + 8.0 * f64::EPSILON * (f.c.abs() + f.x.abs() + f.y.abs() + f.r);
                [mean - off, mean + off]
            });
            let (value, half_width, codes) = judged(known, target);
            if !(codes <= target.codes) {
                return None;
            }
            let evaluations = (i == 0 && j == 0) as u32;
            pixels.push(Pixel { value, half_width, codes, status: Status::Proved, evaluations, samples: 0 });
        }
    }
    Some(pixels)
}

/// How many pixels of a picture have which status: proved, bounded, estimated, open; and the largest error in codes that any of
/// the first three allows.
pub fn summary(pixels: &[Pixel]) -> ([usize; 4], f64) {
    let mut counts = [0; 4];
    let mut worst = 0.0;
    for p in pixels {
        counts[p.status as usize] += 1;
        if p.status != Status::Open {
            worst = larger(worst, p.codes);
        }
    }
    (counts, worst)
}
