//! Every shape's kernel, hit by random rays in random frames: what lies on a surface is on it, and what leaves it is off it.

use glam::DVec3;
use rtdsl::math::hash::KeyedHash;
use rtdsl::math::real::{Bool, axpy, dot};
use rtdsl::math::{Affine, Lane};
use rtdsl::render::frame::{Frame, LinearMap};
use rtdsl::render::ray::Own;
use rtdsl::render::shape::primitive::{Tables, spawn_point};
use rtdsl::render::shape::{Kind, Primitive, Ring, TriangleData, Tube};

/// Uniform in -1..1, by test case and purpose.
fn random(case: u64, k: u64) -> f64 {
    KeyedHash::new().with(case).with(k).unit() * 2.0 - 1.0
}
fn vector(case: u64, k: u64) -> DVec3 {
    DVec3::new(random(case, k), random(case, k + 1), random(case, k + 2))
}

/// A shape of unit size, its number of crossings with a line (at most), and whether it is convex and closed.
fn shapes() -> Vec<(&'static str, Kind, bool)> {
    let tube = |radius: f64, slope: f64, bottom: f64, top: f64, caps: bool| {
        Kind::Tube(Tube { radius, slope, bottom, top, caps })
    };
    vec![
        ("sphere", Kind::Sphere(1.0), true),
        ("plane", Kind::Plane, false),
        ("disc", Kind::Disc { r: 1.0, hole: 0.2 }, false),
        ("box", Kind::Cuboid([1.0, 0.5, 0.7]), true),
        ("cylinder", tube(0.8, 0.0, 0.0, 1.5, true), true),
        ("open cylinder", tube(0.8, 0.0, 0.0, 1.5, false), false),
        ("cone", tube(0.0, -0.6, -1.4, 0.0, true), true),
        ("needle", tube(0.0, -0.15, -1.4, 0.0, true), true),
        ("frustum", tube(0.9, -0.3, 0.0, 1.2, true), true),
        ("funnel", tube(0.3, 0.7, 0.0, 1.0, false), false),
        ("torus", Kind::Ring(Ring::new(0.8, 0.3)), false),
        ("triangle", Kind::Triangle(0), false),
    ]
}

/// Where a test case's shape stands: turned, perhaps stretched, at a distance of up to 10^6.
fn placement(case: u64) -> Affine {
    let far = [0.0, 1.0, 1e3, 1e6][case as usize % 4];
    let stretch = match case % 3 {
        0 => DVec3::ONE,
        1 => DVec3::splat(0.01),
        _ => DVec3::new(1.0, 0.3, 2.5),
    };
    Affine::translation(vector(case, 10) * far)
        .compose(&Affine::rotation_about(vector(case, 20), 360.0 * random(case, 30)))
        .compose(&Affine::scaling(stretch))
}

struct Case {
    primitive: Primitive,
    maps: Vec<LinearMap>,
    triangles: Vec<TriangleData>,
    place: Affine,
}

impl Case {
    fn new(kind: Kind, case: u64) -> Case {
        let place = placement(case);
        let mut maps = Vec::new();
        let frame = Frame::new(&place, |m| {
            maps.push(m);
            maps.len() as u32 - 1
        });
        let v = [DVec3::new(-1.0, 0.0, -0.6), DVec3::new(0.9, 0.1, -0.5), DVec3::new(0.0, -0.2, 1.0)]
            .map(|p| place.apply(p));
        let n = (v[1] - v[0]).cross(v[2] - v[0]).normalize().to_array();
        let triangles = vec![TriangleData { v: v.map(|p| p.to_array()), n, shading: None }];
        let primitive = Primitive { kind, frame, material: 0, space: Primitive::NO_SPACE };
        Case { primitive, maps, triangles, place }
    }
    fn tables(&self) -> Tables<'_> {
        Tables { maps: &self.maps, triangles: &self.triangles }
    }
    /// A ray that aims at the shape from a few of its sizes away.
    fn ray(&self, case: u64) -> ([f64; 3], [f64; 3]) {
        let from = self.place.apply(vector(case, 40) * 4.0);
        let at = self.place.apply(vector(case, 50) * 0.9);
        (from.to_array(), (at - from).normalize().to_array())
    }
    fn crossings(&self, o: [f64; 3], d: [f64; 3], own: Option<Own<f64>>) -> Vec<(f64, f64)> {
        let mut found = Vec::new();
        let mut keep = |t: f64, part: f64, ok: Bool| {
            if ok.0 && t > 0.0 {
                found.push((t, part));
            }
        };
        self.primitive.crossings::<f64, false>(self.tables(), o, d, own, &mut keep);
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found
    }
}

#[test]
fn what_leaves_a_surface_never_meets_it_again_at_once() {
    const CASES: u64 = 12_000;
    for (name, kind, convex) in shapes() {
        let (mut hits, mut ulps, mut inwards) = (0, 0.0, 0);
        for case in 0..CASES {
            let c = Case::new(kind, case);
            let (o, d) = c.ray(case);
            let Some(&(t, part)) = c.crossings(o, d, None).first() else { continue };
            hits += 1;
            let s = c.primitive.surface::<f64, false>(c.tables(), o, d, t, part);
            assert!((dot(s.n, s.n) - 1.0).abs() < 1e-12, "{name} {case}: normal of unit length");
            assert!(s.offset > 0.0 && s.offset.is_finite());
            let size = s.p.iter().map(|x| x.abs()).fold(0.0, rtdsl::math::Real::max);
            ulps += s.offset / (size * f64::EPSILON);

            // Away from the surface, on both sides.
            let out = vector(case, 60).normalize().to_array();
            let out = if dot(out, s.n) < 0.0 { out.map(|x| -x) } else { out };
            for side in [1.0, -1.0] {
                let from = spawn_point(s.p, s.n, side * s.offset);
                let dir = out.map(|x| x * side);
                let own = Own { here: Bool(true), part, outward: Bool(side > 0.0) };
                let again = c.crossings(from, dir, Some(own));
                // Another shape in the very same place, which knows nothing of where the ray started.
                let twin = c.crossings(from, dir, None);
                if convex && side > 0.0 {
                    assert_eq!(again, [], "{name} {case}: out of a convex shape nothing is met");
                    assert_eq!(twin, [], "{name} {case}: nor of its twin");
                } else if convex {
                    inwards += again.len();
                    assert_eq!(twin.len(), 1, "{name} {case}: the way in lies behind, the way out before");
                }
                let same_part = again.iter().filter(|x| x.1 == part).count();
                if matches!(kind, Kind::Plane | Kind::Disc { .. } | Kind::Triangle(_)) {
                    assert_eq!((same_part, twin.len()), (0, 0), "{name} {case}: flat shapes are left for good");
                }
                // Whatever is met, is met a visible way off or at a grazing angle, not at the start.
                for (t, _) in twin {
                    assert!(t > 0.5 * s.offset, "{name} {case}: {t} against {}", s.offset);
                }
            }
        }
        println!("{name}: {hits} hits, mean offset {:.1} ulp", ulps / hits as f64);
        assert!(hits > CASES / 40, "{name}: {hits}");
        assert!(!convex || inwards as u64 > hits * 99 / 100, "{name}: {inwards} ways out for {hits} ways in");
        assert!(ulps / (hits as f64) < 64.0, "{name}");
    }
}

#[test]
fn the_point_of_a_hit_is_on_the_ray_and_on_the_surface() {
    for (name, kind, _) in shapes() {
        for case in (0..4_000).filter(|c| c % 3 != 2) {
            let c = Case::new(kind, case);
            let (o, d) = c.ray(case);
            for (t, part) in c.crossings(o, d, None) {
                let s = c.primitive.surface::<f64, false>(c.tables(), o, d, t, part);
                let on_ray = axpy(t, d, o);
                let gap = DVec3::from_array(s.p).distance(DVec3::from_array(on_ray));
                let size = DVec3::from_array(s.p).length() + t.abs();
                // At a grazing angle an error across the ray is a longer one along it.
                let grazing = dot(s.n, d).abs() + 1e-6;
                assert!(gap <= 64.0 * f64::EPSILON * size / grazing, "{name} {case}: {gap} of {size}");
            }
        }
    }
}

#[test]
fn kernels_of_both_precisions_agree() {
    fn first<L: Lane>(c: &Case, o: [f64; 3], d: [f64; 3]) -> Option<f64> {
        let mut best = f64::INFINITY;
        let mut keep = |t: L, _: L, ok: L::Mask| {
            use rtdsl::math::{Elem, Mask};
            let mut value = [L::Elem::default(); 16];
            t.store(&mut value);
            let t = value[0].to_f64();
            if ok.any() && t > 0.0 && t < best {
                best = t;
            }
        };
        c.primitive.crossings::<L, false>(c.tables(), o.map(L::splat), d.map(L::splat), None, &mut keep);
        best.is_finite().then_some(best)
    }
    for (name, kind, _) in shapes() {
        let mut apart = 0;
        for case in (0..2_000).filter(|c| c % 4 == 0) {
            let c = Case::new(kind, case);
            let (o, d) = c.ray(case);
            let (long, short) = (first::<f64>(&c, o, d), first::<f32>(&c, o, d));
            match (long, short) {
                (Some(a), Some(b)) => apart += ((a - b).abs() > 1e-3 * a) as u32,
                (None, None) => {}
                _ => apart += 1,
            }
        }
        assert!(apart <= 4, "{name}: {apart} of 500 apart");
    }
}
