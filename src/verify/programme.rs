//! The list of all checks.

use super::picture_check::{self, PictureCheck};
use super::{Check, energy};

/// The checks of kernels and formulas, which need no scene.
pub fn programme() -> Vec<Check> {
    vec![energy::CHECK]
}

/// The checks of whole pictures.
pub fn pictures() -> Vec<PictureCheck> {
    picture_check::ALL.to_vec()
}
