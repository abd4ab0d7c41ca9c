//! Pictures as the tracer reads them: bytes as in the file, brought to linear light by a table.

use crate::scene::color::decode_srgb;
use crate::scene::{Filter, Image, Texels};
use std::sync::Arc;

/// A picture, ready to be looked up. Coordinates outside 0..1 are the caller's to bring back or to wrap.
#[derive(Clone, Debug)]
pub struct Texture {
    width: usize,
    height: usize,
    texels: Arc<Texels>,
    table: Table,
}

/// To linear light, by what the texels are.
#[derive(Clone, Debug)]
enum Table {
    /// A channel's value.
    Value(Box<[f64; 256]>),
    /// The colour of a number.
    Color(Box<[[f64; 3]; 256]>),
}

/// What lies beyond an edge of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// The picture again.
    Repeat,
    /// Its last texel.
    Clamp,
}

impl Texture {
    /// Shares an image's texels.
    pub fn new(image: &Image) -> Texture {
        let linear: [f64; 256] = std::array::from_fn(|i| decode_srgb(i as f64 / 255.0));
        let table = match &*image.texels {
            Texels::Colors(_) => Table::Value(Box::new(linear)),
            Texels::Numbers { colors, .. } => Table::Color(Box::new(colors.map(|c| c.map(|v| linear[v as usize])))),
        };
        Texture { width: image.width as usize, height: image.height as usize, texels: Arc::clone(&image.texels), table }
    }

    /// Bytes it occupies.
    pub fn memory_bytes(&self) -> usize {
        let table = match &self.table {
            Table::Value(table) => size_of_val(&**table),
            Table::Color(table) => size_of_val(&**table),
        };
        self.texels.memory_bytes() + table
    }

    /// Texels across and down.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// The linear colour of the texel in column `i` and row `j` from the top, counted on beyond the edges as they say.
    pub fn at_texel(&self, i: i64, j: i64, edges: [Edge; 2]) -> [f64; 3] {
        self.texel(i as f64, j as f64, edges)
    }

    /// The linear colour at (u, v); (0, 0) is the lower left corner of the picture, (1, 1) the upper right. A coordinate that
    /// isn't finite, as of a point too far away for a number, counts as the picture's left or upper edge.
    #[inline(always)]
    pub fn at(&self, u: f64, v: f64, filter: Filter, edges: [Edge; 2]) -> [f64; 3] {
        let finite = |x: f64| if x.is_finite() { x } else { 0.0 };
        let (x, y) = (finite(u * self.width as f64), finite((1.0 - v) * self.height as f64));
        match filter {
            Filter::Nearest => self.texel(x.floor(), y.floor(), edges),
            Filter::Bilinear => {
                let (x, y) = (x - 0.5, y - 0.5);
                let (x0, y0) = (x.floor(), y.floor());
                let (fx, fy) = (x - x0, y - y0);
                let lerp = |a: [f64; 3], b: [f64; 3], t: f64| -> [f64; 3] {
                    std::array::from_fn(|i| a[i] + t * (b[i] - a[i]))
                };
                let row = |y: f64| lerp(self.texel(x0, y, edges), self.texel(x0 + 1.0, y, edges), fx);
                lerp(row(y0), row(y0 + 1.0), fy)
            }
        }
    }

    #[inline(always)]
    fn texel(&self, x: f64, y: f64, edges: [Edge; 2]) -> [f64; 3] {
        let (i, j) = (index(x, self.width, edges[0]), index(y, self.height, edges[1]));
        let at = j * self.width + i;
        match (&*self.texels, &self.table) {
            (Texels::Numbers { numbers, .. }, Table::Color(colors)) => colors[numbers[at] as usize],
            (Texels::Colors(bytes), Table::Value(linear)) => {
                let texel = &bytes[3 * at..3 * at + 3];
                [linear[texel[0] as usize], linear[texel[1] as usize], linear[texel[2] as usize]]
            }
            _ => [0.0; 3], // never: the table was made for the texels
        }
    }
}

/// The texel number for a whole number `x`; NaN counts as 0.
#[inline(always)]
fn index(x: f64, n: usize, edge: Edge) -> usize {
    if x >= 0.0 && x < n as f64 {
        return x as usize;
    }
    match edge {
        Edge::Repeat => (x.rem_euclid(n as f64) as usize).min(n - 1),
        Edge::Clamp => (x.clamp(0.0, (n - 1) as f64)) as usize,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_by_two() -> Texture {
        let colors = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]];
        texture(Texels::Colors(colors.as_flattened().to_vec()))
    }

    fn texture(texels: Texels) -> Texture {
        Texture::new(&Image { path: "x.png".into(), digest: [0; 32], width: 2, height: 2, texels: texels.into() })
    }

    #[test]
    fn corners_edges_and_the_space_between() {
        let t = two_by_two();
        let clamp = [Edge::Clamp; 2];
        assert_eq!(t.at(0.25, 0.75, Filter::Nearest, clamp), [1.0, 0.0, 0.0], "row 0 is the top");
        assert_eq!(t.at(0.75, 0.25, Filter::Nearest, clamp), [1.0, 1.0, 1.0]);
        assert_eq!(t.at(0.5, 0.75, Filter::Bilinear, clamp), [0.5, 0.5, 0.0]);
        assert_eq!(t.at(0.0, 1.0, Filter::Bilinear, clamp), [1.0, 0.0, 0.0]);
        assert_eq!(t.at(0.0, 0.75, Filter::Bilinear, [Edge::Repeat; 2]), [0.5, 0.5, 0.0]);
        assert_eq!(t.at(-3.75, 7.75, Filter::Nearest, [Edge::Repeat; 2]), [1.0, 0.0, 0.0]);
        for filter in [Filter::Nearest, Filter::Bilinear] {
            for far in [f64::NAN, f64::INFINITY] {
                assert!(t.at(far, far, filter, [Edge::Repeat; 2]).iter().all(|x| x.is_finite()));
                assert_eq!(t.at(far, far, filter, clamp), [1.0, 0.0, 0.0]);
            }
        }
        assert_eq!(t.at(f64::NAN, 1e300, Filter::Nearest, clamp), [1.0, 0.0, 0.0]);
    }

    #[test]
    fn numbers_stand_for_colors() {
        let mut colors = Box::new([[0; 3]; 256]);
        (colors[7], colors[255]) = ([1, 2, 3], [200, 100, 50]);
        let numbered = texture(Texels::Numbers { numbers: vec![7, 255, 255, 7], colors });
        let plain = texture(Texels::Colors(vec![1, 2, 3, 200, 100, 50, 200, 100, 50, 1, 2, 3]));
        for i in 0..4 {
            let at = |t: &Texture| t.at_texel(i % 2, i / 2, [Edge::Clamp; 2]).map(f64::to_bits);
            assert_eq!(at(&numbered), at(&plain));
        }
        let gray = texture(Texels::gray(vec![0, 9, 99, 255]));
        assert_eq!(gray.at_texel(1, 1, [Edge::Clamp; 2]), [1.0; 3]);
    }
}
