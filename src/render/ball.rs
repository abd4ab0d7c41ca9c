//! Shapes that rays pass by, told by a ball around them: a fraction of what a kernel costs, and most registers of rays meet few of the
//! shapes that they are tested against.

use super::bounds::larger;
use super::frame::{Axes, Frame, LinearMap};
use super::shape::{Kind, Primitive};
use crate::math::real::{dot, three};
use crate::math::{Mask, Real};

/// Unit roundoffs, of the square of the distance from the ray's origin to the ball's centre, that a ray must pass by at: far more
/// than the dozen operations here and those of the kernels make of it, and little beside what most rays pass by at.
const MARGIN: f64 = (1u64 << 10) as f64;

/// The square of the radius of a ball around the primitive's frame's origin that holds all of it; `None` where there is none, or
/// where the frame doesn't keep lengths.
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

/// The radius of a shape that is a ball in the world too: a stretched one isn't.
#[inline(always)]
pub fn ball_radius(kind: &Kind, frame: &Frame) -> Option<f64> {
    match (kind, frame.axes) {
        (Kind::Sphere(r), Axes::Cyclic(_)) => Some(*r),
        _ => None,
    }
}

/// A ball that holds all of a primitive. These stand by themselves, for they are all that most rays ask of most primitives: half a
/// cache line of the two or three that a primitive takes.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct Ball {
    /// Relative to the camera.
    centre: [f64; 3],
    /// Of the radius; infinite where there is no such ball.
    square: f64,
}

impl Ball {
    /// The ball around `primitive`.
    #[inline(always)]
    pub fn around(primitive: &Primitive, maps: &[LinearMap]) -> Ball {
        let Frame { centre, centre_lo, .. } = primitive.frame;
        // What the centre is off by makes it larger: of two points far from the eye, but near each other, that is much of the
        // difference.
        let off = centre_lo[0].abs() + centre_lo[1].abs() + centre_lo[2].abs();
        if let Some(r) = ball_radius(&primitive.kind, &primitive.frame) {
            return Ball { centre, square: (r + off) * (r + off) };
        }
        Ball::around_other(primitive, maps, off)
    }

    /// The ball around what is none itself, and whose centre is off by so much.
    #[inline(never)]
    fn around_other(primitive: &Primitive, maps: &[LinearMap], off: f64) -> Ball {
        let centre = primitive.frame.centre;
        let square = match radius_square(primitive, maps) {
            Some(square) if off > 0.0 => (square.sqrt() + off) * (square.sqrt() + off),
            Some(square) => square,
            None => f64::INFINITY,
        };
        Ball { centre, square }
    }

    /// Whether there is a ball: of planes and triangles there is none.
    #[inline(always)]
    pub fn is_there(&self) -> bool {
        self.square < f64::INFINITY
    }

    /// Which rays, given by origin and direction, surely miss the primitive at every t > 0, and by far. Of each lane by itself: what
    /// it says of a ray is the same among whatever others.
    #[inline(always)]
    pub fn passed_by<R: Real, const AT_EYE: bool>(&self, (o, d): ([R; 3], [R; 3])) -> R::Mask {
        if !self.is_there() {
            return R::Mask::splat(false);
        }
        let to = three!(i => {
            let centre = R::splat(self.centre[i]);
            if AT_EYE { centre } else { centre - o[i] }
        });
        let (along, away, length) = (dot(to, d), dot(to, to), dot(d, d));
        let margin = MARGIN * R::UNIT_ROUNDOFF;
        let (sure, reach) = (R::splat(1.0 - margin) * away, R::splat((1.0 + margin) * self.square));
        // Squares of lengths in the world, times that of the direction's; no infinite one says anything.
        let whole = sure * length;
        let beside = (reach * length).lt(whole - along * along) & whole.lt(R::splat(f64::INFINITY));
        let behind = along.lt(R::zero()) & reach.lt(sure);
        beside | behind
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Affine;
    use crate::math::fun::{cos_deg as cos, sin_deg as sin};
    use crate::render::frame::Frame;
    use crate::render::shape::Tube;
    use glam::DVec3;

    #[test]
    fn rays_that_meet_a_shape_do_not_pass_by() {
        let tube = Tube { radius: 0.5, slope: 0.25, bottom: -1.0, top: 2.0, caps: true };
        let kinds =
            [Kind::Sphere(1.5), Kind::Cuboid([1.0, 2.0, 0.5]), Kind::Tube(tube), Kind::Disc { r: 1.0, hole: 0.0 }];
        let (mut missed, mut met) = (0, 0);
        for (kind, k) in kinds.into_iter().zip(0..) {
            let turned = Affine::rotation_about(DVec3::new(0.3, 1.0, 0.2), 40.0 * k as f64);
            let placed = Affine::translation(DVec3::new(3.0, 1e6, -2.0)).compose(&turned);
            let mut maps = Vec::new();
            let frame = Frame::new(&placed, |m| {
                maps.push(m);
                0
            });
            let primitive = Primitive { kind, frame, material: 0, space: Primitive::NO_SPACE };
            for i in 0..400 {
                let turn = i as f64 * 21.0;
                let o = [3.0 + 6.0 * cos(turn), 1e6 + 3.0 * sin(2.3 * turn), -2.0 + 6.0 * sin(turn)];
                let aim = [3.0 + 3.0 * cos(1.7 * turn), 1e6 + 2.0 * sin(3.1 * turn), -2.0 + 2.0 * cos(turn)];
                let d = [0, 1, 2].map(|c| (aim[c] - o[c]) * (1.0 + i as f64));
                let passes = Ball::around(&primitive, &maps).passed_by::<f64, false>((o, d)).0;
                let mut hit = false;
                let tables = crate::render::shape::primitive::Tables { maps: &maps, triangles: &[] };
                primitive.crossings::<f64, false>(
                    tables,
                    o,
                    d,
                    None,
                    &mut |t: f64, _: f64, ok: crate::math::real::Bool| {
                        hit |= ok.0 && t > 0.0;
                    },
                );
                assert!(!(passes && hit), "{kind:?}: {o:?} {d:?}");
                (missed, met) = (missed + passes as u32, met + hit as u32);
            }
        }
        assert!(missed > 400 && met > 200, "{missed} {met}");
    }
}
