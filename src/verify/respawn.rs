//! Rays that leave a surface: they never meet it again by rounding, nor another surface in the very same place, though no
//! distance is called too short; and they start only a few ulp off it.

use super::draw::{Draw, unit};
use super::specimen::Specimen;
use super::tally::{Tally, ulp};
use super::{Bound, Check, Outcome, Size};
use crate::math::real::{Bool, axpy, dot, minus};
use crate::math::{Affine, Dd};
use crate::render::bounds::larger;
use crate::render::ray::Own;
use crate::render::shape::primitive::spawn_point;
use crate::render::shape::{Kind, Ring, Tube};
use glam::DVec3;

/// The check.
pub const CHECK: Check =
    Check { name: "leaving", what: "rays that leave a surface don't meet it again by rounding", run };

/// What a ray that leaves a surface can meet of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Build {
    /// Convex and closed: nothing outwards, one way out inwards.
    Solid,
    /// A convex side without its caps: nothing outwards, at most one crossing inwards.
    Open,
    /// Nothing at all.
    Flat,
    /// Closed but not convex: an even number of crossings outwards, an odd one inwards.
    Hollow,
}

/// Every shape, by name, about as large as `s`.
pub(super) fn shapes(s: f64) -> [(&'static str, Kind, Build); 12] {
    let tube = |radius: f64, slope: f64, bottom: f64, top: f64, caps: bool| {
        Kind::Tube(Tube { radius: radius * s, slope, bottom: bottom * s, top: top * s, caps })
    };
    [
        ("sphere", Kind::Sphere(s), Build::Solid),
        ("box", Kind::Cuboid([s, 0.5 * s, 0.7 * s]), Build::Solid),
        ("cylinder", tube(0.8, 0.0, 0.0, 1.5, true), Build::Solid),
        ("cone", tube(0.0, -0.6, -1.4, 0.0, true), Build::Solid),
        ("needle", tube(0.0, -0.15, -1.4, 0.0, true), Build::Solid),
        ("frustum", tube(0.9, -0.3, 0.0, 1.2, true), Build::Solid),
        ("open cylinder", tube(0.8, 0.0, 0.0, 1.5, false), Build::Open),
        ("funnel", tube(0.3, 0.7, 0.0, 1.0, false), Build::Open),
        ("plane", Kind::Plane, Build::Flat),
        ("disc", Kind::Disc { r: s, hole: 0.2 * s }, Build::Flat),
        ("torus", Kind::Ring(Ring::new(0.8 * s, 0.3 * s)), Build::Hollow),
        ("triangle", Kind::Triangle(0), Build::Flat),
    ]
}

/// How shapes stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Stand {
    /// Along the axes.
    Moved,
    /// Turned.
    Turned,
    /// Turned, and its axes scaled by up to 8 to each other.
    Stretched,
}

pub(super) const STANDS: [Stand; 3] = [Stand::Moved, Stand::Turned, Stand::Stretched];

impl Stand {
    /// A place for a shape of size `s`, from 0 to 2^20 sizes away from the world's origin.
    pub(super) fn place(self, x: &mut Draw, s: f64) -> Affine {
        let far = if x.once_in(4) { 0.0 } else { x.magnitude(-2, 20) * s };
        let moved = Affine::translation(DVec3::from_array(x.vector()) * far);
        let turned = |x: &mut Draw| moved.compose(&x.rotation());
        match self {
            Stand::Moved => moved,
            Stand::Turned => turned(x),
            Stand::Stretched => {
                let axes = [0; 3].map(|_| x.magnitude(-2, 1));
                turned(x).compose(&Affine::scaling(DVec3::from_array(axes)))
            }
        }
    }
}

/// A shape of any size from 2^-100 to 2^100, somewhere; its place, and its size.
pub(super) fn placed(which: usize, stand: Stand, x: &mut Draw) -> (Specimen, Build, Affine, f64) {
    let s = x.magnitude(-100, 100);
    let place = stand.place(x, s);
    let (_, kind, build) = shapes(s)[which];
    let shape = match kind {
        Kind::Triangle(_) => Specimen::triangle([0; 3].map(|_| {
            let corner = DVec3::from_array(x.vector()) * s;
            place.apply(corner).to_array()
        })),
        _ => Specimen::framed(kind, &place),
    };
    (shape, build, place, s)
}

/// A point on or in the shape.
pub(super) fn inside(shape: &Specimen, place: &Affine, x: &mut Draw) -> [f64; 3] {
    if let [a, b, c] = shape.corners() {
        let (v, w) = (x.unit(), x.unit());
        return axpy(v * w, minus(*c, *b), axpy(v, minus(*b, *a), *a));
    }
    let v = x.in_ball();
    let (radius, y) = match shape.primitive.kind {
        Kind::Tube(t) => {
            let y = x.between(t.bottom, t.top);
            (t.radius + t.slope * y, y)
        }
        Kind::Ring(ring) => ((ring.r + 0.5 * ring.tube) / ring.scale, v[1] * ring.tube / ring.scale),
        Kind::Sphere(r) | Kind::Disc { r, .. } => (r, r * v[1]),
        Kind::Cuboid(half) => (half[1], half[1] * v[1]),
        Kind::Plane | Kind::Triangle(_) | Kind::Mesh(_) => (1.0, 0.0),
    };
    let flat = matches!(shape.primitive.kind, Kind::Plane | Kind::Disc { .. });
    let p = [radius * v[0], if flat { 0.0 } else { y }, radius * v[2]];
    place.apply(DVec3::from_array(p)).to_array()
}

/// The largest coordinate that goes into a point of a shape: the point's own or the centre's.
pub(super) fn size_of(shape: &Specimen, p: [f64; 3]) -> f64 {
    let all = p.iter().chain(&shape.primitive.frame.centre);
    let corners = shape.corners().iter().flatten();
    all.chain(corners).map(|x| x.abs()).fold(0.0, larger)
}

/// A direction on the side of `n` that `side` says: half of them anywhere, half of them nearly along the surface.
pub(super) fn leaving(x: &mut Draw, n: [f64; 3], side: f64) -> [f64; 3] {
    let d = x.direction();
    let up = dot(d, n);
    let rise = if x.once_in(2) { up.abs() } else { x.magnitude(-40, -1) };
    std::array::from_fn(|i| d[i] + (side * rise - up) * n[i])
}

const OWN: usize = 0;
const TWIN: usize = 1;
const INEXACT: usize = 2;

fn run(size: Size) -> Outcome {
    let cases = size.pick(400, 100_000);
    let mut outcome = Outcome::default();
    for (which, (name, ..)) in shapes(1.0).iter().enumerate() {
        let mut all = Tally::default();
        for stand in STANDS {
            let tally = Tally::of(cases, |case, tally| leave(which, stand, case, tally));
            let how = format!("{name}, {stand:?}: distance of the start from the surface").to_lowercase();
            outcome.figures.push(tally.mean(format!("{how}, mean"), 8.0));
            outcome.figures.push(tally.p99(format!("{how}, p99"), 32.0));
            all = all.plus(tally);
        }
        outcome.figures.push(all.never(OWN, format!("{name}: wrong crossings with itself")));
        outcome.figures.push(all.never(TWIN, format!("{name}: wrong crossings with a twin in its place")));
        outcome.figures.push(all.never(INEXACT, format!("{name}: other crossings than in double-double")));
        outcome.cases += all.tried;
        outcome.first_failure = outcome.first_failure.or(all.first.map(|f| f.1));
    }
    let least = cases * 36; // a third of the rays that are aimed at a shape meet it, and four leave it
    let what = "rays that left a surface".to_string();
    outcome.figures.push(super::tally::count(what, outcome.cases, Bound::AtLeast(least as f64)));
    outcome
}

/// One ray to a shape, and from where it meets it four that leave.
fn leave(which: usize, stand: Stand, case: u64, tally: &mut Tally) {
    let mut x = Draw::new("leaving", 64 * case + 4 * which as u64 + stand as u64);
    let (shape, build, place, s) = placed(which, stand, &mut x);
    let at = inside(&shape, &place, &mut x);
    let o = axpy(s * x.magnitude(2, 24), x.direction(), at);
    let d = unit(minus(at, o));
    let Some(&(t, part)) = shape.ray(o, d, None).as_slice().first() else { return };
    let start = shape.surface(o, d, t, part);
    tally.off(start.offset / ulp(size_of(&shape, start.p)));
    for side in [1.0, 1.0, -1.0, -1.0] {
        let dir = leaving(&mut x, start.n, side);
        let from = spawn_point(start.p, start.n, side * start.offset);
        let own = Own { here: Bool(true), part, outward: Bool(side > 0.0) };
        // Of the shape itself, the crossing at the start is taken out, so that needs no distance at all.
        let (at_once, again) = (shape.ray(start.p, dir, Some(own)), shape.ray(from, dir, Some(own)));
        let twin = shape.ray(from, dir, None);
        tally.tried += 1;
        for (kind, found) in [(OWN, at_once), (OWN, again), (TWIN, twin)] {
            if !is_right(build, side, found.as_slice().len()) {
                let say = || format!("{which} {stand:?} {case}, side {side}: {found:?}, offset {}", start.offset);
                tally.fail(kind, case, say);
            }
        }
        if build == Build::Hollow && case.is_multiple_of(8) {
            let exact = shape.ray(from.map(Dd::new), dir.map(Dd::new), None);
            if exact.as_slice().len() != twin.as_slice().len() {
                tally.fail(INEXACT, case, || format!("{which} {stand:?} {case}, side {side}: {twin:?} for {exact:?}"));
            }
        }
    }
}

/// Whether so many crossings are what a ray can meet that leaves to this side.
fn is_right(build: Build, side: f64, n: usize) -> bool {
    match (build, side > 0.0) {
        (Build::Solid, true) | (Build::Open, true) | (Build::Flat, _) => n == 0,
        (Build::Solid, false) => n == 1,
        (Build::Open, false) => n <= 1,
        (Build::Hollow, true) => n.is_multiple_of(2),
        (Build::Hollow, false) => !n.is_multiple_of(2),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_leaves_a_surface_is_off_it() {
        let outcome = run(Size::Quick);
        assert!(outcome.is_within(), "{outcome:#?}");
    }
}
