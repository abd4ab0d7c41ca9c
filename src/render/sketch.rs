//! More rays where neighbours differ: one a pixel first, then in passes up to as many as wanted for those pixels whose colours
//! aren't like their neighbours'. Nothing is promised of it, for what lies between all first rays is never found; but it is what
//! a short time is best spent on, and every pixel's bits depend on nothing but the pixels around it.

use super::crew::{share_out, useful};
use super::dispatch;
use super::lattice::Lattice;
use super::marks::{ACROSS, BAND, Blocks, Limits, Marks, mark};
use super::options::{Crop, Options, Progress, RayCounts, Rendered, Silent};
use super::supersampler::{Points, Supersampler};
use super::world::World;
use crate::film::Film;
use crate::scene::AntiAliasing;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

/// How much is done where.
#[derive(Clone, Copy, Debug)]
pub struct Pass {
    /// Points of such a pixel, the middle of it among them.
    pub lattice: Lattice,
    /// Neighbours of which a channel differs by more codes of 8 bits.
    pub codes: u8,
}

impl Pass {
    /// The better pixels are known, the smaller the differences that mean something.
    fn of(lattice: Lattice) -> Pass {
        let codes = match lattice.count() {
            ..8 => 16, // 8 takes up to 40 % more rays here, for an RMSE less by 0 to 12 % (nine scenes)
            8..50 => 8,
            50..200 => 4,
            200.. => 3,
        };
        Pass { lattice, codes }
    }

    /// One after the other, each of which takes longer than all before it. Powers of 5 nest without being worse for that: theirs are
    /// square lattices, each turned and 5 times as dense as the one before.
    pub fn all() -> [Pass; 4] {
        Lattice::nested([5, 25, 125, 625]).map(Pass::of)
    }
}

/// A pass goes on while pixels differ from neighbours that got their rays in it, one pixel further each time: where fine patterns
/// happen to give neighbours the same colour, this finds the whole of such a patch, up to so many pixels from where they differ.
const ROUNDS: u32 = 8;

/// So many blocks take about as long to look at as a thread to start, some 100 µs.
const FEW_LOOKS: usize = 128;
/// And so many to trace rays in.
const FEW_BLOCKS: usize = 2;

/// Makes the picture with so many `rays` where neighbours differ, or one more; `None` where `cancel` was set meanwhile.
pub fn render(
    world: &World,
    options: &Options,
    rays: u32,
    (progress, cancel): (&dyn Progress, &AtomicBool),
) -> Option<Rendered> {
    // Each round looks one pixel further: with a margin, a part of a picture gets the same bits as the whole.
    let part = options.crop_or_all();
    let (x, y) = (part.x.saturating_sub(ROUNDS), part.y.saturating_sub(ROUNDS));
    let end = |at: u32, length: u32, most: u32| (at + length).saturating_add(ROUNDS).min(most);
    let right = end(part.x, part.width, options.width);
    let wide = Crop { x, y, width: right - x, height: end(part.y, part.height, options.height) - y };
    let options = Options { crop: Some(wide), ..options.clone() };
    let mut sketch = Sketch::new(world, &options, cancel)?;
    // Of an odd number of points as many lie on each side of the middle.
    let [lattice] = Lattice::nested([rays | 1]);
    if !sketch.pass(Pass::of(lattice), (part, progress), cancel) {
        return None;
    }
    let Sketch { mut film, rays, .. } = sketch;
    if wide != part {
        let pixels = rows(&mut film.pixels, wide, part).concat();
        film = Film { width: part.width, height: part.height, pixels };
    }
    let threads = useful(options.threads, wide.height.div_ceil(BAND) as usize);
    Some(Rendered { film, rays, threads, certificate: None })
}

/// A picture without a certificate.
pub struct Sketch<'w> {
    /// Of this world.
    pub world: &'w World,
    /// Looked at so; rays a pixel and accuracy aside.
    pub options: &'w Options,
    /// The picture so far.
    pub film: Film,
    /// Rays so far.
    pub rays: RayCounts,
    /// How many points pixels have after so many passes.
    points: Vec<u32>,
    /// Of each pixel, how many passes it has had its rays of.
    levels: Vec<u8>,
    /// Whether it lacks rays.
    lacking: Vec<bool>,
    /// Whether any pixel of a block has had rays of a pass.
    had: Vec<bool>,
}

impl<'w> Sketch<'w> {
    /// One ray through the middle of every pixel; `None` where `cancel` was set meanwhile.
    pub fn new(world: &'w World, options: &'w Options, cancel: &AtomicBool) -> Option<Sketch<'w>> {
        let one = Options { aa: AntiAliasing::Off, accuracy: None, ..options.clone() };
        let Rendered { film, rays, .. } = dispatch::render(world, &one, &Silent, cancel)?;
        let (levels, lacking) = (vec![0; film.pixels.len()], vec![false; film.pixels.len()]);
        let had = vec![false; Blocks::of(options.crop_or_all()).count()];
        Some(Sketch { world, options, film, rays, points: vec![1], levels, lacking, had })
    }

    /// More rays where neighbours differ, until no more of them do or [`ROUNDS`] are over; whether it got through. Blocks that weren't
    /// reached are left as they are. `progress` is told of what is in `part` of the picture.
    pub fn pass(&mut self, pass: Pass, (part, progress): (Crop, &dyn Progress), cancel: &AtomicBool) -> bool {
        let all = self.options.crop_or_all();
        let (world, options, points) =
            (self.world, self.options, Points::of(pass.lattice, &self.points, self.options.filter));
        // Workers' memory is made once.
        let idle = Mutex::new(Vec::new());
        let worker = || {
            let known = idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
            known.unwrap_or_else(|| Supersampler::new(dispatch::sampler(world, options, cancel), &points, all))
        };
        let blocks = Blocks::of(all);
        let mut wanted = vec![true; blocks.count()];
        for _ in 0..ROUNDS {
            wanted = self.mark(pass, blocks.around(&wanted));
            if !wanted.contains(&true) || cancel.load(Relaxed) {
                break;
            }
            let workers = self.round(&wanted, &worker, cancel);
            idle.lock().unwrap_or_else(PoisonError::into_inner).extend(workers);
        }
        for worker in idle.into_inner().unwrap_or_else(PoisonError::into_inner) {
            self.rays = self.rays.plus(worker.counts());
        }
        self.points.push(pass.lattice.count());
        let is_whole = !cancel.load(Relaxed);
        if is_whole {
            progress.finished(part, &rows(&mut self.film.pixels, all, part));
        }
        is_whole
    }

    /// Marks pixels that lack rays, in blocks that are `wanted`; those are left in which there are any.
    fn mark(&mut self, pass: Pass, mut wanted: Vec<bool>) -> Vec<bool> {
        let (width, blocks) = (self.film.width.max(1) as usize, Blocks::of(self.options.crop_or_all()));
        let threads = useful(self.options.threads, blocks.pieces(&wanted, FEW_LOOKS));
        let across = blocks.across.max(1);
        let wanted_and_had = wanted.chunks_mut(across).zip(self.had.chunks(across));
        let bands = marks(&mut self.levels, &mut self.lacking, width).zip(wanted_and_had);
        let bands = (0..).step_by(BAND as usize).zip(bands);
        let (pixels, limits) = (&self.film.pixels, Limits { codes: pass.codes, level: self.points.len() as u8 });
        share_out(
            threads,
            bands,
            || (),
            |(), (y, (mut marks, blocks))| mark((pixels, width, y), limits, &mut marks, blocks),
        );
        wanted
    }

    /// The rays that pixels of some blocks lack; and those who traced them.
    fn round<'p>(
        &mut self,
        wanted: &[bool],
        worker: &(dyn Fn() -> Supersampler<'p, 'p> + Sync),
        cancel: &AtomicBool,
    ) -> Vec<Supersampler<'p, 'p>> {
        let all = self.options.crop_or_all();
        let width = self.film.width.max(1) as usize;
        let marks = marks(&mut self.levels, &mut self.lacking, width);
        let blocks = Blocks::of(all);
        self.had.iter_mut().zip(wanted).for_each(|(had, wanted)| *had |= wanted);
        let threads = useful(self.options.threads, blocks.pieces(wanted, FEW_BLOCKS));
        let wanted = wanted.chunks(blocks.across.max(1));
        let bands = self.film.pixels.chunks_mut(BAND as usize * width).zip(marks);
        let bands = (all.y..).step_by(BAND as usize).zip(wanted).zip(bands);
        share_out(threads, bands, worker, |worker, ((y, wanted), (pixels, mut marks))| {
            for (x, _) in (0..).step_by(ACROSS as usize).zip(wanted).filter(|(_, wanted)| **wanted) {
                if !cancel.load(Relaxed) {
                    worker.block([x, y], (pixels, &mut marks), cancel);
                }
            }
        })
    }
}

/// The marks of each band.
fn marks<'m>(levels: &'m mut [u8], lacking: &'m mut [bool], width: usize) -> impl Iterator<Item = Marks<'m>> {
    let bands = levels.chunks_mut(BAND as usize * width).zip(lacking.chunks_mut(BAND as usize * width));
    bands.map(|(levels, lacking)| Marks { levels, lacking })
}

/// Of the pixels of `all`, the rows of `part` of it.
fn rows(pixels: &mut [[f32; 3]], all: Crop, part: Crop) -> Vec<&mut [[f32; 3]]> {
    let rows = pixels.chunks_mut(all.width.max(1) as usize).skip((part.y - all.y) as usize).take(part.height as usize);
    rows.map(|row| &mut row[(part.x - all.x) as usize..][..part.width as usize]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::certify::tests::every_shape;
    use crate::render::certify::{Pixel, Target, certify, code};

    static NEVER: AtomicBool = AtomicBool::new(false);

    #[test]
    fn every_pass_of_a_sketch_brings_it_closer() {
        let scene = every_shape();
        let world = World::build(&scene, &scene.cameras[0]);
        let options = Options { width: 96, height: 54, ..Options::from_settings(&scene.settings) };
        let truth = certify(&world, &options, &Target::new(1.0));
        let off = |sketch: &Sketch<'_>| {
            let pixels = sketch.film.pixels.iter().zip(&truth);
            let square = |c: usize, p: &[f32; 3], t: &Pixel| {
                let off = code(p[c] as f64) - code(t.value[c]);
                off * off
            };
            let sum: f64 = pixels.map(|(p, t)| (0..3).map(|c| square(c, p, t)).sum::<f64>()).sum();
            (sum / (3 * truth.len()) as f64).sqrt()
        };
        let mut sketch = Sketch::new(&world, &options, &NEVER).unwrap();
        let mut before = off(&sketch);
        let mut rays = sketch.rays.camera;
        assert_eq!(rays, 96 * 54);
        let part = options.crop_or_all();
        for pass in Pass::all() {
            assert!(sketch.pass(pass, (part, &Silent), &NEVER));
            let (n, now) = (pass.lattice.count(), off(&sketch));
            assert!(now < 0.7 * before, "{n} rays: {before} to {now}");
            assert!(
                sketch.rays.camera > rays && sketch.rays.camera < rays + 96 * 54 * n as u64,
                "edges, and only they"
            );
            (before, rays) = (now, sketch.rays.camera);
        }
        // On several threads the same.
        let several = Options { threads: Some(3), ..options.clone() };
        let mut other = Sketch::new(&world, &several, &NEVER).unwrap();
        for pass in Pass::all() {
            other.pass(pass, (part, &Silent), &NEVER);
        }
        assert!(other.film == sketch.film);
        // And nothing is done to a row that isn't reached.
        let cancelled = AtomicBool::new(true);
        let [all] = Lattice::nested([960]).map(|lattice| Pass { lattice, codes: 0 });
        assert!(!other.pass(all, (part, &Silent), &cancelled) && other.film == sketch.film);
    }

    #[test]
    fn a_part_is_that_of_the_whole() {
        let scene = every_shape();
        let world = World::build(&scene, &scene.cameras[0]);
        let aa = AntiAliasing::Adaptive(100);
        let all = Options { width: 96, height: 54, aa, ..Options::from_settings(&scene.settings) };
        let whole = dispatch::render(&world, &all, &Silent, &NEVER).unwrap();
        let told = Mutex::new(vec![[f32::NAN; 3]; 40 * 23]);
        struct Witness<'t>(&'t Mutex<Vec<[f32; 3]>>, Crop);
        impl Progress for Witness<'_> {
            fn finished(&self, tile: Crop, rows: &[&mut [[f32; 3]]]) {
                let mut told = self.0.lock().unwrap();
                for (y, row) in (tile.y - self.1.y..).zip(rows) {
                    told[(y * self.1.width) as usize..][..row.len()].copy_from_slice(row);
                }
            }
        }
        for (x, y) in [(0, 0), (13, 9), (56, 31)] {
            let crop = Crop { x, y, width: 40, height: 23 };
            let options = Options { crop: Some(crop), threads: Some(2), ..all.clone() };
            let part = dispatch::render(&world, &options, &Witness(&told, crop), &NEVER).unwrap();
            let rows = whole.film.pixels.chunks(96).skip(y as usize).take(23);
            let expected: Vec<[f32; 3]> = rows.flat_map(|row| &row[x as usize..][..40]).copied().collect();
            assert!(part.film.pixels == expected && *told.lock().unwrap() == expected, "from ({x}, {y})");
        }
        assert!(dispatch::render(&world, &all, &Silent, &AtomicBool::new(true)).is_none());
    }
}
