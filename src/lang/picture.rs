//! Decodes the picture files that a scene shows.

use super::limits::Limits;
use crate::film::{ReadError, read};
use crate::scene::{Image, range};
use std::path::Path;

/// Largest picture file: more than an uncompressed one of the most texels.
pub const FILE_BYTES: usize = 1 << 30;

/// The picture that `bytes` are, read at `path`; why they are none, in words, otherwise.
pub fn decode(path: &Path, bytes: Vec<u8>, digest: [u8; 32], limits: &Limits) -> Result<Image, String> {
    let may_be = |width: u32, height: u32| {
        width.max(height) <= range::LARGEST_SIDE && u64::from(width) * u64::from(height) <= limits.image_texels
    };
    let picture = read(bytes, may_be).map_err(|e| match e {
        ReadError::Unknown => "it is no PNG, JPEG, PPM or PGM file".into(),
        ReadError::Damaged(kind) => format!("it is damaged: not a complete {kind} file"),
        ReadError::TooLarge(width, height) => format!("it is too large: {width} × {height}"),
    })?;
    let (width, height) = (picture.width, picture.height);
    Ok(Image { path: path.to_owned(), digest, width, height, texels: picture.texels.into() })
}
