//! Shades the hits of one object: points and normals first, then light by light, then colour and the rays that follow.

use super::batch::{Column, Column3, RayBatch, column, column3, load3, store3};
use super::bounds::Bounds;
use super::candidates::Candidates;
use super::cull::{Shaft, bounds_of, margin};
use super::footprint::Recorder;
use super::light::{Shadow, ShadowRays, occlusion};
use super::material::{Slot, Surfacing};
use super::optics::{dielectric, mirrored};
use super::pattern::{PatternPoint, Rows};
use super::place::RESIDUE;
use super::shape::primitive::spawn_point;
use super::surface_pattern::{PatternFrame, bumped};
use super::world::{PointLight, World};
use crate::math::fun;
use crate::math::real::{Mask, dot, each3, minus, scaled, splat3, three};
use crate::math::{Elem, Lane};
use crate::scene::range::BRIGHTEST;

/// The hits of one object.
pub struct Hits<'a, E> {
    /// The primitive.
    pub id: u32,
    /// The rays that met it.
    pub rays: &'a RayBatch<E>,
    /// How far along each ray.
    pub t: &'a Column<E>,
    /// Which part of it.
    pub part: &'a Column<E>,
}

/// Where rays go that leave the surface.
pub struct Children<'a, E> {
    /// Mirrored ones.
    pub mirrored: &'a mut RayBatch<E>,
    /// Those that go through.
    pub transmitted: &'a mut RayBatch<E>,
    /// Whether the recursion may go on.
    pub spawn: bool,
}

/// What shading keeps of each hit between its passes.
pub struct ShadeScratch<E> {
    p: Column3<E>,
    /// Geometric normal on the viewer's side.
    n: Column3<E>,
    /// Shading normal.
    ns: Column3<E>,
    local: Column3<E>,
    offset: Column<E>,
    /// 1 where the ray comes from inside.
    inside: Column<E>,
    diffuse: Column3<E>,
    specular: Column3<E>,
    spaces: Vec<Rows>,
    shadow: Shadow,
    occluders: Candidates,
    /// Notes what the rays depend on.
    pub recorder: Recorder,
}

impl<E: Elem> ShadeScratch<E> {
    /// Room for batches of `n` rays.
    pub fn new(n: usize, recorder: Recorder) -> Self {
        ShadeScratch {
            p: column3(n),
            n: column3(n),
            ns: column3(n),
            local: column3(n),
            offset: column(n),
            inside: column(n),
            diffuse: column3(n),
            specular: column3(n),
            spaces: Vec::new(),
            shadow: Shadow::default(),
            occluders: Candidates::default(),
            recorder,
        }
    }
}

/// Adds what the hits give back to `radiance`, and puts the rays that follow into `children`.
#[inline(always)]
pub fn shade<L: Lane, const AT_EYE: bool>(
    world: &World,
    hits: Hits<'_, L::Elem>,
    s: &mut ShadeScratch<L::Elem>,
    radiance: &mut Column3<L::Elem>,
    children: Children<'_, L::Elem>,
    shadow_rays: &mut u64,
) {
    let primitive = world.primitive(hits.id);
    let surfacing = world.surfacing(hits.id);
    let frame = PatternFrame::new(world, primitive, surfacing, &mut s.spaces);
    surfaces::<L, AT_EYE>(world, &hits, &frame, s);
    if surfacing.lit {
        for c in s.diffuse.iter_mut().chain(&mut s.specular) {
            c[..hits.rays.len].fill(L::Elem::default());
        }
        let points = bounds_of(&s.p, hits.rays.len);
        if s.recorder.is_on() {
            s.recorder.lit(points);
        }
        for light in &world.lights {
            illuminate::<L>(world, (light, &points), surfacing, &hits, &frame, s, shadow_rays);
        }
    }
    finish::<L>(world, surfacing, &hits, &frame, s, radiance, children);
}

/// Points, normals and offsets of all hits.
#[inline(always)]
fn surfaces<L: Lane, const AT_EYE: bool>(
    world: &World,
    hits: &Hits<'_, L::Elem>,
    frame: &PatternFrame<'_>,
    s: &mut ShadeScratch<L::Elem>,
) {
    let mut g = 0;
    while g < hits.rays.len {
        let d = load3::<L>(&hits.rays.d, g);
        let o = if AT_EYE { [L::zero(); 3] } else { load3::<L>(&hits.rays.o, g) };
        let (t, part) = (L::load(&hits.t[g..]), L::load(&hits.part[g..]));
        let surface = world.surface::<L, AT_EYE>(hits.id, (o, d), (t, part));
        let inside = L::zero().lt(dot(surface.n, d));
        let mut ns = surface.ns;
        if frame.has_bump() {
            ns = bumped(frame, &s.spaces, surface.local, surface.n, ns);
        }
        let face = |n: [L; 3]| each3(n, |x| L::select(inside, -x, x));
        store3(&mut s.p, g, surface.p);
        store3(&mut s.n, g, face(surface.n));
        store3(&mut s.ns, g, face(ns));
        store3(&mut s.local, g, surface.local);
        surface.offset.store(&mut s.offset[g..]);
        L::select(inside, L::one(), L::zero()).store(&mut s.inside[g..]);
        g += L::WIDTH;
    }
}

/// Adds one light's share to the diffuse and specular sums; `points` holds all hits.
#[inline(always)]
fn illuminate<L: Lane>(
    world: &World,
    (light, points): (&PointLight, &Bounds),
    surfacing: &Surfacing,
    hits: &Hits<'_, L::Elem>,
    frame: &PatternFrame<'_>,
    s: &mut ShadeScratch<L::Elem>,
    shadow_rays: &mut u64,
) {
    let n_hits = hits.rays.len;
    let shaft = Shaft::new(points, light.at, margin(L::UNIT_ROUNDOFF));
    s.occluders.gather(world, |b| shaft.may_meet(b), |n, offset| shaft.may_cross(points, n, offset));
    let (at, color): ([L; 3], [L; 3]) = (splat3(light.at), splat3(light.color));
    // A light in this very surface grazes it: what rounding makes of the right angle doesn't count.
    let least = L::splat(if light.touched.contains(&hits.id) { RESIDUE } else { 0.0 });
    let mut g = 0;
    while g < n_hits {
        let (p, n, ns) = (load3::<L>(&s.p, g), load3::<L>(&s.n, g), load3::<L>(&s.ns, g));
        let o = spawn_point(p, n, L::load(&s.offset[g..]));
        let to = minus(at, o);
        let distance = dot(to, to).sqrt();
        let l = scaled(L::one() / distance, to); // NaN for a light exactly here, which no comparison lets through
        let cosine = dot(ns, l);
        let front = least.lt(dot(n, l)) & L::zero().lt(cosine) & lanes_below::<L>(n_hits - g);
        if front.any() {
            *shadow_rays += front.bits().count_ones() as u64;
            let part = L::load(&hits.part[g..]);
            let outward = !L::load(&s.inside[g..]).same(L::one());
            let rays = ShadowRays { source: hits.id, part, outward, o, l, distance, touched: &light.touched };
            let seen = occlusion(world, &s.occluders, &rays, front, &mut s.shadow, &mut s.recorder);
            let zero = L::zero();
            let arrives: [L; 3] = three(|c| L::select(front, color[c] * seen[c], zero));
            let sum = load3::<L>(&s.diffuse, g);
            let lambert = L::select(front, cosine, zero);
            store3(&mut s.diffuse, g, three(|c| lambert.mul_add(arrives[c], sum[c])));
            if !surfacing.specular.is_zero() {
                let d = load3::<L>(&hits.rays.d, g);
                let r = mirrored(d, ns);
                let along = dot(r, l) / dot(d, d).sqrt();
                let shininess = slot(world, surfacing.shininess, frame, s, g)[0];
                let high = power(along, shininess, surfacing.shininess);
                let high = L::select(front & zero.lt(along), high, zero);
                let sum = load3::<L>(&s.specular, g);
                store3(&mut s.specular, g, three(|c| high.mul_add(arrives[c], sum[c])));
            }
        }
        g += L::WIDTH;
    }
}

/// The lanes that hold one of the last `n` hits.
#[inline(always)]
fn lanes_below<L: Lane>(n: usize) -> L::Mask {
    if n >= L::WIDTH { L::Mask::splat(true) } else { L::Mask::first(n) }
}

/// x^exponent for 0 < x ≤ 1. A constant whole exponent goes by squaring.
#[inline(always)]
fn power<L: Lane>(x: L, exponent: L, slot: Slot) -> L {
    match slot {
        // Beyond 4096 the pinned function is as fast.
        Slot::Constant([e, ..]) if e.fract() == 0.0 && (0.0..=4096.0).contains(&e) => {
            let (mut n, mut square, mut product) = (e as u32, x, L::one());
            while n > 0 {
                if n & 1 == 1 {
                    product = product * square;
                }
                square = square * square;
                n >>= 1;
            }
            product
        }
        _ => L::each([x, exponent], |[x, e]| [if x > 0.0 { fun::pow(x, e) } else { 0.0 }])[0],
    }
}

/// The value of a slot at the hits from number `g` on.
#[inline(always)]
fn slot<L: Lane>(world: &World, slot: Slot, frame: &PatternFrame<'_>, s: &ShadeScratch<L::Elem>, g: usize) -> [L; 3] {
    match slot {
        Slot::Constant(c) => splat3(c),
        Slot::Pattern(id) => {
            let (n, inside) = (load3::<L>(&s.n, g), L::load(&s.inside[g..]));
            let outward = each3(n, |x| L::select(inside.same(L::one()), -x, x));
            let at: PatternPoint<'_, L> = frame.point(&s.spaces, load3::<L>(&s.local, g), outward);
            world.patterns.eval(id, &at)
        }
    }
}

/// Colour, and the rays that follow.
#[inline(always)]
fn finish<L: Lane>(
    world: &World,
    m: &Surfacing,
    hits: &Hits<'_, L::Elem>,
    frame: &PatternFrame<'_>,
    s: &mut ShadeScratch<L::Elem>,
    radiance: &mut Column3<L::Elem>,
    children: Children<'_, L::Elem>,
) {
    let rays = hits.rays;
    let ambient: [L; 3] = splat3(world.ambient);
    let (mirrors, lets_through) = (children.spawn && m.mirrors(), children.spawn && m.lets_through());
    let mut g = 0;
    while g < rays.len {
        let weight = load3::<L>(&rays.weight, g);
        let mut value = [L::zero(); 3];
        if !m.ambient.is_zero() || !m.diffuse.is_zero() {
            let color = slot::<L>(world, m.color, frame, s, g);
            let share = slot::<L>(world, m.ambient, frame, s, g);
            let mut light = three(|c| share[c] * ambient[c]);
            if !m.diffuse.is_zero() {
                let share = slot::<L>(world, m.diffuse, frame, s, g);
                let sum = load3::<L>(&s.diffuse, g);
                light = three(|c| share[c].mul_add(sum[c], light[c]));
            }
            value = three(|c| color[c] * light[c]);
        }
        if !m.specular.is_zero() {
            let share = slot::<L>(world, m.specular, frame, s, g);
            let sum = load3::<L>(&s.specular, g);
            value = three(|c| share[c].mul_add(sum[c], value[c]));
        }
        let lanes = L::WIDTH.min(rays.len - g);
        add_to_slots::<L>(radiance, &rays.slot[g..g + lanes], three(|c| weight[c] * value[c]));

        if mirrors || lets_through {
            let d = load3::<L>(&rays.d, g);
            let (p, n, ns) = (load3::<L>(&s.p, g), load3::<L>(&s.n, g), load3::<L>(&s.ns, g));
            let offset = L::load(&s.offset[g..]);
            let mut back = slot::<L>(world, m.reflect, frame, s, g);
            let mut through = slot::<L>(world, m.transmit, frame, s, g);
            let mut onward = d;
            let inside = L::load(&s.inside[g..]);
            let outside = L::one() - inside;
            if let Some(ior) = m.ior {
                let bent = dielectric(d, ns, ior, inside.same(L::one()));
                back = three(|c| through[c].mul_add(bent.reflectance, back[c]));
                through = each3(through, |x| x * (L::one() - bent.reflectance));
                onward = bent.direction;
            }
            let live = lanes_below::<L>(rays.len - g);
            let part = L::load(&hits.part[g..]);
            let from = |o: [L; 3], d: [L; 3], w: [L; 3], outward: L| {
                // Mirrors that amplify, face to face, would leave the range of numbers.
                let most = L::splat(BRIGHTEST);
                let w = three(|c| (weight[c] * w[c]).min(most).max(-most));
                Child { o, d, w, part, outward }
            };
            if mirrors {
                // A tilted normal may send the mirrored ray into the surface; then the true normal decides.
                let tilted = mirrored(d, ns);
                let out = L::zero().lt(dot(tilted, n));
                let plain = mirrored(d, n);
                let r = three(|c| L::select(out, tilted[c], plain[c]));
                let child = from(spawn_point(p, n, offset), r, back, outside);
                push(children.mirrored, child, live, hits.id, &rays.slot[g..]);
            }
            if lets_through {
                let live = live & dot(onward, n).lt(L::zero());
                let child = from(spawn_point(p, n, -offset), onward, through, inside);
                push(children.transmitted, child, live, hits.id, &rays.slot[g..]);
            }
        }
        g += L::WIDTH;
    }
}

/// A ray that leaves the surface.
struct Child<L> {
    o: [L; 3],
    d: [L; 3],
    w: [L; 3],
    part: L,
    /// 1 where it leaves to the outside.
    outward: L,
}

/// Appends those of `live` that carry any weight.
#[inline(always)]
fn push<L: Lane>(batch: &mut RayBatch<L::Elem>, child: Child<L>, live: L::Mask, id: u32, slots: &[L::Elem]) {
    let zero = L::zero();
    let nothing = child.w[0].same(zero) & child.w[1].same(zero) & child.w[2].same(zero);
    let live = live & !nothing;
    let count = live.bits().count_ones() as usize;
    if count == 0 {
        return;
    }
    let at = batch.len;
    for c in 0..3 {
        child.o[c].compress(live, &mut batch.o[c][at..]);
        child.d[c].compress(live, &mut batch.d[c][at..]);
        child.w[c].compress(live, &mut batch.weight[c][at..]);
    }
    L::load(slots).compress(live, &mut batch.slot[at..]);
    L::splat(id as f64).compress(live, &mut batch.source[at..]);
    child.part.compress(live, &mut batch.source_part[at..]);
    child.outward.compress(live, &mut batch.outward[at..]);
    batch.len += count;
}

#[inline(always)]
fn add_to_slots<L: Lane>(radiance: &mut Column3<L::Elem>, slots: &[L::Elem], value: [L; 3]) {
    for (c, column) in radiance.iter_mut().enumerate() {
        let mut lanes = [L::Elem::default(); super::batch::PADDING];
        value[c].store(&mut lanes);
        for (x, slot) in lanes.iter().zip(slots) {
            let sum = &mut column[slot.to_f64() as usize];
            *sum = L::Elem::from_f64(sum.to_f64() + x.to_f64());
        }
    }
}
