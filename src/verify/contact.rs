//! Two surfaces almost in contact: no ray slips through the second, and the gap between them is neither lost nor widened.
//!
//! The outer shell is the inner one moved outwards by g, from 64 ulp of the coordinates upwards.

use super::draw::{Draw, power, unit};
use super::respawn::{STANDS, Stand, leaving, size_of};
use super::specimen::Specimen;
use super::tally::{Tally, ulp};
use super::{Check, Outcome, Size};
use crate::math::real::minus;
use crate::render::bounds::larger;
use crate::render::shape::primitive::{Surface, spawn_point};
use crate::render::shape::{Kind, Ring, Tube};
use glam::DVec3;

/// The check.
pub const CHECK: Check = Check { name: "contact", what: "two surfaces with a gap of a few ulp between them", run };

/// The narrowest gap, in ulp of the largest coordinate.
const NARROWEST: i32 = 6;
/// The widest, as a power of two.
const WIDEST: i32 = 20;

const NAMES: [&str; 4] = ["spheres", "boxes", "cylinders", "tori"];

/// A shape grown by `g`.
fn shell(which: usize, s: f64, g: f64) -> Kind {
    match which {
        0 => Kind::Sphere(s + g),
        1 => Kind::Cuboid([s + g, 0.5 * s + g, 0.75 * s + g]),
        2 => Kind::Tube(Tube { radius: 0.75 * s + g, slope: 0.0, bottom: -g, top: s + g, caps: true }),
        _ => Kind::Ring(Ring::new(s, 0.25 * s + g)),
    }
}

const LEAK: usize = 0;
const GAP: usize = 1;

fn run(size: Size) -> Outcome {
    let cases = size.pick(500, 100_000);
    let mut outcome = Outcome::default();
    for (which, name) in NAMES.into_iter().enumerate() {
        let stands = STANDS.into_iter().filter(|s| *s != Stand::Stretched);
        let tallies = stands.map(|stand| Tally::of(cases, |case, tally| between(which, stand, case, tally)));
        let all = tallies.fold(Tally::default(), Tally::plus);
        outcome.figures.push(all.never(LEAK, format!("{name}: rays that slipped through a shell")));
        outcome.figures.push(all.never(GAP, format!("{name}: gaps seen half or half again as wide")));
        // Both surfaces' points and a start's distance go into a gap, each within the bounds for rays that leave.
        outcome.figures.push(all.p99(format!("{name}: error of the gap, p99"), 32.0));
        outcome.figures.push(all.tried(format!("{name}: rays tried"), cases));
        outcome.cases += all.tried;
        outcome.first_failure = outcome.first_failure.or(all.first.map(|f| f.1));
    }
    outcome
}

/// From a point of the inner shell to the outer one, straight and anyhow, and straight back from there.
fn between(which: usize, stand: Stand, case: u64, tally: &mut Tally) {
    let mut x = Draw::new("contact", 64 * case + 4 * which as u64 + stand as u64);
    let s = power(x.below(200) as i32 - 100);
    let place = stand.place(&mut x, s);
    let reach = place.shift_f64().iter().map(|c| c.abs()).fold(0.0, larger) + 2.0 * s;
    // A power of two, as the sizes are: so the shell is wider by just that.
    let g = power(NARROWEST + x.below((WIDEST - NARROWEST) as u64) as i32) * ulp(reach);
    if g > 0.1 * s {
        return;
    }
    let inner = Specimen::framed(shell(which, s, 0.0), &place);
    let outer = Specimen::framed(shell(which, s, g), &place);
    let (from, at) = (x.vector().map(|c| 4.0 * s * c), x.vector().map(|c| 0.9 * s * c));
    let [from, at] = [from, at].map(|p| place.apply(DVec3::from_array(p)).to_array());
    let Some(out) = Leaving::after(&inner, from, unit(minus(at, from)), 1.0) else { return };

    let around = outer.ray(out.from, leaving(&mut x, out.n, 1.0), None);
    let straight = outer.ray(out.from, out.n, None);
    tally.tried += 2;
    let is_torus = which == 3;
    for found in [around, straight].map(|c| c.as_slice().len()) {
        if found != 1 && !(is_torus && found % 2 == 1) {
            tally.fail(LEAK, case, || format!("{which} {stand:?} {case}: {found} crossings of the outer shell"));
        }
    }
    if let Some(&(t, _)) = straight.as_slice().first() {
        see(t + out.offset, g, &inner, &out, case, tally);
    }
    let Some(back) = Leaving::after(&outer, out.from, out.n, -1.0) else { return };
    tally.tried += 1;
    match inner.ray(back.from, back.n.map(|c| -c), None).as_slice().first() {
        Some(&(t, _)) => see(t + back.offset, g, &outer, &back, case, tally),
        None => tally.fail(LEAK, case, || format!("{which} {stand:?} {case}: past the inner shell")),
    }
}

/// Judges a gap that was seen.
fn see(gap: f64, g: f64, shape: &Specimen, start: &Leaving, case: u64, tally: &mut Tally) {
    tally.off((gap - g) / ulp(size_of(shape, start.p)));
    if (gap - g).abs() > 0.5 * g {
        tally.fail(GAP, case, || format!("{case}: {gap} for {g}"));
    }
}

/// A start on a surface.
struct Leaving {
    p: [f64; 3],
    n: [f64; 3],
    offset: f64,
    /// Where rays to its side begin.
    from: [f64; 3],
}

impl Leaving {
    /// Where the ray meets the shape first, and from there to `side`.
    fn after(shape: &Specimen, o: [f64; 3], d: [f64; 3], side: f64) -> Option<Leaving> {
        let &(t, part) = shape.ray(o, d, None).as_slice().first()?;
        let Surface { p, n, offset, .. } = shape.surface(o, d, t, part);
        Some(Leaving { p, n, offset, from: spawn_point(p, n, side * offset) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn narrow_gaps_stay() {
        let outcome = run(Size::Quick);
        assert!(outcome.is_within(), "{outcome:#?}");
    }
}
