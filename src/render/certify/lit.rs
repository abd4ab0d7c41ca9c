//! The light of a surface: Phong's terms as forms, its mirror image, and what of each light arrives.

use super::super::material::Slot;
use super::super::optics::mirrored;
use super::bound::{Bound, Span};
use super::bundle::{Bundle, bounds_of, from_constant};
use super::certifier::Certifier;
use super::met::Met;
use super::polygon::Polygon;
use super::sheet::{Sheet, Sheets};
use super::study::Study;
use crate::math::Form;
use crate::math::real::{dot, three};

/// Light that depends on a surface's colour: `plain + color·tinted`.
#[derive(Clone, Copy)]
pub struct Shade {
    /// Highlights.
    pub plain: [Form; 3],
    /// Ambient and diffuse.
    pub tinted: [Form; 3],
}

/// The shares of a material's terms: where a pattern decides, anything that it may be.
struct Shares {
    ambient: [Form; 3],
    diffuse: [Form; 3],
    specular: [Form; 3],
    /// `None` where a pattern decides.
    shininess: Option<f64>,
    reflect: [Span; 3],
    transmit: [Span; 3],
}

impl Certifier<'_> {
    /// What surface `id` lets through of rays that go straight on.
    pub(super) fn straight_through(&self, id: u32) -> Option<[f64; 3]> {
        let m = self.world.surfacing(id);
        match (m.transmit, m.ior) {
            (Slot::Constant(share), None) => Some(share),
            _ => None,
        }
    }
}

impl Shares {
    fn of(scene: &Certifier<'_>, met: &Met<'_>) -> Shares {
        let m = met.surfacing;
        let form = |s: Slot| scene.slot_range(s).map(|[lo, hi]| Form::between(lo, hi));
        Shares {
            ambient: form(m.ambient),
            diffuse: form(m.diffuse),
            specular: form(m.specular),
            shininess: if let Slot::Constant(c) = m.shininess { Some(c[0]) } else { None },
            reflect: scene.slot_range(m.reflect),
            transmit: scene.slot_range(m.transmit),
        }
    }
}

impl<'c> Study<'c> {
    /// The light that a sheet sends along the rays, but for what goes straight through it.
    pub fn surface_light(&mut self, p: &Polygon, ray: &Bundle, sheet: &Sheet, depth: u32) -> Bound {
        let world = self.scene.world;
        let nothing_known = || Bound::within(p, self.scene.surface_ceiling(sheet.id, depth));
        let Some(met) = Met::new(world, ray, sheet) else { return nothing_known() };
        if !met.is_useful(p) {
            return nothing_known();
        }
        let shares = Shares::of(self.scene, &met);
        let outer = std::mem::replace(&mut self.ceiling, self.scene.own_ceiling(sheet.id));
        let own = self.own_light(p, &met, &shares);
        self.ceiling = outer;
        let straight = self.scene.straight_through(sheet.id).is_some();
        let goes_through = met.surfacing.lets_through() && !straight;
        if depth == 0 || !(met.surfacing.mirrors() || goes_through) {
            return own;
        }
        if goes_through {
            return own.plus(self.bent_light(p, &met, (shares.reflect, shares.transmit), depth - 1));
        }
        let reflect = shares.reflect.map(|[lo, hi]| Form::between(lo, hi));
        let back = self.onward(p, reflect, (depth - 1, 0.0), |study| match met.at {
            Some(o) if met.bent.is_none() && met.surfacing.bump.is_none() => {
                let d = mirrored(met.d, met.n);
                study.seen(p, &Bundle { o, d, start: Some(met.start), rect: None }, depth - 1)
            }
            _ => Bound::within(p, study.scene.ceiling(depth - 1)),
        });
        own.plus(back)
    }

    /// Ambient light and that of all lights.
    fn own_light(&mut self, p: &Polygon, met: &Met<'_>, shares: &Shares) -> Bound {
        let world = self.scene.world;
        let ambient = three!(c => shares.ambient[c].times(world.ambient[c]));
        let none = [Form::constant(0.0); 3];
        let base = Shade { plain: none, tinted: ambient };
        let lights = if met.surfacing.lit { &world.lights[..] } else { &[] };
        if lights.is_empty() {
            return self.painted(p, met, &base);
        }
        // Where bumps turn a normal to isn't followed.
        let ns = match met.surfacing.bump {
            Some(_) => [Form::ALL; 3],
            None => met.bent.unwrap_or(met.n),
        };
        let mut sum: Option<Bound> = None;
        for (number, light) in lights.iter().enumerate() {
            // The first one takes the ambient light along: one picture of the pattern less.
            let base = if number == 0 { base } else { Shade { plain: none, tinted: none } };
            let to = three!(i => met.w.times(light.at[i]) - met.p[i]);
            // In the shadow nobody asks for them.
            let mut terms = None;
            let fin = &mut |study: &mut Study<'c>, q: &Polygon, seen: [Span; 3]| {
                let arrives = three!(c => {
                    let share = if seen[c][0] == seen[c][1] { Form::constant(seen[c][0]) } else { Form::between(seen[c][0], seen[c][1]) };
                    share.times(light.color[c])
                });
                if seen == [[0.0; 2]; 3] {
                    return study.painted(q, met, &base);
                }
                let terms = terms.get_or_insert_with(|| Terms::new(met, ns, to, shares));
                let shade = Shade {
                    plain: three!(c => base.plain[c] + (arrives[c] * terms.high) * shares.specular[c]),
                    tinted: three!(c => base.tinted[c] + (arrives[c] * terms.lambert) * shares.diffuse[c]),
                };
                study.painted(q, met, &shade)
            };
            let mut tests = vec![dot(met.n, to)];
            if met.bent.is_some() && met.surfacing.bump.is_none() {
                tests.push(dot(ns, to));
            }
            let one = self.split_all(p, &tests, &mut |study, q, faces| match faces {
                true => study.shadowed(q, met, (number, to), fin),
                false => fin(study, q, [[0.0; 2]; 3]),
            });
            sum = Some(match sum {
                Some(before) => before.plus(one),
                None => one,
            });
        }
        sum.unwrap_or_else(Bound::none)
    }

    /// How much of a light arrives on `p`; `to` leads from the points, times their w, to the light.
    fn shadowed(
        &mut self,
        p: &Polygon,
        met: &Met<'_>,
        (number, to): (usize, [Form; 3]),
        fin: Arrived<'_, 'c>,
    ) -> Bound {
        let (scene, world) = (self.scene, self.scene.world);
        let light = &world.lights[number];
        let anything = [[0.0, 1.0]; 3];
        if !light.touched.is_empty() {
            return fin(self, p, anything);
        }
        let from_light = Bundle { o: light.at.map(Form::constant), d: to.map(|x| -x), start: None, rect: None };
        let bounds = met.at.and_then(|at| bounds_of(p, at));
        let candidates = match &bounds {
            Some(points) => Bundle::occluders(scene, light.at, points),
            None => from_light.candidates(scene, p),
        };
        let Some(candidates) = candidates else { return fin(self, p, anything) };
        let mut blocks = Vec::new();
        for &id in candidates.iter() {
            let factor = match world.constant_transmission(id) {
                Some([1.0, 1.0, 1.0]) => continue,
                Some(factor) => factor,
                None => return fin(self, p, anything),
            };
            let from_here = match (id == met.start.id, met.at) {
                (false, _) => None,
                // What leaves a flat or convex surface to the outside doesn't come back.
                (true, _) if met.start.outward || !met.is_curved() => continue,
                (true, Some(o)) => {
                    Some(Bundle { o, d: from_constant(light.at, o), start: Some(met.start), rect: None })
                }
                (true, None) => return fin(self, p, anything),
            };
            let (ray, end) = match &from_here {
                Some(ray) => (ray, Form::constant(1.0)),
                None => (&from_light, met.w),
            };
            let mut sheets = Sheets { scene, p, ray, found: Vec::new() };
            if sheets.add(id).is_err() {
                return fin(self, p, anything);
            }
            for mut sheet in sheets.found {
                // Before the other end is reached.
                let ahead = sheet.nearness - end;
                let (lo, hi) = p.range(ahead);
                if hi < 0.0 {
                    continue;
                }
                if lo < 0.0 {
                    if !ahead.is_known() {
                        return fin(self, p, anything);
                    }
                    sheet.tests.push(ahead);
                }
                if sheet.tests.is_empty() && factor == [0.0; 3] && !sheet.veil {
                    return fin(self, p, [[0.0; 2]; 3]);
                }
                blocks.push((sheet, factor));
            }
        }
        // What is dark all the same needn't know what veils hide.
        blocks.sort_by_key(|(sheet, _)| sheet.veil);
        self.past(p, &blocks, [1.0; 3], fin)
    }

    /// Light of the share `seen` on its way past the rest of the sheets.
    fn past(&mut self, p: &Polygon, blocks: &[(Sheet, [f64; 3])], seen: [f64; 3], fin: Arrived<'_, 'c>) -> Bound {
        let Some(((sheet, factor), rest)) = blocks.split_first() else {
            return fin(self, p, seen.map(|s| [s; 2]));
        };
        self.split_all(p, &sheet.tests, &mut |study, q, met| {
            if met && sheet.veil {
                return fin(study, q, [[0.0, 1.0]; 3]);
            }
            let left = if met { three!(c => seen[c] * factor[c]) } else { seen };
            match left == [0.0; 3] {
                true => fin(study, q, [[0.0; 2]; 3]),
                false => study.past(q, rest, left, fin),
            }
        })
    }
}

/// Goes on where the share of a light that arrives is known.
type Arrived<'b, 'c> = &'b mut dyn FnMut(&mut Study<'c>, &Polygon, [Span; 3]) -> Bound;

/// Cosine and highlight of one light, both from 0 to 1 where the light is in front.
struct Terms {
    lambert: Form,
    high: Form,
}

impl Terms {
    fn new(met: &Met<'_>, ns: [Form; 3], to: [Form; 3], shares: &Shares) -> Terms {
        let length = dot(to, to).reciprocal_root();
        let unit = |f: Form| if f.is_known() { f } else { Form::between(0.0, 1.0) };
        let lambert = unit(dot(ns, to) * length);
        let mut high = Form::constant(0.0);
        if shares.specular != [high; 3] {
            let along = dot(mirrored(met.d, ns), to) * length * dot(met.d, met.d).reciprocal_root();
            high = shares.shininess.map_or(Form::between(0.0, 1.0), |n| along.power(n));
        }
        Terms { lambert, high }
    }
}
