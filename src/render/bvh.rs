//! The tree of boxes over all bounded primitives: finds what a ray, a tile or a shaft can meet without looking at the rest.
//!
//! Binary, built top-down by the surface area heuristic over binned centres (Wald, "On fast construction of SAH-based
//! bounding volume hierarchies", 2007). The same primitives give the same tree.

use super::bounds::{Bounds, larger};
use crate::math::real::{each3, three};
use crate::math::{Mask, Real};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// The tree.
#[derive(Clone, Debug, Default)]
pub struct Bvh {
    pub(super) nodes: Vec<BvhNode>,
    /// Primitives in the order of the leaves, with their boxes.
    pub(super) leaves: Vec<(u32, Bounds)>,
    /// Primitives that were taken out or grafted on since it was built.
    pub(super) changed: usize,
    /// How often something was grafted on.
    pub(super) grafts: usize,
}

/// A node of the tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct BvhNode {
    /// Around all below.
    pub(super) bounds: Bounds,
    /// Of a leaf: its first entry in `leaves`. Of an inner node: its second child; the first one follows directly.
    pub(super) first: u32,
    /// Entries of a leaf; 0 for an inner node.
    pub(super) count: u32,
}

/// Bins a split is chosen from: more change the tree little (Wald 2007, section 3).
const BINS: usize = 16;
/// Largest leaf: testing four boxes in a row costs about as much as two more levels.
const LEAF: usize = 4;
/// Depth after which a range is halved by count, whatever the heuristic says: bounds the depth by this plus log₂ n ≤ 32.
const FREE_DEPTH: u32 = 48;
/// Room for every node that can wait during a traversal: the depth of a tree, and of what is grafted on it.
const STACK: usize = (FREE_DEPTH + 33) as usize + super::graft::MOST_GRAFTS;

impl Bvh {
    /// Builds the tree over (primitive, box) pairs.
    pub fn build(leaves: Vec<(u32, Bounds)>) -> Bvh {
        Bvh::build_unless(leaves, &AtomicBool::new(false))
    }

    /// The same; where `cancel` is set meanwhile it ends soon, with a tree that is right but slow.
    pub fn build_unless(mut leaves: Vec<(u32, Bounds)>, cancel: &AtomicBool) -> Bvh {
        let mut nodes = Vec::with_capacity(leaves.len());
        if !leaves.is_empty() {
            subdivide(&mut nodes, &mut leaves, (0, 0), &mut Vec::new(), cancel);
        }
        Bvh { nodes, leaves, ..Bvh::default() }
    }

    /// Primitives and their boxes, in the order of the leaves.
    pub fn leaves(&self) -> &[(u32, Bounds)] {
        &self.leaves
    }

    /// Number of primitives.
    pub fn len(&self) -> usize {
        self.leaves.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.leaves.is_empty()
    }

    /// Bytes it occupies.
    pub fn memory_bytes(&self) -> usize {
        self.nodes.len() * size_of::<BvhNode>() + self.leaves.len() * size_of::<(u32, Bounds)>()
    }

    /// Calls `found` for every primitive whose box, and all boxes around it, satisfy `keep`; stops when `found` says false.
    #[inline(always)]
    pub fn gather(&self, mut keep: impl FnMut(&Bounds) -> bool, mut found: impl FnMut(u32) -> bool) {
        if self.nodes.is_empty() {
            return;
        }
        let (mut stack, mut depth) = ([0u32; STACK], 1);
        while depth > 0 {
            depth -= 1;
            let at = stack[depth];
            let node = &self.nodes[at as usize];
            if !keep(&node.bounds) {
                continue;
            }
            if node.count == 0 {
                stack[depth] = node.first;
                stack[depth + 1] = at + 1;
                depth += 2;
                continue;
            }
            for (id, bounds) in &self.leaves[node.first as usize..(node.first + node.count) as usize] {
                if (node.count == 1 || keep(bounds)) && !found(*id) {
                    return;
                }
            }
        }
    }

    /// Calls `test(primitive)` for every primitive whose box a ray meets before its `t_max`, nearer boxes first. `test` gives
    /// the lanes' new `t_max`; a lane is finished when that is not positive.
    #[inline(always)]
    pub fn traverse<R: Real>(&self, o: [R; 3], d: [R; 3], mut t_max: R, mut test: impl FnMut(u32) -> R) {
        if self.nodes.is_empty() {
            return;
        }
        let inverse = each3!(d, x => R::one() / x);
        // How far a turned surface may seem off by what its frame makes of an origin this far out: 16 roundings, as many as
        // boxes are wider by for their own distance.
        let reach = R::splat(16.0 * R::UNIT_ROUNDOFF) * o[0].abs().max(o[1].abs()).max(o[2].abs());
        let o = [each3!(o, x => x + reach), each3!(o, x => x - reach)];
        let first_sign = three!(i => !d[i].lt(R::zero()).any());
        let (mut stack, mut depth) = ([0u32; STACK], 1);
        while depth > 0 {
            depth -= 1;
            let at = stack[depth];
            let node = &self.nodes[at as usize];
            if !meets(&node.bounds, o, inverse, t_max).any() {
                continue;
            }
            if node.count == 0 {
                // The child on the side that the rays come from is visited first.
                let (a, b) = (&self.nodes[at as usize + 1].bounds, &self.nodes[node.first as usize].bounds);
                let axis = widest_gap(a, b);
                let a_first = (a.lo[axis] <= b.lo[axis]) == first_sign[axis];
                let (near, far) = if a_first { (at + 1, node.first) } else { (node.first, at + 1) };
                stack[depth] = far;
                stack[depth + 1] = near;
                depth += 2;
                continue;
            }
            for (id, bounds) in &self.leaves[node.first as usize..(node.first + node.count) as usize] {
                if node.count == 1 || meets(bounds, o, inverse, t_max).any() {
                    t_max = test(*id);
                }
            }
        }
    }
}

/// Whether rays meet a box at a t from 0 to `t_max`. Never misses by rounding: the far side is widened (Ize, "Robust BVH ray
/// traversal", JCGT 2(2), 2013), and so is `t_max`, or a box that begins at the very t of a hit would hide another one there;
/// a NaN (0·∞, a ray within a face) never wins a comparison. `o` is the origin for the lower faces and that for the upper.
#[inline(always)]
fn meets<R: Real>(b: &Bounds, o: [[R; 3]; 2], inverse: [R; 3], t_max: R) -> R::Mask {
    let widen = R::splat(1.0 + 8.0 * R::UNIT_ROUNDOFF);
    let (mut near, mut far) = (R::zero(), t_max * widen);
    for i in 0..3 {
        let (mut lo, mut hi) = (b.lo[i], b.hi[i]);
        if R::UNIT_ROUNDOFF > f64::EPSILON {
            // Box, centre and size were rounded on the way into a shorter format.
            let reach = 16.0 * R::UNIT_ROUNDOFF * larger(lo.abs(), hi.abs());
            (lo, hi) = (lo - reach, hi + reach);
        }
        let (lo, hi) = (R::splat(lo), R::splat(hi));
        let (t0, t1) = ((lo - o[0][i]) * inverse[i], (hi - o[1][i]) * inverse[i]);
        let swap = inverse[i].lt(R::zero());
        let (enter, leave) = (R::select(swap, t1, t0), R::select(swap, t0, t1));
        near = enter.max(near);
        far = (leave * widen).min(far);
    }
    near.le(far)
}

/// The axis along which two boxes lie furthest apart.
fn widest_gap(a: &Bounds, b: &Bounds) -> usize {
    let gap = |i: usize| ((a.lo[i] - b.lo[i]) + (a.hi[i] - b.hi[i])).abs();
    (1..3).fold(0, |best, i| if gap(i) > gap(best) { i } else { best })
}

/// `spare` is room that all steps share.
fn subdivide(
    nodes: &mut Vec<BvhNode>,
    leaves: &mut [(u32, Bounds)],
    (first, depth): (u32, u32),
    spare: &mut Vec<(u32, Bounds)>,
    cancel: &AtomicBool,
) {
    let bounds = leaves.iter().fold(Bounds::EMPTY, |b, l| b.union(l.1));
    let at = nodes.len();
    nodes.push(BvhNode { bounds, first, count: leaves.len() as u32 });
    if cancel.load(Relaxed) {
        return;
    }
    let split = match best_split(leaves, &bounds, depth, spare) {
        Some(split) => split,
        None if leaves.len() > LEAF => halve(leaves),
        None => return,
    };
    let (left, right) = leaves.split_at_mut(split);
    subdivide(nodes, left, (first, depth + 1), spare, cancel);
    nodes[at].first = nodes.len() as u32;
    nodes[at].count = 0;
    subdivide(nodes, right, (first + split as u32, depth + 1), spare, cancel);
}

/// Parts the leaves by the cheapest of the binned planes; `None` where a leaf is cheaper or no plane parts them.
fn best_split(
    leaves: &mut [(u32, Bounds)],
    bounds: &Bounds,
    depth: u32,
    spare: &mut Vec<(u32, Bounds)>,
) -> Option<usize> {
    if leaves.len() < 2 || depth >= FREE_DEPTH {
        return None;
    }
    let centres = leaves.iter().fold(Bounds::EMPTY, |b, l| b.with(l.1.centre()));
    let mut best: Option<(f64, usize, usize)> = None;
    for axis in 0..3 {
        let (lo, extent) = (centres.lo[axis], centres.hi[axis] - centres.lo[axis]);
        if !(extent > 0.0 && extent.is_finite()) {
            continue;
        }
        let mut bins = [(Bounds::EMPTY, 0usize); BINS];
        let mut used = 0u32; // one bit a bin: most nodes are near the leaves and fill but a few
        for (_, b) in leaves.iter() {
            let k = bin_of(b.centre()[axis], lo, extent);
            bins[k] = (bins[k].0.union(*b), bins[k].1 + 1);
            used |= 1 << k;
        }
        // What is to the right of each bin that is used but the last.
        let mut right_cost = [0.0; BINS];
        let (mut box_, mut n, mut rest) = (Bounds::EMPTY, 0, used);
        while rest.count_ones() > 1 {
            let k = rest.ilog2() as usize;
            rest ^= 1 << k;
            (box_, n) = (box_.union(bins[k].0), n + bins[k].1);
            right_cost[rest.ilog2() as usize] = box_.half_area() * n as f64;
        }
        // A plane after each of them; one within a gap parts as the first one there.
        let (mut box_, mut n, mut rest) = (Bounds::EMPTY, 0, used);
        while rest.count_ones() > 1 {
            let k = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            (box_, n) = (box_.union(bins[k].0), n + bins[k].1);
            let cost = box_.half_area() * n as f64 + right_cost[k];
            if best.is_none_or(|b| cost < b.0) && cost.is_finite() {
                best = Some((cost, axis, k + 1));
            }
        }
    }
    let (cost, axis, plane) = best?;
    // A step down costs about as much as one box test.
    if leaves.len() <= LEAF && cost + bounds.half_area() >= bounds.half_area() * leaves.len() as f64 {
        return None;
    }
    let (lo, extent) = (centres.lo[axis], centres.hi[axis] - centres.lo[axis]);
    let below = |l: &(u32, Bounds)| bin_of(l.1.centre()[axis], lo, extent) < plane;
    Some(part(leaves, spare, below))
}

/// Brings what is `below` to the front, both parts in their order: the same tree every time. Gives how many that are.
fn part(leaves: &mut [(u32, Bounds)], spare: &mut Vec<(u32, Bounds)>, below: impl Fn(&(u32, Bounds)) -> bool) -> usize {
    spare.clear();
    let mut front = 0;
    for i in 0..leaves.len() {
        let leaf = leaves[i];
        if below(&leaf) {
            leaves[front] = leaf;
            front += 1;
        } else {
            spare.push(leaf);
        }
    }
    leaves[front..].copy_from_slice(spare);
    front
}

fn bin_of(x: f64, lo: f64, extent: f64) -> usize {
    (((x - lo) / extent * BINS as f64) as usize).min(BINS - 1)
}

/// Parts the leaves at the median along the longest axis of their centres.
fn halve(leaves: &mut [(u32, Bounds)]) -> usize {
    let centres = leaves.iter().fold(Bounds::EMPTY, |b, l| b.with(l.1.centre()));
    let extent = |i: usize| centres.hi[i] - centres.lo[i];
    let axis = (1..3).fold(0, |best, i| if extent(i) > extent(best) { i } else { best });
    leaves.sort_by(|a, b| a.1.centre()[axis].total_cmp(&b.1.centre()[axis]));
    leaves.len() / 2
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::hash::KeyedHash;

    fn boxes(n: u64) -> Vec<(u32, Bounds)> {
        let random = |i: u64, k: u64| KeyedHash::new().with(i).with(k).unit();
        (0..n)
            .map(|i| {
                let c = [0, 1, 2].map(|k| random(i, k) * 100.0);
                (i as u32, Bounds::around(c, [1.0 + 2.0 * random(i, 4); 3]))
            })
            .collect()
    }

    #[test]
    fn finds_what_a_ray_meets_as_brute_force_does() {
        let all = boxes(500);
        let tree = Bvh::build(all.clone());
        let mut met = 0;
        for i in 0..2_000u64 {
            let random = |k: u64| KeyedHash::new().with(77).with(i).with(k).unit();
            let o = [0, 1, 2].map(|k| random(k) * 100.0);
            let d = [3, 4, 5].map(|k| if random(k + 9) < 0.1 { 0.0 } else { random(k) - 0.5 });
            let inverse = d.map(|x: f64| 1.0 / x);
            let mut expected: Vec<u32> =
                all.iter().filter(|(_, b)| meets(b, [o, o], inverse, f64::INFINITY).any()).map(|x| x.0).collect();
            let mut found = Vec::new();
            tree.traverse(o, d, f64::INFINITY, |id| {
                found.push(id);
                f64::INFINITY
            });
            found.retain(|id| expected.contains(id));
            found.sort();
            expected.sort();
            met += expected.len();
            assert_eq!(found, expected);
        }
        assert!(met > 300);
    }

    #[test]
    fn coincident_boxes_end_in_a_tree_too() {
        let b = Bounds::around([1.0; 3], [0.5; 3]);
        let tree = Bvh::build((0..1000).map(|i| (i, b)).collect());
        let mut n = 0;
        tree.gather(
            |_| true,
            |_| {
                n += 1;
                true
            },
        );
        assert_eq!(n, 1000);
    }
}
