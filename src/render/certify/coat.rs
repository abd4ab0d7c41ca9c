//! Patterns over a region: where a pattern changes, the region is cut; what can't be followed lies within the pattern's range.

use super::super::material::Slot;
use super::super::pattern_node::PatternNode;
use super::super::texture::Edge;
use super::blend::Stops;
use super::bound::Bound;
use super::lit::Shade;
use super::met::Met;
use super::noise;
use super::polygon::{AREA_ERROR, Polygon};
use super::spot::{Coordinate, Spot};
use super::study::Study;
use super::texels::Texels;
use super::waves::{Parity, parity};
use crate::math::Form;
use crate::math::real::{Real, dot, three};
use crate::scene::{Filter, Mapping};

/// Most lines of one pattern through a polygon that it is cut at.
const MOST_LINES: i64 = 24;

/// Goes on with the pattern's colour.
pub type Coloured<'b, 'c> = &'b mut dyn FnMut(&mut Study<'c>, &Polygon, [Form; 3]) -> Bound;

impl<'c> Study<'c> {
    /// The light of a surface with its material's colour.
    pub fn painted(&mut self, p: &Polygon, met: &Met<'_>, shade: &Shade) -> Bound {
        let mix = |color: [Form; 3]| three!(c => shade.plain[c] + shade.tinted[c] * color[c]);
        let id = match met.surfacing.color {
            Slot::Constant(c) => return Bound::of(p, mix(c.map(Form::constant))),
            Slot::Pattern(id) => id,
        };
        // Most pieces of a region are of a surface that was painted just before.
        let mut spaces = std::mem::take(&mut self.spaces);
        let spot = Spot::new(spaces.of(self.scene.world, met), met, self.scene.made_scale(met.primitive));
        let bound = match spot.map(|spot| self.unwrapped(id, spot)) {
            Some((id, at)) => self
                .whole(p, (id, &at), met, shade)
                .unwrap_or_else(|| self.coloured(p, id, &at, &mut |_, q, color| Bound::of(q, mix(color)))),
            None => self.unknown(p),
        };
        self.spaces = spaces;
        bound
    }

    /// What stands in a space, in that space.
    fn unwrapped<'s>(&self, mut id: u32, mut at: Spot<'s>) -> (u32, Spot<'s>) {
        loop {
            (id, at) = match &self.scene.world.patterns.nodes[id as usize] {
                PatternNode::InSpace(child, space) => {
                    let p = at.brought(&at.spaces[*space as usize]);
                    (*child, at.within(p))
                }
                PatternNode::Mapped(child, rows) => {
                    let p = Spot::apply(rows, at.p, at.w);
                    (*child, at.within(p))
                }
                _ => return (id, at),
            };
        }
    }

    /// Patterns whose mean is known without cutting: pictures, and checkers with many cells.
    fn whole(&mut self, p: &Polygon, (id, at): (u32, &Spot<'_>), met: &Met<'_>, shade: &Shade) -> Option<Bound> {
        if self.undivided {
            return None; // their form is of little use
        }
        let patterns = &self.scene.world.patterns;
        match &patterns.nodes[id as usize] {
            PatternNode::Image { texture, mapping: Mapping::Normal, filter: Filter::Nearest, turn_normal, .. } => {
                let detail = self.scene.world.spaces.get(met.primitive.space as usize)?.detail.as_ref()?;
                let outward = if met.start.outward { met.n } else { met.n.map(|x| -x) };
                let n = turned(
                    turn_normal,
                    unit(turned(&detail.made_normal_from_world, outward), &detail.made_normal_from_world),
                );
                let texture = &patterns.textures[*texture as usize];
                let [width, height] = texture.size().map(|n| n as f64);
                let share =
                    |f: Form| f.arcsine() * Form::between(INVERSE_PI.next_down(), INVERSE_PI) + Form::constant(0.5);
                let x = share(n[0]).times(width);
                let y = (Form::constant(1.0) - share(n[1])).times(height);
                Texels { texture, edges: [Edge::Clamp; 2], x, y }.light(p, shade)
            }
            PatternNode::Checker(a, b, size) => {
                let (PatternNode::Constant(a), PatternNode::Constant(b)) =
                    (&patterns.nodes[*a as usize], &patterns.nodes[*b as usize])
                else {
                    return None;
                };
                let mut free = at.p.iter().filter(|c| c.fixed.is_none()).map(|c| c.over);
                let (u, v) = (free.next()?, free.next()?);
                if free.next().is_some() {
                    return None;
                }
                let lines = |x: Form| numbers(p, x, at.w, *size).map_or(i64::MAX / 2, |(a, b)| b - a);
                if lines(u).saturating_add(lines(v)) <= FEW_LINES {
                    return None;
                }
                let level: f64 = at.p.iter().filter_map(|c| c.fixed).map(|x| (x / size).floor()).sum();
                let w = at.w.times(*size);
                let found = parity(p, u, v, w).or_else(|| parity(p, v, u, w))?;
                self.in_rows = true;
                let sign = if (0.5 * level).floor() * 2.0 == level { 1.0 } else { -1.0 };
                Some(alternating(p, shade, (a, b), sign, &found))
            }
            _ => None,
        }
    }

    /// The colours of pattern `id`, each where it is seen.
    pub fn coloured(&mut self, p: &Polygon, id: u32, at: &Spot<'_>, then: Coloured<'_, 'c>) -> Bound {
        let patterns = &self.scene.world.patterns;
        match &patterns.nodes[id as usize] {
            PatternNode::Constant(c) => then(self, p, c.map(Form::constant)),
            PatternNode::Checker(a, b, size) => self.cells(p, at, *size, &mut |study, q, parity| match parity {
                Some(even) => study.coloured(q, if even { *a } else { *b }, at, then),
                None => study.anything(q, id, then),
            }),
            PatternNode::Stripes(a, b, axis, size) => {
                let line = at.p[*axis as usize];
                self.lines(p, line, (at.w, *size), None, &mut |study, q, k| match k {
                    Some(k) => study.coloured(q, if k % 2 == 0 { *a } else { *b }, at, then),
                    None => study.anything(q, id, then),
                })
            }
            PatternNode::InSpace(child, space) => {
                let p2 = at.brought(&at.spaces[*space as usize]);
                self.coloured(p, *child, &at.within(p2), then)
            }
            PatternNode::Mapped(child, rows) => {
                let p2 = Spot::apply(rows, at.p, at.w);
                self.coloured(p, *child, &at.within(p2), then)
            }
            PatternNode::Gradient(a, b, axis, size) => {
                let x = (at.p[*axis as usize].over / at.w) / Form::constant(*size);
                self.mixed(p, (*a, *b), [x.share(); 3], at, then)
            }
            PatternNode::Mix(a, b, by) => {
                self.coloured(p, *by, at, &mut |study, q, share| study.mixed(q, (*a, *b), share, at, then))
            }
            PatternNode::Add(a, b) => self.coloured(p, *a, at, &mut |study, q, x| {
                study.coloured(q, *b, at, &mut |study, q, y| then(study, q, three!(c => x[c] + y[c])))
            }),
            PatternNode::Multiply(a, b) => self.coloured(p, *a, at, &mut |study, q, x| {
                study.coloured(q, *b, at, &mut |study, q, y| then(study, q, three!(c => x[c] * y[c])))
            }),
            PatternNode::Blend(stops, by) => match Stops::all(stops) {
                Some(all) => self.coloured(p, *by, at, &mut |study, q, x| {
                    study.blended(q, all, x[0].times((stops.len() - 1) as f64), at, then)
                }),
                None => self.anything(p, id, then),
            },
            PatternNode::Within(child, least, most) => self.coloured(p, *child, at, &mut |study, q, x| {
                then(study, q, x.map(|x| x.max(Form::constant(*least)).min(Form::constant(*most))))
            }),
            PatternNode::Noise(a, b, octaves, seed) => match noise::unit(p, at.point(), *octaves, *seed) {
                Some(share) => self.mixed(p, (*a, *b), [share; 3], at, then),
                None => self.anything(p, id, then),
            },
            PatternNode::Turbulence(child, amount, octaves, seed) => {
                let q = at.point();
                match noise::vector(p, q, *octaves, *seed) {
                    Some(v) => {
                        let moved = at.moved(three!(i => q[i] + v[i].times(*amount)));
                        self.coloured(p, *child, &moved, then)
                    }
                    None => self.anything(p, id, then),
                }
            }
            // What is left lies somewhere in their range.
            _ => self.anything(p, id, then),
        }
    }

    /// Whatever pattern `id` may be.
    fn anything(&mut self, p: &Polygon, id: u32, then: Coloured<'_, 'c>) -> Bound {
        let any = self.scene.pattern_range(id);
        then(self, p, any.map(|[lo, hi]| Form::between(lo, hi)))
    }

    /// From pattern `a` to pattern `b` by `share`.
    pub fn mixed(
        &mut self,
        p: &Polygon,
        (a, b): (u32, u32),
        share: [Form; 3],
        at: &Spot<'_>,
        then: Coloured<'_, 'c>,
    ) -> Bound {
        self.coloured(p, a, at, &mut |study, q, x| {
            study.coloured(q, b, at, &mut |study, q, y| then(study, q, three!(c => x[c] + share[c] * (y[c] - x[c]))))
        })
    }

    /// The cells of a solid checker: whether the sum of their numbers is even; `None` where it isn't followed.
    fn cells(
        &mut self,
        p: &Polygon,
        at: &Spot<'_>,
        size: f64,
        then: &mut dyn FnMut(&mut Study<'c>, &Polygon, Option<bool>) -> Bound,
    ) -> Bound {
        self.cells_along(p, at, size, 0, 0, then)
    }

    fn cells_along(
        &mut self,
        p: &Polygon,
        at: &Spot<'_>,
        size: f64,
        axis: usize,
        sum: i64,
        then: &mut dyn FnMut(&mut Study<'c>, &Polygon, Option<bool>) -> Bound,
    ) -> Bound {
        let Some(coordinate) = at.p.get(axis) else { return then(self, p, Some(sum % 2 == 0)) };
        self.lines(p, *coordinate, (at.w, size), None, &mut |study, q, k| match k {
            Some(k) => study.cells_along(q, at, size, axis + 1, sum + k % 2, then),
            None => then(study, q, None),
        })
    }

    /// Cuts where a coordinate is a multiple of `size`, and goes on with the whole number below; `None` where that isn't
    /// followed. `known` bounds the number.
    fn lines(
        &mut self,
        p: &Polygon,
        x: Coordinate,
        (w, size): (Form, f64),
        known: Option<(i64, i64)>,
        then: &mut dyn FnMut(&mut Study<'c>, &Polygon, Option<i64>) -> Bound,
    ) -> Bound {
        if let Some(x) = x.fixed {
            let k = (x / size).floor();
            return then(self, p, (k.abs() < MOST_NUMBER).then_some(k as i64));
        }
        let Some((lo, hi)) = numbers(p, x.over, w, size) else { return then(self, p, None) };
        let (mut first, mut last) = (lo, hi);
        if let Some((least, most)) = known {
            // Rounding may leave a polygon just beyond the line that it was cut at.
            (first, last) = (first.clamp(least, most), last.clamp(least, most));
        }
        if first == last {
            return then(self, p, Some(first));
        }
        if last - first > MOST_LINES {
            return then(self, p, None);
        }
        let middle = (first + last + 1) / 2;
        let beyond = x.over - w.times(middle as f64).times(size);
        self.split(p, beyond, &mut |study, q, yes| {
            let known = if yes { (middle, last) } else { (first, middle - 1) };
            study.lines(q, x, (w, size), Some(known), then)
        })
    }
}

/// The light of two colours that alternate, a where the parity is even. Its integral is that of their mean and, times half their
/// difference, of parity·tinted: the constant and the η part of tinted by the parity's moments, the rest by its size.
fn alternating(p: &Polygon, shade: &Shade, (a, b): (&[f64; 3], &[f64; 3]), sign: f64, found: &Parity) -> Bound {
    let color =
        three!(c => Form::between(if a[c] < b[c] { a[c] } else { b[c] }, if a[c] < b[c] { b[c] } else { a[c] }));
    let wide = Bound::of(p, three!(c => shade.plain[c] + shade.tinted[c] * color[c]));
    let middle = three!(c => (Form::constant(a[c]) + Form::constant(b[c])).times(0.5));
    let even = Bound::of(p, three!(c => shade.plain[c] + shade.tinted[c] * middle[c]));
    let area = p.area() + AREA_ERROR;
    let sum = |c: usize| {
        let (t, half) = (shade.tinted[c], 0.5 * sign * (a[c] - b[c]));
        if !t.is_known() {
            return wide.sum[c];
        }
        let odd = half * (t.c * found.sum + t.y * found.eta);
        let size = half.abs() * (t.c.abs() + t.x.abs() + t.y.abs());
        let off = half.abs() * (t.x.abs() + t.r) * area + size * (found.off + AREA_ERROR);
        let [lo, hi] = [even.sum[c][0] + odd - off, even.sum[c][1] + odd + off];
        let plain = wide.sum[c];
        [if lo > plain[0] { lo } else { plain[0] }, if hi < plain[1] { hi } else { plain[1] }]
    };
    Bound { sum: [0, 1, 2].map(sum), ..wide }
}

/// The image of a vector.
fn turned(rows: &[[f64; 3]; 3], v: [Form; 3]) -> [Form; 3] {
    rows.map(|row| dot(row.map(Form::constant), v))
}

/// The same direction, of length 1; a map that changes nothing leaves unit normals what they are.
fn unit(v: [Form; 3], map: &[[f64; 3]; 3]) -> [Form; 3] {
    if *map == [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
        return v;
    }
    let scale = dot(v, v).reciprocal_root();
    v.map(|x| x * scale)
}

/// The float just above 1/π, 0.31830988618379067153…
const INVERSE_PI: f64 = std::f64::consts::FRAC_1_PI;

/// So many lines through a polygon, and checkers are cut at them.
const FEW_LINES: i64 = 4;

/// Whole numbers beyond this aren't told apart well.
const MOST_NUMBER: f64 = (1u64 << 40) as f64;

/// The whole numbers that x/(w·size) may lie above next, from lowest to highest; `None` where that has no bounds.
fn numbers(p: &Polygon, x: Form, w: Form, size: f64) -> Option<(i64, i64)> {
    let unit = w.times(size);
    let (least, _) = p.range(unit);
    if !(least > 0.0) {
        return None;
    }
    // The quotient of both linear parts is highest and lowest at corners; what they miss is divided by the least denominator.
    let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
    for [a, b] in p.corners() {
        let q = (x.c + x.x * a + x.y * b) / (unit.c + unit.x * a + unit.y * b);
        lo = if q < lo { q } else { lo };
        hi = if q > hi { q } else { hi };
    }
    let most = if lo.abs() > hi.abs() { lo.abs() } else { hi.abs() };
    let slack = (x.r + most * unit.r) / least;
    let rounding =
        16.0 * f64::EPSILON * ((x.c.abs() + x.x.abs() + x.y.abs()) / least + most * (1.0 + unit.c.abs() / least));
    let (lo, hi) = (lo - slack - rounding, hi + slack + rounding);
    (lo > -MOST_NUMBER && hi < MOST_NUMBER).then(|| (lo.floor() as i64, hi.floor() as i64))
}
