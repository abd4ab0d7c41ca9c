//! How much of a light arrives: shadow rays, and what transparent objects let through.

use super::candidates::Candidates;
use super::footprint::Recorder;
use super::ray::Own;
use super::shape::Visit;
use super::surface_pattern::PatternFrame;
use super::touch::ButAtTheEnd;
use super::world::World;
use crate::math::real::{Mask, each3, splat3, three};
use crate::math::{Lane, Real};
use crate::render::pattern::Rows;

/// Room for what a shadow ray needs beside its candidates.
#[derive(Debug, Default)]
pub struct Shadow {
    transparent: Vec<u32>,
    spaces: Vec<Rows>,
}

/// Rays from points of a surface to one light.
#[derive(Clone, Copy)]
pub struct ShadowRays<'w, L: Lane> {
    /// The primitive that they start on.
    pub source: u32,
    /// The part of it.
    pub part: L,
    /// Lanes that leave it to the outside.
    pub outward: L::Mask,
    /// Where they start.
    pub o: [L; 3],
    /// Towards the light, of unit length.
    pub l: [L; 3],
    /// How far it is.
    pub distance: L,
    /// The primitives that the light lies on.
    pub touched: &'w [u32],
}

impl<L: Lane> ShadowRays<'_, L> {
    /// Visits the crossings with primitive `k` that lie between start and light.
    #[inline(always)]
    fn crossings(&self, world: &World, k: u32, visit: &mut impl Visit<L>) {
        if self.touched.contains(&k) {
            return self.crossings_but_the_light(world, k, visit);
        }
        world.crossings::<L, false>(k, (self.o, self.l), self.own(k), visit);
    }

    #[cold]
    #[inline(never)]
    fn crossings_but_the_light(&self, world: &World, k: u32, visit: &mut impl Visit<L>) {
        let mut visit = ButAtTheEnd::new(self.distance, visit);
        world.crossings::<L, false>(k, (self.o, self.l), self.own(k), &mut visit);
    }

    #[inline(always)]
    fn own(&self, k: u32) -> Option<Own<L>> {
        Some(Own { here: L::Mask::splat(k == self.source), part: self.part, outward: self.outward })
    }
}

/// The share of light, by channel, that arrives in the lanes of `active`. Every crossing of a transparent surface dims by its
/// transmission; the factors are multiplied in the order of the primitives' numbers, so that no order of tests changes a
/// bit.
#[inline(always)]
pub fn occlusion<L: Lane>(
    world: &World,
    occluders: &Candidates,
    rays: &ShadowRays<'_, L>,
    active: L::Mask,
    scratch: &mut Shadow,
    recorder: &mut Recorder,
) -> [L; 3] {
    let (o, l, distance) = (rays.o, rays.l, rays.distance);
    let mut seen = [L::one(); 3];
    // Opaque ones first: they need no order.
    let mut open = Open { mask: active, rays };
    scratch.transparent.clear();
    for &k in &occluders.ids {
        open.test(world, k, &mut scratch.transparent, recorder);
        if !open.mask.any() {
            return [L::zero(); 3];
        }
    }
    if occluders.tree {
        world.bvh.traverse(o, l, open.reach(), |k| {
            open.test(world, k, &mut scratch.transparent, recorder);
            open.reach()
        });
    }
    let open = open.mask;
    let zero = L::zero();
    seen = each3(seen, |x| L::select(open, x, zero));
    if scratch.transparent.is_empty() || !open.any() {
        return seen;
    }
    scratch.transparent.sort_unstable();
    for &k in &scratch.transparent {
        if recorder.is_on() {
            recorder.shaded(k); // met or not: seldom more than a few
        }
        let primitive = world.primitive(k);
        match world.constant_transmission(k) {
            Some(factor) => {
                let mut dimmed = Dimmed { distance, factor: splat3(factor), seen };
                rays.crossings(world, k, &mut dimmed);
                seen = dimmed.seen;
            }
            None => {
                let mut met = Met { distance, crossings: [(zero, zero, L::Mask::splat(false)); 4], n: 0 };
                rays.crossings(world, k, &mut met);
                let frame = PatternFrame::new(world, primitive, world.surfacing(k), &mut scratch.spaces);
                for (t, part, m) in met.crossings.into_iter().take(met.n) {
                    if m.any() {
                        let surface = world.surface::<L, false>(k, (o, l), (t, part));
                        let at = frame.point(&scratch.spaces, surface.local, surface.n);
                        let factor = frame.transmission(world, &at);
                        seen = three(|c| L::select(m, seen[c] * factor[c], seen[c]));
                    }
                }
            }
        }
    }
    seen
}

/// Shadow rays that nothing opaque has stopped yet.
struct Open<'r, L: Lane> {
    mask: L::Mask,
    rays: &'r ShadowRays<'r, L>,
}

impl<L: Lane> Open<'_, L> {
    /// Tests primitive `k`, or puts it aside where it is transparent.
    #[inline(always)]
    fn test(&mut self, world: &World, k: u32, transparent: &mut Vec<u32>, recorder: &mut Recorder) {
        match world.constant_transmission(k) {
            Some([0.0, 0.0, 0.0]) => {
                let mut met = Blocked { distance: self.rays.distance, blocked: L::Mask::splat(false) };
                self.rays.crossings(world, k, &mut met);
                if recorder.is_on() && (self.mask & met.blocked).any() {
                    recorder.shaded(k);
                }
                self.mask = self.mask & !met.blocked;
            }
            Some([1.0, 1.0, 1.0]) => {}
            _ => transparent.push(k),
        }
    }

    /// How far each ray still has to be followed.
    #[inline(always)]
    fn reach(&self) -> L {
        L::select(self.mask, self.rays.distance, -L::one())
    }
}

/// Whether anything lies between a point and the light.
struct Blocked<R: Real> {
    distance: R,
    blocked: R::Mask,
}

impl<R: Real> Visit<R> for Blocked<R> {
    #[inline(always)]
    fn crossing(&mut self, t: R, _part: R, valid: R::Mask) {
        self.blocked = self.blocked | (valid & R::zero().lt(t) & t.lt(self.distance));
    }
}

/// Dims by the same factor at every crossing.
struct Dimmed<R> {
    distance: R,
    factor: [R; 3],
    seen: [R; 3],
}

impl<R: Real> Visit<R> for Dimmed<R> {
    #[inline(always)]
    fn crossing(&mut self, t: R, _part: R, valid: R::Mask) {
        let m = valid & R::zero().lt(t) & t.lt(self.distance);
        self.seen = three(|c| R::select(m, self.seen[c] * self.factor[c], self.seen[c]));
    }
}

/// Remembers the crossings in between: at most four, a torus'.
struct Met<R: Real> {
    distance: R,
    crossings: [(R, R, R::Mask); 4],
    n: usize,
}

impl<R: Real> Visit<R> for Met<R> {
    #[inline(always)]
    fn crossing(&mut self, t: R, part: R, valid: R::Mask) {
        if self.n < self.crossings.len() {
            self.crossings[self.n] = (t, part, valid & R::zero().lt(t) & t.lt(self.distance));
            self.n += 1;
        }
    }
}
