//! From text to syntax tree: the pest grammar, statement by statement, so that every broken statement is reported.

use super::ast::*;
use super::limits::EXPRESSION_DEPTH;
use super::{scan, syntax};
use crate::diag::{Diagnostic, Diagnostics, FileId, Span};
use crate::scene::Color;
use ecow::EcoString;
use pest::Parser as _;
use pest::iterators::{Pair, Pairs};
use std::iter::Peekable;

#[derive(pest_derive::Parser)]
#[grammar = "../grammar/scene.pest"]
struct Grammar;

/// The edition of the language that this program speaks.
const EDITION: &str = "1";

/// Parses a whole file. Statements with errors are in the list too, so that their names aren't unknown later.
pub fn parse(file: FileId, text: &str) -> (Vec<Statement>, Diagnostics) {
    let (prepared, mut errors) = scan::prepare(file, text);
    let mut statements = Vec::new();
    for (i, piece) in prepared.statements.iter().enumerate() {
        let source = prepared.text.get(piece.range.clone()).unwrap_or("");
        let span = Span::new(file, piece.range.clone());
        if source.split_ascii_whitespace().next() == Some("rtdsl") && !piece.broken {
            errors.extend(check_edition(source, span, i == 0));
            continue;
        }
        let broken = || Statement { kind: StatementKind::Broken { name: bound_name(source) }, span };
        if piece.broken {
            statements.push(broken());
            continue;
        }
        match recover(file, source, piece.range.start, &mut errors) {
            Some(s) => statements.push(s),
            None => statements.push(broken()),
        }
    }
    (statements, errors)
}

/// Most bytes that are parsed again and again to find further mistakes in one statement.
const RECOVERY_BYTES: usize = 4 << 20;

/// Parses an outermost statement. One that is wrong within a block is left out of the block, and the rest tried again,
/// so that every broken statement of a block is reported.
fn recover(file: FileId, source: &str, offset: usize, errors: &mut Diagnostics) -> Option<Statement> {
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
        let again = spent <= RECOVERY_BYTES && !source.starts_with("import");
        let part = at.filter(|_| again).and_then(|at| scan::block_statement(&text, at))?;
        if part.is_empty() || text[part.clone()].trim().is_empty() {
            return None;
        }
        holes.push(Hole { at: offset + part.start, name: bound_name(&text[part.clone()]) });
        holes.sort_by_key(|h| h.at);
        text.to_mut().replace_range(part.clone(), &" ".repeat(part.len()));
    }
}

/// A broken statement that was left out of its block.
struct Hole {
    /// Where in the file it starts.
    at: usize,
    /// What it was to bind.
    name: Option<EcoString>,
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

/// The name that a broken statement was meant to bind.
fn bound_name(source: &str) -> Option<EcoString> {
    let mut words = source.split(|c: char| !(c == '_' || c.is_alphanumeric())).filter(|w| !w.is_empty());
    let mut first = words.next()?;
    if first == "export" {
        first = words.next()?;
    }
    matches!(first, "let" | "var" | "fn" | "param").then(|| words.next().map(EcoString::from)).flatten()
}

type Parsed<T> = Result<T, Diagnostic>;

struct Builder<'a> {
    file: FileId,
    offset: usize,
    /// In the order of the text.
    holes: &'a [Hole],
}

impl Builder<'_> {
    fn span(&self, pair: &Pair<'_, Rule>) -> Span {
        let s = pair.as_span();
        Span::new(self.file, self.offset + s.start()..self.offset + s.end())
    }

    fn ident(&self, pair: &Pair<'_, Rule>) -> Ident {
        Ident { name: pair.as_str().into(), span: self.span(pair) }
    }

    fn statement(&mut self, pair: Pair<'_, Rule>) -> Parsed<Statement> {
        let span = trimmed(self.span(&pair), pair.as_str());
        let rule = pair.as_rule();
        if rule == Rule::expr {
            return Ok(Statement { kind: StatementKind::Expr(self.expr(pair)?), span });
        }
        let mut parts = Parts::of(pair);
        let kind = match rule {
            Rule::let_ => {
                let name = self.ident(&parts.next()?);
                StatementKind::Let { name, value: self.expr(parts.next()?)?, export: false }
            }
            Rule::var_ => {
                let name = self.ident(&parts.next()?);
                StatementKind::Var { name, value: self.expr(parts.next()?)? }
            }
            Rule::assign => {
                let name = self.ident(&parts.next()?);
                let op = parts.next()?;
                StatementKind::Assign {
                    name,
                    op: Op::from_symbol(op.as_str().trim_end_matches('=')),
                    op_span: self.span(&op),
                    value: self.expr(parts.next()?)?,
                }
            }
            Rule::fn_ => {
                let name = self.ident(&parts.next()?);
                let params = self.params(parts.next()?)?;
                let body = self.block_or_expr(parts.next()?)?;
                StatementKind::Fn { name, function: Function { params, body }, export: false }
            }
            Rule::while_ => {
                let condition = self.expr(parts.next()?)?;
                StatementKind::While { condition, body: self.block(parts.next()?)? }
            }
            Rule::export => {
                let mut inner = self.statement(parts.next()?)?;
                match &mut inner.kind {
                    StatementKind::Let { export, .. } | StatementKind::Fn { export, .. } => *export = true,
                    _ => {}
                }
                inner.kind
            }
            Rule::import => self.import(parts)?,
            Rule::param => self.param(parts)?,
            _ => return Err(Diagnostic::error("this isn't a statement").at(span, "")),
        };
        Ok(Statement { kind, span })
    }

    fn import(&mut self, mut parts: Parts<'_>) -> Parsed<StatementKind> {
        let pair = parts.next()?;
        let path = Path { span: self.span(&pair), text: self.plain_text(pair)? };
        let names = parts.next()?;
        let names = if names.as_rule() == Rule::ident {
            ImportNames::Module(self.ident(&names))
        } else {
            let mut some = Vec::new();
            for item in Parts::of(names) {
                let mut ids = Parts::of(item);
                let there = self.ident(&ids.next()?);
                let here = ids.maybe().map_or_else(|| there.clone(), |p| self.ident(&p));
                some.push((there, here));
            }
            ImportNames::Some(some)
        };
        Ok(StatementKind::Import { path, names })
    }

    fn param(&mut self, mut parts: Parts<'_>) -> Parsed<StatementKind> {
        let name = self.ident(&parts.next()?);
        let default = self.expr(parts.next()?)?;
        let (mut range, mut choices, mut description) = (None, None, None);
        while let Some(part) = parts.0.next() {
            match part.as_rule() {
                Rule::kw_in => range = Some(self.expr(parts.next()?)?),
                Rule::kw_of => choices = Some(self.expr(parts.next()?)?),
                _ => description = Some(self.plain_text(part)?),
            }
        }
        Ok(StatementKind::Param(Box::new(ParamStatement { name, default, range, choices, description })))
    }

    fn params(&mut self, pair: Pair<'_, Rule>) -> Parsed<Vec<ParamDecl>> {
        if pair.as_rule() == Rule::ident {
            return Ok(vec![ParamDecl { name: self.ident(&pair), default: None }]);
        }
        Parts::of(pair)
            .map(|decl| {
                let mut parts = Parts::of(decl);
                let name = self.ident(&parts.next()?);
                let default = parts.maybe().map(|p| self.expr(p)).transpose()?;
                Ok(ParamDecl { name, default })
            })
            .collect()
    }

    fn block(&mut self, pair: Pair<'_, Rule>) -> Parsed<Block> {
        let span = self.span(&pair);
        let mut statements = Parts::of(pair).map(|p| self.statement(p)).collect::<Parsed<Vec<_>>>()?;
        for hole in self.holes.iter().filter(|h| span.range().contains(&h.at)) {
            let within = |s: &Statement| s.span.range().contains(&hole.at);
            if !statements.iter().any(within) {
                let at = statements.partition_point(|s| s.span.start as usize <= hole.at);
                let kind = StatementKind::Broken { name: hole.name.clone() };
                statements.insert(at, Statement { kind, span: Span::new(self.file, hole.at..hole.at) });
            }
        }
        Ok(Block { statements, span })
    }

    fn block_or_expr(&mut self, pair: Pair<'_, Rule>) -> Parsed<Expr> {
        if pair.as_rule() == Rule::block {
            let span = self.span(&pair);
            let block = self.block(pair)?;
            self.make(span, block_depth(&block), ExprKind::Block(block))
        } else {
            self.expr(pair)
        }
    }

    fn args(&mut self, pair: Pair<'_, Rule>) -> Parsed<Vec<Arg>> {
        Parts::of(pair)
            .map(|arg| {
                let mut parts = Parts::of(arg);
                let first = parts.next()?;
                if first.as_rule() == Rule::ident {
                    let name = Some(self.ident(&first));
                    Ok(Arg { name, value: self.expr(parts.next()?)? })
                } else {
                    Ok(Arg { name: None, value: self.expr(first)? })
                }
            })
            .collect()
    }

    fn make(&self, span: Span, inner: u32, kind: ExprKind) -> Parsed<Expr> {
        if inner >= EXPRESSION_DEPTH {
            return Err(Diagnostic::error(format!("this expression is nested more than {EXPRESSION_DEPTH} deep"))
                .at(span, "")
                .note("give parts of it names with `let`, or add up a list with a loop"));
        }
        Ok(Expr { kind, span, depth: inner + 1 })
    }

    fn expr(&mut self, pair: Pair<'_, Rule>) -> Parsed<Expr> {
        let mut parts = pair.into_inner().peekable();
        self.climb(&mut parts, 0, 0)
    }

    /// Precedence climbing over the flat list: operators at least as strong as `least`.
    fn climb(&mut self, parts: &mut Peekable<Pairs<'_, Rule>>, least: u32, depth: u32) -> Parsed<Expr> {
        let mut a = self.prefixed(parts, depth)?;
        while let Some(op_pair) = parts.next_if(|p| p.as_rule() == Rule::operator && strength(p.as_str()) >= least) {
            let symbol = op_pair.as_str();
            // `^` groups to the right, all others to the left.
            let next = strength(symbol) + if symbol == "^" { 0 } else { 1 };
            let b = self.climb(parts, next, depth + 1)?;
            let span = a.span.to(b.span);
            let inner = a.depth.max(b.depth);
            a = match Op::from_symbol(symbol) {
                Some(op) => self.make(span, inner, ExprKind::Binary { op, a: Box::new(a), b: Box::new(b) })?,
                None => self.pipe(a, b, inner, span)?,
            };
        }
        Ok(a)
    }

    fn pipe(&mut self, a: Expr, b: Expr, inner: u32, span: Span) -> Parsed<Expr> {
        let arg = Arg { name: None, value: a };
        let kind = match b.kind {
            ExprKind::Call { callee, mut args } => {
                args.insert(0, arg);
                ExprKind::Call { callee, args }
            }
            ExprKind::Name(_) | ExprKind::Field { .. } | ExprKind::Lambda(_) | ExprKind::Block(_) => {
                ExprKind::Call { callee: Box::new(b), args: vec![arg] }
            }
            _ => {
                return Err(Diagnostic::error("`|>` passes a value on to a function, and this isn't one")
                    .at(b.span, "expected a call such as `move([0, 1, 0])`"));
            }
        };
        self.make(span, inner, kind)
    }

    fn prefixed(&mut self, parts: &mut Peekable<Pairs<'_, Rule>>, depth: u32) -> Parsed<Expr> {
        let Some(pair) = parts.next() else {
            return Err(Diagnostic::error("expected a value"));
        };
        let span = self.span(&pair);
        if depth >= EXPRESSION_DEPTH {
            return self.make(span, depth, ExprKind::Bool(false));
        }
        if pair.as_rule() != Rule::prefix {
            let primary = self.primary(pair)?;
            return self.postfixed(primary, parts);
        }
        // `-x^2` is -(x^2), `not a == b` is not (a == b).
        let minus = pair.as_str() == "-";
        let of = self.climb(parts, if minus { 9 } else { 4 }, depth + 1)?;
        let (span, inner) = (span.to(of.span), of.depth);
        match (minus, &of.kind) {
            (true, ExprKind::Number(v)) => self.make(span, 0, ExprKind::Number(-v)),
            (true, ExprKind::Angle(v)) => self.make(span, 0, ExprKind::Angle(-v)),
            (true, _) => self.make(span, inner, ExprKind::Negate(Box::new(of))),
            (false, _) => self.make(span, inner, ExprKind::Not(Box::new(of))),
        }
    }

    fn postfixed(&mut self, mut of: Expr, parts: &mut Peekable<Pairs<'_, Rule>>) -> Parsed<Expr> {
        while let Some(pair) = parts.next_if(|p| matches!(p.as_rule(), Rule::call | Rule::index | Rule::field)) {
            let span = of.span.to(trimmed(self.span(&pair), pair.as_str()));
            let rule = pair.as_rule();
            let depth = of.depth;
            of = match rule {
                Rule::call => {
                    let args = self.args(pair)?;
                    let inner = args.iter().map(|a| a.value.depth).fold(depth, u32::max);
                    self.make(span, inner, ExprKind::Call { callee: Box::new(of), args })?
                }
                Rule::index => {
                    let index = self.expr(Parts::of(pair).next()?)?;
                    self.make(
                        span,
                        depth.max(index.depth),
                        ExprKind::Index { of: Box::new(of), index: Box::new(index) },
                    )?
                }
                _ => {
                    let field = self.ident(&Parts::of(pair).next()?);
                    self.make(span, depth, ExprKind::Field { of: Box::new(of), field })?
                }
            };
        }
        Ok(of)
    }

    fn primary(&mut self, pair: Pair<'_, Rule>) -> Parsed<Expr> {
        let span = trimmed(self.span(&pair), pair.as_str());
        let text = pair.as_str();
        match pair.as_rule() {
            Rule::number => self.number(pair),
            Rule::color => {
                let kind = ExprKind::Color(parse_color(text).ok_or_else(|| bad_color(text, span))?);
                self.make(span, 0, kind)
            }
            Rule::text => {
                let parts = self.text_parts(pair)?;
                let inner =
                    parts.iter().map(|p| if let TextPart::Expr(e) = p { e.depth } else { 0 }).max().unwrap_or(0);
                self.make(span, inner, ExprKind::Text(parts))
            }
            Rule::true_ => self.make(span, 0, ExprKind::Bool(true)),
            Rule::false_ => self.make(span, 0, ExprKind::Bool(false)),
            Rule::name => self.make(span, 0, ExprKind::Name(text.trim().into())),
            Rule::paren => {
                let inner = self.expr(Parts::of(pair).next()?)?;
                Ok(Expr { span, ..inner })
            }
            Rule::list => {
                let items = Parts::of(pair).map(|p| self.expr(p)).collect::<Parsed<Vec<_>>>()?;
                self.make(span, items.iter().map(|e| e.depth).max().unwrap_or(0), ExprKind::List(items))
            }
            Rule::lambda => {
                let mut parts = Parts::of(pair);
                let params = self.params(parts.next()?)?;
                let body = self.expr(parts.next()?)?;
                self.make(span, 0, ExprKind::Lambda(Box::new(Function { params, body })))
            }
            Rule::block => {
                let block = self.block(pair)?;
                self.make(span, block_depth(&block), ExprKind::Block(block))
            }
            Rule::if_ => self.if_(pair, span),
            Rule::for_ => self.for_(pair, span),
            Rule::scene_block => {
                let mut parts = Parts::of(pair);
                parts.next()?; // the word: `group` is the only one
                let mut next = parts.next()?;
                let mut args = Vec::new();
                if next.as_rule() == Rule::call {
                    args = self.args(next)?;
                    next = parts.next()?;
                }
                let body = self.block(next)?;
                let inner = args.iter().map(|a| a.value.depth).fold(block_depth(&body), u32::max);
                self.make(span, inner, ExprKind::Group { args, body })
            }
            _ => Err(Diagnostic::error("this isn't a value").at(span, "")),
        }
    }

    fn if_(&mut self, pair: Pair<'_, Rule>, span: Span) -> Parsed<Expr> {
        let mut parts = Parts::of(pair);
        let (mut arms, mut otherwise) = (Vec::new(), None);
        while let Some(part) = parts.maybe() {
            if part.as_rule() == Rule::block {
                otherwise = Some(self.block(part)?);
            } else {
                let condition = self.expr(part)?;
                arms.push((condition, self.block(parts.next()?)?));
            }
        }
        let inner = arms
            .iter()
            .map(|(c, b)| c.depth.max(block_depth(b)))
            .chain(otherwise.as_ref().map(block_depth))
            .max()
            .unwrap_or(0);
        self.make(span, inner, ExprKind::If { arms, otherwise })
    }

    fn for_(&mut self, pair: Pair<'_, Rule>, span: Span) -> Parsed<Expr> {
        let mut parts = Parts::of(pair);
        let name = self.ident(&parts.next()?);
        let over = self.expr(parts.next()?)?;
        let mut next = parts.next()?;
        let mut guard = None;
        if next.as_rule() == Rule::expr {
            guard = Some(self.expr(next)?);
            next = parts.next()?;
        }
        let body = self.block(next)?;
        let inner = over.depth.max(guard.as_ref().map_or(0, |g| g.depth)).max(block_depth(&body));
        self.make(span, inner, ExprKind::For(Box::new(For { name, over, guard, body })))
    }

    fn number(&mut self, pair: Pair<'_, Rule>) -> Parsed<Expr> {
        let span = self.span(&pair);
        let mut parts = pair.into_inner();
        let digits = parts.next().map_or("", |p| p.as_str());
        let value: f64 = digits.replace('_', "").parse().unwrap_or(f64::INFINITY);
        if !value.is_finite() {
            return Err(Diagnostic::error("this number is too large").at(span, "the largest is about 1.8e308"));
        }
        let Some(unit) = parts.next() else {
            return self.make(span, 0, ExprKind::Number(value));
        };
        let kind = match unit.as_str() {
            "deg" => ExprKind::Angle(value),
            "turn" => ExprKind::Angle(value * 360.0),
            "rad" => ExprKind::Angle(value.to_degrees()),
            "%" => ExprKind::Number(value / 100.0),
            other => {
                let span = self.span(&unit);
                let d = Diagnostic::error(format!("`{other}` isn't a unit")).note("units are: deg, turn, rad and %");
                return Err(match super::suggest::nearest(other, ["deg", "turn", "rad"]) {
                    Some(best) => d.at(span, format!("did you mean `{best}`?")).fix(best),
                    None if other.starts_with(|c: char| c.is_alphabetic()) => {
                        d.at(span, "lengths have no unit; for a product write `*`")
                    }
                    None => d.at(span, ""),
                });
            }
        };
        self.make(span, 0, kind)
    }

    fn text_parts(&mut self, pair: Pair<'_, Rule>) -> Parsed<Vec<TextPart>> {
        let mut out = Vec::new();
        for part in pair.into_inner() {
            if part.as_rule() == Rule::interpolation {
                out.push(TextPart::Expr(self.expr(Parts::of(part).next()?)?));
            } else {
                out.push(TextPart::Literal(self.unescape(&part)?));
            }
        }
        Ok(out)
    }

    fn unescape(&self, part: &Pair<'_, Rule>) -> Parsed<EcoString> {
        let mut out = EcoString::new();
        let mut chars = part.as_str().char_indices();
        while let Some((at, c)) = chars.next() {
            if c != '\\' {
                out.push(c);
                continue;
            }
            match chars.next().map(|(_, c)| c) {
                Some('n') => out.push('\n'),
                Some('t') => out.push('\t'),
                Some(c @ ('"' | '\\' | '{' | '}')) => out.push(c),
                other => {
                    let start = self.offset + part.as_span().start() + at;
                    let len = 1 + other.map_or(0, char::len_utf8);
                    return Err(Diagnostic::error(format!("`\\{}` means nothing in a text", other.unwrap_or(' ')))
                        .at(Span::new(self.file, start..start + len), "for a backslash write `\\\\`")
                        .note("a text knows: \\n \\t \\\" \\\\ \\{ \\}"));
                }
            }
        }
        Ok(out)
    }

    /// A text without `{…}`: a path, a description.
    fn plain_text(&mut self, pair: Pair<'_, Rule>) -> Parsed<EcoString> {
        let span = self.span(&pair);
        let mut out = EcoString::new();
        for part in self.text_parts(pair)? {
            match part {
                TextPart::Literal(s) => out.push_str(&s),
                TextPart::Expr(_) => return Err(Diagnostic::error("this text must be plain").at(span, "no `{…}` here")),
            }
        }
        Ok(out)
    }
}

/// The parts of a pair that carry meaning: keywords and punctuation left out.
struct Parts<'a>(Pairs<'a, Rule>);

impl<'a> Parts<'a> {
    fn of(pair: Pair<'a, Rule>) -> Parts<'a> {
        Parts(pair.into_inner())
    }
    fn next(&mut self) -> Parsed<Pair<'a, Rule>> {
        self.maybe().ok_or_else(|| Diagnostic::error("this statement is incomplete"))
    }
    fn maybe(&mut self) -> Option<Pair<'a, Rule>> {
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

fn strength(symbol: &str) -> u32 {
    Op::from_symbol(symbol).map_or(1, Op::strength)
}

/// The grammar's rules may take blanks after them; an error's caret shouldn't.
fn trimmed(span: Span, text: &str) -> Span {
    Span { end: span.start + text.trim_end().len() as u32, ..span }
}

fn block_depth(block: &Block) -> u32 {
    block
        .statements
        .iter()
        .map(|s| match &s.kind {
            StatementKind::Let { value, .. }
            | StatementKind::Var { value, .. }
            | StatementKind::Assign { value, .. } => value.depth,
            StatementKind::Expr(e) => e.depth,
            StatementKind::While { condition, body } => condition.depth.max(block_depth(body)),
            StatementKind::Fn { .. }
            | StatementKind::Import { .. }
            | StatementKind::Param(_)
            | StatementKind::Broken { .. } => 0,
        })
        .max()
        .unwrap_or(0)
        + 1
}

fn parse_color(text: &str) -> Option<Color> {
    let digits: Vec<u8> =
        text.strip_prefix('#')?.chars().map(|c| c.to_digit(16).map(|d| d as u8)).collect::<Option<_>>()?;
    match digits[..] {
        [r, g, b] => Some(Color::from_srgb8([r * 17, g * 17, b * 17])),
        [r1, r0, g1, g0, b1, b0] => Some(Color::from_srgb8([r1 * 16 + r0, g1 * 16 + g0, b1 * 16 + b0])),
        _ => None,
    }
}

fn bad_color(text: &str, span: Span) -> Diagnostic {
    Diagnostic::error(format!("`{text}` isn't a color"))
        .at(span, "expected 3 or 6 digits from 0 to f")
        .note("as in `#f80` or `#ff8800`")
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
        parse(FileId(0), text).1.into_iter().map(|d| d.message).collect()
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
