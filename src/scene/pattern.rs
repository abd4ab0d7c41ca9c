//! Patterns: colours (or numbers, as equal channels) that vary over a surface. A pattern is a node of an acyclic graph
//! whose children are patterns; shared ones are stored once.
//!
//! Solid patterns are functions of the point in the space in which the shape is made. Every feature has size 1 in the
//! pattern's own space; [`PatternKind::Transformed`] moves, turns and scales that space.

use super::{Color, ImageId};
use crate::diag::Span;
use crate::math::Affine;

/// Names a pattern of a [`Scene`](super::Scene). Children have smaller ids than their parents.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PatternId(pub u32);

/// One pattern and the text that made it.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    /// What it is.
    pub kind: PatternKind,
    /// The text; `None` for built-in defaults.
    pub span: Option<Span>,
}

/// The kinds of pattern. `a` is the value at even parity or position 0, `b` at odd parity or position 1.
#[derive(Clone, Debug, PartialEq)]
pub enum PatternKind {
    /// The same everywhere.
    Constant(Color),
    /// Cubes of side `size`: parity of ⌊x/size⌋ + ⌊y/size⌋ + ⌊z/size⌋.
    Checker {
        /// At even parity.
        a: PatternId,
        /// At odd parity.
        b: PatternId,
        /// Side of a cube.
        size: f64,
    },
    /// Slabs of thickness `size` across an axis: parity of ⌊x/size⌋.
    Stripes {
        /// At even parity.
        a: PatternId,
        /// At odd parity.
        b: PatternId,
        /// 0, 1, 2 for x, y, z.
        axis: u8,
        /// Thickness of a stripe.
        size: f64,
    },
    /// Concentric shells around an axis, each `size` thick: parity of ⌊distance from the axis / size⌋.
    Rings {
        /// At even parity: the innermost.
        a: PatternId,
        /// At odd parity.
        b: PatternId,
        /// 0, 1, 2 for x, y, z.
        axis: u8,
        /// Thickness of a ring.
        size: f64,
    },
    /// From `a` at coordinate 0 to `b` at coordinate `size`, along an axis; clamped beyond.
    Gradient {
        /// At 0 and below.
        a: PatternId,
        /// At `size` and above.
        b: PatternId,
        /// 0, 1, 2 for x, y, z.
        axis: u8,
        /// Length over which it changes.
        size: f64,
    },
    /// Smooth noise, between `a` and `b`: gradient noise summed over octaves, each of half the size and half the strength.
    Noise {
        /// Where the noise is 0.
        a: PatternId,
        /// Where the noise is 1.
        b: PatternId,
        /// 1 to 16.
        octaves: u32,
        /// Another arrangement.
        seed: u64,
    },
    /// Cells around scattered points (Worley, SIGGRAPH 1996): from `a` at a cell's point to `b` at distance 1.
    Cells {
        /// At the points.
        a: PatternId,
        /// Far from the points.
        b: PatternId,
        /// Another arrangement.
        seed: u64,
    },
    /// A brick wall in x and y, bricks running along x, every other course shifted by half a brick; the same at every z.
    Brick {
        /// Between the bricks.
        mortar: PatternId,
        /// The bricks.
        brick: PatternId,
        /// Width and height of a brick with its mortar.
        size: [f64; 2],
        /// Thickness of the mortar.
        gap: f64,
    },
    /// A picture.
    Image {
        /// The picture.
        image: ImageId,
        /// How it is laid on.
        mapping: Mapping,
        /// How it is read between texels.
        filter: Filter,
    },
    /// (1 − p)·a + p·b; p is taken channel by channel and isn't clamped.
    Mix {
        /// Where `by` is 0.
        a: PatternId,
        /// Where `by` is 1.
        b: PatternId,
        /// The share of `b`.
        by: PatternId,
    },
    /// Several patterns evenly spaced over 0..=1 of `by`'s red channel, joined by straight lines; clamped beyond.
    Blend {
        /// At least two.
        stops: Vec<PatternId>,
        /// The position.
        by: PatternId,
    },
    /// Another pattern in a moved, turned or scaled space.
    Transformed {
        /// The pattern.
        child: PatternId,
        /// From the child's space to this one's.
        parent_from_child: Affine,
    },
    /// Another pattern at a point displaced by noise.
    Turbulence {
        /// The pattern.
        child: PatternId,
        /// Largest displacement, about.
        amount: f64,
        /// 1 to 16.
        octaves: u32,
        /// Another arrangement.
        seed: u64,
    },
    /// Channel-wise sum, for arithmetic on patterns.
    Add(PatternId, PatternId),
    /// Channel-wise product.
    Multiply(PatternId, PatternId),
}

/// How a picture is laid on a surface. (u, v) = (0, 0) is the picture's lower left corner, (1, 1) its upper right; outside, it repeats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mapping {
    /// Longitude and latitude of the direction from the shape's centre: u = ½ + atan2(x, z)/2π, v = ½ + asin(y)/π.
    Spherical,
    /// u = asin(n.x)/π + ½, v = asin(n.y)/π + ½ with the unit surface normal n: the student ray tracer's.
    Normal,
    /// u, v = the two coordinates across the axis, in pattern space: 0 (x): (−z, y); 1 (y): (x, −z); 2 (z): (x, y).
    Planar {
        /// The direction of projection.
        axis: u8,
    },
    /// Round the y axis through the shape's centre, u as in `Spherical`; v from the shape's lowest to its highest point.
    Cylindrical,
}

/// How a picture is read between texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// The texel under the point.
    Nearest,
    /// The four around it, weighted, in linear light.
    Bilinear,
}

impl Pattern {
    /// A pattern that is the same everywhere, without a place.
    pub fn constant(color: Color) -> Pattern {
        Pattern { kind: PatternKind::Constant(color), span: None }
    }
}

impl PatternKind {
    /// The patterns that this one is made of, each once for every use.
    pub fn children(&self) -> Vec<PatternId> {
        use PatternKind::*;
        match self {
            Constant(_) | Image { .. } => vec![],
            Checker { a, b, .. }
            | Stripes { a, b, .. }
            | Rings { a, b, .. }
            | Gradient { a, b, .. }
            | Noise { a, b, .. }
            | Cells { a, b, .. } => vec![*a, *b],
            Brick { mortar, brick, .. } => vec![*mortar, *brick],
            Mix { a, b, by } => vec![*a, *b, *by],
            Blend { stops, by } => stops.iter().copied().chain([*by]).collect(),
            Transformed { child, .. } | Turbulence { child, .. } => vec![*child],
            Add(a, b) | Multiply(a, b) => vec![*a, *b],
        }
    }

    /// The same, to be changed.
    pub fn children_mut(&mut self) -> Vec<&mut PatternId> {
        use PatternKind::*;
        match self {
            Constant(_) | Image { .. } => vec![],
            Checker { a, b, .. }
            | Stripes { a, b, .. }
            | Rings { a, b, .. }
            | Gradient { a, b, .. }
            | Noise { a, b, .. }
            | Cells { a, b, .. } => vec![a, b],
            Brick { mortar, brick, .. } => vec![mortar, brick],
            Mix { a, b, by } => vec![a, b, by],
            Blend { stops, by } => stops.iter_mut().chain([by]).collect(),
            Transformed { child, .. } | Turbulence { child, .. } => vec![child],
            Add(a, b) | Multiply(a, b) => vec![a, b],
        }
    }
}
