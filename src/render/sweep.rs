//! One surface against many registers of rays: what kind of shape it is, and how it stands, is asked once and not for each register.
//!
//! A kernel is some tens of instructions for a register of rays. To find out which kernel it is, where the shape stands, which ball is
//! around it and whether its crossings are confined takes as many again. So a list of candidates is gone through surface by
//! surface, each against the whole batch, in a loop that is compiled for its kind.

use super::ball::Ball;
use super::batch::{HitColumns, RayBatch, load3};
use super::closest::Nearest;
use super::confine::Confined;
use super::known::{Known, with_known};
use super::ray::Own;
use super::run::place;
use super::shape::primitive::Tables;
use super::world::World;
use crate::math::{Lane, Mask};

/// Tests surface `k` against every ray of a batch, if it is a primitive and its crossings aren't confined; says whether. `AT_EYE` says
/// that all origins are exactly 0.
#[inline(always)]
pub fn sweep<L: Lane, const AT_EYE: bool>(
    world: &World,
    k: u32,
    rays: &RayBatch<L::Elem>,
    hits: &mut HitColumns<L::Elem>,
) -> bool {
    if !world.is_plain(k) {
        return false;
    }
    let ball = world.ball(k).filter(Ball::is_there);
    with_known!(world.primitive(k), known => {
        let one = One { tables: world.tables(), surface: known, k, ball };
        one.against::<L, AT_EYE>(rays, hits);
    });
    true
}

/// A surface, and what rays are told of it.
struct One<'w, S> {
    tables: Tables<'w>,
    surface: S,
    k: u32,
    /// Around it.
    ball: Option<Ball>,
}

impl<S: Known> One<'_, S> {
    #[inline(always)]
    fn against<L: Lane, const AT_EYE: bool>(&self, rays: &RayBatch<L::Elem>, hits: &mut HitColumns<L::Elem>) {
        let number = L::splat(self.k as f64);
        for g in (0..rays.len).step_by(L::WIDTH) {
            let g = place(g);
            let d = load3::<L>(&rays.d, g);
            let (mut o, mut own) = ([L::zero(); 3], None);
            if !AT_EYE {
                o = load3::<L>(&rays.o, g);
                let here = L::load(&rays.source[g..]).same(number);
                if here.any() {
                    let outward = L::one().same(L::load(&rays.outward[g..]));
                    let live = L::Mask::first((rays.len - g).min(L::WIDTH));
                    if self.surface.is_left_for_good() && !(live & !(here & outward)).any() {
                        continue;
                    }
                    own = Own::of(here, L::load(&rays.source_part[g..]), outward);
                }
            }
            let mut met = L::Mask::splat(true);
            if let Some(ball) = &self.ball {
                met = !ball.passed_by::<L, AT_EYE>((o, d));
                if let Some(own) = &own {
                    met = met | own.here; // what went in must come out, wherever rounding puts the start
                }
                if !met.any() {
                    continue;
                }
            }
            let mut best = Nearest::load(hits, g);
            best.current = number;
            let visit = &mut Confined::new(met, None, (o, d), &mut best);
            self.surface.crossings::<L, AT_EYE>(self.tables, (o, d), own, visit);
            best.store(hits, g);
        }
    }
}
