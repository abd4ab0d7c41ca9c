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

    /// The calls, innermost first, as `called from …` lines. The middle of a long chain is left out: a runaway recursion
    /// is plain from its ends.
    pub fn call_chain(&self, sources: &Sources) -> Vec<String> {
        let frames: Vec<&CallFrame> =
            std::iter::successors(self.trace.as_deref(), |frame| frame.parent.as_deref()).collect();
        let line = |frame: &&CallFrame| format!("called from {} at {}", frame.call, sources.location(frame.span));
        let left_out = frames.len().saturating_sub(INNERMOST_SHOWN + OUTERMOST_SHOWN);
        if left_out <= 1 {
            return frames.iter().map(line).collect();
        }
        let mut lines: Vec<String> = frames[..INNERMOST_SHOWN].iter().map(line).collect();
        lines.push(format!("… {left_out} more …"));
        lines.extend(frames[frames.len() - OUTERMOST_SHOWN..].iter().map(line));
        lines
    }
}

/// Calls shown next to the mistake: enough to see the pattern of a recursion.
const INNERMOST_SHOWN: usize = 5;
/// Calls shown at the other end: where it all began.
const OUTERMOST_SHOWN: usize = 2;

// A chain can be as long as the recursion limit allows; dropping it must not recurse.
impl Drop for CallFrame {
    fn drop(&mut self) {
        let mut next = self.parent.take();
        while let Some(frame) = next {
            next = Arc::into_inner(frame).and_then(|mut f| f.parent.take());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diag::Source;

    #[test]
    fn long_chains_show_their_ends() {
        let mut sources = Sources::new();
        let file = sources.add(Source { name: "a.scene".into(), path: None, text: "f(0)".into() });
        let span = Span::new(file, 0..4);
        let mut trace = None;
        for i in 0..100_000 {
            trace = Some(Arc::new(CallFrame { call: format!("f({i})").into(), span, parent: trace }));
        }
        let lines = Place { span, trace: trace.clone() }.call_chain(&sources);
        assert_eq!(lines.len(), 8);
        assert_eq!(lines[0], "called from f(99999) at a.scene:1:1");
        assert_eq!(lines[5], "… 99993 more …");
        assert_eq!(lines[7], "called from f(0) at a.scene:1:1");
        let mut short = trace;
        for _ in 0..100_000 - 8 {
            short = short.and_then(|f| f.parent.clone());
        }
        assert_eq!(Place { span, trace: short }.call_chain(&sources).len(), 8, "one line isn't replaced by one line");
    }
}
