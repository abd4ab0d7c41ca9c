//! What a picture looks like before anything is certain of it: one ray a pixel, then more of them where neighbours differ. Nothing
//! is promised of it, but it is what a short time is best spent on.

use super::super::crew::{crew, useful};
use super::super::dispatch;
use super::super::options::{Options, RayCounts, Silent};
use super::super::world::World;
use super::sobol;
use crate::film::{Depth, Developer, Film};
use crate::math::hash::KeyedHash;
use crate::scene::AntiAliasing;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

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
    /// Which pixels have more than one ray.
    is_edge: Vec<bool>,
}

/// How much is done where.
#[derive(Clone, Copy, Debug)]
pub struct Pass {
    /// Rays of such a pixel.
    pub rays: u32,
    /// Neighbours of which a channel differs by more codes of 8 bits.
    pub codes: u8,
}

/// Tag of what the random numbers are for.
const SKETCH: u64 = 3;

/// So many sets of points within a pixel are taken in turn by chance: neighbours rarely have the same, and making one for each
/// would cost as much as its rays.
const PATTERNS: u64 = 61;

/// Pixels side by side whose rays are traced together.
const TOGETHER: usize = 16;

impl<'w> Sketch<'w> {
    /// One ray through the middle of every pixel; `None` where `cancel` was set meanwhile.
    pub fn new(world: &'w World, options: &'w Options, cancel: &AtomicBool) -> Option<Sketch<'w>> {
        let one = Options { aa: AntiAliasing::Off, accuracy: None, ..options.clone() };
        let rendered = dispatch::render(world, &one, &Silent, cancel)?;
        let is_edge = vec![false; rendered.film.pixels.len()];
        Some(Sketch { world, options, film: rendered.film, rays: rendered.rays, is_edge })
    }

    /// More rays where neighbours differ; whether it got through. Rows that weren't reached are left as they are.
    pub fn pass(&mut self, pass: Pass, cancel: &AtomicBool) -> bool {
        self.mark(pass.codes);
        let part = self.options.crop_or_all();
        let width = part.width.max(1) as usize;
        let rows: Vec<_> = self.film.pixels.chunks_mut(width).zip(self.is_edge.chunks(width)).map(Mutex::new).collect();
        let pattern = |number| {
            let key = KeyedHash::new().with(SKETCH).with(number);
            (0..pass.rays).map(|i| sobol::point(i, key)).collect()
        };
        let patterns: Vec<Vec<[f64; 2]>> = (0..PATTERNS).map(pattern).collect();
        let next = AtomicUsize::new(0);
        let traced = crew(useful(self.options.threads, rows.len()), || {
            let mut sampler = dispatch::sampler(self.world, self.options, cancel);
            let (mut points, mut sums) = (Vec::new(), Vec::new());
            let mut traced = 0;
            loop {
                let number = next.fetch_add(1, Relaxed);
                let Some(row) = rows.get(number) else { return traced };
                // Locked once, by the thread whose turn it is.
                let mut row = row.lock().unwrap_or_else(PoisonError::into_inner);
                let (pixels, is_edge) = &mut *row;
                let y = part.y + number as u32;
                for (at, (pixels, is_edge)) in
                    (0..).step_by(TOGETHER).zip(pixels.chunks_mut(TOGETHER).zip(is_edge.chunks(TOGETHER)))
                {
                    let x = part.x + at;
                    points.clear();
                    for (k, _) in (0..).zip(is_edge.iter()).filter(|(_, edge)| **edge) {
                        let key = KeyedHash::new().with(SKETCH).with((x + k) as u64).with(y as u64);
                        let within = &patterns[(key.bits() % PATTERNS) as usize];
                        points.extend(within.iter().map(|[u, v]| [(x + k) as f64 + u, y as f64 + v]));
                    }
                    if points.is_empty() {
                        continue;
                    }
                    sums.clear();
                    sums.resize(points.len() / pass.rays as usize, [0.0; 3]);
                    let rect = [x as f64, y as f64, x as f64 + pixels.len() as f64, y as f64 + 1.0];
                    sampler.trace(rect, &points, &mut |i, light| {
                        let sum: &mut [f64; 3] = &mut sums[i / pass.rays as usize];
                        (0..3).for_each(|c| sum[c] += light[c]);
                    });
                    if cancel.load(Relaxed) {
                        return traced;
                    }
                    traced += points.len() as u64;
                    let those = pixels.iter_mut().zip(is_edge.iter()).filter(|(_, edge)| **edge);
                    those.zip(&sums).for_each(|((pixel, _), sum)| *pixel = sum.map(|s| (s / pass.rays as f64) as f32));
                }
            }
        });
        self.rays.camera += traced.iter().sum::<u64>();
        !cancel.load(Relaxed)
    }

    /// Marks pixels that differ from a neighbour beside or above or below them; those that are marked stay so.
    fn mark(&mut self, codes: u8) {
        let mut shown = Vec::new();
        Developer::of(Depth::Eight).develop(&self.film.pixels, &mut shown);
        let (shown, _) = shown.as_chunks::<3>();
        let width = self.film.width.max(1) as usize;
        let differ = |a: usize, b: usize| (0..3).any(|c| shown[a][c].abs_diff(shown[b][c]) > codes);
        for i in 0..shown.len() {
            if (i + 1) % width != 0 && i + 1 < shown.len() && differ(i, i + 1) {
                (self.is_edge[i], self.is_edge[i + 1]) = (true, true);
            }
            if i + width < shown.len() && differ(i, i + width) {
                (self.is_edge[i], self.is_edge[i + width]) = (true, true);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::every_shape;
    use super::super::{Pixel, Target, certify, code};
    use super::*;

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
        for (n, codes) in [(16, 8), (64, 4), (256, 3)] {
            assert!(sketch.pass(Pass { rays: n, codes }, &NEVER));
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
        for (rays, codes) in [(16, 8), (64, 4), (256, 3)] {
            other.pass(Pass { rays, codes }, &NEVER);
        }
        assert!(other.film == sketch.film);
        // And nothing is done to a row that isn't reached.
        let cancelled = AtomicBool::new(true);
        assert!(!other.pass(Pass { rays: 4, codes: 0 }, &cancelled) && other.film == sketch.film);
    }
}
