//! What a batch of rays may meet: found once for all of them, so that each tests only what is near.

use super::batch::{RayBatch, load3};
use super::bounds::Bounds;
use super::cull::margin;
use super::footprint::Beam;
use super::span::{Span, least, total};
use super::world::World;
use crate::math::Lane;
use crate::math::real::{Mask, dot, each3, splat3, three};

/// Longest list of candidates that every ray of a batch tests in turn; beyond it each ray goes through the tree. Counted in instructions
/// over six examples, four rays at a time: 8 takes 1 to 5 % less than 4 in three of them, and 0.2 % more at most in the others.
pub const LONGEST_LIST: usize = 8;

/// A node of the tree looked at for all rays takes about as long as this many of them take to go through the tree alone, so no more
/// are looked at.
const RAYS_A_NODE: usize = 8;

/// What a batch of rays may meet.
#[derive(Clone, Debug, Default)]
pub struct Candidates {
    /// Primitives in ascending order; for a tree, only the unbounded ones.
    pub ids: Vec<u32>,
    /// Whether bounded primitives are found through the tree.
    pub tree: bool,
    /// How often in a row it came to that lately.
    pub vain: u32,
}

/// So many searches in vain, and only each [`AGAIN`]th is made until one finds something.
const VAIN: u32 = 16;
const AGAIN: u32 = 8;

impl Candidates {
    /// Collects what `keep` and `keep_plane` don't exclude, for so many `rays`; of many, those that it pays to look for. For none
    /// nothing is looked for in the tree.
    #[inline(always)]
    pub fn gather(
        &mut self,
        world: &World,
        rays: usize,
        keep: impl FnMut(&Bounds) -> bool,
        mut keep_plane: impl FnMut([f64; 3], f64) -> bool,
    ) {
        self.ids.clear();
        self.ids.extend(world.unbounded.iter().filter(|p| keep_plane(p.n, p.offset)).map(|p| p.id));
        let planes = self.ids.len();
        let ids = &mut self.ids;
        self.tree = false;
        let tree = &mut self.tree;
        let most = if rays == 0 { 0 } else { 1 + rays / RAYS_A_NODE };
        let ended = world.bvh.gather(most, keep, |id| {
            *tree = ids.len() >= planes + LONGEST_LIST;
            if !*tree {
                ids.push(id);
            }
            !*tree
        });
        self.tree |= !ended;
        if self.tree {
            self.ids.truncate(planes);
        }
        self.ids.sort_unstable();
    }

    /// As [`gather`](Candidates::gather), but where this found too much again and again it is mostly left to the tree at once: what
    /// rays may meet is asked for many batches, one after another.
    #[inline(always)]
    pub fn gather_if_it_pays(
        &mut self,
        world: &World,
        rays: usize,
        keep: impl FnMut(&Bounds) -> bool,
        keep_plane: impl FnMut([f64; 3], f64) -> bool,
    ) {
        let rays = if self.vain > VAIN && !self.vain.is_multiple_of(AGAIN) { 0 } else { rays };
        self.gather(world, rays, keep, keep_plane);
        self.vain = if self.tree { self.vain.wrapping_add(1) } else { 0 };
    }

    /// Whether nothing can be met.
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty() && !self.tree
    }
}

/// Finds what the rays of a batch may meet: the cone of their directions, from the ball around their origins. Gives that
/// region.
#[inline(always)]
pub fn narrow_to_batch<L: Lane>(world: &World, rays: &RayBatch<L::Elem>, out: &mut Candidates) -> Beam {
    let margin = margin(L::UNIT_ROUNDOFF);
    let mut origins = Span::new();
    let mut sum = [L::zero(); 3];
    for g in (0..rays.len).step_by(L::WIDTH) {
        let live = L::Mask::first((rays.len - g).min(L::WIDTH));
        origins.hold(live, load3::<L>(&rays.o, g));
        // Not brought to one length: any axis does, for what counts is measured from it.
        let d = load3::<L>(&rays.d, g);
        sum = three!(c => sum[c] + L::select(live, d[c], L::zero()));
    }
    let sum = each3!(sum, x => total(x));
    let len = (sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]).sqrt();
    let axis = each3!(sum, x => x / len);
    let along: [L; 3] = splat3(axis);
    let mut cos = L::one();
    for g in (0..rays.len).step_by(L::WIDTH) {
        let live = L::Mask::first((rays.len - g).min(L::WIDTH));
        let d = load3::<L>(&rays.d, g);
        let cosine = dot(d, along) / dot(d, d).sqrt();
        // A NaN, of rays whose middle is no direction, is kept: it stands for all directions.
        cos = L::select(live & !cos.le(cosine), cosine, cos);
    }
    let origins = origins.bounds();
    let beam = Beam { origins, axis, cos: least(cos) };
    let cone = beam.cone(margin);
    out.gather_if_it_pays(
        world,
        rays.len,
        #[inline(always)]
        |b| cone.may_meet(b),
        |n, offset| cone.may_reach(&origins, n, offset),
    );
    beam
}
