//! The programme of proofs: what rtdsl says of its own accuracy at the extremes, tried out on this machine.
//!
//! Every check draws its cases from a keyed hash, so it is the same on every machine, and gives an [`Outcome`]: figures,
//! each beside the bound that it must keep. `cargo test` runs all of them in [`Size::Quick`], `rtdsl verify --extremes` in
//! [`Size::Long`].

mod contact;
mod coverage;
mod draw;
mod enclosure;
mod energy;
mod histogram;
mod outcome;
pub mod picture;
mod picture_check;
mod programme;
pub mod quadric;
mod reach;
mod respawn;
pub mod specimen;
mod stage;
mod tally;
pub mod tangent;
pub mod torus;
mod tree;
mod watertight;

pub use coverage::lower_limit;
pub use histogram::Histogram;
pub use outcome::{Bound, Figure, Outcome};
pub use picture_check::{PictureCheck, Subject, hashed};
pub use programme::{pictures, programme};

/// How many cases are tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// Seconds for all checks together.
    Quick,
    /// Minutes: as many cases as the stated bounds speak of.
    Long,
}

impl Size {
    /// One of two numbers of cases.
    pub fn pick(self, quick: u64, long: u64) -> u64 {
        match self {
            Size::Quick => quick,
            Size::Long => long,
        }
    }
}

/// One check of the programme.
#[derive(Clone, Copy, Debug)]
pub struct Check {
    /// A short word for it, for the command line and for tests.
    pub name: &'static str,
    /// What it shows, in one line.
    pub what: &'static str,
    /// Tries it out; threads of the current pool share the work.
    pub run: fn(Size) -> Outcome,
}
