//! Lights.

use super::Color;
use glam::DVec3;

/// A point that shines equally in all directions, without fall-off: `color × power` reaches every distance, as in the
/// classic Phong model.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Position.
    pub at: DVec3,
    /// Colour.
    pub color: Color,
    /// Factor on the colour; not negative.
    pub power: f64,
}
