//! Prepares a text for the grammar: checks that brackets and quotes match and aren't nested too deeply, blanks comments and
//! tabs, and turns every line's end into `;` where it ends a statement and into a blank where it doesn't. No byte moves, so
//! the grammar's positions are the file's. Splitting the text at its outermost statements lets one mistake be reported for
//! each.

mod unclosed;

use super::limits::{ARROW_DEPTH, BRACKET_DEPTH};
use crate::diag::{Diagnostic, Diagnostics, FileId, Span};
use std::ops::Range;

/// A prepared text.
#[derive(Debug, Default)]
pub struct Prepared {
    /// As long as the file.
    pub text: String,
    /// The outermost statements, blanks around them left out; empty ones are dropped.
    pub statements: Vec<Piece>,
    /// Comments, in the order of the text.
    pub comments: Vec<Range<usize>>,
    /// What stands within quotes, quotes included; the `{…}` in it parts it.
    pub texts: Vec<Range<usize>>,
}

/// An outermost statement.
#[derive(Debug)]
pub struct Piece {
    /// Its bytes.
    pub range: Range<usize>,
    /// A bracket or quote in it doesn't match: reported already, not to be parsed.
    pub broken: bool,
}

/// Prepares `text`.
pub fn prepare(file: FileId, text: &str) -> (Prepared, Diagnostics) {
    let mut s = Scanner {
        file,
        bytes: text.as_bytes(),
        out: text.as_bytes().to_vec(),
        open: Vec::new(),
        i: 0,
        last: None,
        start: 0,
        broken: false,
        arrows: 0,
        pieces: Vec::new(),
        errors: Vec::new(),
        next_word: 0..0,
        comments: Vec::new(),
        texts: Vec::new(),
    };
    s.run();
    let text = String::from_utf8(s.out).unwrap_or_default();
    (Prepared { text, statements: s.pieces, comments: s.comments, texts: s.texts }, s.errors)
}

struct Open {
    mark: u8,
    at: usize,
}

struct Scanner<'a> {
    file: FileId,
    bytes: &'a [u8],
    out: Vec<u8>,
    open: Vec<Open>,
    i: usize,
    /// The last byte that belongs to a token.
    last: Option<usize>,
    start: usize,
    broken: bool,
    arrows: u32,
    pieces: Vec<Piece>,
    errors: Diagnostics,
    /// Where the next line with any text starts; everything up to it is blanks and comments.
    next_word: Range<usize>,
    comments: Vec<Range<usize>>,
    texts: Vec<Range<usize>>,
}

/// What names and numbers are made of.
const PLAIN: [bool; 256] = {
    let mut plain = [false; 256];
    let mut b = 0;
    while b < 256 {
        plain[b] =
            (b as u8).is_ascii_alphanumeric() || matches!(b as u8, b'_' | b'.' | b':' | b'-' | b'+') || b >= 0x80;
        b += 1;
    }
    plain
};

const OPENING_WORDS: [&str; 7] = ["let", "var", "fn", "param", "import", "export", "while"];

impl Scanner<'_> {
    fn run(&mut self) {
        while self.i < self.bytes.len() {
            let (at, c) = (self.i, self.bytes[self.i]);
            let inside_text = self.inside_text();
            if !inside_text && self.plain_bytes() {
                continue;
            }
            if inside_text {
                self.text_byte(c);
            } else {
                self.code_byte(c);
            }
            match (inside_text, self.inside_text()) {
                // At its quote, or after the `}` of a value in it.
                (false, true) => self.texts.push(at + usize::from(c != b'"')..self.bytes.len()),
                (true, false) => self.end_text(at + usize::from(c == b'"')),
                _ => {}
            }
            if self.open.len() > BRACKET_DEPTH || self.arrows > ARROW_DEPTH {
                self.too_deep();
                return;
            }
        }
        self.close_at_end();
        self.end_statement(self.bytes.len());
    }

    /// Passes over code that ends and begins nothing, most of a file; false where there is none.
    fn plain_bytes(&mut self) -> bool {
        let is_plain = |b: &&u8| PLAIN[usize::from(**b)];
        let plain = self.bytes[self.i..].iter().take_while(is_plain).count();
        if plain == 0 {
            return false;
        }
        self.i += plain;
        self.last = Some(self.i - 1);
        true
    }

    fn inside_text(&self) -> bool {
        self.open.last().is_some_and(|o| o.mark == b'"')
    }

    fn end_text(&mut self, end: usize) {
        if let Some(text) = self.texts.last_mut() {
            text.end = end;
        }
    }

    fn text_byte(&mut self, c: u8) {
        match c {
            b'\n' => return self.line_end(),
            b'\\' if self.bytes.get(self.i + 1).is_some_and(|n| *n != b'\n') => self.i += 1,
            b'"' => {
                self.open.pop();
                self.last = Some(self.i);
            }
            b'{' => self.open.push(Open { mark: b'{', at: self.i }),
            _ => {}
        }
        self.i += 1;
    }

    fn code_byte(&mut self, c: u8) {
        let next = self.bytes.get(self.i + 1).copied();
        match c {
            b'/' if next == Some(b'/') => {
                let end =
                    self.bytes[self.i..].iter().position(|b| *b == b'\n').map_or(self.bytes.len(), |n| self.i + n);
                self.comment(end);
                return;
            }
            b'/' if next == Some(b'*') => return self.block_comment(),
            b'\n' => return self.line_end(),
            b' ' | b'\t' | b'\r' => {
                self.out[self.i] = b' ';
                self.i += 1;
                return;
            }
            b'"' | b'(' | b'[' | b'{' => self.open.push(Open { mark: c, at: self.i }),
            b')' | b']' | b'}' => self.closing(c),
            b';' => {
                self.arrows = 0;
                if self.open.is_empty() {
                    self.end_statement(self.i);
                    self.start = self.i + 1;
                }
            }
            b',' => self.arrows = 0,
            b'=' if next == Some(b'>') => self.arrows += 1,
            _ => {}
        }
        self.last = Some(self.i);
        self.i += 1;
    }

    fn line_end(&mut self) {
        if self.open.iter().any(|o| o.mark == b'"') {
            return self.unclosed_text();
        }
        let word = self.next_word();
        let opening = OPENING_WORDS.contains(&word);
        let continues = word == "|>" || word == "else";
        let top = self.open.last().map(|o| o.mark);
        if opening && matches!(top, Some(b'(' | b'[')) {
            // No expression goes on with such a word, so the bracket was forgotten.
            self.unclosed_brackets();
        }
        let in_brackets = matches!(self.open.last(), Some(o) if o.mark != b'{');
        let goes_on = continues || (self.ends_with_operator() && !opening);
        if in_brackets || goes_on {
            self.out[self.i] = b' ';
        } else {
            self.out[self.i] = b';';
            self.arrows = 0;
            if self.open.is_empty() {
                self.end_statement(self.i);
                self.start = self.i + 1;
            }
            self.last = None;
        }
        self.i += 1;
    }

    /// Whether a line that ends here goes on in the next.
    fn ends_with_operator(&self) -> bool {
        let Some(last) = self.last else { return false };
        if b"=+-*/^<>.&|".contains(&self.bytes[last]) {
            return true;
        }
        let word_start = self.bytes[..=last]
            .iter()
            .rposition(|b| !(b.is_ascii_alphanumeric() || *b == b'_' || *b >= 0x80))
            .map_or(0, |k| k + 1);
        matches!(&self.bytes[word_start..=last], b"and" | b"or" | b"not" | b"in" | b"else")
    }

    /// The word, or `|>`, that the next line with any starts with. Found once for all the blank lines and comments before
    /// it: a long comment must not be read again from each of its lines.
    fn next_word(&mut self) -> &str {
        if self.next_word.start <= self.i {
            self.next_word = self.find_next_word();
        }
        std::str::from_utf8(&self.bytes[self.next_word.clone()]).unwrap_or("")
    }

    fn find_next_word(&self) -> Range<usize> {
        let all = self.bytes.len();
        let mut i = self.i;
        loop {
            while self.bytes.get(i).is_some_and(|b| b.is_ascii_whitespace()) {
                i += 1;
            }
            match self.bytes.get(i..i + 2) {
                Some(b"//") => {
                    while self.bytes.get(i).is_some_and(|b| *b != b'\n') {
                        i += 1;
                    }
                }
                Some(b"/*") => match comment_end(self.bytes, i) {
                    Some(end) => i = end,
                    None => return all..all,
                },
                Some(b"|>") => return i..i + 2,
                _ => break,
            }
        }
        let is_word = |b: &u8| b.is_ascii_alphanumeric() || *b == b'_' || *b >= 0x80;
        i..self.bytes[i..].iter().position(|b| !is_word(b)).map_or(all, |n| i + n)
    }

    fn block_comment(&mut self) {
        let end = comment_end(self.bytes, self.i);
        if end.is_none() {
            let here = self.span(self.i, self.i + 2);
            self.errors.push(
                Diagnostic::error("this comment is never closed")
                    .at(here, "opened here")
                    .note("comments nest: every `/*` needs its own `*/`"),
            );
        }
        self.comment(end.unwrap_or(self.bytes.len()));
    }

    /// Blanks the comment that ends before `end`.
    fn comment(&mut self, end: usize) {
        self.out[self.i..end].fill(b' ');
        self.comments.push(self.i..end);
        self.i = end;
    }

    fn end_statement(&mut self, end: usize) {
        let blank = |b: &u8| b.is_ascii_whitespace();
        let piece = &self.out[self.start..end];
        if let Some(from) = piece.iter().position(|b| !blank(b)) {
            let to = piece.iter().rposition(|b| !blank(b)).map_or(from, |k| k + 1);
            self.pieces.push(Piece { range: self.start + from..self.start + to, broken: self.broken });
        }
        self.broken = false;
    }

    fn span(&self, from: usize, to: usize) -> Span {
        Span::new(self.file, from..to.min(self.bytes.len()).max(from))
    }
}

fn closer(open: u8) -> u8 {
    match open {
        b'(' => b')',
        b'[' => b']',
        b'{' => b'}',
        other => other,
    }
}

/// One past a nested comment that starts at `i`.
fn comment_end(bytes: &[u8], mut i: usize) -> Option<usize> {
    let mut depth = 0usize;
    while i < bytes.len() {
        match bytes.get(i..i + 2) {
            Some(b"/*") => {
                depth += 1;
                i += 2;
            }
            Some(b"*/") => {
                depth -= 1;
                i += 2;
                if depth == 0 {
                    return Some(i);
                }
            }
            _ => i += 1,
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cooked(text: &str) -> String {
        let (p, errors) = prepare(FileId(0), text);
        assert!(errors.is_empty(), "{errors:?}");
        assert_eq!(p.text.len(), text.len());
        p.text
    }
    fn errors(text: &str) -> Vec<String> {
        prepare(FileId(0), text).1.into_iter().map(|d| d.message).collect()
    }

    #[test]
    fn lines_end_statements_only_outside_brackets() {
        assert_eq!(cooked("a\nb"), "a;b");
        assert_eq!(cooked("f(a\n,b)\nc"), "f(a ,b);c");
        assert_eq!(cooked("f({\na\n})"), "f({;a;})");
        assert_eq!(cooked("a // x\n  |> b"), "a        |> b");
    }

    #[test]
    fn statements_go_on_before_pipes_else_and_after_operators() {
        assert_eq!(cooked("if a {}\n else {}"), "if a {}  else {}");
        assert_eq!(cooked("let a =\n 1"), "let a =  1");
        assert_eq!(cooked("a or\nb"), "a or b");
        assert_eq!(cooked("50%\nb"), "50%;b");
        assert_eq!(cooked("a /* x\n /* y */ */ b"), "a                  b");
    }

    #[test]
    fn brackets_and_texts_must_close() {
        assert_eq!(errors("f(1"), ["this `(` is never closed"]);
        assert_eq!(errors("f(1]"), ["`(` is closed by `]`"]);
        assert_eq!(errors("f 1)"), ["`)` closes nothing"]);
        assert_eq!(errors("\"abc\nlet b = 1"), ["this text is never closed"]);
        assert_eq!(errors("f(1\nlet b = 2"), ["this `(` is never closed"]);
        assert_eq!(errors("/* /* */"), ["this comment is never closed"]);
        assert_eq!(errors(&"(".repeat(100_000)), ["brackets are nested more than 256 deep"]);
        assert_eq!(errors(&"a=>".repeat(100_000)), ["functions are nested more than 32 deep"]);
    }

    #[test]
    fn texts_may_hold_brackets_and_expressions() {
        assert_eq!(cooked("\"a ( // {f(\"x\")} \\\" \""), "\"a ( // {f(\"x\")} \\\" \"");
    }
}
