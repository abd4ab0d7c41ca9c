//! Work written over lanes, done in the widest that the machine has: for measuring what a picture's tracer does without one.

use super::Lane;
#[cfg(target_arch = "x86_64")]
use super::lane;

/// Work on `f64`, written over lanes.
pub trait InLanes {
    /// What comes of it.
    type Out;
    /// Does it; to be inlined always, or every operation on lanes is a call.
    fn run<L: Lane>(self) -> Self::Out;
}

/// Does the work in the widest lanes of the machine.
pub fn in_widest_lanes<W: InLanes>(work: W) -> W::Out {
    #[cfg(target_arch = "x86_64")]
    if lane::avx512_is_there() {
        return in_lanes::<lane::F64x8, W>(work);
    } else if lane::avx2_is_there() {
        return in_lanes::<lane::F64x4, W>(work);
    }
    in_lanes::<f64, W>(work)
}

fn in_lanes<L: Lane, W: InLanes>(work: W) -> W::Out {
    L::vectorize(
        #[inline(always)]
        || work.run::<L>(),
    )
}
