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
    /// How many these come to.
    weight: f64,
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
/// What counts of a trial after the next.
const FADING: f64 = 15.0 / 16.0;
/// Rays together are given up, and go alone, where they cost this many times as much as rays alone lately did: a few that run apart
/// may cost as much together as hundreds of others.
const HOPELESS: f64 = 4.0;

impl Way {
    /// Has `go` send a register of rays on its way: it is told whether together, and what that may cost at most, and gives what it did
    /// cost. It may be called twice, and has to begin anew; where it costs more than it may, what was found before counts.
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
        let mut together = !tries && self.together < self.alone;
        let mut tried_alone = 0;
        loop {
            let most = if together { (HOPELESS * self.alone / self.weight) as u32 } else { u32::MAX };
            let cost = go(together, most);
            let is_hopeless = cost > most;
            match (tries, together) {
                (true, false) => {
                    self.weight = FADING * self.weight + 1.0;
                    self.alone = FADING * self.alone + cost as f64;
                    (tried_alone, together) = (cost, true);
                }
                (true, true) => {
                    // What it takes to find out this way, the other included where need be.
                    let all = cost as f64 + if is_hopeless { tried_alone as f64 } else { 0.0 };
                    self.together = FADING * self.together + all;
                    return;
                }
                (false, true) if is_hopeless => together = false,
                (false, _) => return,
            }
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
