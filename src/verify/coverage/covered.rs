//! How much of a square a shape covers: exactly, but for rounding.

use crate::math::fun;
use crate::render::bounds::{larger, smaller};

/// A square of the picture: its left, lower, right and upper end.
pub(super) type Square = [f64; 4];

/// The area of `square` that lies within a disc.
pub(super) fn disc(centre: [f64; 2], r: f64, square: Square) -> f64 {
    let [x0, y0, x1, y1] = [square[0] - centre[0], square[1] - centre[1], square[2] - centre[0], square[3] - centre[1]];
    let (left, right) = (larger(x0, -r), smaller(x1, r));
    if left >= right {
        return 0.0;
    }
    // Between these the strip's upper end is either the circle's or the square's, and so its lower one.
    let corner = |y: f64| if y.abs() < r { ((r - y) * (r + y)).sqrt() } else { 0.0 };
    let mut cuts = vec![left, right];
    cuts.extend([corner(y0), -corner(y0), corner(y1), -corner(y1)].into_iter().filter(|x| left < *x && *x < right));
    cuts.sort_by(f64::total_cmp);
    let half = |x: f64| ((r - x) * (r + x)).sqrt();
    // The integral of the half circle's height, from the left end on.
    let under = |x: f64| 0.5 * (x * half(x) + r * r * fun::asin(larger(smaller(x / r, 1.0), -1.0)));
    cuts.windows(2)
        .map(|w| {
            let (a, b) = (w[0], w[1]);
            let height = half(0.5 * (a + b));
            if height <= y0 || -height >= y1 {
                return 0.0;
            }
            let arc = under(b) - under(a);
            let top = if height < y1 { arc } else { y1 * (b - a) };
            let bottom = if -height > y0 { -arc } else { y0 * (b - a) };
            top - bottom
        })
        .sum()
}

/// The area of `square` that lies within a convex polygon, whose corners go either way round.
pub(super) fn polygon(corners: &[[f64; 2]], square: Square) -> f64 {
    let [x0, y0, x1, y1] = square;
    let mut inside: Vec<[f64; 2]> = vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
    let turn = signed_area(corners);
    for (a, b) in edges(corners) {
        // Positive to the inside of the edge (Sutherland, Hodgman, CACM 17, 1974).
        let side = |p: [f64; 2]| ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])) * turn;
        let mut kept = Vec::with_capacity(inside.len() + 1);
        for (p, q) in edges(&inside) {
            let (sp, sq) = (side(p), side(q));
            if sp >= 0.0 {
                kept.push(p);
            }
            if (sp >= 0.0) != (sq >= 0.0) {
                let t = sp / (sp - sq);
                kept.push([p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]);
            }
        }
        inside = kept;
    }
    signed_area(&inside).abs()
}

/// The edges of a closed polygon.
fn edges(corners: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
    corners.iter().zip(corners.iter().cycle().skip(1)).map(|(a, b)| (*a, *b))
}

fn signed_area(corners: &[[f64; 2]]) -> f64 {
    let Some(&o) = corners.first() else { return 0.0 };
    // From one of its corners: coordinates far away would cancel.
    let twice = |(a, b): ([f64; 2], [f64; 2])| (a[0] - o[0]) * (b[1] - o[1]) - (b[0] - o[0]) * (a[1] - o[1]);
    0.5 * edges(corners).map(twice).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::draw::Draw;
    use std::f64::consts::PI;

    #[test]
    fn whole_and_half_discs() {
        let of = |centre, r, square| disc(centre, r, square);
        assert!((of([0.3, -0.2], 0.25, [-1.0, -1.0, 1.0, 1.0]) - PI * 0.0625).abs() < 1e-15);
        assert!((of([0.0, 0.0], 0.5, [0.0, -1.0, 1.0, 1.0]) - PI * 0.125).abs() < 1e-15);
        assert!((of([0.0, 0.0], 0.5, [0.0, 0.0, 1.0, 1.0]) - PI * 0.0625).abs() < 1e-15);
        assert_eq!(of([0.0, 0.0], 9.0, [0.0, 0.0, 1.0, 1.0]), 1.0);
        assert_eq!(of([3.0, 0.0], 1.0, [0.0, 0.0, 1.0, 1.0]), 0.0);
    }

    #[test]
    fn areas_of_parts_add_up_and_agree_with_counting() {
        let mut draw = Draw::new("covered", 0);
        for case in 0..200 {
            let centre = [draw.between(-1.0, 2.0), draw.between(-1.0, 2.0)];
            let r = draw.between(0.05, 1.5);
            let corners = [0; 3].map(|_| [draw.between(-1.0, 2.0), draw.between(-1.0, 2.0)]);
            for area in
                [&|s: Square| disc(centre, r, s), &|s: Square| polygon(&corners, s)] as [&dyn Fn(Square) -> f64; 2]
            {
                let whole = area([0.0, 0.0, 1.0, 1.0]);
                let quarters = [[0.0, 0.0], [0.5, 0.0], [0.0, 0.5], [0.5, 0.5]];
                let parts: f64 = quarters.iter().map(|[x, y]| area([*x, *y, x + 0.5, y + 0.5])).sum();
                assert!((whole - parts).abs() < 1e-13, "{case}: {whole} {parts}");
            }
            let n = 200;
            let hits = (0..n * n).filter(|k| {
                let [x, y] = [(k % n) as f64 + 0.5, (k / n) as f64 + 0.5].map(|v| v / n as f64 - 0.0);
                (x - centre[0]) * (x - centre[0]) + (y - centre[1]) * (y - centre[1]) < r * r
            });
            let counted = hits.count() as f64 / (n * n) as f64;
            let whole = disc(centre, r, [0.0, 0.0, 1.0, 1.0]);
            // Cells on the rim, at most about 2πr·n of n².
            assert!((counted - whole).abs() < 0.01, "{case}: {counted} {whole}");
        }
    }
}
