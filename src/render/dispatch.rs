//! Spreads tiles over threads, on the best instructions that the machine has.
//!
//! Nothing here changes a bit of the picture: a fused multiply-add gives the same result from the processor and from the
//! library that stands in for it, only faster.

use super::footprint::{Footprint, Recorder};
use super::options::{Crop, Instructions, Options, Progress, RayCounts, Rendered};
use super::tile::TileWorker;
use super::world::World;
use crate::film::Film;
use crate::math::Lane;
#[cfg(target_arch = "x86_64")]
use crate::math::lane;
use crate::scene::Precision;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Traces the picture; `None` where `cancel` was set meanwhile. Its bits depend on `world` and on size, anti-aliasing, depth
/// and precision of `options`, on nothing else.
pub fn render(world: &World, options: &Options, progress: &dyn Progress, cancel: &AtomicBool) -> Option<Rendered> {
    let part = options.crop_or_all();
    let mut film = Film::new(part.width, part.height);
    let work = Work { world, options, progress, cancel, tiles: None };
    let (rays, threads) = work.run(&mut film, None)?;
    Some(Rendered { film, rays, threads })
}

/// Traces the tiles marked in `tiles`, in the order of [`tiles_of`], into `film`, and leaves in `footprints` what each
/// depended on.
pub fn render_tiles(
    world: &World,
    options: &Options,
    (progress, cancel): (&dyn Progress, &AtomicBool),
    film: &mut Film,
    tiles: &[bool],
    footprints: &mut [Footprint],
) -> Option<RayCounts> {
    let work = Work { world, options, progress, cancel, tiles: Some(tiles) };
    work.run(film, Some(footprints)).map(|(rays, _)| rays)
}

/// The tiles of a picture, row by row.
pub fn tiles_of(options: &Options) -> Vec<Crop> {
    let (part, side) = (options.crop_or_all(), options.tile_side());
    let start = |from: u32, length: u32| (0..length.div_ceil(side)).map(move |k| from + k * side);
    let size = |at: u32, from: u32, length: u32| side.min(from + length - at);
    let row = |y: u32| {
        let height = size(y, part.y, part.height);
        start(part.x, part.width).map(move |x| Crop { x, y, width: size(x, part.x, part.width), height })
    };
    start(part.y, part.height).flat_map(row).collect()
}

/// The instructions that `asked` comes to on this machine, in words: `AVX2 and FMA`, or `common`.
pub fn instructions(asked: Instructions) -> &'static str {
    match Build::of(asked) {
        Build::Common => "common",
        #[cfg(target_arch = "x86_64")]
        Build::Avx2 => "AVX2 and FMA, 4 rays at a time",
        #[cfg(target_arch = "x86_64")]
        Build::Avx512 => "AVX-512, 8 rays at a time",
    }
}

/// What the tile's loop is compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Build {
    /// What every processor of the family has.
    Common,
    /// AVX2 and FMA of x86-64.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// AVX-512 of x86-64.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Build {
    fn of(asked: Instructions) -> Build {
        #[cfg(target_arch = "x86_64")]
        match asked {
            Instructions::Best if lane::avx512_is_there() => return Build::Avx512,
            Instructions::Best | Instructions::Narrow if lane::avx2_is_there() => return Build::Avx2,
            Instructions::Best | Instructions::Narrow | Instructions::Common => {}
        }
        #[cfg(not(target_arch = "x86_64"))]
        let _ = asked;
        Build::Common
    }
}

/// What is to be done.
struct Work<'w> {
    world: &'w World,
    options: &'w Options,
    progress: &'w dyn Progress,
    cancel: &'w AtomicBool,
    /// Which tiles; `None` for all.
    tiles: Option<&'w [bool]>,
}

/// A tile, the rows of the film that it fills, and where its footprint goes.
struct Job<'f> {
    tile: Crop,
    rows: Vec<&'f mut [[f32; 3]]>,
    footprint: Option<&'f mut Footprint>,
}

/// Stack of a worker: patterns nest up to the language's limit, at a few hundred bytes a level.
const STACK: usize = 16 << 20;

impl Work<'_> {
    /// Rays traced, and by how many threads.
    fn run(&self, film: &mut Film, footprints: Option<&mut [Footprint]>) -> Option<(RayCounts, usize)> {
        let on = Build::of(self.options.instructions);
        // The one place that chooses lanes: only what the processor was found to have.
        let run = || match (on, self.options.precision) {
            (Build::Avx512, Precision::F64) => self.trace::<lane::F64x8>(film, footprints),
            _ => self.trace::<f64>(film, footprints),
        };
        // Patterns may nest deep, and each level takes a frame of the stack.
        let threads = self.options.threads.unwrap_or(0);
        match rayon::ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK).build() {
            Ok(pool) => pool.install(run),
            Err(_) => run(), // no threads to be had: this one does it
        }
    }

    fn trace<L: Lane>(&self, film: &mut Film, footprints: Option<&mut [Footprint]>) -> Option<(RayCounts, usize)> {
        let record = footprints.is_some();
        let recorder = || if record { Recorder::new(self.world.primitives.len()) } else { Recorder::off() };
        let worker = || TileWorker::<L>::new(self.world, self.options, self.cancel, recorder());
        let jobs = self.jobs(film, footprints);
        let work = |worker: &mut TileWorker<'_, L>, mut job: Job<'_>| {
            if self.cancel.load(Relaxed) {
                return RayCounts::default();
            }
            worker.tracer.counts = RayCounts::default();
            L::vectorize(
                #[inline(always)]
                || worker.render(job.tile, &mut job.rows),
            );
            if let Some(footprint) = job.footprint {
                *footprint = worker.tracer.recorder().take();
            }
            if !self.cancel.load(Relaxed) {
                self.progress.finished(job.tile, &job.rows);
            }
            worker.tracer.counts
        };
        let rays = jobs.into_par_iter().map_init(worker, work).reduce(RayCounts::default, RayCounts::plus);
        if self.cancel.load(Relaxed) {
            return None;
        }
        Some((rays, rayon::current_num_threads()))
    }

    /// Cuts the film into tiles, those of [`tiles_of`] that are to be traced.
    fn jobs<'f>(&self, film: &'f mut Film, footprints: Option<&'f mut [Footprint]>) -> Vec<Job<'f>> {
        let (part, side) = (self.options.crop_or_all(), self.options.tile_side() as usize);
        let mut footprints = footprints.map(|all| all.iter_mut());
        let tiles = tiles_of(self.options).into_iter();
        let mut jobs: Vec<Job<'f>> = tiles
            .map(|tile| {
                let footprint = footprints.as_mut().and_then(Iterator::next);
                Job { tile, rows: Vec::with_capacity(tile.height as usize), footprint }
            })
            .collect();
        let (columns, width) = ((part.width as usize).div_ceil(side), part.width as usize);
        for (y, row) in film.pixels.chunks_mut(width).enumerate() {
            let first = y / side * columns;
            for (piece, job) in row.chunks_mut(side).zip(&mut jobs[first..]) {
                job.rows.push(piece);
            }
        }
        if let Some(wanted) = self.tiles {
            let mut wanted = wanted.iter();
            jobs.retain(|_| wanted.next() == Some(&true));
        }
        jobs
    }
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
            NodeKind::Shape(Shape::Tetrahedron { points: Box::new(points) }),
            NodeKind::Shape(Shape::Plane { through: v(0.0, -0.4, 0.0), normal: v(0.1, 1.0, 0.05) }),
            NodeKind::Light(Light { at: v(4.0, 6.0, 5.0), color: crate::scene::Color::WHITE, power: 1.0 }),
        ];
        for kind in kinds {
            let place = Place::new(Span::new(FileId(0), 0..1));
            let child = NodeId(scene.nodes.len() as u32);
            scene.nodes.push(Node { kind, material: None, name: None, place: place.clone() });
            let turn = Affine::rotation_about(v(0.2, 1.0, 0.4), 7.0);
            let kind = NodeKind::Transformed { child, parent_from_child: Box::new(turn) };
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
            let on = |instructions| {
                let options = Options { width: 64, height: 48, precision, instructions, ..settings.clone() };
                render(&world, &options, &Silent, &AtomicBool::new(false)).expect("not cancelled")
            };
            let (best, common) = (on(Instructions::Best), on(Instructions::Common));
            assert!(best.rays.transmitted > 1000 && best.film == common.film);
            assert!(best.film == on(Instructions::Narrow).film);
        }
    }
}
