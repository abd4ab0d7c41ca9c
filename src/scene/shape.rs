//! The shapes, in the space in which they are made. y is up, axes are right-handed, lengths are scene units.

use glam::DVec3;

/// A surface. Every size is positive and within [`range`](super::range); directions have any length but 0.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// All points at distance `r` from `at`.
    Sphere {
        /// Centre.
        at: DVec3,
        /// Radius.
        r: f64,
    },
    /// An unbounded plane.
    Plane {
        /// A point of it.
        through: DVec3,
        /// Its normal, of any length.
        normal: DVec3,
    },
    /// An axis-aligned box, closed.
    Box {
        /// Smallest corner.
        from: DVec3,
        /// Largest corner; greater than `from` in every coordinate.
        to: DVec3,
    },
    /// A flat ring, or a full disc when `hole` is 0.
    Disc {
        /// Centre.
        at: DVec3,
        /// Its normal, of any length.
        normal: DVec3,
        /// Outer radius.
        r: f64,
        /// Inner radius, 0 to below `r`.
        hole: f64,
    },
    /// A circular cylinder around the segment `from`–`to`.
    Cylinder {
        /// Centre of one end.
        from: DVec3,
        /// Centre of the other end.
        to: DVec3,
        /// Radius.
        r: f64,
        /// Whether the ends are closed.
        caps: bool,
    },
    /// A circular cone or frustum around the segment `from`–`to`.
    Cone {
        /// Centre of the base.
        from: DVec3,
        /// The apex, or the centre of the top.
        to: DVec3,
        /// Radius at `from`.
        r: f64,
        /// Radius at `to`; 0 makes a pointed cone. Differs from `r`.
        top: f64,
        /// Whether the ends are closed.
        caps: bool,
    },
    /// A ring: all points at distance `tube` from the circle of radius `r` around `at`.
    Torus {
        /// Centre.
        at: DVec3,
        /// Radius of the circle.
        r: f64,
        /// Radius of the tube; below `r`.
        tube: f64,
        /// The direction that the ring goes round, of any length.
        axis: DVec3,
    },
    /// A flat triangle; its corners aren't on one line.
    Triangle {
        /// Corners.
        points: Box<[DVec3; 3]>,
        /// Shading normals at the corners, for a smooth look.
        normals: Option<Box<[DVec3; 3]>>,
    },
    /// The four faces between four points that aren't in one plane.
    Tetrahedron {
        /// Corners.
        points: Box<[DVec3; 4]>,
    },
}

impl Shape {
    /// The word of the language that makes it.
    pub fn word(&self) -> &'static str {
        match self {
            Shape::Sphere { .. } => "sphere",
            Shape::Plane { .. } => "plane",
            Shape::Box { .. } => "box",
            Shape::Disc { .. } => "disc",
            Shape::Cylinder { .. } => "cylinder",
            Shape::Cone { .. } => "cone",
            Shape::Torus { .. } => "torus",
            Shape::Triangle { .. } => "triangle",
            Shape::Tetrahedron { .. } => "tetrahedron",
        }
    }
}
