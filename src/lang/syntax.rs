//! Syntax errors in the language's words: what was expected, and what stands there instead.

use super::expected::expectations;
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
    let rest = piece.get(at..).unwrap_or("");
    let before = piece.get(..at).unwrap_or("").trim_end();
    let ErrorVariant::ParsingError { positives, .. } = &error.variant else {
        let span = Span::new(file, offset + at..offset + at);
        return Diagnostic::error("this statement is too deeply nested").at(span, "give inner parts names with `let`");
    };
    let last_word = before.rsplit(|c: char| !(c.is_alphanumeric() || c == '_')).next().unwrap_or("");
    let expected = expectations(positives);
    // In brackets a line's end is a blank: a `;` there was written.
    let semicolon = rest.starts_with(';') && expected.iter().any(|e| e.ends_with("`)`") || e.ends_with("`]`"));
    let found = if semicolon { ";" } else { token(rest) };
    let e = Unexpected { file, offset, at, before, last_word, found, rest, expected };
    e.sign().or_else(|| e.number()).or_else(|| e.word()).or_else(|| e.form()).unwrap_or_else(|| e.plain())
}

/// Where the grammar couldn't go on.
struct Unexpected<'a> {
    file: FileId,
    /// Where the statement starts in the file.
    offset: usize,
    /// Where in the statement it couldn't go on.
    at: usize,
    /// What stands before, blanks at the end left out.
    before: &'a str,
    /// The word that `before` ends with; may be empty.
    last_word: &'a str,
    /// What stands there; empty at the end of a statement.
    found: &'a str,
    rest: &'a str,
    /// What could stand there, in words.
    expected: Vec<String>,
}

impl Unexpected<'_> {
    /// From byte `from` to byte `to` of the statement.
    fn span(&self, from: usize, to: usize) -> Span {
        Span::new(self.file, self.offset + from..self.offset + to)
    }
    fn here(&self) -> Span {
        self.span(self.at, self.at + self.found.len())
    }
    fn expects(&self, what: &str) -> bool {
        self.expected.iter().any(|e| e.contains(what))
    }
    /// The word that the statement starts with.
    fn first_word(&self) -> &str {
        let text = if self.before.is_empty() { self.rest } else { self.before };
        token(text)
    }
    /// An error at what was found.
    fn error(&self, message: impl Into<String>, label: impl Into<String>) -> Diagnostic {
        Diagnostic::error(message).at(self.here(), label)
    }

    /// Signs that other languages have.
    fn sign(&self) -> Option<Diagnostic> {
        let adjacent = self.before.len() == self.at;
        // Of a foreign operator of two signs the first may have been taken for one of ours.
        for (sign, meant, label) in [
            ("&&", "and", "write `and`"),
            ("||", "or", "write `or`"),
            ("->", "=>", "write `=>`"),
            ("**", "^", "write `^`"),
            ("===", "==", "write `==`"),
            ("<>", "!=", "write `!=`"),
            (":=", "=", "write `=`"),
            ("++", "+= 1", "write `+= 1`"),
            ("--", "-= 1", "write `-= 1`"),
        ] {
            let split = (1..sign.len())
                .rev()
                .find(|n| adjacent && self.before.ends_with(&sign[..*n]) && self.rest.starts_with(&sign[*n..]));
            let ends = sign == "--" && self.found.is_empty() && self.before.ends_with(sign);
            let start = match split {
                _ if ends => self.before.len() - sign.len(),
                Some(n) => self.at - n,
                None if self.rest.starts_with(sign) => self.at,
                None => continue,
            };
            let here = self.span(start, start + sign.len());
            return Some(Diagnostic::error(format!("`{sign}` isn't an operator")).at(here, label).fix(meant));
        }
        // Alone, a `#` is the comment of other languages.
        let hash = match self.before.strip_suffix('#') {
            Some(before) if !adjacent => Some(before.len()),
            _ => self.rest.starts_with("# ").then_some(self.at),
        };
        if let Some(start) = hash {
            let here = self.span(start, start + 1);
            return Some(Diagnostic::error("`#` starts a color, not a comment").at(here, "write `//`").fix("//"));
        }
        let first = self.rest.chars().next()?;
        Some(match first {
            '!' => self.error("`!` isn't an operator", "write `not`").fix("not "),
            '&' => self
                .error("`&` isn't an operator", "between conditions write `and`")
                .note("shapes are put together in a `group { … }`"),
            '|' if !self.rest.starts_with("|>") => self
                .error("`|` isn't an operator", "between conditions write `or`")
                .note("shapes are put together in a `group { … }`"),
            '?' => self
                .error("`?` isn't an operator", "write `if condition { … } else { … }`")
                .note("an `if` has a value: `let a = if b > 1 { 2 } else { 3 }`"),
            '°' => self.error("`°` isn't a unit", "write `deg`").fix("deg").note("units are: deg, turn, rad and %"),
            '“' | '”' | '„' | '‘' | '’' | '\'' | '`' | '«' | '»' => {
                let here = self.span(self.at, self.at + first.len_utf8());
                Diagnostic::error("a text stands in straight double quotes")
                    .at(here, "write `\"`")
                    .note("as in `\"ball\"`")
            }
            '<' if self.expects("a value") => {
                self.error("expected a value, found `<`", "a list of numbers stands in `[ ]`").note("as in `[0, 1, 0]`")
            }
            '@' | '$' | '~' | '\\' | '×' | '·' | '÷' | '−' | '≤' | '≥' | '≠' | '…' | '→' => {
                let meant = match first {
                    '×' | '·' => "write `*`",
                    '÷' => "write `/`",
                    '−' => "write `-`",
                    '≤' => "write `<=`",
                    '≥' => "write `>=`",
                    '≠' => "write `!=`",
                    '→' => "write `=>`",
                    '…' => "write `..`",
                    _ => "it means nothing here",
                };
                let here = self.span(self.at, self.at + first.len_utf8());
                Diagnostic::error(format!("`{first}` isn't a sign of the language")).at(here, meant)
            }
            _ => return None,
        })
    }

    /// Numbers that aren't.
    fn number(&self) -> Option<Diagnostic> {
        let start = self.before.rfind(|c: char| !(c.is_ascii_digit() || c == '.')).map_or(0, |k| k + 1);
        let digits = self.before.get(start..).filter(|d| d.starts_with(|c: char| c.is_ascii_digit()))?;
        if let Some(whole) = digits.strip_suffix('.')
            && !whole.contains('.')
        {
            let d = Diagnostic::error("a number doesn't end with a point");
            return Some(d.at(self.span(start, self.before.len()), format!("write `{whole}`")).fix(whole));
        }
        let more = self.rest.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(self.rest.len());
        if !self.rest.starts_with('.') || more < 2 || self.before.len() != self.at {
            return None;
        }
        let number = format!("{digits}{}", &self.rest[..more]);
        let d = Diagnostic::error(format!("`{number}` isn't a number"));
        Some(d.at(self.span(start, self.at + more), "a number has one point at most"))
    }

    /// Words where others belong.
    fn word(&self) -> Option<Diagnostic> {
        if KEYWORDS.contains(&self.found) && self.expects("a name") {
            let message = format!("`{}` is a word of the language and can't be a name", self.found);
            return Some(self.error(message, "choose another name"));
        }
        if matches!(self.found, "elif" | "elsif" | "elseif" | "elseIf") {
            let message = format!("`{}` isn't a word of the language", self.found);
            return Some(self.error(message, "write `else if`").fix("else if"));
        }
        // A misspelt or foreign keyword before a name: `lett a = 1`, `def f(x)`.
        let word = self.last_word;
        let starts = self.found.starts_with(|c: char| c.is_alphanumeric() || c == '_' || c == '"' || c == '#');
        if !starts || self.before != word || word.is_empty() || KEYWORDS.contains(&word) {
            return None;
        }
        let here = self.span(self.before.len() - word.len(), self.before.len());
        let wrong = |label: String| Diagnostic::error(format!("`{word}` doesn't start a statement")).at(here, label);
        let meant = match word {
            "return" => {
                return Some(wrong("leave it out".into()).fix("").note("the last line of a block is its value"));
            }
            "const" | "val" | "define" | "declare" | "set" | "auto" | "float" | "int" | "double" => Some("let"),
            "def" | "func" | "function" | "proc" | "macro" => Some("fn"),
            "mut" | "local" => Some("var"),
            "foreach" => Some("for"),
            "include" | "use" | "require" | "from" => Some("import"),
            _ => nearest(word, KEYWORDS),
        };
        meant.map(|meant| wrong(format!("did you mean `{meant}`?")).fix(meant))
    }

    /// Statements and calls that have the wrong form.
    fn form(&self) -> Option<Diagnostic> {
        let (found, before) = (self.found, self.before);
        let as_in = |d: Diagnostic, example: &str| d.note(format!("as in `{example}`"));
        match self.first_word() {
            "import" => {
                let example = "import \"tree.scene\" as tree` or `import \"tree.scene\" { oak }";
                return Some(as_in(self.plain(), example));
            }
            "param" if found == "=" => {
                return Some(self.error("the default of a parameter is written with `:`", "write `:`").fix(":"));
            }
            "param" if self.expects("a name") || self.expects("`:`") => {
                return Some(as_in(self.plain(), "param count: 5 in 1..=9 \"how many\""));
            }
            "export" if self.expects("`let`") => {
                return Some(as_in(self.plain(), "export let oak = …").note("only what has a name can be exported"));
            }
            "fn" if self.expects("parameters") => return Some(as_in(self.plain(), "fn double(x) = 2 * x")),
            _ => {}
        }
        if let Some(d) = self.several_names() {
            return Some(d);
        }
        if self.last_word == "for" || self.expects("`in`") {
            let d = if found == "=" { self.error("expected `in`, found `=`", "write `in`") } else { self.plain() };
            return Some(as_in(d, "for i in 0..10 { … }"));
        }
        if found == "=" {
            let name = before.strip_suffix(self.last_word).unwrap_or("").trim_end();
            let argument = !self.last_word.is_empty() && name.ends_with(['(', ',']);
            if let Some(d) = self.part_assigned() {
                return Some(d);
            }
            return Some(match argument {
                true => as_in(
                    self.error("a named argument is written with `:`", "write `:`").fix(":"),
                    &format!("{}: 1", self.last_word),
                ),
                false => self
                    .error(
                        "`=` doesn't compare, and binds a name only where a statement starts",
                        "to compare, write `==`",
                    )
                    .fix("=="),
            });
        }
        if found == "," && before.ends_with(',') {
            return Some(self.error("there is nothing between these commas", "one `,` is enough").fix(""));
        }
        if let Some(name) = before.strip_suffix(':').map(str::trim_end)
            && self.expects("a value")
        {
            let name = name.rsplit(|c: char| !(c.is_alphanumeric() || c == '_')).next().unwrap_or("");
            return Some(self.error(format!("`{name}` is given no value"), format!("found {}", shown(found))));
        }
        if let Some(d) = self.trailing_if() {
            return Some(d);
        }
        if found.is_empty() && before.ends_with(['+', '-', '*', '/', '^', '=', '<', '>']) {
            return Some(self.error("expected a value, but the statement ends here", ""));
        }
        if !self.expects("the end of the statement") {
            return None;
        }
        if found == "{" {
            let word = self.last_word;
            let collects = matches!(word, "union" | "difference" | "intersection" | "merge" | "object");
            let d = self.error(format!("`{word}` doesn't take a block"), "");
            return Some(match () {
                () if collects => d.note("`group { … }` is the block that collects shapes"),
                () if word.is_empty() => return None,
                () => d.note(format!("values go in round brackets: `{word}(…)`")),
            });
        }
        let starts = |c: char| c.is_alphanumeric() || c == '_' || c == '"' || c == '#';
        if found.starts_with(starts) && !matches!(found, "in" | "as" | "of" | "else") {
            return Some(
                self.error("two statements on one line", "the second one starts here")
                    .note("give it a line of its own, or put a `;` between them"),
            );
        }
        None
    }

    /// `m.color = red`, where a statement starts.
    fn part_assigned(&self) -> Option<Diagnostic> {
        let path = self.before.rsplit(|c: char| !(c.is_alphanumeric() || c == '_' || c == '.')).next()?;
        let lead = self.before.strip_suffix(path)?.trim_end();
        let (of, part) = path.rsplit_once('.').filter(|(of, _)| !of.is_empty())?;
        if !(lead.is_empty() || lead.ends_with(['{', ';'])) {
            return None;
        }
        let d = self.error("`=` can't change a part of a value", format!("write `{of}.with({part}: …)`"));
        Some(d.note(format!("it gives a changed copy: `let changed = {of}.with({part}: …)`")))
    }

    /// `for i, x in …` and `let (x, z) = …`.
    fn several_names(&self) -> Option<Diagnostic> {
        let opens = matches!(self.found, "(" | "[" | "{") && self.expects("a name");
        // `for (let i = 0; …)` is another mistake.
        let names = self.rest.split_once([')', ']']).is_some_and(|(names, _)| !names.contains('='));
        match self.last_word {
            "let" | "var" if opens => Some(
                self.error(format!("`{}` binds one name", self.last_word), "several can't be bound at once")
                    .note("give the list a name and take its items: `let p = …`, then `p[0]` and `p[1]`"),
            ),
            last if (last == "for" && opens && names) || (self.found == "," && self.expects("`in`")) => Some(
                self.error("`for` binds one name", "several can't be bound at once")
                    .note("as in `for p in enumerate(xs) { … p[0] … p[1] … }`: the position and the value there"),
            ),
            _ => None,
        }
    }

    /// `a if c else b`.
    fn trailing_if(&self) -> Option<Diagnostic> {
        if self.found != "if" || self.before.is_empty() {
            return None;
        }
        let (condition, _) = self.rest.strip_prefix("if")?.split_once(" else ")?;
        let condition = condition.trim();
        if condition.is_empty() || condition.contains(['{', ';']) {
            return None;
        }
        let d = self.error("an `if` starts with its condition", "the value of each case stands in `{ }`");
        Some(d.note(format!("as in `if {condition} {{ a }} else {{ b }}`")))
    }

    /// What was expected, and what stands there.
    fn plain(&self) -> Diagnostic {
        let shown = shown(self.found);
        let message = match &self.expected[..] {
            [] => format!("didn't expect {shown} here"),
            some => format!("expected {}, found {shown}", join_or(some)),
        };
        let value = self.found.starts_with(|c: char| c.is_alphanumeric() || "_\"#([".contains(c));
        let label = match () {
            () if self.expects("`,`") && value => "is a `,` missing before this?",
            () if self.expects("a block") && self.found.is_empty() => "the `{` goes on the same line",
            () => "",
        };
        let d = self.error(message, label);
        // `group` alone takes arguments before its block; shapes given so would be lost.
        if self.expects("a block") && self.first_word() == "group" {
            return d.note("as in `group { sphere(); box() }`");
        }
        d
    }
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
        other if other.chars().any(char::is_control) => "a character that can't be seen".into(),
        word if KEYWORDS.contains(&word) => format!("the word `{word}`"),
        other => format!("`{other}`"),
    }
}
