//! A tree that goes on living from one world to the next: what is gone is taken out, what is new is built into a tree of its own
//! and grafted on. All that is unchanged keeps its tree, which is copied, not built.
//!
//! The picture doesn't depend on the tree's shape, only its time does: so when too much was grafted, the tree is built anew.

use super::bounds::Bounds;
use super::bvh::Bvh;
use super::bvh::node::{Box4, Child, Node};
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
        let gone = self.ids.iter().filter(|id| is_gone(id)).count();
        let changed = self.changed + gone + added.len();
        if changed * MOST_CHANGED > self.ids.len() || (self.grafts >= MOST_GRAFTS && !added.is_empty()) {
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
        let graft = Bvh::build_in(self.fit, bounds, added, u32::MAX, &AtomicBool::new(false))?;
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
            let (kept, bounds) = if child.is_leaf() {
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
