//! The truth of a comparison of intervals: for all values in them, for some, or for none.

use super::real::Mask;
use std::ops::{BitAnd, BitOr, Not};

/// True, false, or true for some values and false for others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tri {
    /// Whether it surely holds.
    pub certain: bool,
    /// Whether it may hold.
    pub possible: bool,
}

impl BitAnd for Tri {
    type Output = Tri;
    #[inline(always)]
    fn bitand(self, o: Tri) -> Tri {
        Tri { certain: self.certain & o.certain, possible: self.possible & o.possible }
    }
}
impl BitOr for Tri {
    type Output = Tri;
    #[inline(always)]
    fn bitor(self, o: Tri) -> Tri {
        Tri { certain: self.certain | o.certain, possible: self.possible | o.possible }
    }
}
impl Not for Tri {
    type Output = Tri;
    #[inline(always)]
    fn not(self) -> Tri {
        Tri { certain: !self.possible, possible: !self.certain }
    }
}
impl Mask for Tri {
    #[inline(always)]
    fn splat(value: bool) -> Tri {
        Tri { certain: value, possible: value }
    }
    #[inline(always)]
    fn from_bits(bits: u32) -> Tri {
        Mask::splat(bits & 1 == 1)
    }
    /// Set where it may hold: what is skipped where no lane is set is surely not needed.
    #[inline(always)]
    fn bits(self) -> u32 {
        self.possible as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logic_of_kleene() {
        let (yes, no) = (Tri::splat(true), Tri::splat(false));
        let maybe = Tri { certain: false, possible: true };
        assert_eq!((yes & maybe, no & maybe, yes | maybe, no | maybe), (maybe, no, yes, maybe));
        assert_eq!((!yes, !no, !maybe), (no, yes, maybe));
    }
}
