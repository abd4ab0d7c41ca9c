//! Rays through any points of the picture: for what no certificate settles, and to check certificates.

use super::super::batch::{MOST, NONE};
use super::super::camera::PixelGrid;
use super::super::cull::margin;
use super::super::footprint::Recorder;
use super::super::options::{Options, RayCounts};
use super::super::spawn::Faint;
use super::super::tracer::Tracer;
use super::super::world::World;
use crate::math::{Elem, Lane};
use std::sync::atomic::AtomicBool;

/// Traces points of the picture in 64-bit numbers. What it is compiled for never changes a bit.
pub trait Sampler {
    /// Adds the light of each point to `lights`, all of which lie within `rect`: left, top, right, bottom. Where the work is cancelled
    /// meanwhile, that light means nothing.
    fn add_lights(&mut self, rect: [f64; 4], points: &[[f64; 2]], lights: &mut Vec<[f64; 3]>);

    /// Calls `seen` with the number and the light of each point, likewise.
    fn trace(&mut self, rect: [f64; 4], points: &[[f64; 2]], seen: &mut dyn FnMut(usize, [f64; 3])) {
        let mut lights = Vec::with_capacity(points.len());
        self.add_lights(rect, points, &mut lights);
        lights.into_iter().enumerate().for_each(|(i, light)| seen(i, light));
    }

    /// From now on mirrored and transmitted rays are left out whose weight is `most` or less in every channel.
    fn leave_out(&mut self, most: f64);

    /// The sum of the weights of rays left out since this was last asked: of each its largest channel, rounded up.
    fn left_out(&mut self) -> f64;

    /// Rays so far.
    fn counts(&self) -> RayCounts;
}

/// A sampler whose rays travel in lanes.
pub struct LaneSampler<'w, L: Lane> {
    world: &'w World,
    grid: PixelGrid<'w>,
    tracer: Tracer<'w, L>,
}

impl<'w, L: Lane> LaneSampler<'w, L> {
    /// For a picture of the given options.
    pub fn new(world: &'w World, options: &Options, cancel: &'w AtomicBool) -> LaneSampler<'w, L> {
        let mut tracer = Tracer::new(world, options.max_depth, cancel, Recorder::off());
        let grid = world.camera.grid(options);
        let batch = tracer.camera_rays();
        for i in 0..MOST {
            for c in 0..3 {
                batch.weight[c][i] = L::Elem::from_f64(1.0);
                batch.d[c][i] = L::Elem::from_f64(grid.forward()[c]);
            }
            batch.slot[i] = L::Elem::from_f64(i as f64);
            batch.source[i] = L::Elem::from_f64(NONE);
        }
        LaneSampler { world, grid, tracer }
    }

    /// Finds what so many rays through `rect` may meet; false where that is nothing.
    #[inline(always)]
    fn find_candidates(&mut self, rect: [f64; 4], rays: usize) -> bool {
        let margin = margin(f64::EPSILON);
        let frustum = self.grid.frustum(rect, margin);
        let grid = &self.grid;
        self.tracer.candidates.gather(
            self.world,
            rays,
            #[inline(always)]
            |b| frustum.may_meet(b),
            |n, offset| grid.may_meet_plane(rect, n, offset, margin),
        );
        !self.tracer.candidates.is_empty()
    }

    /// Traces up to [`MOST`] points.
    #[inline(always)]
    fn batch(&mut self, points: &[[f64; 2]]) {
        let batch = self.tracer.camera_rays();
        batch.len = points.len();
        for (i, [x, y]) in points.iter().enumerate() {
            let (o, d) = self.grid.ray::<f64>(*x, *y);
            for c in 0..3 {
                (batch.o[c][i], batch.d[c][i]) = (L::Elem::from_f64(o[c]), L::Elem::from_f64(d[c]));
            }
        }
        match self.world.camera.at_eye() {
            true => self.tracer.trace::<true>(),
            false => self.tracer.trace::<false>(),
        }
    }
}

impl<L: Lane> Sampler for LaneSampler<'_, L> {
    fn add_lights(&mut self, rect: [f64; 4], points: &[[f64; 2]], lights: &mut Vec<[f64; 3]>) {
        let found = L::vectorize(
            #[inline(always)]
            || self.find_candidates(rect, points.len()),
        );
        if !found {
            lights.extend(points.iter().map(|_| self.world.background));
            self.tracer.counts.camera += points.len() as u64;
            return;
        }
        for chunk in points.chunks(MOST) {
            L::vectorize(
                #[inline(always)]
                || self.batch(chunk),
            );
            let [red, green, blue] = &self.tracer.radiance;
            let light = red.iter().zip(green.iter()).zip(blue.iter()).take(chunk.len());
            lights.extend(light.map(|((r, g), b)| [r.to_f64(), g.to_f64(), b.to_f64()]));
        }
    }

    fn leave_out(&mut self, most: f64) {
        self.tracer.faint.most = most;
    }

    fn left_out(&mut self) -> f64 {
        std::mem::take(&mut self.tracer.faint.lost) as f64 / Faint::UNIT
    }

    fn counts(&self) -> RayCounts {
        self.tracer.counts
    }
}
