//! The further rays of pixels that differ from their neighbours: which points they go through, and how they are traced together.

use super::certify::Sampler;
use super::filter::Kernel;
use super::lattice::Lattice;
use super::marks::{ACROSS, Marks, encode};
use super::options::{Crop, RayCounts};
use super::tile::Mean;
use crate::math::hash::KeyedHash;
use crate::scene::PixelFilter;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Tag of what the random numbers are for.
const SKETCH: u64 = 3;

/// Points that stand for a pixel.
pub struct Points {
    lattice: Lattice,
    /// Turned over in every way: neighbours rarely share one, so that patterns are seen by chance, not by beats.
    ways: [Vec<Point>; 4],
    /// How many a pixel had before, after so many passes: as many as a lattice has that this one holds.
    before: Vec<u32>,
    /// What those come to, and last what all come to, where some count against the light.
    signs: Vec<f64>,
    /// By how much they may lie outside of their pixel.
    beyond: f64,
}

/// A point, from the pixel's middle, and whether it counts against the light: 1 or −1. They are as dense as the filter's weights are large.
#[derive(Clone, Copy)]
struct Point {
    at: [f64; 2],
    sign: f64,
}

impl Points {
    /// Those of a lattice, where pixels have had as many as this `before`, by number of passes.
    pub fn of(lattice: Lattice, before: &[u32], filter: PixelFilter) -> Points {
        let kernel = Kernel::of(filter);
        let point = |at: [f64; 2]| {
            let Some(k) = &kernel else { return Point { at, sign: 1.0 } };
            let [u, v] = at.map(|t| k.quantile(t + 0.5, [-k.radius(), k.radius()]));
            Point { at: [u, v], sign: k.sign(u) * k.sign(v) }
        };
        let ways = [0, 1, 2, 3].map(|way| lattice.points(way).map(point).collect::<Vec<Point>>());
        let signs = |count: &u32| ways[0].iter().step_by((lattice.count() / count) as usize).map(|p| p.sign).sum();
        let signs = before.iter().chain([&lattice.count()]).map(signs).collect();
        let beyond = kernel.as_ref().map_or(0.0, |k| k.radius() - 0.5);
        Points { lattice, ways, before: before.to_vec(), signs, beyond }
    }

    /// As many as pixel (x, y) lacks that has had rays of `level` passes.
    fn lacked(&self, x: u32, y: u32, level: u8) -> impl Iterator<Item = &Point> {
        let way = KeyedHash::new().with(SKETCH).with(x as u64).with(y as u64).bits() % 4;
        let step = self.lattice.count() / self.before[level as usize];
        self.ways[way as usize].chunks(step as usize).flat_map(|points| &points[1..])
    }
}

/// One thread's work on a pass.
pub struct Supersampler<'p, 'w> {
    sampler: Box<dyn Sampler + Send + 'w>,
    points: &'p Points,
    part: Crop,
    /// Pixels of the block at hand: their place in the band, by column and row.
    pixels: Vec<[u32; 2]>,
    /// Points of the picture: of each pixel those that it lacks, one pixel after the other.
    at: Vec<[f64; 2]>,
    /// And their signs.
    signs: Vec<f64>,
    lights: Vec<[f64; 3]>,
}

impl<'p, 'w> Supersampler<'p, 'w> {
    /// For a part of a picture.
    pub fn new(sampler: Box<dyn Sampler + Send + 'w>, points: &'p Points, part: Crop) -> Supersampler<'p, 'w> {
        let (pixels, at, signs, lights) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Supersampler { sampler, points, part, pixels, at, signs, lights }
    }

    /// Rays so far.
    pub fn counts(&self) -> RayCounts {
        self.sampler.counts()
    }

    /// Traces the rays that pixels lack in the block of a band that begins at column x. The band begins at row y of the picture.
    pub fn block(
        &mut self,
        [x, y]: [u32; 2],
        (pixels, marks, codes): (&mut [[f32; 3]], &mut Marks<'_>, &mut [[u8; 3]]),
        cancel: &AtomicBool,
    ) {
        let (part, count) = (self.part, self.points.lattice.count());
        let columns = x..(x + ACROSS).min(part.width);
        self.pixels.clear();
        for (row, lacking) in (0..).zip(marks.lacking.chunks(part.width as usize)) {
            let lacking = columns.clone().filter(|x| lacking[*x as usize]);
            self.pixels.extend(lacking.map(|x| [x, row]));
        }
        if self.pixels.is_empty() {
            return;
        }
        let place = |[x, row]: [u32; 2]| (row * part.width + x) as usize;
        self.at.clear();
        self.signs.clear();
        for &pixel in &self.pixels {
            let [x, y] = [part.x + pixel[0], y + pixel[1]];
            let lacked = self.points.lacked(x, y, marks.levels[place(pixel)]);
            for Point { at: [right, down], sign } in lacked {
                self.at.push([x as f64 + 0.5 + right, y as f64 + 0.5 + down]);
                self.signs.push(*sign);
            }
        }
        let [first, last] = ends(&self.pixels);
        let beyond = self.points.beyond;
        let [left, top] = [part.x + first[0], y + first[1]].map(|at| at as f64 - beyond);
        let [right, bottom] = [part.x + last[0] + 1, y + last[1] + 1].map(|at| at as f64 + beyond);
        let lights = &mut self.lights;
        lights.clear();
        self.sampler.trace([left, top, right, bottom], &self.at, &mut |_, light| lights.push(light));
        if cancel.load(Relaxed) {
            return;
        }
        let Points { before, signs, .. } = self.points;
        // A whole number, and more than half of them: few of a filter's weights are negative.
        let mean = Mean::of(signs[before.len()] as u32);
        let mut lights = self.lights.iter().zip(&self.signs);
        for at in self.pixels.iter().map(|pixel| place(*pixel)) {
            let level = marks.levels[at] as usize;
            let sum = pixels[at].map(|mean| signs[level] * mean as f64);
            let sum = lights
                .by_ref()
                .take((count - before[level]) as usize)
                .fold(sum, |sum, (light, sign)| [0, 1, 2].map(|c| sum[c] + sign * light[c]));
            pixels[at] = sum.map(|s| mean.resolve(s));
            encode(&pixels[at..=at], &mut codes[at..=at]);
            (marks.levels[at], marks.lacking[at]) = (before.len() as u8, false);
        }
    }
}

/// The corners of the smallest rectangle around some places.
fn ends(places: &[[u32; 2]]) -> [[u32; 2]; 2] {
    places.iter().fold([[u32::MAX; 2], [0; 2]], |[least, most], p| {
        [[least[0].min(p[0]), least[1].min(p[1])], [most[0].max(p[0]), most[1].max(p[1])]]
    })
}
