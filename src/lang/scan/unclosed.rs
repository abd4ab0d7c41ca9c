//! Brackets and quotes that don't match, or are nested too deeply.

use super::{Open, Piece, Scanner, closer};
use crate::diag::Diagnostic;
use crate::lang::limits::{ARROW_DEPTH, BRACKET_DEPTH};

impl Scanner<'_> {
    pub(super) fn closing(&mut self, c: u8) {
        let wanted = self.open.last().map(|o| closer(o.mark));
        if wanted == Some(c) {
            self.open.pop();
            return;
        }
        // What follows a bracket that doesn't fit is guesswork: one message a statement.
        let first = !std::mem::replace(&mut self.broken, true);
        let here = self.span(self.i, self.i + 1);
        let error = match self.open.last() {
            None => {
                Diagnostic::error(format!("`{}` closes nothing", c as char)).at(here, "no bracket is open here").fix("")
            }
            Some(open) => {
                let (mark, wanted) = (open.mark as char, closer(open.mark) as char);
                let error = Diagnostic::error(format!("`{mark}` is closed by `{}`", c as char))
                    .at(here, format!("expected `{wanted}`"))
                    .at(self.span(open.at, open.at + 1), "opened here");
                // Close up to the bracket that this one fits, if there is one.
                // Otherwise take it for a slip of the innermost.
                let fits = self.open.iter().rposition(|o| closer(o.mark) == c);
                self.open.truncate(fits.unwrap_or(self.open.len() - 1));
                error
            }
        };
        if first {
            self.errors.push(error);
        }
    }

    pub(super) fn unclosed_text(&mut self) {
        // A text's {…} that is still open has swallowed the quote that was to end the text.
        let text = self.open.iter().position(|o| o.mark == b'"').unwrap_or(0);
        if let Some(open) = self.open.get(text + 1) {
            let here = self.span(open.at, open.at + 1);
            self.errors.push(
                Diagnostic::error("this `{` in a text is never closed")
                    .at(here, "expected a `}` before the text ends")
                    .note("`{…}` puts a value into a text; for the sign itself write `\\{`"),
            );
        } else if let Some(open) = self.open.get(text) {
            let end = self.bytes[..self.i].iter().rposition(|b| !b.is_ascii_whitespace()).map_or(self.i, |k| k + 1);
            let here = self.span(open.at, end);
            self.errors.push(
                Diagnostic::error("this text is never closed")
                    .at(here, "a `\"` is missing at its end")
                    .note("a text ends on the line on which it starts; write `\\n` for a new line in it"),
            );
        }
        self.broken = true;
        // The rest of the statement can't be told from the text; start afresh with the line.
        self.open.clear();
        self.last = None;
    }

    pub(super) fn unclosed_brackets(&mut self) {
        let keep = self.open.iter().rposition(|o| o.mark == b'{').map_or(0, |k| k + 1);
        if let Some(open) = self.open.last()
            && !self.broken
        {
            self.errors.push(self.unclosed(open));
        }
        self.open.truncate(keep);
        self.broken = true;
    }

    pub(super) fn close_at_end(&mut self) {
        if self.open.iter().any(|o| o.mark == b'"') {
            self.unclosed_text();
        } else if let Some(open) = self.open.last() {
            if !self.broken {
                self.errors.push(self.unclosed(open));
            }
            self.broken = true;
        }
    }

    pub(super) fn unclosed(&self, open: &Open) -> Diagnostic {
        Diagnostic::error(format!("this `{}` is never closed", open.mark as char)).at(
            self.span(open.at, open.at + 1),
            format!("expected a `{}` somewhere after it", closer(open.mark) as char),
        )
    }

    pub(super) fn too_deep(&mut self) {
        let at = self.i.saturating_sub(1);
        let error = if self.open.len() > BRACKET_DEPTH {
            Diagnostic::error(format!("brackets are nested more than {BRACKET_DEPTH} deep"))
        } else {
            Diagnostic::error(format!("functions are nested more than {ARROW_DEPTH} deep"))
        };
        self.errors.push(
            error.at(self.span(at, at + 1), "too deep here").note("give the inner part a name with `let` and use that"),
        );
        self.pieces.push(Piece { range: self.start..self.bytes.len(), broken: true });
    }
}
