//! Whether what a scene is made of has a size and a place that can be traced, where all transforms around it put it.

use super::value::number_text;
use crate::math::{Affine, Real};
use crate::scene::{Shape, range};
use glam::DVec3;

/// What is right.
const LENGTHS: &str = "a length or coordinate is 0, or from 1e-140 to 1e140 in size";

/// Why a shape can't be traced where it stands: what it is there, and what would be right.
pub fn misplaced(shape: &Shape, world_from_object: &Affine) -> Option<(String, &'static str)> {
    if surely_placed(shape, world_from_object) {
        return None;
    }
    let m = world_from_object.linear_f64();
    let column = |c: usize| DVec3::new(m[0][c], m[1][c], m[2][c]).abs().max_element();
    let (a, b, c) = (column(0), column(1), column(2));
    let (least, most) = (Real::min(a, Real::min(b, c)), Real::max(a, Real::max(b, c)));
    let usable = |x: f64| x.is_finite() && range::is_supported(x) && x != 0.0;
    if !usable(least) || !usable(most) || world_from_object.inverse().is_none() {
        return Some(("is scaled beyond all measure".into(), LENGTHS));
    }
    if is_flattened(m) {
        let what = "between its turns it is scaled so unevenly that rounding leaves nothing of one direction";
        return Some(("is flattened beyond all measure".into(), what));
    }
    let (points, small, large) = extent(shape);
    if small * least < range::SMALLEST {
        return Some((format!("is too small: about {}", number_text(small * least)), LENGTHS));
    }
    // What isn't finite has no largest element.
    let fits = |p: DVec3| p.is_finite() && p.abs().max_element() <= range::LARGEST;
    if !(large * most <= range::LARGEST && points.iter().all(|p| fits(world_from_object.apply(*p)))) {
        return Some(("is too large or too far away".into(), LENGTHS));
    }
    None
}

/// Why a light can't shine where it stands.
pub fn misplaced_light(at: DVec3, world_from_object: &Affine) -> Option<(String, &'static str)> {
    let at = world_from_object.apply(at);
    let fits = at.is_finite() && at.abs().max_element() <= range::LARGEST;
    (!fits).then(|| ("is too far away".into(), LENGTHS))
}

/// Whether a map from the space of one pattern to that of another is one of numbers.
pub fn is_measurable(map: &Affine) -> bool {
    // Where a point of the world may be, no product overflows.
    const FARTHEST: f64 = range::LARGEST * range::LARGEST;
    let linear = map.linear_f64();
    let size = |v: [f64; 3]| v.iter().fold(0.0, |m: f64, x| if x.abs() <= m { m } else { x.abs() });
    let rows_fit = linear.into_iter().all(|row| (range::SMALLEST..=range::LARGEST).contains(&size(row)));
    rows_fit && size(map.shift_f64()) <= FARTHEST
}

/// Whether rounding has eaten one direction of a map: what is left of its determinant when every row and column is brought to
/// about 1. Plain stretching along the axes, before or after a turn, leaves it as it is.
fn is_flattened(mut m: [[f64; 3]; 3]) -> bool {
    /// The rounding of the sixteen products and sums of a map and its determinant, and some room.
    const NOTHING_LEFT: f64 = 1e4 * f64::EPSILON;
    // Each round brings rows and columns nearer to 1; three are enough for an order of magnitude.
    for _ in 0..3 {
        for row in &mut m {
            let largest = row.iter().fold(0.0, |a: f64, x| if x.abs() > a { x.abs() } else { a });
            *row = row.map(|x| x / largest);
        }
        for i in 0..3 {
            let largest = m.iter().fold(0.0, |a: f64, r| if r[i].abs() > a { r[i].abs() } else { a });
            m.iter_mut().for_each(|r| r[i] /= largest);
        }
    }
    let [a, b, c] = m.map(DVec3::from_array);
    !(a.cross(b).dot(c).abs() > NOTHING_LEFT)
}

/// Whether a shape stands so far within all limits that `f64` can tell: nearly every one does.
fn surely_placed(shape: &Shape, world_from_object: &Affine) -> bool {
    /// Room to the limits: far more than the rounding of a few sums and products.
    const ROOM: f64 = 1e6;
    let m = world_from_object.linear_f64();
    // A sum lets nothing that isn't a number through.
    let size = |v: [f64; 3]| v[0].abs() + v[1].abs() + v[2].abs();
    let rows = m.map(size);
    let columns = [0, 1, 2].map(|c| size([m[0][c], m[1][c], m[2][c]]));
    let normal = |x: &f64| (range::SMALLEST * ROOM..=range::LARGEST / ROOM).contains(x);
    if !rows.iter().chain(&columns).all(normal) {
        return false;
    }
    // Rows of size 1: the determinant's rounding error is a few 1e-16.
    let [a, b, c] = [0, 1, 2].map(|r| DVec3::from_array(m[r].map(|x| x / rows[r])));
    let (points, small, large) = extent(shape);
    let far = points.iter().map(|p| size(p.to_array())).fold(large, Real::max);
    let reach = 3.0 * size(rows) * far + size(world_from_object.shift_f64());
    a.cross(b).dot(c).abs() > 1e-9
        && small * columns.into_iter().fold(f64::INFINITY, Real::min) >= range::SMALLEST * ROOM
        && reach <= range::LARGEST / ROOM
}

/// Points of a shape, its smallest and its largest size; 1 where it has none.
fn extent(shape: &Shape) -> ([DVec3; 4], f64, f64) {
    let edges = |p: &[DVec3]| {
        let sizes = p.iter().skip(1).map(|q| (*q - p[0]).abs().max_element());
        sizes.fold((f64::INFINITY, 0f64), |(lo, hi), s| (Real::min(lo, s), Real::max(hi, s)))
    };
    let tube = |from: DVec3, to: DVec3, r: f64| ([from, to, to, to], Real::min(r, (to - from).abs().max_element()), r);
    match shape {
        Shape::Sphere { at, r } => ([*at; 4], *r, *r),
        Shape::Plane { through, .. } => ([*through; 4], 1.0, 1.0),
        Shape::Box { from, to } => ([*from, *to, *to, *to], (*to - *from).min_element(), (*to - *from).max_element()),
        Shape::Disc { at, r, .. } => ([*at; 4], *r, *r),
        Shape::Cylinder { from, to, r, .. } => tube(*from, *to, *r),
        Shape::Cone { from, to, r, top, .. } => tube(*from, *to, Real::max(*r, *top)),
        Shape::Torus { at, r, tube, .. } => ([*at; 4], *tube, r + tube),
        Shape::Triangle { points, .. } => {
            let (lo, hi) = edges(&points[..]);
            let [a, b, c] = **points;
            ([a, b, c, c], lo, hi)
        }
        Shape::Tetrahedron { points } => {
            let (lo, hi) = edges(&points[..]);
            (**points, lo, hi)
        }
    }
}
