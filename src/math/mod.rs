//! Numbers: the scalar traits that let a formula be written once, double-double values, affine maps, pinned
//! elementary functions and the hash behind everything random. Knows nothing of scenes or pictures.

pub mod affine;
pub mod dd;
pub mod float;
pub mod fun;
pub mod hash;
pub mod noise;
pub mod real;

pub use affine::Affine;
pub use dd::Dd;
pub use real::{Elem, Lane, Mask, Real, Single};
