//! What a check found.

use super::Histogram;

/// What a check found.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Cases tried.
    pub cases: u64,
    /// Figures, each with its bound.
    pub figures: Vec<Figure>,
    /// The first case that was out of bounds, in words that let it be found again.
    pub first_failure: Option<String>,
}

/// One measured figure.
#[derive(Clone, Debug)]
pub struct Figure {
    /// What was measured, such as `sphere, distance/radius 1.5e6: t error, p99`.
    pub what: String,
    /// The value.
    pub value: f64,
    /// Its unit, such as `ulp`; empty for counts.
    pub unit: &'static str,
    /// What it must keep.
    pub bound: Bound,
    /// How the values spread, where that says more.
    pub histogram: Option<Histogram>,
}

/// What a figure must keep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// At most this.
    AtMost(f64),
    /// At least this: that a check tried what it says.
    AtLeast(f64),
    /// Nothing: said for information.
    None,
}

impl Figure {
    /// Whether it keeps its bound; NaN never does.
    pub fn is_within(&self) -> bool {
        match self.bound {
            Bound::AtMost(most) => self.value <= most,
            Bound::AtLeast(least) => self.value >= least,
            Bound::None => true,
        }
    }
}

impl Outcome {
    /// Whether every figure keeps its bound.
    pub fn is_within(&self) -> bool {
        self.figures.iter().all(Figure::is_within)
    }
}
