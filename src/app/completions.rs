//! `rtdsl completions`: a script that teaches a shell this program's arguments.

use super::args::{Cli, CompletionsArgs};
use super::{Exit, Stop};
use clap::CommandFactory;
use std::io::{self, Write};

/// Runs the command.
///
/// # Errors
/// Standard output fails.
pub fn run(args: &CompletionsArgs) -> Result<Exit, Stop> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "rtdsl", &mut script);
    io::stdout().write_all(&script)?;
    Ok(Exit::Done)
}
