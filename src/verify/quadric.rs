//! Crossings of quadrics: how far off t is, and that none is missing, from near by to 10^9 radii away.
//!
//! The yardstick is the same kernel in double-double, which `tests/oracle.rs` holds against exact rational arithmetic. Given are
//! the ray's and the shape's numbers as they are stored: of an ellipsoid, which is a sphere in a stretched frame, that is the
//! rounded matrix that leads into the frame.

use super::draw::{Draw, unit};
use super::specimen::Specimen;
use super::tally::{Tally, ulp};
use super::{Check, Outcome, Size};
use crate::math::real::{axpy, minus};
use crate::math::{Affine, Dd};
use crate::render::shape::{Kind, Tube};
use glam::DVec3;

/// The check.
pub const CHECK: Check =
    Check { name: "quadrics", what: "where a ray meets spheres, ellipsoids, cylinders and cones, near and far", run };

/// Distance of the ray's origin from the shape's, in radii.
pub const DISTANCES: [f64; 7] = [1.5, 5.0, 15.0, 30.0, 1e3, 1.5e6, 1.5e9];

/// A family of quadrics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Family {
    /// Round.
    Sphere,
    /// Stretched, the axes up to 1:1000 to each other.
    Ellipsoid,
    /// Without caps, as high as wide.
    Cylinder,
    /// A hundred times as high as thick, without caps.
    Pole,
    /// Half a right angle between axis and side.
    Cone,
    /// 0.6° between axis and side.
    Needle,
    /// A cone without its tip.
    Frustum,
}

/// All of them.
pub const FAMILIES: [Family; 7] =
    [Family::Sphere, Family::Ellipsoid, Family::Cylinder, Family::Pole, Family::Cone, Family::Needle, Family::Frustum];

/// Slopes of 45° and 0.6°.
const STEEP: f64 = 1.0;
const SLIM: f64 = 0.010_472_4;

impl Family {
    fn name(self) -> &'static str {
        match self {
            Family::Sphere => "sphere",
            Family::Ellipsoid => "ellipsoid",
            Family::Cylinder => "cylinder",
            Family::Pole => "pole",
            Family::Cone => "cone",
            Family::Needle => "needle cone",
            Family::Frustum => "frustum",
        }
    }

    /// The bound on p99 of the error of t, in ulp, at a distance in radii.
    fn at_most(self, distance: f64) -> f64 {
        let pointed = matches!(self, Family::Cone | Family::Needle | Family::Frustum);
        match distance {
            d if d < 15.0 => 8.0,
            d if pointed && d < 30.0 => 8.0,
            d if pointed && d < 1e3 => 5.0,
            _ => 1.0,
        }
    }
}

/// A shape and a line that passes through its extent.
pub struct Aimed {
    /// The shape.
    pub shape: Specimen,
    /// Origin.
    pub o: [f64; 3],
    /// Direction, of length 1 but for rounding.
    pub d: [f64; 3],
}

/// Draws a shape of any size from 2^-400 to 2^400 and a line through it from `distance` radii away.
pub fn draw(family: Family, distance: f64, case: u64) -> Aimed {
    let mut x = Draw::new(family.name(), case ^ distance.to_bits());
    let r = x.magnitude(-400, 400);
    let tube =
        |radius: f64, slope: f64, bottom: f64, top: f64| Kind::Tube(Tube { radius, slope, bottom, top, caps: false });
    let (kind, width, middle) = match family {
        Family::Sphere => (Kind::Sphere(r), [r; 3], 0.0),
        Family::Ellipsoid => (Kind::Sphere(1.0), [0.0; 3].map(|_| r * x.magnitude(-9, 0) * 0.5), 0.0),
        Family::Cylinder => (tube(r, 0.0, 0.0, r), [r, 0.5 * r, r], 0.5 * r),
        Family::Pole => (tube(0.01 * r, 0.0, 0.0, r), [0.01 * r, 0.5 * r, 0.01 * r], 0.5 * r),
        Family::Cone => (tube(0.0, -STEEP, -r, 0.0), [0.5 * r, 0.5 * r, 0.5 * r], -0.5 * r),
        Family::Needle => (tube(0.0, -SLIM, -r, 0.0), [0.5 * SLIM * r, 0.5 * r, 0.5 * SLIM * r], -0.5 * r),
        Family::Frustum => (tube(r, -0.5, 0.0, r), [0.7 * r, 0.5 * r, 0.7 * r], 0.5 * r),
    };
    // The frame's origin is anywhere as far from the world's as the ray's origin is from the shape.
    let centre = x.vector().map(|c| c * r * distance);
    let mut place = Affine::translation(DVec3::from_array(centre));
    if family == Family::Ellipsoid {
        place = place.compose(&x.rotation()).compose(&Affine::scaling(DVec3::from_array(width)));
    }
    let inside = x.in_ball();
    let target = match family {
        Family::Ellipsoid => place.apply(DVec3::from_array(inside)).to_array(),
        _ => [0, 1, 2].map(|i| centre[i] + width[i] * inside[i] + if i == 1 { middle } else { 0.0 }),
    };
    let heart = [centre[0], centre[1] + middle, centre[2]];
    let along = if x.once_in(8) { x.axis() } else { x.direction() };
    let (o, d) = if along.contains(&0.0) {
        // Beside the middle by what the target is.
        let by: [f64; 3] = std::array::from_fn(|i| if along[i] == 0.0 { target[i] } else { heart[i] });
        (axpy(-distance * r, along, by), along)
    } else {
        let o = axpy(-distance * r, along, heart);
        (o, unit(minus(target, o)))
    };
    Aimed { shape: Specimen::framed(kind, &place), o, d }
}

/// What a line has too few or too many of.
const LOST: usize = 0;
const SPURIOUS: usize = 1;

fn run(size: Size) -> Outcome {
    let rays = size.pick(500, 100_000);
    let mut outcome = Outcome::default();
    for family in FAMILIES {
        let mut all = Tally::default();
        for distance in DISTANCES {
            let tally = Tally::of(rays, |case, tally| compare(family, distance, case, tally));
            let what = format!("{}, distance/radius {distance:?}: error of t, p99", family.name());
            outcome.figures.push(tally.p99(what, family.at_most(distance)));
            all = all.plus(tally);
        }
        let name = family.name();
        outcome.figures.push(all.never(LOST, format!("{name}: crossings lost")));
        outcome.figures.push(all.never(SPURIOUS, format!("{name}: crossings that there aren't")));
        // Most lines that pass through the extent cross; through a needle's box not quite half.
        outcome.figures.push(all.tried(format!("{name}: crossings tried"), rays * 6));
        outcome.cases += rays * DISTANCES.len() as u64;
        outcome.first_failure = outcome.first_failure.or(all.first.map(|f| f.1));
    }
    outcome
}

/// One line, in `f64` against double-double.
fn compare(family: Family, distance: f64, case: u64, tally: &mut Tally) {
    let Aimed { shape, o, d } = draw(family, distance, case);
    let found = shape.line(o, d, None);
    let exact = shape.line(o.map(Dd::new), d.map(Dd::new), None);
    let (n, wanted) = (found.as_slice().len(), exact.as_slice().len());
    tally.tried += wanted as u64;
    if n != wanted {
        let kind = if n < wanted { LOST } else { SPURIOUS };
        return tally.fail(kind, case, || format!("{family:?} {distance:?} {case}: {n} crossings for {wanted}"));
    }
    for ((t, _), (yardstick, _)) in found.as_slice().iter().zip(exact.as_slice()) {
        tally.off((Dd::new(*t) - *yardstick).hi / ulp(yardstick.hi));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quadrics_keep_their_bounds() {
        let outcome = run(Size::Quick);
        assert!(outcome.is_within(), "{outcome:#?}");
    }
}
