//! Messages as text for a person: the sentence, the place, the line with a caret under it, and what to do, in the form that
//! rustc made familiar. `annotate-snippets` draws the excerpt; what it can't bear is kept from it here, in one place:
//! it panics on spans that are reversed, past the end or inside a character, and prints a line of any length whole.

use super::{Diagnostic, Label, Severity, Sources};
use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet};
use std::ops::Range;

/// How messages are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// Text alone.
    Plain,
    /// With colours for a terminal.
    Colored,
}

/// Columns of an excerpt: fits a wide terminal beside the line numbers.
const WIDTH: usize = 120;
/// Bytes of a line that are kept at either side of a label; the drawing itself shortens the rest to [`WIDTH`].
const AROUND: usize = 4 * WIDTH;
/// Longest caret: a span of a megabyte needn't be underlined to its end.
const LONGEST_CARET: usize = WIDTH / 2;
/// Longest message, label, note or fix in characters: all that a person reads; texts from a scene can be of any length.
const LONGEST_TEXT: usize = 1000;

/// The messages one after another, a blank line between them, each ending in a newline.
pub fn print(diagnostics: &[Diagnostic], sources: &Sources, look: Look) -> String {
    diagnostics.iter().map(|d| print_one(d, sources, look)).collect::<Vec<_>>().join("\n")
}

/// How many there are: `2 errors, 1 warning`; empty for none.
pub fn summary(diagnostics: &[Diagnostic]) -> String {
    let count = |severity, one: &str| match diagnostics.iter().filter(|d| d.severity == severity).count() {
        0 => None,
        1 => Some(format!("1 {one}")),
        n => Some(format!("{n} {one}s")),
    };
    let counts = [count(Severity::Error, "error"), count(Severity::Warning, "warning")];
    counts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

fn print_one(d: &Diagnostic, sources: &Sources, look: Look) -> String {
    let level = match d.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let mut group = Group::with_title(level.primary_title(shorten(&d.message)));
    let mut shown: Vec<_> = Vec::new();
    for (i, label) in d.labels.iter().enumerate() {
        let file = label.span.file;
        if shown.contains(&file) {
            continue;
        }
        shown.push(file);
        let labels: Vec<&Label> = d.labels[i..].iter().filter(|l| l.span.file == file).collect();
        let source = sources.get(file);
        let excerpt = Excerpt::new(&source.text, &labels);
        let kind = |k| if i == 0 && k == 0 { AnnotationKind::Primary } else { AnnotationKind::Context };
        let snippet = Snippet::source(excerpt.text).line_start(excerpt.first_line).annotations(
            excerpt.spans.into_iter().zip(&labels).enumerate().map(|(k, (span, label))| {
                let text = (!label.text.is_empty()).then(|| shorten(&label.text));
                kind(k).span(span).label(text)
            }),
        );
        group = if excerpt.cut {
            // The drawing counts columns in the excerpt; where its head is missing, the true place is stated before it.
            let (line, column) = sources.line_column(label.span);
            group.element(Origin::path(source.name.as_str()).line(line).char_column(column)).element(snippet)
        } else {
            group.element(snippet.path(source.name.as_str()))
        };
    }
    for note in d.notes.iter().chain(&d.place.as_ref().map_or(Vec::new(), |p| p.call_chain(sources))) {
        group = group.element(Level::NOTE.no_name().message(shorten(note)));
    }
    if let Some(help) = help(d) {
        group = group.element(Level::HELP.message(shorten(&help)));
    }
    let renderer = match look {
        Look::Plain => Renderer::plain(),
        Look::Colored => Renderer::styled(),
    };
    let drawn = renderer.term_width(WIDTH).render(&[group]);
    let mut text = String::with_capacity(drawn.len() + 1);
    for line in drawn.lines() {
        // The bar that leads from an excerpt to its notes leads nowhere without one.
        let bare = anstream::adapter::strip_str(line).to_string();
        if d.labels.is_empty() && bare.trim() == "|" {
            continue;
        }
        // Where the head of a line is missing the place stands before the excerpt; a second arrow without one means nothing.
        if bare.trim() == ":::" {
            text.push_str(line.replace(":::", " |").trim_end());
        } else {
            text.push_str(line.trim_end());
        }
        text.push('\n');
    }
    text
}

/// What to write instead, unless the message says so already.
fn help(d: &Diagnostic) -> Option<String> {
    let fix = d.fix.as_ref()?;
    let quoted = format!("`{}`", fix.trim());
    let said = d.labels.iter().map(|l| &l.text).chain([&d.message]).chain(&d.notes).any(|t| t.contains(&quoted));
    let at_a_point = d.span().is_some_and(|s| s.start == s.end);
    match () {
        () if said => None,
        () if fix.is_empty() => Some("remove it".into()),
        () if at_a_point => Some(format!("insert {quoted}")),
        () => Some(format!("write {quoted}")),
    }
}

/// At most [`LONGEST_TEXT`] characters, control characters but the newline made visible: an escape sequence in a scene
/// must not reach the terminal.
fn shorten(text: &str) -> String {
    let visible = |c: char| if c.is_control() && c != '\n' { '\u{fffd}' } else { c };
    let mut short: String = text.chars().take(LONGEST_TEXT).map(visible).collect();
    if text.chars().nth(LONGEST_TEXT).is_some() {
        short.push('…');
    }
    short
}

/// The lines that the labels stand on, cut where they are very long, and the labels' ranges in them.
struct Excerpt {
    text: String,
    /// Number of the first line, from 1.
    first_line: usize,
    /// One a label; never reversed, past the end, or inside a character.
    spans: Vec<Range<usize>>,
    /// Whether the head of a labelled line is missing.
    cut: bool,
}

impl Excerpt {
    /// `labels` isn't empty.
    fn new(whole: &str, labels: &[&Label]) -> Excerpt {
        let ranges: Vec<Range<usize>> = labels.iter().map(|l| clamp(whole, l.span.range())).collect();
        let start = ranges.iter().map(|r| r.start).min().unwrap_or(0);
        let end = ranges.iter().map(|r| r.end).max().unwrap_or(0);
        let start = whole[..start].rfind('\n').map_or(0, |i| i + 1);
        let end = whole[end..].find('\n').map_or(whole.len(), |i| end + i);
        let mut excerpt = Excerpt {
            text: String::new(),
            first_line: whole[..start].matches('\n').count() + 1,
            spans: vec![0..0; ranges.len()],
            cut: false,
        };
        let mut line_start = start;
        for (i, line) in whole[start..end].split('\n').enumerate() {
            if i > 0 {
                excerpt.text.push('\n');
            }
            excerpt.push_line(line, line_start, &ranges);
            line_start += line.len() + 1;
        }
        excerpt
    }

    /// Adds `line`, which starts at `at` in the whole text, and sets the ends of the ranges that lie in it.
    fn push_line(&mut self, line: &str, at: usize, ranges: &[Range<usize>]) {
        let here = |i: usize| (at..=at + line.len()).contains(&i);
        let first = ranges.iter().flat_map(|r| [r.start, r.end]).filter(|&i| here(i)).min();
        // Kept is what lies around the first label of the line.
        let middle = first.map_or(0, |i| i - at);
        let kept = clamp(line, middle.saturating_sub(AROUND)..middle + AROUND);
        if kept.start > 0 {
            self.text.push('…');
            self.cut = true;
        }
        let base = self.text.len();
        // The end of a line on Windows isn't part of it.
        self.text.push_str(&line[kept.clone()].replace('\r', " "));
        let place = |i: usize| base + (i - at).clamp(kept.start, kept.end) - kept.start;
        for (span, range) in self.spans.iter_mut().zip(ranges) {
            if here(range.start) {
                span.start = place(range.start);
            }
            if here(range.end) {
                span.end = place(range.end);
                if span.end - span.start > LONGEST_CARET && here(range.start) {
                    span.end = place(clamp(line, 0..range.start - at + LONGEST_CARET).end + at);
                }
            }
        }
        if kept.end < line.len() {
            self.text.push('…');
        }
    }
}

/// `range` moved into `text` and to character boundaries, not reversed.
fn clamp(text: &str, range: Range<usize>) -> Range<usize> {
    let floor = |i: usize| {
        let i = i.min(text.len());
        (0..=i).rev().find(|&i| text.is_char_boundary(i)).unwrap_or(0)
    };
    let start = floor(range.start);
    start..floor(range.end).max(start)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diag::{CallFrame, FileId, Place, Source, Span};
    use std::sync::Arc;

    fn one(text: &str) -> (Sources, FileId) {
        let mut s = Sources::new();
        let f = s.add(Source { name: "spiral.scene".into(), path: None, text: text.into() });
        (s, f)
    }

    fn plain(d: Diagnostic, sources: &Sources) -> String {
        print(&[d], sources, Look::Plain)
    }

    #[test]
    fn a_whole_message() {
        let (s, f) = one("let u = 1\n\n  sphere(at: spiral(u), raduis: size)\n");
        let span = Span::new(f, 35..41);
        let frame = CallFrame { call: "bead(u: 0.25, i: 60)".into(), span: Span::new(f, 8..9), parent: None };
        let d = Diagnostic::error("`sphere` has no property `raduis`")
            .at(span, "this name")
            .note("sphere takes: at, r, mat, name")
            .fix("r")
            .from_place(Place { span, trace: Some(Arc::new(frame)) });
        let expected = "\
error: `sphere` has no property `raduis`
 --> spiral.scene:3:25
  |
3 |   sphere(at: spiral(u), raduis: size)
  |                         ^^^^^^ this name
  |
  = sphere takes: at, r, mat, name
  = called from bead(u: 0.25, i: 60) at spiral.scene:1:9
  = help: write `r`
";
        assert_eq!(plain(d.clone(), &s), expected);
        assert_eq!(print(&[d.clone(), d.clone()], &s, Look::Plain), format!("{expected}\n{expected}"));
        assert!(print(std::slice::from_ref(&d), &s, Look::Colored).contains("\x1b["));
        let mut said = d;
        said.labels[0].text = "did you mean `r`?".into();
        assert!(!plain(said, &s).contains("help"), "not said twice");
    }

    #[test]
    fn several_places_and_files() {
        let (mut s, f) = one("let a = 1\nlet b = 2\n\n\n\nlet a = 3\n");
        let g = s.add(Source { name: "tree.scene".into(), path: None, text: "export a".into() });
        let d = Diagnostic::warning("`a` is there twice")
            .at(Span::new(f, 27..28), "again")
            .at(Span::new(f, 4..5), "first")
            .at(Span::new(g, 7..8), "and here");
        let expected = "\
warning: `a` is there twice
 --> spiral.scene:6:5
  |
1 | let a = 1
  |     - first
...
6 | let a = 3
  |     ^ again
  |
 ::: tree.scene:1:8
  |
1 | export a
  |        - and here
";
        assert_eq!(plain(d, &s), expected);
    }

    #[test]
    fn without_a_place() {
        let d = Diagnostic::error("the file `a.scene` can't be read").note("there is no such file");
        assert_eq!(plain(d, &Sources::new()), "error: the file `a.scene` can't be read\n = there is no such file\n");
    }

    #[test]
    fn very_long_lines_are_cut() {
        let (s, f) = one(&format!("let x = \"{}\" + y", "abcdefghi ".repeat(100_000)));
        let far = plain(Diagnostic::error("there is no `y`").at(Span::new(f, 1_000_013..1_000_014), "this"), &s);
        assert!(far.contains("spiral.scene:1:1000014\n") && far.contains("abcdefghi \" + y\n"), "{far}");
        assert!(far.len() < 500, "{far}");
        let wide = plain(Diagnostic::error("m").at(Span::new(f, 8..1_000_010), "this"), &s);
        assert!(wide.contains(&format!("  |         {} this\n", "^".repeat(LONGEST_CARET))), "{wide}");
        assert!(wide.len() < 500, "{wide}");
        assert!(plain(Diagnostic::error("m".repeat(1_000_000)), &s).len() < 2 * LONGEST_TEXT);
    }

    #[test]
    fn tabs_line_ends_and_escapes() {
        let (s, f) = one("let a = 1\r\n\tlet b = \u{1b}[31m\tc\r\n");
        let text = plain(Diagnostic::error("no \u{1b}[31m").at(Span::new(f, 26..27), "here"), &s);
        assert!(text.contains("spiral.scene:2:16\n") && !text.contains('\u{1b}'), "{text:?}");
        assert!(text.lines().all(|l| l.trim_end() == l), "{text:?}");
    }

    #[test]
    fn no_span_is_too_wild() {
        for text in ["", "\n", "é", "a\n\né\n", "😀\r\n\tü", "\n\n\n"] {
            let (s, f) = one(text);
            for start in 0..=text.len() as u32 + 2 {
                for end in 0..=text.len() as u32 + 2 {
                    let d = Diagnostic::error("m").at(Span { file: f, start, end }, "a");
                    let both = d.clone().at(Span { file: f, start: end, end: u32::MAX }, "b");
                    assert!(plain(d, &s).starts_with("error: m\n --> spiral.scene:"));
                    plain(both, &s);
                }
            }
        }
    }

    #[test]
    fn sums() {
        let (e, w) = (Diagnostic::error("e"), Diagnostic::warning("w"));
        assert_eq!(summary(&[]), "");
        assert_eq!(summary(std::slice::from_ref(&e)), "1 error");
        assert_eq!(summary(&[e.clone(), w, e]), "2 errors, 1 warning");
    }
}
