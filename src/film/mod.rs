//! From linear colours to picture files.

pub mod buffer;

pub use buffer::Film;
