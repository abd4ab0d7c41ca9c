//! How a command ends: its exit code, and the message when it couldn't do what it was asked.

use crate::diag::{self, Diagnostic, Diagnostics, Look, Report, Sources};
use crate::lang::Failure;
use std::io::{self, Write};

/// The program's exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Exit {
    /// All is done.
    Done = 0,
    /// The scene is wrong.
    Scene = 1,
    /// The command line is wrong.
    Usage = 2,
    /// A file or the system failed.
    System = 3,
    /// What was asked to hold doesn't: pictures differ from those that are committed, or a bound isn't kept.
    Unmet = 4,
}

/// Why a command stopped.
#[derive(Debug)]
pub struct Stop {
    /// The exit code.
    pub exit: Exit,
    diagnostics: Diagnostics,
    sources: Sources,
}

impl Stop {
    /// The command line asks for something impossible.
    pub fn usage(d: Diagnostic) -> Stop {
        Stop { exit: Exit::Usage, diagnostics: vec![d], sources: Sources::new() }
    }

    /// The scene asks for something that can't be drawn as it is.
    pub fn scene(d: Diagnostic, sources: &Sources) -> Stop {
        Stop { exit: Exit::Scene, diagnostics: vec![d], sources: sources.clone() }
    }

    /// `what` failed for the reason that the system gives.
    pub fn system(what: impl Into<String>, e: io::Error) -> Stop {
        Stop {
            exit: Exit::System,
            diagnostics: vec![Diagnostic::error(what).note(reason(&e))],
            sources: Sources::new(),
        }
    }

    /// The messages.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// The texts that they refer to.
    pub fn sources(&self) -> &Sources {
        &self.sources
    }

    /// The messages as plain text.
    pub fn text(&self) -> String {
        diag::print(&self.diagnostics, &self.sources, Look::Plain)
    }

    /// The messages as data.
    pub fn reports(&self) -> Vec<Report> {
        self.diagnostics.iter().map(|d| Report::new(d, &self.sources)).collect()
    }

    /// Prints the message to standard error.
    pub fn print(&self) {
        print_diagnostics(&self.diagnostics, &self.sources);
    }
}

impl From<Failure> for Stop {
    fn from(f: Failure) -> Stop {
        let exit = if f.main_unreadable { Exit::System } else { Exit::Scene };
        Stop { exit, diagnostics: f.diagnostics, sources: f.sources }
    }
}

/// Standard output failed. A reader that has seen enough (`| head`) is no news to anyone.
impl From<io::Error> for Stop {
    fn from(e: io::Error) -> Stop {
        match e.kind() {
            io::ErrorKind::BrokenPipe => Stop { exit: Exit::System, diagnostics: Vec::new(), sources: Sources::new() },
            _ => Stop::system("standard output can't be written", e),
        }
    }
}

/// Prints messages to standard error, in colour where it shows, and their number where there are several.
pub fn print_diagnostics(diagnostics: &[Diagnostic], sources: &Sources) {
    if diagnostics.is_empty() {
        return;
    }
    let look = match anstream::AutoStream::choice(&io::stderr()) {
        anstream::ColorChoice::Never => Look::Plain,
        _ => Look::Colored,
    };
    let mut text = diag::print(diagnostics, sources, look);
    if diagnostics.len() > 1 {
        text += &format!("\n{}\n", diag::summary(diagnostics));
    }
    // Where standard error is closed nobody wants to know.
    let _ = anstream::stderr().write_all(text.as_bytes());
}

/// What the system says, in words without its number.
fn reason(e: &io::Error) -> String {
    match e.kind() {
        io::ErrorKind::NotFound => "there is no such file or folder".into(),
        io::ErrorKind::PermissionDenied => "it isn't permitted".into(),
        io::ErrorKind::IsADirectory => "it is a folder".into(),
        io::ErrorKind::NotADirectory => "a part of its path is no folder".into(),
        io::ErrorKind::StorageFull => "the disk is full".into(),
        _ => e.to_string(),
    }
}
