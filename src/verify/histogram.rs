//! How errors spread, in ulp: counts by size, and quantiles from them.

use super::draw::power;
use crate::render::bounds::larger;

/// Counts of errors by size: four bins to every power of two, so that every bound the programme states is the edge of a bin.
/// Adding up is exact, so the work may be shared out in any way.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    counts: [u64; Histogram::FINE],
    max: f64,
}

/// The smallest error told apart is 2^LOWEST, the largest 2^HIGHEST.
const LOWEST: i32 = -3;
const HIGHEST: i32 = 20;
/// Bins to a power of two.
const PARTS: usize = 4;

impl Histogram {
    /// Number of [`bins`](Histogram::bins).
    pub const BINS: usize = (HIGHEST - LOWEST) as usize + 2;
    const FINE: usize = (HIGHEST - LOWEST) as usize * PARTS + 2;

    /// An empty one.
    pub fn new() -> Histogram {
        Histogram { counts: [0; Histogram::FINE], max: 0.0 }
    }

    /// Counts an error; its sign doesn't matter, and NaN counts as infinite.
    pub fn add(&mut self, error: f64) {
        let error = if error.is_nan() { f64::INFINITY } else { error.abs() };
        self.counts[bin_of(error)] += 1;
        self.max = larger(self.max, error);
    }

    /// Counts the errors of another one too.
    pub fn merge(&mut self, other: &Histogram) {
        for (to, from) in self.counts.iter_mut().zip(other.counts) {
            *to += from;
        }
        self.max = larger(self.max, other.max);
    }

    /// Errors counted.
    pub fn count(&self) -> u64 {
        self.counts.iter().sum()
    }

    /// The largest error, exactly; 0 where none was counted.
    pub fn max(&self) -> f64 {
        self.max
    }

    /// The value that a share `q` of the errors doesn't exceed, rounded up to the edge of a bin but never beyond the largest
    /// error; 0 where none was counted.
    pub fn quantile(&self, q: f64) -> f64 {
        let wanted = (q * self.count() as f64).ceil() as u64;
        let mut seen = 0;
        for (bin, n) in self.counts.iter().enumerate() {
            seen += n;
            if seen >= wanted {
                let edge = upper_edge(bin);
                return if edge < self.max { edge } else { self.max };
            }
        }
        self.max
    }

    /// One bin a power of two, for showing: its upper edge, infinite for the last, and how many errors are below it but not
    /// below the one before.
    pub fn bins(&self) -> [(f64, u64); Histogram::BINS] {
        let mut out = [(f64::INFINITY, 0); Histogram::BINS];
        for (bin, n) in self.counts.iter().enumerate() {
            let coarse = bin.div_ceil(PARTS).min(Histogram::BINS - 1);
            out[coarse].1 += n;
        }
        for (i, bin) in out[..Histogram::BINS - 1].iter_mut().enumerate() {
            bin.0 = power(LOWEST + i as i32);
        }
        out
    }

    /// How a bin of this upper edge is called: `<1/8`, `<2`, `<1024`, and `more` for the last.
    pub fn label(edge: f64) -> String {
        match edge {
            e if e.is_infinite() => "more".into(),
            e if e < 1.0 => format!("<1/{}", 1.0 / e),
            e => format!("<{e}"),
        }
    }
}

impl Default for Histogram {
    fn default() -> Self {
        Histogram::new()
    }
}

/// Bin 0 is below 2^LOWEST, the last one 2^HIGHEST and above; between them exponent and the two leading bits of the fraction
/// tell.
fn bin_of(error: f64) -> usize {
    if error < power(LOWEST) {
        return 0;
    }
    if error >= power(HIGHEST) {
        return Histogram::FINE - 1;
    }
    let quarter_octaves = (error.to_bits() >> 50) as usize;
    quarter_octaves - (power(LOWEST).to_bits() >> 50) as usize + 1
}

fn upper_edge(bin: usize) -> f64 {
    match bin {
        _ if bin == Histogram::FINE - 1 => f64::INFINITY,
        _ => f64::from_bits(((power(LOWEST).to_bits() >> 50) + bin as u64) << 50),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_edges_and_never_too_small() {
        let mut h = Histogram::new();
        assert_eq!((h.quantile(0.99), h.max()), (0.0, 0.0));
        for i in 0..1000 {
            h.add(i as f64 / 100.0);
        }
        assert_eq!((h.count(), h.max()), (1000, 9.99));
        assert_eq!(h.quantile(0.5), 5.0);
        assert_eq!(h.quantile(0.99), 9.99);
        assert_eq!(h.quantile(0.4), 4.0);
        let mut twice = h.clone();
        twice.merge(&h);
        assert_eq!((twice.count(), twice.quantile(0.5)), (2000, 5.0));
        h.add(f64::NAN);
        assert_eq!(h.max(), f64::INFINITY);
    }

    #[test]
    fn bins_hold_what_lies_below_their_edges() {
        let mut h = Histogram::new();
        for e in [0.0, 0.124, 0.125, 0.249, 0.25, 1.0, 1.99, 2.0, 1e5, 1e9] {
            h.add(-e);
        }
        let bins = h.bins();
        let of = |edge: f64| bins.iter().find(|b| b.0 == edge).unwrap().1;
        assert_eq!((of(0.125), of(0.25), of(0.5), of(1.0), of(2.0), of(4.0)), (2, 2, 1, 0, 2, 1));
        assert_eq!((of(131_072.0), of(f64::INFINITY)), (1, 1));
        assert_eq!(bins.iter().map(|b| b.1).sum::<u64>(), 10);
        assert_eq!([0.125, 1.0, 1024.0, f64::INFINITY].map(Histogram::label), ["<1/8", "<1", "<1024", "more"]);
    }
}
