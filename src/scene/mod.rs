//! What a picture is of: plain data, in `f64`, every part with the place in the text that made it. `lang` writes it,
//! `render` reads it, and neither knows the other. A [`Scene`] that exists is valid: every number is finite and within
//! range, every id points at something, every shape has a size.

pub mod camera;
pub mod color;
pub mod graph;
pub mod image;
pub mod light;
pub mod material;
pub mod mesh;
pub mod pattern;
mod prune;
pub mod range;
pub mod settings;
pub mod shape;

pub use camera::{Camera, Projection};
pub use color::Color;
pub use graph::{Instance, Node, NodeId, NodeKind, Scene};
pub use image::{Image, ImageId, Texels};
pub use light::Light;
pub use material::{Material, MaterialId};
pub use mesh::{Mesh, MeshData, MeshId};
pub use pattern::{Filter, Mapping, Pattern, PatternId, PatternKind};
pub use settings::{Accuracy, AntiAliasing, PixelFilter, Precision, Settings};
pub use shape::Shape;
