//! Axis-aligned boxes that surely hold what they bound.

/// A box in the camera-relative world. Empty when `lo` is above `hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest corner.
    pub lo: [f64; 3],
    /// Largest corner.
    pub hi: [f64; 3],
}

/// Relative widening of a box: eight roundings, more than any bound below goes through.
const SLACK: f64 = 8.0 * f64::EPSILON;

impl Bounds {
    /// Holds nothing.
    pub const EMPTY: Bounds = Bounds { lo: [f64::INFINITY; 3], hi: [f64::NEG_INFINITY; 3] };

    /// Around `centre`, `half` to each side, widened for rounding.
    pub fn around(centre: [f64; 3], half: [f64; 3]) -> Bounds {
        let reach: [f64; 3] = std::array::from_fn(|i| half[i] + SLACK * (half[i] + centre[i].abs()));
        Bounds { lo: std::array::from_fn(|i| centre[i] - reach[i]), hi: std::array::from_fn(|i| centre[i] + reach[i]) }
    }
    /// Around points, widened for rounding.
    pub fn of_points(points: [[f64; 3]; 3]) -> Bounds {
        points.into_iter().fold(Bounds::EMPTY, |b, p| b.union(Bounds::around(p, [0.0; 3])))
    }
    /// Holds both.
    pub fn union(self, o: Bounds) -> Bounds {
        Bounds {
            lo: std::array::from_fn(|i| smaller(self.lo[i], o.lo[i])),
            hi: std::array::from_fn(|i| larger(self.hi[i], o.hi[i])),
        }
    }
    /// Holds the point too.
    pub fn with(self, p: [f64; 3]) -> Bounds {
        self.union(Bounds { lo: p, hi: p })
    }
    /// Whether they have a point in common.
    pub fn overlaps(&self, o: &Bounds) -> bool {
        (0..3).all(|i| self.lo[i] <= o.hi[i] && o.lo[i] <= self.hi[i])
    }
    /// The middle.
    pub fn centre(&self) -> [f64; 3] {
        std::array::from_fn(|i| 0.5 * self.lo[i] + 0.5 * self.hi[i])
    }
    /// Radius of a ball around the centre that surely holds the box.
    pub fn radius(&self) -> f64 {
        let c = self.centre();
        let h: [f64; 3] = std::array::from_fn(|i| larger(self.hi[i] - c[i], c[i] - self.lo[i]));
        (h[0] * h[0] + h[1] * h[1] + h[2] * h[2]).sqrt() * (1.0 + SLACK)
    }
    /// Half the area of the surface: the measure of how likely a ray is to meet it.
    pub fn half_area(&self) -> f64 {
        let e: [f64; 3] = std::array::from_fn(|i| self.hi[i] - self.lo[i]);
        if e[0] < 0.0 { 0.0 } else { e[0] * e[1] + e[1] * e[2] + e[2] * e[0] }
    }
    /// The corner furthest along `n`.
    pub fn support(&self, n: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| if n[i] > 0.0 { self.hi[i] } else { self.lo[i] })
    }
}

/// The smaller of two numbers, neither NaN.
pub fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The larger of two numbers, neither NaN.
pub fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
