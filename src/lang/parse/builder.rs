//! What turns the grammar's pairs into the syntax tree: where it is in the file, and the parts that carry meaning.

use super::Rule;
use super::recover::Hole;
use crate::diag::{Diagnostic, FileId, Span};
use crate::lang::ast::Ident;
use pest::iterators::{Pair, Pairs};

pub(super) type Parsed<T> = Result<T, Diagnostic>;

pub(super) struct Builder<'a> {
    pub file: FileId,
    pub offset: usize,
    /// In the order of the text.
    pub holes: &'a [Hole],
}

impl Builder<'_> {
    pub(super) fn span(&self, pair: &Pair<'_, Rule>) -> Span {
        let s = pair.as_span();
        Span::new(self.file, self.offset + s.start()..self.offset + s.end())
    }

    pub(super) fn ident(&self, pair: &Pair<'_, Rule>) -> Ident {
        Ident { name: pair.as_str().into(), span: self.span(pair) }
    }
}

/// The parts of a pair that carry meaning: keywords and punctuation left out.
pub(super) struct Parts<'a>(pub Pairs<'a, Rule>);

impl<'a> Parts<'a> {
    pub(super) fn of(pair: Pair<'a, Rule>) -> Parts<'a> {
        Parts(pair.into_inner())
    }
    pub(super) fn next(&mut self) -> Parsed<Pair<'a, Rule>> {
        self.maybe().ok_or_else(|| Diagnostic::error("this statement is incomplete"))
    }
    pub(super) fn maybe(&mut self) -> Option<Pair<'a, Rule>> {
        Iterator::next(self)
    }
}

impl<'a> Iterator for Parts<'a> {
    type Item = Pair<'a, Rule>;
    fn next(&mut self) -> Option<Pair<'a, Rule>> {
        self.0.find(|p| {
            !matches!(
                p.as_rule(),
                Rule::kw_let
                    | Rule::kw_var
                    | Rule::kw_fn
                    | Rule::kw_param
                    | Rule::kw_import
                    | Rule::kw_export
                    | Rule::kw_as
                    | Rule::kw_for
                    | Rule::kw_in
                    | Rule::kw_of
                    | Rule::kw_while
                    | Rule::kw_if
                    | Rule::kw_else
                    | Rule::open_paren
                    | Rule::close_paren
                    | Rule::open_bracket
                    | Rule::close_bracket
                    | Rule::open_brace
                    | Rule::close_brace
                    | Rule::comma
                    | Rule::colon
                    | Rule::dot
                    | Rule::arrow
                    | Rule::equals
                    | Rule::separator
                    | Rule::EOI
            )
        })
    }
}

/// The grammar's rules may take blanks after them; an error's caret shouldn't.
pub(super) fn trimmed(span: Span, text: &str) -> Span {
    Span { end: span.start + text.trim_end().len() as u32, ..span }
}
