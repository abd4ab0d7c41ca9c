//! Points of a pixel that lie on a lattice, its middle among them (rank-1 lattices: Sloan, Joe, "Lattice methods for multiple
//! integration", 1994). Of the share of an edge's side they err by about n^(-3/4), where points by chance err by n^(-1/2), and each column and
//! each row holds one of them.

/// A lattice: point number i lies i/n to the right of the middle and i·g/n below it, wrapped around.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lattice {
    n: u32,
    g: u32,
}

impl Lattice {
    /// Lattices of so many points, each of which holds the one before: every count is a multiple of the one before. The g is taken whose
    /// points are furthest apart, in that one of the lattices where they are nearest.
    pub fn nested<const N: usize>(counts: [u32; N]) -> [Lattice; N] {
        let last = counts.iter().copied().max().unwrap_or(1);
        let merit = |g: u32| {
            let each = counts.iter().map(|&n| Lattice { n, g: g % n }.merit());
            each.fold(f64::INFINITY, |least, m| if m < least { m } else { least })
        };
        let (mut best, mut most) = (1, merit(1));
        // Those beyond the half are mirrored.
        for g in 2..=last / 2 {
            let merit = merit(g);
            if merit > most {
                (best, most) = (g, merit);
            }
        }
        counts.map(|n| Lattice { n, g: best % n })
    }

    /// How many points.
    pub fn count(self) -> u32 {
        self.n
    }

    /// All points, in the order of their numbers, from the middle of the pixel: −1/2 to 1/2. They are turned over one or both of two
    /// ways, by the lowest bits of `way`.
    pub fn points(self, way: u64) -> impl Iterator<Item = [f64; 2]> {
        let wrapped = move |i: u32| if 2 * i < self.n { i as f64 } else { i as f64 - self.n as f64 } / self.n as f64;
        (0..self.n).map(move |i| {
            let [x, y] = [wrapped(i), wrapped(self.row(i))];
            let x = if way & 1 == 0 { x } else { -x };
            if way & 2 == 0 { [x, y] } else { [y, x] }
        })
    }

    fn row(self, i: u32) -> u32 {
        (i as u64 * self.g as u64 % self.n as u64) as u32
    }

    /// The square of the least distance of two points, where pixel stands beside pixel, over that of a square grid of as many.
    fn merit(self) -> f64 {
        let short = |i: u32| if 2 * i < self.n { i as u64 } else { (self.n - i) as u64 };
        let square = |i| short(i) * short(i) + short(self.row(i)) * short(self.row(i));
        // One point is as far from itself as it can be.
        let least = (1..self.n).map(square).min().unwrap_or(1);
        let distinct = (1..self.n).all(|i| self.row(i) != 0);
        if distinct { least as f64 / self.n as f64 } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::fun::{cos_deg, sin_deg};

    #[test]
    fn columns_and_rows_hold_one_point_each() {
        for n in [1, 2, 3, 4, 5, 9, 17, 64, 257, 1025] {
            let [lattice] = Lattice::nested([n]);
            for way in 0..4 {
                let points: Vec<[f64; 2]> = lattice.points(way).collect();
                assert_eq!((points.len(), points[0]), (n as usize, [0.0, 0.0]));
                for axis in 0..2 {
                    assert!(points.iter().all(|p| p[axis].abs() <= 0.5));
                    let mut cells: Vec<i64> =
                        points.iter().map(|p| ((p[axis] * n as f64).round() as i64).rem_euclid(n as i64)).collect();
                    cells.sort();
                    assert!(cells.iter().copied().eq(0..n as i64), "{n}: {points:?}");
                }
            }
        }
    }

    #[test]
    fn nested_lattices_hold_the_smaller_ones() {
        let lattices = Lattice::nested([5, 25, 125, 625]);
        for (few, many) in lattices.iter().zip(&lattices[1..]) {
            let step = (many.n / few.n) as usize;
            let held: Vec<[f64; 2]> = many.points(1).step_by(step).collect();
            assert_eq!(few.points(1).collect::<Vec<_>>(), held);
        }
        assert_eq!(lattices.map(Lattice::merit), [1.0; 4], "square lattices, turned");
    }

    /// The part of the square of side 1 around 0 that lies where x·cos + y·sin < offset; cos and sin aren't 0.
    fn part(cos: f64, sin: f64, offset: f64) -> f64 {
        let (a, b) = (cos.abs(), sin.abs());
        let along = offset + 0.5 * (a + b);
        let triangle = |length: f64| if length > 0.0 { length * length } else { 0.0 };
        (triangle(along) - triangle(along - a) - triangle(along - b) + triangle(along - a - b)) / (2.0 * a * b)
    }

    #[test]
    fn an_edge_of_any_direction_is_met_by_its_share() {
        for n in [5, 9, 17, 25, 65, 125] {
            let [lattice] = Lattice::nested([n]);
            let (mut squares, mut count) = (0.0, 0);
            for angle in 0..64 {
                let angle = (angle as f64 + 0.5) * 180.0 / 64.0;
                let (sin, cos) = (sin_deg(angle), cos_deg(angle));
                for k in 0..64 {
                    let offset = (k as f64 - 31.5) / 128.0;
                    let met = lattice.points(0).filter(|[x, y]| x * cos + y * sin < offset).count();
                    let off = met as f64 / n as f64 - part(cos, sin, offset);
                    squares += off * off;
                    count += 1;
                }
            }
            // About n^(-3/4) is the least that any points reach for all half-planes (Beck, "Irregularities of distribution I", 1987). Points by
            // chance are off by about 0.43·n^(-1/2).
            let (off, n) = ((squares / count as f64).sqrt(), n as f64);
            assert!(off < 0.36 / (n.sqrt() * n.sqrt().sqrt()), "{n}: {off}");
        }
    }
}
