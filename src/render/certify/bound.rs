//! What is known of the light in a part of a region: its integral, its values, and how it varies to first order.
//!
//! A [`Bound`] is about a polygon. It says: there is a function on the polygon that equals the light wherever the conditions
//! hold that led here, whose values lie within `range` and whose integral lies within `sum`. On the strips that belong to
//! two polygons at once that function is free; [`joined`](Bound::joined) takes the strip's share out again.

use super::super::bounds::{larger, smaller};
use super::polygon::{AREA_ERROR, Polygon};
use crate::math::Form;

/// A lower and an upper bound.
pub type Span = [f64; 2];

/// Light by channel.
#[derive(Clone, Copy, Debug)]
pub struct Bound {
    /// Of the integral over the polygon, in units of the region's coordinates: its square has the area 4.
    pub sum: [Span; 3],
    /// Of the values on it.
    pub range: [Span; 3],
    /// The values, where one form holds for all of them.
    pub form: Option<[Form; 3]>,
}

/// Relative margin for the few roundings of each step here.
const MARGIN: f64 = 8.0 * f64::EPSILON;

/// Widened by rounding errors of numbers as large as `size`.
fn wide([lo, hi]: Span, size: f64) -> Span {
    let slack = MARGIN * size;
    [lo - slack, hi + slack]
}

fn size([lo, hi]: Span) -> f64 {
    larger(lo.abs(), hi.abs())
}

/// All products of a value of one and a value of the other, rounded outwards.
fn product(a: Span, b: Span) -> Span {
    let all = [a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]];
    let span = all.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |s, x| [smaller(s[0], *x), larger(s[1], *x)]);
    wide(span, size(span))
}

/// One that holds both.
pub fn hull(a: Span, b: Span) -> Span {
    [smaller(a[0], b[0]), larger(a[1], b[1])]
}

/// The part that both hold; where rounding has left none, the first.
pub fn meet(a: Span, b: Span) -> Span {
    let both = [larger(a[0], b[0]), smaller(a[1], b[1])];
    if both[0] <= both[1] { both } else { a }
}

impl Bound {
    /// No light.
    pub fn none() -> Bound {
        Bound { sum: [[0.0; 2]; 3], range: [[0.0; 2]; 3], form: Some([Form::constant(0.0); 3]) }
    }

    /// Nothing but where the values lie is known.
    pub fn within(p: &Polygon, range: [Span; 3]) -> Bound {
        let form = range.map(|[lo, hi]| Form::between(lo, hi));
        Bound { form: Some(form), ..Bound::somewhere(p.area(), range) }
    }

    /// The same without a form.
    fn somewhere(area: f64, range: [Span; 3]) -> Bound {
        let area = [larger(area - AREA_ERROR, 0.0), area + AREA_ERROR];
        Bound { sum: range.map(|r| product(r, area)), range, form: None }
    }

    /// The values are those of `form`.
    pub fn of(p: &Polygon, form: [Form; 3]) -> Bound {
        let m = p.moments();
        let range = form.map(|f| <[f64; 2]>::from(p.range(f)));
        let sum = |f: Form| {
            let mean = f.c * m.area + (f.x * m.x + f.y * m.y);
            let off = f.r * (m.area + AREA_ERROR) + (f.c.abs() + f.x.abs() + f.y.abs()) * AREA_ERROR;
            [mean - off, mean + off]
        };
        let sum = form.map(|f| if f.is_known() { sum(f) } else { [f64::NEG_INFINITY, f64::INFINITY] });
        Bound { sum, range, form: Some(form) }
    }

    /// The sum of two lights on the same polygon.
    pub fn plus(self, o: Bound) -> Bound {
        let add = |a: Span, b: Span| wide([a[0] + b[0], a[1] + b[1]], size(a) + size(b));
        let each = |a: [Span; 3], b: [Span; 3]| [0, 1, 2].map(|i| add(a[i], b[i]));
        let form = match (self.form, o.form) {
            (Some(a), Some(b)) => Some([0, 1, 2].map(|i| a[i] + b[i])),
            _ => None,
        };
        Bound { sum: each(self.sum, o.sum), range: each(self.range, o.range), form }
    }

    /// `w` times the light.
    pub fn times(self, w: [f64; 3]) -> Bound {
        let scaled = |s: [Span; 3]| [0, 1, 2].map(|i| product(s[i], [w[i]; 2]));
        let form = self.form.map(|f| [0, 1, 2].map(|i| f[i].times(w[i])));
        Bound { sum: scaled(self.sum), range: scaled(self.range), form }
    }

    /// The light times shares from one end of `w` to the other, which may be another at each point.
    pub fn shared(self, p: &Polygon, w: [Span; 3]) -> Bound {
        if w.iter().all(|s| s[0] == s[1]) {
            return self.times(w.map(|s| s[0]));
        }
        let range = [0, 1, 2].map(|i| product(self.range[i], w[i]));
        let plain = Bound::somewhere(p.area(), range);
        let area = p.area();
        let area = [larger(area - AREA_ERROR, 0.0), area + AREA_ERROR];
        // What isn't negative, the light above its least value below 0, comes to no more by its shares than all of it by the largest,
        // and to no less than all of it by the least.
        let sum = |i: usize| {
            let below = product([smaller(self.range[i][0], 0.0); 2], area);
            let [lo, hi] = self.sum[i];
            let above = wide([lo - below[1], hi - below[0]], size(self.sum[i]) + size(below));
            let (above, below) = (product(above, w[i]), product(below, w[i]));
            meet(wide([above[0] + below[0], above[1] + below[1]], size(above) + size(below)), plain.sum[i])
        };
        let form = self.form.map(|f| [0, 1, 2].map(|i| f[i] * Form::between(w[i][0], w[i][1])));
        Bound { sum: [0, 1, 2].map(sum), range, form }
    }

    /// The same light, or all that `ceiling` says of it where that is more. (Not both: the integral counts strips, where the function that
    /// it is of may lie outside.)
    pub fn limited(self, p: &Polygon, ceiling: [Span; 3]) -> Bound {
        let all = Bound::within(p, ceiling);
        let width = |s: Span| s[1] - s[0];
        let is_wide =
            |i: usize| !(width(self.range[i]) < 2.0 * width(ceiling[i])) || !(width(self.sum[i]) < width(all.sum[i]));
        if (0..3).any(is_wide) { all } else { self }
    }

    /// The light times shares that vary as these forms do.
    pub fn through(self, p: &Polygon, w: [Form; 3]) -> Bound {
        let spans = w.map(|f| <[f64; 2]>::from(p.range(f)));
        // Of constants the range is wider by rounding.
        let spans = [0, 1, 2].map(|i| if w[i] == Form::constant(w[i].c) { [w[i].c; 2] } else { spans[i] });
        let plain = self.shared(p, spans);
        let Some(form) = self.form else { return plain };
        let form = [0, 1, 2].map(|i| form[i] * w[i]);
        let first = Bound::of(p, form);
        Bound {
            sum: [0, 1, 2].map(|i| meet(first.sum[i], plain.sum[i])),
            range: [0, 1, 2].map(|i| meet(first.range[i], plain.range[i])),
            form: Some(form),
        }
    }

    /// What holds of `whole`, which was cut into the polygons of `a` and `b`, which overlap. Each point's light is that of one of
    /// both; the other's at the points of the strip has to be taken out: the strip's area times something among the values.
    pub fn joined(whole: &Polygon, (pa, a): (&Polygon, Bound), (pb, b): (&Polygon, Bound)) -> Bound {
        let area = whole.area();
        let strip = pa.area() + pb.area() - area;
        // Three areas are off, and two cuts may have lost what their corners' rounding takes.
        let strip = [strip - 8.0 * AREA_ERROR, larger(strip, 0.0) + 8.0 * AREA_ERROR];
        let range = [0, 1, 2].map(|i| hull(a.range[i], b.range[i]));
        let plain = Bound::somewhere(area, range);
        let sum = |i: usize| {
            let twice = product(range[i], strip);
            let size = size(a.sum[i]) + size(b.sum[i]) + size(twice);
            let cut = wide([a.sum[i][0] + b.sum[i][0] - twice[1], a.sum[i][1] + b.sum[i][1] - twice[0]], size);
            meet(cut, plain.sum[i])
        };
        Bound { sum: [0, 1, 2].map(sum), range, form: None }
    }

    /// The same light, of whose values and integral more is known. The claims must hold both.
    pub fn knowing(self, p: &Polygon, range: [Span; 3]) -> Bound {
        let range = [0, 1, 2].map(|i| meet(self.range[i], range[i]));
        let plain = Bound::somewhere(p.area(), range);
        Bound { sum: [0, 1, 2].map(|i| meet(self.sum[i], plain.sum[i])), range, form: self.form }
    }
}
