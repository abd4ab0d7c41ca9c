//! One tile of the picture: which rays, in which order, and how their colours become pixels.
//!
//! With a filter beyond the box, pixels share rays with their neighbours. A tile traces those of the neighbours that it needs itself:
//! so it stays independent of all others, for up to 1.4 times as many rays.

use super::batch::{MOST, NONE};
use super::camera::PixelGrid;
use super::cull::margin;
use super::footprint::Recorder;
use super::options::{Crop, Options};
use super::taps::Taps;
use super::tracer::Tracer;
use super::world::World;
use crate::math::{Elem, Lane};
use crate::scene::AntiAliasing;
use std::sync::atomic::AtomicBool;

/// What pixel (x, y) sees in the first of its rays, in 64-bit numbers: the picture before its film rounds it.
pub fn radiance(world: &World, options: &Options, x: u32, y: u32) -> [f64; 3] {
    let one = Options { aa: AntiAliasing::Off, tile: 1, ..options.clone() };
    let cancel = AtomicBool::new(false);
    let mut worker = TileWorker::<f64>::new(world, &one, &cancel, Recorder::off());
    match worker.sum_up(Crop { x, y, width: 1, height: 1 }) {
        true => [0, 1, 2].map(|c| worker.sums[c][0]),
        false => world.background,
    }
}

/// A worker that renders tiles.
pub struct TileWorker<'w, L: Lane> {
    world: &'w World,
    grid: PixelGrid<'w>,
    side: u32,
    /// Rays traced; what [`render`](TileWorker::render) leaves for the statistics.
    pub tracer: Tracer<'w, L>,
    /// Sums over the rays of each pixel.
    sums: [Box<[f64]>; 3],
    /// How far right each column of the tile looks.
    across: Vec<f64>,
    /// What a filter beyond the box needs.
    filtered: Option<Filtered>,
}

/// Weights, and the light of one ray of each pixel of a tile and of those around it.
struct Filtered {
    taps: Taps,
    /// By channel, row by row.
    light: [Vec<f64>; 3],
}

impl<'w, L: Lane> TileWorker<'w, L> {
    /// A worker for tiles of up to [`Options::tile_side`]² pixels.
    pub fn new(world: &'w World, options: &Options, cancel: &'w AtomicBool, recorder: Recorder) -> Self {
        let n = (options.tile_side() * options.tile_side()) as usize;
        let side = options.aa.side();
        let filtered = Taps::of_picture(options).map(|taps| Filtered { taps, light: Default::default() });
        // Rays of neighbours, too.
        let most = if filtered.is_some() { MOST } else { n };
        let mut tracer = Tracer::new(world, options.max_depth, cancel, recorder);
        let grid = world.camera.grid(options);
        let batch = tracer.camera_rays();
        // What all camera rays have in common is written once.
        for i in 0..most {
            for c in 0..3 {
                batch.weight[c][i] = L::Elem::from_f64(1.0);
                batch.d[c][i] = L::Elem::from_f64(grid.forward()[c]);
            }
            batch.slot[i] = L::Elem::from_f64(i as f64);
            batch.source[i] = L::Elem::from_f64(NONE);
        }
        let sums = [(); 3].map(|_| vec![0.0; n].into_boxed_slice());
        TileWorker { world, grid, side, tracer, sums, across: Vec::new(), filtered }
    }

    /// Renders the pixels of `tile` into its rows.
    #[inline(always)]
    pub fn render(&mut self, tile: Crop, rows: &mut [&mut [[f32; 3]]]) {
        let n = (tile.width * tile.height) as usize;
        let samples = self.side * self.side;
        let background = self.background();
        if !self.sum_up(tile) {
            // Nothing here: the same sums as below, of one pixel, for all.
            let mut sum = [0.0; 3];
            for _ in 0..samples {
                sum = std::array::from_fn(|c| sum[c] + background[c]);
            }
            let mean = Mean::of(samples);
            let pixel = match self.filtered {
                None => sum.map(|s| mean.resolve(s)),
                Some(_) => background.map(stored),
            };
            rows.iter_mut().for_each(|row| row.fill(pixel));
            self.tracer.counts.camera += samples as u64 * n as u64;
            self.tracer.recorder().saw_background();
            return;
        }
        if self.tracer.is_cancelled() {
            return;
        }
        let mean = Mean::of(samples);
        let is_filtered = self.filtered.is_some();
        let [red, green, blue] = &self.sums;
        let mut i = 0;
        for row in rows {
            let colors = red[i..].iter().zip(&green[i..]).zip(&blue[i..]);
            i += row.len();
            for (pixel, ((r, g), b)) in row.iter_mut().zip(colors) {
                *pixel = match is_filtered {
                    false => [mean.resolve(*r), mean.resolve(*g), mean.resolve(*b)],
                    true => [stored(background[0] + r), stored(background[1] + g), stored(background[2] + b)],
                };
            }
        }
    }

    /// The background, as rays see it.
    #[inline(always)]
    fn background(&self) -> [f64; 3] {
        self.world.background.map(|c| L::Elem::from_f64(c).to_f64())
    }

    /// Adds up the rays of each pixel of `tile`, until cancelled; false where they all see the background. With a filter they are
    /// weighed, and what they have more than the background is added up: so where nothing else is seen exactly that is shown.
    #[inline(always)]
    fn sum_up(&mut self, tile: Crop) -> bool {
        let (x, y) = (tile.x as f64, tile.y as f64);
        let own = [x, y, x + tile.width as f64, y + tile.height as f64];
        let rect = self.filtered.as_ref().map_or(own, |f| f.taps.rect(tile));
        if !self.find_candidates(rect, (tile.width * tile.height * self.side * self.side) as usize) {
            return false;
        }
        let n = (tile.width * tile.height) as usize;
        let background = self.background();
        for sy in 0..self.side {
            for sx in 0..self.side {
                let is_first = sx == 0 && sy == 0;
                let ([left, top], [columns, all_rows]) = match &self.filtered {
                    None => ([x, y], [tile.width as usize, tile.height as usize]),
                    Some(filtered) => filtered.taps.patch(tile, [sx, sy]),
                };
                self.tracer.recorder().sample();
                // As many rows at a time as a batch has room for: without a filter all.
                for from in (0..all_rows).step_by(MOST / columns) {
                    if self.tracer.is_cancelled() {
                        return true;
                    }
                    let rows = (MOST / columns).min(all_rows - from);
                    self.camera_rays([left, top + from as f64], [columns, rows], [sx, sy]);
                    match self.world.camera.at_eye() {
                        true => self.tracer.trace::<true>(),
                        false => self.tracer.trace::<false>(),
                    }
                    if let Some(filtered) = &mut self.filtered {
                        for ((light, radiance), b) in
                            filtered.light.iter_mut().zip(&self.tracer.radiance).zip(background)
                        {
                            light.extend(radiance[..columns * rows].iter().map(|l| l.to_f64() - b));
                        }
                        continue;
                    }
                    for (sums, radiance) in self.sums.iter_mut().zip(&self.tracer.radiance) {
                        for (sum, light) in sums[..n].iter_mut().zip(&radiance[..n]) {
                            *sum = if is_first { 0.0 } else { *sum } + light.to_f64();
                        }
                    }
                }
                if let Some(filtered) = &mut self.filtered {
                    filtered.weigh(tile, [sx, sy], &mut self.sums, is_first);
                }
            }
        }
        true
    }

    /// Finds what so many camera rays through `rect` may meet; false where that is nothing.
    #[inline(always)]
    fn find_candidates(&mut self, rect: [f64; 4], rays: usize) -> bool {
        let margin = margin(L::UNIT_ROUNDOFF);
        let frustum = self.grid.frustum(rect, margin);
        let grid = &self.grid;
        self.tracer.candidates.gather(
            self.world,
            rays,
            #[inline(always)]
            |b| frustum.may_meet(b),
            |n, offset| grid.may_meet_plane(rect, n, offset, margin),
        );
        !self.tracer.candidates.is_empty()
    }

    /// One ray a pixel: sample (sx, sy) of each of those from `left` and `top` on.
    #[inline(always)]
    fn camera_rays(&mut self, [left, top]: [f64; 2], [width, height]: [usize; 2], [sx, sy]: [u32; 2]) {
        // A sample's place in its pixel; a middle is exact for every grid whose side is a power of two.
        let (ox, oy) = ((sx as f64 + 0.5) / self.side as f64, (sy as f64 + 0.5) / self.side as f64);
        self.across.clear();
        self.across.extend((0..width).map(|x| self.grid.across((left + x as f64) + ox)));
        let parallel = !self.world.camera.at_eye();
        let batch = self.tracer.camera_rays();
        batch.len = width * height;
        for py in 0..height {
            let (right, base) = self.grid.row((top + py as f64) + oy);
            let [a, b, c] = if parallel { &mut batch.o } else { &mut batch.d };
            let row = py * width..(py + 1) * width;
            let (a, b, c) = (&mut a[row.clone()], &mut b[row.clone()], &mut c[row]);
            // One loop for all three: rows are short, and beginning a loop costs as much as a few of its turns.
            for (((a, b), c), sx) in a.iter_mut().zip(b).zip(c).zip(&self.across) {
                *a = L::Elem::from_f64(right[0].mul_add(*sx, base[0]));
                *b = L::Elem::from_f64(right[1].mul_add(*sx, base[1]));
                *c = L::Elem::from_f64(right[2].mul_add(*sx, base[2]));
            }
        }
    }
}

/// Takes the mean of a pixel's rays.
pub struct Mean {
    samples: f64,
    /// Its reciprocal, where that is exact: it gives the same bits as the quotient, and sooner.
    reciprocal: Option<f64>,
}

impl Mean {
    /// Of so many.
    pub fn of(samples: u32) -> Mean {
        let count = samples as f64;
        Mean { samples: count, reciprocal: samples.is_power_of_two().then_some(1.0 / count) }
    }

    /// The mean, as it is stored.
    #[inline(always)]
    pub fn resolve(&self, sum: f64) -> f32 {
        let mean = match self.reciprocal {
            Some(factor) => sum * factor,
            None => sum / self.samples,
        };
        stored(mean)
    }
}

/// Light as it is stored. Brighter than `f32` can hold becomes the brightest that it can.
#[inline(always)]
fn stored(light: f64) -> f32 {
    light.clamp(-(f32::MAX as f64), f32::MAX as f64) as f32
}

impl Filtered {
    /// Adds to each pixel of a tile what its taps see of ray (sx, sy) of pixels; or begins with that. The light is used up.
    fn weigh(&mut self, tile: Crop, [sx, sy]: [u32; 2], sums: &mut [Box<[f64]>; 3], is_first: bool) {
        let (across, down) = (self.taps.of(sx), self.taps.of(sy));
        let (width, height) = (tile.width as usize, tile.height as usize);
        let columns = width + across.weights.len() - 1;
        for (light, sums) in self.light.iter_mut().zip(sums) {
            for row in light.chunks_exact_mut(columns) {
                for x in 0..width {
                    // What lies before isn't needed any more.
                    row[x] = row[x..].iter().zip(&across.weights).fold(0.0, |sum, (l, w)| sum + l * w);
                }
            }
            for y in 0..height {
                for x in 0..width {
                    let column = light[y * columns + x..].iter().step_by(columns);
                    let seen = column.zip(&down.weights).fold(0.0, |sum, (l, w)| sum + l * w);
                    let sum = &mut sums[y * width + x];
                    *sum = if is_first { 0.0 } else { *sum } + seen;
                }
            }
            light.clear();
        }
    }
}
