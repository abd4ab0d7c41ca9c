//! A pattern as the tracer knows it: what it does, and which patterns it is made of.

use super::pattern_point::Rows;
use crate::scene::{Filter, Mapping};

/// A pattern of the world. `a` and `b` are as in [`PatternKind`](crate::scene::PatternKind).
#[derive(Clone, Debug)]
pub enum PatternNode {
    /// The same everywhere.
    Constant([f64; 3]),
    /// Solid checker.
    Checker(u32, u32, f64),
    /// Stripes across an axis.
    Stripes(u32, u32, u8, f64),
    /// Shells around an axis.
    Rings(u32, u32, u8, f64),
    /// From `a` to `b` along an axis.
    Gradient(u32, u32, u8, f64),
    /// Noise: octaves and seed.
    Noise(u32, u32, u32, u64),
    /// Cells: seed.
    Cells(u32, u32, u64),
    /// Mortar, brick, size, gap.
    Brick(u32, u32, [f64; 2], f64),
    /// A picture.
    Image {
        /// By number in [`PatternTable::textures`](super::pattern::PatternTable::textures).
        texture: u32,
        /// How it is laid on.
        mapping: Mapping,
        /// How it is read.
        filter: Filter,
        /// Linear part of the map from the space in which the shape is made to the pattern's.
        turn: [[f64; 3]; 3],
        /// The same for normals.
        turn_normal: [[f64; 3]; 3],
    },
    /// a, b, share of b.
    Mix(u32, u32, u32),
    /// Stops and position.
    Blend(Vec<u32>, u32),
    /// A pattern in a space of [`PatternTable::spaces`](super::pattern::PatternTable::spaces).
    InSpace(u32, u32),
    /// A pattern in a space given from the one around it.
    Mapped(u32, Box<Rows>),
    /// Child, amount, octaves, seed.
    Turbulence(u32, f64, u32, u64),
    /// Sum.
    Add(u32, u32),
    /// Product.
    Multiply(u32, u32),
    /// A pattern, cut off below and above.
    Within(u32, f64, f64),
}

impl PatternNode {
    /// Calls `visit` with every pattern that this one is made of.
    pub fn for_each_child(&self, mut visit: impl FnMut(u32)) {
        use PatternNode::*;
        match self {
            Constant(_) | Image { .. } => {}
            Checker(a, b, _) | Noise(a, b, _, _) | Cells(a, b, _) | Brick(a, b, _, _) | Add(a, b) | Multiply(a, b) => {
                visit(*a);
                visit(*b);
            }
            Stripes(a, b, ..) | Rings(a, b, ..) | Gradient(a, b, ..) => {
                visit(*a);
                visit(*b);
            }
            Mix(a, b, by) => {
                visit(*a);
                visit(*b);
                visit(*by);
            }
            Blend(stops, by) => {
                stops.iter().for_each(|s| visit(*s));
                visit(*by);
            }
            InSpace(child, _) | Mapped(child, _) | Turbulence(child, ..) | Within(child, ..) => visit(*child),
        }
    }
}
