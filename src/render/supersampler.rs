//! The further rays of pixels that differ from their neighbours: which points they go through, and how they are traced together.

use super::certify::Sampler;
use super::lattice::Lattice;
use super::marks::{ACROSS, Marks, encode};
use super::options::{Crop, RayCounts};
use super::tile::Mean;
use crate::math::hash::KeyedHash;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Tag of what the random numbers are for.
const SKETCH: u64 = 3;

/// Points within a pixel, from its middle.
pub struct Points {
    lattice: Lattice,
    /// How many a pixel had before, after so many passes: as many as a lattice has that this one holds.
    before: Vec<u32>,
    /// Turned over in every way: neighbours rarely share one, so that patterns are seen by chance, not by beats.
    ways: [Vec<[f64; 2]>; 4],
}

impl Points {
    /// Those of a lattice, where pixels have had as many as this `before`, by number of passes.
    pub fn of(lattice: Lattice, before: &[u32]) -> Points {
        Points { lattice, before: before.to_vec(), ways: [0, 1, 2, 3].map(|way| lattice.points(way).collect()) }
    }

    /// As many as pixel (x, y) lacks that has `had` some.
    fn lacked(&self, x: u32, y: u32, had: u32) -> impl Iterator<Item = &[f64; 2]> {
        let way = KeyedHash::new().with(SKETCH).with(x as u64).with(y as u64).bits() % 4;
        let step = self.lattice.count() / had;
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
    pub fn block(
        &mut self,
        [x, y]: [u32; 2],
        (pixels, marks, codes): (&mut [[f32; 3]], &mut Marks<'_>, &mut [[u8; 3]]),
        cancel: &AtomicBool,
    ) {
        let (part, count, before) = (self.part, self.points.lattice.count(), &self.points.before);
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
        for &pixel in &self.pixels {
            let [x, y] = [part.x + pixel[0], y + pixel[1]];
            let lacked = self.points.lacked(x, y, before[marks.levels[place(pixel)] as usize]);
            self.at.extend(lacked.map(|[right, down]| [x as f64 + 0.5 + right, y as f64 + 0.5 + down]));
        }
        let [first, last] = ends(&self.pixels);
        let rect = [part.x + first[0], y + first[1], part.x + last[0] + 1, y + last[1] + 1].map(f64::from);
        let lights = &mut self.lights;
        lights.clear();
        self.sampler.trace(rect, &self.at, &mut |_, light| lights.push(light));
        if cancel.load(Relaxed) {
            return;
        }
        let mean = Mean::of(count);
        let mut lights = lights.iter();
        for at in self.pixels.iter().map(|pixel| place(*pixel)) {
            let had = before[marks.levels[at] as usize];
            let sum = pixels[at].map(|mean| had as f64 * mean as f64);
            let sum = lights
                .by_ref()
                .take((count - had) as usize)
                .fold(sum, |sum, light| [0, 1, 2].map(|c| sum[c] + light[c]));
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
