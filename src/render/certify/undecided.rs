//! The tests of a sheet that a polygon leaves undecided.

use super::polygon::Polygon;
use crate::math::Form;

/// Most tests of one sheet: five of a box's face, and whether something lies ahead.
const MOST_TESTS: usize = 6;

/// Tests that are undecided on a polygon; in place, for there are few, and most sheets are found to be missed.
#[derive(Clone, Debug)]
pub struct Undecided {
    n: usize,
    all: [Form; MOST_TESTS],
}

impl Undecided {
    /// No test.
    pub fn none() -> Undecided {
        Undecided { n: 0, all: [Form::constant(0.0); MOST_TESTS] }
    }

    /// Adds g ≥ 0, unless it is sure on `p`; whether it may hold anywhere.
    pub fn may_hold(&mut self, p: &Polygon, g: Form) -> bool {
        let (lo, hi) = p.range(g);
        if hi < 0.0 {
            return false;
        }
        if lo < 0.0 {
            self.push(g);
        }
        true
    }

    /// Adds one that is undecided.
    pub fn push(&mut self, g: Form) {
        if let Some(free) = self.all.get_mut(self.n) {
            *free = g;
            self.n += 1;
        }
    }
}

impl std::ops::Deref for Undecided {
    type Target = [Form];
    fn deref(&self) -> &[Form] {
        &self.all[..self.n]
    }
}
