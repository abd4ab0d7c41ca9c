//! Expressions: operators by precedence climbing, then what they join.

use super::Rule;
use super::builder::{Builder, Parsed, Parts, trimmed};
use super::literal::{bad_color, parse_color};
use crate::diag::{Diagnostic, Span};
use crate::lang::ast::*;
use crate::lang::limits::EXPRESSION_DEPTH;
use pest::iterators::{Pair, Pairs};
use std::iter::Peekable;

impl Builder<'_> {
    pub(super) fn make(&self, span: Span, inner: u32, kind: ExprKind) -> Parsed<Expr> {
        if inner >= EXPRESSION_DEPTH {
            return Err(Diagnostic::error(format!("this expression is nested more than {EXPRESSION_DEPTH} deep"))
                .at(span, "")
                .note("give parts of it names with `let`, or add up a list with a loop"));
        }
        Ok(Expr { kind, span, depth: inner + 1 })
    }

    pub(super) fn expr(&mut self, pair: Pair<'_, Rule>) -> Parsed<Expr> {
        let mut parts = pair.into_inner().peekable();
        self.climb(&mut parts, 0, 0)
    }

    /// Precedence climbing over the flat list: operators at least as strong as `least`.
    pub(super) fn climb(&mut self, parts: &mut Peekable<Pairs<'_, Rule>>, least: u32, depth: u32) -> Parsed<Expr> {
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

    pub(super) fn pipe(&mut self, a: Expr, b: Expr, inner: u32, span: Span) -> Parsed<Expr> {
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

    pub(super) fn prefixed(&mut self, parts: &mut Peekable<Pairs<'_, Rule>>, depth: u32) -> Parsed<Expr> {
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

    pub(super) fn postfixed(&mut self, mut of: Expr, parts: &mut Peekable<Pairs<'_, Rule>>) -> Parsed<Expr> {
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

    pub(super) fn primary(&mut self, pair: Pair<'_, Rule>) -> Parsed<Expr> {
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

    pub(super) fn if_(&mut self, pair: Pair<'_, Rule>, span: Span) -> Parsed<Expr> {
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

    pub(super) fn for_(&mut self, pair: Pair<'_, Rule>, span: Span) -> Parsed<Expr> {
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
}

fn strength(symbol: &str) -> u32 {
    Op::from_symbol(symbol).map_or(1, Op::strength)
}

pub(super) fn block_depth(block: &Block) -> u32 {
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
