//! Traces a batch of camera rays and everything that follows from them.
//!
//! Rays go in batches; what a batch met is sorted into runs that are shaded together, so that the material is the same for a
//! whole run of hits. Mirrored and transmitted rays go into batches of their own, which are traced one after the other before the next
//! batch: every pixel adds up its contributions in the order own, mirrored, transmitted, down its tree of rays, whatever
//! batch its rays travelled in. So tiles, crops and threads can't change a bit.

use super::batch::{Column3, HitColumns, NONE, RayBatch};
use super::candidates::{Candidates, narrow_to_batch};
use super::footprint::Recorder;
use super::gathered::Gathered;
use super::nearest::nearest;
use super::options::RayCounts;
use super::run::{LaneGroup, Run, Runs};
use super::run_of_hits::Hits;
use super::shade::{ShadeScratch, shade};
use super::spawn::{Children, Faint};
use super::way::Way;
use super::world::World;
use crate::math::real::{Mask, three};
use crate::math::{Elem, Lane};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Traces batches; one for each worker thread.
pub struct Tracer<'w, L: Lane> {
    world: &'w World,
    cancel: &'w AtomicBool,
    max_depth: usize,
    levels: Vec<Level<L::Elem>>,
    /// Light gathered by each pixel of the tile; what it holds when a [`trace`](Tracer::trace) begins is forgotten.
    pub radiance: Column3<L::Elem>,
    /// What camera rays may meet.
    pub candidates: Candidates,
    /// What the batch at hand may meet.
    narrowed: Candidates,
    scratch: ShadeScratch<L::Elem>,
    /// Of camera rays and of others.
    ways: [Way; 2],
    runs: Runs,
    /// The run at hand, once packed.
    packed: Run,
    /// Rays traced so far.
    pub counts: RayCounts,
    /// Rays that aren't followed.
    pub faint: Faint,
}

/// The rays of one depth. Batches are exchanged with the depth below, hence the boxes.
#[derive(Default)]
struct Level<E: Elem> {
    rays: Box<RayBatch<E>>,
    hits: Box<HitColumns<E>>,
    /// Rays and hits of a sparse run, packed.
    run: Box<RayBatch<E>>,
    run_hits: Box<HitColumns<E>>,
    mirrored: Box<RayBatch<E>>,
    transmitted: Box<RayBatch<E>>,
}

impl<'w, L: Lane> Tracer<'w, L> {
    /// A tracer of rays that go on for up to `max_depth` reflections and transmissions. It stops within a batch once `cancel` is
    /// set, and notes what rays do in `recorder`.
    pub fn new(world: &'w World, max_depth: u32, cancel: &'w AtomicBool, recorder: Recorder) -> Self {
        Tracer {
            world,
            cancel,
            max_depth: max_depth as usize,
            levels: vec![Level::default()],
            radiance: Default::default(),
            candidates: Candidates::default(),
            narrowed: Candidates::default(),
            scratch: ShadeScratch::new(recorder),
            ways: Default::default(),
            runs: Runs::new(world.primitives.len()),
            packed: Run::default(),
            counts: RayCounts::default(),
            faint: Faint::default(),
        }
    }

    /// Whether the work was given up.
    pub fn is_cancelled(&self) -> bool {
        self.cancel.load(Relaxed)
    }

    /// Where it notes what rays do.
    pub fn recorder(&mut self) -> &mut Recorder {
        &mut self.scratch.recorder
    }

    /// The batch that the next [`trace`](Tracer::trace) starts with.
    pub fn camera_rays(&mut self) -> &mut RayBatch<L::Elem> {
        &mut self.levels[0].rays
    }

    /// Traces the camera rays, whose candidates are known, and all that follows; leaves it in `radiance`. `AT_EYE` says that
    /// they all start at the origin.
    #[inline(always)]
    pub fn trace<const AT_EYE: bool>(&mut self) {
        self.counts.camera += self.levels[0].rays.len as u64;
        let candidates = std::mem::take(&mut self.candidates);
        let mut narrowed = std::mem::take(&mut self.narrowed);
        self.process::<AT_EYE>(0, &candidates);
        let mut level = 0;
        loop {
            if self.is_cancelled() {
                for level in &mut self.levels {
                    (level.mirrored.len, level.transmitted.len) = (0, 0);
                }
                break;
            }
            let at = &self.levels[level];
            if at.mirrored.len > 0 {
                self.counts.reflected += at.mirrored.len as u64;
            } else if at.transmitted.len > 0 {
                self.counts.transmitted += at.transmitted.len as u64;
            } else if level > 0 {
                level -= 1;
                continue;
            } else {
                break;
            }
            level += 1;
            if self.levels.len() == level {
                self.levels.push(Level::default()); // once a depth, not once a ray
            }
            let (above, below) = self.levels.split_at_mut(level);
            let parent = &mut above[level - 1];
            let children = if parent.mirrored.len > 0 { &mut parent.mirrored } else { &mut parent.transmitted };
            std::mem::swap(children, &mut below[0].rays);
            children.len = 0;
            let beam = narrow_to_batch::<L>(self.world, &self.levels[level].rays, &mut narrowed);
            if self.scratch.recorder.is_on() {
                self.scratch.recorder.beam(beam);
            }
            self.process::<false>(level, &narrowed);
        }
        (self.candidates, self.narrowed) = (candidates, narrowed);
    }

    /// Finds what the rays of a level meet and shades it; leaves mirrored and transmitted rays in the level.
    #[inline(always)]
    fn process<const AT_EYE: bool>(&mut self, level: usize, candidates: &Candidates) {
        let at = &mut self.levels[level];
        L::vectorize(
            #[inline(always)]
            || {
                let way = &mut self.ways[(level > 0) as usize];
                nearest::<L, AT_EYE>(self.world, candidates, &at.rays, &mut at.hits, way);
                self.runs.sort::<L>(self.world, &at.hits.id, at.rays.len);
            },
        );
        if self.scratch.recorder.is_on() {
            let ids = at.hits.id[..at.rays.len].iter().map(|id| id.to_f64());
            self.scratch.recorder.saw(ids.filter(|id| *id != NONE).map(|id| id as u32));
            if self.runs.missed.count > 0 {
                self.scratch.recorder.saw_background();
            }
        }
        // Camera rays stand in the order of their pixels, one for each, and are the first to add to them.
        let mut gathered = Gathered { radiance: &mut self.radiance, first: level == 0, in_order: level == 0 };
        background::<L>(self.world, &self.runs.missed, &at.rays, &mut gathered);
        for run in self.runs.met() {
            if self.cancel.load(Relaxed) {
                return;
            }
            let packed = run.is_sparse(L::WIDTH);
            if packed {
                pack::<L>(&at.rays, &at.hits, run, &mut at.run, &mut at.run_hits);
                self.packed.whole(run.count, L::WIDTH, run.only);
            }
            gathered.in_order = level == 0 && !packed;
            let (rays, hits) = if packed { (&at.run, &at.run_hits) } else { (&at.rays, &at.hits) };
            let groups: &[LaneGroup] = if packed { &self.packed.groups } else { &run.groups };
            let spawn = level < self.max_depth;
            let hits = Hits { flock: run.flock, only: run.only, rays, hits, groups, count: run.count };
            let (mirrored, transmitted) = (&mut at.mirrored, &mut at.transmitted);
            let children = Children { mirrored, transmitted, spawn, faint: &mut self.faint };
            let shadow_rays = &mut self.counts.shadow;
            shade::<L, AT_EYE>(self.world, hits, &mut self.scratch, &mut gathered, children, shadow_rays);
        }
    }
}

/// What rays see that met nothing.
#[inline(always)]
fn background<L: Lane>(world: &World, missed: &Run, rays: &RayBatch<L::Elem>, gathered: &mut Gathered<'_, L::Elem>) {
    for group in &missed.groups {
        let g = group.place();
        let seen = three!(c => L::load(&rays.weight[c][g..]) * L::splat(world.background[c]));
        gathered.add(group, &rays.slot, seen);
    }
}

/// Brings the rays of a run and their hits together.
#[inline(always)]
fn pack<L: Lane>(
    rays: &RayBatch<L::Elem>,
    hits: &HitColumns<L::Elem>,
    run: &Run,
    to: &mut RayBatch<L::Elem>,
    hits_to: &mut HitColumns<L::Elem>,
) {
    to.len = 0;
    for group in &run.groups {
        let (g, at, m) = (group.place(), to.len, L::Mask::from_bits(group.bits));
        for c in 0..3 {
            L::load(&rays.o[c][g..]).compress(m, &mut to.o[c][at..]);
            L::load(&rays.d[c][g..]).compress(m, &mut to.d[c][at..]);
            L::load(&rays.weight[c][g..]).compress(m, &mut to.weight[c][at..]);
        }
        L::load(&rays.slot[g..]).compress(m, &mut to.slot[at..]);
        L::load(&hits.t[g..]).compress(m, &mut hits_to.t[at..]);
        L::load(&hits.id[g..]).compress(m, &mut hits_to.id[at..]);
        L::load(&hits.part[g..]).compress(m, &mut hits_to.part[at..]);
        to.len += group.bits.count_ones() as usize;
    }
}
