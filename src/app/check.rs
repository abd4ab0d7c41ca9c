//! `rtdsl check`: the mistakes of several scenes, without a picture.

use super::args::CheckArgs;
use super::load::{request, shown_name};
use super::stop::print_diagnostics;
use super::{Exit, Stop};
use crate::diag::{Diagnostic, Report, Sources};
use crate::lang;
use serde::Serialize;
use std::io::{self, Write};

/// What was found in one file.
#[derive(Serialize)]
struct Checked {
    /// As it was named on the command line.
    file: String,
    /// Whether a picture can be made of it.
    ok: bool,
    /// Errors and warnings.
    diagnostics: Vec<Report>,
}

/// Runs the command; the exit code is that of the worst file.
///
/// # Errors
/// Standard input or output fails.
pub fn run(args: &CheckArgs) -> Result<Exit, Stop> {
    let mut worst = Exit::Done;
    let mut all = Vec::new();
    for file in &args.files {
        let name = shown_name(file);
        match lang::evaluate(&request(file, &args.set, &args.allow_read)?) {
            Ok(e) => {
                let warnings = if e.is_library { &[] } else { &e.warnings[..] };
                all.push(report(args, name, Exit::Done, warnings, &e.sources)?);
            }
            Err(f) => {
                let exit = if f.main_unreadable { Exit::System } else { Exit::Scene };
                worst = worst.max(exit);
                all.push(report(args, name, exit, &f.diagnostics, &f.sources)?);
            }
        }
    }
    if args.json {
        let text = serde_json::to_string_pretty(&all).map_err(io::Error::from)?;
        writeln!(io::stdout(), "{text}")?;
    }
    Ok(worst)
}

/// Says what was found in one file, at once where the form is text.
fn report(
    args: &CheckArgs,
    file: String,
    exit: Exit,
    diagnostics: &[Diagnostic],
    sources: &Sources,
) -> Result<Checked, Stop> {
    let ok = exit == Exit::Done;
    if !args.json {
        print_diagnostics(diagnostics, sources);
        if ok {
            writeln!(io::stdout(), "{file}: ok")?;
        }
    }
    let diagnostics = diagnostics.iter().map(|d| Report::new(d, sources)).collect();
    Ok(Checked { file, ok, diagnostics })
}
