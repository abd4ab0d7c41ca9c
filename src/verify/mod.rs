//! What rtdsl promises about its numbers, checked on the user's own machine.
//!
//! [`picture`] holds the laws of whole pictures: what must not change a bit of them.

pub mod picture;
