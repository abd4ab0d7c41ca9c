//! What each ray of a batch meets first.

use super::batch::{HitColumns, NONE, PADDING, RayBatch, load3};
use super::bvh::{Leaves, Spread};
use super::candidates::Candidates;
use super::ray::Own;
use super::shape::{Mesh, Visit};
use super::span::{least, stored};
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
    for g in (0..rays.len).step_by(L::WIDTH) {
        let d = load3::<L>(&rays.d, g);
        let mut best = Nearest { t: L::splat(f64::INFINITY), id: L::splat(NONE), part: L::zero(), current: L::zero() };
        if AT_EYE {
            for &k in &candidates.ids {
                best.test::<true>(world, k, ([L::zero(); 3], d), None);
            }
            if candidates.tree {
                best.through_tree(world, &Start::at_eye(d), way);
            }
        } else {
            let start = Start {
                o: load3::<L>(&rays.o, g),
                d,
                primitive: L::load(&rays.source[g..]),
                part: L::load(&rays.source_part[g..]),
                outward: L::load(&rays.outward[g..]),
                live: L::Mask::first((rays.len - g).min(L::WIDTH)),
            };
            if !candidates.ids.is_empty() {
                best.test_all(world, &candidates.ids, &start);
            }
            if candidates.tree {
                best.through_tree(world, &start, way);
            }
        }
        best.t.store(&mut hits.t[g..]);
        best.id.store(&mut hits.id[g..]);
        best.part.store(&mut hits.part[g..]);
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

impl<R: Real> Start<R> {
    #[inline(always)]
    fn at_eye(d: [R; 3]) -> Start<R> {
        Start {
            o: [R::zero(); 3],
            d,
            primitive: R::splat(NONE),
            part: R::zero(),
            outward: R::zero(),
            live: Mask::splat(true),
        }
    }
}

/// Keeps the nearest crossing; of two at the same t, that of the primitive with the lower number.
#[derive(Clone, Copy)]
struct Nearest<R> {
    t: R,
    id: R,
    part: R,
    current: R,
}

impl<L: Lane> Nearest<L> {
    /// Tests surface `k`.
    #[inline(always)]
    fn test<const AT_EYE: bool>(&mut self, world: &World, k: u32, ray: ([L; 3], [L; 3]), own: Option<Own<L>>) {
        self.current = L::splat(k as f64);
        world.crossings::<L, AT_EYE>(k, ray, own, self);
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
            let left = here & outward & L::Mask::splat(world.primitive(k).kind.is_left_for_good());
            if !(start.live & !left).any() {
                continue;
            }
            let own = Own::of(here, start.part, outward);
            self.test::<false>(world, k, (start.o, start.d), own);
        }
    }

    /// Goes through the tree the better way.
    #[inline(always)]
    fn through_tree(&mut self, world: &World, start: &Start<L>, way: &mut Way) {
        let before = *self;
        way.take::<L>(
            #[inline(always)]
            |together| {
                *self = before;
                if together { self.together(world, start) } else { self.one_by_one(world, start) }
            },
        );
    }

    /// All rays at once.
    #[inline(always)]
    fn together(&mut self, world: &World, start: &Start<L>) {
        L::vectorize(
            #[inline(always)]
            || {
                let t_max = L::select(start.live, self.t, -L::one());
                world.bvh.traverse(
                    start.o,
                    start.d,
                    t_max,
                    #[inline(always)]
                    |k| {
                        self.test_all(world, &[k], start);
                        L::select(start.live, self.t, -L::one())
                    },
                );
            },
        );
    }

    /// One ray after another.
    #[inline(always)]
    fn one_by_one(&mut self, world: &World, start: &Start<L>) {
        L::vectorize(
            #[inline(always)]
            || {
                let (o, d) = (each3!(start.o, x => stored(x)), each3!(start.d, x => stored(x)));
                let from = [stored(start.primitive), stored(start.part), stored(start.outward)];
                let (mut t, mut id, mut part) = (stored(self.t), stored(self.id), stored(self.part));
                let mut rest = start.live.bits();
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
                    let spread = Spread::of_one(each3!(&o, x => x[i].to_f64()), each3!(&d, x => x[i].to_f64()));
                    let wide = Start::<L> {
                        o: each3!(&o, x => L::splat(x[i].to_f64())),
                        d: each3!(&d, x => L::splat(x[i].to_f64())),
                        primitive: L::splat(from[0][i].to_f64()),
                        part: L::splat(from[1][i].to_f64()),
                        outward: L::splat(from[2][i].to_f64()),
                        live: Mask::splat(true),
                    };
                    let mut ray = InTree::<L> { world, start, best, wide };
                    world.bvh.walk::<L::Boxes>(&spread, L::UNIT_ROUNDOFF, t[i].to_f64(), &mut ray);
                    ray.best.t.store(&mut t[i..]);
                    ray.best.id.store(&mut id[i..]);
                    ray.best.part.store(&mut part[i..]);
                }
                (self.t, self.id, self.part) = (L::load(&t), L::load(&id), L::load(&part));
            },
        );
    }
}

/// A ray on its way through the tree.
struct InTree<'w, L: Lane> {
    world: &'w World,
    start: Start<L::One>,
    best: Nearest<L::One>,
    /// The same in every lane: one ray against many triangles.
    wide: Start<L>,
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
}

impl<L: Lane> InTree<'_, L> {
    #[inline(always)]
    fn test_triangles(&mut self, mesh: &Mesh, ids: &[u32]) {
        let ray = &self.wide;
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

impl<R: Real> Visit<R> for Nearest<R> {
    #[inline(always)]
    fn needs_further(&self, t: R, valid: R::Mask) -> R::Mask {
        valid & !R::zero().lt(t)
    }

    #[inline(always)]
    fn crossing(&mut self, t: R, part: R, valid: R::Mask) {
        let nearer = t.lt(self.t) | (t.same(self.t) & self.current.lt(self.id));
        let m = valid & R::zero().lt(t) & nearer;
        self.t = R::select(m, t, self.t);
        self.id = R::select(m, self.current, self.id);
        self.part = R::select(m, part, self.part);
    }
}
