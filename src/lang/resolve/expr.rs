//! Expressions but for names and calls.

use super::{Mode, Resolver};
use crate::diag::{Diagnostic, Span};
use crate::lang::ast::*;
use crate::lang::call::NAMELESS;
use crate::lang::catalog;
use crate::lang::code::*;
use crate::lang::formula::with_formula;
use crate::lang::scope::Kind;
use crate::lang::value::Value;
use ecow::EcoString;

impl Resolver {
    pub(super) fn expr(&mut self, e: &Expr, mode: Mode) -> Node {
        let span = e.span;
        let node = |code| Node { code, span };
        // What these do with their parts depends on the block around; all else makes a value first.
        match &e.kind {
            ExprKind::If { arms, otherwise } => return node(self.if_(arms, otherwise.as_ref(), span, mode)),
            ExprKind::For(f) => return node(self.for_(f, span, mode)),
            ExprKind::Block(b) => return self.block(b, mode),
            _ => {}
        }
        let value = with_formula(node(self.value(e, mode)));
        match mode {
            Mode::Value => value,
            Mode::Scene => node(Code::Emit(Box::new(value))),
            Mode::List => node(Code::Push(Box::new(value))),
            Mode::Discard => node(Code::Discard(Box::new(value))),
        }
    }

    pub(super) fn boxed(&mut self, e: &Expr) -> Box<Node> {
        Box::new(self.expr(e, Mode::Value))
    }

    pub(super) fn pair(&mut self, a: &Expr, b: &Expr) -> Box<(Node, Node)> {
        let a = self.expr(a, Mode::Value);
        Box::new((a, self.expr(b, Mode::Value)))
    }

    pub(super) fn value(&mut self, e: &Expr, mode: Mode) -> Code {
        match &e.kind {
            ExprKind::Number(n) => Code::Const(Value::Number(*n)),
            ExprKind::Angle(a) => Code::Const(Value::Angle(*a)),
            ExprKind::Bool(b) => Code::Const(Value::Bool(*b)),
            ExprKind::Color(c) => Code::Const(Value::Color(*c)),
            ExprKind::Text(parts) => self.text(parts),
            ExprKind::Name(name) => self.name(&Ident { name: name.clone(), span: e.span }),
            ExprKind::List(items) => self.list(items),
            ExprKind::Lambda(f) => {
                let id = self.reserve(&NAMELESS.into(), f);
                let captures = self.function(f, id, None);
                Code::Closure(id, captures)
            }
            ExprKind::Group { args, body } => self.group(args, body),
            ExprKind::Negate(a) => Code::Negate(self.boxed(a)),
            ExprKind::Not(a) => Code::Not(self.boxed(a)),
            ExprKind::Binary { op: Op::And, a, b, .. } => Code::And(self.pair(a, b)),
            ExprKind::Binary { op: Op::Or, a, b, .. } => Code::Or(self.pair(a, b)),
            ExprKind::Binary { op, a, b, .. } => {
                let (a, b) = *self.pair(a, b);
                Code::Binary(Box::new(Operation { op: *op, a, b }))
            }
            ExprKind::Index { of, index } => Code::Index(self.pair(of, index)),
            ExprKind::Field { of, field } => self.field(of, field),
            ExprKind::Call { callee, args } => self.call(callee, args, mode),
            ExprKind::If { .. } | ExprKind::For(_) | ExprKind::Block(_) => self.expr(e, mode).code,
        }
    }

    pub(super) fn text(&mut self, parts: &[TextPart]) -> Code {
        match parts {
            [] => Code::Const(Value::Text(EcoString::new())),
            [TextPart::Literal(s)] => Code::Const(Value::Text(s.clone())),
            _ => Code::Text(
                parts
                    .iter()
                    .map(|p| match p {
                        TextPart::Literal(s) => TextCode::Literal(s.clone()),
                        TextPart::Expr(e) => TextCode::Node(self.expr(e, Mode::Value)),
                    })
                    .collect(),
            ),
        }
    }

    pub(super) fn list(&mut self, items: &[Expr]) -> Code {
        let collects = items.iter().any(|e| match &e.kind {
            ExprKind::For(_) => true,
            ExprKind::If { otherwise, .. } => otherwise.is_none(),
            _ => false,
        });
        let mode = if collects { Mode::List } else { Mode::Value };
        let nodes = items.iter().map(|e| self.expr(e, mode)).collect();
        if collects { Code::Collected(nodes) } else { Code::List(nodes) }
    }

    pub(super) fn if_(&mut self, arms: &[(Expr, Block)], otherwise: Option<&Block>, span: Span, mode: Mode) -> Code {
        let arms = arms
            .iter()
            .map(|(c, b)| {
                let condition = self.expr(c, Mode::Value);
                (condition, self.block(b, mode))
            })
            .collect();
        let otherwise = otherwise.map(|b| Box::new(self.block(b, mode)));
        if mode == Mode::Value && otherwise.is_none() {
            self.errors.push(
                Diagnostic::error("this `if` has no value when its condition is false")
                    .at(Span { end: span.start + 2, ..span }, "an `else { … }` is missing")
                    .note("as in `if a > 0 { a } else { 0 }`"),
            );
        }
        Code::If { arms, otherwise }
    }

    pub(super) fn for_(&mut self, f: &For, span: Span, mode: Mode) -> Code {
        if mode == Mode::Value {
            let here = Span { end: span.start + 3, ..span };
            self.errors.push(
                Diagnostic::error("a `for` has no value here")
                    .at(here, "its values would be lost")
                    .note("write `[for … { … }]` for a list, or `group { for … { … } }` for shapes"),
            );
        }
        let valueless = mode == Mode::Value;
        let mode = if mode == Mode::Value { Mode::Discard } else { mode };
        let over = self.expr(&f.over, Mode::Value);
        let mark = self.scopes.top().enter();
        let slot = self.bind_local(&f.name, Kind::Loop);
        let guard = f.guard.as_ref().map(|g| self.expr(g, Mode::Value));
        let body = self.block(&f.body, mode);
        self.leave(mark);
        if valueless {
            return Code::Failed;
        }
        Code::For(Box::new(ForCode { slot, over, guard, body }))
    }

    pub(super) fn group(&mut self, args: &[Arg], body: &Block) -> Code {
        let Some(id) = catalog::find("group") else { return Code::Failed };
        let args = self.align_builtin(id, args, body.span);
        let outer = std::mem::replace(&mut self.in_group, true);
        let body = Box::new(self.block(body, Mode::Scene));
        self.in_group = outer;
        args.map_or(Code::Failed, |args| Code::Group { args, body })
    }
}
