//! What the points of a batch have in common, found by the register: a box around them, sums, extremes.

use super::batch::PADDING;
use super::bounds::{Bounds, smaller};
use crate::math::real::{each3, three};
use crate::math::{Elem, Lane};

/// A box around the points of some lanes, one for each place of a register.
pub struct Span<L> {
    lo: [L; 3],
    hi: [L; 3],
}

impl<L: Lane> Span<L> {
    /// Holds nothing.
    #[inline(always)]
    pub fn new() -> Span<L> {
        Span { lo: [L::splat(f64::INFINITY); 3], hi: [L::splat(f64::NEG_INFINITY); 3] }
    }

    /// Holds the points of `live` too; a NaN is held by nothing.
    #[inline(always)]
    pub fn hold(&mut self, live: L::Mask, p: [L; 3]) {
        self.lo = three!(c => L::select(live, p[c].min(self.lo[c]), self.lo[c]));
        self.hi = three!(c => L::select(live, p[c].max(self.hi[c]), self.hi[c]));
    }

    /// Holds all of the points too, none of which is a NaN's.
    #[inline(always)]
    pub fn hold_all(&mut self, p: [L; 3]) {
        self.lo = three!(c => p[c].min(self.lo[c]));
        self.hi = three!(c => p[c].max(self.hi[c]));
    }

    /// The box around all.
    #[inline(always)]
    pub fn bounds(&self) -> Bounds {
        Bounds { lo: each3!(self.lo, x => least(x)), hi: each3!(self.hi, x => -least(-x)) }
    }
}

/// A register's numbers one by one.
#[inline(always)]
pub fn stored<L: Lane>(x: L) -> [L::Elem; PADDING] {
    let mut lanes = [L::Elem::default(); PADDING];
    x.store(&mut lanes);
    lanes
}

/// The smallest of a register's numbers.
#[inline(always)]
pub fn least<L: Lane>(x: L) -> f64 {
    let lanes = stored(x);
    let mut least = f64::INFINITY;
    for x in &lanes[..L::WIDTH] {
        least = smaller(x.to_f64(), least);
    }
    least
}

/// One number in every place of a register. A function and not a closure: those aren't always inlined into what is compiled for lanes.
#[inline(always)]
pub fn spread<L: Lane>(x: L::One) -> L {
    L::splat(least(x))
}

/// The sum of a register's numbers.
#[inline(always)]
pub fn total<L: Lane>(x: L) -> f64 {
    let lanes = stored(x);
    let mut total = 0.0;
    for x in &lanes[..L::WIDTH] {
        total += x.to_f64();
    }
    total
}
