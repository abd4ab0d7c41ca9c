//! Several mistakes in one outermost statement: what is wrong within a block is left out of it, and the rest tried again.

use super::builder::Builder;
use super::{Grammar, Rule};
use crate::diag::{Diagnostic, Diagnostics, FileId};
use crate::lang::ast::Statement;
use crate::lang::syntax;
use ecow::EcoString;
use pest::Parser as _;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Most bytes that are parsed again and again to find further mistakes in one statement.
const RECOVERY_BYTES: usize = 4 << 20;

/// Parses an outermost statement. One that is wrong within a block is left out of the block, and the rest tried again,
/// so that every broken statement of a block is reported.
pub(super) fn recover(
    file: FileId,
    source: &str,
    offset: usize,
    errors: &mut Diagnostics,
    cancel: &AtomicBool,
) -> Option<Statement> {
    let mut text = std::borrow::Cow::Borrowed(source);
    let mut holes: Vec<Hole> = Vec::new();
    let mut spent = 0;
    loop {
        let mut builder = Builder { file, offset, holes: &holes };
        let parsed = match Grammar::parse(Rule::one_statement, &text) {
            Ok(mut pairs) => pairs.next().ok_or_else(|| Diagnostic::error("an empty statement")),
            Err(e) => Err(syntax::explain(&e, file, &text, offset)),
        };
        let error = match parsed.and_then(|pair| builder.statement(pair)) {
            Ok(statement) => return Some(statement),
            Err(error) => error,
        };
        let at = error.span().map(|s| (s.start as usize).saturating_sub(offset));
        errors.push(error);
        spent += text.len();
        // The braces of an import hold names, not statements.
        let again = spent <= RECOVERY_BYTES && !cancel.load(Relaxed) && !source.starts_with("import");
        let part = at.filter(|_| again).and_then(|at| block_statement(&text, at))?;
        if part.is_empty() || text[part.clone()].trim().is_empty() {
            return None;
        }
        holes.push(Hole { at: offset + part.start, name: bound_name(&text[part.clone()]) });
        holes.sort_by_key(|h| h.at);
        text.to_mut().replace_range(part.clone(), &" ".repeat(part.len()));
    }
}

/// A broken statement that was left out of its block.
pub(super) struct Hole {
    /// Where in the file it starts.
    pub at: usize,
    /// What it was to bind.
    pub name: Option<EcoString>,
}

/// The name that a broken statement was meant to bind.
pub(super) fn bound_name(source: &str) -> Option<EcoString> {
    let mut words = source.split(|c: char| !(c == '_' || c.is_alphanumeric())).filter(|w| !w.is_empty());
    let mut first = words.next()?;
    if first == "export" {
        first = words.next()?;
    }
    matches!(first, "let" | "var" | "fn" | "param").then(|| words.next().map(EcoString::from)).flatten()
}

/// The innermost statement within a block `{ }` of prepared text that holds byte `at`; `None` outside of blocks.
fn block_statement(text: &str, at: usize) -> Option<Range<usize>> {
    let bytes = text.as_bytes();
    // Open marks, and where the current statement of a `{` starts; that of a text's `{…}` is no block.
    let mut open: Vec<(u8, usize)> = Vec::new();
    let mut found: Option<(usize, usize)> = None;
    let mut i = 0;
    while i < bytes.len() {
        if i == at {
            found = open.iter().enumerate().rev().find(|(_, o)| o.0 == b'{').map(|(k, o)| (k + 1, o.1));
            found?;
        }
        let here = found.is_some_and(|(depth, _)| open.len() == depth);
        let c = bytes[i];
        match open.last() {
            Some((b'"', _)) => match c {
                b'\\' if i + 1 != at => i += 1,
                b'"' => drop(open.pop()),
                b'{' => open.push((b'i', i)),
                _ => {}
            },
            last => match c {
                b';' | b'}' if here => return found.map(|(_, start)| start..i),
                b'"' | b'(' | b'[' | b'{' => open.push((c, i + 1)),
                b')' | b']' | b'}' => drop(open.pop()),
                b';' if last.is_some_and(|o| o.0 == b'{') => {
                    if let Some(block) = open.last_mut() {
                        block.1 = i + 1;
                    }
                }
                _ => {}
            },
        }
        i += 1;
    }
    None
}
