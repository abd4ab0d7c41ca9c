//! Sheets: the pieces of a surface that a ray can meet once at most, each with the tests that say where it is met, and how far.
//!
//! The renderer's kernels decide which crossing comes first by masks; over a region such decisions are edges, and an edge has to
//! be known as a test that a polygon can be cut at. So here stand the same coefficients, from the same
//! [`Quadric`]s, with one sheet for each root, face and side.

use super::super::ray::LocalRay;
use super::super::shape::quadric::Quadric;
use super::super::shape::{BOTTOM, Ball, Kind, SIDE, TOP, Tube};
use super::bundle::Bundle;
use super::certifier::Certifier;
use super::polygon::Polygon;
use super::undecided::Undecided;
use crate::math::Form;
use crate::math::real::{Real, dot, minus, three};

/// One crossing of the rays of a region with a surface.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// The surface.
    pub id: u32,
    /// The part of it.
    pub part: f64,
    /// Whether rays come from the side that its normal points away from.
    pub inside: bool,
    /// Rays meet it where all of these are 0 or more.
    pub tests: Undecided,
    /// 1/t: the larger, the nearer. Of flat sheets as straight as the rays, and 0 at the horizon.
    pub nearness: Form,
    /// t; unknown where the sheet reaches the horizon.
    pub t: Form,
    /// Whether it is a side of a convex shape, of which rays meet one sheet from outside and one from inside at most.
    pub convex: bool,
    /// Whether it is flat.
    pub flat: bool,
    /// Whether it only stands around a surface that isn't followed: beyond it there may be anything.
    pub veil: bool,
}

/// What isn't covered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unknown;

/// Finds the sheets of one surface.
pub struct Sheets<'a> {
    /// The scene.
    pub scene: &'a Certifier<'a>,
    /// Where they are wanted.
    pub p: &'a Polygon,
    /// The rays.
    pub ray: &'a Bundle,
    /// The sheets found.
    pub found: Vec<Sheet>,
}

/// Which sheets of a closed convex shape count.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Wanted {
    entering: bool,
    leaving: bool,
}

impl Sheets<'_> {
    /// Adds those of surface `id`. Of closed convex shapes that let nothing through, those alone that the rays see from
    /// outside, if they start there.
    pub fn add(&mut self, id: u32) -> Result<(), Unknown> {
        let world = self.scene.world;
        let own = self.ray.start.filter(|s| s.id == id);
        let Some(primitive) = world.primitives().get(id as usize) else {
            let (mesh, k) = world.triangle(id);
            return self.triangle(id, mesh.corners(k), mesh.normal(k));
        };
        if let Kind::Triangle(i) = primitive.kind {
            let tri = &world.tables().triangles[i as usize];
            return self.triangle(id, tri.v, tri.n);
        }
        if own.is_some_and(|own| own.outward && primitive.kind.is_left_for_good()) {
            return Ok(());
        }
        let ray = self.ray.localized(primitive, world.tables().maps);
        let opaque = world.constant_transmission(id) == Some([0.0; 3]);
        // A ray that starts on a convex shape and leaves to the inside meets it from inside alone.
        let wanted = |outside: bool| match own {
            Some(own) => Wanted { entering: false, leaving: !own.outward },
            None => Wanted { entering: true, leaving: !(opaque && outside) },
        };
        match &primitive.kind {
            Kind::Sphere(r) if own.is_some() => self.deflated(id, &ray, &Ball { r: *r }, |_| [None, None]),
            Kind::Sphere(r) => {
                let away = dot(ray.o, ray.o) - Form::constant(*r).times(*r);
                let wanted = wanted(self.p.range(away).0 > 0.0);
                self.quadric(id, &ray, &Ball { r: *r }, wanted, |_| [None, None])
            }
            Kind::Plane | Kind::Disc { .. } if own.is_some() => Ok(()),
            Kind::Plane => self.level(id, 0.0, &ray, 1, 0.0, false, |_, _| true),
            Kind::Disc { r, hole } => self.level(id, 0.0, &ray, 1, 0.0, false, |s, may_hold| {
                let rho2 = squared_distance(&ray, s);
                let s2 = s * s;
                may_hold(s2.times(*r).times(*r) - rho2)
                    && (!(*hole > 0.0) || may_hold(rho2 - s2.times(*hole).times(*hole)))
            }),
            Kind::Cuboid(half) => {
                let outside = (0..3).any(|i| {
                    let (lo, hi) = self.p.range(ray.o[i]);
                    lo > half[i] || hi < -half[i]
                });
                let own_part = own.map(|o| o.part);
                self.cuboid(id, &ray, *half, wanted(outside), own_part)
            }
            Kind::Tube(tube) => {
                let w = ray.o[1].times(tube.slope) + Form::constant(tube.radius);
                let rho2 = ray.o[0] * ray.o[0] + ray.o[2] * ray.o[2];
                let (lo, hi) = self.p.range(ray.o[1]);
                let outside = lo > tube.top || hi < tube.bottom || self.p.range(rho2 - w * w).0 > 0.0;
                let mut wanted = wanted(outside);
                wanted.leaving |= !tube.caps && own.is_none();
                self.tube(id, &ray, tube, wanted, own.map(|o| o.part))
            }
            Kind::Ring(_) if own.is_some() => Err(Unknown),
            Kind::Ring(ring) => {
                self.veil(id, &ray, (ring.r + ring.tube) / ring.scale * WIDER, ring.tube / ring.scale * WIDER)
            }
            Kind::Triangle(_) | Kind::Mesh(_) => Ok(()),
        }
    }

    /// The plane at `height` along an axis, between the tests that `within` makes of 1/t, as long as they may hold. The
    /// normal points up the axis, or down it if `turned`.
    #[allow(clippy::too_many_arguments)]
    fn level(
        &mut self,
        id: u32,
        part: f64,
        ray: &LocalRay<Form>,
        axis: usize,
        height: f64,
        turned: bool,
        within: impl FnOnce(Form, &mut dyn FnMut(Form) -> bool) -> bool,
    ) -> Result<(), Unknown> {
        let way = Form::constant(height) - (ray.o[axis] + ray.o_lo[axis]);
        let (lo, hi) = self.p.range(way);
        if !(lo > 0.0 || hi < 0.0) {
            return Err(Unknown);
        }
        let up = lo > 0.0;
        let nearness = (ray.d[axis] + ray.d_lo[axis]) / way;
        let (p, mut tests) = (self.p, Undecided::none());
        if !tests.may_hold(p, nearness) || !within(nearness, &mut |g| tests.may_hold(p, g)) {
            return Ok(());
        }
        let t = nearness.reciprocal();
        let convex = matches!(self.scene.world.primitives()[id as usize].kind, Kind::Cuboid(_) | Kind::Tube(_));
        self.found.push(Sheet { id, part, inside: up != turned, tests, nearness, t, convex, flat: true, veil: false });
        Ok(())
    }

    fn cuboid(
        &mut self,
        id: u32,
        ray: &LocalRay<Form>,
        half: [f64; 3],
        wanted: Wanted,
        own: Option<f64>,
    ) -> Result<(), Unknown> {
        for (axis, &h) in half.iter().enumerate() {
            for upper in [false, true] {
                let part = 2.0 * axis as f64 + upper as u8 as f64;
                if own == Some(part) {
                    continue;
                }
                let height = if upper { h } else { -h };
                let (lo, hi) = self.p.range(Form::constant(height) - (ray.o[axis] + ray.o_lo[axis]));
                // Seen from outside where the origin lies beyond the face.
                let beyond = if upper { hi < 0.0 } else { lo > 0.0 };
                let within = if upper { lo > 0.0 } else { hi < 0.0 };
                if (beyond && !wanted.entering) || (within && !wanted.leaving) {
                    continue;
                }
                self.level(id, part, ray, axis, height, !upper, |s, may_hold| {
                    [(axis + 1) % 3, (axis + 2) % 3].into_iter().all(|i| {
                        let at = (ray.o[i] + ray.o_lo[i]) * s + (ray.d[i] + ray.d_lo[i]);
                        may_hold(s.times(half[i]) - at) && may_hold(s.times(half[i]) + at)
                    })
                })?;
            }
        }
        Ok(())
    }

    fn tube(
        &mut self,
        id: u32,
        ray: &LocalRay<Form>,
        tube: &Tube,
        wanted: Wanted,
        own: Option<f64>,
    ) -> Result<(), Unknown> {
        let (bottom, top) = (Form::constant(tube.bottom), Form::constant(tube.top));
        let on_side = own == Some(SIDE);
        let ends = |t: Form| {
            let y = t.mul_add(ray.d[1] + ray.d_lo[1], ray.o[1] + ray.o_lo[1]);
            [Some(y - bottom), Some(top - y)]
        };
        match on_side {
            true => self.deflated(id, ray, tube, ends)?,
            false => self.quadric(id, ray, tube, wanted, ends)?,
        }
        if !tube.caps {
            return Ok(());
        }
        for (part, height) in [(BOTTOM, tube.bottom), (TOP, tube.top)] {
            let r = tube.radius + tube.slope * height;
            if own == Some(part) || !(r > 0.0) {
                continue;
            }
            let (lo, hi) = self.p.range(Form::constant(height) - (ray.o[1] + ray.o_lo[1]));
            let (beyond, within) = if part == TOP { (hi < 0.0, lo > 0.0) } else { (lo > 0.0, hi < 0.0) };
            if (beyond && !wanted.entering) || (within && !wanted.leaving) {
                continue;
            }
            // The radius was rounded twice; a form says so.
            let radius = Form::constant(tube.slope).times(height) + Form::constant(tube.radius);
            self.level(id, part, ray, 1, height, part == BOTTOM, |s, may_hold| {
                may_hold(s * s * (radius * radius) - squared_distance(ray, s))
            })?;
        }
        Ok(())
    }

    /// The cylinder around a shape that isn't followed, of this radius and half this height: what misses it misses the shape. For
    /// rays that surely start outside of it.
    fn veil(&mut self, id: u32, ray: &LocalRay<Form>, radius: f64, half: f64) -> Result<(), Unknown> {
        let (lo, hi) = self.p.range(ray.o[1] + ray.o_lo[1]);
        let rho2 = ray.o[0] * ray.o[0] + ray.o[2] * ray.o[2];
        if !(lo > half || hi < -half || self.p.range(rho2).0 > radius * radius * WIDER) {
            return Err(Unknown);
        }
        let first = self.found.len();
        let around = Tube { radius, slope: 0.0, bottom: -half, top: half, caps: true };
        self.tube(id, ray, &around, Wanted { entering: true, leaving: false }, None)?;
        self.found[first..].iter_mut().for_each(|sheet| sheet.veil = true);
        Ok(())
    }

    /// Both roots of a quadric, between the tests that `ends` makes of t.
    fn quadric(
        &mut self,
        id: u32,
        ray: &LocalRay<Form>,
        form: &impl Quadric,
        wanted: Wanted,
        ends: impl Fn(Form) -> [Option<Form>; 2],
    ) -> Result<(), Unknown> {
        // Coefficients at a point of each ray near the shape; the same t for all, so that the point is as straight as the ray.
        let middle = |v: [Form; 3]| three!(i => v[i].c);
        let (o, d) = (middle(ray.o), middle(ray.d));
        let t0 = Form::constant(-(dot(o, d) / dot(d, d)));
        if !t0.c.is_finite() {
            return Err(Unknown);
        }
        let m = ray.at(t0);
        let d = three!(i => ray.d[i] + ray.d_lo[i]);
        let k = form.coefficients(m, d);
        let disc = k.b * k.b - k.a * k.c;
        let (lo, hi) = self.p.range(disc);
        if hi < 0.0 {
            return Ok(());
        }
        // Of a form that falls off in both directions the first root is where rays leave.
        let (a_lo, a_hi) = self.p.range(k.a);
        let steep = a_hi < 0.0;
        if !(steep || a_lo > 0.0) {
            return Err(Unknown);
        }
        let root = disc.root_within(lo, hi);
        let inverse = k.a.reciprocal();
        // −b ∓ √ over a: for negative a the second is the smaller; it is the way out then, as the first is the way in.
        for (inside, shift) in [(false, -k.b - root), (true, root - k.b)] {
            if !(if inside { wanted.leaving } else { wanted.entering }) {
                continue;
            }
            let t = t0 + shift * inverse;
            let mut tests = Undecided::none();
            if ![Some(disc), Some(t)].into_iter().chain(ends(t)).flatten().all(|g| tests.may_hold(self.p, g)) {
                continue;
            }
            self.found.push(Sheet {
                id,
                part: SIDE,
                inside,
                tests,
                nearness: t.reciprocal(),
                t,
                convex: true,
                flat: false,
                veil: false,
            });
        }
        Ok(())
    }

    /// The other root for rays that start on the quadric and go inside.
    fn deflated(
        &mut self,
        id: u32,
        ray: &LocalRay<Form>,
        form: &impl Quadric,
        ends: impl Fn(Form) -> [Option<Form>; 2],
    ) -> Result<(), Unknown> {
        if self.ray.start.is_some_and(|s| s.outward) {
            return Ok(());
        }
        let k = form.coefficients(ray.o, ray.d);
        let t = (k.b + k.b) / -k.a;
        if !t.is_known() {
            return Err(Unknown);
        }
        let mut tests = Undecided::none();
        if !tests.may_hold(self.p, t) || !ends(t).into_iter().flatten().all(|g| tests.may_hold(self.p, g)) {
            return Ok(());
        }
        self.found.push(Sheet {
            id,
            part: SIDE,
            inside: true,
            tests,
            nearness: t.reciprocal(),
            t,
            convex: true,
            flat: false,
            veil: false,
        });
        Ok(())
    }

    /// The triangle: d lies between its corners where the three volumes that d spans with pairs of them have one sign. Each
    /// is linear in d where all rays start at one point.
    fn triangle(&mut self, id: u32, v: [[f64; 3]; 3], n: [f64; 3]) -> Result<(), Unknown> {
        if self.ray.start.is_some_and(|s| s.id == id) {
            return Ok(());
        }
        let (o, d) = (self.ray.o, self.ray.d);
        let to = v.map(|v| minus(v.map(Form::constant), o));
        let n = n.map(Form::constant);
        let height = dot(n, to[0]);
        let (lo, hi) = self.p.range(height);
        if !(lo > 0.0 || hi < 0.0) {
            return Err(Unknown);
        }
        let behind = lo > 0.0;
        // Whether the corners go round as the normal says: not where a mirror made them.
        let across = |k: usize| three!(i => v[k][i] - v[0][i]);
        let round = dot(cross(across(1), across(2)), n.map(|x| x.c));
        if !(round.abs() > 0.0) {
            return Err(Unknown);
        }
        let nearness = dot(n, d) / height;
        let mut tests = Undecided::none();
        if !tests.may_hold(self.p, nearness) {
            return Ok(());
        }
        for i in 0..3 {
            let (a, b) = (v[i], v[(i + 1) % 3]);
            let edge = three!(k => Form::constant(b[k]) - Form::constant(a[k]));
            let volume = dot(d, cross(to[i], edge));
            if !tests.may_hold(self.p, if behind == (round > 0.0) { volume } else { -volume }) {
                return Ok(());
            }
        }
        let t = nearness.reciprocal();
        self.found.push(Sheet {
            id,
            part: 0.0,
            inside: behind,
            tests,
            nearness,
            t,
            convex: false,
            flat: true,
            veil: false,
        });
        Ok(())
    }
}

/// More than the few roundings of a veil's lengths.
const WIDER: f64 = 1.0 + 1.0 / (1u64 << 40) as f64;

/// The squared distance from the y axis of the point at 1/s, times s².
fn squared_distance(ray: &LocalRay<Form>, s: Form) -> Form {
    let at = |i: usize| (ray.o[i] + ray.o_lo[i]) * s + (ray.d[i] + ray.d_lo[i]);
    let (x, z) = (at(0), at(2));
    x * x + z * z
}

fn cross<R: Real>(a: [R; 3], b: [R; 3]) -> [R; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
