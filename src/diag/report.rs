//! Messages as data for other programs: `check --json`.

use super::{Diagnostic, Label, Severity, Sources};
use serde::Serialize;

/// One message with its places as lines and columns, both from 1, columns in characters; ends are exclusive.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// `"error"` or `"warning"`.
    pub severity: &'static str,
    /// The sentence.
    pub message: String,
    /// The main place; `None` where there is no text.
    #[serde(flatten)]
    pub place: Option<ReportPlace>,
    /// Every place, the main one first, with the words under its caret.
    pub labels: Vec<ReportLabel>,
    /// Lines of explanation.
    pub notes: Vec<String>,
    /// A replacement of the main place's text.
    pub fix: Option<String>,
    /// The calls that led here, innermost first.
    pub calls: Vec<String>,
}

/// A range of a text.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReportPlace {
    /// The text's name.
    pub file: String,
    /// Line of the first character.
    pub line: usize,
    /// Column of the first character.
    pub column: usize,
    /// Line of the end.
    pub end_line: usize,
    /// Column after the last character.
    pub end_column: usize,
    /// The same range in bytes, half-open.
    pub bytes: [u32; 2],
}

/// A range with words.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReportLabel {
    /// Where.
    #[serde(flatten)]
    pub place: ReportPlace,
    /// What stands under the caret; may be empty.
    pub text: String,
}

impl Report {
    /// `d` with its places looked up in `sources`.
    pub fn new(d: &Diagnostic, sources: &Sources) -> Report {
        let labels: Vec<ReportLabel> = d.labels.iter().map(|l| ReportLabel::new(l, sources)).collect();
        Report {
            severity: match d.severity {
                Severity::Error => "error",
                Severity::Warning => "warning",
            },
            message: d.message.clone(),
            place: labels.first().map(|l| l.place.clone()),
            labels,
            notes: d.notes.clone(),
            fix: d.fix.clone(),
            calls: d.place.as_ref().map_or(Vec::new(), |p| p.call_chain(sources)),
        }
    }
}

impl ReportLabel {
    fn new(label: &Label, sources: &Sources) -> ReportLabel {
        let span = label.span;
        let (line, column) = sources.line_column(span);
        let end = super::Span { start: span.end.max(span.start), ..span };
        let (end_line, end_column) = sources.line_column(end);
        ReportLabel {
            place: ReportPlace {
                file: sources.get(span.file).name.clone(),
                line,
                column,
                end_line,
                end_column,
                bytes: [span.start, end.start],
            },
            text: label.text.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diag::{Source, Span};

    #[test]
    fn places_are_flat() {
        let mut sources = Sources::new();
        let file = sources.add(Source { name: "a.scene".into(), path: None, text: "let é = 1\nlet b = x\n".into() });
        let d = Diagnostic::error("there is no `x`").at(Span::new(file, 19..20), "").fix("é");
        let json = serde_json::to_value(Report::new(&d, &sources)).unwrap();
        let place = serde_json::json!({
            "file": "a.scene", "line": 2, "column": 9, "end_line": 2, "end_column": 10, "bytes": [19, 20], "text": "",
        });
        assert_eq!(json["labels"], serde_json::json!([place]));
        assert_eq!(json["line"], 2);
        assert_eq!(json["severity"], "error");
        assert_eq!(json["fix"], "é");
        let nowhere = serde_json::to_value(Report::new(&Diagnostic::warning("w"), &sources)).unwrap();
        assert_eq!(nowhere.get("line"), None, "no place, no fields for it");
    }
}
