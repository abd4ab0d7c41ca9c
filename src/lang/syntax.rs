//! Syntax errors in the language's words: what was expected, and what stands there instead.

use super::parse::Rule;
use super::suggest::{join_or, nearest};
use crate::diag::{Diagnostic, FileId, Span};
use pest::error::{Error, ErrorVariant, InputLocation};

const KEYWORDS: [&str; 18] = [
    "let", "var", "fn", "param", "import", "export", "as", "for", "in", "while", "if", "else", "true", "false", "and",
    "or", "not", "group",
];

/// Puts the parser's error about `piece`, which starts at byte `offset` of `file`, into words.
pub fn explain(error: &Error<Rule>, file: FileId, piece: &str, offset: usize) -> Diagnostic {
    let at = match error.location {
        InputLocation::Pos(p) => p,
        InputLocation::Span((p, _)) => p,
    };
    let at = at.min(piece.len());
    let found = token(&piece[at..]);
    let span = Span::new(file, offset + at..offset + at + found.len());
    let ErrorVariant::ParsingError { positives, .. } = &error.variant else {
        return Diagnostic::error("this statement is too deeply nested").at(span, "give inner parts names with `let`");
    };
    let expected = expectations(positives);
    let shown = shown(found);
    if KEYWORDS.contains(&found) && expected.iter().any(|e| e == "a name") {
        return Diagnostic::error(format!("`{found}` is a word of the language and can't be a name"))
            .at(span, "choose another name");
    }
    let before = piece[..at].trim_end();
    if let Some(d) = special(before, found, span, piece, at, offset, file) {
        return d;
    }
    let message = match &expected[..] {
        [] => format!("didn't expect {shown} here"),
        some => format!("expected {}, found {shown}", join_or(some)),
    };
    Diagnostic::error(message).at(span, "")
}

/// Mistakes that have a name of their own.
fn special(
    before: &str,
    found: &str,
    span: Span,
    piece: &str,
    at: usize,
    offset: usize,
    file: FileId,
) -> Option<Diagnostic> {
    let last_word = before.rsplit(|c: char| !(c.is_alphanumeric() || c == '_')).next().unwrap_or("");
    let word_span = Span::new(file, offset + before.len() - last_word.len()..offset + before.len());
    if found.starts_with('&') && piece[at..].starts_with("&&") {
        let span = Span { end: span.start + 2, ..span };
        return Some(Diagnostic::error("`&&` isn't an operator").at(span, "write `and`").fix("and"));
    }
    if piece[at..].starts_with("||") {
        let span = Span { end: span.start + 2, ..span };
        return Some(Diagnostic::error("`||` isn't an operator").at(span, "write `or`").fix("or"));
    }
    if found == "!" {
        return Some(Diagnostic::error("`!` isn't an operator").at(span, "write `not`").fix("not "));
    }
    if found == "=" && !matches!(last_word, "let" | "var" | "fn" | "") && before.contains('(') {
        return Some(
            Diagnostic::error("a named argument is written with `:`")
                .at(span, "write `:`")
                .fix(":")
                .note(format!("as in `{last_word}: 1`")),
        );
    }
    if found.is_empty() && before.ends_with(['+', '-', '*', '/', '^', '=', '<', '>']) {
        return Some(Diagnostic::error("expected a value, but the statement ends here").at(span, ""));
    }
    // A misspelt or foreign keyword before a name: `lett a = 1`, `def f(x)`.
    let starts = before == last_word
        && !KEYWORDS.contains(&last_word)
        && found.chars().next().is_some_and(|c| c.is_alphabetic() || c == '_');
    if starts && !last_word.is_empty() {
        let meant = match last_word {
            "const" | "val" | "define" | "declare" => Some("let"),
            "def" | "func" | "function" | "proc" | "macro" => Some("fn"),
            "mut" | "local" => Some("var"),
            _ => nearest(last_word, KEYWORDS),
        };
        if let Some(meant) = meant {
            return Some(
                Diagnostic::error(format!("`{last_word}` doesn't start a statement"))
                    .at(word_span, format!("did you mean `{meant}`?"))
                    .fix(meant),
            );
        }
    }
    None
}

/// The first token of `rest`, for messages.
fn token(rest: &str) -> &str {
    let mut chars = rest.chars();
    let Some(first) = chars.next() else { return "" };
    if first == ';' {
        return "";
    }
    if first == '_' || first.is_alphanumeric() {
        let end = rest.find(|c: char| !(c == '_' || c.is_alphanumeric())).unwrap_or(rest.len());
        return &rest[..end];
    }
    let end = if "=<>!&|+-*/.".contains(first) {
        rest.find(|c: char| !"=<>&|".contains(c)).filter(|n| *n > 0).unwrap_or(first.len_utf8())
    } else {
        first.len_utf8()
    };
    &rest[..end]
}

fn shown(found: &str) -> String {
    match found {
        "" => "the end of the statement".into(),
        "\"" => "a text".into(),
        word if KEYWORDS.contains(&word) => format!("the word `{word}`"),
        other => format!("`{other}`"),
    }
}

/// What could have stood there, in words; the most telling ones only.
fn expectations(rules: &[Rule]) -> Vec<String> {
    let has = |r: Rule| rules.contains(&r);
    let closers: Vec<String> = [
        (Rule::comma, "`,`"),
        (Rule::close_paren, "a closing `)`"),
        (Rule::close_bracket, "a closing `]`"),
        (Rule::close_brace, "a closing `}`"),
    ]
    .into_iter()
    .filter(|(r, _)| has(*r))
    .map(|(_, w)| w.to_owned())
    .collect();
    let value = [Rule::expr, Rule::true_, Rule::prefix, Rule::color, Rule::digits].into_iter().any(has);
    let mut out = Vec::new();
    if value {
        out.push("a value".to_owned());
        if !has(Rule::comma) {
            out.extend(closers);
        }
        return out;
    }
    let others = [
        (Rule::ident, "a name"),
        (Rule::equals, "`=`"),
        (Rule::colon, "`:`"),
        (Rule::kw_let, "`let`"),
        (Rule::kw_fn, "`fn`"),
        (Rule::kw_in, "`in`"),
        (Rule::kw_as, "`as`"),
        (Rule::params, "parameters in `( )`"),
        (Rule::block, "a block in `{ }`"),
        (Rule::import_names, "names in `{ }`"),
        (Rule::text, "a text in quotes"),
    ];
    out.extend(others.into_iter().filter(|(r, _)| has(*r)).map(|(_, w)| w.to_owned()));
    out.extend(closers);
    if has(Rule::open_brace) && !out.iter().any(|w| w.contains("{ }")) {
        out.push("a block in `{ }`".into());
    }
    if out.is_empty() && (has(Rule::operator) || has(Rule::arrow)) {
        out.push("an operator or the end of the statement".into());
    }
    out
}
