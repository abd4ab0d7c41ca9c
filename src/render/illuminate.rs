//! The light that arrives at the hits of a run: light by light, each in three passes over the hits.
//!
//! First it is found which hits face the light, and their rays to it; then each surface that may stand in between is tested against
//! all of these, in a loop of its own kind (see `known`); then what arrives is added to the sums of each hit. So a register's sums are
//! added up in the order of the lights, whatever its company.

use super::ball::Ball;
use super::batch::{Column, Column3, load3, store3};
use super::between::Blocked;
use super::candidates::Candidates;
use super::confine::Confined;
use super::footprint::Recorder;
use super::highlight::power;
use super::known::{Known, with_known};
use super::light::{dimmed_by, occlusion};
use super::optics::mirrored;
use super::paint::{Paint, Paints};
use super::place::RESIDUE;
use super::ray::Own;
use super::run::MANY;
use super::run_of_hits::{RunOfHits, Surfaces};
use super::shadow_rays::{Shadow, ShadowRays};
use super::shape::primitive::spawn_point;
use super::world::PointLight;
use crate::math::real::{Mask, dot, minus, scaled, splat3, three};
use crate::math::{Elem, Lane};

/// The light that arrives at each hit, and what is found on the way there.
#[derive(Default)]
pub struct Illumination<E: Elem> {
    /// Sums over the lights of what a matte surface scatters.
    pub diffuse: Column3<E>,
    /// Those of highlights; only where the material has any.
    pub specular: Column3<E>,
    /// Rays to the light at hand: where they start,
    o: Column3<E>,
    /// their directions, of unit length,
    l: Column3<E>,
    /// how far it is,
    distance: Column<E>,
    /// and the cosine to the shading normal.
    cosine: Column<E>,
    /// By group of the run, the hits that face it, one bit a ray,
    front: Vec<u32>,
    /// and those of them that see it.
    open: Vec<u32>,
    /// What lets part of it through.
    dimming: Vec<u32>,
    shadow: Shadow,
}

/// Relative to the light's distance: how far below its horizon a surface must be to face away whatever rounding does; thousands
/// of roundings of `f64` and of `f32`.
const FAR_FROM_GRAZING: f64 = 1.0 / 1024.0;

/// What the lights of a run share.
pub struct Lighting<'a, L: Lane> {
    /// What may stand before each light.
    pub occluders: &'a [Candidates],
    /// The exponent of highlights; `None` without any.
    pub shininess: Option<Paint<L>>,
    /// Columns of patterns' values.
    pub paints: &'a Paints<L::Elem>,
}

impl<E: Elem> RunOfHits<'_, E> {
    /// Adds up what arrives from all lights. `deep` says that the hits aren't those of camera rays.
    #[inline(always)]
    pub fn illuminate<L: Lane<Elem = E>>(
        &self,
        s: &Surfaces<E>,
        lighting: &Lighting<'_, L>,
        to: &mut Illumination<E>,
        (deep, recorder): (bool, &mut Recorder),
        shadow_rays: &mut u64,
    ) {
        to.shadow.deep = deep;
        for group in self.hits.groups {
            store3(&mut to.diffuse, group.place(), [L::zero(); 3]);
            if lighting.shininess.is_some() {
                store3(&mut to.specular, group.place(), [L::zero(); 3]);
            }
        }
        for (number, light) in self.world.lights.iter().enumerate() {
            let rays = self.face::<L>(light, s, to);
            if rays == 0 {
                continue;
            }
            *shadow_rays += rays;
            let occluders = &lighting.occluders[number];
            let is_listed =
                !occluders.tree && light.touched.is_empty() && occluders.ids.iter().all(|&k| self.world.is_plain(k));
            to.dimming.clear();
            if is_listed {
                for &k in &occluders.ids {
                    match self.world.constant_transmission(k) {
                        Some([0.0, 0.0, 0.0]) => self.shade_by::<L>(k, s, to, recorder),
                        Some([1.0, 1.0, 1.0]) => {}
                        _ => to.dimming.push(k),
                    }
                }
            }
            let asks = if is_listed { (!to.dimming.is_empty()).then_some(None) } else { Some(Some(occluders)) };
            self.add_up::<L>((number, light), asks, s, lighting, to, recorder);
        }
    }

    /// Finds the hits that face a light, and their rays to it; gives the number of rays.
    #[inline(always)]
    fn face<L: Lane<Elem = E>>(&self, light: &PointLight, s: &Surfaces<E>, to: &mut Illumination<E>) -> u64 {
        let (at, zero): ([L; 3], L) = (splat3(light.at), L::zero());
        // A light in this very surface grazes it: what rounding makes of the right angle doesn't count. (Such surfaces are
        // runs of their own.)
        let least = L::splat(if self.world.touches(light, self.hits.flock) { RESIDUE } else { 0.0 });
        let mut rays = 0;
        to.front.clear();
        to.front.resize(self.hits.groups.len(), 0);
        for (group, facing) in self.hits.groups.iter().zip(&mut to.front) {
            let g = group.place();
            let live = L::Mask::from_bits(group.bits);
            let n = load3::<L>(&s.n, g);
            let o = spawn_point(load3(&s.p, g), n, L::load(&s.offset[g..]));
            let way = minus(at, o);
            // Most of what faces away does so by far.
            let size = way[0].abs() + way[1].abs() + way[2].abs();
            if !(live & !dot(n, way).lt(size * L::splat(-FAR_FROM_GRAZING))).any() {
                continue;
            }
            let distance = dot(way, way).sqrt();
            let l = scaled(L::one() / distance, way); // NaN for a light exactly here, which no comparison lets through
            let (upright, cosine) = (dot(n, l), dot(load3(s.shading_normals(self.bent), g), l));
            let front = (least.lt(upright) & zero.lt(cosine) & live).bits();
            if front == 0 {
                continue;
            }
            rays += front.count_ones() as u64;
            store3(&mut to.o, g, o);
            store3(&mut to.l, g, l);
            distance.store(&mut to.distance[g..]);
            cosine.store(&mut to.cosine[g..]);
            *facing = front;
        }
        to.open.clone_from(&to.front);
        rays
    }

    /// Stops the rays that opaque surface `k` stands before.
    #[inline(always)]
    fn shade_by<L: Lane<Elem = E>>(&self, k: u32, s: &Surfaces<E>, to: &mut Illumination<E>, recorder: &mut Recorder) {
        let primitive = self.world.primitive(k);
        if self.hits.only == k && s.all_outside && primitive.kind.is_left_for_good() {
            return;
        }
        L::vectorize(
            #[inline(always)]
            || {
                let ball = self.world.ball(k).filter(Ball::is_there);
                let stopped = with_known!(primitive, known => self.stop::<L, _>((known, k), ball, s, to));
                if stopped && recorder.is_on() {
                    recorder.shaded(k);
                }
            },
        );
    }

    /// Whether any ray is stopped by the surface, which stands in the ball.
    #[inline(always)]
    fn stop<L: Lane<Elem = E>, S: Known>(
        &self,
        (surface, k): (S, u32),
        ball: Option<Ball>,
        s: &Surfaces<E>,
        to: &mut Illumination<E>,
    ) -> bool {
        let mut stopped = false;
        // Where all start on another one, none needs to be asked.
        let starts_here = self.hits.only == MANY || self.hits.only == k;
        for (group, open) in self.hits.groups.iter().zip(&mut to.open) {
            if *open == 0 {
                continue;
            }
            let g = group.place();
            let (o, l) = (load3::<L>(&to.o, g), load3::<L>(&to.l, g));
            let mut own = None;
            if starts_here {
                let here = L::load(&self.hits.hits.id[g..]).same(L::splat(k as f64));
                if here.any() {
                    let outward = !L::load(&s.inside[g..]).same(L::one());
                    if surface.is_left_for_good() && *open & !(here & outward).bits() == 0 {
                        continue;
                    }
                    own = Own::of(here, L::load(&self.hits.hits.part[g..]), outward);
                }
            }
            let mut met = L::Mask::splat(true);
            if let Some(ball) = &ball {
                met = !ball.passed_by::<L, false>((o, l));
                if let Some(own) = &own {
                    met = met | own.here;
                }
                if *open & met.bits() == 0 {
                    continue;
                }
            }
            let distance = L::load(&to.distance[g..]);
            let mut blocked = Blocked { distance, blocked: L::Mask::splat(false) };
            let visit = &mut Confined::new(met, None, (o, l), &mut blocked);
            surface.crossings::<L, false>(self.world.tables(), (o, l), own, visit);
            let blocked = blocked.blocked.bits();
            stopped |= *open & blocked != 0;
            *open &= !blocked;
        }
        stopped
    }

    /// Adds what arrives from light `number` to the sums. `asks` says whether more than what is open matters: what dims the light, or
    /// all that may stand before it.
    #[inline(always)]
    fn add_up<L: Lane<Elem = E>>(
        &self,
        (number, light): (usize, &PointLight),
        asks: Option<Option<&Candidates>>,
        s: &Surfaces<E>,
        lighting: &Lighting<'_, L>,
        to: &mut Illumination<E>,
        recorder: &mut Recorder,
    ) {
        let (color, zero): ([L; 3], L) = (splat3(light.color), L::zero());
        let all = L::Mask::splat(true).bits();
        for ((group, front), open) in self.hits.groups.iter().zip(&to.front).zip(&to.open) {
            if *open == 0 {
                continue;
            }
            let g = group.place();
            // Mostly all of a register is lit, and there is nothing to choose.
            let is_whole = *open == all;
            let (front, open) = (L::Mask::from_bits(*front), L::Mask::from_bits(*open));
            let l = load3::<L>(&to.l, g);
            let mut arrives = color;
            if !is_whole {
                arrives = three!(c => L::select(open, color[c], zero));
            }
            if let Some(occluders) = asks {
                let rays = ShadowRays {
                    source: L::load(&self.hits.hits.id[g..]),
                    part: L::load(&self.hits.hits.part[g..]),
                    outward: L::one() - L::load(&s.inside[g..]),
                    o: load3(&to.o, g),
                    l,
                    distance: L::load(&to.distance[g..]),
                    light: number,
                    touched: &light.touched,
                };
                let seen = match occluders {
                    Some(occluders) => occlusion(self.world, occluders, &rays, front, &mut to.shadow, recorder),
                    None => dimmed_by(self.world, &to.dimming, &rays, open, &mut to.shadow, recorder),
                };
                arrives = three!(c => L::select(front, color[c] * seen[c], zero));
            }
            let mut lambert = L::load(&to.cosine[g..]);
            if !is_whole {
                lambert = L::select(front, lambert, zero);
            }
            let sum = load3::<L>(&to.diffuse, g);
            store3(&mut to.diffuse, g, three!(c => lambert.mul_add(arrives[c], sum[c])));
            let Some(shininess) = lighting.shininess else { continue };
            let d = load3::<L>(&self.hits.rays.d, g);
            let r = mirrored(d, load3(s.shading_normals(self.bent), g));
            let along = dot(r, l);
            let bright = front & zero.lt(along);
            if !bright.any() {
                continue;
            }
            let along = along / dot(d, d).sqrt();
            let high = power(along, lighting.paints.at(shininess, g)[0], self.surfacing.shininess);
            let high = L::select(bright, high, zero);
            let sum = load3::<L>(&to.specular, g);
            store3(&mut to.specular, g, three!(c => high.mul_add(arrives[c], sum[c])));
        }
    }
}
