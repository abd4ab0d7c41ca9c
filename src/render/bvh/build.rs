//! Builds the tree: top-down, by the surface area heuristic over binned centres (Wald, "On fast construction of SAH-based
//! bounding volume hierarchies", 2007), each node split in two until it has eight parts (Wald, Benthin, Boulos, "Getting rid
//! of packets", 2008). Large parts are built side by side. What is done depends on the boxes alone, never on the threads:
//! the same primitives give the same tree.

use super::Bvh;
use super::node::{Box4, Child, Fit, Node, WIDE};
use super::split::{Company, Item, Part, halve, split};
use super::swarm::Swarm;
use super::walk::MOST_LEVELS;
use crate::render::bounds::Bounds;
use crate::render::graft::MOST_GRAFTS;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Below this level parts are halved by count, whatever the heuristic says, which bounds the depth: 2^32 items halved three
/// times a level are single ones after 11 more. Sixteen levels are left for grafts.
const FREE_LEVELS: usize = MOST_LEVELS - 11 - MOST_GRAFTS;
/// Boxes or items of this number are work worth another thread's while.
const SHARED: usize = 4096;

impl Bvh {
    /// Builds the tree over (primitive, box) pairs, one primitive a leaf.
    pub fn build(leaves: Vec<(u32, Bounds)>) -> Bvh {
        Bvh::build_unless(leaves, |_| Company::Alone, &AtomicBool::new(false)).unwrap_or_default()
    }

    /// Builds the tree with up to eight primitives a leaf where all of them are of one `company`; the boxes of balls are cubes around
    /// them. `None` where `cancel` is set meanwhile.
    pub fn build_unless(
        leaves: Vec<(u32, Bounds)>,
        company: impl Fn(u32) -> Company + Sync,
        cancel: &AtomicBool,
    ) -> Option<Bvh> {
        Bvh::build_with_balls((0, |_| None), leaves, company, cancel)
    }

    /// As [`build_unless`](Bvh::build_unless), over `leaves` and those of the first `count` primitives of which `ball` says that they
    /// are balls, and what their boxes are: so there are never boxes of all of them at once.
    pub fn build_with_balls(
        (count, ball): (u32, impl Fn(u32) -> Option<Bounds>),
        leaves: Vec<(u32, Bounds)>,
        company: impl Fn(u32) -> Company + Sync,
        cancel: &AtomicBool,
    ) -> Option<Bvh> {
        let around = |leaves: &[(u32, Bounds)]| leaves.iter().fold(Bounds::EMPTY, |b, l| b.union(l.1));
        let mut bounds = match leaves.len() < SHARED {
            true => around(&leaves),
            false => leaves.par_chunks(SHARED).map(around).reduce(|| Bounds::EMPTY, Bounds::union),
        };
        let mut balls = 0;
        for b in (0..count).filter_map(&ball) {
            (bounds, balls) = (bounds.union(b), balls + 1);
        }
        let fit = Fit::new(&bounds);
        let item = |(id, b): &(u32, Bounds)| Item::new(*id, fit.shrink(b), company(*id));
        let mut items: Vec<Item> = Vec::with_capacity(leaves.len() + balls);
        match leaves.len() < SHARED {
            true => items.extend(leaves.iter().map(item)),
            false => items.par_extend(leaves.par_iter().map(item)),
        };
        drop(leaves);
        let box_of = |id: u32| Some(Item::new(id, fit.shrink(&ball(id)?), Company::Balls));
        items.extend((0..count).filter_map(box_of));
        Bvh::build_in(fit, bounds, items, cancel)
    }

    /// Builds the tree in given units.
    pub(in crate::render) fn build_in(
        fit: Fit,
        bounds: Bounds,
        mut items: Vec<Item>,
        cancel: &AtomicBool,
    ) -> Option<Bvh> {
        if items.is_empty() {
            return Some(Bvh::default());
        }
        let nodes = nodes_over(&mut items, cancel);
        if cancel.load(Relaxed) {
            return None;
        }
        let mut tree = Bvh { nodes, fit, bounds, ..Bvh::default() };
        tree.fill_leaves(&items);
        Some(tree)
    }

    /// Gives the leaves, which are numbered by their places among `items`, what is in them.
    fn fill_leaves(&mut self, items: &[Item]) {
        let leaves = || self.nodes.iter().flat_map(Node::children).filter(|(_, child)| child.is_leaf());
        let (mut swarms, mut balls) = (0, 0);
        for (_, leaf) in leaves().filter(|(_, leaf)| leaf.is_swarm()) {
            (swarms, balls) = (swarms + 1, balls + leaf.count());
        }
        self.swarms.reserve_exact(swarms);
        self.ids.reserve_exact(items.len() - balls);
        for node in &mut self.nodes {
            for slot in 0..WIDE {
                let leaf = node.child(slot);
                if !leaf.is_leaf() || !node.is_used(slot) {
                    continue;
                }
                let items = &items[leaf.range()];
                if leaf.is_swarm() {
                    node.refer(slot, Child::swarm(self.swarms.len(), leaf.count()));
                    self.swarms.push(Swarm::of(items));
                } else {
                    node.refer(slot, Child::leaf(self.ids.len(), leaf.count()));
                    self.ids.extend(items.iter().map(Item::id));
                }
            }
        }
    }
}

/// Builds the nodes over `items`, which it brings into the order of the leaves; the first node is the root. Up to eight
/// items of one company make a leaf, and any other by itself. Leaves of balls are swarms, numbered as yet by their first
/// item. Ends early, with anything, where `cancel` is set.
fn nodes_over(items: &mut [Item], cancel: &AtomicBool) -> Vec<Node> {
    let whole = Part::over(items, 0);
    let of = |company: Company| items.iter().filter(|i| i.is_of(company)).count();
    // A few balls among other things would be alone in their leaves anyway.
    let swarms = 2 * of(Company::Balls) > items.len();
    let most = if swarms || of(Company::Triangles) > 0 { Child::MOST } else { 1 };
    Builder { swarms, most, cancel }.subtree(items, whole, 0)
}

struct Builder<'c> {
    /// Whether balls share leaves.
    swarms: bool,
    /// Most primitives of any leaf.
    most: usize,
    cancel: &'c AtomicBool,
}

impl Builder<'_> {
    /// The leaf that a part makes, if it makes one.
    fn leaf(&self, items: &[Item], part: &Part) -> Option<Child> {
        let all = |company: Company| items.iter().all(|i| i.is_of(company));
        match items.len() {
            1 => Some(Child::leaf(part.first, 1)),
            n if n > self.most => None,
            n if self.swarms && all(Company::Balls) => Some(Child::swarm(part.first, n)),
            n => all(Company::Triangles).then(|| Child::leaf(part.first, n)),
        }
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
        let below: Vec<(Option<Child>, Vec<Node>)> = jobs
            .into_par_iter()
            .map(|(items, part)| match self.leaf(items, &part) {
                Some(leaf) => (Some(leaf), Vec::new()),
                None => (None, self.subtree(items, part, level + 1)),
            })
            .collect();
        nodes.reserve_exact(below.iter().map(|(_, below)| below.len()).sum());
        for (slot, (part, (leaf, mut below))) in parts.into_iter().flatten().zip(below).enumerate() {
            let child = leaf.unwrap_or(Child::node(nodes.len()));
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
            if let Some(leaf) = self.leaf(own, &part) {
                nodes[at].set(slot, part.bounds, leaf);
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
            let (a, b) = if free { split(own, &part, self.most) } else { halve(own, &part) };
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
