//! The tree of boxes over all bounded primitives: finds what a ray, a tile or a shaft can meet without looking at the rest.
//!
//! Eight children a node, boxes of `f32` rounded outwards (`node`), built by the surface area heuristic (`build`), and gone
//! through nearest box first (`walk`). The same primitives give the same tree, and no picture depends on it: a box is
//! passed over only where every ray surely misses what is in it.

mod build;
pub(super) mod node;
mod split;
mod walk;

use super::bounds::Bounds;
use super::slabs::Slabs;
use crate::math::{Lane, Mask};
use node::{Box4, Child, Fit, Node};
use rayon::prelude::*;
use split::Item;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use walk::Beam;
pub use walk::{Leaves, Spread, farthest};

/// The tree.
#[derive(Clone, Debug)]
pub struct Bvh {
    /// The first one is the root.
    pub(super) nodes: Vec<Node>,
    /// Primitives in the order of the leaves.
    pub(super) ids: Vec<u32>,
    pub(super) fit: Fit,
    /// Around all.
    pub(super) bounds: Bounds,
    /// Primitives that were taken out or grafted on since it was built.
    pub(super) changed: usize,
    /// How often something was grafted on.
    pub(super) grafts: usize,
}

/// A tree smaller than this is built before another thread is awake.
const SHARED: usize = 4096;

impl Default for Bvh {
    fn default() -> Bvh {
        Bvh { nodes: Vec::new(), ids: Vec::new(), fit: Fit::default(), bounds: Bounds::EMPTY, changed: 0, grafts: 0 }
    }
}

impl Bvh {
    /// Builds the tree over (primitive, box) pairs, one primitive a leaf.
    pub fn build(leaves: Vec<(u32, Bounds)>) -> Bvh {
        Bvh::build_unless(leaves, u32::MAX, &AtomicBool::new(false)).unwrap_or_default()
    }

    /// Builds the tree with up to eight primitives a leaf where all their numbers are `batched_from` or more: those are tested
    /// as fast as their box, as eight triangles are that go into one register. `None` where `cancel` is set meanwhile.
    pub fn build_unless(leaves: Vec<(u32, Bounds)>, batched_from: u32, cancel: &AtomicBool) -> Option<Bvh> {
        let around = |leaves: &[(u32, Bounds)]| leaves.iter().fold(Bounds::EMPTY, |b, l| b.union(l.1));
        let bounds = match leaves.len() < SHARED {
            true => around(&leaves),
            false => leaves.par_chunks(SHARED).map(around).reduce(|| Bounds::EMPTY, Bounds::union),
        };
        Bvh::build_in(Fit::new(&bounds), bounds, leaves, batched_from, cancel)
    }

    /// Builds the tree in given units.
    pub(super) fn build_in(
        fit: Fit,
        bounds: Bounds,
        leaves: Vec<(u32, Bounds)>,
        batched_from: u32,
        cancel: &AtomicBool,
    ) -> Option<Bvh> {
        if leaves.is_empty() {
            return Some(Bvh::default());
        }
        let item = |(id, b): &(u32, Bounds)| Item::new(*id, fit.shrink(b));
        let mut items: Vec<Item> = match leaves.len() < SHARED {
            true => leaves.iter().map(item).collect(),
            false => leaves.par_iter().map(item).collect(),
        };
        drop(leaves);
        let nodes = build::nodes_over(&mut items, batched_from, cancel);
        let ids = items.iter().map(Item::id).collect();
        (!cancel.load(Relaxed)).then_some(Bvh { nodes, ids, fit, bounds, changed: 0, grafts: 0 })
    }

    /// Every primitive with a box that surely holds it: that of its leaf, in the order of the leaves.
    pub fn leaves(&self) -> impl Iterator<Item = (u32, Bounds)> {
        let slots = self.nodes.iter().flat_map(|n| n.children().map(move |(slot, child)| (n, slot, child)));
        slots.filter(|(.., child)| child.is_leaf()).flat_map(|(node, slot, child)| {
            let bounds = self.fit.grow(&node.box_of(slot));
            self.ids_of(child).iter().map(move |&id| (id, bounds))
        })
    }

    /// Number of primitives.
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }

    /// Bytes it occupies.
    pub fn memory_bytes(&self) -> usize {
        self.nodes.len() * size_of::<Node>() + self.ids.len() * size_of::<u32>()
    }

    #[inline(always)]
    pub(super) fn ids_of(&self, leaf: Child) -> &[u32] {
        self.ids.get(leaf.range()).unwrap_or_default()
    }

    /// Calls `found` for every primitive in whose leaf's box, and all boxes around it, `keep` sees something; stops when
    /// `found` says false. Gives whether it came to an end within `most` nodes.
    #[inline(always)]
    pub fn gather(
        &self,
        most: usize,
        mut keep: impl FnMut(&Bounds) -> bool,
        mut found: impl FnMut(u32) -> bool,
    ) -> bool {
        if self.nodes.is_empty() {
            return true;
        }
        let (mut stack, mut depth, mut left) = ([0u32; walk::ROOM], 1, most);
        while depth > 0 {
            if left == 0 {
                return false;
            }
            left -= 1;
            depth -= 1;
            let Some(node) = self.nodes.get(stack[depth] as usize) else { return true };
            for (slot, child) in node.children() {
                if !keep(&self.fit.grow(&node.box_of(slot))) {
                    continue;
                }
                if !child.is_leaf() {
                    if let Some(free) = stack.get_mut(depth) {
                        *free = child.at() as u32;
                        depth += 1;
                    }
                    continue;
                }
                for id in self.ids_of(child) {
                    if !found(*id) {
                        return true;
                    }
                }
            }
        }
        true
    }

    /// Calls `test(primitive)` once for every primitive whose leaf's box a ray meets before its `t_max`, nearer boxes first.
    /// `test` gives the lanes' new `t_max`; a lane is finished when that is not positive, and one that begins so has no ray.
    #[inline(always)]
    pub fn traverse<L: Lane>(&self, o: [L; 3], d: [L; 3], t_max: L, test: impl FnMut(u32) -> L) {
        let alive = L::zero().lt(t_max);
        if alive.any() {
            let spread = Spread::of(o, d, alive);
            let slabs = (L::WIDTH > 1 && !spread.is_narrow()).then(
                #[inline(always)]
                || Slabs::new(o, d),
            );
            let t = farthest(t_max, alive);
            let mut leaves = OneByOne { test, t_max, alive, slabs, fit: self.fit };
            self.walk::<L::Boxes>(&spread, L::UNIT_ROUNDOFF, t, &mut leaves);
        }
    }

    /// Has `leaves` test every leaf whose box one of the rays of `spread` meets before `t_max`, nearer boxes first. `u` is
    /// the unit roundoff of the kernels that it calls.
    #[inline(always)]
    pub fn walk<W: Lane<Elem = f32>>(&self, spread: &Spread, u: f64, t_max: f64, leaves: &mut impl Leaves) {
        if self.nodes.is_empty() {
            return;
        }
        if let Some(beam) = Beam::new(&self.fit, &self.bounds, spread, u) {
            walk::walk::<W>(&self.nodes, &self.ids, &beam, t_max, leaves);
        }
    }
}

/// Leaves whose primitives a function tests one by one.
struct OneByOne<L: Lane, F> {
    test: F,
    t_max: L,
    alive: L::Mask,
    /// Where rays run apart: each for itself.
    slabs: Option<Slabs<L>>,
    fit: Fit,
}

impl<L: Lane, F: FnMut(u32) -> L> Leaves for OneByOne<L, F> {
    #[inline(always)]
    fn test(&mut self, ids: &[u32]) -> f64 {
        for id in ids {
            self.t_max = (self.test)(*id);
        }
        farthest(self.t_max, self.alive)
    }
    #[inline(always)]
    fn may_meet(&self, b: impl FnOnce() -> Box4) -> bool {
        match &self.slabs {
            Some(slabs) => (slabs.meet(&self.fit.grow(&b()), self.t_max) & self.alive).any(),
            None => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::hash::KeyedHash;
    use crate::render::bounds::{larger, smaller};

    fn random(i: u64, k: u64) -> f64 {
        KeyedHash::new().with(i).with(k).unit()
    }

    /// Boxes of many sizes in a room of `size` that begins `away` from the origin; every fourth is flat, every fifth a copy.
    fn boxes(n: u64, size: f64, away: f64) -> Vec<(u32, Bounds)> {
        let one = |i: u64| {
            let i = if i % 5 == 4 { i - 1 } else { i };
            let c = [0, 1, 2].map(|k| away + size * random(i, k));
            let mut half = [0, 1, 2].map(|k| size * 0.05 * random(i, 4 + k) * random(i, 7));
            if i % 4 == 3 {
                half[(i / 4 % 3) as usize] = 0.0;
            }
            Bounds { lo: [0, 1, 2].map(|k| c[k] - half[k]), hi: [0, 1, 2].map(|k| c[k] + half[k]) }
        };
        (0..n).map(|i| (i as u32, one(i))).collect()
    }

    /// Where a ray enters a box, in plain arithmetic, if it surely meets it: not just by rounding.
    fn enters(b: &Bounds, o: [f64; 3], d: [f64; 3]) -> Option<f64> {
        let (mut near, mut far) = (0.0, f64::INFINITY);
        for i in 0..3 {
            let (t0, t1) = ((b.lo[i] - o[i]) / d[i], (b.hi[i] - o[i]) / d[i]);
            if t0.is_nan() || t1.is_nan() {
                continue; // along a face
            }
            (near, far) = (larger(near, smaller(t0, t1)), smaller(far, larger(t0, t1)));
        }
        (near <= far).then_some(near)
    }

    fn ray(i: u64, size: f64, away: f64) -> ([f64; 3], [f64; 3]) {
        let far = if i.is_multiple_of(3) { 1e4 } else { 1.0 };
        let o =
            [0, 1, 2].map(|k| if i.is_multiple_of(7) { 0.0 } else { away + far * size * (random(i, 20 + k) - 0.2) });
        let target = [0, 1, 2].map(|k| away + size * random(i, 30 + k));
        let mut d = [0, 1, 2].map(|k| target[k] - o[k]);
        if i % 4 == 1 {
            d[(i / 4 % 3) as usize] = if i % 8 == 1 { 0.0 } else { -0.0 };
        }
        (o, d)
    }

    #[test]
    fn a_search_for_the_nearest_box_finds_what_testing_all_finds() {
        let mut met = 0;
        for (power, away) in [(0, 0.0), (0, -0.5), (400, 0.0), (-400, -0.3), (0, 1e7), (-60, 1.0), (12, -1e12)] {
            let size = f64::from_bits(((1023 + power) as u64) << 52);
            let away = away * size;
            for n in [1, 2, 7, 60, 600, 5000] {
                let all = boxes(n, size, away);
                for batched_from in [u32::MAX, n as u32 / 2, 0] {
                    let tree = Bvh::build_unless(all.clone(), batched_from, &AtomicBool::new(false)).expect("built");
                    assert_eq!(tree.len(), all.len());
                    for i in 0..200 {
                        let (o, d) = ray(i + n, size, away);
                        let nearer = |best: Option<(f64, u32)>, (id, b): &(u32, Bounds)| match (best, enters(b, o, d)) {
                            (Some((t, k)), Some(new)) if new < t || (new == t && *id < k) => Some((new, *id)),
                            (None, Some(new)) => Some((new, *id)),
                            (best, _) => best,
                        };
                        let expected = all.iter().fold(None, nearer);
                        let mut found = None;
                        tree.traverse(o, d, f64::INFINITY, |id| {
                            found = nearer(found, &all[id as usize]);
                            found.map_or(f64::INFINITY, |f| f.0)
                        });
                        met += found.is_some() as u32;
                        assert_eq!(found, expected, "{n} boxes of 2^{power}, {away} away: ray {i}");
                    }
                }
            }
        }
        assert!(met > 5_000, "{met}");
    }

    #[test]
    fn every_primitive_is_found_once_and_only_near_what_it_is_asked_for() {
        let all = boxes(3000, 100.0, -50.0);
        let tree = Bvh::build(all.clone());
        let mut once: Vec<u32> = tree.leaves().map(|l| l.0).collect();
        once.sort();
        assert!(once.iter().copied().eq(0..3000));
        assert!(tree.leaves().all(|(id, b)| b.union(all[id as usize].1) == b));
        for k in 0..100 {
            let region = Bounds::around([0, 1, 2].map(|c| random(k, 90 + c) * 100.0 - 50.0), [4.0; 3]);
            let mut found = Vec::new();
            tree.gather(
                usize::MAX,
                |b| b.overlaps(&region),
                |id| {
                    found.push(id);
                    true
                },
            );
            found.sort();
            let expected: Vec<u32> = all.iter().filter(|l| l.1.overlaps(&region)).map(|l| l.0).collect();
            assert_eq!(found, expected, "rounding decides in none of these");
        }
    }

    #[test]
    fn the_tree_is_the_same_for_any_number_of_threads() {
        let all = boxes(30_000, 10.0, 0.0);
        let built = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            format!("{:?}", pool.install(|| Bvh::build_unless(all.clone(), 9_000, &AtomicBool::new(false))))
        };
        assert!(built(1) == built(2) && built(1) == built(5));
    }

    #[test]
    fn coincident_boxes_end_in_a_tree_too() {
        for b in [Bounds::around([1.0; 3], [0.5; 3]), Bounds { lo: [0.0; 3], hi: [0.0; 3] }] {
            let tree = Bvh::build((0..10_000).map(|i| (i, b)).collect());
            let mut n = 0;
            tree.traverse([0.0; 3], [1.0; 3], f64::INFINITY, |_| {
                n += 1;
                f64::INFINITY
            });
            assert_eq!((tree.leaves().count(), n), (10_000, 10_000));
        }
    }

    #[test]
    fn a_cancelled_build_gives_no_tree() {
        assert!(Bvh::build_unless(boxes(50_000, 1.0, 0.0), u32::MAX, &AtomicBool::new(true)).is_none());
    }
}
