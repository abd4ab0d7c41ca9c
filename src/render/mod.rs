//! From scene to film: the world as the tracer sees it, and the tracer.

pub mod options;

pub use options::{Crop, Feature, Options, Probe, Progress, RayCounts, Rendered, Silent};

use crate::scene::{Camera, Scene};
use std::sync::atomic::AtomicBool;

/// The scene as the tracer sees it from one camera: only what this scene requires.
pub struct World;

impl World {
    /// Prepares `scene` as seen by `camera`.
    pub fn build(_scene: &Scene, _camera: &Camera, _options: &Options) -> World {
        World
    }
    /// What the renderer can do, and which of it this scene requires.
    pub fn features(&self) -> Vec<Feature> {
        Vec::new()
    }
    /// Bytes held for tracing.
    pub fn memory_bytes(&self) -> usize {
        0
    }
}

/// Traces the picture; `None` where `cancel` was set meanwhile.
pub fn render(_world: &World, _options: &Options, _progress: &dyn Progress, _cancel: &AtomicBool) -> Option<Rendered> {
    todo!("replaced by the tracer")
}

/// What the middle of pixel (x, y) sees; `None` for the background.
pub fn probe(_world: &World, _options: &Options, _x: u32, _y: u32) -> Option<Probe> {
    todo!("replaced by the tracer")
}
