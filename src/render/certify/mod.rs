//! Certificates: bounds of the light in regions of the picture that hold for every point of them.
//!
//! A pixel's true value is the mean of the light over its square. Rays sample it; a certificate bounds it: the same formulas are
//! evaluated for all rays of a region at once, as [`Form`](crate::math::Form)s, and the region is cut where a test is undecided. What no cut
//! can tell apart is charged. See [`Certifier::region`].

mod bound;
mod bundle;
mod certifier;
mod coat;
mod lit;
mod met;
mod polygon;
mod sampler;
mod sheet;
mod study;
#[cfg(test)]
mod tests;
mod visible;

pub use bound::Bound;
pub use certifier::Certifier;
pub use sampler::Sampler;
