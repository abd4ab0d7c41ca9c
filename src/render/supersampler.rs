//! The further rays of pixels that differ from their neighbours: which points they go through, and how they are traced together.

use super::certify::Sampler;
use super::filter::Kernel;
use super::options::{Crop, RayCounts};
use super::sobol;
use crate::math::hash::KeyedHash;
use crate::scene::PixelFilter;
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

/// Points that stand for a pixel, to be taken by lot.
pub struct Patterns {
    rays: u32,
    points: Vec<Point>,
    /// By how much they may lie outside of their pixel.
    beyond: f64,
}

/// A point, from the pixel's upper left corner, and whether it counts against the light: 1 or −1. There are as many of them as the
/// filter has weight.
#[derive(Clone, Copy)]
struct Point {
    at: [f64; 2],
    sign: f64,
}

/// Among the first 2, 3, 4 and more up to so many points of a set, at most a quarter is negative: else what is left of them would be
/// too little to divide by. Later there are about as many as there should be.
const BALANCED: u32 = 64;

impl Patterns {
    /// Of so many points each, for a filter.
    pub fn new(rays: u32, filter: PixelFilter) -> Patterns {
        let kernel = Kernel::of(filter);
        let point = |i: u32, key: KeyedHash| {
            let at = sobol::point(i, key);
            let Some(k) = &kernel else { return Point { at, sign: 1.0 } };
            let [u, v] = at.map(|t| k.quantile(t, [-k.radius(), k.radius()]));
            Point { at: [0.5 + u, 0.5 + v], sign: k.sign(u) * k.sign(v) }
        };
        let is_balanced = |key: &KeyedHash| {
            let mut negative = 0;
            (0..BALANCED).all(|i| {
                negative += (point(i, *key).sign < 0.0) as u32;
                4 * negative <= i + 1
            })
        };
        let keys = (0..).map(|number| KeyedHash::new().with(SKETCH).with(number));
        let has_negative = kernel.as_ref().is_some_and(Kernel::has_negative);
        let keys = keys.filter(|key| !has_negative || is_balanced(key)).take(PATTERNS as usize);
        let points = keys.flat_map(|key| (0..rays).map(move |i| (i, key))).map(|(i, key)| point(i, key)).collect();
        Patterns { rays, points, beyond: kernel.map_or(0.0, |k| k.radius() - 0.5) }
    }

    /// Those of pixel (x, y).
    fn of(&self, x: u32, y: u32) -> &[Point] {
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
    /// Of each point, which of those pixels it belongs to, and its sign.
    whose: Vec<(u32, f64)>,
    /// Of each of those pixels, light and signs.
    sums: Vec<([f64; 3], f64)>,
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
            let (before, points) = self.patterns.of(x, y).split_at(had as usize);
            self.points.extend(points.iter().map(|Point { at: [u, v], .. }| [x as f64 + u, y as f64 + v]));
            self.whose.extend(points.iter().map(|p| (i, p.sign)));
            let of_before = before.iter().fold(0.0, |sum, p| sum + p.sign);
            let signs = points.iter().fold(of_before, |sum, p| sum + p.sign);
            self.sums.push((pixels[place(at)].map(|mean| of_before * mean as f64), signs));
        }
        let beyond = self.patterns.beyond;
        let [left, top] = [part.x + first[0], y + first[1]].map(|at| at as f64 - beyond);
        let [right, bottom] = [part.x + last[0] + 1, y + last[1] + 1].map(|at| at as f64 + beyond);
        let rect = [left, top, right, bottom];
        let (sums, whose) = (&mut self.sums, &self.whose);
        self.sampler.trace(rect, &self.points, &mut |i, light| {
            let (of, sign) = whose[i];
            let (sum, _) = &mut sums[of as usize];
            (0..3).for_each(|c| sum[c] += sign * light[c]);
        });
        if cancel.load(Relaxed) {
            return;
        }
        for (at, (sum, signs)) in self.edges.iter().map(|at| place(*at)).zip(&self.sums) {
            (pixels[at], taken[at]) = (sum.map(|s| (s / signs) as f32), rays);
        }
    }
}

/// The corners of the smallest rectangle around some places.
fn ends(places: &[[u32; 2]]) -> [[u32; 2]; 2] {
    places.iter().fold([[u32::MAX; 2], [0; 2]], |[least, most], p| {
        [[least[0].min(p[0]), least[1].min(p[1])], [most[0].max(p[0]), most[1].max(p[1])]]
    })
}
