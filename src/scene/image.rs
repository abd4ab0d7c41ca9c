//! A decoded picture file, used as a pattern.

use std::path::PathBuf;
use std::sync::Arc;

/// Names an image of a [`Scene`](super::Scene).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ImageId(pub u32);

/// A picture as a file holds it.
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
    /// `width × height` texels, row by row, row 0 at the top; shared by all scenes that show the file.
    pub texels: Arc<Texels>,
}

/// Colours of 8 bits a channel, sRGB-encoded as in the file.
#[derive(Clone, Debug)]
pub enum Texels {
    /// Red, green and blue of each.
    Colors(Vec<u8>),
    /// The number of each one's colour: a third of the memory. So are files of gray, and those that number their colours.
    Numbers {
        /// One a texel.
        numbers: Vec<u8>,
        /// What they stand for.
        colors: Box<[[u8; 3]; 256]>,
    },
}

impl Texels {
    /// Grays, by their value.
    pub fn gray(values: Vec<u8>) -> Texels {
        Texels::Numbers { numbers: values, colors: Box::new(std::array::from_fn(|i| [i as u8; 3])) }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        match self {
            Texels::Colors(bytes) => bytes.len() / 3,
            Texels::Numbers { numbers, .. } => numbers.len(),
        }
    }

    /// Bytes that they occupy.
    pub fn memory_bytes(&self) -> usize {
        match self {
            Texels::Colors(bytes) => bytes.len(),
            Texels::Numbers { numbers, colors } => numbers.len() + size_of_val(&**colors),
        }
    }

    /// All of them, a colour each.
    pub fn into_colors(self) -> Vec<[u8; 3]> {
        match self {
            Texels::Colors(bytes) => bytes.as_chunks().0.to_vec(),
            Texels::Numbers { numbers, colors } => numbers.iter().map(|n| colors[*n as usize]).collect(),
        }
    }
}

/// By their colours, however they are kept.
impl PartialEq for Texels {
    fn eq(&self, other: &Texels) -> bool {
        match (self, other) {
            (Texels::Colors(a), Texels::Colors(b)) => a == b,
            _ => self.clone().into_colors() == other.clone().into_colors(),
        }
    }
}
