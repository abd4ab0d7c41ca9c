//! A tree that goes on living from one world to the next: what is gone is taken out, what is new is built into a tree of its own
//! and grafted on. All that is unchanged keeps its tree, which is copied, not built.
//!
//! The picture doesn't depend on the tree's shape, only its time does: so when too much was grafted, the tree is built anew.

use super::bounds::Bounds;
use super::bvh::node::{Box4, Child, Node};
use super::bvh::{Bvh, Company, Item};
use std::sync::atomic::AtomicBool;

/// Most grafts, one upon the other: each makes the tree deeper by one.
pub const MOST_GRAFTS: usize = 16;

/// A tree of which a quarter was changed is worth building anew: what is grafted overlaps the rest.
const MOST_CHANGED: usize = 4;

impl Bvh {
    /// The tree of the next world. `renumbered` has the new number of every primitive of this one, `u32::MAX` for those that
    /// are gone; `added` are the new ones. `None` where it is better built anew.
    pub fn grafted(&self, renumbered: &[u32], added: Vec<(u32, Bounds)>) -> Option<Bvh> {
        let is_gone = |id: &u32| renumbered.get(*id as usize) == Some(&u32::MAX);
        let all =
            || self.nodes.iter().flat_map(Node::children).filter(|c| c.1.is_leaf()).flat_map(|c| self.ids_of(c.1));
        let (gone, count) = (all().filter(|id| is_gone(id)).count(), self.len());
        let changed = self.changed + gone + added.len();
        if changed * MOST_CHANGED > count || (self.grafts >= MOST_GRAFTS && !added.is_empty()) {
            return None;
        }
        let mut tree = Bvh { changed, grafts: self.grafts, fit: self.fit, bounds: self.bounds, ..Bvh::default() };
        if added.is_empty() {
            self.copy_kept(0, renumbered, &mut tree);
            return Some(tree);
        }
        tree.grafts += 1;
        tree.nodes.push(Node::empty());
        let kept = self.copy_kept(0, renumbered, &mut tree)?;
        tree.nodes[0].set(0, kept, Child::node(1));
        let bounds = added.iter().fold(Bounds::EMPTY, |b, l| b.union(l.1));
        let item = |(id, b): &(u32, Bounds)| Item::new(*id, self.fit.shrink(b), Company::Alone);
        let graft = Bvh::build_in(self.fit, bounds, added.iter().map(item).collect(), &AtomicBool::new(false))?;
        let (second, ids) = (tree.nodes.len(), tree.ids.len());
        tree.nodes[0].set(1, graft.nodes.first()?.around(), Child::node(second));
        tree.nodes.extend(graft.nodes);
        tree.nodes[second..].iter_mut().for_each(|n| n.renumber(second, ids));
        tree.ids.extend(graft.ids);
        tree.bounds = tree.bounds.union(graft.bounds);
        Some(tree)
    }

    /// Appends the part of this tree below node `at` to `to`, without what is gone; `None` where nothing is left of it.
    fn copy_kept(&self, at: usize, renumbered: &[u32], to: &mut Bvh) -> Option<Box4> {
        let node = self.nodes.get(at)?;
        let (place, mut left) = (to.nodes.len(), 0);
        to.nodes.push(Node::empty());
        for (slot, child) in node.children() {
            let (kept, bounds) = if child.is_swarm() {
                let number = |id: u32| renumbered.get(id as usize).copied().unwrap_or(u32::MAX);
                let is_kept = |(k, id): (usize, &u32)| ((number(*id) != u32::MAX) as u32) << k;
                let kept: u32 = self.ids_of(child).iter().enumerate().map(is_kept).sum();
                let Some(swarm) = self.swarms.get(child.first()).filter(|_| kept != 0) else { continue };
                to.swarms.push(swarm.renumbered(kept, number));
                (Child::swarm(to.swarms.len() - 1, kept.count_ones() as usize), node.box_of(slot))
            } else if child.is_leaf() {
                let first = to.ids.len();
                let renumbered = self.ids_of(child).iter().filter_map(|id| renumbered.get(*id as usize));
                to.ids.extend(renumbered.filter(|id| **id != u32::MAX));
                let count = to.ids.len() - first;
                if count == 0 {
                    continue;
                }
                (Child::leaf(first, count), node.box_of(slot))
            } else {
                let next = to.nodes.len();
                let Some(bounds) = self.copy_kept(child.at(), renumbered, to) else { continue };
                (Child::node(next), bounds)
            };
            to.nodes[place].set(left, bounds, kept);
            left += 1;
        }
        if left == 0 {
            to.nodes.truncate(place);
            return None;
        }
        Some(to.nodes[place].around())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::hash::KeyedHash;

    fn random(i: u64, k: u64) -> f64 {
        KeyedHash::new().with(i).with(k).unit()
    }

    fn boxed(id: u32, seed: u64) -> (u32, Bounds) {
        (id, Bounds::around([0, 1, 2].map(|k| random(seed, k) * 100.0), [1.0; 3]))
    }

    /// Leaves hold their primitives, each of which is there once, and boxes all that lies below them: a search through them
    /// finds what a plain one does.
    fn check(tree: &Bvh, expected: &mut [(u32, Bounds)]) {
        let mut leaves: Vec<(u32, Bounds)> = tree.leaves().collect();
        leaves.sort_by_key(|l| l.0);
        expected.sort_by_key(|l| l.0);
        assert!(leaves.iter().map(|l| l.0).eq(expected.iter().map(|l| l.0)));
        assert!(leaves.iter().zip(&*expected).all(|(leaf, own)| leaf.1.union(own.1) == leaf.1));
        for k in 0..50 {
            let region = Bounds::around([0, 1, 2].map(|c| random(k, 90 + c) * 100.0), [15.0; 3]);
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
            let met: Vec<u32> = expected.iter().filter(|l| l.1.overlaps(&region)).map(|l| l.0).collect();
            assert_eq!(found, met);
        }
    }

    #[test]
    fn a_grafted_tree_holds_what_a_new_one_would() {
        let mut expected: Vec<(u32, Bounds)> = (0..300).map(|i| boxed(i, i as u64)).collect();
        let mut tree = Bvh::build(expected.clone());
        let (mut grafted, mut next_seed) = (0, 1000);
        for step in 0..60u64 {
            // Some go, some come, and the numbers of all move.
            let n = expected.len();
            let gone = |id: u32| random(step, 500 + id as u64) < 0.01 * (step % 4) as f64;
            let mut kept: Vec<u32> = (0..n as u32).filter(|&id| !gone(id)).collect();
            kept.sort_by_key(|&id| KeyedHash::new().with(step).with(id as u64).bits());
            let mut renumbered = vec![u32::MAX; n];
            kept.iter().zip(0..).for_each(|(&old, new)| renumbered[old as usize] = new);
            let come = (step % 3) as u32 * 2;
            let added: Vec<_> = (0..come).map(|k| boxed(kept.len() as u32 + k, next_seed + k as u64)).collect();
            next_seed += come as u64;
            expected = expected
                .iter()
                .filter(|l| renumbered[l.0 as usize] != u32::MAX)
                .map(|l| (renumbered[l.0 as usize], l.1))
                .chain(added.iter().copied())
                .collect();
            tree = match tree.grafted(&renumbered, added) {
                Some(tree) => {
                    grafted += 1;
                    tree
                }
                None => Bvh::build(expected.clone()),
            };
            check(&tree, &mut expected);
        }
        assert!((40..60).contains(&grafted), "{grafted}: often, but not for ever");
    }

    #[test]
    fn of_nothing_and_to_nothing() {
        let three: Vec<_> = (0..30).map(|i| boxed(i, i as u64)).collect();
        assert!(Bvh::default().grafted(&[], three.clone()).is_none());
        let tree = Bvh::build(three);
        assert!(tree.grafted(&[u32::MAX; 30], Vec::new()).is_none(), "better built anew");
    }
}
