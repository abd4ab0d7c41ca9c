//! The further rays of pixels that differ from their neighbours: which points they go through, and how they are traced together.

use super::certify::Sampler;
use super::filter::Kernel;
use super::lattice::Lattice;
use super::marks::{ACROSS, Marks};
use super::options::{Crop, RayCounts};
use super::tile::Mean;
use crate::math::hash::KeyedHash;
use crate::scene::PixelFilter;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Tag of what the random numbers are for.
const SKETCH: u64 = 3;

/// Points that stand for a pixel.
pub struct Points {
    /// Turned over in every way: neighbours rarely share one, so that patterns are seen by chance, not by beats. Of each way those that a
    /// pixel lacks, by the number of passes that it has had.
    ways: [Vec<Vec<Point>>; 4],
    /// How many passes there were before.
    passes: usize,
    /// What the points come to that a pixel had after so many passes, and last what all come to, where some count against the light.
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
        let step = |count: &u32| (lattice.count() / count) as usize;
        let signs = |count: &u32| ways[0].iter().step_by(step(count)).map(|p| p.sign).sum();
        let signs = before.iter().chain([&lattice.count()]).map(signs).collect();
        let lacked = |points: &Vec<Point>, count| points.chunks(step(count)).flat_map(|p| &p[1..]).copied().collect();
        let ways = ways.each_ref().map(|points| before.iter().map(|count| lacked(points, count)).collect());
        let beyond = kernel.as_ref().map_or(0.0, |k| k.radius() - 0.5);
        Points { ways, passes: before.len(), signs, beyond }
    }

    /// Those that pixel (x, y) lacks that has had rays of `level` passes.
    fn lacked(&self, [x, y]: [u32; 2], level: u8) -> &[Point] {
        let way = KeyedHash::new().with(SKETCH).with(x as u64).with(y as u64).bits() % 4;
        &self.ways[way as usize][level as usize]
    }
}

/// A pixel that lacks rays: its place in the band, by column and row, and the points that it lacks.
struct Lacking<'p> {
    at: [u32; 2],
    points: &'p [Point],
}

/// One thread's work on a pass.
pub struct Supersampler<'p, 'w> {
    sampler: Box<dyn Sampler + Send + 'w>,
    points: &'p Points,
    part: Crop,
    /// Pixels of the block at hand.
    pixels: Vec<Lacking<'p>>,
    /// Points of the picture: of each pixel those that it lacks, one pixel after the other.
    at: Vec<[f64; 2]>,
    lights: Vec<[f64; 3]>,
}

impl<'p, 'w> Supersampler<'p, 'w> {
    /// For a part of a picture.
    pub fn new(sampler: Box<dyn Sampler + Send + 'w>, points: &'p Points, part: Crop) -> Supersampler<'p, 'w> {
        let (pixels, at, lights) = (Vec::new(), Vec::new(), Vec::new());
        Supersampler { sampler, points, part, pixels, at, lights }
    }

    /// Rays so far.
    pub fn counts(&self) -> RayCounts {
        self.sampler.counts()
    }

    /// Traces the rays that pixels lack in the block of a band that begins at column x. The band begins at row y of the picture.
    pub fn block(&mut self, [x, y]: [u32; 2], (pixels, marks): (&mut [[f32; 3]], &mut Marks<'_>), cancel: &AtomicBool) {
        let (part, points) = (self.part, self.points);
        let end = (x + ACROSS).min(part.width);
        let place = |[x, row]: [u32; 2]| (row * part.width + x) as usize;
        self.pixels.clear();
        self.at.clear();
        for (row, lacking) in (0..).zip(marks.lacking.chunks(part.width as usize)) {
            for (column, _) in (x..).zip(&lacking[x as usize..end as usize]).filter(|(_, lacks)| **lacks) {
                let (at, pixel) = ([column, row], [part.x + column, y + row]);
                let lacked = points.lacked(pixel, marks.levels[place(at)]);
                self.pixels.push(Lacking { at, points: lacked });
                let [x, y] = pixel.map(|at| at as f64 + 0.5);
                self.at.extend(lacked.iter().map(|p| [x + p.at[0], y + p.at[1]]));
            }
        }
        if self.pixels.is_empty() {
            return;
        }
        let [first, last] = ends(&self.pixels);
        let beyond = self.points.beyond;
        let [left, top] = [part.x + first[0], y + first[1]].map(|at| at as f64 - beyond);
        let [right, bottom] = [part.x + last[0] + 1, y + last[1] + 1].map(|at| at as f64 + beyond);
        self.lights.clear();
        self.sampler.add_lights([left, top, right, bottom], &self.at, &mut self.lights);
        if cancel.load(Relaxed) {
            return;
        }
        // A whole number, and more than half of them: few of a filter's weights are negative.
        let (level, mean) = (points.passes, Mean::of(points.signs[points.passes] as u32));
        let mut lights = self.lights.iter();
        for Lacking { at, points: lacked } in &self.pixels {
            let at = place(*at);
            let had = points.signs[marks.levels[at] as usize];
            let mut sum = pixels[at].map(|mean| had * mean as f64);
            for (point, light) in lacked.iter().zip(&mut lights) {
                sum = [0, 1, 2].map(|c| sum[c] + point.sign * light[c]);
            }
            pixels[at] = sum.map(|s| mean.resolve(s));
            (marks.levels[at], marks.lacking[at]) = (level as u8, false);
        }
    }
}

/// The corners of the smallest rectangle around some pixels.
fn ends(pixels: &[Lacking<'_>]) -> [[u32; 2]; 2] {
    pixels.iter().map(|pixel| pixel.at).fold([[u32::MAX; 2], [0; 2]], |[least, most], p| {
        [[least[0].min(p[0]), least[1].min(p[1])], [most[0].max(p[0]), most[1].max(p[1])]]
    })
}
