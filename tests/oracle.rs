//! The yardstick of the programme of proofs, the kernels in double-double, held against exact rational arithmetic.
//!
//! A crossing is a root of a polynomial whose coefficients are exact rationals of the numbers given. That there is a root next
//! to a stated one is shown by a change of sign, and how many there are by Sturm's theorem: so nothing here is rounded, and
//! no root is computed.

use dashu_ratio::Relaxed;
use rtdsl::math::Dd;
use rtdsl::math::Real;
use rtdsl::math::hash::KeyedHash;
use rtdsl::render::shape::{Kind, Tube};
use rtdsl::verify::specimen::Specimen;
use rtdsl::verify::{quadric, tangent, torus};

/// Coefficients, constant first.
type Poly = Vec<Relaxed>;

fn exact(x: f64) -> Relaxed {
    Relaxed::try_from(x).expect("finite")
}
fn exact_dd(x: Dd) -> Relaxed {
    exact(x.hi) + exact(x.lo)
}
fn add(a: &Poly, b: &Poly) -> Poly {
    let at = |p: &Poly, i: usize| p.get(i).cloned().unwrap_or(Relaxed::ZERO);
    (0..a.len().max(b.len())).map(|i| at(a, i) + at(b, i)).collect()
}
fn times(a: &Poly, b: &Poly) -> Poly {
    let mut out = vec![Relaxed::ZERO; a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            out[i + j] += x * y;
        }
    }
    out
}
fn scaled(s: Relaxed, a: &Poly) -> Poly {
    a.iter().map(|x| x * &s).collect()
}
fn square(a: &Poly) -> Poly {
    times(a, a)
}
fn at(a: &Poly, t: &Relaxed) -> Relaxed {
    a.iter().rev().fold(Relaxed::ZERO, |y, c| y * t + c)
}
fn sign(x: &Relaxed) -> i32 {
    match x.cmp(&Relaxed::ZERO) {
        std::cmp::Ordering::Less => -1,
        std::cmp::Ordering::Equal => 0,
        std::cmp::Ordering::Greater => 1,
    }
}

/// The number of different roots between `lo` and `hi`, neither a root; of all of them for `None` (Sturm).
fn roots_between(p: &Poly, ends: Option<(&Relaxed, &Relaxed)>) -> usize {
    let trimmed = |mut p: Poly| {
        while p.last().is_some_and(|c| sign(c) == 0) {
            p.pop();
        }
        p
    };
    let first = trimmed(p.clone());
    let slope = trimmed((1..first.len()).map(|i| Relaxed::from(i as u32) * &first[i]).collect());
    let mut chain = vec![first, slope];
    while chain.last().is_some_and(|p| p.len() > 1) {
        let (a, b) = (&chain[chain.len() - 2], &chain[chain.len() - 1]);
        let mut rest = a.clone();
        while rest.len() >= b.len() {
            let factor = rest[rest.len() - 1].clone() / &b[b.len() - 1];
            let shift = rest.len() - b.len();
            for (i, c) in b.iter().enumerate() {
                rest[i + shift] -= &factor * c;
            }
            rest.pop();
        }
        let rest = trimmed(rest);
        if rest.is_empty() {
            break;
        }
        chain.push(rest.iter().map(|c| -c.clone()).collect());
    }
    let changes = |signs: Vec<i32>| {
        let signs: Vec<i32> = signs.into_iter().filter(|s| *s != 0).collect();
        signs.windows(2).filter(|w| w[0] != w[1]).count()
    };
    let at_end = |end: Option<&Relaxed>, side: i32| {
        changes(
            chain
                .iter()
                .filter(|p| !p.is_empty())
                .map(|p| match end {
                    Some(t) => sign(&at(p, t)),
                    None => sign(&p[p.len() - 1]) * if p.len() % 2 == 0 { side } else { 1 },
                })
                .collect(),
        )
    };
    at_end(ends.map(|e| e.0), -1) - at_end(ends.map(|e| e.1), 1)
}

/// The ray's coordinates in the shape's frame as polynomials of t, exactly, by the map as it is stored.
fn local(shape: &Specimen, o: [f64; 3], d: [f64; 3]) -> [Poly; 3] {
    let frame = &shape.primitive.frame;
    let world: [Poly; 3] =
        std::array::from_fn(|i| vec![exact(o[i]) - exact(frame.centre[i]) - exact(frame.centre_lo[i]), exact(d[i])]);
    match shape.map() {
        None => world,
        Some(map) => std::array::from_fn(|r| {
            (0..3).fold(vec![], |sum, c| add(&sum, &scaled(exact(map.local_from_world[r][c]), &world[c])))
        }),
    }
}

/// The form of a shape along a ray; and, of a tube, where the ray is between its ends.
fn form(shape: &Specimen, o: [f64; 3], d: [f64; 3]) -> (Poly, Option<(Relaxed, Relaxed)>) {
    let p = local(shape, o, d);
    let flat = add(&square(&p[0]), &square(&p[2]));
    match shape.primitive.kind {
        Kind::Sphere(r) => (add(&add(&flat, &square(&p[1])), &vec![-(exact(r) * exact(r))]), None),
        Kind::Tube(Tube { radius, slope, bottom, top, .. }) => {
            let w = add(&vec![exact(radius)], &scaled(exact(slope), &p[1]));
            let to = |y: f64| (exact(y) - p[1][0].clone()) / p[1][1].clone();
            let ends = (sign(&p[1][1]) != 0).then(|| (to(bottom), to(top)));
            let ends = ends.map(|(a, b)| if a < b { (a, b) } else { (b, a) });
            (add(&flat, &scaled(exact(-1.0), &square(&w))), ends)
        }
        Kind::Ring(ring) => {
            let (r, tube) = (exact(ring.r / ring.scale), exact(ring.tube / ring.scale));
            let r2 = r.clone() * r;
            let k = add(&add(&flat, &square(&p[1])), &vec![r2.clone() - tube.clone() * tube]);
            (add(&square(&k), &scaled(exact(-4.0) * r2, &flat)), None)
        }
        _ => panic!("not a shape of these tests"),
    }
}

/// How far a stated root may be from an exact one, relatively: 2^-17 ulp of an `f64`.
const NEAR: f64 = 1.0 / (1u64 << 35) as f64 / (1u64 << 35) as f64;

/// The crossings in double-double: as many as there are roots, each next to one.
fn hold(shape: &Specimen, o: [f64; 3], d: [f64; 3], what: &str) -> usize {
    let (poly, ends) = form(shape, o, d);
    let found = shape.line(o.map(Dd::new), d.map(Dd::new), None);
    let found: Vec<Relaxed> = found.as_slice().iter().map(|x| exact_dd(x.0)).collect();
    let is_level_tube = matches!(shape.primitive.kind, Kind::Tube(_)) && ends.is_none();
    if !(is_level_tube && found.is_empty()) {
        let wanted = roots_between(&poly, ends.as_ref().map(|e| (&e.0, &e.1)));
        assert_eq!(found.len(), wanted, "{what}: number of crossings");
    }
    for t in &found {
        let reach = t * exact(NEAR);
        let (before, after) = (sign(&at(&poly, &(t - &reach))), sign(&at(&poly, &(t + &reach))));
        assert_ne!(before, after, "{what}: no root near {}", t.to_f64_fast());
    }
    found.len()
}

#[test]
fn quadrics_in_double_double_are_right() {
    let mut held = 0;
    for family in quadric::FAMILIES {
        for distance in quadric::DISTANCES {
            for case in 0..60 {
                let x = quadric::draw(family, distance, case);
                held += hold(&x.shape, x.o, x.d, &format!("{family:?}, {distance}, case {case}"));
            }
        }
    }
    assert!(held > 3_000, "{held}");
}

#[test]
fn tori_in_double_double_are_right() {
    let mut held = 0;
    for tube in torus::TUBES {
        for distance in torus::DISTANCES {
            for case in 0..40 {
                let x = torus::draw(tube, distance, case);
                held += hold(&x.shape, x.o, x.d, &format!("torus {tube}, {distance}, case {case}"));
            }
        }
    }
    assert!(held > 1_600, "{held}");
}

#[test]
fn verdicts_at_tangents_are_right_in_both_precisions() {
    let (mut met, mut missed) = (0, 0);
    for touched in tangent::TOUCHED {
        for case in 0..800 {
            let Some(x) = tangent::draw(touched, case) else { continue };
            let (p, _) = form(&x.shape, x.o, x.d);
            let wanted = match touched {
                // May be met elsewhere, too.
                tangent::Touched::Torus => roots_between(&p, None),
                _ if sign(&(&p[1] * &p[1] - exact(4.0) * &p[0] * &p[2])) >= 0 => 2,
                _ => 0,
            };
            let (fast, fine) = (x.shape.line(x.o, x.d, None), x.shape.line(x.o.map(Dd::new), x.d.map(Dd::new), None));
            assert_eq!(fast.as_slice().len(), wanted, "{touched:?} {case}, in f64");
            assert_eq!(fine.as_slice().len(), wanted, "{touched:?} {case}, in double-double");
            if wanted > 0 { met += 1 } else { missed += 1 }
        }
    }
    assert!(met > 500 && missed > 500, "{met} {missed}");
}

#[test]
fn double_double_operations_keep_their_roundoff() {
    let random = |i: u64, k: u64| {
        let key = KeyedHash::new().with_text("oracle").with(i).with(k);
        let scale = f64::from_bits((1023 - 60 + key.bits() % 120) << 52);
        Dd::new((key.with(1).unit() - 0.5) * scale) + Dd::new((key.with(2).unit() - 0.5) * scale * f64::EPSILON)
    };
    let keeps = |got: Dd, wanted: Relaxed, what: &str| {
        let (off, size) = (exact_dd(got) - &wanted, wanted * exact(Dd::UNIT_ROUNDOFF));
        assert!(&off * &off <= &size * &size, "{what}: {got:?}");
    };
    for i in 0..4_000 {
        let (a, b) = (random(i, 0), random(i, 1));
        let (x, y) = (exact_dd(a), exact_dd(b));
        keeps(a + b, &x + &y, "sum");
        keeps(a - b, &x - &y, "difference");
        keeps(a * b, &x * &y, "product");
        keeps(a / b, &x / &y, "quotient");
        // A root is judged by its square, which has twice its relative error.
        let root = exact_dd(a.abs().sqrt());
        let (square, wanted) = (&root * &root, exact_dd(a.abs()));
        let (off, size) = (square - &wanted, wanted * exact(2.0 * Dd::UNIT_ROUNDOFF));
        assert!(&off * &off <= &size * &size, "root of {a:?}");
    }
}
