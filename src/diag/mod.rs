//! How rtdsl tells a person what is wrong: texts, places in them, and messages with a place, a reason and a remedy; numbers as people read them. Knows
//! no phase; every phase reports through it.

pub mod diagnostic;
pub mod number;
pub mod place;
pub mod report;
pub mod snippet;
pub mod source;

pub use diagnostic::{Diagnostic, Diagnostics, Label, Severity};
pub use number::thousands;
pub use place::{CallFrame, Place};
pub use report::Report;
pub use snippet::{Look, print, summary};
pub use source::{FileId, Source, Sources, Span};
