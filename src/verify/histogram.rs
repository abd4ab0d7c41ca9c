//! How errors spread, in ulp: counts by powers of two, and quantiles from them.

/// Counts of errors by size: below 1/8, below 1/4, … below 2^20, and all above.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Histogram {
    counts: [u64; Histogram::BINS],
}

impl Histogram {
    /// Number of bins.
    pub const BINS: usize = 25;

    /// An empty one.
    pub fn new() -> Histogram {
        Histogram { counts: [0; Histogram::BINS] }
    }
}

impl Default for Histogram {
    fn default() -> Self {
        Histogram::new()
    }
}
