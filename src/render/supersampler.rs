//! The further rays of pixels that differ from their neighbours: which points they go through, and how they are traced together.

use super::certify::Sampler;
use super::options::{Crop, RayCounts};
use super::sobol;
use crate::math::hash::KeyedHash;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Rays are traced together by rectangles of so many pixels by so many: as many as a batch holds, were each to get one.
pub const ACROSS: u32 = 32;
/// See [`ACROSS`].
pub const BAND: u32 = 8;

/// Tag of what the random numbers are for.
const SKETCH: u64 = 3;

/// So many sets of points within a pixel are taken in turn by chance: neighbours rarely have the same, and making one for each
/// would cost as much as its rays.
const PATTERNS: u64 = 61;

/// Points within a pixel, to be taken by lot.
pub struct Patterns {
    rays: u32,
    points: Vec<[f64; 2]>,
}

impl Patterns {
    /// Of so many points each.
    pub fn new(rays: u32) -> Patterns {
        let of = |number| (0..rays).map(move |i| sobol::point(i, KeyedHash::new().with(SKETCH).with(number)));
        Patterns { rays, points: (0..PATTERNS).flat_map(of).collect() }
    }

    /// Those of pixel (x, y).
    fn of(&self, x: u32, y: u32) -> &[[f64; 2]] {
        let key = KeyedHash::new().with(SKETCH).with(x as u64).with(y as u64);
        &self.points[(key.bits() % PATTERNS) as usize * self.rays as usize..][..self.rays as usize]
    }
}

/// One thread's work on a pass.
pub struct Supersampler<'p, 'w> {
    sampler: Box<dyn Sampler + Send + 'w>,
    patterns: &'p Patterns,
    part: Crop,
    /// Pixels of the rectangle at hand: their place in the band, by column and row.
    edges: Vec<[u32; 2]>,
    points: Vec<[f64; 2]>,
    /// Of each point, which of those pixels it belongs to.
    whose: Vec<u32>,
    sums: Vec<[f64; 3]>,
}

impl<'p, 'w> Supersampler<'p, 'w> {
    /// For a part of a picture.
    pub fn new(sampler: Box<dyn Sampler + Send + 'w>, patterns: &'p Patterns, part: Crop) -> Supersampler<'p, 'w> {
        let (edges, points, whose, sums) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Supersampler { sampler, patterns, part, edges, points, whose, sums }
    }

    /// Finds which pixels of a band, from column x on, want rays.
    pub fn find_edges(&mut self, x: u32, taken: &[u32], is_edge: &[bool]) {
        let width = self.part.width as usize;
        self.edges.clear();
        for (row, (taken, is_edge)) in (0..).zip(taken.chunks(width).zip(is_edge.chunks(width))) {
            let columns = x..(x + ACROSS).min(self.part.width);
            let wanted = |x: &u32| is_edge[*x as usize] && taken[*x as usize] < self.patterns.rays;
            self.edges.extend(columns.filter(wanted).map(|x| [x, row]));
        }
    }

    /// Whether there are none.
    pub fn is_idle(&self) -> bool {
        self.edges.is_empty()
    }

    /// Rays so far.
    pub fn counts(&self) -> RayCounts {
        self.sampler.counts()
    }

    /// Traces the rays that those pixels lack, of which there is one at least.
    pub fn trace(&mut self, y: u32, (pixels, taken): (&mut [[f32; 3]], &mut [u32]), cancel: &AtomicBool) {
        let (part, rays) = (self.part, self.patterns.rays);
        let [first, last] = ends(&self.edges);
        let place = |[x, row]: [u32; 2]| (row * part.width + x) as usize;
        self.points.clear();
        self.whose.clear();
        self.sums.clear();
        for (i, &at) in (0..).zip(&self.edges) {
            let (x, y) = (part.x + at[0], y + at[1]);
            // The ray through the middle isn't one of the points, the others are the first of them.
            let had = Some(taken[place(at)]).filter(|n| *n > 1).unwrap_or(0);
            let points = &self.patterns.of(x, y)[had as usize..];
            self.points.extend(points.iter().map(|[u, v]| [x as f64 + u, y as f64 + v]));
            self.whose.resize(self.points.len(), i);
            self.sums.push(pixels[place(at)].map(|mean| had as f64 * mean as f64));
        }
        let rect = [part.x + first[0], y + first[1], part.x + last[0] + 1, y + last[1] + 1].map(f64::from);
        let (sums, whose) = (&mut self.sums, &self.whose);
        self.sampler.trace(rect, &self.points, &mut |i, light| {
            let sum = &mut sums[whose[i] as usize];
            (0..3).for_each(|c| sum[c] += light[c]);
        });
        if cancel.load(Relaxed) {
            return;
        }
        for (at, sum) in self.edges.iter().map(|at| place(*at)).zip(&self.sums) {
            (pixels[at], taken[at]) = (sum.map(|s| (s / rays as f64) as f32), rays);
        }
    }
}

/// The corners of the smallest rectangle around some places.
fn ends(places: &[[u32; 2]]) -> [[u32; 2]; 2] {
    places.iter().fold([[u32::MAX; 2], [0; 2]], |[least, most], p| {
        [[least[0].min(p[0]), least[1].min(p[1])], [most[0].max(p[0]), most[1].max(p[1])]]
    })
}
