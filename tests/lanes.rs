//! Kernels of several rays at once: each lane gives the very bits that its ray gives alone.

use glam::DVec3;
use rtdsl::math::hash::KeyedHash;
use rtdsl::math::real::Bool;
use rtdsl::math::{Affine, Dd, Mask, Real};
use rtdsl::render::ray::Own;
use rtdsl::render::shape::{Kind, Ring, Tube, Visit};
use rtdsl::verify::specimen::Specimen;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

const WIDTH: usize = 4;

#[derive(Clone, Copy)]
struct Four([f64; WIDTH]);
#[derive(Clone, Copy)]
struct Bools([bool; WIDTH]);

fn each(f: impl Fn(usize) -> f64) -> Four {
    Four(std::array::from_fn(f))
}
fn mask(f: impl Fn(usize) -> bool) -> Bools {
    Bools(std::array::from_fn(f))
}

macro_rules! operator {
    ($($trait:ident $name:ident)*) => { $(
        impl $trait for Four {
            type Output = Four;
            fn $name(self, o: Four) -> Four {
                each(|i| self.0[i].$name(o.0[i]))
            }
        }
    )* };
}
operator!(Add add Sub sub Mul mul Div div);
impl Neg for Four {
    type Output = Four;
    fn neg(self) -> Four {
        each(|i| -self.0[i])
    }
}
impl BitAnd for Bools {
    type Output = Bools;
    fn bitand(self, o: Bools) -> Bools {
        mask(|i| self.0[i] & o.0[i])
    }
}
impl BitOr for Bools {
    type Output = Bools;
    fn bitor(self, o: Bools) -> Bools {
        mask(|i| self.0[i] | o.0[i])
    }
}
impl Not for Bools {
    type Output = Bools;
    fn not(self) -> Bools {
        mask(|i| !self.0[i])
    }
}
impl Mask for Bools {
    fn splat(value: bool) -> Bools {
        Bools([value; WIDTH])
    }
    fn from_bits(bits: u32) -> Bools {
        mask(|i| bits >> i & 1 == 1)
    }
    fn bits(self) -> u32 {
        (0..WIDTH).map(|i| (self.0[i] as u32) << i).sum()
    }
}
impl Real for Four {
    type Mask = Bools;
    type Single = f64;
    type Fine = Dd;
    const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;
    const LEAST: f64 = f64::MIN_POSITIVE;
    fn splat(x: f64) -> Four {
        Four([x; WIDTH])
    }
    fn mul_add(self, b: Four, c: Four) -> Four {
        each(|i| f64::mul_add(self.0[i], b.0[i], c.0[i]))
    }
    fn sqrt(self) -> Four {
        each(|i| self.0[i].sqrt())
    }
    fn floor(self) -> Four {
        each(|i| self.0[i].floor())
    }
    fn abs(self) -> Four {
        each(|i| self.0[i].abs())
    }
    fn copysign(self, sign: Four) -> Four {
        each(|i| self.0[i].copysign(sign.0[i]))
    }
    fn lt(self, o: Four) -> Bools {
        mask(|i| self.0[i] < o.0[i])
    }
    fn le(self, o: Four) -> Bools {
        mask(|i| self.0[i] <= o.0[i])
    }
    fn same(self, o: Four) -> Bools {
        mask(|i| self.0[i] == o.0[i])
    }
    fn select(m: Bools, a: Four, b: Four) -> Four {
        each(|i| if m.0[i] { a.0[i] } else { b.0[i] })
    }
    fn each<const N: usize, const M: usize>(v: [Four; N], mut f: impl FnMut([f64; N]) -> [f64; M]) -> [Four; M] {
        let mut out = [Four([0.0; WIDTH]); M];
        for i in 0..WIDTH {
            for (to, from) in out.iter_mut().zip(f(v.map(|x| x.0[i]))) {
                to.0[i] = from;
            }
        }
        out
    }
    fn again<const N: usize, const M: usize>(
        doubt: Bools,
        given: [Four; N],
        rough: [Four; M],
        mut f: impl FnMut([Dd; N]) -> [Dd; M],
    ) -> [Four; M] {
        let mut out = rough;
        for i in (0..WIDTH).filter(|&i| doubt.0[i]) {
            for (to, from) in out.iter_mut().zip(f(given.map(|x| Dd::new(x.0[i])))) {
                to.0[i] = from.hi;
            }
        }
        out
    }
}

fn random(case: u64, k: u64) -> f64 {
    KeyedHash::new().with_text("lanes").with(case).with(k).unit() * 2.0 - 1.0
}
fn vector(case: u64, k: u64) -> [f64; 3] {
    [random(case, k), random(case, k + 1), random(case, k + 2)]
}

/// A ray of one lane: some start on the shape, some along an axis, some all but touch a unit sphere.
fn ray(case: u64) -> ([f64; 3], [f64; 3]) {
    let (o, d) = (vector(case, 0).map(|x| 3.0 * x), vector(case, 10));
    match case % 5 {
        0 => (o, [0.0, -1.0, -0.0]),
        1 => ([1.0 + random(case, 20).signum() * f64::EPSILON * (case % 3) as f64, 0.2, 4.0], [0.0, 0.0, -1.0]),
        2 => (o.map(|x| 1e6 * x), std::array::from_fn(|i| vector(case, 30)[i] * 0.7 - 1e6 * o[i])),
        _ => (o, d),
    }
}

fn bits(x: f64) -> u64 {
    // Which NaN is nobody's business: it is never read.
    if x.is_nan() { f64::NAN.to_bits() } else { x.to_bits() }
}

#[test]
fn every_lane_gives_the_bits_of_its_ray_alone() {
    let tube = |radius: f64, slope: f64, bottom: f64, top: f64, caps: bool| {
        Kind::Tube(Tube { radius, slope, bottom, top, caps })
    };
    let kinds = [
        Kind::Sphere(1.0),
        Kind::Plane,
        Kind::Disc { r: 1.0, hole: 0.2 },
        Kind::Cuboid([1.0, 0.5, 0.7]),
        tube(1.0, 0.0, -1.0, 1.5, true),
        tube(0.0, -0.6, -1.4, 0.0, true),
        tube(0.3, 0.7, 0.0, 1.0, false),
        Kind::Ring(Ring::new(0.8, 0.2)),
        Kind::Triangle(0),
    ];
    let turned =
        Affine::rotation_about(DVec3::new(1.0, 2.0, -0.5), 37.0).compose(&Affine::scaling(DVec3::new(1.0, 0.5, 2.0)));
    let mut met = 0;
    for (k, kind) in kinds.into_iter().enumerate() {
        for place in [Affine::IDENTITY, turned] {
            let shape = match kind {
                Kind::Triangle(_) => Specimen::triangle([[-1.0, 0.0, -0.6], [1.0, 0.0, -0.5], [0.0, -0.2, 1.0]]),
                _ => Specimen::framed(kind, &place),
            };
            for case in 0..2_000 {
                let rays: [_; WIDTH] = std::array::from_fn(|i| ray(WIDTH as u64 * case + i as u64));
                let lanes = |v: [[f64; 3]; WIDTH]| -> [Four; 3] { std::array::from_fn(|c| each(|i| v[i][c])) };
                // Of every other batch some lanes start on the shape.
                let here = mask(|i| case % 2 == 1 && (case / 2 + i as u64).is_multiple_of(3));
                let outward = mask(|i| (case + i as u64) % 4 < 2);
                let own = Own { here, part: Four([0.0; WIDTH]), outward };
                let (o, d) = (lanes(rays.map(|r| r.0)), lanes(rays.map(|r| r.1)));
                let together = seen::<Four>(&shape, o, d, own);
                let nearest = first::<Four>(&shape, (o, d), own);
                for (i, (o, d)) in rays.into_iter().enumerate() {
                    let own = Own { here: Bool(here.0[i]), part: 0.0, outward: Bool(outward.0[i]) };
                    let alone = seen::<f64>(&shape, o, d, own);
                    let mine: Vec<_> =
                        together.iter().filter(|x| x.2.0[i]).map(|x| (bits(x.0.0[i]), x.1.0[i])).collect();
                    let wanted: Vec<_> = alone.iter().filter(|x| x.2.0).map(|x| (bits(x.0), x.1)).collect();
                    assert_eq!(mine, wanted, "shape {k}, case {case}, lane {i}");
                    let (t, part) = first::<f64>(&shape, (o, d), own);
                    let mine = (bits(nearest.0.0[i]), nearest.1.0[i]);
                    assert_eq!(mine, (bits(t), part), "the nearest of shape {k}, case {case}, lane {i}");
                    met += wanted.len();
                }
            }
        }
    }
    assert!(met > 20_000, "{met}");
}

/// The nearest crossing, looked for as rays do: without those that come after one.
struct First<R> {
    t: R,
    part: R,
}

impl<R: Real> Visit<R> for First<R> {
    fn crossing(&mut self, t: R, part: R, valid: R::Mask) {
        let m = valid & R::zero().lt(t) & t.lt(self.t);
        (self.t, self.part) = (R::select(m, t, self.t), R::select(m, part, self.part));
    }
    fn needs_further(&self, t: R, valid: R::Mask) -> R::Mask {
        valid & !R::zero().lt(t)
    }
}

fn first<R: Real>(shape: &Specimen, (o, d): ([R; 3], [R; 3]), own: Own<R>) -> (R, R) {
    let mut first = First { t: R::splat(f64::INFINITY), part: R::splat(-1.0) };
    shape.visit::<R>(o, d, Own::of(own.here, own.part, own.outward), &mut first);
    (first.t, first.part)
}

fn seen<R: Real>(shape: &Specimen, o: [R; 3], d: [R; 3], own: Own<R>) -> Vec<(R, R, R::Mask)> {
    let mut all = Vec::new();
    shape.visit::<R>(o, d, Some(own), &mut |t: R, part: R, ok: R::Mask| all.push((t, part, ok)));
    all
}
