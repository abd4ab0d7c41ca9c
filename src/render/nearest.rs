//! What each ray of a batch meets first.

use super::batch::{HitColumns, NONE, RayBatch, load3};
use super::candidates::Candidates;
use super::ray::Own;
use super::shape::Visit;
use super::world::World;
use crate::math::{Lane, Mask, Real};

/// Finds the nearest crossing in front of each ray's origin. `AT_EYE` says that all origins are exactly 0.
#[inline(always)]
pub fn nearest<L: Lane, const AT_EYE: bool>(
    world: &World,
    candidates: &Candidates,
    rays: &RayBatch<L::Elem>,
    hits: &mut HitColumns<L::Elem>,
) {
    for g in (0..rays.len).step_by(L::WIDTH) {
        let d = load3::<L>(&rays.d, g);
        let mut best = Nearest { t: L::splat(f64::INFINITY), id: L::splat(NONE), part: L::zero(), current: L::zero() };
        if AT_EYE {
            for &k in &candidates.ids {
                best.test::<true>(world, k, ([L::zero(); 3], d), None);
            }
            if candidates.tree {
                best.through_tree(world, &Start::at_eye(d));
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
                best.through_tree(world, &start);
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
            || {
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
            },
        );
    }

    #[inline(always)]
    fn through_tree(&mut self, world: &World, start: &Start<L>) {
        L::vectorize(
            #[inline(always)]
            || {
                world.bvh.traverse(
                    start.o,
                    start.d,
                    L::select(start.live, self.t, -L::one()),
                    #[inline(always)]
                    |k| {
                        self.test_all(world, &[k], start);
                        self.t
                    },
                );
            },
        );
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
