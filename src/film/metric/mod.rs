//! How far a written picture is from the true one: pixels in, numbers out.
//!
//! [`Truth`] is what is known of the true picture, with its own uncertainty; [`Errors`] are the metrics of a picture beside it.
//! [`Flip`] is the one that asks what people see.

mod blur;
mod errors;
mod flip;
mod opponent;
mod truth;

pub use errors::{Errors, Range, change};
pub use flip::{Flip, PIXELS_PER_DEGREE};
pub use truth::{Truth, written};
