//! Work written over lanes, done in the widest that the machine has: for measuring what a picture's tracer does without one.

use super::Lane;
#[cfg(target_arch = "x86_64")]
use super::lane;

/// Work written over lanes.
pub trait InLanes {
    /// What comes of it.
    type Out;
    /// Does it; to be inlined always, or every operation on lanes is a call.
    fn run<L: Lane>(self) -> Self::Out;
}

/// Does the work in the widest lanes of `f64` that the machine has.
pub fn in_widest_lanes<W: InLanes>(work: W) -> W::Out {
    #[cfg(target_arch = "x86_64")]
    if lane::avx512_is_there() {
        return in_lanes::<lane::F64x8, W>(work);
    } else if lane::avx2_is_there() {
        return in_lanes::<lane::F64x4, W>(work);
    }
    in_lanes::<f64, W>(work)
}

/// Does the work in the widest lanes of `f32` that the machine has.
pub fn in_widest_lanes_of_f32<W: InLanes>(work: W) -> W::Out {
    #[cfg(target_arch = "x86_64")]
    if lane::avx512_is_there() {
        return in_lanes::<lane::F32x16, W>(work);
    } else if lane::avx2_is_there() {
        return in_lanes::<lane::F32x8, W>(work);
    }
    in_lanes::<f32, W>(work)
}

fn in_lanes<L: Lane, W: InLanes>(work: W) -> W::Out {
    L::vectorize(
        #[inline(always)]
        || work.run::<L>(),
    )
}
