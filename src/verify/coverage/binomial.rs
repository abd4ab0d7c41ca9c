//! What a number of failures says of their probability.

use crate::math::fun;

/// The smallest probability of failing with which as few as `failures` of `n` would come about with probability `alpha` only
/// (Clopper, Pearson, Biometrika 26, 1934): the true one is below, with confidence 1 − `alpha`. 1 where nothing was tried.
pub(super) fn upper_limit(failures: u64, n: u64, alpha: f64) -> f64 {
    bisect(failures < n, |p| at_most(failures, n, p) > alpha)
}

/// The largest probability of failing with which as many as `failures` of `n` would come about with probability `alpha` only: the
/// true one is above, with confidence 1 − `alpha`. 0 where none failed.
pub fn lower_limit(failures: u64, n: u64, alpha: f64) -> f64 {
    if failures == 0 {
        return 0.0;
    }
    bisect(true, |p| 1.0 - at_most(failures - 1, n, p) < alpha)
}

/// Where `is_below` ends to hold; 1 if there is nothing to tell it by.
fn bisect(is_told: bool, is_below: impl Fn(f64) -> bool) -> f64 {
    if !is_told {
        return 1.0;
    }
    let (mut lo, mut hi) = (0.0, 1.0);
    // As many halvings as a double has bits.
    for _ in 0..60 {
        let middle = 0.5 * (lo + hi);
        if is_below(middle) { lo = middle } else { hi = middle }
    }
    hi
}

/// The probability of at most `k` failures in `n` trials that fail with probability `p`, between 0 and 1. Terms are summed from
/// their logarithms, so that large numbers of trials don't underflow.
fn at_most(k: u64, n: u64, p: f64) -> f64 {
    let (ln_p, ln_q) = (fun::ln(p), fun::log1p(-p));
    let mut ln_choose = 0.0;
    let mut sum = 0.0;
    for i in 0..=k.min(n) {
        if i > 0 {
            ln_choose += fun::ln((n - i + 1) as f64) - fun::ln(i as f64);
        }
        sum += fun::exp(ln_choose + i as f64 * ln_p + (n - i) as f64 * ln_q);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_those_of_the_tables() {
        // 1 - 0.05^(1/n): nothing failed.
        for n in [3, 29, 2995] {
            let expected = 1.0 - fun::exp(fun::ln(0.05) / n as f64);
            assert!((upper_limit(0, n, 0.05) - expected).abs() < 1e-12);
        }
        // Two-sided 95 % limits of 5 in 10: 0.1871 and 0.8129.
        assert!((upper_limit(5, 10, 0.025) - 0.8129).abs() < 5e-5);
        assert!((lower_limit(5, 10, 0.025) - 0.1871).abs() < 5e-5);
        assert_eq!((upper_limit(0, 0, 0.05), upper_limit(4, 4, 0.05), lower_limit(0, 9, 0.05)), (1.0, 1.0, 0.0));
        assert!((at_most(3, 1_000_000, 1e-6) - 0.98101).abs() < 1e-5);
    }
}
