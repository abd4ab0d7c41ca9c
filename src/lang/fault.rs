//! What goes wrong while a scene is evaluated: first without a place, then with one.

use super::value::Value;
use crate::diag::{Diagnostic, Span};

/// A mistake found by an operator or a built-in word, which don't know where they stand.
#[derive(Debug)]
pub struct Fault {
    /// One sentence.
    pub message: String,
    /// What stands under the caret.
    pub label: String,
    /// Lines of explanation.
    pub notes: Vec<String>,
    /// The argument that it is about, counted like the call's parameters; else the whole expression.
    pub argument: Option<usize>,
    /// What to write instead of the text under the caret.
    pub fix: Option<String>,
    /// Another place that it has to do with.
    pub other: Option<(Span, String)>,
    /// A budget is used up: evaluating on makes no sense.
    pub fatal: bool,
}

impl Fault {
    /// A mistake of the whole expression.
    pub fn new(message: impl Into<String>) -> Box<Fault> {
        Box::new(Fault {
            message: message.into(),
            label: String::new(),
            notes: Vec::new(),
            argument: None,
            fix: None,
            other: None,
            fatal: false,
        })
    }
    /// A used-up budget.
    pub fn budget(message: impl Into<String>, note: impl Into<String>) -> Box<Fault> {
        let mut fault = Fault::new(message).note(note);
        fault.fatal = true;
        fault
    }
    /// Words under the caret.
    pub fn label(mut self: Box<Self>, text: impl Into<String>) -> Box<Fault> {
        self.label = text.into();
        self
    }
    /// A line of explanation.
    pub fn note(mut self: Box<Self>, text: impl Into<String>) -> Box<Fault> {
        self.notes.push(text.into());
        self
    }
    /// A line of explanation where there is none yet.
    pub fn note_once(self: Box<Self>, text: impl Into<String>) -> Box<Fault> {
        if self.notes.is_empty() { self.note(text) } else { self }
    }
    /// A replacement.
    pub fn fix(mut self: Box<Self>, text: impl Into<String>) -> Box<Fault> {
        self.fix = Some(text.into());
        self
    }
    /// Shows another place.
    pub fn and_at(mut self: Box<Self>, span: Span, text: impl Into<String>) -> Box<Fault> {
        self.other = Some((span, text.into()));
        self
    }
    /// It is about one argument.
    pub fn on(mut self: Box<Self>, argument: usize) -> Box<Fault> {
        self.argument = Some(argument);
        self
    }
}

/// Why an expression has no value.
#[derive(Debug)]
pub enum Stop {
    /// A mistake without a place yet.
    Fault(Box<Fault>),
    /// A mistake with a place.
    Error(Box<Diagnostic>),
    /// As `Error`, and nothing more shall be evaluated.
    Fatal(Box<Diagnostic>),
    /// It depends on something whose mistake has been reported.
    Reported,
    /// Nobody waits for it any more.
    Cancelled,
}

impl From<Box<Fault>> for Stop {
    fn from(fault: Box<Fault>) -> Stop {
        Stop::Fault(fault)
    }
}

/// What evaluating gives.
pub type Outcome = Result<Value, Stop>;
