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
    render_on(Instructions::best(), world, options, progress, cancel)
}

/// What the tile's loop is compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Instructions {
    /// What every processor of the family has.
    Baseline,
    /// AVX2 and FMA of x86-64.
    #[cfg(target_arch = "x86_64")]
    Fma,
}

impl Instructions {
    /// The best of this machine.
    fn best() -> Instructions {
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
            return Instructions::Fma;
        }
        Instructions::Baseline
    }
}

fn render_on(
    instructions: Instructions,
    world: &World,
    options: &Options,
    progress: &dyn Progress,
    cancel: &AtomicBool,
) -> Option<Rendered> {
    let run = || match options.precision {
        Precision::F64 => render_in::<f64>(instructions, world, options, progress, cancel),
        Precision::F32 => render_in::<f32>(instructions, world, options, progress, cancel),
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
    instructions: Instructions,
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
                render_tile(instructions, worker, tile, &mut rows);
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

/// Renders one tile.
fn render_tile<L: Lane>(
    instructions: Instructions,
    worker: &mut TileWorker<'_, L>,
    tile: Crop,
    rows: &mut [&mut [[f32; 3]]],
) {
    match instructions {
        Instructions::Baseline => worker.render(tile, rows),
        // SAFETY: `Instructions::best` alone makes this value, and only where the processor was found to have both.
        #[cfg(target_arch = "x86_64")]
        Instructions::Fma => unsafe { render_tile_fma(worker, tile, rows) },
    }
}

/// The tile's loop, compiled for AVX2 and FMA: a fused multiply-add is then one instruction instead of a call.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn render_tile_fma<L: Lane>(worker: &mut TileWorker<'_, L>, tile: Crop, rows: &mut [&mut [[f32; 3]]]) {
    worker.render(tile, rows);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diag::{FileId, Place, Span};
    use crate::math::Affine;
    use crate::render::Silent;
    use crate::scene::{Light, Material, Node, NodeId, NodeKind, Pattern, PatternId, Scene, Shape};
    use glam::DVec3;

    /// A ball, a ring, a cone, a tetrahedron and a floor of a mirroring glass, all turned.
    fn scene() -> Scene {
        let mut scene = Scene::empty();
        let mut plain = Material::plain(|p| {
            scene.patterns.push(p);
            PatternId(scene.patterns.len() as u32 - 1)
        });
        scene.patterns.push(Pattern::constant(crate::scene::Color::linear_gray(0.4)));
        let half = PatternId(scene.patterns.len() as u32 - 1);
        (plain.reflect, plain.transmit, plain.specular, plain.ior) = (half, half, half, Some(1.4));
        scene.materials[0] = plain;
        let v = DVec3::new;
        let points = [v(-1.0, 0.1, 1.0), v(0.4, 0.2, 1.5), v(-0.2, 1.3, 1.1), v(-0.4, 0.3, 2.0)];
        let kinds = [
            NodeKind::Shape(Shape::Sphere { at: v(0.3, 0.7, 0.0), r: 0.9 }),
            NodeKind::Shape(Shape::Torus { at: v(1.5, 0.5, 0.2), r: 0.7, tube: 0.2, axis: v(1.0, 2.0, 0.3) }),
            NodeKind::Shape(Shape::Cone {
                from: v(-2.0, 0.0, 0.0),
                to: v(-1.5, 1.7, 0.3),
                r: 0.7,
                top: 0.1,
                caps: true,
            }),
            NodeKind::Shape(Shape::Tetrahedron { points }),
            NodeKind::Shape(Shape::Plane { through: v(0.0, -0.4, 0.0), normal: v(0.1, 1.0, 0.05) }),
            NodeKind::Light(Light { at: v(4.0, 6.0, 5.0), color: crate::scene::Color::WHITE, power: 1.0 }),
        ];
        for kind in kinds {
            let place = Place::new(Span::new(FileId(0), 0..1));
            let child = NodeId(scene.nodes.len() as u32);
            scene.nodes.push(Node { kind, material: None, name: None, place: place.clone() });
            let turn = Affine::rotation_about(v(0.2, 1.0, 0.4), 7.0);
            let kind = NodeKind::Transformed { child, parent_from_child: turn };
            scene.roots.push(NodeId(scene.nodes.len() as u32));
            scene.nodes.push(Node { kind, material: None, name: None, place });
        }
        scene
    }

    #[test]
    fn fused_operations_from_the_library_give_the_same_bits() {
        let scene = scene();
        let world = World::build(&scene, &scene.cameras[0]);
        for precision in [Precision::F64, Precision::F32] {
            let settings = Options::from_settings(&scene.settings);
            let options = Options { width: 64, height: 48, precision, ..settings };
            let on = |instructions| {
                render_on(instructions, &world, &options, &Silent, &AtomicBool::new(false)).expect("not cancelled")
            };
            let (best, baseline) = (on(Instructions::best()), on(Instructions::Baseline));
            assert!(best.rays.transmitted > 1000 && best.film == baseline.film);
        }
    }
}
