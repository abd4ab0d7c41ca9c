//! The point of a surface at which a pattern is asked for, and the maps from there to the spaces that patterns stand in.

use crate::math::real::{Real, dot, each3, scaled, splat3, three};

/// A map, by rows.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rows {
    /// Three factors and an addend each.
    pub rows: [[f64; 4]; 3],
    /// Whether it only moves points, as the map to a pattern's space mostly does.
    is_shift: bool,
}

impl Rows {
    /// The map with these rows.
    pub fn new(rows: [[f64; 4]; 3]) -> Rows {
        let [x, y, z] = &rows;
        let (diagonal, off) = ([x[0], y[1], z[2]], [x[1], x[2], y[0], y[2], z[0], z[1]]);
        Rows { rows, is_shift: diagonal == [1.0; 3] && off == [0.0; 6] }
    }
}

/// A point of a surface at which patterns are evaluated. What but few of them ask for is found when they do.
#[derive(Clone, Copy)]
pub struct PatternPoint<'a, R> {
    /// The point in the shape's own frame.
    pub local: [R; 3],
    /// From there to every space of the table; none where only constants are asked for.
    pub spaces: &'a [Rows],
    /// Outward unit normal in the world.
    pub n: [R; 3],
    /// Only where a picture or a bump asks.
    pub detail: Option<&'a MadeDetail>,
}

/// What pictures and bumps need of a shape.
#[derive(Clone, Debug)]
pub struct MadeDetail {
    /// World normals to normals of the space in which the shape was made, but for their length.
    pub made_normal_from_world: [[f64; 3]; 3],
    /// And back.
    pub world_normal_from_made: [[f64; 3]; 3],
    /// From the shape's centre to the origin of its frame, in the space in which it was made.
    pub from_centre: [f64; 3],
    /// Half the shape's height there.
    pub half_height: f64,
}

impl<R: Real> PatternPoint<'_, R> {
    /// The point in the space in which the shape is made.
    #[inline(always)]
    pub fn made(&self) -> [R; 3] {
        match self.spaces.first() {
            Some(first) => apply(first, self.local),
            None => self.local,
        }
    }

    /// The unit normal there.
    #[inline(always)]
    pub fn normal(&self) -> [R; 3] {
        match self.detail {
            Some(detail) => turned(&detail.made_normal_from_world, self.n),
            None => self.n,
        }
    }

    /// From the shape's centre to the point there. Not by way of the point: a shape made far from the origin keeps its bits.
    #[inline(always)]
    pub fn around_centre(&self) -> [R; 3] {
        match (self.detail, self.spaces.first()) {
            (Some(detail), Some(Rows { rows, is_shift })) => {
                let shift = detail.from_centre;
                let rows = three!(i => [rows[i][0], rows[i][1], rows[i][2], shift[i]]);
                apply(&Rows { rows, is_shift: *is_shift }, self.local)
            }
            _ => self.made(),
        }
    }
}

/// A unit normal through the linear map for normals.
#[inline(always)]
pub fn turned<R: Real>(map: &[[f64; 3]; 3], n: [R; 3]) -> [R; 3] {
    let m = each3!(*map, row => dot(splat3(row), n));
    scaled(R::one() / dot(m, m).sqrt(), m)
}

/// The image of a point.
#[inline(always)]
pub fn apply<R: Real>(map: &Rows, p: [R; 3]) -> [R; 3] {
    if map.is_shift {
        return three!(i => p[i] + R::splat(map.rows[i][3])); // the same to the bit: 1·x + 0·y is x
    }
    each3!(map.rows, [x, y, z, w] => (R::splat(x) * p[0] + R::splat(y) * p[1]) + (R::splat(z) * p[2] + R::splat(w)))
}
