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
        let mut half = Polygon::empty();
        let mut between = |p: &Polygon, f: Form, (lo, hi): (f64, f64), out: &mut Polygon| {
            p.clip(straight(f, lo), &mut half);
            half.clip(-straight(f, hi), out);
        };
        let (mut column, mut inner_column) = (Polygon::empty(), Polygon::empty());
        let (mut cell, mut inner) = (Polygon::empty(), Polygon::empty());
        let around = self.around((i0, i1), (j0, j1));
        for i in i0..=i1 {
            between(p, self.x, (i as f64, i as f64 + 1.0), &mut column);
            if column.is_empty() {
                continue;
            }
            between(&column, self.x, (i as f64 + rx, i as f64 + 1.0 - rx), &mut inner_column);
            for j in j0..=j1 {
                between(&column, self.y, (j as f64, j as f64 + 1.0), &mut cell);
                if cell.is_empty() {
                    continue;
                }
                between(&inner_column, self.y, (j as f64 + ry, j as f64 + 1.0 - ry), &mut inner);
                tally.add(&around.of((i - i0) as usize, (j - j0) as usize), cell.moments(), inner.area());
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

    /// The texels of some columns and rows, and where those lie that surround each.
    fn around(&self, (i0, i1): (i64, i64), (j0, j1): (i64, i64)) -> Around {
        let height = (j1 - j0 + 3) as usize;
        let mut texels = Vec::with_capacity((i1 - i0 + 3) as usize * height);
        for i in i0 - 1..=i1 + 1 {
            for j in j0 - 1..=j1 + 1 {
                texels.push(self.at(i, j));
            }
        }
        let spans = |k: usize| texels[k].map(|x| [x; 2]);
        let tall = |k: usize| {
            let (a, b, c) = (spans(k), spans(k + 1), spans(k + 2));
            [0, 1, 2].map(|i| hull(hull(a[i], b[i]), c[i]))
        };
        let tall = (0..texels.len().saturating_sub(2)).map(tall).collect();
        Around { texels, tall, height }
    }
}

/// Texels of a block and one row and column more on each side, column by column.
struct Around {
    texels: Vec<[f64; 3]>,
    /// Of each texel, where it and the two below it lie; of the last two of a column nothing of use.
    tall: Vec<[Span; 3]>,
    height: usize,
}

impl Around {
    /// A texel of the block, and where it and its eight neighbours lie.
    fn of(&self, i: usize, j: usize) -> ([f64; 3], [Span; 3]) {
        let at = i * self.height + j;
        let [a, b, c] = [0, 1, 2].map(|k| &self.tall[at + k * self.height]);
        (self.texels[at + self.height + 1], three!(k => hull(hull(a[k], b[k]), c[k])))
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
    /// Adds a texel that is seen on a cell, of which `inner` is surely its.
    fn add(&mut self, (texel, around): &([f64; 3], [Span; 3]), cell: Moments, inner: f64) {
        let border = larger(cell.area - inner, 0.0) + 2.0 * AREA_ERROR;
        for c in 0..3 {
            let m = &mut self.moments[c];
            (m.area, m.x, m.y) = (m.area + texel[c] * cell.area, m.x + texel[c] * cell.x, m.y + texel[c] * cell.y);
            self.differ[c] += border * larger(around[c][1] - texel[c], texel[c] - around[c][0]);
        }
        self.values = Some(match self.values {
            Some(values) => three!(c => hull(values[c], around[c])),
            None => *around,
        });
        self.area += cell.area;
        self.error += AREA_ERROR;
    }

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
