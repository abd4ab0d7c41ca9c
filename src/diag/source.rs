//! The texts that were read, and half-open byte ranges in them.

use std::ops::Range;
use std::path::PathBuf;

/// Names one text of a [`Sources`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FileId(pub u32);

/// A half-open byte range `start..end` of one text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Span {
    /// The text.
    pub file: FileId,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// The range `range` of `file`.
    pub fn new(file: FileId, range: Range<usize>) -> Span {
        Span { file, start: range.start as u32, end: range.end as u32 }
    }
    /// The byte range.
    pub fn range(self) -> Range<usize> {
        self.start as usize..self.end as usize
    }
    /// From the start of `self` to the end of `other`, which must be in the same text.
    pub fn to(self, other: Span) -> Span {
        Span { end: other.end, ..self }
    }
}

/// One text: a scene file, a module, or a value from the command line.
#[derive(Clone, Debug)]
pub struct Source {
    /// How messages name it: the path as the user would type it.
    pub name: String,
    /// Where it was read from; `None` for standard input and command-line values.
    pub path: Option<PathBuf>,
    /// The text.
    pub text: String,
}

/// All texts of one run.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    files: Vec<Source>,
}

impl Sources {
    /// No texts yet.
    pub fn new() -> Self {
        Self::default()
    }
    /// Adds a text.
    pub fn add(&mut self, source: Source) -> FileId {
        self.files.push(source);
        FileId(self.files.len() as u32 - 1)
    }
    /// The text named `id`.
    pub fn get(&self, id: FileId) -> &Source {
        &self.files[id.0 as usize]
    }
    /// Every text, in the order in which it was added.
    pub fn iter(&self) -> impl Iterator<Item = (FileId, &Source)> {
        self.files.iter().enumerate().map(|(i, s)| (FileId(i as u32), s))
    }
    /// The bytes of a span as text; clamped to the file and to character boundaries, so it never fails.
    pub fn text(&self, span: Span) -> &str {
        let text = &self.get(span.file).text;
        let floor = |mut i: usize| {
            i = i.min(text.len());
            while !text.is_char_boundary(i) {
                i -= 1;
            }
            i
        };
        let start = floor(span.start as usize);
        &text[start..floor(span.end as usize).max(start)]
    }
    /// Line and column of the first byte, both counted from 1; the column counts characters.
    pub fn line_column(&self, span: Span) -> (usize, usize) {
        let text = &self.get(span.file).text;
        let head = self.text(Span { start: 0, end: span.start.min(text.len() as u32), ..span });
        let line_start = head.rfind('\n').map_or(0, |i| i + 1);
        (head.matches('\n').count() + 1, head[line_start..].chars().count() + 1)
    }
    /// `name:line:column`, as messages print it.
    pub fn location(&self, span: Span) -> String {
        let (line, column) = self.line_column(span);
        format!("{}:{line}:{column}", self.get(span.file).name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_count_characters() {
        let mut s = Sources::new();
        let f = s.add(Source { name: "a.scene".into(), path: None, text: "let ä = 1\nlet b = é + 2\n".into() });
        let b = s.get(f).text.find("+ 2").unwrap();
        assert_eq!(s.location(Span::new(f, b..b + 1)), "a.scene:2:11");
        assert_eq!(s.text(Span::new(f, 5..9000)), "ä = 1\nlet b = é + 2\n", "clamped, and moved to a boundary");
    }
}
