//! The tree of boxes over all bounded primitives: finds what a ray, a tile or a shaft can meet without looking at the rest.
//!
//! Eight children a node, boxes of `f32` rounded outwards ([`node`]), built by the surface area heuristic ([`build`]), and gone
//! through nearest box first ([`walk`]). The same primitives give the same tree, and no picture depends on it: a box is
//! passed over only where every ray surely misses what is in it.

mod build;
pub(super) mod node;
mod split;
mod walk;

use super::bounds::Bounds;
use crate::math::Lane;
use node::{Child, Fit, Node};
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
    /// `found` says false.
    #[inline(always)]
    pub fn gather(&self, mut keep: impl FnMut(&Bounds) -> bool, mut found: impl FnMut(u32) -> bool) {
        if self.nodes.is_empty() {
            return;
        }
        let (mut stack, mut depth) = ([0u32; walk::ROOM], 1);
        while depth > 0 {
            depth -= 1;
            let Some(node) = self.nodes.get(stack[depth] as usize) else { return };
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
                        return;
                    }
                }
            }
        }
    }

    /// Calls `test(primitive)` for every primitive whose leaf's box rays meet before their `t_max`, nearer boxes first.
    /// `test` gives the lanes' new `t_max`; a lane is finished when that is not positive.
    #[inline(always)]
    pub fn traverse<L: Lane>(&self, o: [L; 3], d: [L; 3], t_max: L, test: impl FnMut(u32) -> L) {
        let t = walk::farthest(t_max);
        if t > 0.0 {
            let spread = Spread::of(o, d, t_max);
            self.walk::<L::Boxes>(&spread, L::UNIT_ROUNDOFF, t, &mut OneByOne { test, t_max });
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
struct OneByOne<L, F> {
    test: F,
    t_max: L,
}

impl<L: Lane, F: FnMut(u32) -> L> Leaves for OneByOne<L, F> {
    #[inline(always)]
    fn test(&mut self, ids: &[u32]) -> f64 {
        for id in ids {
            self.t_max = (self.test)(*id);
        }
        walk::farthest(self.t_max)
    }
}
