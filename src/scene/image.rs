//! A decoded picture file, used as a pattern.

use std::path::PathBuf;
use std::sync::Arc;

/// Names an image of a [`Scene`](super::Scene).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ImageId(pub u32);

/// Texels, sRGB-encoded as in the file; row 0 is the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// The file.
    pub path: PathBuf,
    /// BLAKE3 of the file's bytes: equal digests mean equal texels.
    pub digest: [u8; 32],
    /// Texels across; at least 1.
    pub width: u32,
    /// Texels down; at least 1.
    pub height: u32,
    /// `width × height` texels, row by row; shared by all scenes that show the file.
    pub texels: Arc<Vec<[u8; 3]>>,
}
