//! More rays where neighbours differ: one a pixel first, then in passes up to as many as wanted for those pixels whose colours
//! aren't like their neighbours'. Nothing is promised of it, for what lies between all first rays is never found; but it is what
//! a short time is best spent on, and every pixel's bits depend on nothing but the pixels around it.

use super::crew::{crew, useful};
use super::dispatch;
use super::options::{Crop, Options, Progress, RayCounts, Rendered, Silent};
use super::supersampler::{ACROSS, BAND, Patterns, Supersampler};
use super::world::World;
use crate::film::{Depth, Developer, Film};
use crate::scene::AntiAliasing;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

/// How much is done where.
#[derive(Clone, Copy, Debug)]
pub struct Pass {
    /// Rays of such a pixel.
    pub rays: u32,
    /// Neighbours of which a channel differs by more codes of 8 bits.
    pub codes: u8,
}

/// Each pass takes longer than all before it, and about halves what is visible of the error. The better pixels are known, the
/// smaller the differences that mean something.
pub const PASSES: [Pass; 4] = [
    Pass { rays: 4, codes: 8 },
    Pass { rays: 16, codes: 8 },
    Pass { rays: 64, codes: 4 },
    Pass { rays: 256, codes: 3 },
];

/// A pass goes on while pixels differ from neighbours that got their rays in it, one pixel further each time: where fine patterns
/// happen to give neighbours the same colour, this finds the whole of such a patch, up to so many pixels from where they differ.
const ROUNDS: u32 = 8;

/// Makes the picture with up to so many `rays` where neighbours differ; `None` where `cancel` was set meanwhile.
pub fn render(
    world: &World,
    options: &Options,
    rays: u32,
    (progress, cancel): (&dyn Progress, &AtomicBool),
) -> Option<Rendered> {
    let before = PASSES.iter().take_while(|p| p.rays < rays).count();
    let last = Pass { rays, codes: PASSES[before.min(PASSES.len() - 1)].codes };
    // Each round looks one pixel further: with a margin, a part of a picture gets the same bits as the whole.
    let part = options.crop_or_all();
    let margin = (before as u32 + 1) * ROUNDS;
    let (x, y) = (part.x.saturating_sub(margin), part.y.saturating_sub(margin));
    let end = |at: u32, length: u32, most: u32| (at + length).saturating_add(margin).min(most);
    let right = end(part.x, part.width, options.width);
    let wide = Crop { x, y, width: right - x, height: end(part.y, part.height, options.height) - y };
    let options = Options { crop: Some(wide), ..options.clone() };
    let mut sketch = Sketch::new(world, &options, cancel)?;
    let is_whole = PASSES[..before].iter().all(|pass| sketch.pass(*pass, (part, &Silent), cancel));
    if !is_whole || !sketch.pass(last, (part, progress), cancel) {
        return None;
    }
    let pixels = rows(&mut sketch.film.pixels, wide, part).concat();
    let film = Film { width: part.width, height: part.height, pixels };
    let threads = useful(options.threads, wide.height.div_ceil(BAND) as usize);
    Some(Rendered { film, rays: sketch.rays, threads, certificate: None })
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
    /// How many rays each pixel has.
    taken: Vec<u32>,
    /// Which pixels differ from a neighbour, or did so before.
    is_edge: Vec<bool>,
}

impl<'w> Sketch<'w> {
    /// One ray through the middle of every pixel; `None` where `cancel` was set meanwhile.
    pub fn new(world: &'w World, options: &'w Options, cancel: &AtomicBool) -> Option<Sketch<'w>> {
        let one = Options { aa: AntiAliasing::Off, accuracy: None, ..options.clone() };
        let rendered = dispatch::render(world, &one, &Silent, cancel)?;
        let (taken, is_edge) = (vec![1; rendered.film.pixels.len()], vec![false; rendered.film.pixels.len()]);
        Some(Sketch { world, options, film: rendered.film, rays: rendered.rays, taken, is_edge })
    }

    /// More rays where neighbours differ, until no more of them do or [`ROUNDS`] are over; whether it got through. Bands that weren't
    /// reached are left as they are. `progress` is told of what is in `part` of the picture.
    pub fn pass(&mut self, pass: Pass, (part, progress): (Crop, &dyn Progress), cancel: &AtomicBool) -> bool {
        let all = self.options.crop_or_all();
        let (world, options, patterns) = (self.world, self.options, Patterns::new(pass.rays, self.options.filter));
        // Workers' memory is made once.
        let idle = Mutex::new(Vec::new());
        let worker = || {
            let known = idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
            known.unwrap_or_else(|| Supersampler::new(dispatch::sampler(world, options, cancel), &patterns, all))
        };
        let mut changed = vec![true; all.height.div_ceil(BAND) as usize];
        for round in 0..ROUNDS {
            let marked = self.mark(pass.codes, &changed);
            // Those that were marked before this pass lack rays, too.
            let wanted = if round == 0 { changed } else { marked };
            if !wanted.contains(&true) || cancel.load(Relaxed) {
                break;
            }
            let workers;
            (changed, workers) = self.round(&wanted, &worker, cancel);
            idle.lock().unwrap_or_else(PoisonError::into_inner).extend(workers);
        }
        for worker in idle.into_inner().unwrap_or_else(PoisonError::into_inner) {
            self.rays = self.rays.plus(worker.counts());
        }
        let is_whole = !cancel.load(Relaxed);
        if is_whole {
            progress.finished(part, &rows(&mut self.film.pixels, all, part));
        }
        is_whole
    }

    /// The rays that pixels of some bands lack which are marked; which bands that changes, and those who did it.
    fn round<'p>(
        &mut self,
        wanted: &[bool],
        worker: &(dyn Fn() -> Supersampler<'p, 'p> + Sync),
        cancel: &AtomicBool,
    ) -> (Vec<bool>, Vec<Supersampler<'p, 'p>>) {
        let (all, threads) = (self.options.crop_or_all(), self.threads(wanted));
        let band = all.width.max(1) as usize * BAND as usize;
        let bands = self.film.pixels.chunks_mut(band).zip(self.taken.chunks_mut(band)).zip(self.is_edge.chunks(band));
        let bands: Vec<_> = (all.y..).step_by(BAND as usize).zip(bands).map(Mutex::new).collect();
        let changed: Vec<AtomicBool> = bands.iter().map(|_| AtomicBool::new(false)).collect();
        let next = AtomicUsize::new(0);
        let workers = crew(threads, || {
            let mut worker = worker();
            while let number = next.fetch_add(1, Relaxed)
                && let Some(band) = bands.get(number)
                && !cancel.load(Relaxed)
            {
                if !wanted[number] {
                    continue;
                }
                // Locked once, by the thread whose turn it is.
                let mut band = band.lock().unwrap_or_else(PoisonError::into_inner);
                let (y, ((pixels, taken), is_edge)) = &mut *band;
                for x in (0..all.width).step_by(ACROSS as usize) {
                    worker.find_edges(x, taken, is_edge);
                    if !worker.is_idle() {
                        changed[number].store(true, Relaxed);
                        worker.trace(*y, (pixels, taken), cancel);
                    }
                }
            }
            worker
        });
        (changed.into_iter().map(AtomicBool::into_inner).collect(), workers)
    }

    /// Threads that are of use for so many bands.
    fn threads(&self, bands: &[bool]) -> usize {
        useful(self.options.threads, bands.iter().filter(|b| **b).count())
    }

    /// Marks pixels that differ from a neighbour beside or above or below them, where that may be since bands have changed; those that
    /// are marked stay so. In which bands any is that wasn't.
    fn mark(&mut self, codes: u8, changed: &[bool]) -> Vec<bool> {
        let concerned = |i: usize| changed[i.saturating_sub(1)..(i + 2).min(changed.len())].contains(&true);
        let concerned: Vec<bool> = (0..changed.len()).map(concerned).collect();
        let threads = self.threads(&concerned);
        let width = self.film.width.max(1) as usize;
        let (pixels, rows) = (&self.film.pixels, self.film.pixels.len() / width);
        let bands: Vec<_> = self.is_edge.chunks_mut(width * BAND as usize).enumerate().map(Mutex::new).collect();
        let marked: Vec<AtomicBool> = bands.iter().map(|_| AtomicBool::new(false)).collect();
        let next = AtomicUsize::new(0);
        crew(threads, || {
            let (mut shown, mut differ) = (Vec::new(), vec![0; 3 * width]);
            while let Some(band) = bands.get(next.fetch_add(1, Relaxed)) {
                let mut band = band.lock().unwrap_or_else(PoisonError::into_inner);
                let (number, is_edge) = &mut *band;
                if !concerned[*number] {
                    continue;
                }
                let mut any = false;
                // With the row above and the row below.
                let first = *number * BAND as usize;
                let (from, to) = (first.saturating_sub(1), (first + BAND as usize + 1).min(rows));
                shown.clear();
                Developer::of(Depth::Eight).develop(&pixels[from * width..to * width], &mut shown);
                let row = |y: usize| shown.get(3 * width * y..3 * width * (y + 1));
                for (y, is_edge) in (first - from..).zip(is_edge.chunks_mut(width)) {
                    let Some(here) = row(y) else { continue };
                    differ.fill(0);
                    note_differences(&here[3..], here, codes, &mut differ[3..]);
                    note_differences(here, &here[3..], codes, &mut differ);
                    for other in [y.checked_sub(1).and_then(row), row(y + 1)].into_iter().flatten() {
                        note_differences(here, other, codes, &mut differ);
                    }
                    for (is_edge, differ) in is_edge.iter_mut().zip(differ.chunks_exact(3)) {
                        let differs = differ.iter().any(|d| *d != 0);
                        any |= differs & !*is_edge;
                        *is_edge |= differs;
                    }
                }
                marked[*number].store(any, Relaxed);
            }
        });
        marked.into_iter().map(AtomicBool::into_inner).collect()
    }
}

/// Notes which of `a` differ by more than `most` from those of `b` in the same place, as far as the shorter of them goes.
fn note_differences(a: &[u8], b: &[u8], most: u8, differ: &mut [u8]) {
    for ((a, b), differ) in a.iter().zip(b).zip(differ) {
        *differ |= (a.abs_diff(*b) > most) as u8;
    }
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
        for Pass { rays: n, codes } in PASSES {
            assert!(sketch.pass(Pass { rays: n, codes }, (part, &Silent), &NEVER));
            let now = off(&sketch);
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
        for pass in PASSES {
            other.pass(pass, (part, &Silent), &NEVER);
        }
        assert!(other.film == sketch.film);
        // And nothing is done to a row that isn't reached.
        let cancelled = AtomicBool::new(true);
        assert!(!other.pass(Pass { rays: 1024, codes: 0 }, (part, &Silent), &cancelled) && other.film == sketch.film);
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
