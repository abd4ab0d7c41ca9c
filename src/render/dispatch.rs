//! Spreads tiles over threads, on the best instructions that the machine has.
//!
//! Nothing here changes a bit of the picture: a fused multiply-add gives the same result from the processor and from the
//! library that stands in for it, only faster.

use super::options::{Crop, Options, Progress, RayCounts, Rendered};
use super::tile::TileWorker;
use super::world::World;
use crate::film::Film;
use crate::math::Lane;
use crate::scene::Precision;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Traces the picture; `None` where `cancel` was set meanwhile. Its bits depend on `world` and on size, anti-aliasing, depth
/// and precision of `options`, on nothing else.
pub fn render(world: &World, options: &Options, progress: &dyn Progress, cancel: &AtomicBool) -> Option<Rendered> {
    let run = || match options.precision {
        Precision::F64 => render_in::<f64>(world, options, progress, cancel),
        Precision::F32 => render_in::<f32>(world, options, progress, cancel),
    };
    // Patterns may nest deep, and each level takes a frame of the stack.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.threads.unwrap_or(0)).stack_size(STACK).build();
    match pool {
        Ok(pool) => pool.install(run),
        Err(_) => run(), // no threads to be had: this one does it
    }
}

/// Stack of a worker: patterns nest up to the language's limit, at a few hundred bytes a level.
const STACK: usize = 16 << 20;

/// A tile and the rows of the film it fills.
type Job<'f> = (Crop, Vec<&'f mut [[f32; 3]]>);

fn render_in<L: Lane>(
    world: &World,
    options: &Options,
    progress: &dyn Progress,
    cancel: &AtomicBool,
) -> Option<Rendered> {
    let part = options.crop_or_all();
    let mut film = Film::new(part.width, part.height);
    let rays = jobs(&mut film, part, options.tile_side())
        .into_par_iter()
        .map_init(
            || TileWorker::<L>::new(world, options),
            |worker, (tile, mut rows)| {
                if cancel.load(Relaxed) {
                    return RayCounts::default();
                }
                worker.tracer.counts = RayCounts::default();
                render_tile(worker, tile, &mut rows);
                progress.advance(tile.width as u64 * tile.height as u64);
                worker.tracer.counts
            },
        )
        .reduce(RayCounts::default, RayCounts::plus);
    if cancel.load(Relaxed) {
        return None;
    }
    Some(Rendered { film, rays, threads: rayon::current_num_threads() })
}

/// Cuts the film into tiles. Tiles lie on a grid of the whole picture, but that is only for the order of work.
fn jobs(film: &mut Film, part: Crop, side: u32) -> Vec<Job<'_>> {
    let (columns, width) = (part.width.div_ceil(side), part.width as usize);
    let mut jobs: Vec<Job<'_>> = Vec::new();
    for (y, row) in film.pixels.chunks_mut(width).enumerate() {
        let y = y as u32;
        if y.is_multiple_of(side) {
            for k in 0..columns {
                let (x, w) = (k * side, side.min(part.width - k * side));
                let tile = Crop { x: part.x + x, y: part.y + y, width: w, height: side.min(part.height - y) };
                jobs.push((tile, Vec::with_capacity(side as usize)));
            }
        }
        let first = jobs.len() - columns as usize;
        for (piece, job) in row.chunks_mut(side as usize).zip(&mut jobs[first..]) {
            job.1.push(piece);
        }
    }
    jobs
}

/// Renders one tile with the instructions that this machine has.
#[cfg(target_arch = "x86_64")]
fn render_tile<L: Lane>(worker: &mut TileWorker<'_, L>, tile: Crop, rows: &mut [&mut [[f32; 3]]]) {
    /// The tile's loop, compiled for AVX2 and FMA.
    #[target_feature(enable = "avx2,fma")]
    fn with_fma<L: Lane>(worker: &mut TileWorker<'_, L>, tile: Crop, rows: &mut [&mut [[f32; 3]]]) {
        worker.render(tile, rows);
    }
    if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
        // SAFETY: the processor has just been found to have both features.
        unsafe { with_fma(worker, tile, rows) }
    } else {
        worker.render(tile, rows);
    }
}

/// Renders one tile; other processors have what they need in their baseline.
#[cfg(not(target_arch = "x86_64"))]
fn render_tile<L: Lane>(worker: &mut TileWorker<'_, L>, tile: Crop, rows: &mut [&mut [[f32; 3]]]) {
    worker.render(tile, rows);
}
