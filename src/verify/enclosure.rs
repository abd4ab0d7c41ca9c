//! Intervals are sound: whatever values their inputs take, the results of exact arithmetic and of `f64` lie within. First
//! operation by operation, then whole kernels: rays and surfaces.

use super::draw::Draw;
use super::tally::Tally;
use super::{Bound, Check, Figure, Outcome};
use crate::math::real::Bool;
use crate::math::tri::Tri;
use crate::math::{Affine, Dd, Interval, Real};
use crate::render::frame::Frame;
use crate::render::shape::primitive::Tables;
use crate::render::shape::{Kind, Primitive, Ring, TriangleData, Tube};
use glam::DVec3;

/// The check of intervals.
pub const CHECK: Check = Check {
    name: "intervals",
    what: "exact and f64 results lie within interval results: operations, crossings, surfaces",
    run: |size| {
        let operations = tally(size.pick(200_000, 10_000_000), operation::<0>);
        let (n_kernels, certain) = (size.pick(40_000, 2_000_000), "kernels: crossings surely there");
        let kernels = tally(n_kernels, kernel);
        Outcome {
            cases: size.pick(200_000, 10_000_000) + n_kernels,
            figures: vec![
                Figure::none_of("operations: results outside", operations.wrong[0]),
                Figure::none_of("kernels: results outside", kernels.wrong[0]),
                // A box that is always undecided would prove nothing.
                Figure::new(certain, kernels.tried as f64, "", Bound::AtLeast(n_kernels as f64 / 20.0)),
            ],
            first_failure: operations.first.or(kernels.first).map(|(_, say)| say),
        }
    },
};

/// What one case found: how many crossings were certain, or what was wrong.
type Found = Result<u64, String>;

fn tally(cases: u64, try_one: impl Fn(u64) -> Found + Sync) -> Tally {
    Tally::of(cases, |case, tally| match try_one(case) {
        Ok(certain) => tally.tried += certain,
        Err(what) => tally.fail(0, case, || format!("case {case}: {what}")),
    })
}

impl Draw {
    /// An awkward number: short ones, whose sums are ties; powers of two and their neighbours; any.
    fn number(&mut self) -> f64 {
        let short = self.between(-8.0, 8.0).round();
        match self.below(6) {
            0 => short,
            1 => short * f64::EPSILON * [0.25, 0.5, 1.0, 0.125][self.below(4) as usize],
            2 => self.sign() * [1.0, 2.0][self.below(2) as usize],
            3 => self.sign() * (1.0 + f64::EPSILON * (self.below(5) as f64 - 2.0)),
            4 => self.between(-1.0, 1.0),
            _ => self.sign() * self.magnitude(-100, 100),
        }
    }
    /// An interval and a number in it.
    fn interval<const M: u8>(&mut self) -> (Interval<M>, f64) {
        let x = self.number();
        let (below, above) = match self.below(4) {
            0 => (x, x),
            1 => (x.next_down(), x.next_up()),
            2 => (x, x + self.unit() * x.abs()),
            _ => (x - self.unit(), x + self.unit()),
        };
        (Interval::new(below, above), x)
    }
}

/// One operation on random intervals.
fn operation<const M: u8>(case: u64) -> Found {
    let mut draw = Draw::new("operations on intervals", case);
    let ((a, x), (b, y), (c, z)) = (draw.interval::<M>(), draw.interval::<M>(), draw.interval::<M>());
    let (dx, dy, dz) = (Dd::new(x), Dd::new(y), Dd::new(z));
    let holds = |name: &str, i: Interval<M>, exact: Dd, rounded: f64| {
        let (lo, hi) = (Dd::new(i.lo), Dd::new(i.hi));
        // Dd is exact to 2^-104 or so; what it can't tell from a bound lies on it.
        let slack = exact.abs() * Dd::new(4.0 * Dd::UNIT_ROUNDOFF);
        let inside = lo.le(exact + slack).0 && (exact - slack).le(hi).0;
        if i.contains(rounded) && (inside || !exact.hi.is_finite()) {
            Ok(0)
        } else {
            Err(format!("{name} of {x:?} {y:?} {z:?} gives {rounded:?}, exactly {exact:?}, beside {i:?}"))
        }
    };
    holds("sum", a + b, dx + dy, x + y)?;
    holds("difference", a - b, dx - dy, x - y)?;
    holds("product", a * b, dx * dy, x * y)?;
    if y != 0.0 {
        holds("quotient", a / b, dx / dy, x / y)?;
    }
    if x >= 0.0 {
        holds("root", a.sqrt(), dx.sqrt(), x.sqrt())?;
    }
    holds("fused product and sum", a.mul_add(b, c), dx * dy + dz, x.mul_add(y, z))?;
    let ((s, e), (fs, fe)) = (a.two_sum(b), x.two_sum(y));
    holds("sum with its error", s, dx + dy, fs)?;
    holds("error of a sum", e, Dd::default(), fe)?;
    let ((p, e), (fp, fe)) = (a.two_prod(b), x.two_prod(y));
    holds("product with its error", p, dx * dy, fp)?;
    holds("error of a product", e, Dd::default(), fe)?;
    // The determinant of nearly parallel vectors, too.
    let (w, q) = if draw.once_in(2) { (c, z) } else { (a, x) };
    let exact = dx * dy - Dd::new(q) * dz;
    holds("determinant", a.difference_of_products(b, w, c), exact, x.difference_of_products(y, q, z))?;
    holds("magnitude", a.abs(), dx.abs(), x.abs())?;
    holds("floor", a.floor(), dx.floor(), x.floor())?;
    holds("smaller", a.min(b), if x < y { dx } else { dy }, Real::min(x, y))?;
    holds("larger", a.max(b), if y < x { dx } else { dy }, Real::max(x, y))?;
    holds("sign", a.copysign(b), dx.copysign(dy), x.copysign(y))?;
    let comparisons = [(a.lt(b), x < y), (a.le(b), x <= y), (a.same(b), x == y)];
    for (i, (may, is)) in comparisons.into_iter().enumerate() {
        if (may.certain && !is) || (!may.possible && is) {
            return Err(format!("comparison {i} of {x:?} and {y:?}: {may:?}"));
        }
    }
    holds("choice", Interval::select(a.lt(b), a, c), if x < y { dx } else { dz }, if x < y { x } else { z })
}

fn shape(draw: &mut Draw) -> Kind {
    let caps = draw.once_in(2);
    match draw.below(9) {
        0 => Kind::Sphere(1.0),
        1 => Kind::Plane,
        2 => Kind::Disc { r: 1.0, hole: 0.2 },
        3 => Kind::Cuboid([1.0, 0.5, 0.7]),
        4 => Kind::Tube(Tube { radius: 0.8, slope: 0.0, bottom: 0.0, top: 1.5, caps }),
        5 => Kind::Tube(Tube { radius: 0.0, slope: -0.6, bottom: -1.4, top: 0.0, caps }),
        6 => Kind::Tube(Tube { radius: 0.9, slope: -0.3, bottom: 0.0, top: 1.2, caps }),
        7 => Kind::Ring(Ring::new(0.8, 0.3)),
        _ => Kind::Triangle(0),
    }
}

/// Rays from a random box in random directions to a random shape.
fn kernel(case: u64) -> Found {
    type Box3 = [Interval; 3];
    let mut draw = Draw::new("kernels on intervals", case);
    let kind = shape(&mut draw);
    let mut place = Affine::translation(DVec3::from_array(draw.vector()));
    if draw.once_in(2) {
        let stretch = DVec3::new(1.0, 0.4 + draw.unit(), 0.5 + draw.unit());
        place = place.compose(&draw.rotation()).compose(&Affine::scaling(stretch));
    }
    let mut maps = Vec::new();
    let frame = Frame::new(&place, |m| {
        maps.push(m);
        0
    });
    let corners = [draw.vector(), draw.vector(), draw.vector()];
    let edge = |i: usize| DVec3::from_array(corners[i]) - DVec3::from_array(corners[0]);
    let n = edge(1).cross(edge(2)).normalize_or(DVec3::Y).to_array();
    let triangles = [TriangleData { v: corners, n, shading: None }];
    let primitive = Primitive { kind, frame, material: 0, space: Primitive::NO_SPACE };
    let tables = Tables { maps: &maps, triangles: &triangles };

    let far = draw.magnitude(0, 13);
    let (start, aim) = (draw.vector().map(|x| x * far), draw.vector());
    let middle: [f64; 3] = std::array::from_fn(|i| aim[i] - start[i]);
    let (wide_o, wide_d) = (draw.magnitude(-44, -3), draw.magnitude(-44, -3));
    let around = |draw: &mut Draw, v: [f64; 3], width: f64| -> (Box3, [f64; 3]) {
        let of = |x: f64| Interval::new(x - width * x.abs(), x + width * x.abs());
        let boxes = v.map(of);
        (boxes, boxes.map(|b| (b.lo + (b.hi - b.lo) * draw.unit()).clamp(b.lo, b.hi)))
    };
    let ((bo, o), (bd, d)) = (around(&mut draw, start, wide_o), around(&mut draw, middle, wide_d));

    let (mut enclosed, mut numbers) = (Vec::new(), Vec::new());
    let mut keep = |t: Interval, part: Interval, valid: Tri| enclosed.push((t, part, valid));
    primitive.crossings::<Interval, false>(tables, bo, bd, None, &mut keep);
    let mut keep = |t: f64, part: f64, valid: Bool| numbers.push((t, part, valid.0));
    primitive.crossings::<f64, false>(tables, o, d, None, &mut keep);

    let say = |what: &str| Err(format!("{kind:?} in {frame:?}, ray {o:?} {d:?} in {bo:?} {bd:?}: {what}"));
    for &(t, part, valid) in &numbers {
        let holds = |e: &&(Interval, Interval, Tri)| e.2.possible && e.0.contains(t) && e.1.contains(part);
        let Some(e) = enclosed.iter().find(holds) else {
            if valid {
                return say(&format!("crossing at {t:?}, part {part}, is in none of {enclosed:?}"));
            }
            continue;
        };
        if !valid {
            continue;
        }
        let surface = primitive.surface::<f64, false>(tables, o, d, t, part);
        let region = primitive.surface::<Interval, false>(tables, bo, bd, e.0, e.1);
        let pairs = (0..3).flat_map(|i| [(region.p[i], surface.p[i]), (region.n[i], surface.n[i])]);
        for (i, (b, x)) in pairs.chain([(region.offset, surface.offset)]).enumerate() {
            if !b.contains(x) {
                return say(&format!("number {i} of the surface, {x:?}, beside {b:?}"));
            }
        }
    }
    let certain = enclosed.iter().filter(|e| e.2.certain);
    for (t, ..) in certain.clone() {
        if !numbers.iter().any(|n| n.2 && t.contains(n.0)) {
            return say(&format!("the crossing in {t:?} is called certain and isn't there: {numbers:?}"));
        }
    }
    Ok(certain.count() as u64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Single;
    use crate::verify::Size;

    #[test]
    fn intervals_are_sound() {
        let outcome = (CHECK.run)(Size::Quick);
        assert!(outcome.is_within(), "{outcome:?}");
    }

    /// Values outside their interval in so many random operations, in which one bound of one operation is two numbers too
    /// narrow; see [`Interval`].
    fn violations<const MUTANT: u8>(cases: u64) -> u64 {
        tally(cases, operation::<MUTANT>).wrong[0]
    }

    #[test]
    fn no_bound_could_be_two_numbers_narrower() {
        macro_rules! mutants {
            ($($m:literal)*) => {{
                $(assert_ne!(violations::<$m>(50_000), 0, "mutant {} goes unnoticed", $m);)*
                [$($m),*].len() as u8
            }};
        }
        let tried = mutants!(1 2 3 4 5 6 7 8 9 10 11 12 13 14);
        assert_eq!(tried, Interval::<0>::MUTANTS);
        assert_eq!(Single::magnitude(Interval::<0>::new(-2.0, 1.0)), 2.0);
    }
}
