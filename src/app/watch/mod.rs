//! `rtdsl watch`: makes the picture again whenever the text changes.

pub mod follower;

use super::args::WatchArgs;
use super::{Exit, Stop};

/// Runs the command until it is interrupted.
///
/// # Errors
/// The arguments don't fit together, or a file can't be written.
pub fn run(_args: &WatchArgs) -> Result<Exit, Stop> {
    Ok(Exit::Done)
}
