//! The rays of a register on their way through the tree together.

use super::beam::farthest;
use super::node::{Box4, Fit};
use super::walk::Leaves;
use crate::math::{Lane, Mask};
use crate::render::slabs::Slabs;

/// Leaves whose primitives a function tests one by one.
pub struct OneByOne<L: Lane, C, F> {
    /// What the search may cost.
    pub most: u32,
    /// What a test costs.
    pub cost: C,
    /// Tests a primitive.
    pub test: F,
    /// How far each lane still looks.
    pub t_max: L,
    /// Lanes that hold a ray.
    pub alive: L::Mask,
    /// Where rays run apart: each for itself.
    pub slabs: Option<Slabs<L>>,
    /// Units of the tree.
    pub fit: Fit,
}

impl<L: Lane, C: Fn(u32) -> u32, F: FnMut(u32) -> L> Leaves for OneByOne<L, C, F> {
    #[inline(always)]
    fn test(&mut self, ids: &[u32]) -> f64 {
        for id in ids {
            self.t_max = (self.test)(*id);
        }
        farthest(self.t_max, self.alive)
    }
    #[inline(always)]
    fn cost(&self, ids: &[u32]) -> u32 {
        let mut sum = 0;
        for id in ids {
            sum += (self.cost)(*id);
        }
        sum
    }
    #[inline(always)]
    fn most(&self) -> u32 {
        self.most
    }
    #[inline(always)]
    fn cost_of_boxes(&self, boxes: u32) -> u32 {
        if self.slabs.is_some() { boxes.count_ones() } else { 0 }
    }
    #[inline(always)]
    fn may_meet(&self, b: impl FnOnce() -> Box4) -> bool {
        match &self.slabs {
            Some(slabs) => (slabs.meet(&self.fit.grow(&b()), self.t_max) & self.alive).any(),
            None => true,
        }
    }
}
