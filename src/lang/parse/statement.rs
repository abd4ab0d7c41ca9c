//! Statements, blocks, parameters and arguments.

use super::Rule;
use super::builder::{Builder, Parsed, Parts, trimmed};
use super::expr::block_depth;
use crate::diag::{Diagnostic, Span};
use crate::lang::ast::*;
use pest::iterators::Pair;

impl Builder<'_> {
    pub(super) fn statement(&mut self, pair: Pair<'_, Rule>) -> Parsed<Statement> {
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

    pub(super) fn import(&mut self, mut parts: Parts<'_>) -> Parsed<StatementKind> {
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

    pub(super) fn param(&mut self, mut parts: Parts<'_>) -> Parsed<StatementKind> {
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

    pub(super) fn params(&mut self, pair: Pair<'_, Rule>) -> Parsed<Vec<ParamDecl>> {
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

    pub(super) fn block(&mut self, pair: Pair<'_, Rule>) -> Parsed<Block> {
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

    pub(super) fn block_or_expr(&mut self, pair: Pair<'_, Rule>) -> Parsed<Expr> {
        if pair.as_rule() == Rule::block {
            let span = self.span(&pair);
            let block = self.block(pair)?;
            self.make(span, block_depth(&block), ExprKind::Block(block))
        } else {
            self.expr(pair)
        }
    }

    pub(super) fn args(&mut self, pair: Pair<'_, Rule>) -> Parsed<Vec<Arg>> {
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
}
