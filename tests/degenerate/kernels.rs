//! The kernels with rays that are none.

use rtdsl::math::Affine;
use rtdsl::math::real::Bool;
use rtdsl::render::frame::Frame;
use rtdsl::render::ray::Own;
use rtdsl::render::shape::primitive::Tables;
use rtdsl::render::shape::{Kind, Primitive, Ring, TriangleData, Tube};

fn kinds() -> Vec<(&'static str, Kind)> {
    let tube =
        |radius: f64, slope: f64, bottom: f64, top: f64| Kind::Tube(Tube { radius, slope, bottom, top, caps: true });
    vec![
        ("sphere", Kind::Sphere(1.0)),
        ("plane", Kind::Plane),
        ("disc", Kind::Disc { r: 1.0, hole: 0.2 }),
        ("box", Kind::Cuboid([1.0, 0.5, 0.7])),
        ("cylinder", tube(0.8, 0.0, 0.0, 1.5)),
        ("cone", tube(0.0, -0.6, -1.4, 0.0)),
        ("frustum", tube(0.9, -0.3, 0.0, 1.2)),
        ("torus", Kind::Ring(Ring::new(0.8, 0.3))),
        ("triangle", Kind::Triangle(0)),
    ]
}

/// Calls `check` with what each kernel says of the crossings of a line, in a plain and in a turned frame, for a ray that
/// starts anywhere and one that leaves the surface.
fn each_kernel(o: [f64; 3], d: [f64; 3], check: impl Fn(&str, Vec<f64>)) {
    let n = [0.0, 0.6, 0.8];
    let triangles = [TriangleData { v: [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.8, -0.6]], n, shading: None }];
    for (name, kind) in kinds() {
        for turned in [false, true] {
            let place = if turned { Affine::rotation(0, 30.0) } else { Affine::IDENTITY };
            let mut maps = Vec::new();
            let frame = Frame::new(&place, |m| {
                maps.push(m);
                0
            });
            let primitive = Primitive { kind, frame, material: 0, space: Primitive::NO_SPACE };
            let tables = Tables { maps: &maps, triangles: &triangles };
            for own in [None, Some(Own { here: Bool(true), part: 0.0, outward: Bool(true) })] {
                let mut met = Vec::new();
                primitive.crossings::<f64, false>(tables, o, d, own, &mut |t: f64, _: f64, valid: Bool| {
                    // As every caller asks.
                    if valid.0 && 0.0 < t && t < f64::INFINITY {
                        met.push(t);
                    }
                });
                check(name, met);
            }
        }
    }
}

/// Every way to have `odd` among three coordinates, the others being as in `v`.
fn with(odd: f64, v: [f64; 3]) -> impl Iterator<Item = [f64; 3]> {
    (1..8).map(move |bits: usize| std::array::from_fn(|i| if bits >> i & 1 == 1 { odd } else { v[i] }))
}

#[test]
fn a_ray_that_is_no_number_meets_nothing() {
    let (o, d) = ([0.1, 3.0, 0.2], [0.01, -1.0, -0.02]);
    let met = std::cell::Cell::new(0);
    each_kernel(o, d, |_, crossings| met.set(met.get() + crossings.len()));
    assert!(met.get() > 20, "the plain ray meets most: {}", met.get());
    let nothing = |name: &str, met: Vec<f64>| assert!(met.is_empty(), "{name}: {met:?}");
    for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        each_kernel([odd; 3], d, nothing);
        each_kernel(o, [odd; 3], nothing);
        each_kernel([odd; 3], [odd; 3], nothing);
        // A kernel that doesn't look at a coordinate can't tell; it comes to an end.
        with(odd, o).for_each(|o| each_kernel(o, d, |_, _| {}));
        with(odd, d).for_each(|d| each_kernel(o, d, |_, _| {}));
    }
    each_kernel(o, [0.0; 3], nothing);
    each_kernel(o, [0.0, -0.0, 0.0], nothing);
}

#[test]
fn rays_at_the_edges_of_the_numbers_come_to_an_end() {
    let values = [0.0, -0.0, 1.0, -1.0, 5e-324, -5e-324, 1e-310, 1e-160, 1e160, 1e308, -1e308];
    let count = values.len();
    for i in 0..count * count * count {
        let v = [values[i % count], values[i / count % count], values[i / count / count]];
        for w in [[0.1, 3.0, 0.2], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]] {
            each_kernel(w, v, |_, met| assert!(met.iter().all(|t| t.is_finite())));
            each_kernel(v, w, |_, met| assert!(met.iter().all(|t| t.is_finite())));
        }
    }
}
