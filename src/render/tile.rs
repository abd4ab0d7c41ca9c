//! One tile of the picture: which rays, in which order, and how their colours become pixels.

use super::batch::NONE;
use super::camera::PixelGrid;
use super::cull::margin;
use super::footprint::Recorder;
use super::options::{Crop, Options};
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
        true => worker.sums[0],
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
    sums: Vec<[f64; 3]>,
}

impl<'w, L: Lane> TileWorker<'w, L> {
    /// A worker for tiles of up to [`Options::tile_side`]² pixels.
    pub fn new(world: &'w World, options: &Options, cancel: &'w AtomicBool, recorder: Recorder) -> Self {
        let n = (options.tile_side() * options.tile_side()) as usize;
        TileWorker {
            world,
            grid: world.camera.grid(options),
            side: options.aa.side(),
            tracer: Tracer::new(world, options.max_depth, n, cancel, recorder),
            sums: vec![[0.0; 3]; n],
        }
    }

    /// Renders the pixels of `tile` into its rows.
    #[inline(always)]
    pub fn render(&mut self, tile: Crop, rows: &mut [&mut [[f32; 3]]]) {
        let n = (tile.width * tile.height) as usize;
        let samples = self.side * self.side;
        if !self.sum_up(tile) {
            // Nothing here: the same sums as below, of one pixel, for all.
            let background = self.world.background.map(|c| L::Elem::from_f64(c).to_f64());
            let mut sum = [0.0; 3];
            for _ in 0..samples {
                sum = std::array::from_fn(|c| sum[c] + background[c]);
            }
            let pixel = resolve(sum, samples);
            rows.iter_mut().for_each(|row| row.fill(pixel));
            self.tracer.counts.camera += samples as u64 * n as u64;
            self.tracer.recorder().saw_background();
            return;
        }
        if self.tracer.is_cancelled() {
            return;
        }
        for (row, sums) in rows.iter_mut().zip(self.sums.chunks(tile.width as usize)) {
            for (pixel, sum) in row.iter_mut().zip(sums) {
                *pixel = resolve(*sum, samples);
            }
        }
    }

    /// Adds up the rays of each pixel of `tile`, until cancelled; false where they all see the background.
    #[inline(always)]
    fn sum_up(&mut self, tile: Crop) -> bool {
        if !self.find_candidates(tile) {
            return false;
        }
        let n = (tile.width * tile.height) as usize;
        self.sums[..n].fill([0.0; 3]);
        for sy in 0..self.side {
            for sx in 0..self.side {
                if self.tracer.is_cancelled() {
                    return true;
                }
                self.camera_rays(tile, [sx, sy]);
                self.tracer.recorder().sample();
                match self.world.camera.at_eye() {
                    true => self.tracer.trace::<true>(),
                    false => self.tracer.trace::<false>(),
                }
                for (i, sum) in self.sums[..n].iter_mut().enumerate() {
                    *sum = std::array::from_fn(|c| sum[c] + self.tracer.radiance[c][i].to_f64());
                }
            }
        }
        true
    }

    /// Finds what the tile's camera rays may meet; false where that is nothing.
    #[inline(always)]
    fn find_candidates(&mut self, tile: Crop) -> bool {
        let (x, y) = (tile.x as f64, tile.y as f64);
        let rect = [x, y, x + tile.width as f64, y + tile.height as f64];
        let margin = margin(L::UNIT_ROUNDOFF);
        let frustum = self.grid.frustum(rect, margin);
        let grid = &self.grid;
        self.tracer.candidates.gather(
            self.world,
            |b| frustum.may_meet(b),
            |n, offset| grid.may_meet_plane(rect, n, offset, margin),
        );
        !self.tracer.candidates.is_empty()
    }

    /// One ray a pixel: sample (sx, sy) of each.
    #[inline(always)]
    fn camera_rays(&mut self, tile: Crop, [sx, sy]: [u32; 2]) {
        // A sample's place in its pixel; a middle is exact for every grid whose side is a power of two.
        let at = |s: u32| (s as f64 + 0.5) / self.side as f64;
        let (ox, oy) = (at(sx), at(sy));
        let batch = self.tracer.camera_rays();
        let n = (tile.width * tile.height) as usize;
        for i in 0..n {
            let (px, py) = (i as u32 % tile.width, i as u32 / tile.width);
            let (x, y) = ((tile.x + px) as f64 + ox, (tile.y + py) as f64 + oy);
            let (o, d) = self.grid.ray::<f64>(x, y);
            for c in 0..3 {
                batch.o[c][i] = L::Elem::from_f64(o[c]);
                batch.d[c][i] = L::Elem::from_f64(d[c]);
                batch.weight[c][i] = L::Elem::from_f64(1.0);
            }
            batch.slot[i] = L::Elem::from_f64(i as f64);
            batch.source[i] = L::Elem::from_f64(NONE);
        }
        batch.len = n;
    }
}

/// The mean of a pixel's rays, as it is stored. Brighter than `f32` can hold becomes the brightest that it can.
fn resolve(sum: [f64; 3], samples: u32) -> [f32; 3] {
    sum.map(|s| (s / samples as f64).clamp(-(f32::MAX as f64), f32::MAX as f64) as f32)
}
