//! From text to syntax tree: the pest grammar, statement by statement, so that every broken statement is reported.

mod builder;
mod expr;
pub mod like;
mod literal;
mod recover;
mod statement;

use super::ast::*;
use super::{scan, syntax};
use crate::diag::{Diagnostic, Diagnostics, FileId, Span};
use builder::Builder;
use like::{Like, Likenesses, Template};
use pest::Parser as _;
use recover::{bound_name, recover};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

#[derive(pest_derive::Parser)]
#[grammar = "../grammar/scene.pest"]
struct Grammar;

/// The edition of the language that this program speaks.
const EDITION: &str = "1";

/// A parsed file.
#[derive(Debug, Default)]
pub struct Parsed {
    /// Those with errors too, so that their names aren't unknown later.
    pub statements: Vec<Statement>,
    /// Further ones, in the order of the text.
    pub likes: Vec<Like>,
    /// What those are like, in the order of the text.
    pub templates: Vec<Template>,
    pub errors: Diagnostics,
}

/// Parses a whole file; only a part of it where `cancel` is set meanwhile.
pub fn parse(file: FileId, text: &str, cancel: &AtomicBool) -> Parsed {
    let (prepared, mut errors) = scan::prepare(file, text);
    let (mut statements, mut likes, mut templates) = (Vec::new(), Vec::new(), Vec::new());
    let mut likenesses = Likenesses::default();
    for (i, piece) in prepared.statements.iter().enumerate() {
        if cancel.load(Relaxed) {
            break;
        }
        let source = prepared.text.get(piece.range.clone()).unwrap_or("");
        let span = Span::new(file, piece.range.clone());
        if source.split_ascii_whitespace().next() == Some("rtdsl") && !piece.broken {
            errors.extend(check_edition(source, span, i == 0));
            continue;
        }
        let broken = || Statement { kind: StatementKind::Broken { name: bound_name(source) }, span };
        if piece.broken {
            likenesses.clear();
            statements.push(broken());
            continue;
        }
        // Where the two differ there are comments.
        let outline =
            text.get(piece.range.clone()).filter(|t| *t == source).and_then(|_| likenesses.look(text, source));
        if let Some((_, Some(template))) = outline {
            likes.push(Like { template, start: span.start, end: span.end });
            continue;
        }
        let before = errors.len();
        let statement = recover(file, source, piece.range.start, &mut errors, cancel).unwrap_or_else(broken);
        match (&statement.kind, outline) {
            (StatementKind::Expr(_), Some((outline, None))) if errors.len() == before => {
                likenesses.add(outline, templates.len() as u32, piece.range.clone());
                templates.push(Template { statement: statements.len(), range: piece.range.clone() });
            }
            (StatementKind::Expr(_), _) => {}
            _ => likenesses.clear(),
        }
        statements.push(statement);
    }
    Parsed { statements, likes, templates, errors }
}

/// Parses an outermost statement that was found to be like another: `text` is all of its file, without comments in `range`.
pub fn parse_like(file: FileId, text: &str, like: &Like, cancel: &AtomicBool) -> (Option<Statement>, Diagnostics) {
    let mut errors = Vec::new();
    let source = text.get(like.start as usize..like.end as usize).unwrap_or("");
    (recover(file, source, like.start as usize, &mut errors, cancel), errors)
}

/// Parses a single expression: a value of `--set`.
pub fn parse_expression(file: FileId, text: &str) -> Result<Expr, Diagnostic> {
    let (prepared, errors) = scan::prepare(file, text);
    if let Some(e) = errors.into_iter().next() {
        return Err(e);
    }
    let all = Span::new(file, 0..text.len());
    if prepared.statements.is_empty() {
        return Err(Diagnostic::error("a value is missing").at(Span { start: all.end, ..all }, "write one here"));
    }
    let [piece] = &prepared.statements[..] else {
        return Err(Diagnostic::error("expected one value").at(all, ""));
    };
    let source = prepared.text.get(piece.range.clone()).unwrap_or("");
    let mut pairs = Grammar::parse(Rule::one_expression, source)
        .map_err(|e| syntax::explain(&e, file, source, piece.range.start))?;
    let pair = pairs.next().ok_or_else(|| Diagnostic::error("expected a value").at(all, ""))?;
    Builder { file, offset: piece.range.start, holes: &[] }.expr(pair)
}

/// How many bytes at the start of `text` are one `rule`; `None` if it starts with something else. Takes time in proportion
/// to all of `text`.
pub fn length_of(rule: Rule, text: &str) -> Option<usize> {
    Grammar::parse(rule, text).ok().map(|pairs| pairs.as_str().len())
}

fn check_edition(source: &str, span: Span, first: bool) -> Option<Diagnostic> {
    let rest = source.trim_start_matches("rtdsl").trim();
    if !first {
        return Some(
            Diagnostic::error("the edition goes on the first line").at(span, "move this to the top of the file"),
        );
    }
    if rest == EDITION {
        return None;
    }
    Some(
        Diagnostic::error(format!("this program speaks edition {EDITION} of the language, not `{rest}`"))
            .at(span, "write `rtdsl 1`")
            .fix("rtdsl 1"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn expr(text: &str) -> Expr {
        parse_expression(FileId(0), text).unwrap_or_else(|e| panic!("{text}: {}", e.message))
    }
    /// Fully bracketed.
    fn show(e: &Expr) -> String {
        match &e.kind {
            ExprKind::Number(n) => n.to_string(),
            ExprKind::Angle(a) => format!("{a}deg"),
            ExprKind::Name(n) => n.to_string(),
            ExprKind::Negate(a) => format!("(- {})", show(a)),
            ExprKind::Not(a) => format!("(not {})", show(a)),
            ExprKind::Binary { op, a, b, .. } => format!("({} {} {})", show(a), op.symbol(), show(b)),
            ExprKind::Call { callee, args } => {
                format!("{}({})", show(callee), args.iter().map(|a| show(&a.value)).collect::<Vec<_>>().join(", "))
            }
            ExprKind::Field { of, field } => format!("{}.{}", show(of), field.name),
            ExprKind::Index { of, index } => format!("{}[{}]", show(of), show(index)),
            other => format!("{other:?}"),
        }
    }
    fn errors(text: &str) -> Vec<String> {
        parse(FileId(0), text, &AtomicBool::new(false)).errors.into_iter().map(|d| d.message).collect()
    }

    #[test]
    fn operators_bind_as_in_mathematics() {
        assert_eq!(show(&expr("1 + 2 * 3 ^ 2 ^ 2")), "(1 + (2 * (3 ^ (2 ^ 2))))");
        assert_eq!(show(&expr("-x ^ 2")), "(- (x ^ 2))");
        assert_eq!(show(&expr("2 ^ -x")), "(2 ^ (- x))");
        assert_eq!(show(&expr("a - b - c")), "((a - b) - c)");
        assert_eq!(show(&expr("not a == b and c")), "((not (a == b)) and c)");
        assert_eq!(show(&expr("0..n - 1")), "(0 .. (n - 1))");
        assert_eq!(show(&expr("a + b |> f(y) |> g")), "g(f((a + b), y))");
        assert_eq!(show(&expr("-a.x[1]")), "(- a.x[1])");
    }

    #[test]
    fn numbers_have_units() {
        assert_eq!(show(&expr("0.25turn")), "90deg");
        assert_eq!(show(&expr("1_000")), "1000");
        assert_eq!(show(&expr("1e-3")), "0.001");
        assert_eq!(show(&expr("50%")), "0.5");
        assert_eq!(show(&expr("10%3")), "(10 % 3)");
        assert_eq!(show(&expr("10 % 3")), "(10 % 3)");
        assert_eq!(show(&expr("50% * a")), "(0.5 * a)");
        assert_eq!(show(&expr(".5")), "0.5");
        assert_eq!(errors("a = 3cm"), ["`cm` isn't a unit"]);
    }

    #[test]
    fn every_broken_statement_is_reported() {
        let found = errors("let a = \nlet b = 2 +\nlet = 3\nf(a = 1)\nlett c = 1\nx && y\nlet for = 1");
        assert_eq!(found.len(), 7, "{found:#?}");
    }
}
