//! Cameras.

use crate::diag::Place;
use glam::DVec3;

/// Where the picture is taken from.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// The name that `--camera` picks it by; `None` for the default one.
    pub name: Option<String>,
    /// Eye point.
    pub from: DVec3,
    /// The point in the middle of the picture; differs from `from`.
    pub at: DVec3,
    /// A direction that points up in the picture; not along the view.
    pub up: DVec3,
    /// How space is laid on the picture.
    pub projection: Projection,
    /// The text that made it; `None` for the built-in default.
    pub place: Option<Place>,
}

/// Perspective or parallel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// All rays start at the eye.
    Perspective {
        /// Vertical angle of view in degrees, above 0 and below 180.
        fov: f64,
    },
    /// All rays are parallel.
    Orthographic {
        /// Height of the visible part of space, in scene units.
        height: f64,
    },
}

impl Default for Camera {
    /// Eight units back and a little up, looking at the origin.
    fn default() -> Self {
        Camera {
            name: None,
            from: DVec3::new(0.0, 2.0, 8.0),
            at: DVec3::ZERO,
            up: DVec3::Y,
            projection: Projection::Perspective { fov: 40.0 },
            place: None,
        }
    }
}
