//! The way of rays through the tree, nearest box first.

use super::Bvh;
use super::beam::Beam;
use super::node::{Box4, Child};
use super::swarm::Line;
use crate::math::Lane;
use std::mem::MaybeUninit;

/// The same three numbers in every lane.
#[inline(always)]
fn splat3<W: Lane>(v: [f32; 3]) -> [W; 3] {
    [W::splat(v[0] as f64), W::splat(v[1] as f64), W::splat(v[2] as f64)]
}

/// The numbers of a [`Beam`] that nodes are tested by, in registers.
pub struct Registers<W> {
    pub(super) near_row: [usize; 3],
    pub(super) far_row: [usize; 3],
    pub(super) near_from: [W; 3],
    pub(super) near_inverse: [W; 3],
    pub(super) far_from: [W; 3],
    pub(super) far_inverse: [W; 3],
    /// The ray, where it is only one.
    pub(super) line: Option<Line<W>>,
}

impl<W: Lane<Elem = f32>> Registers<W> {
    #[inline(always)]
    fn new(beam: &Beam, has_swarms: bool) -> Self {
        // No `bool::then`: its closure may be compiled without the lanes' instructions.
        let mut line = None;
        if has_swarms && beam.is_one {
            line = Some(Line::between([beam.near_from, beam.far_from], [beam.near_inverse, beam.far_inverse]));
        }
        Registers {
            line,
            near_row: beam.near_row,
            far_row: beam.far_row,
            near_from: splat3(beam.near_from),
            near_inverse: splat3(beam.near_inverse),
            far_from: splat3(beam.far_from),
            far_inverse: splat3(beam.far_inverse),
        }
    }
}

/// Tests what is in the leaves of a tree. A trait and not a closure, so that it is surely inlined into what is compiled for
/// lanes.
pub trait Leaves {
    /// Tests primitives, one to eight of them; gives the new `t_max`. The search ends when that isn't positive.
    fn test(&mut self, ids: &[u32]) -> f64;
    /// What the search may cost before it is given up, in node's tests.
    #[inline(always)]
    fn most(&self) -> u32 {
        u32::MAX
    }
    /// What testing these costs, in node's tests.
    #[inline(always)]
    fn cost(&self, ids: &[u32]) -> u32 {
        TEST * ids.len() as u32
    }
    /// What asking whether a ray may meet boxes costs, one for each bit.
    #[inline(always)]
    fn cost_of_boxes(&self, boxes: u32) -> u32 {
        let _ = boxes;
        0
    }
    /// Whether a ray may meet the box, in the tree's units, for those who know better than their beam.
    #[inline(always)]
    fn may_meet(&self, b: impl FnOnce() -> Box4) -> bool {
        let _ = b;
        true
    }
}

/// Nodes and leaves that wait, nearest last.
struct Stack {
    /// Only the first `len` hold anything: to clear three kilobytes would take longer than many a ray's whole search.
    entries: [MaybeUninit<u64>; ROOM],
    len: usize,
}

impl Stack {
    #[inline(always)]
    fn new() -> Stack {
        Stack { entries: [const { MaybeUninit::uninit() }; ROOM], len: 0 }
    }

    /// Puts `entry` among those from `base` on, in its place.
    #[inline(always)]
    fn insert(&mut self, entry: u64, base: usize) {
        let mut at = self.len;
        if at >= ROOM {
            return; // no tree is that deep
        }
        // SAFETY: `at` is at most the old `len` and below `ROOM`; all entries below the old `len` were written by this function,
        // which alone makes `len` grow, by one, after it wrote all up to there.
        unsafe {
            while at > base {
                let below = self.entries.get_unchecked(at - 1).assume_init();
                if below >= entry {
                    break;
                }
                self.entries.get_unchecked_mut(at).write(below);
                at -= 1;
            }
            self.entries.get_unchecked_mut(at).write(entry);
        }
        self.len += 1;
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<u64> {
        self.len = self.len.checked_sub(1)?;
        // SAFETY: `len` was larger than this index, so `insert` wrote it.
        Some(unsafe { self.entries.get_unchecked(self.len).assume_init() })
    }
}

/// What a kernel costs, in node's tests: measured over the examples, roughly.
pub const TEST: u32 = 3;
/// What it costs to send a beam on its way, in node's tests.
const SETUP: u32 = 5;

/// Most levels of a tree, grafts included; each leaves up to seven waiting.
pub const MOST_LEVELS: usize = 56;
pub const ROOM: usize = MOST_LEVELS * (super::node::WIDE - 1) + 1;

/// Entry distance and child as one number that sorts by distance: of numbers that aren't negative the bits do.
#[inline(always)]
fn entry(near: f32, child: Child) -> u64 {
    (near.to_bits() as u64) << 32 | child.0 as u64
}

/// Tests every leaf whose box the rays of `beam` meet before `t_max`, nearer ones first. Gives what that cost: about as many node's
/// tests.
#[inline(always)]
pub fn walk<W: Lane<Elem = f32>>(
    Bvh { nodes, ids, swarms, .. }: &Bvh,
    beam: &Beam,
    t_max: f64,
    leaves: &mut impl Leaves,
) -> u32 {
    let mut cost = SETUP;
    let mut stack = Stack::new();
    let mut child = Child::node(0);
    let registers = Registers::<W>::new(beam, !swarms.is_empty());
    let mut t_max = beam.reach(t_max);
    loop {
        if child.is_leaf() {
            // All primitives of a plain leaf are tested at once, and of a swarm those that are met, one by one: from one place of the
            // code, for kernels are large.
            let swarm = if child.is_swarm() { swarms.get(child.first()) } else { None };
            let (mut met, ids) = match swarm {
                Some(swarm) => {
                    let met = swarm.meet(&registers, t_max) & ((2 << (child.count() - 1)) - 1);
                    cost = cost.saturating_add(1 + leaves.cost_of_boxes(met));
                    (met, &swarm.ids()[..])
                }
                None => (1, ids.get(child.range()).unwrap_or_default()),
            };
            while met != 0 {
                let k = met.trailing_zeros() as usize & 7;
                met &= met - 1;
                let mut tested = ids;
                if let Some(swarm) = swarm {
                    if !leaves.may_meet(
                        #[inline(always)]
                        || swarm.box_of(k),
                    ) {
                        continue;
                    }
                    tested = &ids[k..=k];
                }
                cost = cost.saturating_add(leaves.cost(tested));
                if cost > leaves.most() {
                    return cost;
                }
                let t = leaves.test(tested);
                t_max = beam.reach(t);
                if !(t > 0.0) {
                    break;
                }
            }
        } else if let Some(node) = nodes.get(child.at()) {
            let (near, children, mut met) = node.meet(&registers, t_max);
            cost = cost.saturating_add(1 + leaves.cost_of_boxes(met));
            if cost > leaves.most() {
                return cost;
            }
            let base = stack.len;
            let mut nearest = u64::MAX;
            while met != 0 {
                let k = met.trailing_zeros() as usize & 7;
                met &= met - 1;
                if !leaves.may_meet(
                    #[inline(always)]
                    || node.box_of(k),
                ) {
                    continue;
                }
                let other = entry(near[k], Child(children[k].to_bits()));
                let (a, b) = if other < nearest { (other, nearest) } else { (nearest, other) };
                nearest = a;
                if b != u64::MAX {
                    stack.insert(b, base);
                }
            }
            if nearest != u64::MAX {
                child = Child(nearest as u32);
                continue;
            }
        }
        loop {
            let Some(waiting) = stack.pop() else { return cost };
            if f32::from_bits((waiting >> 32) as u32) <= t_max {
                child = Child(waiting as u32);
                break;
            }
        }
    }
}
