//! Where a thing in the scene came from: its text, and the calls that led there.

use super::{Sources, Span};
use std::sync::Arc;

/// The text that made a thing, and the chain of calls that was running.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// The expression.
    pub span: Span,
    /// The innermost call, if any.
    pub trace: Option<Arc<CallFrame>>,
}

/// One call of a function of the scene language.
#[derive(Debug, PartialEq)]
pub struct CallFrame {
    /// The function's name, with its arguments where they are known: `bead(u: 0.25, i: 60)`.
    pub call: Arc<str>,
    /// The call expression.
    pub span: Span,
    /// The call around it.
    pub parent: Option<Arc<CallFrame>>,
}

impl Place {
    /// A place outside any call.
    pub fn new(span: Span) -> Place {
        Place { span, trace: None }
    }

    /// The calls, innermost first, as `called from …` lines.
    pub fn call_chain(&self, sources: &Sources) -> Vec<String> {
        let mut lines = Vec::new();
        let mut frame = self.trace.as_deref();
        while let Some(f) = frame {
            lines.push(format!("called from {} at {}", f.call, sources.location(f.span)));
            frame = f.parent.as_deref();
        }
        lines
    }
}

// A chain can be as long as the recursion limit allows; dropping it must not recurse.
impl Drop for CallFrame {
    fn drop(&mut self) {
        let mut next = self.parent.take();
        while let Some(frame) = next {
            next = Arc::into_inner(frame).and_then(|mut f| f.parent.take());
        }
    }
}
