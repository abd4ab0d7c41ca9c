//! The tree of boxes over all bounded primitives: finds what a ray, a tile or a shaft can meet without looking at the rest.
//!
//! Eight children a node, boxes of `f32` rounded outwards ([`node`]), built by the surface area heuristic ([`build`]), and gone
//! through nearest box first ([`walk`]). The same primitives give the same tree, and no picture depends on it: a box is
//! passed over only where every ray surely misses what is in it.

mod build;
mod node;
mod split;
mod walk;

use super::bounds::Bounds;
use crate::math::{Elem, Lane};
use node::{Child, Fit, Node};
use rayon::prelude::*;
use split::Item;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use walk::{Beam, Spread, walk};

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

/// Most grafts, one upon the other: each makes the tree deeper by one.
pub const MOST_GRAFTS: usize = 16;

/// A tree smaller than this is built before another thread is awake.
const SHARED: usize = 4096;

impl Default for Bvh {
    fn default() -> Bvh {
        Bvh { nodes: Vec::new(), ids: Vec::new(), fit: Fit::default(), bounds: Bounds::EMPTY, changed: 0, grafts: 0 }
    }
}

impl Bvh {
    /// Builds the tree over (primitive, box) pairs.
    pub fn build(leaves: &[(u32, Bounds)]) -> Bvh {
        Bvh::build_unless(leaves, 1, &AtomicBool::new(false)).unwrap_or_default()
    }

    /// The same, with up to `most` primitives a leaf, at most eight: more than one is for primitives that are tested as fast
    /// as boxes are. `None` where `cancel` is set meanwhile.
    pub fn build_unless(leaves: &[(u32, Bounds)], most: usize, cancel: &AtomicBool) -> Option<Bvh> {
        if leaves.is_empty() {
            return Some(Bvh::default());
        }
        let both = |a: Bounds, b: Bounds| a.union(b);
        let bounds = match leaves.len() < SHARED {
            true => leaves.iter().fold(Bounds::EMPTY, |b, l| b.union(l.1)),
            false => leaves.par_chunks(SHARED).map(|c| c.iter().fold(Bounds::EMPTY, |b, l| b.union(l.1))).reduce(|| Bounds::EMPTY, both),
        };
        let fit = Fit::new(&bounds);
        let item = |(id, b): &(u32, Bounds)| Item::new(*id, fit.shrink(b));
        let mut items: Vec<Item> = match leaves.len() < SHARED {
            true => leaves.iter().map(item).collect(),
            false => leaves.par_iter().map(item).collect(),
        };
        let nodes = build::nodes_over(&mut items, most, cancel);
        let ids = items.iter().map(Item::id).collect();
        (!cancel.load(Relaxed)).then_some(Bvh { nodes, ids, fit, bounds, changed: 0, grafts: 0 })
    }

    /// Every primitive with a box that surely holds it: that of its leaf.
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

    /// Its shape, for people: nodes, slots in use, leaves, depth.
    pub fn summary(&self) -> String {
        let slots: usize = self.nodes.iter().map(|n| n.children().count()).sum();
        let leaves = self.nodes.iter().flat_map(Node::children).filter(|c| c.1.is_leaf()).count();
        format!("{} nodes, {slots} slots, {leaves} leaves", self.nodes.len())
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
    pub fn traverse<L: Lane>(&self, o: [L; 3], d: [L; 3], t_max: L, mut test: impl FnMut(u32) -> L) {
        let farthest = |t: L| {
            let mut all = [L::Elem::default(); 16];
            t.store(&mut all);
            all[..L::WIDTH].iter().fold(f64::NEG_INFINITY, |m, x| if x.to_f64() > m { x.to_f64() } else { m })
        };
        let mut spread = Spread { o: [[f64::INFINITY, f64::NEG_INFINITY]; 3], d: [[f64::INFINITY, f64::NEG_INFINITY]; 3] };
        let mut alive = [L::Elem::default(); 16];
        t_max.store(&mut alive);
        for i in 0..3 {
            for (v, range) in [(o[i], &mut spread.o[i]), (d[i], &mut spread.d[i])] {
                let mut all = [L::Elem::default(); 16];
                v.store(&mut all);
                for k in 0..L::WIDTH {
                    if alive[k].to_f64() > 0.0 {
                        let x = all[k].to_f64();
                        *range = [if x < range[0] { x } else { range[0] }, if x > range[1] { x } else { range[1] }];
                    }
                }
            }
        }
        let t = farthest(t_max);
        if !(t > 0.0) {
            return;
        }
        self.walk(&spread, L::UNIT_ROUNDOFF, t, |ids| {
            let mut t = t_max;
            for id in ids {
                t = test(*id);
            }
            farthest(t)
        });
    }

    /// Calls `test` for every leaf whose box one of the rays of `spread` meets before `t_max`, nearer boxes first, with the
    /// primitives in it, of which there are one to eight. `test` gives the new `t_max`; the search ends when that isn't
    /// positive. `u` is the unit roundoff of the kernels that `test` calls.
    #[inline(always)]
    pub fn walk(&self, spread: &Spread, u: f64, t_max: f64, mut test: impl FnMut(&[u32]) -> f64) {
        if self.nodes.is_empty() {
            return;
        }
        let Some(beam) = Beam::new(&self.fit, &self.bounds, spread, u) else { return };
        walk(&self.nodes, &beam, beam.reach(t_max), |leaf| beam.reach(test(self.ids_of(leaf))));
    }
}
