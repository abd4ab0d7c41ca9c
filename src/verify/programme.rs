//! The list of all checks.

use super::picture_check::{self, PictureCheck};
use super::{Check, contact, coverage, enclosure, energy, quadric, respawn, tangent, torus, tree, watertight};

/// The checks of kernels and formulas, which need no scene.
pub fn programme() -> Vec<Check> {
    vec![
        quadric::CHECK,
        tangent::CHECK,
        torus::CHECK,
        watertight::CHECK,
        respawn::CHECK,
        contact::CHECK,
        tree::CHECK,
        enclosure::CHECK,
        energy::CHECK,
        coverage::CHECK,
        coverage::FILTERED,
    ]
}

/// The checks of whole pictures.
pub fn pictures() -> Vec<PictureCheck> {
    picture_check::ALL.into_iter().chain([coverage::PICTURES]).collect()
}
