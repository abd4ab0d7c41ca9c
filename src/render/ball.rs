//! Shapes that rays pass by, told by a ball around them: a fraction of what a kernel costs, and most registers of rays meet few of the
//! shapes that they are tested against.

use super::bounds::larger;
use super::frame::{Axes, LinearMap};
use super::ray::Line;
use super::shape::{Kind, Primitive};
use crate::math::real::{dot, three};
use crate::math::{Mask, Real};

/// Unit roundoffs, of the origin's distance, that a ray must pass by at: far more than a dozen operations make of it, a kernel's
/// own errors included, and nothing to the sizes of shapes.
const MARGIN: f64 = (1u64 << 16) as f64;

/// The square of the radius of a ball around the primitive's frame's origin that holds all of it; `None` where there is none, or
/// where the frame doesn't keep lengths.
#[inline(always)]
fn radius_square(primitive: &Primitive, maps: &[LinearMap]) -> Option<f64> {
    if let Axes::Linear(m) = primitive.frame.axes
        && !maps[m as usize].rigid
    {
        return None;
    }
    match &primitive.kind {
        Kind::Sphere(r) => Some(r * r),
        Kind::Disc { r, .. } => Some(r * r),
        Kind::Cuboid([x, y, z]) => Some(x * x + y * y + z * z),
        Kind::Tube(t) => {
            let end = |y: f64| (t.radius + t.slope * y) * (t.radius + t.slope * y) + y * y;
            Some(larger(end(t.bottom), end(t.top)))
        }
        Kind::Ring(ring) => {
            let reach = (ring.r + ring.tube) / ring.scale;
            Some(reach * reach)
        }
        Kind::Plane | Kind::Triangle(_) | Kind::Mesh(_) => None,
    }
}

/// Which rays surely miss the primitive at every t > 0, and by far.
#[inline(always)]
pub fn passing_by<R: Real, const AT_EYE: bool>(primitive: &Primitive, maps: &[LinearMap], line: &Line<R>) -> R::Mask {
    let Some(square) = radius_square(primitive, maps) else { return R::Mask::splat(false) };
    let centre = three!(i => R::splat(primitive.frame.centre[i]));
    let to = if AT_EYE { centre } else { three!(i => centre[i] - line.o[i]) };
    let (along, away) = (dot(to, line.d), dot(to, to));
    let margin = MARGIN * R::UNIT_ROUNDOFF;
    // Both sides are squares of lengths in the world.
    let (sure, reach) = (R::splat(1.0 - margin) * away, R::splat((1.0 + margin) * square));
    let beside = reach.lt(sure - (along * along) * line.per_square);
    let behind = along.lt(R::zero()) & reach.lt(sure);
    beside | behind
}
