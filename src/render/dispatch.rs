//! Spreads tiles over threads, on the best instructions that the machine has.
//!
//! Nothing here changes a bit of the picture: a fused multiply-add gives the same result from the processor and from the
//! library that stands in for it, only faster.

use super::belt::{Belt, Watchman};
use super::certify::{self, LaneSampler, Sampler};
use super::crew::{crew, useful};
use super::footprint::{Footprint, Recorder};
use super::options::{Crop, Instructions, Options, Progress, RayCounts, Rendered, Streamed};
use super::sketch;
use super::tile::TileWorker;
use super::world::World;
use crate::film::Film;
use crate::math::Lane;
#[cfg(target_arch = "x86_64")]
use crate::math::lane;
use crate::scene::{AntiAliasing, Precision};
use std::io;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

/// Traces the picture; `None` where `cancel` was set meanwhile. Its bits depend on `world` and on size, anti-aliasing or error,
/// depth and precision of `options`, on nothing else unless time is limited.
pub fn render(world: &World, options: &Options, progress: &dyn Progress, cancel: &AtomicBool) -> Option<Rendered> {
    match (options.accuracy, options.aa) {
        (Some(accuracy), _) => return certify::render(world, options, accuracy, (progress, cancel)),
        (None, AntiAliasing::Adaptive(rays)) => return sketch::render(world, options, rays, (progress, cancel)),
        _ => {}
    }
    let part = options.crop_or_all();
    let mut film = Film::new(part.width, part.height);
    let work = Work { world, options, progress, cancel };
    let (rays, threads) = work.fill(&mut film, None, None)?;
    Some(Rendered { film, rays, threads, certificate: None })
}

/// As [`render`], without a film of the whole picture: `develop` makes bytes of pixels, as many for each, on the threads
/// that trace; `take` is given them a few rows at a time, from the top, while others are traced.
///
/// # Errors
/// The first of `take`, which ends the work.
pub fn stream(
    world: &World,
    options: &Options,
    (progress, cancel): (&dyn Progress, &AtomicBool),
    (pixel_bytes, develop): (usize, Develop<'_>),
    take: &mut (dyn FnMut(&[u8]) -> io::Result<()> + Send),
) -> io::Result<Option<Streamed>> {
    if !options.is_by_tiles() {
        // Its pixels aren't ready in any order.
        let Some(rendered) = render(world, options, progress, cancel) else { return Ok(None) };
        let mut bytes = Vec::new();
        for row in rendered.film.pixels.chunks(rendered.film.width as usize) {
            bytes.clear();
            develop(row, &mut bytes);
            take(&bytes)?;
        }
        return Ok(Some(Streamed { rays: rendered.rays, threads: rendered.threads }));
    }
    let (part, side) = (options.crop_or_all(), options.tile_side());
    let tiles = part.width.div_ceil(side) as usize * part.height.div_ceil(side) as usize;
    let threads = useful(options.threads, tiles);
    let work = Work { world, options, progress, cancel };
    let belt = Belt::new(part, side, pixel_bytes, threads);
    let take = Mutex::new(take);
    let take = |rows: &[u8]| (take.lock().unwrap_or_else(PoisonError::into_inner))(rows);
    let done = work.run(&Course::Belt { belt: &belt, develop, take: &take }, threads);
    belt.end()?;
    Ok(done.map(|(rays, threads)| Streamed { rays, threads }))
}

/// Adds the bytes of pixels to what is there.
pub type Develop<'d> = &'d (dyn Fn(&[[f32; 3]], &mut Vec<u8>) + Sync);

/// Traces the tiles marked in `tiles`, in the order of [`Options::tiles`], into `film`, and leaves in `footprints` what each
/// depended on.
pub fn render_tiles(
    world: &World,
    options: &Options,
    (progress, cancel): (&dyn Progress, &AtomicBool),
    film: &mut Film,
    tiles: &[bool],
    footprints: &mut [Footprint],
) -> Option<RayCounts> {
    let work = Work { world, options, progress, cancel };
    work.fill(film, Some(tiles), Some(footprints)).map(|(rays, _)| rays)
}

/// A tracer of any points of the picture, in 64-bit numbers, until `cancel` is set.
pub fn sampler<'w>(world: &'w World, options: &Options, cancel: &'w AtomicBool) -> Box<dyn Sampler + Send + 'w> {
    match Build::of(options.instructions) {
        Build::Common => Box::new(LaneSampler::<f64>::new(world, options, cancel)),
        #[cfg(target_arch = "x86_64")]
        Build::Avx2 => Box::new(LaneSampler::<lane::F64x4>::new(world, options, cancel)),
        #[cfg(target_arch = "x86_64")]
        Build::Avx512 => Box::new(LaneSampler::<lane::F64x8>::new(world, options, cancel)),
    }
}

/// The instructions that `asked` comes to on this machine, in words: `AVX-512`, `AVX2 and FMA`, or `common`.
pub fn instructions(asked: Instructions) -> &'static str {
    match Build::of(asked) {
        Build::Common => "common",
        #[cfg(target_arch = "x86_64")]
        Build::Avx2 => "AVX2 and FMA",
        #[cfg(target_arch = "x86_64")]
        Build::Avx512 => "AVX-512",
    }
}

/// How many rays one of those instructions works on.
pub fn rays_at_a_time(asked: Instructions, precision: Precision) -> usize {
    match (Build::of(asked), precision) {
        (Build::Common, _) => 1,
        #[cfg(target_arch = "x86_64")]
        (Build::Avx2, Precision::F64) => lane::F64x4::WIDTH,
        #[cfg(target_arch = "x86_64")]
        (Build::Avx2, Precision::F32) => lane::F32x8::WIDTH,
        #[cfg(target_arch = "x86_64")]
        (Build::Avx512, Precision::F64) => lane::F64x8::WIDTH,
        #[cfg(target_arch = "x86_64")]
        (Build::Avx512, Precision::F32) => lane::F32x16::WIDTH,
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
}

/// A tile, the rows of the film that it fills, and where its footprint goes.
struct Job<'f> {
    tile: Crop,
    rows: Vec<&'f mut [[f32; 3]]>,
    footprint: Option<&'f mut Footprint>,
}

/// Where the tiles come from, and where their pixels go.
enum Course<'c> {
    /// Each to its place in a film. A job is locked once, by the thread whose turn it is.
    Film { jobs: &'c [Mutex<Job<'c>>], next: AtomicUsize, record: bool },
    /// Out, in order, and forgotten.
    Belt { belt: &'c Belt, develop: Develop<'c>, take: &'c (dyn Fn(&[u8]) -> io::Result<()> + Sync) },
}

impl Work<'_> {
    /// Traces the wanted tiles of a film; rays, and the threads that traced them.
    fn fill(
        &self,
        film: &mut Film,
        wanted: Option<&[bool]>,
        footprints: Option<&mut [Footprint]>,
    ) -> Option<(RayCounts, usize)> {
        let record = footprints.is_some();
        let jobs = jobs(self.options, film, wanted, footprints);
        let threads = useful(self.options.threads, jobs.len());
        self.run(&Course::Film { jobs: &jobs, next: AtomicUsize::new(0), record }, threads)
    }

    /// Follows the course; rays, and the threads that traced them.
    fn run(&self, course: &Course<'_>, threads: usize) -> Option<(RayCounts, usize)> {
        let on = Build::of(self.options.instructions);
        // Here and in `sampler` lanes are chosen, nowhere else: only what the processor was found to have.
        let counts = crew(threads, || match (on, self.options.precision) {
            (Build::Common, Precision::F64) => self.trace::<f64>(course),
            (Build::Common, Precision::F32) => self.trace::<f32>(course),
            #[cfg(target_arch = "x86_64")]
            (Build::Avx2, Precision::F64) => self.trace::<lane::F64x4>(course),
            #[cfg(target_arch = "x86_64")]
            (Build::Avx2, Precision::F32) => self.trace::<lane::F32x8>(course),
            #[cfg(target_arch = "x86_64")]
            (Build::Avx512, Precision::F64) => self.trace::<lane::F64x8>(course),
            #[cfg(target_arch = "x86_64")]
            (Build::Avx512, Precision::F32) => self.trace::<lane::F32x16>(course),
        });
        if self.cancel.load(Relaxed) {
            return None;
        }
        let threads = counts.len();
        Some((counts.into_iter().fold(RayCounts::default(), RayCounts::plus), threads))
    }

    /// One thread's share.
    fn trace<L: Lane>(&self, course: &Course<'_>) -> RayCounts {
        let recorder = match course {
            Course::Film { record: true, .. } => Recorder::new(self.world),
            _ => Recorder::off(),
        };
        let mut worker = TileWorker::<L>::new(self.world, self.options, self.cancel, recorder);
        match course {
            Course::Film { jobs, next, .. } => {
                while let Some(job) = jobs.get(next.fetch_add(1, Relaxed))
                    && !self.cancel.load(Relaxed)
                {
                    let mut job = job.lock().unwrap_or_else(PoisonError::into_inner);
                    let Job { tile, rows, footprint } = &mut *job;
                    self.tile(&mut worker, *tile, rows);
                    if let Some(footprint) = footprint {
                        **footprint = worker.tracer.recorder().take();
                    }
                }
            }
            Course::Belt { belt, develop, take } => {
                let _watchman = Watchman(belt);
                let side = self.options.tile_side() as usize;
                let (mut pixels, mut bytes) = (vec![[0.0; 3]; side * side], Vec::new());
                while let Some(tile) = belt.next() {
                    let pixels = &mut pixels[..tile.width as usize * tile.height as usize];
                    let mut rows: Vec<&mut [[f32; 3]]> = pixels.chunks_mut(tile.width as usize).collect();
                    self.tile(&mut worker, tile, &mut rows);
                    if self.cancel.load(Relaxed) {
                        belt.stop();
                        break;
                    }
                    bytes.clear();
                    develop(pixels, &mut bytes);
                    belt.put(tile, &bytes, take);
                }
            }
        }
        worker.tracer.counts
    }

    /// Traces one tile into its rows.
    fn tile<L: Lane>(&self, worker: &mut TileWorker<'_, L>, tile: Crop, rows: &mut [&mut [[f32; 3]]]) {
        L::vectorize(
            #[inline(always)]
            || worker.render(tile, rows),
        );
        if !self.cancel.load(Relaxed) {
            self.progress.finished(tile, rows);
        }
    }
}

/// Cuts `film` into the tiles of [`Options::tiles`], those of them that are wanted.
fn jobs<'f>(
    options: &Options,
    film: &'f mut Film,
    wanted: Option<&[bool]>,
    footprints: Option<&'f mut [Footprint]>,
) -> Vec<Mutex<Job<'f>>> {
    let (part, side) = (options.crop_or_all(), options.tile_side() as usize);
    let mut footprints = footprints.map(|all| all.iter_mut());
    let tiles = options.tiles().into_iter();
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
    if let Some(wanted) = wanted {
        let mut wanted = wanted.iter();
        jobs.retain(|_| wanted.next() == Some(&true));
    }
    jobs.into_iter().map(Mutex::new).collect()
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

    #[test]
    fn rows_that_go_out_are_those_of_the_film() {
        let scene = scene();
        let world = World::build(&scene, &scene.cameras[0]);
        let settings = Options { width: 61, height: 47, ..Options::from_settings(&scene.settings) };
        let part = Some(Crop { x: 9, y: 5, width: 40, height: 33 });
        let to_bytes = |pixels: &[[f32; 3]], out: &mut Vec<u8>| {
            out.extend(pixels.as_flattened().iter().flat_map(|v| v.to_bits().to_le_bytes()));
        };
        let work = (&Silent as &dyn Progress, &AtomicBool::new(false));
        for (threads, tile, crop) in [(1, 16, None), (2, 7, part), (8, 1, None), (3, 32, part)] {
            let options = Options { threads: Some(threads), tile, crop, ..settings.clone() };
            let whole = render(&world, &options, work.0, work.1).expect("not cancelled");
            let mut out = Vec::new();
            let mut take = |rows: &[u8]| {
                out.extend_from_slice(rows);
                Ok(())
            };
            let done = stream(&world, &options, work, (12, &to_bytes), &mut take).unwrap().expect("not cancelled");
            let mut expected = Vec::new();
            to_bytes(&whole.film.pixels, &mut expected);
            assert!(out == expected && done.rays == whole.rays, "{threads} threads, tiles of {tile}");
        }
        let mut full = |_: &[u8]| Err(io::ErrorKind::StorageFull.into());
        let fault = stream(&world, &settings, work, (12, &to_bytes), &mut full).unwrap_err();
        assert_eq!(fault.kind(), io::ErrorKind::StorageFull);
        let given_up = (work.0, &AtomicBool::new(true));
        assert!(matches!(stream(&world, &settings, given_up, (12, &to_bytes), &mut |_| Ok(())), Ok(None)));
    }
}
