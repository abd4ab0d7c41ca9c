//! Whether a ray meets a quadric at all, within the last bits of a tangent.
//!
//! A line is drawn first and then the quadric that it touches, its radius or slope computed in double-double and rounded: so the
//! shape is within 2^-52 of touching, and its neighbours among the numbers lie on both sides.

use super::draw::{Draw, unit};
use super::specimen::Specimen;
use super::tally::Tally;
use super::{Bound, Check, Figure, Outcome, Size};
use crate::math::real::{axpy, dot, minus};
use crate::math::{Affine, Dd, Real};
use crate::render::shape::{Kind, Ring, Tube};
use glam::DVec3;

/// The check.
pub const CHECK: Check = Check { name: "tangents", what: "whether rays that all but touch a shape meet it", run };

/// A family of quadrics with a measure of which a line touches one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Touched {
    /// By its radius.
    Sphere,
    /// By its radius.
    Cylinder,
    /// By its slope.
    Cone,
    /// By the radius of its tube.
    Torus,
}

/// All of them.
pub const TOUCHED: [Touched; 4] = [Touched::Sphere, Touched::Cylinder, Touched::Cone, Touched::Torus];

/// A line and a shape that it all but touches.
pub struct Grazing {
    /// The shape.
    pub shape: Specimen,
    /// What the shape is, in its frame.
    pub kind: Kind,
    /// The frame's origin.
    pub centre: [f64; 3],
    /// The line's origin.
    pub o: [f64; 3],
    /// The line's direction.
    pub d: [f64; 3],
    /// |1 − l²/R²|: l the distance of the line, R the shape's radius; for a cone, of slopes.
    pub gap: f64,
}

/// Draws a line from up to 2·10^6 radii away, and the shape that it all but touches; `None` where the line touches no part
/// of the shape that is drawn.
pub fn draw(touched: Touched, case: u64) -> Option<Grazing> {
    let mut x = Draw::new("tangent", 8 * case + touched as u64);
    let distance = x.magnitude(0, 21);
    let size = x.magnitude(-200, 200);
    let centre = x.vector().map(|c| c * size * distance);
    let target = axpy(size, x.direction(), centre);
    let o = axpy(distance * size, x.direction(), target);
    let d = unit(minus(target, o));
    // The line from the shape's point of view, as exactly as double-double is.
    let from: [Dd; 3] = std::array::from_fn(|i| Dd::new(o[i]) - Dd::new(centre[i]));
    let along = d.map(Dd::new);
    let across = |v: [Dd; 3]| [v[0], Dd::default(), v[2]];
    let steps = [1, 8, 64][x.below(3) as usize];
    let mut near = |exact: Dd| {
        let rounded = x.neighbour(exact.hi, steps);
        let ratio = exact / Dd::new(rounded);
        (rounded, (Dd::ONE - ratio * ratio).hi.abs())
    };
    let (kind, gap) = match touched {
        Touched::Sphere => {
            let (r, gap) = near(distance_to_origin(from, along)?.1);
            (Kind::Sphere(r), gap)
        }
        Touched::Cylinder => {
            let (t, l) = distance_to_origin(across(from), across(along))?;
            let (r, gap) = near(l);
            let y = (from[1] + t * along[1]).hi;
            (Kind::Tube(Tube { radius: r, slope: 0.0, bottom: y - size, top: y + size, caps: true }), gap)
        }
        Touched::Cone => {
            // a·c = b² as an equation for the slope squared is linear: what is of second order cancels.
            let (t0, m) = {
                let t = distance_to_origin(from, along)?.0;
                (t, std::array::from_fn::<Dd, 3, _>(|i| from[i] + t * along[i]))
            };
            let (dd, md, mm) = (dot(across(along), along), dot(across(m), along), dot(across(m), m));
            let (my, dy) = (m[1], along[1]);
            let two = Dd::new(2.0);
            let below = dd * my * my + mm * dy * dy - two * md * my * dy;
            let slope2 = (dd * mm - md * md) / below;
            let (slope, gap) = near(slope2.sqrt());
            // Where it touches: on the lower nappe, which is the one that a pointed cone has.
            let tau = (slope2 * my * dy - md) / (dd - slope2 * dy * dy);
            let y = (m[1] + tau * along[1]).hi;
            if !(y < 0.0 && (0.01..100.0).contains(&slope) && (t0 + tau).hi.is_finite()) {
                return None;
            }
            (Kind::Tube(Tube { radius: 0.0, slope: -slope, bottom: 2.0 * y, top: 0.0, caps: true }), gap)
        }
        Touched::Torus => {
            let (tube, gap) = near(distance_to_circle(from, along, size)?);
            if !(tube < 0.9 * size && tube > 1e-3 * size) {
                return None;
            }
            (Kind::Ring(Ring::new(size, tube)), gap)
        }
    };
    let shape = Specimen::framed(kind, &Affine::translation(DVec3::from_array(centre)));
    Some(Grazing { shape, kind, centre, o, d, gap })
}

/// Where the line m + t·d is nearest to the origin, and how near.
fn distance_to_origin(m: [Dd; 3], d: [Dd; 3]) -> Option<(Dd, Dd)> {
    let d2 = dot(d, d);
    let t = -(dot(m, d) / d2);
    let p: [Dd; 3] = std::array::from_fn(|i| m[i] + t * d[i]);
    let l = dot(p, p).sqrt();
    (l.hi > 0.0 && l.hi.is_finite()).then_some((t, l))
}

/// The least distance of the line m + t·d to the circle of radius `r` around the y axis, near where it is nearest to the
/// origin. By Newton's method on the derivative: what is off in t is squared in the distance.
fn distance_to_circle(m: [Dd; 3], d: [Dd; 3], r: f64) -> Option<Dd> {
    let mut t = distance_to_origin(m, d)?.0;
    let r = Dd::new(r);
    let (dd, flat) = (dot(d, d), d[0] * d[0] + d[2] * d[2]);
    for _ in 0..40 {
        let p: [Dd; 3] = std::array::from_fn(|i| m[i] + t * d[i]);
        let rho = (p[0] * p[0] + p[2] * p[2]).sqrt();
        let away = p[0] * d[0] + p[2] * d[2];
        // Half the squared distance is (|p|² + r²)/2 − r·ρ; its first and second derivative by t.
        let slope = dot(p, d) - r * away / rho;
        let bend = dd - r * (flat - away * away / (rho * rho)) / rho;
        let (step, w) = (slope / bend, rho - r);
        if !(bend.hi > 0.0) {
            return None;
        }
        if step.hi.abs() <= 1e-25 * r.hi {
            return Some((w * w + p[1] * p[1]).sqrt()).filter(|l| l.hi > 0.0);
        }
        t = t - step;
    }
    None
}

const WRONG: usize = 0;
const CLOSE: usize = 1;

fn run(size: Size) -> Outcome {
    let rays = size.pick(2_000, 30_000);
    let mut outcome = Outcome { cases: rays * TOUCHED.len() as u64, ..Outcome::default() };
    for touched in TOUCHED {
        let tally = Tally::of(rays, |case, tally| {
            let Some(line) = draw(touched, case) else { return };
            tally.tried += 1;
            tally.wrong[CLOSE] += (line.gap < CLOSE_BY) as u64;
            let found = line.shape.line(line.o, line.d, None).as_slice().len();
            let exact = line.shape.line(line.o.map(Dd::new), line.d.map(Dd::new), None).as_slice().len();
            if found != exact {
                tally.worst = Real::max(line.gap, tally.worst);
                tally.fail(WRONG, case, || format!("{touched:?} {case}: {found} crossings for {exact}"));
            }
        });
        let (all, close) = (tally.tried, tally.wrong[CLOSE]);
        outcome.figures.push(tally.never(WRONG, format!("{touched:?}: wrong verdicts of {all}")));
        outcome.figures.push(Figure {
            what: format!("{touched:?}: largest |1 − l²/R²| of a wrong verdict"),
            value: tally.worst / f64::EPSILON,
            unit: "2^-52",
            bound: Bound::AtMost(2.0),
            histogram: None,
        });
        let what = format!("{touched:?}: lines within 2^-51 of touching");
        outcome.figures.push(super::tally::count(what, close, Bound::AtLeast((rays / 20) as f64)));
        outcome.first_failure = outcome.first_failure.or(tally.first.map(|f| f.1));
    }
    outcome
}

/// 2^-51: inside, even a right kernel may be wrong in plain `f64`.
const CLOSE_BY: f64 = 2.0 * f64::EPSILON;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_are_right_at_tangents() {
        let outcome = run(Size::Quick);
        assert!(outcome.is_within(), "{outcome:#?}");
    }
}
