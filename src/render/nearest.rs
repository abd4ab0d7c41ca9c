//! What each ray of a batch meets first.

use super::batch::{HitColumns, NONE, PADDING, RayBatch, load3};
use super::bvh::{Leaves, TEST};
use super::candidates::Candidates;
use super::closest::Nearest;
use super::ray::Own;
use super::run::place;
use super::shape::{Mesh, Visit};
use super::span::{least, spread, stored};
use super::sweep::sweep;
use super::way::Way;
use super::world::World;
use crate::math::real::each3;
use crate::math::{Elem, Lane, Mask, Real};

/// Finds the nearest crossing in front of each ray's origin. `AT_EYE` says that all origins are exactly 0.
#[inline(always)]
pub fn nearest<L: Lane, const AT_EYE: bool>(
    world: &World,
    candidates: &Candidates,
    rays: &RayBatch<L::Elem>,
    hits: &mut HitColumns<L::Elem>,
    way: &mut Way,
) {
    let by_tree_alone = candidates.tree && candidates.ids.is_empty();
    if !by_tree_alone {
        for g in (0..rays.len).step_by(L::WIDTH) {
            Nearest::<L>::none().store(hits, place(g));
        }
    }
    for &k in &candidates.ids {
        if !sweep::<L, AT_EYE>(world, k, rays, hits) {
            test_each::<L, AT_EYE>(world, k, rays, hits);
        }
    }
    if !candidates.tree {
        return;
    }
    for g in (0..rays.len).step_by(L::WIDTH) {
        let mut best = if by_tree_alone { Nearest::none() } else { Nearest::<L>::load(hits, g) };
        best.through_tree(world, &Start::of::<AT_EYE>(rays, g), way);
        best.store(hits, g);
    }
}

/// Tests surface `k` against every ray of a batch, a register at a time.
#[inline(always)]
fn test_each<L: Lane, const AT_EYE: bool>(
    world: &World,
    k: u32,
    rays: &RayBatch<L::Elem>,
    hits: &mut HitColumns<L::Elem>,
) {
    for g in (0..rays.len).step_by(L::WIDTH) {
        let mut best = Nearest::<L>::load(hits, g);
        best.test_all(world, &[k], &Start::of::<AT_EYE>(rays, g));
        best.store(hits, g);
    }
}

/// Rays and where they start.
struct Start<R: Real> {
    o: [R; 3],
    d: [R; 3],
    /// The primitive, or [`NONE`].
    primitive: R,
    part: R,
    /// 1 where they leave it to the outside.
    outward: R,
    /// Lanes that hold a ray.
    live: R::Mask,
}

impl<L: Lane> Start<L> {
    /// The rays of a batch from number `g` on.
    #[inline(always)]
    fn of<const AT_EYE: bool>(rays: &RayBatch<L::Elem>, g: usize) -> Start<L> {
        let d = load3::<L>(&rays.d, g);
        if AT_EYE {
            let live = Mask::splat(true);
            return Start {
                o: [L::zero(); 3],
                d,
                primitive: L::splat(NONE),
                part: L::zero(),
                outward: L::zero(),
                live,
            };
        }
        Start {
            o: load3::<L>(&rays.o, g),
            d,
            primitive: L::load(&rays.source[g..]),
            part: L::load(&rays.source_part[g..]),
            outward: L::load(&rays.outward[g..]),
            live: L::Mask::first((rays.len - g).min(L::WIDTH)),
        }
    }
}

impl<L: Lane> Nearest<L> {
    /// Tests surface `k`.
    #[inline(always)]
    fn test(&mut self, world: &World, k: u32, ray: ([L; 3], [L; 3]), own: Option<Own<L>>) {
        self.current = L::splat(k as f64);
        world.crossings::<L, false>(k, ray, own, self);
    }

    /// Tests surfaces, in a function of its own: kernels are large.
    #[inline(always)]
    fn test_all(&mut self, world: &World, ids: &[u32], start: &Start<L>) {
        L::vectorize(
            #[inline(always)]
            || self.test_here(world, ids, start),
        );
    }

    #[inline(always)]
    fn test_here(&mut self, world: &World, ids: &[u32], start: &Start<L>) {
        let outward = L::one().same(start.outward);
        for &k in ids {
            let here = start.primitive.same(L::splat(k as f64));
            let leaves = here & outward;
            // Mostly none does, and the primitive needn't be looked at.
            if leaves.any() && world.primitive(k).kind.is_left_for_good() && !(start.live & !leaves).any() {
                continue;
            }
            let own = Own::of(here, start.part, outward);
            self.test(world, k, (start.o, start.d), own);
        }
    }

    /// Goes through the tree the better way.
    #[inline(always)]
    fn through_tree(&mut self, world: &World, start: &Start<L>, way: &mut Way) {
        let before = *self;
        way.take::<L>(
            #[inline(always)]
            |together, most| {
                let found = *self;
                *self = before;
                let cost = match together {
                    true => self.together(world, start, most),
                    false => self.one_by_one(world, start),
                };
                if cost > most {
                    *self = found;
                }
                cost
            },
        );
    }

    /// All rays at once.
    #[inline(always)]
    fn together(&mut self, world: &World, start: &Start<L>, most: u32) -> u32 {
        L::vectorize(
            #[inline(always)]
            || {
                let t_max = L::select(start.live, self.t, -L::one());
                world.bvh.traverse_within(
                    most,
                    (start.o, start.d),
                    t_max,
                    #[inline(always)]
                    |k| world.cost_of_test(k, L::WIDTH),
                    #[inline(always)]
                    |k| {
                        self.test_all(world, &[k], start);
                        L::select(start.live, self.t, -L::one())
                    },
                )
            },
        )
    }

    /// One ray after another.
    #[inline(always)]
    fn one_by_one(&mut self, world: &World, start: &Start<L>) -> u32 {
        L::vectorize(
            #[inline(always)]
            || {
                let (o, d) = (each3!(start.o, x => stored(x)), each3!(start.d, x => stored(x)));
                let from = [stored(start.primitive), stored(start.part), stored(start.outward)];
                let (mut t, mut id, mut part) = (stored(self.t), stored(self.id), stored(self.part));
                let rays = world.bvh.rays::<L>(start.o, start.d);
                let (mut rest, mut cost) = (start.live.bits(), 0);
                while rest != 0 {
                    let i = rest.trailing_zeros() as usize % PADDING;
                    rest &= rest - 1;
                    let one = |lanes: &[L::Elem; PADDING]| L::One::splat(lanes[i].to_f64());
                    let start = Start::<L::One> {
                        o: each3!(&o, x => one(x)),
                        d: each3!(&d, x => one(x)),
                        primitive: one(&from[0]),
                        part: one(&from[1]),
                        outward: one(&from[2]),
                        live: Mask::splat(true),
                    };
                    let best = Nearest { t: one(&t), id: one(&id), part: one(&part), current: L::One::zero() };
                    let mut ray = InTree::<L> { world, start, best, wide: None };
                    cost += world.bvh.walk_alone::<L>(&rays, i, t[i].to_f64(), &mut ray);
                    ray.best.t.store(&mut t[i..]);
                    ray.best.id.store(&mut id[i..]);
                    ray.best.part.store(&mut part[i..]);
                }
                (self.t, self.id, self.part) = (L::load(&t), L::load(&id), L::load(&part));
                cost
            },
        )
    }
}

/// A ray on its way through the tree.
struct InTree<'w, L: Lane> {
    world: &'w World,
    start: Start<L::One>,
    best: Nearest<L::One>,
    /// The same in every lane: one ray against many triangles. Not before it meets some.
    wide: Option<Start<L>>,
}

impl<L: Lane> Leaves for InTree<'_, L> {
    #[inline(always)]
    fn test(&mut self, ids: &[u32]) -> f64 {
        match self.world.mesh_of(ids) {
            Some(mesh) if L::WIDTH > 1 => {
                for ids in ids.chunks(L::WIDTH) {
                    self.test_triangles(mesh, ids);
                }
            }
            _ => self.best.test_here(self.world, ids, &self.start),
        }
        least(self.best.t)
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
    #[inline(always)]
    fn test_triangles(&mut self, mesh: &Mesh, ids: &[u32]) {
        if self.wide.is_none() {
            let ray = &self.start;
            self.wide = Some(Start {
                o: each3!(ray.o, x => spread::<L>(x)),
                d: each3!(ray.d, x => spread::<L>(x)),
                primitive: spread::<L>(ray.primitive),
                part: spread::<L>(ray.part),
                outward: spread::<L>(ray.outward),
                live: Mask::splat(true),
            });
        }
        let Some(ray) = &self.wide else { return };
        let mut met = Met { t: L::zero(), valid: L::Mask::splat(false) };
        mesh.crossings_of_one(ids, (ray.o, ray.d), (ray.primitive, ray.part, ray.outward), &mut met);
        let mut rest = (met.valid & L::zero().lt(met.t) & met.t.le(L::splat(least(self.best.t)))).bits();
        let t = stored(met.t);
        while rest != 0 {
            let i = rest.trailing_zeros() as usize % PADDING;
            rest &= rest - 1;
            if let Some(&id) = ids.get(i) {
                self.best.current = L::One::splat(id as f64);
                self.best.crossing(L::One::splat(t[i].to_f64()), L::One::zero(), Mask::splat(true));
            }
        }
    }
}

/// What a ray meets of triangles: each lane of its own.
struct Met<R: Real> {
    t: R,
    valid: R::Mask,
}

impl<R: Real> Visit<R> for Met<R> {
    #[inline(always)]
    fn crossing(&mut self, t: R, _part: R, valid: R::Mask) {
        (self.t, self.valid) = (t, valid);
    }
}
