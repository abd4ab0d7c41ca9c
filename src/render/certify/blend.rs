//! Colours along a scale of stops: the region is cut where one pair of stops follows another.

use super::bound::{Bound, Span, hull};
use super::coat::Coloured;
use super::polygon::Polygon;
use super::spot::Spot;
use super::study::Study;
use crate::math::Form;

/// Patterns at the places 0, 1, 2 … of a scale, joined by straight lines.
#[derive(Clone, Copy)]
pub struct Stops<'s> {
    /// By number.
    pub stops: &'s [u32],
    /// The first pair that counts, by the number of its first stop.
    pub first: usize,
    /// The last pair that counts.
    pub last: usize,
}

impl<'s> Stops<'s> {
    /// All of them; `None` where there aren't two.
    pub fn all(stops: &'s [u32]) -> Option<Stops<'s>> {
        Some(Stops { stops, first: 0, last: stops.len().checked_sub(2)? })
    }
}

impl<'c> Study<'c> {
    /// The colours at the places `x`, which beyond either end are those of the end.
    pub fn blended(&mut self, p: &Polygon, all: Stops<'_>, x: Form, at: &Spot<'_>, then: Coloured<'_, 'c>) -> Bound {
        let (lo, hi) = p.range(x);
        // Rounding may leave a polygon just beyond the place that it was cut at.
        let pair = |x: f64| (x.floor().clamp(all.first as f64, all.last as f64)) as usize;
        let (first, last) = (pair(lo), pair(hi));
        if first == last {
            let s = x - Form::constant(first as f64);
            return self.mixed(p, (all.stops[first], all.stops[first + 1]), [s.share(); 3], at, then);
        }
        let middle = (first + last).div_ceil(2);
        let beyond = x - Form::constant(middle as f64);
        // A cut that leaves nearly all to both sides is none.
        if !(x.x.abs() + x.y.abs() > x.r) {
            let any = all.stops[first..=last + 1].iter().map(|s| self.scene.pattern_range(*s));
            let any = any.reduce(|a, b| [0, 1, 2].map(|c| hull(a[c], b[c]))).unwrap_or([[0.0; 2]; 3]);
            return then(self, p, any.map(|[lo, hi]: Span| Form::between(lo, hi)));
        }
        self.split(p, beyond, &mut |study, q, yes| {
            let (first, last) = if yes { (middle, last) } else { (first, middle - 1) };
            study.blended(q, Stops { first, last, ..all }, x, at, then)
        })
    }
}
