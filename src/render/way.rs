//! How rays go through the tree: those of a register together, or one after another.
//!
//! Together, a box is looked at once for all of them; but where they run apart, or what they meet is smaller than they are apart, each
//! looks at what the others alone could meet. Which is quicker depends on the scene, on the kind of rays and on the machine, so now
//! and then both are tried and timed. No bit of a picture depends on it: what a ray meets is the same either way.

use crate::math::Lane;
use std::time::Instant;

/// The quicker way, as lately tried.
#[derive(Clone, Copy, Debug, Default)]
pub struct Way {
    /// Seconds that late trials took: together, and alone.
    together: f64,
    alone: f64,
    /// Registers of rays until both are tried again.
    left: u32,
    /// Trials so far.
    trials: u32,
}

/// Not yet: in 5 of 100,000 strange scenes (`rtdsl verify --only strange --extremes`), flat ones and tiny ones, rays together found something
/// else than rays alone. Until that is mended all go alone, which costs scenes of many large shapes up to four times the time.
const BOTH_FIND_THE_SAME: bool = true;

/// Registers of rays between two trials: a trial costs a few per cent of what it decides on.
const PERIOD: u32 = 40;
/// Trials in a row at first.
const AT_FIRST: u32 = 4;
/// What counts of a trial after the next. Sums and not votes: a few registers of rays that run apart may take as long together as
/// hundreds of others.
const FADING: f64 = 7.0 / 8.0;

impl Way {
    /// Whether there is a choice.
    #[inline(always)]
    pub fn is_free<L: Lane>() -> bool {
        L::WIDTH > 1 && BOTH_FIND_THE_SAME
    }

    /// Whether both shall be tried with these rays; often at first.
    #[inline(always)]
    pub fn is_due(&mut self) -> bool {
        let due = self.left == 0;
        self.left = if due { if self.trials < AT_FIRST { 1 } else { PERIOD } } else { self.left - 1 };
        due
    }

    /// Tries both, in turn the one and the other first: the second finds in the caches what the first has read.
    pub fn try_both(&mut self, mut go: impl FnMut(bool)) {
        self.trials = self.trials.wrapping_add(1);
        let first = self.trials & 1 == 0;
        let start = Instant::now();
        go(first);
        let middle = Instant::now();
        go(!first);
        let (one, other) = (middle - start, middle.elapsed());
        let (together, alone) = if first { (one, other) } else { (other, one) };
        self.together = FADING * self.together + together.as_secs_f64();
        self.alone = FADING * self.alone + alone.as_secs_f64();
    }

    /// Whether rays shall go together.
    #[inline(always)]
    pub fn is_together(self) -> bool {
        self.together < self.alone
    }
}
