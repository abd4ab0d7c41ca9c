//! A message for the author of a scene: what is wrong, where, why, and what to do.

use super::{Place, Span};

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Worth a look; the picture is made.
    Warning,
    /// No picture.
    Error,
}

/// A place within a message, with a few words under its caret.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// The text.
    pub span: Span,
    /// What stands under the caret; may be empty.
    pub text: String,
}

/// One message. The first label is where it happened; the others show what it has to do with.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// Error or warning.
    pub severity: Severity,
    /// One sentence in the language's own words, without a full stop.
    pub message: String,
    /// The places, the main one first; may be empty where there is no text (a missing file).
    pub labels: Vec<Label>,
    /// Lines after the excerpt: what is allowed, where it was called from.
    pub notes: Vec<String>,
    /// How to mend it: a replacement of the main label's text, where it is certain enough to offer.
    pub fix: Option<String>,
    /// The calls that led here.
    pub place: Option<Place>,
}

/// What went wrong in a phase that can find several mistakes; never empty as an error value.
pub type Diagnostics = Vec<Diagnostic>;

impl Diagnostic {
    /// An error that has no place in a text.
    pub fn error(message: impl Into<String>) -> Diagnostic {
        Diagnostic {
            severity: Severity::Error,
            message: message.into(),
            labels: Vec::new(),
            notes: Vec::new(),
            fix: None,
            place: None,
        }
    }
    /// A warning.
    pub fn warning(message: impl Into<String>) -> Diagnostic {
        Diagnostic { severity: Severity::Warning, ..Diagnostic::error(message) }
    }
    /// Adds a place with `text` under its caret.
    pub fn at(mut self, span: Span, text: impl Into<String>) -> Diagnostic {
        self.labels.push(Label { span, text: text.into() });
        self
    }
    /// Adds a line of explanation.
    pub fn note(mut self, text: impl Into<String>) -> Diagnostic {
        self.notes.push(text.into());
        self
    }
    /// Offers `text` in place of the main label's.
    pub fn fix(mut self, text: impl Into<String>) -> Diagnostic {
        self.fix = Some(text.into());
        self
    }
    /// Records the calls that led here.
    pub fn from_place(mut self, place: Place) -> Diagnostic {
        self.place = Some(place);
        self
    }
    /// The main place.
    pub fn span(&self) -> Option<Span> {
        self.labels.first().map(|l| l.span)
    }
}
