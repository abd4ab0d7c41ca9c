//! Light at glass: what is mirrored and what is refracted, by Snell's law and Fresnel's formulas all over a region.

use super::super::optics::{dielectric, mirrored};
use super::bound::{Bound, Span};
use super::bundle::{Bundle, Start};
use super::met::Met;
use super::polygon::Polygon;
use super::study::Study;
use crate::math::Form;
use crate::math::real::{dot, three};
use crate::math::tri::Tri;

/// Most surfaces of glass in one study: each sends rays two ways.
const MOST: u32 = 24;

/// Rays of less weight at glass aren't followed. Straight on it mirrors some 4 %: once, that is looked at.
const FAINT: f64 = 1.0 / 64.0;

impl<'c> Study<'c> {
    /// The light that a surface of glass mirrors, by its share for that, and lets through; its rays go on up to `depth` times more.
    pub fn bent_light(
        &mut self,
        p: &Polygon,
        met: &Met<'_>,
        (reflect, transmit): ([Span; 3], [Span; 3]),
        depth: u32,
    ) -> Bound {
        let [reflect, transmit] = [reflect, transmit].map(|s| s.map(|[lo, hi]| Form::between(lo, hi)));
        let all = three!(c => reflect[c] + transmit[c]);
        let anything = Bound::within(p, self.scene.ceiling(depth));
        let plain = met.bent.is_none() && met.surfacing.bump.is_none() && self.bends < MOST;
        let (true, Some(ior), Some(o)) = (plain, met.surfacing.ior, met.at) else {
            return anything.through(p, transmit).plus(anything.through(p, reflect));
        };
        self.bends += 1;
        let inside = !met.start.outward;
        let eta = Form::constant(if inside { ior } else { 1.0 / ior });
        let (length2, along) = (dot(met.d, met.d), dot(met.d, met.n));
        // 1 − sin² beyond the surface, times the length of d squared.
        let refracts = length2 - eta * eta * (length2 - along * along);
        let mirror = Bundle { o, d: mirrored(met.d, met.n), start: Some(met.start), rect: None };
        self.split(p, refracts, &mut |study, q, refracts| {
            if !refracts {
                return study.onward(q, all, (depth, FAINT), |study| study.seen(q, &mirror, depth));
            }
            let bent = dielectric(met.d, met.n, ior, Tri { certain: inside, possible: inside });
            let one = Form::constant(1.0);
            let (lo, hi) = q.range(bent.reflectance);
            // Near the critical angle that is all there is to know.
            let share = match hi - lo < 1.0 {
                true => bent.reflectance.share(),
                false => Form::between(0.0, 1.0),
            };
            let back = three!(c => reflect[c] + transmit[c] * share);
            let back = study.onward(q, back, (depth, FAINT), |study| study.seen(q, &mirror, depth));
            let rest = three!(c => transmit[c] * (one - share));
            let start = Some(Start { outward: inside, ..met.start });
            let onward = Bundle { o, d: bent.direction, start, rect: None };
            back.plus(study.onward(q, rest, (depth, FAINT), |study| study.seen(q, &onward, depth)))
        })
    }
}
