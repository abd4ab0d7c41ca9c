//! The nodes of the tree: eight boxes side by side, so that one instruction does the same to all of them.
//!
//! Faces are `f32`, rounded outwards, in the tree's own units ([`Fit`]): a box is there to say where a surface surely isn't, and
//! half the bytes are half the time. So a scene may be as large or as small as `f64` allows.

use super::walk::Registers;
use crate::math::{Lane, Mask};
use crate::render::bounds::{Bounds, larger};

/// Children of a node.
pub const WIDE: usize = 8;

/// Boxes of eight children and what is in them.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Node {
    /// The lower faces across x, y and z, the upper ones; then, in its bits, what each child is. The last row only makes the node
    /// four cache lines, and any number of three bits a row.
    rows: [[f32; WIDE]; 8],
}

/// Row of the upper faces across x.
const UPPER: usize = 3;
/// Row that tells what the children are.
const CHILD: usize = 6;

/// What a slot of a node refers to: another node, or up to [`Child::MOST`] primitives, in a row or in a [`Swarm`](super::swarm::Swarm).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Child(pub u32);

impl Child {
    /// Most primitives of a leaf.
    pub const MOST: usize = 8;
    /// Nothing: a leaf whose box is empty.
    pub const NONE: Child = Child(Child::LEAF);

    const LEAF: u32 = 1 << 31;
    const SWARM: u32 = 1 << 30;
    const COUNT: u32 = 27;
    const FIRST: u32 = (1 << Child::COUNT) - 1;

    /// Node number `at`.
    pub fn node(at: usize) -> Child {
        Child(at as u32)
    }
    /// `count` primitives, at least one, from `first` on in the order of the leaves.
    pub fn leaf(first: usize, count: usize) -> Child {
        Child(Child::LEAF | (count as u32 - 1) << Child::COUNT | first as u32 & Child::FIRST)
    }
    /// The first `count` balls, at least one, of swarm number `at`.
    pub fn swarm(at: usize, count: usize) -> Child {
        Child(Child::leaf(at, count).0 | Child::SWARM)
    }
    /// Whether it is a leaf.
    #[inline(always)]
    pub fn is_leaf(self) -> bool {
        self.0 & Child::LEAF != 0
    }
    /// The node's number.
    #[inline(always)]
    pub fn at(self) -> usize {
        self.0 as usize
    }
    /// Whether it is a leaf that is a swarm.
    #[inline(always)]
    pub fn is_swarm(self) -> bool {
        self.0 >= Child::LEAF | Child::SWARM
    }
    /// How many primitives the leaf has.
    #[inline(always)]
    pub fn count(self) -> usize {
        (self.0 >> Child::COUNT & 7) as usize + 1
    }
    /// Where the leaf's primitives stand in the order of the leaves, or the number of its swarm.
    #[inline(always)]
    pub fn first(self) -> usize {
        (self.0 & Child::FIRST) as usize
    }
    /// Where the leaf's primitives stand in the order of the leaves.
    #[inline(always)]
    pub fn range(self) -> std::ops::Range<usize> {
        self.first()..self.first() + self.count()
    }
}

/// A box in the tree's units; x, y, z, and one unused, so that it fills a register.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Box4 {
    /// Smallest corner.
    pub lo: [f32; 4],
    /// Largest corner.
    pub hi: [f32; 4],
}

impl Box4 {
    /// Holds nothing.
    pub const EMPTY: Box4 = Box4 { lo: [f32::INFINITY; 4], hi: [f32::NEG_INFINITY; 4] };

    /// Holds both.
    #[inline(always)]
    pub fn union(self, o: Box4) -> Box4 {
        let (mut lo, mut hi) = (self.lo, self.hi);
        for i in 0..4 {
            lo[i] = if o.lo[i] < lo[i] { o.lo[i] } else { lo[i] };
            hi[i] = if o.hi[i] > hi[i] { o.hi[i] } else { hi[i] };
        }
        Box4 { lo, hi }
    }
    /// The sides' lengths.
    #[inline(always)]
    pub fn extent(&self) -> [f32; 3] {
        [0, 1, 2].map(|i| self.hi[i] - self.lo[i])
    }
}

impl Node {
    /// Without children.
    pub fn empty() -> Node {
        let mut node = Node { rows: [[0.0; WIDE]; 8] };
        (0..WIDE).for_each(|slot| node.set(slot, Box4::EMPTY, Child::NONE));
        node
    }

    /// Fills a slot.
    pub fn set(&mut self, slot: usize, b: Box4, child: Child) {
        for i in 0..3 {
            self.rows[i][slot] = b.lo[i];
            self.rows[UPPER + i][slot] = b.hi[i];
        }
        self.refer(slot, child);
    }

    /// The box of a slot.
    pub fn box_of(&self, slot: usize) -> Box4 {
        let mut b = Box4::EMPTY;
        for i in 0..3 {
            b.lo[i] = self.rows[i][slot];
            b.hi[i] = self.rows[UPPER + i][slot];
        }
        b
    }

    /// What a slot refers to.
    #[inline(always)]
    pub fn child(&self, slot: usize) -> Child {
        Child(self.rows[CHILD][slot & (WIDE - 1)].to_bits())
    }

    /// Adds to the numbers of the children that are nodes, and to the places of those that are leaves.
    pub fn renumber(&mut self, nodes: usize, leaves: usize) {
        for slot in 0..WIDE {
            if !self.is_used(slot) {
                continue;
            }
            let child = self.child(slot);
            let moved = match child.is_leaf() {
                true => Child(child.0 + leaves as u32),
                false => Child::node(child.at() + nodes),
            };
            self.refer(slot, moved);
        }
    }

    /// Has a slot refer to something else.
    pub fn refer(&mut self, slot: usize, child: Child) {
        self.rows[CHILD][slot] = f32::from_bits(child.0);
    }

    /// Around all children.
    pub fn around(&self) -> Box4 {
        self.children().fold(Box4::EMPTY, |b, (slot, _)| b.union(self.box_of(slot)))
    }

    /// The slots that are used.
    pub fn children(&self) -> impl Iterator<Item = (usize, Child)> {
        (0..WIDE).filter(|&slot| self.is_used(slot)).map(|slot| (slot, self.child(slot)))
    }

    /// Whether a slot is used.
    pub fn is_used(&self, slot: usize) -> bool {
        self.rows[0][slot] < f32::INFINITY
    }

    /// Where rays enter each of the eight boxes, the bits of what is in them, and one bit for each box that they meet before
    /// `t_max`. `W` is a register of up to eight.
    #[inline(always)]
    pub fn meet<W: Lane<Elem = f32>>(&self, beam: &Registers<W>, t_max: f32) -> ([f32; WIDE], [f32; WIDE], u32) {
        let (mut nears, mut children, mut met) = ([0.0; WIDE], [0.0; WIDE], 0);
        let t_max = W::splat(t_max as f64);
        for k in 0..WIDE / W::WIDTH {
            let (mut near, mut far) = (W::zero(), t_max);
            for i in 0..3 {
                let (enter, leave) = (&self.rows[beam.near_row[i] & 7], &self.rows[beam.far_row[i] & 7]);
                let enter = (W::load(&enter[k * W::WIDTH..]) - beam.near_from[i]) * beam.near_inverse[i];
                let leave = (W::load(&leave[k * W::WIDTH..]) - beam.far_from[i]) * beam.far_inverse[i];
                (near, far) = (enter.max(near), leave.min(far));
            }
            near.store(&mut nears[k * W::WIDTH..]);
            // Fetched together with the faces: a wait for memory less.
            W::load(&self.rows[CHILD][k * W::WIDTH..]).store(&mut children[k * W::WIDTH..]);
            met |= near.le(far).bits() << (k * W::WIDTH);
        }
        (nears, children, met)
    }
}

/// The tree's own units: p' = (p − origin)·scale. `scale` is a power of two that brings the largest coordinate to 1 or a
/// little more, so nothing leaves the range of `f32`. The origin is the camera, near which numbers are fine, unless all the
/// tree is far away.
#[derive(Clone, Copy, Debug)]
pub struct Fit {
    /// What is subtracted.
    pub origin: [f64; 3],
    /// What is multiplied by.
    pub scale: f64,
}

impl Default for Fit {
    fn default() -> Fit {
        Fit { origin: [0.0; 3], scale: 1.0 }
    }
}

/// From this many times its own size away, a tree is measured from its middle: `f32` boxes then still part 2^18 of them.
const FAR: f64 = 64.0;

/// One step of `f32`, relatively; a rounding is at most half of it.
const STEP: f64 = f32::EPSILON as f64;

impl Fit {
    /// Units for boxes within `bounds`.
    pub fn new(bounds: &Bounds) -> Fit {
        let (c, size) = (bounds.centre(), [0, 1, 2].map(|i| 0.5 * (bounds.hi[i] - bounds.lo[i])));
        let most = |v: [f64; 3]| v.into_iter().map(f64::abs).fold(0.0, larger);
        let (away, half) = (most(c), most(size));
        if !(away < f64::MAX && half < f64::MAX) {
            return Fit::default();
        }
        let (origin, reach) =
            if away > FAR * half { (c, half) } else { ([0.0; 3], larger(most(bounds.lo), most(bounds.hi))) };
        Fit { origin, scale: 1.0 / power_below(reach) }
    }

    /// The box, rounded outwards.
    #[inline(always)]
    pub fn shrink(&self, b: &Bounds) -> Box4 {
        let mut out = Box4 { lo: [0.0; 4], hi: [0.0; 4] };
        for i in 0..3 {
            // The difference is off by far less than the step that is added.
            let (lo, hi) = ((b.lo[i] - self.origin[i]) * self.scale, (b.hi[i] - self.origin[i]) * self.scale);
            out.lo[i] = (lo - lo.abs() * STEP - LEAST) as f32;
            out.hi[i] = (hi + hi.abs() * STEP + LEAST) as f32;
        }
        out
    }

    /// A box that surely holds what `b` holds, in the world.
    #[inline(always)]
    pub fn grow(&self, b: &Box4) -> Bounds {
        let inverse = 1.0 / self.scale;
        let mut out = Bounds::EMPTY;
        for i in 0..3 {
            let slack = f64::EPSILON * self.origin[i].abs();
            out.lo[i] = (b.lo[i] as f64 * inverse + self.origin[i]) - slack;
            out.hi[i] = (b.hi[i] as f64 * inverse + self.origin[i]) + slack;
        }
        out
    }
}

/// Far below every coordinate that matters, and far above the smallest `f32`: covers what rounding loses there.
const LEAST: f64 = 1.0 / (1u128 << 120) as f64;

/// The largest power of two that isn't above `x`, within 2^±1000; 1 for 0 and what is no number.
pub fn power_below(x: f64) -> f64 {
    if !(x > 0.0 && x < f64::INFINITY) {
        return 1.0;
    }
    let exponent = ((x.to_bits() >> 52) as i64 - 1023).clamp(-1000, 1000);
    f64::from_bits(((exponent + 1023) as u64) << 52)
}
