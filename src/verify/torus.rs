//! Crossings of tori: none lost, none spurious, t as exact as a double-double kernel says.
//!
//! `tests/oracle.rs` holds that kernel against the exact number of roots and their exact signs in rational arithmetic.

use super::draw::{Draw, unit};
use super::specimen::Specimen;
use super::tally::{Tally, ulp};
use super::{Check, Outcome, Size};
use crate::math::real::{axpy, minus};
use crate::math::{Affine, Dd, fun};
use crate::render::shape::{Kind, Ring};
use glam::DVec3;

/// The check.
pub const CHECK: Check = Check { name: "tori", what: "where a ray meets thick and thin tori, near and far", run };

/// Radius of the tube to that of the ring.
pub const TUBES: [f64; 5] = [0.5, 0.25, 0.1, 0.01, 1e-3];
/// Distance of the ray's origin, in radii of the ring.
pub const DISTANCES: [f64; 4] = [3.0, 30.0, 1e3, 1e6];
/// Lines pass the middle of the tube within this share of its radius: beyond, they touch rather than cross.
const AIM: f64 = 0.9;

/// A torus and a line aimed at its tube.
pub struct Aimed {
    /// The shape.
    pub shape: Specimen,
    /// The torus.
    pub ring: Ring,
    /// Its centre.
    pub centre: [f64; 3],
    /// Origin of the line.
    pub o: [f64; 3],
    /// Its direction.
    pub d: [f64; 3],
    /// Where, roughly, it is within the tube.
    pub t_inside: f64,
}

/// Draws a torus of any size from 2^-200 to 2^200 and a line at its tube.
pub fn draw(tube: f64, distance: f64, case: u64) -> Aimed {
    let mut x = Draw::new("torus", case ^ tube.to_bits() ^ distance.to_bits().rotate_left(32));
    let r = x.magnitude(-200, 200);
    let centre = x.vector().map(|c| c * r * distance);
    let angle = x.between(0.0, 360.0);
    let (sin, cos) = (fun::sin_deg(angle), fun::cos_deg(angle));
    let off = x.in_ball().map(|v| v * AIM * tube);
    // Off the circle across it only: along it would be off by the circle's curvature.
    let target = [(1.0 + off[0]) * cos, off[1], (1.0 + off[0]) * sin];
    let target = axpy(r, target, centre);
    let along = if x.once_in(8) { x.axis() } else { x.direction() };
    let o = axpy(-distance * r, along, target);
    let d = if along.contains(&0.0) { along } else { unit(minus(target, o)) };
    let ring = Ring::new(r, tube * r);
    let shape = Specimen::framed(Kind::Ring(ring), &Affine::translation(DVec3::from_array(centre)));
    Aimed { shape, ring, centre, o, d, t_inside: distance * r }
}

const LOST: usize = 0;
const SPURIOUS: usize = 1;

fn run(size: Size) -> Outcome {
    // Every line has at least two crossings.
    let rays = size.pick(150, 2_500);
    let mut outcome = Outcome { cases: rays * (TUBES.len() * DISTANCES.len()) as u64, ..Outcome::default() };
    let mut all = Tally::default();
    for tube in TUBES {
        let mut of_tube = Tally::default();
        for distance in DISTANCES {
            of_tube = of_tube.plus(Tally::of(rays, |case, tally| compare(tube, distance, case, tally)));
        }
        outcome.figures.push(of_tube.p99(format!("tube/ring {tube:?}: error of t, p99"), 2.0));
        all = all.plus(of_tube);
    }
    outcome.figures.push(all.never(LOST, "crossings lost".into()));
    outcome.figures.push(all.never(SPURIOUS, "crossings that there aren't".into()));
    outcome.figures.push(all.tried("crossings tried".into(), outcome.cases * 2));
    outcome.first_failure = all.first.map(|f| f.1);
    outcome
}

/// One line, in `f64` against double-double.
fn compare(tube: f64, distance: f64, case: u64, tally: &mut Tally) {
    let Aimed { shape, o, d, t_inside, .. } = draw(tube, distance, case);
    let found = shape.line(o, d, None);
    let exact = shape.line(o.map(Dd::new), d.map(Dd::new), None);
    let (found, exact) = (found.as_slice(), exact.as_slice());
    tally.tried += exact.len() as u64;
    if found.len() != exact.len() {
        let kind = if found.len() < exact.len() { LOST } else { SPURIOUS };
        let say = || format!("tube {tube:?}, distance {distance:?}, {case}: {found:?} for {exact:?}");
        return tally.fail(kind, case, say);
    }
    // The way into the tube that was aimed at and the way out of it; the line may all but touch another side of the ring.
    let after = exact.iter().position(|x| x.0.hi > t_inside).unwrap_or(exact.len());
    for i in after.saturating_sub(1)..exact.len().min(after + 1) {
        tally.off((Dd::new(found[i].0) - exact[i].0).hi / ulp(exact[i].0.hi));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tori_keep_their_bounds() {
        let outcome = run(Size::Quick);
        assert!(outcome.is_within(), "{outcome:#?}");
    }
}
