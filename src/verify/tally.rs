//! Shares cases out among threads and adds up what they gave. Sums don't depend on who did which case, so every number of
//! threads gives the same outcome.

use super::{Bound, Figure, Histogram};
use rayon::prelude::*;
use std::ops::Range;

/// What cases gave, added up.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    /// Things that were tried and could go wrong: crossings, spawned rays.
    pub(super) tried: u64,
    /// How far off numbers were, in ulp.
    pub(super) errors: Histogram,
    /// Sum of those errors, for their mean.
    pub(super) sum: f64,
    /// What went wrong, by kind; each check names its own kinds.
    pub(super) wrong: [u64; 4],
    /// A value that only its largest matters of.
    pub(super) worst: f64,
    /// The first case that went wrong, in words.
    pub(super) first: Option<(u64, String)>,
}

/// Cases that one thread does in a row. Sums of rounded numbers are added in blocks of these, in order.
const BLOCK: u64 = 512;

impl Tally {
    /// Tries the cases 0..n.
    pub(super) fn of(n: u64, try_one: impl Fn(u64, &mut Tally) + Sync) -> Tally {
        let blocks: Vec<Tally> = (0..n.div_ceil(BLOCK))
            .into_par_iter()
            .map(|block| {
                let Range { start, end } = block * BLOCK..n.min((block + 1) * BLOCK);
                let mut tally = Tally::default();
                (start..end).for_each(|case| try_one(case, &mut tally));
                tally
            })
            .collect();
        blocks.into_iter().fold(Tally::default(), Tally::plus)
    }

    /// Counts an error in ulp.
    pub(super) fn off(&mut self, ulps: f64) {
        self.errors.add(ulps);
        self.sum += ulps.abs();
    }

    /// Counts something that went wrong.
    pub(super) fn fail(&mut self, kind: usize, case: u64, say: impl FnOnce() -> String) {
        self.wrong[kind] += 1;
        if self.first.is_none() {
            self.first = Some((case, say()));
        }
    }

    /// Both together; `self` holds the earlier cases.
    pub(super) fn plus(mut self, o: Tally) -> Tally {
        self.tried += o.tried;
        self.errors.merge(&o.errors);
        self.sum += o.sum;
        for (to, from) in self.wrong.iter_mut().zip(o.wrong) {
            *to += from;
        }
        self.worst = if self.worst < o.worst { o.worst } else { self.worst };
        self.first = self.first.or(o.first);
        self
    }

    /// The error that 99 of 100 don't exceed, with the histogram.
    pub(super) fn p99(&self, what: String, at_most: f64) -> Figure {
        let (value, bound) = (self.errors.quantile(0.99), Bound::AtMost(at_most));
        Figure { what, value, unit: "ulp", bound, histogram: Some(self.errors.clone()) }
    }

    /// Mean of the errors.
    pub(super) fn mean(&self, what: String, at_most: f64) -> Figure {
        let value = self.sum / self.errors.count() as f64;
        Figure { what, value, unit: "ulp", bound: Bound::AtMost(at_most), histogram: None }
    }

    /// How often something went wrong: never, is the bound.
    pub(super) fn never(&self, kind: usize, what: String) -> Figure {
        count(what, self.wrong[kind], Bound::AtMost(0.0))
    }

    /// That as many were tried as the check speaks of.
    pub(super) fn tried(&self, what: String, at_least: u64) -> Figure {
        count(what, self.tried, Bound::AtLeast(at_least as f64))
    }
}

/// A count as a figure.
pub(super) fn count(what: String, n: u64, bound: Bound) -> Figure {
    Figure { what, value: n as f64, unit: "", bound, histogram: None }
}

/// The distance from |x| to the next larger number: the unit in the last place. For 0 the smallest there is.
pub(super) fn ulp(x: f64) -> f64 {
    x.abs().next_up() - x.abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_do_not_depend_on_threads() {
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                Tally::of(5_000, |case, tally| {
                    tally.tried += 1;
                    tally.off(1.0 / (case + 1) as f64);
                    if case % 1_000 == 700 {
                        tally.fail(1, case, || format!("case {case}"));
                    }
                })
            })
        };
        let (one, three) = (run(1), run(3));
        assert_eq!((one.tried, one.wrong, one.sum.to_bits()), (three.tried, three.wrong, three.sum.to_bits()));
        assert_eq!(one.errors, three.errors);
        assert_eq!((one.first, one.wrong[1]), (Some((700, "case 700".into())), 5));
    }

    #[test]
    fn ulps_grow_with_powers_of_two() {
        assert_eq!((ulp(1.0), ulp(-1.99), ulp(2.0)), (f64::EPSILON, f64::EPSILON, 2.0 * f64::EPSILON));
    }
}
