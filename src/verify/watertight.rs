//! Triangles that share an edge or a corner: a ray there meets exactly one of them, not none and not two.
//!
//! Meshes are fans around a corner, seen from their front, and a closed convex solid, seen from inside. Rays are aimed at
//! corners and at points of edges, half of them on meshes whose coordinates are small whole numbers, where they meet the corner
//! or edge exactly.

use super::draw::{Draw, power, unit};
use super::specimen::Specimen;
use super::tally::{Tally, count};
use super::{Bound, Check, Outcome, Size};
use crate::math::real::{axpy, minus, scaled};

/// The check.
pub const CHECK: Check = Check { name: "watertight", what: "rays at the shared edges and corners of triangles", run };

/// What rays are aimed at.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Aim {
    Edge,
    Corner,
}

/// Where mesh and ray are.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Where {
    /// Both near the world's origin.
    Near,
    /// Both far from it: the place where Embree's own test was known to fail.
    Far,
    /// The mesh near, the ray's origin 10^5 to 10^9 of its sizes away.
    Distant,
    /// All lengths times 10^-12.
    Tiny,
}

const WHERE: [Where; 4] = [Where::Near, Where::Far, Where::Distant, Where::Tiny];
const FAR: [f64; 3] = [148_376.0, 1_234.0, -223_423.0];

const MISS: usize = 0;
const TWICE: usize = 1;
const TIE: usize = 2;

fn run(size: Size) -> Outcome {
    let rays = size.pick(2_500, 250_000);
    let mut outcome = Outcome::default();
    for aim in [Aim::Edge, Aim::Corner] {
        let mut ties = 0;
        for place in WHERE {
            let tally = Tally::of(rays, |case, tally| shoot(aim, place, case, tally));
            let what = format!("{aim:?}s, {place:?}").to_lowercase();
            outcome.figures.push(tally.never(MISS, format!("{what}: rays that slipped through")));
            outcome.figures.push(tally.never(TWICE, format!("{what}: rays that met two triangles")));
            ties += tally.wrong[TIE];
            outcome.cases += tally.tried;
            outcome.first_failure = outcome.first_failure.or(tally.first.map(|f| f.1));
        }
        let what = format!("{aim:?}s: rays on meshes of whole numbers").to_lowercase();
        outcome.figures.push(count(what, ties, Bound::AtLeast(rays as f64)));
    }
    outcome
}

/// One mesh and one ray.
fn shoot(aim: Aim, place: Where, case: u64, tally: &mut Tally) {
    let mut x = Draw::new("watertight", 16 * case + 4 * aim as u64 + place as u64);
    let whole = x.once_in(2);
    let mesh = if x.once_in(4) { Mesh::solid(&mut x) } else { Mesh::fan(&mut x, whole) };
    let at = match aim {
        Aim::Corner => mesh.inner,
        Aim::Edge => {
            let share = if whole { 0.5 } else { x.unit() };
            axpy(share, minus(mesh.rim[x.below(mesh.rim.len() as u64) as usize], mesh.inner), mesh.inner)
        }
    };
    // Towards the front of the mesh, at less than 60° to its axis; distances that keep whole numbers whole, half of the time.
    let away = match place {
        Where::Distant => {
            if whole {
                power(17 + x.below(13) as i32)
            } else {
                x.magnitude(17, 30)
            }
        }
        _ => {
            if whole {
                power(x.below(5) as i32)
            } else {
                x.magnitude(-2, 5)
            }
        }
    };
    let aside = |x: &mut Draw| if whole { x.below(13) as f64 / 8.0 - 0.75 } else { x.between(-0.8, 0.8) };
    let along = match (whole, x.below(4)) {
        (_, 0) => [0.0 * x.sign(), 0.0 * x.sign(), 1.0],
        _ => [aside(&mut x), aside(&mut x), 1.0],
    };
    let origin = match mesh.closed {
        true => mesh.hidden,
        false => axpy(away, along, at),
    };
    let (shift, scale) = match place {
        Where::Far => (FAR, 1.0),
        // A power of two near 10^-12 keeps whole numbers whole.
        Where::Tiny => ([0.0; 3], if whole { power(-40) } else { 1e-12 }),
        _ => ([0.0; 3], 1.0),
    };
    let put = |p: [f64; 3]| axpy(scale, p, shift);
    let turn = x.below(3) as usize;
    let mirror = [0; 3].map(|_| x.sign());
    let turned = |p: [f64; 3]| -> [f64; 3] { std::array::from_fn(|i| mirror[i] * p[(i + turn) % 3]) };
    let o = turned(put(origin));
    let d = minus(turned(put(at)), o);
    let d = if whole { d } else { unit(d) };
    let met = mesh.triangles.iter().filter(|t| {
        // Each starts with any of its corners, and may go round either way: the rule for ties can't lean on that.
        let (first, flip) = (x.below(3) as usize, x.once_in(2));
        let corner = |i: usize| turned(put(t[(first + if flip { 3 - i } else { i }) % 3]));
        let triangle = Specimen::triangle(std::array::from_fn(corner));
        !triangle.ray(o, d, None).as_slice().is_empty()
    });
    let met = met.count();
    tally.tried += 1;
    tally.wrong[TIE] += whole as u64;
    if met != 1 {
        let kind = if met == 0 { MISS } else { TWICE };
        tally.fail(kind, case, || format!("{aim:?} {place:?} {case}: {met} triangles met from {o:?} along {d:?}"));
    }
}

/// Triangles around a corner.
struct Mesh {
    triangles: Vec<[[f64; 3]; 3]>,
    /// The corner that they share.
    inner: [f64; 3],
    /// The corners that it is joined to.
    rim: Vec<[f64; 3]>,
    /// Whether it goes all around `hidden`.
    closed: bool,
    /// A point inside a closed mesh.
    hidden: [f64; 3],
}

impl Mesh {
    /// A fan whose front looks along +z, flat enough that no ray from there meets it twice.
    fn fan(x: &mut Draw, whole: bool) -> Mesh {
        // Around the corner and once more around, so that a ray may miss its aim by rounding and still be above the mesh.
        let circle = [
            (1, 0),
            (3, 1),
            (1, 1),
            (1, 3),
            (0, 1),
            (-1, 3),
            (-1, 1),
            (-3, 1),
            (-1, 0),
            (-3, -1),
            (-1, -1),
            (-1, -3),
            (0, -1),
            (1, -3),
            (1, -1),
            (3, -1),
        ];
        let step = 1 + x.below(4) as usize;
        let spread = |x: &mut Draw, n: i32| if whole { n as f64 * 0.125 } else { n as f64 * x.between(0.1, 0.15) };
        let height = |x: &mut Draw| if whole { x.below(3) as f64 / 128.0 } else { x.between(0.0, 0.02) };
        let inner = if whole { [0.5, -0.25, 0.0] } else { scaled(0.7, x.vector()) };
        let rim: Vec<[f64; 3]> = circle
            .iter()
            .step_by(step)
            .map(|&(a, b)| {
                let k = spread(x, 1);
                [inner[0] + k * a as f64, inner[1] + k * b as f64, inner[2] + height(x)]
            })
            .collect();
        let triangles = (0..rim.len()).map(|i| [inner, rim[i], rim[(i + 1) % rim.len()]]).collect();
        Mesh { triangles, inner, rim, closed: false, hidden: inner }
    }

    /// An octahedron with unequal corners, its faces divided at a corner each.
    fn solid(x: &mut Draw) -> Mesh {
        let r: [f64; 6] = [0; 6].map(|_| x.below(8) as f64 / 8.0 + 1.0);
        let corner = |axis: usize, up: bool| -> [f64; 3] {
            let mut p = [0.0; 3];
            p[axis] = if up { r[2 * axis] } else { -r[2 * axis + 1] };
            p
        };
        let mut triangles = Vec::new();
        for k in 0..8u32 {
            let up = |axis: u32| k >> axis & 1 == 1;
            let (a, b, c) = (corner(0, up(0)), corner(1, up(1)), corner(2, up(2)));
            // Outside stays outside: an odd number of reflections turns the order round.
            triangles.push(if k.count_ones() % 2 == 1 { [a, b, c] } else { [a, c, b] });
        }
        let inner = corner(2, true);
        let rim = vec![corner(0, true), corner(0, false), corner(1, true), corner(1, false)];
        let hidden = x.vector().map(|c| (c * 16.0).round() / 64.0);
        Mesh { triangles, inner, rim, closed: true, hidden }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_ray_meets_one_triangle() {
        let outcome = run(Size::Quick);
        assert!(outcome.is_within(), "{outcome:#?}");
    }
}
