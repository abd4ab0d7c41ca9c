//! A picture brought to its target: regions of many pixels first, then pixel by pixel. Every pixel depends on the world, the
//! options and the target alone, so the picture has the same bits for any number of threads.

use super::super::crew::{share_out, useful};
use super::super::dispatch::sampler;
use super::super::options::{Crop, Options, Progress, RayCounts, Silent};
use super::super::world::World;
use super::bound::Span;
use super::budget::affordable;
use super::certifier::Certifier;
use super::leaves::judged;
use super::memo::Memo;
use super::sampler::Sampler;
use super::target::{Pixel, Status, Target};
use super::window::Window;
use crate::math::Form;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Side of the largest regions, in pixels.
const BLOCK: u32 = 8;

/// Who is told of finished pixels, and who may end the work.
#[derive(Clone, Copy)]
pub struct Control<'c> {
    /// Told of every block of pixels that is done with, and of their light, which is final for the target at hand.
    pub progress: &'c dyn Progress,
    /// Once set, the work ends within milliseconds.
    pub cancel: &'c AtomicBool,
}

/// Every pixel of the picture, or of the options' part of it, brought to the target as far as its budgets allow; row by row.
pub fn certify(world: &World, options: &Options, target: &Target) -> Vec<Pixel> {
    let part = options.crop_or_all();
    let mut pixels = vec![Pixel::unknown(); part.width as usize * part.height as usize];
    let control = Control { progress: &Silent, cancel: &AtomicBool::new(false) };
    refine(world, options, target, &mut pixels, control);
    pixels
}

/// What became of a picture's refinement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Refined {
    /// Whether it got through; false where it was cancelled.
    pub is_whole: bool,
    /// What was traced.
    pub rays: RayCounts,
}

/// Brings those pixels to the target that don't keep its error yet, and leaves alone those that do. Where it is cancelled, what
/// wasn't reached is left as it was.
///
/// `pixels` are those of the picture, or of the options' part of it, row by row: [`Pixel::unknown`], or what a call for a larger
/// error left, of the same world and options. A pixel that isn't brought to the target keeps what it was known to keep
/// before. Bits depend on the world, the options and all targets so far, on nothing else, unless the work is cancelled.
pub fn refine(
    world: &World,
    options: &Options,
    target: &Target,
    pixels: &mut [Pixel],
    control: Control<'_>,
) -> Refined {
    let certifier = Certifier::new(world, options).for_target(target);
    let affordable = affordable(&certifier, options, target, control.cancel);
    let blocks = blocks(options, pixels).into_iter().take_while(|_| !control.cancel.load(Relaxed));
    let start = || Work {
        certifier: &certifier,
        sampler: sampler(world, options, control.cancel),
        memo: Memo::default(),
        picture: [options.width, options.height],
        target,
        affordable,
        cancel: control.cancel,
        spent: 0,
    };
    let workers = share_out(threads(options), blocks, start, |work, mut block| {
        work.square(&mut block, BLOCK, [0, 0]);
        if !control.cancel.load(Relaxed) {
            block.tell(control.progress);
        }
    });
    let rays = workers.iter().fold(RayCounts::default(), |rays, work| rays.plus(work.sampler.counts()));
    Refined { is_whole: !control.cancel.load(Relaxed), rays }
}

/// Threads that are of use for so many blocks.
pub(super) fn threads(options: &Options) -> usize {
    let part = options.crop_or_all();
    let across =
        |from: u32, length: u32| (from as usize + length as usize).div_ceil(BLOCK as usize) - (from / BLOCK) as usize;
    useful(options.threads, across(part.x, part.width) * across(part.y, part.height))
}

/// Pixels of a square of [`BLOCK`]² that are asked for.
struct Block<'p> {
    /// The square's corner in the picture, whatever part is asked for.
    at: [u32; 2],
    /// What is asked for, in the picture.
    part: Crop,
    rows: Vec<&'p mut [Pixel]>,
}

/// Cuts the pixels of the options' part into blocks: those of the whole picture.
fn blocks<'p>(options: &Options, pixels: &'p mut [Pixel]) -> Vec<Block<'p>> {
    let part = options.crop_or_all();
    // By the block that the number lies in: its start, and where the part of it ends that is asked for.
    let end = |at: u32, from: u32, length: u32| ((at / BLOCK + 1).saturating_mul(BLOCK)).min(from + length);
    let mut blocks: Vec<Block<'p>> = Vec::new();
    let mut row_of_blocks = 0;
    for (y, mut row) in (part.y..).zip(pixels.chunks_mut(part.width.max(1) as usize)) {
        if y == part.y || y % BLOCK == 0 {
            row_of_blocks = blocks.len();
        }
        let height = end(y, part.y, part.height) - y;
        let (mut x, mut number) = (part.x, row_of_blocks);
        while !row.is_empty() {
            let width = end(x, part.x, part.width) - x;
            let (piece, rest) = row.split_at_mut(row.len().min(width as usize));
            if number == blocks.len() {
                let at = [x / BLOCK * BLOCK, y / BLOCK * BLOCK];
                blocks.push(Block { at, part: Crop { x, y, width, height }, rows: Vec::new() });
            }
            blocks[number].rows.push(piece);
            (row, x, number) = (rest, x + width, number + 1);
        }
    }
    blocks
}

impl Block<'_> {
    /// The pixel at a place in the picture, if it is asked for.
    fn pixel(&mut self, [x, y]: [u32; 2]) -> Option<&mut Pixel> {
        let row = self.rows.get_mut(y.checked_sub(self.part.y)? as usize)?;
        row.get_mut(x.checked_sub(self.part.x)? as usize)
    }

    fn tell(&self, progress: &dyn Progress) {
        let mut light: Vec<Vec<[f32; 3]>> =
            self.rows.iter().map(|row| row.iter().map(|p| p.value.map(|x| x as f32)).collect()).collect();
        let rows: Vec<&mut [[f32; 3]]> = light.iter_mut().map(|row| &mut row[..]).collect();
        progress.finished(self.part, &rows);
    }
}

/// One thread's work.
struct Work<'w> {
    certifier: &'w Certifier<'w>,
    sampler: Box<dyn Sampler + Send + 'w>,
    memo: Memo,
    picture: [u32; 2],
    target: &'w Target,
    /// The most samples of a pixel that certainty may cost.
    affordable: u32,
    cancel: &'w AtomicBool,
    /// Looks at regions of several pixels that no pixel was charged for yet.
    spent: u32,
}

impl Work<'_> {
    /// The pixels of a square of the block, `from` its corner.
    fn square(&mut self, block: &mut Block<'_>, side: u32, from: [u32; 2]) {
        let [x, y] = [block.at[0] + from[0], block.at[1] + from[1]];
        let places = move || (0..side * side).map(move |i| [x + i % side, y + i / side]);
        let codes = self.target.codes;
        let mut wanted = places().filter_map(|at| block.pixel(at).map(|p| !p.keeps(codes)));
        if !wanted.any(|wanted| wanted) || self.cancel.load(Relaxed) {
            return;
        }
        if side == 1 {
            let memo = &mut self.memo;
            let pixel = self.certifier.pixel(&mut *self.sampler, memo, [x, y], self.target, self.affordable);
            return self.put(block, [x, y], pixel);
        }
        // Squares that reach beyond the picture are looked at in parts.
        let within = x + side <= self.picture[0] && y + side <= self.picture[1];
        if within && self.target.certificates {
            let window = self.certifier.window;
            let [from, to] = [[x, y], [x + side, y + side]];
            let [left, top] = from.map(|i| i as f64 - window.beyond());
            let [right, bottom] = to.map(|i| i as f64 + window.beyond());
            self.spent += 1;
            let form = self.certifier.form([left, top, right, bottom]);
            if let Some(pixels) = form.and_then(|form| all_proved(form, side, &window, self.target)) {
                for (at, pixel) in places().zip(pixels) {
                    if block.pixel(at).is_some_and(|p| !p.keeps(codes)) {
                        self.put(block, at, pixel);
                    }
                }
                return;
            }
        }
        let half = side / 2;
        for [dx, dy] in [[0, 0], [half, 0], [0, half], [half, half]] {
            self.square(block, half, [from[0] + dx, from[1] + dy]);
        }
    }

    /// Writes down what was found, unless it was cancelled on the way.
    fn put(&mut self, block: &mut Block<'_>, at: [u32; 2], mut found: Pixel) {
        if self.cancel.load(Relaxed) {
            return;
        }
        found.evaluations += std::mem::take(&mut self.spent);
        if let Some(pixel) = block.pixel(at) {
            *pixel = pixel.and_then(found);
        }
    }
}

/// The pixels of a square whose light is `form` all over, in all of their windows; `None` unless that proves every one of them.
/// Windows are symmetric, so the linear part adds what it is in the pixel's middle.
fn all_proved(form: [Form; 3], side: u32, window: &Window, target: &Target) -> Option<Vec<Pixel>> {
    if form.iter().any(|f| !f.is_known()) {
        return None;
    }
    let mut pixels = Vec::with_capacity((side * side) as usize);
    // Many are the same: background, and what lies in the shadow.
    let (mut last, mut found) = ([[f64::NAN; 2]; 3], ([0.0; 3], [0.0; 3], 0.0));
    for j in 0..side {
        for i in 0..side {
            let reach = side as f64 + 2.0 * window.beyond();
            let centre = |k: u32| ((2 * k + 1) as f64 + 2.0 * window.beyond()) / reach - 1.0;
            let known: [Span; 3] = form.map(|f| {
                let mean = f.c + (f.x * centre(i) + f.y * centre(j));
                // Two products and two sums, and the interval's ends.
                let off = window.size() * f.r + 8.0 * f64::EPSILON * (f.c.abs() + f.x.abs() + f.y.abs() + f.r);
                [mean - off, mean + off]
            });
            if known != last {
                (last, found) = (known, judged(known, target));
            }
            let (value, half_width, codes) = found;
            if !(codes <= target.codes) {
                return None;
            }
            pixels.push(Pixel { value, half_width, codes, status: Status::Proved, evaluations: 0, samples: 0 });
        }
    }
    Some(pixels)
}
