//! Shades the hits of one run: points and normals first, then light by light, then colour and the rays that follow.

use super::batch::{Column, Column3, HitColumns, RayBatch, load3, put3, store3};
use super::bounds::Bounds;
use super::candidates::Candidates;
use super::cull::{Shaft, margin};
use super::footprint::Recorder;
use super::gathered::Gathered;
use super::highlight::power;
use super::light::{Shadow, ShadowRays, occlusion};
use super::material::{Slot, Surfacing};
use super::optics::mirrored;
use super::pattern_point::{PatternPoint, Rows};
use super::place::RESIDUE;
use super::run::LaneGroup;
use super::shape::primitive::spawn_point;
use super::shape::{Kind, Mesh, Primitive, Surface};
use super::span::Span;
use super::spawn::{Children, Leaving};
use super::surface_pattern::{PatternFrame, bumped};
use super::sweep::with_known;
use super::world::World;
use crate::math::real::{Mask, dot, minus, scaled, select3, splat3, three};
use crate::math::{Elem, Lane};

/// The hits of one run.
#[derive(Clone, Copy)]
pub struct Hits<'a, E: Elem> {
    /// The primitive that stands for all that were met.
    pub flock: u32,
    /// The one surface that all of them met, or [`MANY`].
    pub only: u32,
    /// The rays.
    pub rays: &'a RayBatch<E>,
    /// What they met.
    pub hits: &'a HitColumns<E>,
    /// Which of the rays.
    pub groups: &'a [LaneGroup],
}

/// What shading keeps of each hit between its passes, at the ray's own place.
#[derive(Default)]
pub struct ShadeScratch<E: Elem> {
    p: Column3<E>,
    /// Geometric normal on the viewer's side.
    n: Column3<E>,
    /// Shading normal; only where it is another.
    ns: Column3<E>,
    /// Only where a pattern asks.
    local: Column3<E>,
    offset: Column<E>,
    /// 1 where the ray comes from inside.
    inside: Column<E>,
    spaces: Vec<Rows>,
    shadow: Shadow,
    /// What may stand before each light.
    occluders: Vec<Candidates>,
    /// Notes what the rays depend on.
    pub recorder: Recorder,
}

impl<E: Elem> ShadeScratch<E> {
    /// Keeps nothing yet.
    pub fn new(recorder: Recorder) -> Self {
        ShadeScratch { recorder, ..ShadeScratch::default() }
    }
}

/// Leaves what the hits give back in `gathered`, and the rays that follow in `children`.
#[inline(always)]
pub fn shade<L: Lane, const AT_EYE: bool>(
    world: &World,
    hits: Hits<'_, L::Elem>,
    s: &mut ShadeScratch<L::Elem>,
    gathered: &mut Gathered<'_, L::Elem>,
    children: Children<'_, L::Elem>,
    shadow_rays: &mut u64,
) {
    s.shadow.deep = !gathered.first;
    let primitive = world.primitive(hits.flock);
    let surfacing = world.surfacing(hits.flock);
    let frame = PatternFrame::new(world, primitive, surfacing, &mut s.spaces);
    let bent = surfacing.bump.is_some() || primitive.kind.may_be_smooth();
    let mesh = match primitive.kind {
        Kind::Mesh(i) => world.meshes.get(i as usize),
        _ => None,
    };
    let run = RunOfHits { world, surfacing, frame, bent, hits, mesh };
    // Asked once for all, where there is one: see `sweep`.
    let points = match world.primitives.get(hits.only as usize) {
        Some(primitive) => with_known!(primitive, known => run.surfaces_of::<L, AT_EYE>(known, s)),
        None => run.surfaces::<L, AT_EYE>(s),
    };
    if surfacing.lit {
        if s.recorder.is_on() {
            s.recorder.lit(points);
        }
        run.find_occluders(&points, margin(L::UNIT_ROUNDOFF), &mut s.occluders);
    }
    run.finish::<L>(s, gathered, children, shadow_rays);
}

/// A run and what all its hits have in common.
struct RunOfHits<'a, E: Elem> {
    world: &'a World,
    surfacing: &'a Surfacing,
    frame: PatternFrame<'a>,
    /// Whether shading normals may differ from geometric ones.
    bent: bool,
    hits: Hits<'a, E>,
    /// The mesh, where that is what was met.
    mesh: Option<&'a Mesh>,
}

impl<E: Elem> RunOfHits<'_, E> {
    /// Points, normals and offsets of all hits, which lie on one `primitive`; gives a box around the points.
    #[inline(always)]
    fn surfaces_of<L: Lane<Elem = E>, const AT_EYE: bool>(
        &self,
        primitive: &Primitive,
        s: &mut ShadeScratch<E>,
    ) -> Bounds {
        let (rays, hits, tables) = (self.hits.rays, self.hits.hits, self.world.tables());
        let mut points = Span::<L>::new();
        for group in self.hits.groups {
            let g = group.first as usize;
            let d = load3::<L>(&rays.d, g);
            let o = if AT_EYE { [L::zero(); 3] } else { load3::<L>(&rays.o, g) };
            let (t, part) = (L::load(&hits.t[g..]), L::load(&hits.part[g..]));
            let surface = primitive.surface::<L, AT_EYE>(tables, o, d, t, part);
            points.hold(L::Mask::from_bits(group.bits), surface.p);
            self.keep(g, d, &surface, s);
        }
        points.bounds()
    }

    /// Points, normals and offsets of all hits; gives a box around the points.
    #[inline(always)]
    fn surfaces<L: Lane<Elem = E>, const AT_EYE: bool>(&self, s: &mut ShadeScratch<E>) -> Bounds {
        let (rays, hits) = (self.hits.rays, self.hits.hits);
        let mut points = Span::<L>::new();
        for group in self.hits.groups {
            let g = group.first as usize;
            let d = load3::<L>(&rays.d, g);
            let o = if AT_EYE { [L::zero(); 3] } else { load3::<L>(&rays.o, g) };
            let at = (L::load(&hits.t[g..]), L::load(&hits.part[g..]));
            let ids = L::load(&hits.id[g..]);
            let live = L::Mask::from_bits(group.bits);
            if let Some(mesh) = self.mesh {
                let ids = L::select(live, ids, L::splat(mesh.first as f64));
                let surface = surface_of_mesh(mesh, ids, (o, d));
                points.hold(live, surface.p);
                self.keep(g, d, &surface, s);
                continue;
            }
            let id = hits.id[g + group.bits.trailing_zeros() as usize];
            let surface = self.world.surface::<L, AT_EYE>(id.to_f64() as u32, (o, d), at);
            points.hold(live, surface.p);
            self.keep(g, d, &surface, s);
            // Mostly that is all; the surfaces of others are put over it, one after another.
            let mut rest = group.bits & !ids.same(L::splat(id.to_f64())).bits();
            while rest != 0 {
                let id = hits.id[g + rest.trailing_zeros() as usize].to_f64();
                let here = ids.same(L::splat(id));
                self.keep_another(g, id as u32, (o, d), at, here, s);
                points.hold(live & here, load3(&s.p, g));
                rest &= !here.bits();
            }
        }
        points.bounds()
    }

    /// Keeps the surfaces that rays along `d` met at the places from `g` on.
    #[inline(always)]
    fn keep<L: Lane<Elem = E>>(&self, g: usize, d: [L; 3], surface: &Surface<L>, s: &mut ShadeScratch<E>) {
        let inside = L::zero().lt(dot(surface.n, d));
        let faced = FacedBy { inside };
        store3(&mut s.p, g, surface.p);
        store3(&mut s.n, g, faced.face(surface.n));
        if self.bent {
            let mut ns = surface.ns;
            if self.frame.has_bump() {
                ns = bumped(&self.frame, &s.spaces, surface.local, surface.n, ns);
            }
            store3(&mut s.ns, g, faced.face(ns));
        }
        if self.surfacing.patterned {
            store3(&mut s.local, g, surface.local);
        }
        surface.offset.store(&mut s.offset[g..]);
        L::select(inside, L::one(), L::zero()).store(&mut s.inside[g..]);
    }

    /// Keeps surface `id` in the lanes of `here`; in a function of its own, for kernels are large. Such runs have no pattern, and
    /// so no bump.
    #[inline(always)]
    fn keep_another<L: Lane<Elem = E>>(
        &self,
        g: usize,
        id: u32,
        ray: ([L; 3], [L; 3]),
        at: (L, L),
        here: L::Mask,
        s: &mut ShadeScratch<E>,
    ) {
        L::vectorize(
            #[inline(always)]
            || {
                let surface = self.world.surface::<L, false>(id, ray, at);
                let inside = L::zero().lt(dot(surface.n, ray.1));
                let faced = FacedBy { inside };
                put3(&mut s.p, g, here, surface.p);
                put3(&mut s.n, g, here, faced.face(surface.n));
                put3(&mut s.ns, g, here, faced.face(surface.ns));
                let inside = L::select(inside, L::one(), L::zero());
                L::select(here, surface.offset, L::load(&s.offset[g..])).store(&mut s.offset[g..]);
                L::select(here, inside, L::load(&s.inside[g..])).store(&mut s.inside[g..]);
            },
        );
    }

    /// What may stand between the hits, which lie in `points`, and each light.
    #[inline(always)]
    fn find_occluders(&self, points: &Bounds, margin: f64, occluders: &mut Vec<Candidates>) {
        let rays = self.hits.groups.iter().map(|g| g.bits.count_ones() as usize).sum();
        occluders.resize_with(self.world.lights.len(), Candidates::default);
        for (light, occluders) in self.world.lights.iter().zip(occluders) {
            let shaft = Shaft::new(points, light.at, margin);
            occluders.gather_if_it_pays(
                self.world,
                rays,
                #[inline(always)]
                |b| shaft.may_meet(b),
                |n, offset| shaft.may_cross(points, n, offset),
            );
        }
    }

    /// Light, colour, and the rays that follow.
    #[inline(always)]
    fn finish<L: Lane<Elem = E>>(
        &self,
        s: &mut ShadeScratch<E>,
        gathered: &mut Gathered<'_, E>,
        mut children: Children<'_, E>,
        shadow_rays: &mut u64,
    ) {
        let (rays, m) = (self.hits.rays, self.surfacing);
        let ambient: [L; 3] = splat3(self.world.ambient);
        // Asked once and not for each register.
        let (glows, diffuses, shines) = (!m.ambient.is_zero(), !m.diffuse.is_zero(), !m.specular.is_zero());
        let spawns = children.any(m);
        for group in self.hits.groups {
            let g = group.first as usize;
            let hit = LitHits::<L> {
                d: load3(&rays.d, g),
                p: load3(&s.p, g),
                n: load3(&s.n, g),
                ns: load3(if self.bent { &s.ns } else { &s.n }, g),
                local: if m.patterned { load3(&s.local, g) } else { [L::zero(); 3] },
                offset: L::load(&s.offset[g..]),
                inside: L::load(&s.inside[g..]),
            };
            let (mut diffuse, mut specular) = ([L::zero(); 3], [L::zero(); 3]);
            if m.lit {
                self.illuminate(group, &hit, s, (&mut diffuse, shines.then_some(&mut specular)), shadow_rays);
            }
            let spaces = &s.spaces;
            let mut value = [L::zero(); 3];
            if glows || diffuses {
                let color = self.slot(m.color, &hit, spaces);
                let share = self.slot(m.ambient, &hit, spaces);
                let mut light = three!(c => share[c] * ambient[c]);
                if diffuses {
                    let share = self.slot(m.diffuse, &hit, spaces);
                    light = three!(c => share[c].mul_add(diffuse[c], light[c]));
                }
                value = three!(c => color[c] * light[c]);
            }
            if shines {
                let share = self.slot(m.specular, &hit, spaces);
                value = three!(c => share[c].mul_add(specular[c], value[c]));
            }
            let weight = if gathered.first { [L::one(); 3] } else { load3::<L>(&rays.weight, g) };
            gathered.add(group, &rays.slot, three!(c => weight[c] * value[c]));

            if spawns {
                let (back, through) = (self.slot(m.reflect, &hit, spaces), self.slot(m.transmit, &hit, spaces));
                let leaving = Leaving {
                    d: hit.d,
                    p: hit.p,
                    n: hit.n,
                    ns: hit.ns,
                    offset: hit.offset,
                    inside: hit.inside,
                    weight,
                    id: L::load(&self.hits.hits.id[g..]),
                    part: L::load(&self.hits.hits.part[g..]),
                    slot: L::load(&rays.slot[g..]),
                };
                children.spawn(m, &leaving, back, through, L::Mask::from_bits(group.bits));
            }
        }
    }

    /// Adds every light's share to the diffuse sum, and to the specular one where the material shines.
    #[inline(always)]
    fn illuminate<L: Lane<Elem = E>>(
        &self,
        group: &LaneGroup,
        hit: &LitHits<L>,
        s: &mut ShadeScratch<E>,
        (diffuse, mut specular): (&mut [L; 3], Option<&mut [L; 3]>),
        shadow_rays: &mut u64,
    ) {
        let g = group.first as usize;
        let (zero, live) = (L::zero(), L::Mask::from_bits(group.bits));
        let o = spawn_point(hit.p, hit.n, hit.offset);
        let (source, part) = (L::load(&self.hits.hits.id[g..]), L::load(&self.hits.hits.part[g..]));
        let outward = L::one() - hit.inside;
        let mut mirror: Option<[L; 3]> = None;
        for (number, light) in self.world.lights.iter().enumerate() {
            let (at, color): ([L; 3], [L; 3]) = (splat3(light.at), splat3(light.color));
            // A light in this very surface grazes it: what rounding makes of the right angle doesn't count. (Such surfaces are
            // runs of their own.)
            let least = L::splat(if self.world.touches(light, self.hits.flock) { RESIDUE } else { 0.0 });
            let to = minus(at, o);
            // Most of what faces away does so by far.
            let size = to[0].abs() + to[1].abs() + to[2].abs();
            if !(live & !dot(hit.n, to).lt(size * L::splat(-FAR_FROM_GRAZING))).any() {
                continue;
            }
            let distance = dot(to, to).sqrt();
            let l = scaled(L::one() / distance, to); // NaN for a light exactly here, which no comparison lets through
            let cosine = dot(hit.ns, l);
            let front = least.lt(dot(hit.n, l)) & zero.lt(cosine) & live;
            if !front.any() {
                continue;
            }
            *shadow_rays += front.bits().count_ones() as u64;
            let rays = ShadowRays { source, part, outward, o, l, distance, light: number, touched: &light.touched };
            let seen = occlusion(self.world, &s.occluders[number], &rays, front, &mut s.shadow, &mut s.recorder);
            let arrives: [L; 3] = three!(c => L::select(front, color[c] * seen[c], zero));
            let lambert = L::select(front, cosine, zero);
            *diffuse = three!(c => lambert.mul_add(arrives[c], diffuse[c]));
            if let Some(specular) = &mut specular {
                let r = match mirror {
                    Some(known) => known,
                    None => mirrored(hit.d, hit.ns),
                };
                mirror = Some(r);
                let along = dot(r, l);
                if !(front & zero.lt(along)).any() {
                    continue;
                }
                let along = along / dot(hit.d, hit.d).sqrt();
                let shininess = self.slot(self.surfacing.shininess, hit, &s.spaces)[0];
                let high = power(along, shininess, self.surfacing.shininess);
                let high = L::select(front & zero.lt(along), high, zero);
                **specular = three!(c => high.mul_add(arrives[c], specular[c]));
            }
        }
    }

    /// The value of a slot.
    #[inline(always)]
    fn slot<L: Lane<Elem = E>>(&self, slot: Slot, hit: &LitHits<L>, spaces: &[Rows]) -> [L; 3] {
        match slot {
            Slot::Constant(c) => splat3(c),
            Slot::Pattern(id) => {
                let outward = FacedBy { inside: hit.inside.same(L::one()) }.face(hit.n);
                let at: PatternPoint<'_, L> = self.frame.point(spaces, hit.local, outward);
                self.world.patterns.eval(id, &at)
            }
        }
    }
}

/// Hits of one register.
struct LitHits<L> {
    d: [L; 3],
    p: [L; 3],
    n: [L; 3],
    ns: [L; 3],
    local: [L; 3],
    offset: L,
    inside: L,
}

/// Turns normals to the viewer's side, and back.
struct FacedBy<M> {
    inside: M,
}

impl<M: Mask> FacedBy<M> {
    #[inline(always)]
    fn face<L: Lane<Mask = M>>(&self, n: [L; 3]) -> [L; 3] {
        select3(self.inside, [-n[0], -n[1], -n[2]], n)
    }
}

/// The surfaces where rays meet triangles of `mesh`, each lane its own; in a function of its own, for it is large.
#[inline(always)]
fn surface_of_mesh<L: Lane>(mesh: &Mesh, ids: L, ray: ([L; 3], [L; 3])) -> Surface<L> {
    L::vectorize(
        #[inline(always)]
        || mesh.surfaces(ids - L::splat(mesh.first as f64), ray),
    )
}

/// Relative to the light's distance: how far below its horizon a surface must be to face away whatever rounding does; thousands
/// of roundings of `f64` and of `f32`.
const FAR_FROM_GRAZING: f64 = 1.0 / 1024.0;
