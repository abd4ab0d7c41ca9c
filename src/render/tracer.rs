//! Traces a batch of camera rays and everything that follows from them.
//!
//! Rays go in batches; what a batch met is sorted by object, so that shape and material are the same for a whole run of
//! hits. Mirrored and transmitted rays go into batches of their own, which are traced one after the other before the next
//! batch: every pixel adds up its contributions in the order own, mirrored, transmitted, down its tree of rays, whatever
//! batch its rays travelled in. So tiles, crops and threads can't change a bit.

use super::batch::{Column, Column3, HitColumns, NONE, RayBatch, column3, load3};
use super::candidates::{Candidates, narrow_to_batch};
use super::footprint::Recorder;
use super::options::RayCounts;
use super::ray::Own;
use super::shade::{Children, Hits, ShadeScratch};
use super::shape::Visit;
use super::world::World;
use crate::math::{Elem, Lane, Real};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Traces batches; one for each worker thread.
pub struct Tracer<'w, L: Lane> {
    world: &'w World,
    cancel: &'w AtomicBool,
    max_depth: usize,
    levels: Vec<Level<L::Elem>>,
    /// Light gathered by each pixel of the tile.
    pub radiance: Column3<L::Elem>,
    /// What camera rays may meet.
    pub candidates: Candidates,
    /// What the batch at hand may meet.
    narrowed: Candidates,
    scratch: ShadeScratch<L::Elem>,
    groups: Groups,
    /// Rays traced so far.
    pub counts: RayCounts,
    capacity: usize,
}

/// The rays of one depth.
struct Level<E> {
    rays: RayBatch<E>,
    hits: HitColumns<E>,
    /// Rays and hits of one object, gathered.
    run: RayBatch<E>,
    run_hits: HitColumns<E>,
    mirrored: RayBatch<E>,
    transmitted: RayBatch<E>,
}

impl<E: Elem> Level<E> {
    fn new(n: usize) -> Level<E> {
        Level {
            rays: RayBatch::new(n),
            hits: HitColumns::new(n),
            run: RayBatch::new(n),
            run_hits: HitColumns::new(n),
            mirrored: RayBatch::new(n),
            transmitted: RayBatch::new(n),
        }
    }
}

impl<'w, L: Lane> Tracer<'w, L> {
    /// A tracer for batches of up to `capacity` rays, `max_depth` reflections and transmissions deep.
    /// It stops within a batch once `cancel` is set, and notes what rays do in `recorder`.
    pub fn new(world: &'w World, max_depth: u32, capacity: usize, cancel: &'w AtomicBool, recorder: Recorder) -> Self {
        Tracer {
            world,
            cancel,
            max_depth: max_depth as usize,
            levels: vec![Level::new(capacity)],
            radiance: column3(capacity),
            candidates: Candidates::default(),
            narrowed: Candidates::default(),
            scratch: ShadeScratch::new(capacity, recorder),
            groups: Groups::new(capacity),
            counts: RayCounts::default(),
            capacity,
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

    /// Traces the camera rays, whose candidates are known, and all that follows; adds to `radiance`. `AT_EYE` says that
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
                self.levels.push(Level::new(self.capacity)); // once a depth, not once a ray
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
        nearest::<L, AT_EYE>(self.world, candidates, &at.rays, &mut at.hits);
        self.groups.sort(&at.hits.id, at.rays.len);
        if self.scratch.recorder.is_on() {
            self.scratch.recorder.saw(self.groups.found.iter().map(|f| f.0));
            if self.groups.missed > 0 {
                self.scratch.recorder.saw_background();
            }
        }
        for k in 0..self.groups.missed {
            let i = self.groups.order[k] as usize;
            let slot = at.rays.slot[i].to_f64() as usize;
            for c in 0..3 {
                let seen = at.rays.weight[c][i].to_f64() * self.world.background[c];
                let sum = &mut self.radiance[c][slot];
                *sum = L::Elem::from_f64(sum.to_f64() + seen);
            }
        }
        let mut first = self.groups.missed;
        for g in 0..self.groups.found.len() {
            if self.cancel.load(Relaxed) {
                return;
            }
            let (id, count) = self.groups.found[g];
            let members = &self.groups.order[first..first + count as usize];
            first += count as usize;
            let whole = count as usize == at.rays.len;
            if !whole {
                gather_run(&at.rays, &at.hits, members, &mut at.run, &mut at.run_hits);
            }
            let (rays, hits) = if whole { (&at.rays, &at.hits) } else { (&at.run, &at.run_hits) };
            let spawn = level < self.max_depth;
            super::shade::shade::<L, AT_EYE>(
                self.world,
                Hits { id, rays, t: &hits.t, part: &hits.part },
                &mut self.scratch,
                &mut self.radiance,
                Children { mirrored: &mut at.mirrored, transmitted: &mut at.transmitted, spawn },
                &mut self.counts.shadow,
            );
        }
    }
}

/// Finds the nearest crossing in front of each ray's origin.
#[inline(always)]
pub fn nearest<L: Lane, const AT_EYE: bool>(
    world: &World,
    candidates: &Candidates,
    rays: &RayBatch<L::Elem>,
    hits: &mut HitColumns<L::Elem>,
) {
    let mut g = 0;
    while g < rays.len {
        let d = load3::<L>(&rays.d, g);
        let o = if AT_EYE { [L::zero(); 3] } else { load3::<L>(&rays.o, g) };
        let start = Start {
            primitive: L::load(&rays.source[g..]),
            part: L::load(&rays.source_part[g..]),
            outward: L::one().same(L::load(&rays.outward[g..])),
        };
        let mut best = Nearest { t: L::splat(f64::INFINITY), id: L::splat(NONE), part: L::zero(), current: L::zero() };
        for &k in &candidates.ids {
            best.test::<AT_EYE>(world, k, o, d, &start);
        }
        if candidates.tree {
            world.bvh.traverse(o, d, best.t, |k| {
                best.test::<AT_EYE>(world, k, o, d, &start);
                best.t
            });
        }
        best.t.store(&mut hits.t[g..]);
        best.id.store(&mut hits.id[g..]);
        best.part.store(&mut hits.part[g..]);
        g += L::WIDTH;
    }
}

/// Where rays start.
struct Start<R: Real> {
    /// The primitive, or [`NONE`].
    primitive: R,
    part: R,
    outward: R::Mask,
}

/// Keeps the nearest crossing; of two at the same t, that of the primitive with the lower number.
struct Nearest<R> {
    t: R,
    id: R,
    part: R,
    current: R,
}

impl<R: Real> Nearest<R> {
    /// Tests primitive `k`.
    #[inline(always)]
    fn test<const AT_EYE: bool>(&mut self, world: &World, k: u32, o: [R; 3], d: [R; 3], start: &Start<R>) {
        self.current = R::splat(k as f64);
        let here = start.primitive.same(self.current);
        let own = if AT_EYE { None } else { Some(Own { here, part: start.part, outward: start.outward }) };
        world.crossings::<R, AT_EYE>(k, (o, d), own, self);
    }
}

impl<R: Real> Visit<R> for Nearest<R> {
    #[inline(always)]
    fn crossing(&mut self, t: R, part: R, valid: R::Mask) {
        let nearer = t.lt(self.t) | (t.same(self.t) & self.current.lt(self.id));
        let m = valid & R::zero().lt(t) & nearer;
        self.t = R::select(m, t, self.t);
        self.id = R::select(m, self.current, self.id);
        self.part = R::select(m, part, self.part);
    }
}

/// Sorts a batch by what its rays met.
struct Groups {
    /// Indices of rays: first those that met nothing, then object by object in the order of `found`.
    order: Column<u32>,
    missed: usize,
    /// Objects in the order of their first ray, and how many rays met them.
    found: Vec<(u32, u32)>,
    group_of: Vec<u32>,
    next: Vec<u32>,
}

impl Groups {
    fn new(n: usize) -> Groups {
        Groups {
            order: vec![0; n].into_boxed_slice(),
            missed: 0,
            found: Vec::with_capacity(n),
            group_of: vec![0; n],
            next: Vec::with_capacity(n),
        }
    }

    fn sort<E: Elem>(&mut self, ids: &[E], n: usize) {
        self.found.clear();
        self.missed = 0;
        let mut last = 0;
        for (i, id) in ids[..n].iter().enumerate() {
            let id = id.to_f64();
            if id == NONE {
                self.group_of[i] = u32::MAX;
                self.order[self.missed] = i as u32;
                self.missed += 1;
                continue;
            }
            let id = id as u32;
            // Neighbouring rays mostly meet the same object.
            if self.found.get(last).is_none_or(|f| f.0 != id) {
                last = self.found.iter().position(|f| f.0 == id).unwrap_or_else(|| {
                    self.found.push((id, 0));
                    self.found.len() - 1
                });
            }
            self.found[last].1 += 1;
            self.group_of[i] = last as u32;
        }
        if self.found.len() == 1 && self.missed == 0 {
            return; // the whole batch is one run, used where it lies
        }
        self.next.clear();
        let mut at = self.missed as u32;
        for (_, count) in &self.found {
            self.next.push(at);
            at += count;
        }
        for (i, &group) in self.group_of[..n].iter().enumerate() {
            if group != u32::MAX {
                let at = &mut self.next[group as usize];
                self.order[*at as usize] = i as u32;
                *at += 1;
            }
        }
    }
}

fn gather_run<E: Elem>(
    rays: &RayBatch<E>,
    hits: &HitColumns<E>,
    members: &[u32],
    run: &mut RayBatch<E>,
    run_hits: &mut HitColumns<E>,
) {
    let pick = |from: &[E], to: &mut [E]| {
        for (out, &i) in to.iter_mut().zip(members) {
            *out = from[i as usize];
        }
    };
    for c in 0..3 {
        pick(&rays.o[c], &mut run.o[c]);
        pick(&rays.d[c], &mut run.d[c]);
        pick(&rays.weight[c], &mut run.weight[c]);
    }
    pick(&rays.slot, &mut run.slot);
    pick(&hits.t, &mut run_hits.t);
    pick(&hits.part, &mut run_hits.part);
    run.len = members.len();
}
