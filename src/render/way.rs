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

/// Registers of rays between two trials: a trial costs a few per cent of what it decides on.
const PERIOD: u32 = 40;
/// Trials in a row at first.
const AT_FIRST: u32 = 4;
/// What counts of a trial after the next. Sums and not votes: a few registers of rays that run apart may take as long together as
/// hundreds of others.
const FADING: f64 = 7.0 / 8.0;

impl Way {
    /// Has `go` send a register of rays on its way: it is told whether together. Where both ways are tried it is called twice, and
    /// has to begin anew.
    ///
    /// `go` is called from one place of the code only, so that the tree's walk is compiled once, and inside the caller, which is where
    /// the registers' instructions may be used.
    #[inline(always)]
    pub fn take<L: Lane>(&mut self, mut go: impl FnMut(bool)) {
        if L::WIDTH == 1 {
            return go(false); // there is no choice
        }
        let tries = self.is_due();
        // In turn the one and the other first: the second finds in the caches what the first has read.
        let first = if tries { self.trials & 1 == 0 } else { self.together < self.alone };
        let mut together = first;
        loop {
            let start = tries.then(Instant::now);
            go(together);
            let Some(start) = start else { return };
            let spent = if together { &mut self.together } else { &mut self.alone };
            *spent = FADING * *spent + start.elapsed().as_secs_f64();
            together = !together;
            if together == first {
                return;
            }
        }
    }

    /// Whether both shall be tried with these rays; often at first.
    #[inline(always)]
    fn is_due(&mut self) -> bool {
        let due = self.left == 0;
        self.trials += due as u32;
        self.left = if due { if self.trials <= AT_FIRST { 1 } else { PERIOD } } else { self.left - 1 };
        due
    }
}
