//! Shades the hits of one run: points and normals first, then light by light, then colour and the rays that follow.

use super::batch::load3;
use super::bounds::Bounds;
use super::candidates::Candidates;
use super::cull::{Shaft, margin};
use super::footprint::Recorder;
use super::gathered::Gathered;
use super::illuminate::{Illumination, Lighting};
use super::paint::{Paint, Paints};
use super::pattern_point::Rows;
use super::run_of_hits::{Hits, RunOfHits, Surfaces};
use super::spawn::{Children, Leaving};
use super::world::World;
use crate::math::real::{Mask, splat3, three};
use crate::math::{Elem, Lane};

/// What shading keeps of each hit between its passes, at the ray's own place.
#[derive(Default)]
pub struct ShadeScratch<E: Elem> {
    surfaces: Surfaces<E>,
    light: Illumination<E>,
    paints: Paints<E>,
    spaces: Vec<Rows>,
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
    let run = RunOfHits::new(world, hits, &mut s.spaces);
    let points = L::vectorize(
        #[inline(always)]
        || run.surfaces::<L, AT_EYE>(&mut s.surfaces),
    );
    let mut passes = Passes {
        run,
        surfaces: &s.surfaces,
        light: &mut s.light,
        paints: &mut s.paints,
        occluders: &mut s.occluders,
        recorder: &mut s.recorder,
    };
    passes.finish::<L>(&points, gathered, children, shadow_rays);
}

/// What comes after points and normals are known. It doesn't depend on where rays start, so it is compiled once for each kind of lanes.
struct Passes<'a, E: Elem> {
    run: RunOfHits<'a, E>,
    surfaces: &'a Surfaces<E>,
    light: &'a mut Illumination<E>,
    paints: &'a mut Paints<E>,
    occluders: &'a mut Vec<Candidates>,
    recorder: &'a mut Recorder,
}

impl<E: Elem> Passes<'_, E> {
    fn finish<L: Lane<Elem = E>>(
        &mut self,
        points: &Bounds,
        gathered: &mut Gathered<'_, E>,
        children: Children<'_, E>,
        shadow_rays: &mut u64,
    ) {
        self.paints.clear();
        if self.run.surfacing.lit {
            if self.recorder.is_on() {
                self.recorder.lit(*points);
            }
            self.find_occluders(points, margin(L::UNIT_ROUNDOFF));
            L::vectorize(
                #[inline(always)]
                || self.illuminate::<L>(!gathered.first, shadow_rays),
            );
        }
        L::vectorize(
            #[inline(always)]
            || self.color::<L>(gathered, children),
        );
    }

    /// What may stand between the hits, which lie in `points`, and each light.
    fn find_occluders(&mut self, points: &Bounds, margin: f64) {
        let world = self.run.world;
        self.occluders.resize_with(world.lights.len(), Candidates::default);
        for (light, occluders) in world.lights.iter().zip(&mut *self.occluders) {
            let shaft = Shaft::new(points, light.at, margin);
            occluders.gather_if_it_pays(
                world,
                self.run.hits.count,
                #[inline(always)]
                |b| shaft.may_meet(b),
                |n, offset| shaft.may_cross(points, n, offset),
            );
        }
    }

    #[inline(always)]
    fn illuminate<L: Lane<Elem = E>>(&mut self, deep: bool, shadow_rays: &mut u64) {
        let m = self.run.surfacing;
        let mut shininess = None;
        if !m.specular.is_zero() {
            shininess = Some(self.run.paint::<L>(m.shininess, self.surfaces, self.paints));
        }
        let lighting = Lighting { occluders: self.occluders, shininess, paints: self.paints };
        self.run.illuminate(self.surfaces, &lighting, self.light, (deep, self.recorder), shadow_rays);
    }

    /// Colour, and the rays that follow.
    #[inline(always)]
    fn color<L: Lane<Elem = E>>(&mut self, gathered: &mut Gathered<'_, E>, mut children: Children<'_, E>) {
        let (m, rays, s) = (self.run.surfacing, self.run.hits.rays, self.surfaces);
        // Asked once and not for each register.
        let (glows, diffuses, shines) = (!m.ambient.is_zero(), !m.diffuse.is_zero(), !m.specular.is_zero());
        let spawns = children.any(m);
        let nothing = Paint::Same([L::zero(); 3]);
        let (mut color, mut glow, mut diffuse, mut specular) = (nothing, nothing, nothing, nothing);
        if glows || diffuses {
            color = self.run.paint::<L>(m.color, s, self.paints);
            glow = self.run.paint::<L>(m.ambient, s, self.paints);
        }
        if diffuses {
            diffuse = self.run.paint::<L>(m.diffuse, s, self.paints);
        }
        if shines {
            specular = self.run.paint::<L>(m.specular, s, self.paints);
        }
        let (mut back, mut through) = (nothing, nothing);
        if spawns {
            back = self.run.paint::<L>(m.reflect, s, self.paints);
            through = self.run.paint::<L>(m.transmit, s, self.paints);
        }
        let ambient: [L; 3] = splat3(self.run.world.ambient);
        let (paints, lights) = (&*self.paints, &*self.light);
        for group in self.run.hits.groups {
            let g = group.place();
            let mut value = [L::zero(); 3];
            if glows || diffuses {
                let (color, share) = (paints.at(color, g), paints.at(glow, g));
                let mut light = three!(c => share[c] * ambient[c]);
                if diffuses {
                    let (share, arrives) = (paints.at(diffuse, g), load3::<L>(&lights.diffuse, g));
                    light = three!(c => share[c].mul_add(arrives[c], light[c]));
                }
                value = three!(c => color[c] * light[c]);
            }
            if shines {
                let (share, arrives) = (paints.at(specular, g), load3::<L>(&lights.specular, g));
                value = three!(c => share[c].mul_add(arrives[c], value[c]));
            }
            let mut weight = [L::one(); 3];
            if !gathered.first {
                weight = load3::<L>(&rays.weight, g);
                value = three!(c => weight[c] * value[c]);
            }
            gathered.add(group, &rays.slot, value);

            if spawns {
                let leaving = Leaving {
                    d: load3(&rays.d, g),
                    p: load3(&s.p, g),
                    n: load3(&s.n, g),
                    ns: load3(s.shading_normals(self.run.bent), g),
                    offset: L::load(&s.offset[g..]),
                    inside: L::load(&s.inside[g..]),
                    weight,
                    id: L::load(&self.run.hits.hits.id[g..]),
                    part: L::load(&self.run.hits.hits.part[g..]),
                    slot: L::load(&rays.slot[g..]),
                };
                let (back, through) = (paints.at(back, g), paints.at(through, g));
                children.spawn(m, &leaving, back, through, L::Mask::from_bits(group.bits));
            }
        }
    }
}
