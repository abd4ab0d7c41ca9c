//! Names: what each means, or why it means nothing.

use super::Resolver;
use crate::diag::{Diagnostic, Span};
use crate::lang::ast::*;
use crate::lang::catalog;
use crate::lang::code::*;
use crate::lang::scope::{Access, Kind};
use crate::lang::suggest::{did_you_mean, nearest, nearest_word};
use crate::lang::value::{BuiltinId, Value};
use crate::lang::word::Run;

impl Resolver {
    pub(super) fn captured_var(&mut self, name: &Ident, bound: Span, what: &str) {
        self.errors.push(
            Diagnostic::error(format!("a function can't {what} the `var` `{}` outside it", name.name))
                .at(name.span, "")
                .at(bound, "bound here")
                .note("functions see only what never changes: bind it with `let`, or pass it as an argument"),
        );
    }

    /// The built-in word that an expression names, if nothing shadows it.
    pub(super) fn builtin(&mut self, e: &Expr) -> Option<BuiltinId> {
        match &e.kind {
            ExprKind::Name(name) => match self.scopes.find(name) {
                Some((_, b, crosses)) if b.declared || crosses => None,
                _ => catalog::find(name),
            },
            ExprKind::Field { of, field } if self.is_std(of) => catalog::find(&field.name),
            _ => None,
        }
    }

    pub(super) fn is_std(&mut self, e: &Expr) -> bool {
        matches!(&e.kind, ExprKind::Name(n) if n == "std") && self.scopes.find("std").is_none()
    }

    pub(super) fn module(&mut self, e: &Expr) -> Option<usize> {
        let ExprKind::Name(name) = &e.kind else { return None };
        match self.scopes.find(name)?.1.kind {
            Kind::Module(m) => Some(m),
            _ => None,
        }
    }

    pub(super) fn name(&mut self, ident: &Ident) -> Code {
        let level = self.scopes.levels.len();
        match self.scopes.find(&ident.name) {
            Some((_, b, _)) if b.kind == Kind::Broken => Code::Failed,
            Some((_, b, _)) if matches!(b.kind, Kind::Module(_)) => {
                let Kind::Module(m) = b.kind else { return Code::Failed };
                Code::Module(self.exports[m].names.iter().map(|e| (e.name.clone(), e.slot)).collect())
            }
            Some((_, b, true)) if b.kind == Kind::Var => {
                self.captured_var(ident, b.span, "use");
                Code::Failed
            }
            Some((access, b, _)) if b.declared || level > 1 => match access {
                Access::Local(i) => Code::Local(i),
                Access::Global(i) => Code::Global(i),
                Access::Capture(i) => Code::Capture(i),
                Access::Current => Code::Current,
            },
            later => self.builtin_value(ident, later.map(|(_, b, _)| b.span)),
        }
    }

    /// A name that nothing binds yet.
    pub(super) fn builtin_value(&mut self, ident: &Ident, later: Option<Span>) -> Code {
        if let Some(id) = catalog::find(&ident.name) {
            return self.word_value(id, ident.span);
        }
        let d = match later {
            Some(later) if self.binding.as_ref().is_some_and(|b| b.span == later) => self.of_itself(ident, later),
            Some(later) => Diagnostic::error(format!("`{}` is used before it has a value", ident.name))
                .at(ident.span, "")
                .at(later, "it gets one here")
                .note("move that line up"),
            None => self.unknown(ident, false),
        };
        self.errors.push(d);
        Code::Failed
    }

    pub(super) fn of_itself(&self, ident: &Ident, bound: Span) -> Diagnostic {
        Diagnostic::error(format!("the value of `{0}` is made of `{0}` itself", ident.name))
            .at(ident.span, "it has no value yet")
            .at(bound, "it is bound here")
            .note("a line that ends with an operator goes on in the next one")
    }

    /// A word that stands without a call.
    pub(super) fn word_value(&mut self, id: BuiltinId, span: Span) -> Code {
        let word = catalog::word(id);
        match word.run {
            Run::Constant(make) => Code::Const(make()),
            Run::Syntax => {
                self.errors.push(
                    Diagnostic::error(format!("`{}` must be called", word.name))
                        .at(span, format!("write `{}(…)`", word.name))
                        .note(format!("as in `{}`", word.example.lines().next().unwrap_or(""))),
                );
                Code::Failed
            }
            _ if word.sets_something() => {
                self.errors.push(
                    Diagnostic::error(format!("`{}` must be called", word.name))
                        .at(span, format!("write `{}(…)`", word.name))
                        .note(word.takes()),
                );
                Code::Failed
            }
            _ => Code::Const(Value::Builtin(id)),
        }
    }

    pub(super) fn unknown(&self, ident: &Ident, called: bool) -> Diagnostic {
        let name = &ident.name;
        let d = Diagnostic::error(format!("`{name}` is unknown"));
        if let Some(bound) = self.binding.as_ref().filter(|b| b.name == *name) {
            return self.of_itself(ident, bound.span);
        }
        if let Some((_, bound)) = self.ended.iter().rev().find(|(n, _)| n == name) {
            return Diagnostic::error(format!("`{name}` is unknown here"))
                .at(ident.span, "outside the block that binds it")
                .at(*bound, "it is bound here, for this block alone")
                .note("bind it before the block");
        }
        let words = || catalog::catalog().iter().map(|w| w.name);
        if let Some(best) = nearest_word(name, self.scopes.names(), words()) {
            return d.at(ident.span, did_you_mean(Some(best))).fix(best);
        }
        let d = d.at(ident.span, "nothing has this name");
        match called {
            true => d.note(format!("to make a function, write `fn {name}(…) = …`")),
            false => {
                d.note(format!("to give it a value, write `let {name} = …`; a text stands in quotes: `\"{name}\"`"))
            }
        }
    }

    pub(super) fn field(&mut self, of: &Expr, field: &Ident) -> Code {
        if self.is_std(of) {
            return match catalog::find(&field.name) {
                Some(id) => self.word_value(id, field.span),
                None => {
                    let best = nearest(&field.name, catalog::catalog().iter().map(|w| w.name));
                    self.errors.push(
                        Diagnostic::error(format!("`std` has no `{}`", field.name)).at(field.span, did_you_mean(best)),
                    );
                    Code::Failed
                }
            };
        }
        if let Some(m) = self.module(of) {
            return match self.export(m, field) {
                Some(e) if !e.broken => Code::Global(e.slot),
                _ => Code::Failed,
            };
        }
        let item = ["x", "y", "z"].iter().position(|axis| *axis == field.name).map(|i| i as u8);
        Code::Field { of: self.boxed(of), name: field.name.clone(), item }
    }
}
