//! The program: one file a command, and what several of them need. Only this floor prints, reads arguments and knows exit
//! codes.

pub mod accuracy;
pub mod args;
mod argument;
pub mod check;
pub mod completions;
pub mod explain;
pub mod gallery;
pub mod help;
pub mod later;
pub mod load;
mod make;
mod map;
pub mod params;
pub mod picture;
pub mod preview;
pub mod progress;
pub mod render;
pub mod sight;
pub mod stats;
pub mod stop;
pub mod trade;
pub mod verify;
pub mod view;
pub mod watch;
pub mod words;

pub use stop::{Exit, Stop};

use args::{Cli, Command};
use clap::Parser;
use std::ffi::OsString;
use std::process::ExitCode;

/// Does what the arguments ask for, the program's name first among them; prints results to standard output, messages to
/// standard error.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let cli = match Cli::try_parse_from(args::with_optional_values(arguments)) {
        Ok(cli) => cli,
        Err(e) => {
            // Also how `--help` and `--version` arrive. If even the message can't be printed, the code is all there is.
            let _ = e.print();
            return ExitCode::from(e.exit_code() as u8);
        }
    };
    let result = match &cli.command {
        Command::Render(a) => render::run(&a.0),
        Command::Watch(a) => watch::run(a),
        Command::Gallery(a) => gallery::run(&a.0),
        Command::Check(a) => check::run(&a.0),
        Command::Explain(a) => explain::run(&a.0),
        Command::Verify(a) => verify::run(&a.0),
        Command::Trade(a) => trade::run(&a.0),
        Command::Params(a) => params::run(&a.0),
        Command::Help(a) => help::run(&a.0),
        Command::Completions(a) => completions::run(&a.0),
    };
    let exit = result.unwrap_or_else(|stop| {
        stop.print();
        stop.exit
    });
    ExitCode::from(exit as u8)
}
