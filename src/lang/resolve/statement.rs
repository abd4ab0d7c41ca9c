//! Statements and blocks: what binds and changes names.

use super::{Mode, Resolver};
use crate::diag::{Diagnostic, Span};
use crate::lang::ast::*;
use crate::lang::code::*;
use crate::lang::formula::with_formula;
use crate::lang::scope::{Access, At, Kind};
use crate::lang::suggest::{did_you_mean, nearest};

impl Resolver {
    pub(super) fn top_statement(&mut self, s: &Statement) -> Option<TopStatement> {
        self.binds.clear();
        let mut for_scene = false;
        let node = match &s.kind {
            StatementKind::Broken { .. } | StatementKind::Import { .. } => return None,
            StatementKind::Let { name, value, .. } | StatementKind::Var { name, value } => {
                let value = self.bound_value(name, value);
                self.set_global(name, value, s.span)?
            }
            StatementKind::Param(p) => {
                let default = self.expr(&p.default, Mode::Value);
                let range = p.range.as_ref().map(|e| self.expr(e, Mode::Value));
                let choices = p.choices.as_ref().map(|e| self.expr(e, Mode::Value));
                let slot = self.global_slot(&p.name)?;
                let (name, name_span, description) = (p.name.name.clone(), p.name.span, p.description.clone());
                let code = ParamCode { slot, name, name_span, default, range, choices, description, main: self.main };
                Node { code: Code::Param(Box::new(code)), span: s.span }
            }
            StatementKind::Fn { name, function, .. } => {
                // Its slot is filled before anything runs; the top level has nothing to capture.
                let block = self.scopes.top().blocks.last();
                let id = block.and_then(|b| b.iter().find(|b| b.span == name.span)).map(|b| b.kind);
                if let Some(Kind::Function(id)) = id {
                    self.function(function, id, None);
                }
                return None;
            }
            StatementKind::Expr(e) => {
                for_scene = true;
                self.expr(e, Mode::Scene)
            }
            _ => self.statement(s, Mode::Scene),
        };
        Some(TopStatement { node, binds: std::mem::take(&mut self.binds), for_scene })
    }

    pub(super) fn global_slot(&mut self, name: &Ident) -> Option<u32> {
        let block = self.scopes.top().blocks.last_mut()?;
        let binding = block.iter_mut().find(|b| b.span == name.span)?;
        binding.declared = true;
        let At::Global(slot) = binding.at else { return None };
        self.binds.push(slot);
        Some(slot)
    }

    pub(super) fn set_global(&mut self, name: &Ident, value: Node, span: Span) -> Option<Node> {
        let slot = self.global_slot(name)?;
        Some(Node { code: Code::SetGlobal(slot, Box::new(value)), span })
    }

    /// The value of a `let` or `var`.
    pub(super) fn bound_value(&mut self, name: &Ident, value: &Expr) -> Node {
        let outer = self.binding.replace(name.clone());
        let value = self.expr(value, Mode::Value);
        self.binding = outer;
        value
    }

    /// Ends a block; what it bound is remembered, to explain why it isn't there any more.
    pub(super) fn leave(&mut self, mark: u32) {
        if let Some(block) = self.scopes.top().blocks.last() {
            self.ended.extend(block.iter().map(|b| (b.name.clone(), b.span)));
        }
        self.scopes.top().leave(mark);
    }

    pub(super) fn block(&mut self, block: &Block, mode: Mode) -> Node {
        let mark = self.scopes.top().enter();
        let last = block.statements.len().wrapping_sub(1);
        let mut nodes = Vec::with_capacity(block.statements.len());
        let mut before = self.errors.len();
        for (i, s) in block.statements.iter().enumerate() {
            before = self.errors.len();
            let mode = if i == last || mode == Mode::Scene { mode } else { Mode::Discard };
            nodes.push(self.statement(s, mode));
        }
        self.leave(mark);
        let last = block.statements.last().map(|s| &s.kind);
        if mode == Mode::Value && !matches!(last, Some(StatementKind::Expr(_) | StatementKind::Broken { .. })) {
            let (span, text) = match block.statements.last() {
                Some(s) => (s.span, "expected an expression after this"),
                None => (block.span, "it is empty"),
            };
            // Where the last line is wrong itself it may have been meant as the value.
            if self.errors.len() == before {
                self.errors.push(
                    Diagnostic::error("this block has no value")
                        .at(span, text)
                        .note("the last line of a block is its value"),
                );
            }
            nodes.push(Node { code: Code::Failed, span: block.span });
        }
        match (nodes.len(), nodes.pop()) {
            (1, Some(only)) => only,
            (_, last) => {
                nodes.extend(last);
                Node { code: Code::Block(nodes.into()), span: block.span }
            }
        }
    }

    pub(super) fn statement(&mut self, s: &Statement, mode: Mode) -> Node {
        let code = match &s.kind {
            StatementKind::Expr(e) => return self.expr(e, mode),
            StatementKind::Let { name, value, export } => {
                if *export {
                    self.only_at_top("export", s.span);
                }
                let value = self.bound_value(name, value);
                Code::SetLocal(self.bind_local(name, Kind::Let), Box::new(value))
            }
            StatementKind::Var { name, value } => {
                let value = self.bound_value(name, value);
                Code::SetLocal(self.bind_local(name, Kind::Var), Box::new(value))
            }
            StatementKind::Fn { name, function, export } => {
                if *export {
                    self.only_at_top("export", s.span);
                }
                let id = self.reserve(&name.name, function);
                let captures = self.function(function, id, Some(name));
                let slot = self.bind_local(name, Kind::Function(id));
                Code::SetLocal(slot, Box::new(Node { code: Code::Closure(id, captures), span: s.span }))
            }
            StatementKind::Assign { name, op, op_span, value } => self.assign(name, *op, *op_span, value),
            StatementKind::While { condition, body } => {
                let condition = self.expr(condition, Mode::Value);
                Code::While(Box::new((condition, self.block(body, Mode::Discard))))
            }
            StatementKind::Import { names, .. } => {
                match names {
                    ImportNames::Module(name) => self.bind(name, Kind::Broken, At::Local(0), true),
                    ImportNames::Some(names) => {
                        names.iter().for_each(|(_, here)| self.bind(here, Kind::Broken, At::Local(0), true));
                    }
                }
                self.only_at_top("import", s.span)
            }
            StatementKind::Param(p) => {
                self.bind(&p.name, Kind::Broken, At::Local(0), true);
                self.only_at_top("param", s.span)
            }
            StatementKind::Broken { name } => {
                if let Some(name) = name {
                    let ident = Ident { name: name.clone(), span: s.span };
                    self.bind(&ident, Kind::Broken, At::Local(0), true);
                }
                Code::Failed
            }
        };
        Node { code, span: s.span }
    }

    pub(super) fn only_at_top(&mut self, word: &str, span: Span) -> Code {
        let here = Span { end: span.start + word.len() as u32, ..span };
        self.errors.push(
            Diagnostic::error(format!("`{word}` belongs at the top level of the file"))
                .at(here, "not within a block or function"),
        );
        Code::Failed
    }

    pub(super) fn assign(&mut self, name: &Ident, op: Option<Op>, op_span: Span, value: &Expr) -> Code {
        let value = self.expr(value, Mode::Value);
        let Some((access, binding, crosses)) = self.scopes.find(&name.name) else {
            let best = nearest(&name.name, self.scopes.names()).map(str::to_owned);
            let d = Diagnostic::error(format!("there is no variable `{}`", name.name));
            self.errors.push(match best {
                Some(b) => d.at(name.span, did_you_mean(Some(&b))).fix(b),
                None => d.at(name.span, "").note(format!("to make one, write `var {} = …`", name.name)),
            });
            return Code::Failed;
        };
        if binding.kind == Kind::Broken {
            return Code::Failed;
        }
        if binding.kind != Kind::Var {
            let how = match binding.kind {
                Kind::Let => "`let` binds it for good",
                Kind::Parameter => "it is a parameter",
                Kind::Loop => "the loop sets it",
                _ => "it is bound here",
            };
            let d =
                Diagnostic::error(format!("`{}` can't be changed", name.name)).at(name.span, "").at(binding.span, how);
            self.errors.push(match binding.kind {
                Kind::Let => d.note(format!("for a value that changes write `var {} = …`", name.name)),
                Kind::Parameter | Kind::Loop => {
                    d.note(format!("for a value that changes write `var changed = {}`", name.name))
                }
                _ => d,
            });
            return Code::Failed;
        }
        if crosses {
            self.captured_var(name, binding.span, "change");
            return Code::Failed;
        }
        let get = |code| Node { code, span: name.span };
        let (read, local, slot) = match access {
            Access::Local(i) => (get(Code::Local(i)), true, i),
            Access::Global(i) => (get(Code::Global(i)), false, i),
            _ => return Code::Failed,
        };
        let value = match op {
            Some(op) => {
                let span = op_span.to(value.span);
                let operation = Operation { op, a: read, b: value };
                let span = Span { start: name.span.start, ..span };
                with_formula(Node { code: Code::Binary(Box::new(operation)), span })
            }
            None => value,
        };
        if local {
            Code::SetLocal(slot, Box::new(value))
        } else {
            self.binds.push(slot);
            Code::SetGlobal(slot, Box::new(value))
        }
    }
}
