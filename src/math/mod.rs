//! Numbers: the scalar traits that let a formula be written once, double-double values, affine maps, pinned
//! elementary functions and the hash behind everything random. Knows nothing of scenes or pictures.

pub mod affine;
pub mod best;
pub mod dd;
pub mod float;
pub mod form;
pub mod fun;
pub mod hash;
pub mod interval;
pub(crate) mod lane;
pub mod noise;
pub mod real;
pub mod tri;

pub use affine::Affine;
pub use dd::Dd;
pub use form::Form;
pub use interval::Interval;
pub use real::{Elem, Lane, Mask, Real, Single};
