//! rtdsl reads a scene written as text and ray-traces its picture.

pub mod app;
pub mod diag;
pub mod film;
pub mod lang;
pub mod math;
pub mod render;
pub mod scene;
