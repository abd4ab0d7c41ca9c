//! Rays from points of surfaces to one light, and what of a surface they may meet.

use super::between::Met;
use super::pattern_point::Rows;
use super::ray::Own;
use super::shape::Visit;
use super::touch::ButAtTheEnd;
use super::way::Way;
use super::world::World;
use crate::math::Lane;
use crate::math::real::Mask;

/// Room for what a shadow ray needs beside its candidates.
#[derive(Debug, Default)]
pub struct Shadow {
    /// What lets part of the light through.
    pub transparent: Vec<u32>,
    /// The maps of its patterns.
    pub spaces: Vec<Rows>,
    /// What lately stood before each light: it often does so again.
    pub blockers: Vec<Option<u32>>,
    /// Of camera rays' hits, and of others.
    pub ways: [Way; 2],
    /// Whether these are others.
    pub deep: bool,
}

/// Rays from points of surfaces to one light.
#[derive(Clone, Copy)]
pub struct ShadowRays<'w, L: Lane> {
    /// The surfaces that they start on.
    pub source: L,
    /// The parts of them.
    pub part: L,
    /// 1 in lanes that leave them to the outside.
    pub outward: L,
    /// Where they start.
    pub o: [L; 3],
    /// Towards the light, of unit length.
    pub l: [L; 3],
    /// How far it is.
    pub distance: L,
    /// The light, by number.
    pub light: usize,
    /// The primitives that the light lies on.
    pub touched: &'w [u32],
}

impl<L: Lane> ShadowRays<'_, L> {
    /// Whether all lanes of `open` start on surface `k` and surely don't meet it again.
    #[inline(always)]
    pub fn left_for_good(&self, world: &World, k: u32, open: L::Mask) -> bool {
        let leaves = self.source.same(L::splat(k as f64)) & self.outward.same(L::one());
        // Mostly none does, and the primitive needn't be looked at.
        leaves.any() && world.primitive(k).kind.is_left_for_good() && !(open & !leaves).any()
    }

    /// Whether all lanes of `open` surely miss surface `k`, and by far: told by the ball around it, before anything else of it is
    /// looked at, for that may be anywhere in memory.
    #[inline(always)]
    pub fn pass_by(&self, world: &World, k: u32, open: L::Mask) -> bool {
        match world.ball(k) {
            Some(ball) => {
                let here = self.source.same(L::splat(k as f64));
                !(open & (here | !ball.passed_by::<L, false>((self.o, self.l)))).any()
            }
            None => false,
        }
    }

    /// Visits the crossings with surface `k`.
    #[inline(always)]
    pub fn crossings(&self, world: &World, k: u32, visit: &mut impl Visit<L>) {
        let own = Own::of(self.source.same(L::splat(k as f64)), self.part, self.outward.same(L::one()));
        world.crossings::<L, false>(k, (self.o, self.l), own, visit);
    }

    /// The crossings with surface `k` that lie between start and light; in a function of its own, for it is seldom asked.
    #[inline(always)]
    pub fn met(&self, world: &World, k: u32) -> Met<L> {
        L::vectorize(
            #[inline(always)]
            || {
                let nothing = (L::zero(), L::zero(), L::Mask::splat(false));
                let mut met = Met { distance: self.distance, crossings: [nothing; 4], n: 0 };
                let mut visit = ButAtTheEnd::new(self.distance, self.touched.contains(&k), &mut met);
                self.crossings(world, k, &mut visit);
                met
            },
        )
    }
}
