//! The tree of boxes over all bounded primitives: finds what a ray, a tile or a shaft can meet without looking at the rest.
//!
//! Eight children a node, boxes of `f32` rounded outwards (`node`), balls by the eight in a leaf (`swarm`); built by the surface
//! area heuristic (`build`), and gone through nearest box first (`walk`). The same primitives give the same tree, and no picture depends on it: a box is
//! passed over only where every ray surely misses what is in it.

mod beam;
mod build;
pub(super) mod node;
mod split;
mod swarm;
mod together;
mod walk;

use super::batch::PADDING;
use super::bounds::Bounds;
use super::slabs::Slabs;
use super::span::stored;
use crate::math::real::each3;
use crate::math::{Elem, Lane, Mask};
use beam::{Beam, Beams};
pub use beam::{Rays, Spread, farthest};
use node::{Child, Fit, Node};
pub use split::{Company, Item};
use swarm::Swarm;
use together::OneByOne;
pub use walk::{Leaves, TEST};

/// The tree.
#[derive(Clone, Debug)]
pub struct Bvh {
    /// The first one is the root.
    pub(super) nodes: Vec<Node>,
    /// Primitives in the order of the leaves, but for those in swarms.
    pub(super) ids: Vec<u32>,
    /// Leaves of balls.
    pub(super) swarms: Vec<Swarm>,
    pub(super) fit: Fit,
    /// Around all.
    pub(super) bounds: Bounds,
    /// Primitives that were taken out or grafted on since it was built.
    pub(super) changed: usize,
    /// How often something was grafted on.
    pub(super) grafts: usize,
}

impl Default for Bvh {
    fn default() -> Bvh {
        Bvh {
            nodes: Vec::new(),
            ids: Vec::new(),
            swarms: Vec::new(),
            fit: Fit::default(),
            bounds: Bounds::EMPTY,
            changed: 0,
            grafts: 0,
        }
    }
}

impl Bvh {
    /// Every primitive with a box that surely holds it: that of its leaf, in the order of the leaves.
    pub fn leaves(&self) -> impl Iterator<Item = (u32, Bounds)> {
        let slots = self.nodes.iter().flat_map(|n| n.children().map(move |(slot, child)| (n, slot, child)));
        slots.filter(|(.., child)| child.is_leaf()).flat_map(|(node, slot, child)| {
            let bounds = self.fit.grow(&node.box_of(slot));
            self.ids_of(child).iter().map(move |&id| (id, bounds))
        })
    }

    /// Whether balls share leaves.
    pub fn has_swarms(&self) -> bool {
        !self.swarms.is_empty()
    }

    /// Number of primitives.
    pub fn len(&self) -> usize {
        let leaves = self.nodes.iter().flat_map(Node::children).filter(|(_, child)| child.is_swarm());
        self.ids.len() + leaves.map(|(_, leaf)| leaf.count()).sum::<usize>()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Bytes it occupies.
    pub fn memory_bytes(&self) -> usize {
        self.nodes.len() * size_of::<Node>()
            + self.ids.len() * size_of::<u32>()
            + self.swarms.len() * size_of::<Swarm>()
    }

    #[inline(always)]
    pub(super) fn ids_of(&self, leaf: Child) -> &[u32] {
        match leaf.is_swarm() {
            true => self.swarms.get(leaf.first()).map_or(&[][..], |swarm| &swarm.ids()[..leaf.count()]),
            false => self.ids.get(leaf.range()).unwrap_or_default(),
        }
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
                let swarm = if child.is_swarm() { self.swarms.get(child.first()) } else { None };
                for (k, id) in self.ids_of(child).iter().enumerate() {
                    if let Some(swarm) = swarm
                        && !keep(&self.fit.grow(&swarm.box_of(k)))
                    {
                        continue;
                    }
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
        self.traverse_within(u32::MAX, (o, d), t_max, |_| TEST, test);
    }

    /// As [`traverse`](Bvh::traverse), but given up where it costs more than `most`. Gives what it cost, in node's tests; `cost` says
    /// that of `test`.
    #[inline(always)]
    pub fn traverse_within<L: Lane>(
        &self,
        most: u32,
        (o, d): ([L; 3], [L; 3]),
        t_max: L,
        cost: impl Fn(u32) -> u32,
        test: impl FnMut(u32) -> L,
    ) -> u32 {
        let alive = L::zero().lt(t_max);
        if alive.any() {
            let spread = Spread::of(o, d, alive);
            let slabs = (L::WIDTH > 1 && !spread.is_narrow()).then(
                #[inline(always)]
                || Slabs::new(o, d),
            );
            let t = farthest(t_max, alive);
            let mut leaves = OneByOne { most, cost, test, t_max, alive, slabs, fit: self.fit };
            return self.walk::<L::Boxes>(&spread, L::UNIT_ROUNDOFF, t, &mut leaves);
        }
        0
    }

    /// Has `leaves` test every leaf whose box one of the rays of `spread` meets before `t_max`, nearer boxes first. `u` is
    /// the unit roundoff of the kernels that it calls. Gives what it cost, in node's tests.
    #[inline(always)]
    pub fn walk<W: Lane<Elem = f32>>(&self, spread: &Spread, u: f64, t_max: f64, leaves: &mut impl Leaves) -> u32 {
        if self.nodes.is_empty() {
            return 0;
        }
        match Beam::new(&self.fit, &self.bounds, spread, u) {
            Some(beam) => walk::walk::<W>(self, &beam, t_max, leaves),
            None => 0,
        }
    }

    /// Rays that are to go through the tree one after another.
    #[inline(always)]
    pub fn rays<L: Lane>(&self, o: [L; 3], d: [L; 3]) -> Rays<L> {
        // Slack is for roundings of `f64`: what has others gets a beam ray by ray.
        match L::UNIT_ROUNDOFF > f64::EPSILON {
            true => Rays::Shorter(each3!(o, x => stored(x)), each3!(d, x => stored(x))),
            false => Rays::Ready(Beams::new(&self.fit, &self.bounds, (o, d))),
        }
    }

    /// [`walk`](Bvh::walk) of ray number `k`.
    #[inline(always)]
    pub fn walk_alone<L: Lane>(&self, rays: &Rays<L>, k: usize, t_max: f64, leaves: &mut impl Leaves) -> u32 {
        if self.nodes.is_empty() {
            return 0;
        }
        let beam = match rays {
            Rays::Ready(beams) => beams.get(&self.fit, k),
            Rays::Shorter(o, d) => {
                let of = |v: &[[L::Elem; PADDING]; 3]| each3!(v, x => x[k % PADDING].to_f64());
                Beam::new(&self.fit, &self.bounds, &Spread::of_one(of(o), of(d)), L::UNIT_ROUNDOFF)
            }
        };
        match beam {
            Some(beam) => walk::walk::<L::Boxes>(self, &beam, t_max, leaves),
            None => 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::hash::KeyedHash;
    use crate::render::bounds::{larger, smaller};
    use std::sync::atomic::AtomicBool;

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

    /// Those from number `first` on are triangles.
    fn triangles(first: u32) -> impl Fn(u32) -> Company + Sync {
        move |id| if id < first { Company::Alone } else { Company::Triangles }
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
                    let tree = Bvh::build_unless(all.clone(), triangles(batched_from), &AtomicBool::new(false));
                    let tree = tree.expect("built");
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
            format!("{:?}", pool.install(|| Bvh::build_unless(all.clone(), triangles(9_000), &AtomicBool::new(false))))
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
        assert!(Bvh::build_unless(boxes(50_000, 1.0, 0.0), triangles(0), &AtomicBool::new(true)).is_none());
    }
}
