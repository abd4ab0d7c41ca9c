//! `rtdsl gallery`: pictures and text together.

use super::args::GalleryArgs;
use super::{Exit, Stop};

/// Runs the command.
///
/// # Errors
/// A file can't be read or written.
pub fn run(_args: &GalleryArgs) -> Result<Exit, Stop> {
    Ok(Exit::Done)
}
