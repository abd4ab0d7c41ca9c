//! The mean of a picture over a region: its texels one by one, each over the polygon on which it is seen.
//!
//! Where a surface bends, the borders of texels bend; what that can change is charged by how much neighbouring texels differ, which
//! in most pictures is little.

use super::super::bounds::{larger, smaller};
use super::super::texture::{Edge, Texture};
use super::bound::{Bound, Span, hull};
use super::lit::Shade;
use super::polygon::{AREA_ERROR, Moments, Polygon};
use crate::math::Form;
use crate::math::real::three;

/// Most texels of a polygon that are looked at one by one.
const MOST_TEXELS: i64 = 1024;

/// A picture's texels under a polygon.
pub struct Texels<'t> {
    /// The picture.
    pub texture: &'t Texture,
    /// Its edges.
    pub edges: [Edge; 2],
    /// Column, in texels.
    pub x: Form,
    /// Row from the top, in texels.
    pub y: Form,
}

impl Texels<'_> {
    /// The light `plain + tinted·texel` on `p`; `None` where there are too many texels.
    pub fn light(&self, p: &Polygon, shade: &Shade) -> Option<Bound> {
        let (xs, ys) = (p.range(self.x), p.range(self.y));
        if !(xs.1 - xs.0 < MOST_TEXELS as f64 && ys.1 - ys.0 < MOST_TEXELS as f64) {
            return None;
        }
        let whole = |(lo, hi): (f64, f64)| (lo.floor() as i64, hi.floor() as i64);
        let ((i0, i1), (j0, j1)) = (whole(xs), whole(ys));
        if (i1 - i0 + 1) * (j1 - j0 + 1) > MOST_TEXELS {
            return None;
        }
        let mut tally =
            Tally { moments: [Moments::default(); 3], differ: [0.0; 3], values: None, area: 0.0, error: 0.0 };
        // By how far a texel's border may lie elsewhere; further than a texel, neighbours say nothing.
        let (rx, ry) = (self.x.r, self.y.r);
        if !(rx < 0.5 && ry < 0.5) {
            let any = self.any((i0 - 1, i1 + 1), (j0 - 1, j1 + 1));
            return Some(Bound::of(
                p,
                three!(c => shade.plain[c] + shade.tinted[c] * Form::between(any[c][0], any[c][1])),
            ));
        }
        let straight = |f: Form, shift: f64| Form { c: f.c - shift, r: 0.0, ..f };
        let between = |p: &Polygon, f: Form, lo: f64, hi: f64| p.clipped(straight(f, lo)).clipped(-straight(f, hi));
        for i in i0..=i1 {
            let column = between(p, self.x, i as f64, i as f64 + 1.0);
            if column.is_empty() {
                continue;
            }
            let inner_column = between(&column, self.x, i as f64 + rx, i as f64 + 1.0 - rx);
            for j in j0..=j1 {
                let cell = between(&column, self.y, j as f64, j as f64 + 1.0);
                if cell.is_empty() {
                    continue;
                }
                let inner = between(&inner_column, self.y, j as f64 + ry, j as f64 + 1.0 - ry);
                self.add(&mut tally, (i, j), cell.moments(), inner.area());
            }
        }
        Some(tally.light(p, shade))
    }

    fn at(&self, i: i64, j: i64) -> [f64; 3] {
        self.texture.at_texel(i, j, self.edges)
    }

    /// Where the texels lie of some columns and rows.
    fn any(&self, columns: (i64, i64), rows: (i64, i64)) -> [Span; 3] {
        let mut range = self.at(columns.0, rows.0).map(|x| [x; 2]);
        for i in columns.0..=columns.1 {
            for j in rows.0..=rows.1 {
                let t = self.at(i, j);
                range = three!(c => hull(range[c], [t[c]; 2]));
            }
        }
        range
    }

    /// Adds a texel that is seen on a cell, of which `inner` is surely its.
    fn add(&self, tally: &mut Tally, (i, j): (i64, i64), cell: Moments, inner: f64) {
        let texel = self.at(i, j);
        let around = self.any((i - 1, i + 1), (j - 1, j + 1));
        let border = larger(cell.area - inner, 0.0) + 2.0 * AREA_ERROR;
        for c in 0..3 {
            let m = &mut tally.moments[c];
            (m.area, m.x, m.y) = (m.area + texel[c] * cell.area, m.x + texel[c] * cell.x, m.y + texel[c] * cell.y);
            tally.differ[c] += border * larger(around[c][1] - texel[c], texel[c] - around[c][0]);
        }
        tally.values = Some(match tally.values {
            Some(values) => three!(c => hull(values[c], around[c])),
            None => around,
        });
        tally.area += cell.area;
        tally.error += AREA_ERROR;
    }
}

/// What the texels of a polygon add up to.
struct Tally {
    /// By channel, weighted with the texels.
    moments: [Moments; 3],
    /// By channel, how much bent borders may change the area's integral.
    differ: [f64; 3],
    values: Option<[Span; 3]>,
    /// Of all cells, and how far off that is.
    area: f64,
    error: f64,
}

impl Tally {
    fn light(&self, p: &Polygon, shade: &Shade) -> Bound {
        let values = self.values.unwrap_or([[0.0, 1.0]; 3]);
        let wide =
            Bound::of(p, three!(c => shade.plain[c] + shade.tinted[c] * Form::between(values[c][0], values[c][1])));
        let plain = Bound::of(p, shade.plain);
        // Cells overlap by what their cuts were moved, and may leave out what their corners were rounded.
        let twice = (self.area - p.area()).abs() + self.error + AREA_ERROR;
        let sum = |c: usize| {
            let (a, m) = (shade.tinted[c], &self.moments[c]);
            if !a.is_known() {
                return wide.sum[c];
            }
            let (lo, hi) = p.range(a);
            let most = larger(lo.abs(), hi.abs());
            let brightest = larger(values[c][0].abs(), values[c][1].abs());
            let mean = a.c * m.area + (a.x * m.x + a.y * m.y);
            let linear = a.c.abs() + a.x.abs() + a.y.abs();
            // What isn't linear; what borders change; what cells have twice or not at all; moments that are off.
            let off = a.r * brightest * (self.area + self.error)
                + most * (self.differ[c] + brightest * twice)
                + linear * brightest * (self.error + self.area * MARGIN);
            let [lo, hi] = [plain.sum[c][0] + mean - off, plain.sum[c][1] + mean + off];
            [larger(lo, wide.sum[c][0]), smaller(hi, wide.sum[c][1])]
        };
        Bound { sum: [0, 1, 2].map(sum), ..wide }
    }
}

/// Relative margin for adding up as many terms as there are texels: 2^-40.
const MARGIN: f64 = 1.0 / (1u64 << 40) as f64;
