//! Draws the cases: numbers over all magnitudes, directions, places, and what seeks trouble: axis-parallel rays with ±0,
//! neighbours of special values.

use crate::math::Affine;
use crate::math::hash::KeyedHash;
use crate::math::real::{dot, scaled};
use glam::DVec3;

/// The random numbers of one case. The same check and case draw the same ones everywhere.
pub(super) struct Draw {
    key: KeyedHash,
    drawn: u64,
}

impl Draw {
    /// For case number `case` of `check`.
    pub(super) fn new(check: &str, case: u64) -> Draw {
        Draw { key: KeyedHash::new().with_text(check).with(case), drawn: 0 }
    }

    fn next(&mut self) -> KeyedHash {
        self.drawn += 1;
        self.key.with(self.drawn)
    }

    /// In [0, 1).
    pub(super) fn unit(&mut self) -> f64 {
        self.next().unit()
    }

    /// In [lo, hi).
    pub(super) fn between(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * self.unit()
    }

    /// 0..n.
    pub(super) fn below(&mut self, n: u64) -> u64 {
        self.next().bits() % n
    }

    /// Once in `n`.
    pub(super) fn once_in(&mut self, n: u64) -> bool {
        self.below(n) == 0
    }

    /// 1 or −1.
    pub(super) fn sign(&mut self) -> f64 {
        if self.once_in(2) { 1.0 } else { -1.0 }
    }

    /// Of any magnitude from 2^lo to 2^hi, each power of two as likely.
    pub(super) fn magnitude(&mut self, lo: i32, hi: i32) -> f64 {
        let n = lo + self.below((hi - lo) as u64) as i32;
        self.between(1.0, 2.0) * power(n)
    }

    /// A vector with coordinates in [−1, 1).
    pub(super) fn vector(&mut self) -> [f64; 3] {
        [0; 3].map(|_| self.between(-1.0, 1.0))
    }

    /// A point in the unit ball.
    pub(super) fn in_ball(&mut self) -> [f64; 3] {
        loop {
            let v = self.vector();
            if dot(v, v) <= 1.0 {
                return v;
            }
        }
    }

    /// A direction, of length 1 but for rounding.
    pub(super) fn direction(&mut self) -> [f64; 3] {
        loop {
            let v = self.in_ball();
            if dot(v, v) > 0.01 {
                return unit(v);
            }
        }
    }

    /// A direction along a coordinate axis, with a −0 or 0 in the other places.
    pub(super) fn axis(&mut self) -> [f64; 3] {
        let mut d = [0; 3].map(|_| 0.0 * self.sign());
        d[self.below(3) as usize] = self.sign();
        d
    }

    /// A rotation about some axis.
    pub(super) fn rotation(&mut self) -> Affine {
        let axis = DVec3::from_array(self.direction());
        Affine::rotation_about(axis, self.between(0.0, 360.0))
    }

    /// `x` or one of its neighbours, up to `steps` numbers away.
    pub(super) fn neighbour(&mut self, x: f64, steps: u64) -> f64 {
        let (n, up) = (self.below(steps + 1), self.once_in(2));
        (0..n).fold(x, |x, _| if up { x.next_up() } else { x.next_down() })
    }
}

/// `v` at length 1, but for rounding.
pub(super) fn unit(v: [f64; 3]) -> [f64; 3] {
    scaled(1.0 / dot(v, v).sqrt(), v)
}

/// 2^n, for n in the range of normal numbers.
pub(super) fn power(n: i32) -> f64 {
    f64::from_bits(((1023 + n) as u64) << 52)
}
