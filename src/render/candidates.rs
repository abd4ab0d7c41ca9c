//! What a batch of rays may meet: found once for all of them, so that each tests only what is near.

use super::batch::RayBatch;
use super::bounds::{Bounds, smaller};
use super::cull::{bounds_of, margin};
use super::footprint::Beam;
use super::world::World;
use crate::math::real::{each3, three};
use crate::math::{Elem, Lane};

/// Longest list of candidates that every ray of a batch tests in turn; beyond it each ray goes through the tree. Measured over
/// the examples, one ray at a time: 3 to 6 are equally good, 12 costs a fifth more, 24 to 48 up to half.
pub const LONGEST_LIST: usize = 4;

/// What a batch of rays may meet.
#[derive(Clone, Debug, Default)]
pub struct Candidates {
    /// Primitives in ascending order; for a tree, only the unbounded ones.
    pub ids: Vec<u32>,
    /// Whether bounded primitives are found through the tree.
    pub tree: bool,
}

impl Candidates {
    /// Collects what `keep` and `keep_plane` don't exclude.
    #[inline(always)]
    pub fn gather(
        &mut self,
        world: &World,
        keep: impl FnMut(&Bounds) -> bool,
        mut keep_plane: impl FnMut([f64; 3], f64) -> bool,
    ) {
        self.ids.clear();
        self.ids.extend(world.unbounded.iter().filter(|p| keep_plane(p.n, p.offset)).map(|p| p.id));
        let planes = self.ids.len();
        let ids = &mut self.ids;
        self.tree = false;
        let tree = &mut self.tree;
        world.bvh.gather(keep, |id| {
            *tree = ids.len() >= planes + LONGEST_LIST;
            if !*tree {
                ids.push(id);
            }
            !*tree
        });
        if self.tree {
            self.ids.truncate(planes);
        }
        self.ids.sort_unstable();
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
    let origins = bounds_of(&rays.o, rays.len);
    let unit = |i: usize| -> [f64; 3] {
        let d = three!(c => rays.d[c][i].to_f64());
        let len = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
        each3!(d, x => x / len)
    };
    let sum = (0..rays.len).map(unit).fold([0.0; 3], |s, d| [s[0] + d[0], s[1] + d[1], s[2] + d[2]]);
    let len = (sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]).sqrt();
    let axis = sum.map(|x| x / len);
    let cosine = |d: [f64; 3]| d[0] * axis[0] + d[1] * axis[1] + d[2] * axis[2];
    let cos = (0..rays.len).map(|i| cosine(unit(i))).fold(1.0, smaller);
    let beam = Beam { origins, axis, cos };
    let cone = beam.cone(margin);
    out.gather(world, |b| cone.may_meet(b), |n, offset| cone.may_reach(&origins, n, offset));
    beam
}
