//! A tree that goes on living from one world to the next: what is gone is taken out, what is new is built into a tree of its own
//! and grafted on. All that is unchanged keeps its tree, which is copied, not built.
//!
//! The picture doesn't depend on the tree's shape, only its time does: so when too much was grafted, the tree is built anew.

use super::bounds::Bounds;
use super::bvh::{Bvh, BvhNode};

/// Most grafts, one upon the other: each makes the tree deeper by one.
pub const MOST_GRAFTS: usize = 16;

/// A tree of which a quarter was changed is worth building anew: what is grafted overlaps the rest.
const MOST_CHANGED: usize = 4;

impl Bvh {
    /// The tree of the next world. `renumbered` has the new number of every primitive of this one, `u32::MAX` for those that
    /// are gone; `added` are the new ones. `None` where it is better built anew.
    pub fn grafted(&self, renumbered: &[u32], added: Vec<(u32, Bounds)>) -> Option<Bvh> {
        let gone = self.leaves.iter().filter(|l| renumbered.get(l.0 as usize) == Some(&u32::MAX)).count();
        let changed = self.changed + gone + added.len();
        if changed * MOST_CHANGED > self.leaves.len() || (self.grafts >= MOST_GRAFTS && !added.is_empty()) {
            return None;
        }
        let mut tree = Bvh { changed, grafts: self.grafts, ..Bvh::default() };
        if added.is_empty() {
            self.copy_kept(0, renumbered, &mut tree);
            return Some(tree);
        }
        tree.grafts += 1;
        let graft = Bvh::build(added);
        tree.nodes.push(BvhNode { bounds: Bounds::EMPTY, first: 0, count: 0 });
        self.copy_kept(0, renumbered, &mut tree)?;
        let second = tree.nodes.len();
        tree.append(graft);
        let bounds = tree.nodes[1].bounds.union(tree.nodes[second].bounds);
        tree.nodes[0] = BvhNode { bounds, first: second as u32, count: 0 };
        Some(tree)
    }

    /// Appends the part of this tree below node `at` to `to`, without what is gone; `None` where nothing is left of it.
    fn copy_kept(&self, at: u32, renumbered: &[u32], to: &mut Bvh) -> Option<Bounds> {
        let node = self.nodes.get(at as usize)?;
        let (place, first) = (to.nodes.len(), to.leaves.len() as u32);
        if node.count > 0 {
            let mut bounds = Bounds::EMPTY;
            for (id, b) in &self.leaves[node.first as usize..(node.first + node.count) as usize] {
                let id = renumbered[*id as usize];
                if id != u32::MAX {
                    to.leaves.push((id, *b));
                    bounds = bounds.union(*b);
                }
            }
            let count = to.leaves.len() as u32 - first;
            (count > 0).then(|| to.nodes.push(BvhNode { bounds, first, count }))?;
            return Some(bounds);
        }
        to.nodes.push(*node);
        let left = self.copy_kept(at + 1, renumbered, to);
        if left.is_none() {
            // The other child takes the place of this node.
            to.nodes.truncate(place);
            return self.copy_kept(node.first, renumbered, to);
        }
        let second = to.nodes.len() as u32;
        let right = self.copy_kept(node.first, renumbered, to);
        match (left, right) {
            (Some(a), Some(b)) => {
                to.nodes[place] = BvhNode { bounds: a.union(b), first: second, count: 0 };
                Some(a.union(b))
            }
            (left, _) => {
                // The first child, which follows it directly, takes its place: all of it moves up by one.
                to.nodes.remove(place);
                to.nodes[place..].iter_mut().filter(|n| n.count == 0).for_each(|n| n.first -= 1);
                left
            }
        }
    }

    fn append(&mut self, other: Bvh) {
        let (nodes, leaves) = (self.nodes.len() as u32, self.leaves.len() as u32);
        self.nodes.extend(other.nodes.into_iter().map(|n| {
            let offset = if n.count == 0 { nodes } else { leaves };
            BvhNode { first: n.first + offset, ..n }
        }));
        self.leaves.extend(other.leaves);
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

    /// Boxes hold what lies below them, every primitive is found once, and a ray's way finds what a plain search does.
    fn check(tree: &Bvh, expected: &mut [(u32, Bounds)]) {
        let mut leaves = tree.leaves.clone();
        leaves.sort_by_key(|l| l.0);
        expected.sort_by_key(|l| l.0);
        assert_eq!(leaves, expected);
        for k in 0..50 {
            let region = Bounds::around([0, 1, 2].map(|c| random(k, 90 + c) * 100.0), [15.0; 3]);
            let mut found = Vec::new();
            tree.gather(
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
