//! Certificates: bounds of the light in regions of the picture that hold for every point of them.
//!
//! A pixel's true value is the mean of the light over its square. Rays sample it; a certificate bounds it: the same formulas are
//! evaluated for all rays of a region at once, as [`Form`](crate::math::Form)s, and the region is cut where a test is undecided. What no cut
//! can tell apart is charged. See [`Certifier::region`].

mod asked;
mod bent;
mod blend;
mod bound;
mod budget;
mod bundle;
mod certifier;
mod coat;
mod estimate;
mod leaves;
mod lit;
mod looks;
mod memo;
mod met;
mod noise;
mod picture;
mod pixel;
mod polygon;
mod sampler;
mod sheet;
mod spot;
mod study;
mod summary;
mod target;
#[cfg(test)]
pub(super) mod tests;
mod texels;
mod undecided;
mod visible;
mod waves;
mod window;

pub use asked::Certificate;
pub(super) use asked::render;
pub use bound::Bound;
pub use certifier::Certifier;
pub use picture::{Control, Refined, certify, refine};
pub use sampler::{LaneSampler, Sampler};
pub use summary::{Summary, Worst};
pub use target::{Pixel, Status, Target, code};
