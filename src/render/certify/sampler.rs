//! Rays through any points of the picture: for what no certificate settles, and to check certificates.

use super::super::batch::{MOST, NONE};
use super::super::camera::PixelGrid;
use super::super::cull::margin;
use super::super::footprint::Recorder;
use super::super::options::Options;
use super::super::tracer::Tracer;
use super::super::world::World;
use std::sync::atomic::AtomicBool;

/// Nothing cancels samples: they come in small numbers.
static NEVER: AtomicBool = AtomicBool::new(false);

/// Traces points of the picture in 64-bit numbers.
pub struct Sampler<'w> {
    world: &'w World,
    grid: PixelGrid<'w>,
    tracer: Tracer<'w, f64>,
    /// Rays from the camera so far.
    pub samples: u64,
}

impl<'w> Sampler<'w> {
    /// For a picture of the given options.
    pub fn new(world: &'w World, options: &Options) -> Sampler<'w> {
        let mut tracer = Tracer::new(world, options.max_depth, &NEVER, Recorder::off());
        let grid = world.camera.grid(options);
        let batch = tracer.camera_rays();
        for i in 0..MOST {
            for c in 0..3 {
                batch.weight[c][i] = 1.0;
                batch.d[c][i] = grid.forward()[c];
            }
            batch.slot[i] = i as f64;
            batch.source[i] = NONE;
        }
        Sampler { world, grid, tracer, samples: 0 }
    }

    /// Calls `seen` with the number and the light of each point, all of which lie within `rect`: left, top, right, bottom.
    pub fn trace(&mut self, rect: [f64; 4], points: &[[f64; 2]], mut seen: impl FnMut(usize, [f64; 3])) {
        self.samples += points.len() as u64;
        let margin = margin(f64::EPSILON);
        let frustum = self.grid.frustum(rect, margin);
        let grid = &self.grid;
        let candidates = &mut self.tracer.candidates;
        let plane = |n, offset| grid.may_meet_plane(rect, n, offset, margin);
        candidates.gather(self.world, points.len(), |b| frustum.may_meet(b), plane);
        if candidates.is_empty() {
            (0..points.len()).for_each(|i| seen(i, self.world.background));
            return;
        }
        let at_eye = self.world.camera.at_eye();
        for (chunk, first) in points.chunks(MOST).zip((0..).step_by(MOST)) {
            let batch = self.tracer.camera_rays();
            batch.len = chunk.len();
            for (i, [x, y]) in chunk.iter().enumerate() {
                let (o, d) = self.grid.ray::<f64>(*x, *y);
                for c in 0..3 {
                    (batch.o[c][i], batch.d[c][i]) = (o[c], d[c]);
                }
            }
            match at_eye {
                true => self.tracer.trace::<true>(),
                false => self.tracer.trace::<false>(),
            }
            for i in 0..chunk.len() {
                seen(first + i, [0, 1, 2].map(|c| self.tracer.radiance[c][i]));
            }
        }
    }
}
