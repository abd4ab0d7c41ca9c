//! What the rays of a region see: which sheets they meet, and which comes first.

use super::bound::Bound;
use super::bundle::Bundle;
use super::polygon::Polygon;
use super::sheet::{Sheet, Sheets};
use super::study::Study;
use crate::math::Form;

/// Most sheets that rays may meet one behind another.
const MOST_HITS: usize = 12;

/// Sheets that the rays of a polygon meet, by their numbers, and what is known of their order.
#[derive(Clone, Debug, Default)]
struct Hits {
    met: Vec<usize>,
    /// Pairs: the first is nearer.
    order: Vec<(usize, usize)>,
}

impl<'c> Study<'c> {
    /// The light that the rays bring on `p`, which go on up to `depth` times more.
    pub fn seen(&mut self, p: &Polygon, ray: &Bundle, depth: u32) -> Bound {
        let outer = std::mem::replace(&mut self.ceiling, self.scene.ceiling(depth));
        let bound = self.looked_at(p, ray, depth);
        self.ceiling = outer;
        bound
    }

    fn looked_at(&mut self, p: &Polygon, ray: &Bundle, depth: u32) -> Bound {
        let scene = self.scene;
        let Some(candidates) = ray.candidates(scene, p) else { return self.unknown(p) };
        self.ceiling = scene.ceiling_among(&candidates, depth);
        let mut sheets = Sheets { scene, p, ray, found: Vec::new() };
        for &id in candidates.iter() {
            if sheets.add(id).is_err() {
                return self.unknown(p);
            }
        }
        let mut found = sheets.found;
        let key = |s: &Sheet| if s.nearness.is_known() { s.nearness.c } else { f64::INFINITY };
        found.sort_by(|a, b| key(b).total_cmp(&key(a)).then(a.id.cmp(&b.id)));
        let view = View { ray, sheets: &found, candidates: &candidates, depth };
        self.gathered(p, &view, 0, &mut Hits::default())
    }

    /// Decides, sheet by sheet from number `next` on, which are met.
    fn gathered(&mut self, p: &Polygon, view: &View<'_>, next: usize, hits: &mut Hits) -> Bound {
        let Some(sheet) = view.sheets.get(next) else {
            return self.in_order(p, view, hits);
        };
        if hits.met.iter().any(|&h| view.hides(self, p, h, sheet)) {
            return self.gathered(p, view, next + 1, hits);
        }
        if hits.met.len() == MOST_HITS {
            return self.unknown(p);
        }
        self.split_all(p, &sheet.tests, &mut |study, q, met| {
            if met && sheet.veil {
                return study.unknown(q);
            }
            if met {
                hits.met.push(next);
            }
            let bound = study.gathered(q, view, next + 1, hits);
            if met {
                hits.met.pop();
            }
            bound
        })
    }

    /// Finds the nearest of the sheets that are met, and what lies behind it where light goes through.
    fn in_order(&mut self, p: &Polygon, view: &View<'_>, hits: &Hits) -> Bound {
        let m = p.moments();
        let centre = if m.area > 0.0 { [m.x / m.area, m.y / m.area] } else { [0.0; 2] };
        let near = |i: usize| {
            let f = view.sheets[i].nearness;
            f.c + f.x * centre[0] + f.y * centre[1]
        };
        let known = |a: usize, b: usize| hits.order.contains(&(a, b));
        let free = hits.met.iter().copied().filter(|&i| !hits.met.iter().any(|&h| known(h, i)));
        let Some(first) = free.reduce(|a, b| if near(b) > near(a) { b } else { a }) else {
            return match hits.met.is_empty() {
                true => Bound::of(p, self.scene.world.background.map(Form::constant)),
                false => self.unknown(p), // each behind another: only in a strip where none of it is true
            };
        };
        for &other in &hits.met {
            if other == first || known(first, other) || view.is_before(first, other) {
                continue;
            }
            let (a, b) = (view.sheets[first].nearness, view.sheets[other].nearness);
            if p.range(a).0 >= p.range(b).1 {
                continue;
            }
            let ahead = a - b;
            if !ahead.is_known() {
                return self.unknown(p);
            }
            return self.split(p, ahead, &mut |study, q, first_is_nearer| {
                let mut hits = hits.clone();
                hits.order.push(if first_is_nearer { (first, other) } else { (other, first) });
                study.in_order(q, view, &hits)
            });
        }
        let sheet = &view.sheets[first];
        let light = self.surface_light(p, view.ray, sheet, view.depth);
        let through = self.scene.world.surfacing(sheet.id).transmit;
        match self.scene.straight_through(sheet.id) {
            _ if through.is_zero() || view.depth == 0 => light,
            // What is bent on its way through goes on with the mirrored light.
            None => light,
            Some(share) => {
                let mut rest = hits.clone();
                rest.met.retain(|&i| i != first);
                let behind = View { depth: view.depth - 1, ..*view };
                let seen_behind = |study: &mut Study<'c>| {
                    study.ceiling = study.scene.ceiling_among(view.candidates, behind.depth);
                    study.in_order(p, &behind, &rest)
                };
                light.plus(self.onward(p, share.map(Form::constant), (behind.depth, 0.0), seen_behind))
            }
        }
    }
}

/// Rays and the sheets that they may meet.
#[derive(Clone, Copy)]
struct View<'v> {
    ray: &'v Bundle,
    sheets: &'v [Sheet],
    /// The surfaces that they may meet.
    candidates: &'v [u32],
    depth: u32,
}

impl View<'_> {
    /// Whether sheet number `hit` surely hides `other` on `p`.
    fn hides(&self, study: &Study<'_>, p: &Polygon, hit: usize, other: &Sheet) -> bool {
        let hit = &self.sheets[hit];
        let opaque = study.scene.straight_through(hit.id).is_none_or(|share| share == [0.0; 3]);
        opaque && p.range(hit.nearness).0 > p.range(other.nearness).1
    }

    /// Whether of one shape's two sheets, if both are met, `a` comes first, or it doesn't matter: a convex shape is entered once
    /// and left once.
    fn is_before(&self, a: usize, b: usize) -> bool {
        let (a, b) = (&self.sheets[a], &self.sheets[b]);
        a.id == b.id && a.convex && (!a.inside || b.inside)
    }
}
