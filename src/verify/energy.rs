//! Light is neither lost nor made: what surfaces give back, compared with closed forms in double-double numbers.
//!
//! The forms are those that a renderer of Phong's model and point lights must keep: a lit plane, a room of ambient light
//! alone (the white furnace), light through panes, mirrors that face each other, and Fresnel's formulas. Phong's highlight
//! isn't reciprocal, so no swap of light and eye is asked of it; refraction is, and its way back is tried.

use super::draw::Draw;
use super::stage::{Stage, Surface};
use super::tally::{Tally, ulp};
use super::{Bound, Check, Figure, Outcome, Size};
use crate::math::real::{Bool, Real, dot, minus};
use crate::math::{Dd, fun};
use crate::render::optics::{Refracted, dielectric};
use crate::scene::{Color, Shape};
use glam::DVec3;

/// Closed forms of light.
pub const CHECK: Check =
    Check { name: "energy", what: "light is neither lost nor made: closed forms in double-double", run };

/// Largest error, in ulp: of what each form says.
const MOST: f64 = 4.0;

/// A case: what came out, what is exact, and one ulp at the scale that counts.
struct Case {
    is: f64,
    exact: Dd,
    ulp: f64,
}

impl Case {
    /// An error is counted in ulp of the exact value: what comes of products and sums alone.
    fn new(is: f64, exact: Dd) -> Case {
        Case { is, exact, ulp: ulp(exact.hi) }
    }
    /// An error is counted in ulp of 1, a share of all the light that arrives, times `how_far`: a point that the eye sees
    /// from afar is as exact as its distance, and by so many of its neighbour's distances the light's direction is less so.
    fn of_one(is: f64, exact: Dd, how_far: f64) -> Case {
        Case { is, exact, ulp: f64::EPSILON * how_far }
    }
    fn error(&self) -> f64 {
        (Dd::new(self.is) - self.exact).hi.abs() / self.ulp
    }
}

/// A kind of case.
struct Form {
    what: &'static str,
    try_one: fn(Draw) -> Case,
    /// How many are tried for one of the dearer ones.
    share: f64,
    bound: Bound,
}

/// What products and sums leave exact to some ulp.
const fn form(what: &'static str, try_one: fn(Draw) -> Case, share: f64) -> Form {
    Form { what, try_one, share, bound: Bound::AtMost(MOST) }
}

/// What magnifies every rounding, by its nature or by the number of its steps: said, not bounded.
const fn told(what: &'static str, try_one: fn(Draw) -> Case, share: f64) -> Form {
    Form { what, try_one, share, bound: Bound::None }
}

const FORMS: [Form; 11] = [
    form("a plane, lit; ulp of 1 at the eye's distance over the lamp's", lit_plane, 1.0),
    form("a white room with mirrors and clear balls in it", furnace, 0.1),
    form("a wall and its lamp behind a pane or none", |draw| panes(draw, 1), 0.5),
    told("a wall and its lamp behind up to 8 panes", |draw| panes(draw, 8), 0.5),
    form("two mirrors face to face, up to 8 reflections", |draw| mirrors(draw, 8), 0.5),
    told("two mirrors face to face, up to 100 reflections", |draw| mirrors(draw, 100), 0.2),
    form(
        "a glass ball in a white room, up to 12 deep; ulp of 1 at the eye's distance over the radius",
        glass_ball,
        0.5,
    ),
    form("Fresnel's reflectance up to 85 degrees; ulp of 1", fresnel, 10.0),
    form("reflectance from both sides up to 60 degrees; ulp of 1", |draw| both_sides(draw, 60.0), 10.0),
    told("reflectance from both sides up to 85 degrees; ulp of 1", |draw| both_sides(draw, 85.0), 10.0),
    form("the way of light through a surface and back, up to 60 degrees; ulp of the index squared", way_back, 10.0),
];

fn run(size: Size) -> Outcome {
    let mut outcome = Outcome::default();
    for Form { what, try_one, share, bound } in &FORMS {
        let n = (size.pick(4_000, 200_000) as f64 * share) as u64;
        let tally = Tally::of(n, |case, tally| {
            let error = try_one(Draw::new(what, case)).error();
            tally.off(error);
            if *bound != Bound::None && !(error <= MOST) {
                tally.fail(0, case, || format!("{what}: case {case} is off by {error:.2} ulp"));
            }
        });
        let figure = Figure::new(format!("{what}: error, max"), tally.errors.max(), "ulp", *bound);
        outcome.figures.push(Figure { histogram: Some(tally.errors), ..figure });
        outcome.cases += n;
        outcome.first_failure = outcome.first_failure.or(tally.first.map(|(_, say)| say));
    }
    outcome
}

/// A whole number from `a` to `b`.
fn whole(draw: &mut Draw, a: u32, b: u32) -> u32 {
    a + draw.below((b - a + 1) as u64) as u32
}

/// A direction at most `degrees` from z, of unit length but for rounding.
fn about_z(draw: &mut Draw, degrees: f64) -> DVec3 {
    let (turn, lean) = (draw.between(0.0, 360.0), draw.between(0.0, degrees));
    let (s, c) = (fun::sin_deg(lean), fun::cos_deg(lean));
    DVec3::new(s * fun::cos_deg(turn), s * fun::sin_deg(turn), c)
}

fn exact(v: DVec3) -> [Dd; 3] {
    v.to_array().map(Dd::new)
}

/// ambient + diffuse × cosine.
fn lit_plane(mut draw: Draw) -> Case {
    let mut stage = Stage::new();
    let normal = about_z(&mut draw, 70.0);
    let through = DVec3::new(draw.between(-2.0, 2.0), draw.between(-2.0, 2.0), draw.between(-14.0, -8.0));
    // Where the ray along -z meets it.
    let (n, p) = (exact(normal), exact(through));
    let z = dot(n, p) / n[2];
    let lamp = DVec3::Z * z.hi + draw.between(1.0, 30.0) * tilted(normal, about_z(&mut draw, 70.0));
    let (ambient, diffuse) = (draw.between(0.0, 1.0), draw.between(0.1, 1.0));
    stage.scene.ambient = Color::linear_gray(draw.between(0.0, 1.0));
    let surface = Surface { ambient, diffuse, ..Surface::default() };
    stage.shape(Shape::Plane { through, normal }, surface);
    stage.light(lamp);
    let to = minus(exact(lamp), [Dd::default(), Dd::default(), z]);
    let cosine = dot(n, to) / (dot(n, n) * dot(to, to)).sqrt();
    let everywhere = Dd::new(ambient) * Dd::new(stage.scene.ambient.0[0]);
    let how_far = 1.0 + z.hi.abs() / dot(to, to).sqrt().hi;
    Case::of_one(stage.seen(0), everywhere + Dd::new(diffuse) * cosine, how_far)
}

/// `v`, given about z, laid about `n` of unit length, n.z > -1 (Rodrigues' rotation from z to n).
fn tilted(n: DVec3, v: DVec3) -> DVec3 {
    let axis = DVec3::Z.cross(n);
    v * n.z + axis.cross(v) + axis * (axis.dot(v) / (1.0 + n.z))
}

/// In a room whose walls give back all of an ambient light of 1, nothing that gives back all light can be seen.
fn furnace(mut draw: Draw) -> Case {
    let mut stage = Stage::new();
    stage.scene.ambient = Color::WHITE;
    stage.shape(Shape::Sphere { at: DVec3::ZERO, r: 100.0 }, Surface { ambient: 1.0, ..Surface::default() });
    for cell in (0..27).filter(|c| *c != 13) {
        let at = DVec3::new((cell % 3) as f64 - 1.0, (cell / 3 % 3) as f64 - 1.0, (cell / 9) as f64 - 1.0) * 4.0;
        let (clear, mirror) =
            (Surface { transmit: 1.0, ..Surface::default() }, Surface { reflect: 1.0, ..Surface::default() });
        let surface = match whole(&mut draw, 0, 2) {
            0 => mirror,
            1 => clear,
            _ => Surface { ior: Some(1.0), ..clear },
        };
        stage.shape(Shape::Sphere { at, r: draw.between(0.5, 1.9) }, surface);
    }
    stage.scene.cameras[0].at = DVec3::new(draw.between(-1.0, 1.0), draw.between(-1.0, 1.0), -1.0);
    Case::new(stage.seen(100), Dd::ONE)
}

/// A wall lit straight on by a lamp behind the eye: every pane dims the light on its way there and on its way back.
fn panes(mut draw: Draw, most: u32) -> Case {
    let mut stage = Stage::new();
    let diffuse = draw.between(0.1, 1.0);
    let facing = |z: f64| Shape::Plane { through: DVec3::Z * z, normal: DVec3::Z };
    stage.shape(facing(-draw.between(10.0, 20.0)), Surface { diffuse, ..Surface::default() });
    stage.light(DVec3::Z * draw.between(1.0, 9.0));
    let mut light = Dd::new(diffuse);
    for pane in 0..whole(&mut draw, 0, most) {
        let transmit = draw.between(0.3, 1.0);
        stage.shape(facing(-1.0 - pane as f64), Surface { transmit, ..Surface::default() });
        light = light * Dd::new(transmit) * Dd::new(transmit);
    }
    Case::new(stage.seen(most), light)
}

/// 1 + w + w² + … between two walls that mirror w and give back ambient light of 1.
fn mirrors(mut draw: Draw, most: u32) -> Case {
    let mut stage = Stage::new();
    stage.scene.ambient = Color::WHITE;
    let reflect = draw.between(0.0, 0.95);
    for y in [-1.0, 1.0] {
        let wall = Shape::Plane { through: DVec3::Y * y * draw.between(0.5, 2.0), normal: DVec3::Y };
        stage.shape(wall, Surface { ambient: 1.0, reflect, ..Surface::default() });
    }
    stage.scene.cameras[0].at = DVec3::new(draw.between(-1.0, 1.0), draw.between(0.2, 1.0), -1.0);
    let depth = whole(&mut draw, 0, most);
    let sum = (0..depth).fold(Dd::ONE, |sum, _| Dd::ONE + Dd::new(reflect) * sum);
    Case::new(stage.seen(depth), sum)
}

/// Every bounce within a ball meets its surface at the same angle. So of white light all comes through but what is still
/// inside when the recursion ends: 1 − (1 − R)·R^(depth − 1).
fn glass_ball(mut draw: Draw) -> Case {
    let mut stage = Stage::new();
    stage.scene.ambient = Color::WHITE;
    stage.shape(Shape::Sphere { at: DVec3::ZERO, r: 100.0 }, Surface { ambient: 1.0, ..Surface::default() });
    let (r, ior) = (draw.between(0.5, 2.0), draw.between(1.1, 3.0));
    let beside = draw.between(0.0, 0.9) * r;
    let at = DVec3::new(beside, 0.0, -draw.between(3.0, 20.0));
    stage.shape(Shape::Sphere { at, r }, Surface { transmit: 1.0, ior: Some(ior), ..Surface::default() });
    let depth = whole(&mut draw, 1, 12);
    let sine = Dd::new(beside) / Dd::new(r);
    let back = reflectance((Dd::ONE - sine * sine).sqrt(), Dd::new(ior));
    let inside = (1..depth).fold(Dd::ONE - back, |inside, _| inside * back);
    Case::of_one(stage.seen(depth), Dd::ONE - inside, at.length() / r)
}

/// Fresnel's formulas for light that comes from the thinner side: `cosine` of its angle, `n` the ratio of the indices.
fn reflectance(cosine: Dd, n: Dd) -> Dd {
    let beyond = (Dd::ONE - (Dd::ONE - cosine * cosine) / (n * n)).sqrt();
    let (s, p) = ((cosine - n * beyond) / (cosine + n * beyond), (beyond - n * cosine) / (beyond + n * cosine));
    (s * s + p * p) * Dd::new(0.5)
}

const NORMAL: [f64; 3] = [0.0, 0.0, 1.0];

/// A ray down to a surface, at most `degrees` from its normal, and a refractive index.
fn arriving(draw: &mut Draw, degrees: f64) -> ([f64; 3], f64) {
    let d = -about_z(draw, degrees) * draw.between(0.1, 10.0);
    (d.to_array(), draw.between(1.1, 3.0))
}

fn fresnel(mut draw: Draw) -> Case {
    let (d, ior) = arriving(&mut draw, 85.0);
    let v = d.map(Dd::new);
    let cosine = -v[2] / dot(v, v).sqrt();
    Case::of_one(dielectric(d, NORMAL, ior, Bool(false)).reflectance, reflectance(cosine, Dd::new(ior)), 1.0)
}

/// The ray, the index, and where what goes through comes from on its way back: Fresnel's shares and Snell's angles are the same.
fn there_and_back(draw: &mut Draw, degrees: f64) -> ([f64; 3], f64, [Refracted<f64>; 2]) {
    let (d, ior) = arriving(draw, degrees);
    let there = dielectric(d, NORMAL, ior, Bool(false));
    let back = dielectric(there.direction.map(|x| -x), NORMAL.map(|x| -x), ior, Bool(true));
    (d, ior, [there, back])
}

fn both_sides(mut draw: Draw, degrees: f64) -> Case {
    let (_, _, [there, back]) = there_and_back(&mut draw, degrees);
    Case::of_one(back.reflectance, Dd::new(there.reflectance), 1.0)
}

/// The coordinate of the direction that is off most. On the denser side the sine comes from 1 − cosine², and Snell's law
/// magnifies that by the square of the index.
fn way_back(mut draw: Draw) -> Case {
    let (d, ior, [_, back]) = there_and_back(&mut draw, 60.0);
    let length = dot(d.map(Dd::new), d.map(Dd::new)).sqrt();
    let off = |i: usize| Case::of_one(-back.direction[i], Dd::new(d[i]) / length, ior * ior);
    let [x, y, z] = [off(0), off(1), off(2)];
    let larger = |a: Case, b: Case| if a.error() > b.error() { a } else { b };
    larger(larger(x, y), z)
}
