//! Builds the tree: top-down, by the surface area heuristic over binned centres (Wald, "On fast construction of SAH-based
//! bounding volume hierarchies", 2007), each node split in two until it has eight parts (Wald, Benthin, Boulos, "Getting rid
//! of packets", 2008). Large parts are built side by side. What is done depends on the boxes alone, never on the threads:
//! the same primitives give the same tree.

use super::node::{Box4, Child, Node, WIDE};
use super::split::{Item, Part, halve, split};
use super::walk::MOST_LEVELS;
use crate::render::graft::MOST_GRAFTS;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Below this level parts are halved by count, whatever the heuristic says, which bounds the depth: 2^32 items halved three
/// times a level are single ones after 11 more. Sixteen levels are left for grafts.
const FREE_LEVELS: usize = MOST_LEVELS - 11 - MOST_GRAFTS;
/// A part of this many items is work worth another thread's while.
const SHARED: usize = 4096;

/// Builds the nodes over `items`, which it brings into the order of the leaves; the first node is the root. Up to eight
/// primitives whose numbers are `batched_from` or more make a leaf, and any other by itself. Ends early, with anything, where
/// `cancel` is set.
pub fn nodes_over(items: &mut [Item], batched_from: u32, cancel: &AtomicBool) -> Vec<Node> {
    let whole = Part::over(items, 0);
    let most = if items.iter().any(|i| i.id() >= batched_from) { Child::MOST } else { 1 };
    Builder { batched_from, most, cancel }.subtree(items, whole, 0)
}

struct Builder<'c> {
    batched_from: u32,
    /// Most primitives of any leaf.
    most: usize,
    cancel: &'c AtomicBool,
}

impl Builder<'_> {
    /// Whether items make a leaf.
    fn is_leaf(&self, items: &[Item]) -> bool {
        items.len() == 1 || (items.len() <= self.most && items.iter().all(|i| i.id() >= self.batched_from))
    }

    /// The nodes of a part; children are numbered from its own root.
    fn subtree(&self, items: &mut [Item], whole: Part, level: usize) -> Vec<Node> {
        let mut nodes = Vec::new();
        if whole.count < SHARED {
            self.add(&mut nodes, items, whole, level);
            return nodes;
        }
        let parts = self.parts(items, whole, level);
        nodes.push(Node::empty());
        let mut rest = items;
        let mut jobs = Vec::with_capacity(WIDE);
        for part in parts.iter().flatten() {
            let (own, after) = rest.split_at_mut(part.count);
            rest = after;
            jobs.push((own, *part));
        }
        let below: Vec<Vec<Node>> = jobs
            .into_par_iter()
            .map(|(items, part)| if self.is_leaf(items) { Vec::new() } else { self.subtree(items, part, level + 1) })
            .collect();
        nodes.reserve(below.iter().map(Vec::len).sum());
        for (slot, (part, mut below)) in parts.into_iter().flatten().zip(below).enumerate() {
            let child = if below.is_empty() { Child::leaf(part.first, part.count) } else { Child::node(nodes.len()) };
            nodes[0].set(slot, part.bounds, child);
            let offset = nodes.len();
            below.iter_mut().for_each(|n| n.renumber(offset, 0));
            nodes.append(&mut below);
        }
        nodes
    }

    /// Appends the nodes of a part to `nodes`.
    fn add(&self, nodes: &mut Vec<Node>, items: &mut [Item], whole: Part, level: usize) {
        let at = nodes.len();
        nodes.push(Node::empty());
        if self.cancel.load(Relaxed) {
            return;
        }
        let mut rest = &mut *items;
        for (slot, part) in self.parts(rest, whole, level).into_iter().flatten().enumerate() {
            let (own, after) = rest.split_at_mut(part.count);
            rest = after;
            if self.is_leaf(own) {
                nodes[at].set(slot, part.bounds, Child::leaf(part.first, part.count));
                continue;
            }
            let child = Child::node(nodes.len());
            nodes[at].set(slot, part.bounds, child);
            self.add(nodes, own, part, level + 1);
        }
    }

    /// Splits a part into up to eight, in the order of their items: always the one with the largest surface, which rays meet
    /// most often.
    fn parts(&self, items: &mut [Item], whole: Part, level: usize) -> [Option<Part>; WIDE] {
        let mut parts = [None; WIDE];
        if self.most == 1 && items.len() <= WIDE {
            // Each becomes a leaf, whichever way they are split.
            for ((part, item), first) in parts.iter_mut().zip(items.chunks(1)).zip(whole.first..) {
                *part = Some(Part::over(item, first));
            }
            return parts;
        }
        parts[0] = Some(whole);
        let free = level < FREE_LEVELS;
        // What comes to lie directly above the leaves is split evenly, into no more parts than it takes: half-empty nodes cost as
        // much memory as full ones.
        let full = WIDE * self.most;
        let enough = match whole.count {
            n if n > full && n <= WIDE * full => full,
            n if n > self.most => self.most,
            _ => 1,
        };
        let by_area = free && whole.count > WIDE * full;
        for n in 1..WIDE {
            let mut chosen: Option<(usize, Part)> = None;
            for (k, part) in parts.iter().enumerate().take(n) {
                let Some(part) = part.filter(|p| p.count > enough) else { continue };
                let larger = |than: Part| match by_area && part.area != than.area {
                    true => part.area > than.area,
                    false => part.count > than.count,
                };
                if chosen.is_none_or(|c| larger(c.1)) {
                    chosen = Some((k, part));
                }
            }
            let Some((k, part)) = chosen else { break };
            let first = part.first - whole.first;
            let own = &mut items[first..first + part.count];
            let (a, b) = if free { split(own, &part) } else { halve(own, &part) };
            parts[k + 1..=n].rotate_right(1);
            (parts[k], parts[k + 1]) = (Some(a), Some(b));
        }
        parts
    }
}

/// The box around items, and that around their centres, doubled.
pub fn around(items: &[Item]) -> (Box4, Box4) {
    items.iter().fold((Box4::EMPTY, Box4::EMPTY), |(b, c), item| {
        let centre = item.centre();
        (b.union(item.bounds), c.union(Box4 { lo: centre, hi: centre }))
    })
}
