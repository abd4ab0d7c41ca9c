//! How much of a light arrives: shadow rays, and what transparent objects let through.

use super::batch::PADDING;
use super::between::Blocked;
use super::bvh::{Leaves, TEST};
use super::candidates::Candidates;
use super::footprint::Recorder;
use super::shadow_rays::{Shadow, ShadowRays};
use super::shape::Mesh;
use super::span::{least, spread, stored};
use super::surface_pattern::PatternFrame;
use super::world::World;
use crate::math::real::{Mask, each3, select3, splat3, three};
use crate::math::{Elem, Lane, Real};

/// The share of light, by channel, that arrives in the lanes of `active`. Every crossing of a transparent surface dims by its
/// transmission; the factors are multiplied in the order of the primitives' numbers, so that no order of tests changes a
/// bit.
#[inline(always)]
pub fn occlusion<L: Lane>(
    world: &World,
    occluders: &Candidates,
    rays: &ShadowRays<'_, L>,
    active: L::Mask,
    scratch: &mut Shadow,
    recorder: &mut Recorder,
) -> [L; 3] {
    let zero = [L::zero(); 3];
    let mut open = Open { mask: active, rays, blocker: None };
    // Opaque ones first: they need no order.
    scratch.transparent.clear();
    if !occluders.ids.is_empty() {
        open.test_here(world, &occluders.ids, &mut scratch.transparent, recorder);
    }
    if occluders.tree && open.mask.any() {
        scratch.blockers.resize(world.lights.len(), None);
        if let Some(k) = scratch.blockers[rays.light] {
            open.test_here(world, &[k], &mut scratch.transparent, recorder);
        }
        if open.mask.any() {
            open.through_tree(world, scratch, recorder);
        }
        scratch.blockers[rays.light] = open.blocker.or(scratch.blockers[rays.light]);
    }
    let seen = select3(open.mask, [L::one(); 3], zero);
    if scratch.transparent.is_empty() || !open.mask.any() {
        return seen;
    }
    dimmed(world, rays, seen, scratch, recorder)
}

/// The share of light, by channel, that the transparent surfaces `ids` let through to the lanes of `open`, which nothing opaque
/// stands before.
#[inline(always)]
pub fn dimmed_by<L: Lane>(
    world: &World,
    ids: &[u32],
    rays: &ShadowRays<'_, L>,
    open: L::Mask,
    scratch: &mut Shadow,
    recorder: &mut Recorder,
) -> [L; 3] {
    scratch.transparent.clear();
    for &k in ids {
        if !(rays.left_for_good(world, k, open) || rays.pass_by(world, k, open)) {
            scratch.transparent.push(k);
        }
    }
    let seen = select3(open, [L::one(); 3], [L::zero(); 3]);
    if scratch.transparent.is_empty() { seen } else { dimmed(world, rays, seen, scratch, recorder) }
}

/// What the transparent surfaces leave of `seen`.
#[inline(always)]
fn dimmed<L: Lane>(
    world: &World,
    rays: &ShadowRays<'_, L>,
    seen: [L; 3],
    scratch: &mut Shadow,
    recorder: &mut Recorder,
) -> [L; 3] {
    L::vectorize(
        #[inline(always)]
        || {
            let mut seen = seen;
            scratch.transparent.sort_unstable();
            for &k in &scratch.transparent {
                if recorder.is_on() {
                    recorder.shaded(k); // met or not: seldom more than a few
                }
                let met = rays.met(world, k);
                let constant = world.constant_transmission(k);
                let frame = PatternFrame::new(world, world.primitive(k), world.surfacing(k), &mut scratch.spaces);
                for (t, part, m) in met.crossings.into_iter().take(met.n) {
                    if !m.any() {
                        continue;
                    }
                    let factor = match constant {
                        Some(factor) => splat3(factor),
                        None => {
                            let surface = world.surface::<L, false>(k, (rays.o, rays.l), (t, part));
                            let at = frame.point(&scratch.spaces, surface.local, surface.n);
                            frame.transmission(world, &at)
                        }
                    };
                    seen = select3(m, three!(c => seen[c] * factor[c]), seen);
                }
            }
            seen
        },
    )
}

/// Shadow rays that nothing opaque has stopped yet.
struct Open<'r, L: Lane> {
    mask: L::Mask,
    rays: &'r ShadowRays<'r, L>,
    /// What stopped the last of those that were stopped.
    blocker: Option<u32>,
}

impl<L: Lane> Open<'_, L> {
    /// Tests surfaces until nothing is open, and puts transparent ones aside.
    #[inline(always)]
    fn test_here(&mut self, world: &World, ids: &[u32], transparent: &mut Vec<u32>, recorder: &mut Recorder) {
        for &k in ids {
            if self.rays.left_for_good(world, k, self.mask) || self.rays.pass_by(world, k, self.mask) {
                continue;
            }
            match world.constant_transmission(k) {
                Some([0.0, 0.0, 0.0]) => self.test(world, k, recorder),
                Some([1.0, 1.0, 1.0]) => {}
                _ => transparent.push(k),
            }
            if !self.mask.any() {
                return;
            }
        }
    }

    /// Tests opaque surface `k`.
    #[inline(always)]
    fn test(&mut self, world: &World, k: u32, recorder: &mut Recorder) {
        let blocked = if self.rays.touched.contains(&k) {
            let met = self.rays.met(world, k);
            met.crossings[..met.n].iter().fold(L::Mask::splat(false), |any, c| any | c.2)
        } else {
            let mut met = Blocked { distance: self.rays.distance, blocked: L::Mask::splat(false) };
            self.rays.crossings(world, k, &mut met);
            met.blocked
        };
        if (self.mask & blocked).any() {
            self.blocker = Some(k);
            if recorder.is_on() {
                recorder.shaded(k);
            }
        }
        self.mask = self.mask & !blocked;
    }

    /// Goes through the tree the better way.
    #[inline(always)]
    fn through_tree(&mut self, world: &World, scratch: &mut Shadow, recorder: &mut Recorder) {
        let Shadow { transparent, ways, deep, .. } = scratch;
        let before = self.mask;
        ways[*deep as usize].take::<L>(
            #[inline(always)]
            |together, most| {
                let found = self.mask;
                self.mask = before;
                let cost = match together {
                    true => self.together(world, transparent, recorder, most),
                    false => self.one_by_one(world, transparent, recorder),
                };
                if cost > most {
                    self.mask = found;
                }
                cost
            },
        );
        // Each of the rays may have put the same aside.
        transparent.sort_unstable();
        transparent.dedup();
    }

    /// All rays at once.
    #[inline(always)]
    fn together(&mut self, world: &World, transparent: &mut Vec<u32>, recorder: &mut Recorder, most: u32) -> u32 {
        L::vectorize(
            #[inline(always)]
            || {
                let (rays, reach) = (self.rays, self.reach());
                world.bvh.traverse_within(
                    most,
                    (rays.o, rays.l),
                    reach,
                    #[inline(always)]
                    |k| world.cost_of_test(k, L::WIDTH),
                    #[inline(always)]
                    |k| {
                        self.test_here(world, &[k], transparent, recorder);
                        self.reach()
                    },
                )
            },
        )
    }

    /// How far each ray still has to be followed.
    #[inline(always)]
    fn reach(&self) -> L {
        L::select(self.mask, self.rays.distance, -L::one())
    }

    /// One ray after another.
    #[inline(always)]
    fn one_by_one(&mut self, world: &World, transparent: &mut Vec<u32>, recorder: &mut Recorder) -> u32 {
        L::vectorize(
            #[inline(always)]
            || {
                let (o, l) = (each3!(self.rays.o, x => stored(x)), each3!(self.rays.l, x => stored(x)));
                let (source, part, outward) =
                    (stored(self.rays.source), stored(self.rays.part), stored(self.rays.outward));
                let distance = stored(self.rays.distance);
                let beams = world.bvh.rays::<L>(self.rays.o, self.rays.l);
                let mut bits = self.mask.bits();
                let (mut rest, mut cost) = (bits, 0);
                while rest != 0 {
                    let i = rest.trailing_zeros() as usize % PADDING;
                    rest &= rest - 1;
                    let one = |lanes: &[L::Elem; PADDING]| L::One::splat(lanes[i].to_f64());
                    let rays = ShadowRays::<L::One> {
                        source: one(&source),
                        part: one(&part),
                        outward: one(&outward),
                        o: each3!(&o, x => one(x)),
                        l: each3!(&l, x => one(x)),
                        distance: one(&distance),
                        light: self.rays.light,
                        touched: self.rays.touched,
                    };
                    let open = Open { mask: Mask::splat(true), rays: &rays, blocker: None };
                    let mut ray = InTree::<L> { world, open, wide: None, transparent, recorder };
                    cost += world.bvh.walk_alone::<L>(&beams, i, distance[i].to_f64(), &mut ray);
                    if !ray.open.mask.any() {
                        bits &= !(1 << i);
                        self.blocker = ray.open.blocker;
                    }
                }
                self.mask = L::Mask::from_bits(bits);
                cost
            },
        )
    }
}

/// A shadow ray on its way through the tree.
struct InTree<'a, L: Lane> {
    world: &'a World,
    open: Open<'a, L::One>,
    /// The same in every lane: one ray against many triangles. Not before it meets some.
    wide: Option<ShadowRays<'a, L>>,
    transparent: &'a mut Vec<u32>,
    recorder: &'a mut Recorder,
}

impl<L: Lane> Leaves for InTree<'_, L> {
    #[inline(always)]
    fn test(&mut self, ids: &[u32]) -> f64 {
        match self.world.mesh_of(ids) {
            Some(mesh) if L::WIDTH > 1 && self.stops_light(ids) => {
                for ids in ids.chunks(L::WIDTH) {
                    self.test_triangles(mesh, ids);
                }
            }
            _ => self.open.test_here(self.world, ids, self.transparent, self.recorder),
        }
        if self.open.mask.any() { least(self.open.rays.distance) } else { -1.0 }
    }
    #[inline(always)]
    fn cost(&self, ids: &[u32]) -> u32 {
        match ids {
            [id] => self.world.cost_of_test(*id, 1),
            _ => TEST * ids.len().div_ceil(L::WIDTH) as u32,
        }
    }
}

impl<L: Lane> InTree<'_, L> {
    /// Whether nothing but a crossing is asked of triangles of one mesh.
    #[inline(always)]
    fn stops_light(&self, ids: &[u32]) -> bool {
        let opaque = self.world.constant_transmission(ids[0]) == Some([0.0; 3]);
        opaque && self.open.rays.touched.is_empty()
    }

    #[inline(always)]
    fn test_triangles(&mut self, mesh: &Mesh, ids: &[u32]) {
        if self.wide.is_none() {
            let ray = self.open.rays;
            self.wide = Some(ShadowRays {
                source: spread::<L>(ray.source),
                part: spread::<L>(ray.part),
                outward: spread::<L>(ray.outward),
                o: each3!(ray.o, x => spread::<L>(x)),
                l: each3!(ray.l, x => spread::<L>(x)),
                distance: spread::<L>(ray.distance),
                light: ray.light,
                touched: ray.touched,
            });
        }
        let Some(rays) = &self.wide else { return };
        let mut met = Blocked { distance: rays.distance, blocked: L::Mask::splat(false) };
        mesh.crossings_of_one(ids, (rays.o, rays.l), (rays.source, rays.part, rays.outward), &mut met);
        let blocked = met.blocked.bits();
        if blocked != 0 {
            self.open.mask = Mask::splat(false);
            self.open.blocker = ids.get(blocked.trailing_zeros() as usize).copied();
            if let (Some(id), true) = (self.open.blocker, self.recorder.is_on()) {
                self.recorder.shaded(id);
            }
        }
    }
}
