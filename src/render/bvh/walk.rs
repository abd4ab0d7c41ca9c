//! The way of rays through the tree.
//!
//! A [`Beam`] stands for one ray or for several that run alike: intervals of origins and of inverse directions, as two numbers
//! an axis, the one that makes the entry into a box earliest and the one that makes the exit latest. So a node is tested by
//! the same few instructions for one ray or sixteen, and all roundings are in the beam: a box is missed only if every
//! ray surely misses it.

use super::node::{Child, Fit, Node, power_below};
use crate::render::bounds::{Bounds, larger, smaller};

/// Rays in the tree's units.
#[derive(Clone, Copy, Debug)]
pub struct Beam {
    /// Rows of the faces that rays enter by, and leave by.
    pub(super) near_row: [usize; 3],
    pub(super) far_row: [usize; 3],
    /// What is subtracted from those faces, and what the difference is multiplied by.
    pub(super) near_from: [f32; 3],
    pub(super) near_inverse: [f32; 3],
    pub(super) far_from: [f32; 3],
    pub(super) far_inverse: [f32; 3],
    /// Where all rays enter the tree.
    start: f64,
    /// A t of the tree for one of the world.
    speed: f64,
    /// Roundings of t that two surfaces at the same place may differ by, relatively.
    tie: f64,
}

/// Origins and directions of rays: smallest and largest, by axis.
#[derive(Clone, Copy, Debug)]
pub struct Spread {
    /// Of origins.
    pub o: [[f64; 2]; 3],
    /// Of directions.
    pub d: [[f64; 2]; 3],
}

/// Roundings of `f64` in a beam's own numbers, and some to spare.
const F64_SLACK: f64 = 16.0 * f64::EPSILON;
/// Of `f32` in a node's test: face minus origin, the inverse, their product; with those of the beam's own numbers, and some to
/// spare.
const F32_SLACK: f64 = 4.0 * f32::EPSILON as f64;
/// Far below every coordinate that matters: covers what [`STEEPEST`] leaves out.
const LEAST: f64 = 1.0 / (1u128 << 90) as f64;
/// A ray moves so little along an axis that it might as well stand still.
const STEEPEST: f64 = (1u128 << 100) as f64;

/// Rays along one axis.
#[derive(Clone, Copy)]
struct Along {
    /// The way they go, 1 or -1; `None` where they go both ways, so that this axis says nothing.
    way: Option<f64>,
    /// One by the fastest and the slowest of them, in t of the world.
    inverse: [f64; 2],
}

impl Along {
    #[inline(always)]
    fn new([least, most]: [f64; 2]) -> Along {
        let way = if least >= 0.0 {
            Some(1.0)
        } else if most <= 0.0 {
            Some(-1.0)
        } else {
            None
        };
        let (a, b) = (1.0 / least.abs(), 1.0 / most.abs());
        Along { way, inverse: if way == Some(1.0) { [b, a] } else { [a, b] } }
    }
}

impl Beam {
    /// The rays of `spread` before they meet the tree in `bounds`; `None` where all miss it. `u` is the unit roundoff of the
    /// kernels that will meet its primitives.
    #[inline(always)]
    pub fn new(fit: &Fit, bounds: &Bounds, spread: &Spread, u: f64) -> Option<Beam> {
        let Spread { o, d } = spread;
        let (mut reach, mut fastest) = (0.0, 0.0);
        for i in 0..3 {
            reach = larger(larger(o[i][0].abs(), o[i][1].abs()), reach);
            fastest = larger(larger(d[i][0].abs(), d[i][1].abs()), fastest);
        }
        // How far a turned surface may seem off by what its frame makes of an origin this far out: 16 roundings, as many as
        // boxes are wider by for their own distance.
        let reach = 16.0 * u * reach;
        // In a shorter format box, centre and size are rounded too.
        let shorter = if u > f64::EPSILON { 16.0 * u } else { 0.0 };
        let along = [Along::new(d[0]), Along::new(d[1]), Along::new(d[2])];
        let (mut start, mut end) = (0.0, f64::INFINITY);
        for i in 0..3 {
            let Some(way) = along[i].way else { continue };
            let slack = reach + (shorter + F64_SLACK) * larger(bounds.lo[i].abs(), bounds.hi[i].abs());
            let (up, down) = (bounds.hi[i] - o[i][0] + slack, bounds.lo[i] - o[i][1] - slack);
            let (enter, leave) = if way > 0.0 { (down, up) } else { (-up, -down) };
            let (enter, leave) = (enter * along[i].inverse[0], leave * along[i].inverse[1]);
            start = if enter > start { enter } else { start };
            end = if leave < end { leave } else { end };
        }
        let start = start * (1.0 - F64_SLACK);
        if start > end * (1.0 + F64_SLACK) || !(start < f64::INFINITY) {
            return None;
        }
        let size = power_below(fastest);
        let wide = 1.0 + F32_SLACK + shorter;
        let mut beam = Beam {
            near_row: [0, 1, 2],
            far_row: [3, 4, 5],
            // As if from far behind: what both ways come to.
            near_from: [STEEPEST as f32; 3],
            near_inverse: [1.0; 3],
            far_from: [-STEEPEST as f32; 3],
            far_inverse: [1.0; 3],
            start,
            speed: fit.scale * size,
            tie: 8.0 * u + F64_SLACK,
        };
        for i in 0..3 {
            let Some(way) = along[i].way else { continue };
            let (low, high) = (o[i][0] + start * d[i][0], o[i][1] + start * d[i][1]);
            let gone = larger(o[i][0].abs(), o[i][1].abs()) + start * larger(d[i][0].abs(), d[i][1].abs());
            let slack = reach + F64_SLACK * (gone + fit.origin[i].abs()) + shorter * fit.origin[i].abs();
            let (low, high) = ((low - fit.origin[i] - slack) * fit.scale, (high - fit.origin[i] + slack) * fit.scale);
            let low = (low - low.abs() * (F32_SLACK + shorter) - LEAST) as f32;
            let high = (high + high.abs() * (F32_SLACK + shorter) + LEAST) as f32;
            let inverse = |k: usize| smaller(along[i].inverse[k] * size, STEEPEST);
            beam.near_inverse[i] = (way * inverse(0) / wide) as f32;
            beam.far_inverse[i] = (way * inverse(1) * wide) as f32;
            if way > 0.0 {
                (beam.near_from[i], beam.far_from[i]) = (high, low);
            } else {
                (beam.near_from[i], beam.far_from[i]) = (low, high);
                (beam.near_row[i], beam.far_row[i]) = (i + 3, i);
            }
        }
        Some(beam)
    }

    /// A t of the world in the tree's units, no smaller; wide enough that a box which begins at the very t of a hit isn't
    /// passed over: it may hide another hit there.
    #[inline(always)]
    pub fn reach(&self, t_max: f64) -> f32 {
        let slack = self.tie * (t_max.abs() + self.start);
        let t = ((t_max - self.start) + slack) * self.speed;
        (t + t.abs() * F32_SLACK) as f32
    }
}

/// Nodes and leaves that wait, nearest last.
struct Stack {
    entries: [u64; ROOM],
    len: usize,
}

impl Stack {
    /// Puts `entry` among those from `base` on, in its place.
    #[inline(always)]
    fn insert(&mut self, entry: u64, base: usize) {
        let mut at = self.len;
        if at >= ROOM {
            return; // no tree is that deep
        }
        while at > base && self.entries[at - 1] < entry {
            self.entries[at] = self.entries[at - 1];
            at -= 1;
        }
        self.entries[at] = entry;
        self.len += 1;
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<u64> {
        self.len = self.len.checked_sub(1)?;
        self.entries.get(self.len).copied()
    }
}

/// Most levels of a tree, grafts included; each leaves up to seven waiting.
pub const MOST_LEVELS: usize = 56;
pub const ROOM: usize = MOST_LEVELS * (super::node::WIDE - 1) + 1;

/// Entry distance and child as one number that sorts by distance: of numbers that aren't negative the bits do.
#[inline(always)]
fn entry(near: f32, child: Child) -> u64 {
    (near.to_bits() as u64) << 32 | child.0 as u64
}

/// Calls `test` for every leaf whose box the rays of `beam` meet before `t_max`, nearer ones first; it gives the new `t_max`.
#[inline(always)]
pub fn walk(nodes: &[Node], beam: &Beam, mut t_max: f32, mut test: impl FnMut(Child) -> f32) {
    let mut stack = Stack { entries: [0; ROOM], len: 0 };
    let mut child = Child::node(0);
    loop {
        if child.is_leaf() {
            t_max = test(child);
        } else if let Some(node) = nodes.get(child.at()) {
            let (near, mut met) = node.meet(beam, t_max);
            if met != 0 {
                let next = |met: &mut u32| {
                    let k = met.trailing_zeros() as usize & 7;
                    *met &= *met - 1;
                    entry(near[k], node.child(k))
                };
                let (mut nearest, base) = (next(&mut met), stack.len);
                while met != 0 {
                    let other = next(&mut met);
                    let (a, b) = if other < nearest { (other, nearest) } else { (nearest, other) };
                    nearest = a;
                    stack.insert(b, base);
                }
                child = Child(nearest as u32);
                continue;
            }
        }
        loop {
            let Some(waiting) = stack.pop() else { return };
            if f32::from_bits((waiting >> 32) as u32) <= t_max {
                child = Child(waiting as u32);
                break;
            }
        }
    }
}
