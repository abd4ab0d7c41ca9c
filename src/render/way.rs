//! How rays go through the tree: those of a register together, or one after another.
//!
//! Together, a box is looked at once for all of them; but where they run apart, or what they meet is smaller than they are apart, each
//! looks at what the others alone could meet. Which is quicker depends on the scene and on the kind of rays, so now and then both are
//! tried, and what they looked at is counted. (Not timed: where a thread has to wait for another program, a clock says nothing of
//! the rays.) No bit of a picture depends on it: what a ray meets is the same either way.

use crate::math::Lane;

/// The quicker way, as lately tried.
#[derive(Clone, Copy, Debug, Default)]
pub struct Way {
    /// What late trials cost: together, and alone.
    together: f64,
    alone: f64,
    /// Registers of rays until both are tried again.
    left: u32,
    /// Trials so far.
    trials: u32,
}

/// Registers of rays between two trials: a trial costs a few per cent of what it decides on.
const PERIOD: u32 = 40;
/// The same where one way costs less than half of the other.
const LONG_PERIOD: u32 = 4 * PERIOD;
/// Trials in a row at first.
const AT_FIRST: u32 = 4;
/// What counts of a trial after the next. Sums and not votes: a few registers of rays that run apart may take as long together as
/// hundreds of others.
const FADING: f64 = 7.0 / 8.0;
/// A trial of rays together is given up where it costs this many times as much as they do alone.
const HOPELESS: u32 = 8;

impl Way {
    /// Has `go` send a register of rays on its way: it is told whether together, and what that may cost at most, and gives what it did
    /// cost. Where both ways are tried it is called twice, and has to begin anew; where the second costs more than it may, what
    /// the first found counts.
    ///
    /// `go` is called from one place of the code only, so that the tree's walk is compiled once, and inside the caller, which is where
    /// the registers' instructions may be used.
    #[inline(always)]
    pub fn take<L: Lane>(&mut self, mut go: impl FnMut(bool, u32) -> u32) {
        if L::WIDTH == 1 {
            go(false, u32::MAX); // there is no choice
            return;
        }
        let tries = self.is_due();
        let (mut together, mut most) = (!tries && self.together < self.alone, u32::MAX);
        loop {
            let cost = go(together, most);
            if !tries {
                return;
            }
            let sum = if together { &mut self.together } else { &mut self.alone };
            *sum = FADING * *sum + cost as f64;
            if together {
                return;
            }
            (together, most) = (true, cost.saturating_mul(HOPELESS));
        }
    }

    /// Whether both shall be tried with these rays; often at first.
    #[inline(always)]
    fn is_due(&mut self) -> bool {
        let due = self.left == 0;
        self.trials += due as u32;
        let is_clear = 2.0 * self.together < self.alone || 2.0 * self.alone < self.together;
        self.left = match due {
            true if self.trials <= AT_FIRST => 1,
            true if is_clear => LONG_PERIOD,
            true => PERIOD,
            false => self.left - 1,
        };
        due
    }
}
