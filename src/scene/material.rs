//! Materials: Phong's model, every slot a pattern.

use super::{Color, Pattern, PatternId};
use crate::diag::Place;

/// Names a material of a [`Scene`](super::Scene).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MaterialId(pub u32);

/// How a surface looks. With n the normal, l the direction to a light, r its mirror image and v the direction to the eye:
///
/// seen = color × (ambient × scene ambient + diffuse × Σ light × max(0, n·l)) + specular × Σ light × max(0, r·v)^shininess
///   + reflect × mirrored + transmit × behind
///
/// (Phong, CACM 18(6), 1975; Whitted, CACM 23(6), 1980.)
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Base colour.
    pub color: PatternId,
    /// Share of the scene's ambient light that is given back.
    pub ambient: PatternId,
    /// Share of direct light that is scattered.
    pub diffuse: PatternId,
    /// Strength of the highlight.
    pub specular: PatternId,
    /// Exponent of the highlight, at least 0; red channel.
    pub shininess: PatternId,
    /// Weight of the mirror image.
    pub reflect: PatternId,
    /// Weight of what lies behind, and of light passing through to what it shadows.
    pub transmit: PatternId,
    /// Refractive index of the inside, 1 to 10; `None` goes straight on. With it, Fresnel's formula divides `transmit`
    /// between what is seen through the surface and what is mirrored by it.
    pub ior: Option<f64>,
    /// Height field that tilts the shading normal, in units of the space in which the shape is made; red channel.
    pub bump: Option<PatternId>,
    /// The text that made it; `None` for the default grey.
    pub place: Option<Place>,
}

/// The default of each slot, where the text gives none.
#[derive(Clone, Copy, Debug)]
pub struct MaterialDefaults;

impl MaterialDefaults {
    /// `gray(0.8)`.
    pub fn color() -> Color {
        Color::from_srgb([0.8; 3])
    }
    /// All of the scene's ambient light.
    pub const AMBIENT: f64 = 1.0;
    /// Four fifths of direct light.
    pub const DIFFUSE: f64 = 0.8;
    /// No highlight.
    pub const SPECULAR: f64 = 0.0;
    /// Exponent of a highlight.
    pub const SHININESS: f64 = 40.0;
    /// No mirror image.
    pub const REFLECT: f64 = 0.0;
    /// Opaque.
    pub const TRANSMIT: f64 = 0.0;
}

impl Material {
    /// The default grey; `add` stores a pattern and gives its id.
    pub fn plain(mut add: impl FnMut(Pattern) -> PatternId) -> Material {
        let mut number = |v: f64| add(Pattern::constant(Color::linear_gray(v)));
        let [ambient, diffuse, specular, shininess, reflect, transmit] = [
            MaterialDefaults::AMBIENT,
            MaterialDefaults::DIFFUSE,
            MaterialDefaults::SPECULAR,
            MaterialDefaults::SHININESS,
            MaterialDefaults::REFLECT,
            MaterialDefaults::TRANSMIT,
        ]
        .map(&mut number);
        let color = add(Pattern::constant(MaterialDefaults::color()));
        Material { color, ambient, diffuse, specular, shininess, reflect, transmit, ior: None, bump: None, place: None }
    }
}
