//! What a check found.

use super::Histogram;

/// What a check found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Cases tried.
    pub cases: u64,
    /// Figures, each with its bound.
    pub figures: Vec<Figure>,
    /// The first case that was out of bounds, in words that let it be found again.
    pub first_failure: Option<String>,
}

/// One measured figure.
#[derive(Clone, Debug, PartialEq)]
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
    /// One without a histogram.
    pub fn new(what: impl Into<String>, value: f64, unit: &'static str, bound: Bound) -> Figure {
        Figure { what: what.into(), value, unit, bound, histogram: None }
    }

    /// A number of cases that there must be none of.
    pub fn none_of(what: impl Into<String>, count: u64) -> Figure {
        Figure::new(what, count as f64, "", Bound::AtMost(0.0))
    }

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_kept_or_not() {
        let within = |value, bound| Figure::new("x", value, "", bound).is_within();
        assert!(within(1.0, Bound::AtMost(1.0)) && !within(1.5, Bound::AtMost(1.0)));
        assert!(within(1.0, Bound::AtLeast(1.0)) && !within(0.5, Bound::AtLeast(1.0)));
        assert!(!within(f64::NAN, Bound::AtMost(1.0)) && !within(f64::NAN, Bound::AtLeast(1.0)));
        let outcome = Outcome { figures: vec![Figure::none_of("a", 0), Figure::none_of("b", 1)], ..Outcome::default() };
        assert!(!outcome.is_within());
    }
}
