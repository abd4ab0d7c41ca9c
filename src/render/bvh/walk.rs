//! The way of rays through the tree.
//!
//! A [`Beam`] stands for one ray or for several that run alike: intervals of origins and of inverse directions, as two numbers
//! an axis, the one that makes the entry into a box earliest and the one that makes the exit latest. So a node is tested by
//! the same few instructions for one ray or sixteen, and all roundings are in the beam: a box is missed only if every
//! ray surely misses it.

use super::node::{Box4, Child, Fit, Node, power_below};
use crate::math::{Elem, Lane, Mask};
use crate::render::bounds::{Bounds, larger, smaller};
use std::mem::MaybeUninit;

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
}

impl<W: Lane<Elem = f32>> Registers<W> {
    #[inline(always)]
    fn new(beam: &Beam) -> Self {
        Registers {
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
    /// Whether a ray may meet the box, in the tree's units, for those who know better than their beam.
    #[inline(always)]
    fn may_meet(&self, b: impl FnOnce() -> Box4) -> bool {
        let _ = b;
        true
    }
}

/// Origins and directions of rays: smallest and largest, by axis.
#[derive(Clone, Copy, Debug)]
pub struct Spread {
    /// Of origins.
    pub o: [[f64; 2]; 3],
    /// Of directions.
    pub d: [[f64; 2]; 3],
}

/// More lanes than any register has.
const LANES: usize = 16;

/// The largest number in the lanes of `alive`.
#[inline(always)]
pub fn farthest<L: Lane>(t: L, alive: L::Mask) -> f64 {
    let t = L::select(alive, t, L::splat(f64::NEG_INFINITY));
    let mut all = [L::Elem::default(); LANES];
    t.store(&mut all);
    let mut most = f64::NEG_INFINITY;
    for x in &all[..L::WIDTH] {
        most = larger(x.to_f64(), most);
    }
    most
}

impl Spread {
    /// Of one ray.
    #[inline(always)]
    pub fn of_one(o: [f64; 3], d: [f64; 3]) -> Spread {
        Spread { o: [[o[0]; 2], [o[1]; 2], [o[2]; 2]], d: [[d[0]; 2], [d[1]; 2], [d[2]; 2]] }
    }

    /// Of the lanes of `alive`.
    #[inline(always)]
    pub fn of<L: Lane>(o: [L; 3], d: [L; 3], alive: L::Mask) -> Spread {
        let alive = alive.bits();
        Spread {
            o: [range(o[0], alive), range(o[1], alive), range(o[2], alive)],
            d: [range(d[0], alive), range(d[1], alive), range(d[2], alive)],
        }
    }
}

impl Spread {
    /// Whether the rays run so much alike that a box which the beam meets is met by most of them.
    #[inline(always)]
    pub fn is_narrow(&self) -> bool {
        let alike =
            |[least, most]: [f64; 2]| (least >= 0.0 && most <= 2.0 * least) || (most <= 0.0 && least >= 2.0 * most);
        alike(self.d[0]) && alike(self.d[1]) && alike(self.d[2])
    }
}

/// Smallest and largest number in the lanes of `alive`.
#[inline(always)]
fn range<L: Lane>(v: L, alive: u32) -> [f64; 2] {
    let mut all = [L::Elem::default(); LANES];
    v.store(&mut all);
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for (k, x) in all[..L::WIDTH].iter().enumerate() {
        if alive >> k & 1 == 1 {
            (least, most) = (smaller(x.to_f64(), least), larger(x.to_f64(), most));
        }
    }
    [least, most]
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
    pub(super) fn new(fit: &Fit, bounds: &Bounds, spread: &Spread, u: f64) -> Option<Beam> {
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
            let far = larger(bounds.lo[i].abs(), bounds.hi[i].abs());
            let slack = reach + F64_SLACK * (gone + fit.origin[i].abs()) + shorter * far;
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

/// Most levels of a tree, grafts included; each leaves up to seven waiting.
pub const MOST_LEVELS: usize = 56;
pub const ROOM: usize = MOST_LEVELS * (super::node::WIDE - 1) + 1;

/// Entry distance and child as one number that sorts by distance: of numbers that aren't negative the bits do.
#[inline(always)]
fn entry(near: f32, child: Child) -> u64 {
    (near.to_bits() as u64) << 32 | child.0 as u64
}

/// Tests every leaf whose box the rays of `beam` meet before `t_max`, nearer ones first.
#[inline(always)]
pub fn walk<W: Lane<Elem = f32>>(nodes: &[Node], ids: &[u32], beam: &Beam, t_max: f64, leaves: &mut impl Leaves) {
    let mut stack = Stack::new();
    let mut child = Child::node(0);
    let registers = Registers::<W>::new(beam);
    let mut t_max = beam.reach(t_max);
    loop {
        if child.is_leaf() {
            t_max = beam.reach(leaves.test(ids.get(child.range()).unwrap_or_default()));
        } else if let Some(node) = nodes.get(child.at()) {
            let (near, children, mut met) = node.meet(&registers, t_max);
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
            let Some(waiting) = stack.pop() else { return };
            if f32::from_bits((waiting >> 32) as u32) <= t_max {
                child = Child(waiting as u32);
                break;
            }
        }
    }
}
