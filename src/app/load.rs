//! From the command line to an evaluated scene.

use super::stop::{Stop, print_diagnostics};
use crate::diag::Diagnostic;
use crate::lang::{self, Evaluated, Input, Request};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// The scene of `request`; its warnings are printed unless `quiet`.
///
/// # Errors
/// The scene is wrong, or can't be read.
pub fn load(request: &Request, quiet: bool) -> Result<Evaluated, Stop> {
    let evaluated = lang::evaluate(request)?;
    if !quiet {
        print_diagnostics(&evaluated.warnings, &evaluated.sources);
    }
    Ok(evaluated)
}

/// What is asked of the language for `file`, where `-` is standard input.
///
/// # Errors
/// Standard input can't be read.
pub fn request(file: &Path, set: &[(String, String)], allow_read: &[PathBuf]) -> Result<Request, Stop> {
    Ok(Request { main: input(file)?, set: set.to_vec(), allow_read: allow_read.to_vec(), record_arguments: false })
}

/// Most bytes of a scene on standard input: far more than anyone writes, and an end to `/dev/zero`.
const MOST_INPUT: u64 = 1 << 28;

fn input(file: &Path) -> Result<Input, Stop> {
    if file != Path::new("-") {
        return Ok(Input::File(file.to_path_buf()));
    }
    let mut bytes = Vec::new();
    let fault = |e| Stop::system("standard input can't be read", e);
    io::stdin().lock().take(MOST_INPUT + 1).read_to_end(&mut bytes).map_err(fault)?;
    if bytes.len() as u64 > MOST_INPUT {
        let d = Diagnostic::error("the scene on standard input is too long");
        return Err(Stop::usage(d.note(format!("{} MB are the most", MOST_INPUT >> 20))));
    }
    let folder = std::env::current_dir().map_err(|e| Stop::system("the current folder can't be found", e))?;
    Ok(Input::Text { name: STDIN_NAME.into(), bytes, folder })
}

/// How messages name standard input.
const STDIN_NAME: &str = "<stdin>";

/// How results name `file`.
pub fn shown_name(file: &Path) -> String {
    if file == Path::new("-") { STDIN_NAME.into() } else { file.display().to_string() }
}
