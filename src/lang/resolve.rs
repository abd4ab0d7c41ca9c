//! From syntax tree to program: finds what every name means, and reports every one that means nothing.

use super::ast::*;
use super::call::NAMELESS;
use super::catalog;
use super::code::*;
use super::scope::{Access, At, Binding, Kind, Level, Scopes};
use super::suggest::{did_you_mean, nearest, nearest_word};
use super::value::{BuiltinId, FunctionId, Value};
use super::word::{self, Run};
use crate::diag::{Diagnostic, Diagnostics, Span};
use ecow::EcoString;

/// What a block does with its expressions.
#[derive(Clone, Copy, PartialEq)]
enum Mode {
    /// The last one is its value.
    Value,
    /// Each is added to the scene block.
    Scene,
    /// The last one is added to the list.
    List,
    /// None has a value.
    Discard,
}

/// What a file gives to those that import it.
#[derive(Clone, Debug, Default)]
pub struct Exports {
    pub names: Vec<Export>,
    /// All its other names, to say that they could be exported.
    pub private: Vec<EcoString>,
}

#[derive(Clone, Debug)]
pub struct Export {
    pub name: EcoString,
    pub slot: u32,
    pub function: Option<FunctionId>,
    /// It has an error of its own.
    pub broken: bool,
}

/// Turns files into one program.
#[derive(Default)]
pub struct Resolver {
    pub program: Program,
    pub errors: Diagnostics,
    pub exports: Vec<Exports>,
    scopes: Scopes,
    /// Whether a `group { }` is around.
    in_group: bool,
    /// Globals that the current outermost statement binds or changes.
    binds: Vec<u32>,
    main: bool,
    /// The name whose value is being resolved.
    binding: Option<Ident>,
    /// Names of this file whose block has ended.
    ended: Vec<(EcoString, Span)>,
}

impl Resolver {
    /// Adds a file. `imports` has one entry an `import` statement: the module's index, or `None` where it couldn't be read.
    pub fn file(&mut self, statements: &[Statement], imports: &[Option<usize>], main: bool) {
        self.scopes = Scopes::default();
        self.ended.clear();
        self.main = main;
        self.scopes.levels.push(Level::default());
        self.scopes.top().enter();
        let functions = self.declare(statements, imports);
        let mut out = Vec::new();
        for s in statements {
            if let Some(t) = self.top_statement(s) {
                out.push(t);
            }
        }
        let level = self.scopes.levels.pop().unwrap_or_default();
        self.exports.push(exports(statements, &level));
        self.program.modules.push(ModuleCode { statements: out, slots: level.slots, functions });
    }

    /// An expression that sees the built-in words only; an unknown word alone is a text.
    pub fn lone_expression(&mut self, e: &Expr) -> Node {
        self.scopes = Scopes::default();
        self.scopes.levels.push(Level::default());
        self.scopes.top().enter();
        if let ExprKind::Name(name) = &e.kind
            && catalog::find(name).is_none()
        {
            return Node { code: Code::Const(Value::Text(name.clone())), span: e.span };
        }
        self.expr(e, Mode::Value)
    }

    // Declarations of the top level, before anything is resolved: functions may use what comes later.
    fn declare(&mut self, statements: &[Statement], imports: &[Option<usize>]) -> Vec<(u32, FunctionId)> {
        let mut functions = Vec::new();
        let mut imports = imports.iter();
        for s in statements {
            let (name, kind) = match &s.kind {
                StatementKind::Let { name, .. } => (name, Kind::Let),
                StatementKind::Var { name, .. } => (name, Kind::Var),
                StatementKind::Param(p) => (&p.name, Kind::Let),
                StatementKind::Fn { name, function, .. } => (name, Kind::Function(self.reserve(&name.name, function))),
                StatementKind::Import { names, .. } => {
                    self.import(names, imports.next().copied().flatten());
                    continue;
                }
                StatementKind::Broken { name: Some(name) } => {
                    let ident = Ident { name: name.clone(), span: s.span };
                    self.bind(&ident, Kind::Broken, At::Global(0), true);
                    continue;
                }
                _ => continue,
            };
            let slot = self.program.globals;
            self.program.globals += 1;
            if let Kind::Function(id) = kind {
                functions.push((slot, id));
            }
            self.bind(name, kind, At::Global(slot), matches!(kind, Kind::Function(_)));
        }
        functions
    }

    /// Gives a function its number and parameters before its body is looked at.
    fn reserve(&mut self, name: &EcoString, f: &Function) -> FunctionId {
        let params = f
            .params
            .iter()
            .map(|p| ParamSlot { name: p.name.name.clone(), required: p.default.is_none(), default: None })
            .collect();
        let body = Node { code: Code::Failed, span: f.body.span };
        self.program.functions.push(FnCode { name: name.clone(), params, slots: 0, depth: 1, body });
        FunctionId(self.program.functions.len() as u32 - 1)
    }

    fn import(&mut self, names: &ImportNames, module: Option<usize>) {
        match names {
            ImportNames::Module(name) => {
                let kind = module.map_or(Kind::Broken, Kind::Module);
                self.bind(name, kind, At::Global(0), true);
            }
            ImportNames::Some(names) => {
                for (there, here) in names {
                    let found = module.map(|m| self.export(m, there));
                    match found {
                        Some(Some(e)) if !e.broken => {
                            let kind = e.function.map_or(Kind::Let, Kind::Function);
                            self.bind(here, kind, At::Global(e.slot), true);
                        }
                        _ => self.bind(here, Kind::Broken, At::Global(0), true),
                    }
                }
            }
        }
    }

    /// What a module exports under a name, or an error.
    fn export(&mut self, module: usize, name: &Ident) -> Option<Export> {
        let exports = &self.exports[module];
        if let Some(e) = exports.names.iter().find(|e| e.name == name.name) {
            return Some(e.clone());
        }
        let d = Diagnostic::error(format!("the module exports no `{}`", name.name));
        let d = if exports.private.contains(&name.name) {
            d.at(name.span, "it isn't exported")
                .note(format!("write `export` before it there: `export let {} = …`", name.name))
        } else {
            let best = nearest(&name.name, exports.names.iter().map(|e| e.name.as_str()));
            let d = d.at(name.span, did_you_mean(best));
            match &exports.names[..] {
                [] => d.note("it exports nothing"),
                names => d.note(format!(
                    "it exports: {}",
                    names.iter().map(|e| e.name.as_str()).collect::<Vec<_>>().join(", ")
                )),
            }
        };
        self.errors.push(d);
        None
    }

    /// Adds a name to the innermost block.
    fn bind(&mut self, ident: &Ident, kind: Kind, at: At, declared: bool) {
        let block = self.scopes.top().blocks.last_mut();
        let Some(block) = block else { return };
        if let Some(first) = block.iter().find(|b| b.name == ident.name)
            && kind != Kind::Broken
            && first.kind != Kind::Broken
        {
            let first = first.span;
            self.errors.push(
                Diagnostic::error(format!("`{}` is bound twice", ident.name))
                    .at(ident.span, "the second time")
                    .at(first, "the first time")
                    .note("choose another name, or use `var` and `=` for a value that changes"),
            );
            return;
        }
        block.push(Binding { name: ident.name.clone(), span: ident.span, kind, at, declared });
    }

    /// A new local name.
    fn bind_local(&mut self, ident: &Ident, kind: Kind) -> u32 {
        let slot = self.scopes.top().slot();
        self.bind(ident, kind, At::Local(slot), true);
        slot
    }

    fn top_statement(&mut self, s: &Statement) -> Option<TopStatement> {
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

    fn global_slot(&mut self, name: &Ident) -> Option<u32> {
        let block = self.scopes.top().blocks.last_mut()?;
        let binding = block.iter_mut().find(|b| b.span == name.span)?;
        binding.declared = true;
        let At::Global(slot) = binding.at else { return None };
        self.binds.push(slot);
        Some(slot)
    }

    fn set_global(&mut self, name: &Ident, value: Node, span: Span) -> Option<Node> {
        let slot = self.global_slot(name)?;
        Some(Node { code: Code::SetGlobal(slot, Box::new(value)), span })
    }

    /// Resolves a function's body into its reserved place; gives what it captures.
    fn function(&mut self, f: &Function, id: FunctionId, own_name: Option<&Ident>) -> Box<[CaptureFrom]> {
        let own_name = own_name.map(|n| (n.name.clone(), id, n.span));
        let mut level = Level::default();
        level.own_name = own_name;
        self.scopes.levels.push(level);
        let in_group = std::mem::replace(&mut self.in_group, false);
        self.scopes.top().enter();
        let mut depth = f.body.depth;
        let mut defaults = Vec::new();
        for p in &f.params {
            // A default sees the parameters before it.
            defaults.push(p.default.as_ref().map(|e| {
                depth = depth.max(e.depth);
                self.expr(e, Mode::Value)
            }));
            self.bind_local(&p.name, Kind::Parameter);
        }
        let body = self.expr(&f.body, Mode::Value);
        self.in_group = in_group;
        let level = self.scopes.levels.pop().unwrap_or_default();
        if let Some(code) = self.program.functions.get_mut(id.0 as usize) {
            for (p, d) in code.params.iter_mut().zip(defaults) {
                p.default = d;
            }
            (code.slots, code.depth, code.body) = (level.slots, depth + 1, body);
        }
        level.captures.into()
    }

    /// The value of a `let` or `var`.
    fn bound_value(&mut self, name: &Ident, value: &Expr) -> Node {
        let outer = self.binding.replace(name.clone());
        let value = self.expr(value, Mode::Value);
        self.binding = outer;
        value
    }

    /// Ends a block; what it bound is remembered, to explain why it isn't there any more.
    fn leave(&mut self, mark: u32) {
        if let Some(block) = self.scopes.top().blocks.last() {
            self.ended.extend(block.iter().map(|b| (b.name.clone(), b.span)));
        }
        self.scopes.top().leave(mark);
    }

    fn block(&mut self, block: &Block, mode: Mode) -> Node {
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

    fn statement(&mut self, s: &Statement, mode: Mode) -> Node {
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

    fn only_at_top(&mut self, word: &str, span: Span) -> Code {
        let here = Span { end: span.start + word.len() as u32, ..span };
        self.errors.push(
            Diagnostic::error(format!("`{word}` belongs at the top level of the file"))
                .at(here, "not within a block or function"),
        );
        Code::Failed
    }

    fn assign(&mut self, name: &Ident, op: Option<Op>, op_span: Span, value: &Expr) -> Code {
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
                Node { code: Code::Binary(op, Box::new((read, value))), span: Span { start: name.span.start, ..span } }
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

    fn captured_var(&mut self, name: &Ident, bound: Span, what: &str) {
        self.errors.push(
            Diagnostic::error(format!("a function can't {what} the `var` `{}` outside it", name.name))
                .at(name.span, "")
                .at(bound, "bound here")
                .note("functions see only what never changes: bind it with `let`, or pass it as an argument"),
        );
    }

    fn expr(&mut self, e: &Expr, mode: Mode) -> Node {
        let span = e.span;
        let node = |code| Node { code, span };
        // What these do with their parts depends on the block around; all else makes a value first.
        match &e.kind {
            ExprKind::If { arms, otherwise } => return node(self.if_(arms, otherwise.as_ref(), span, mode)),
            ExprKind::For(f) => return node(self.for_(f, span, mode)),
            ExprKind::Block(b) => return self.block(b, mode),
            _ => {}
        }
        let value = node(self.value(e, mode));
        match mode {
            Mode::Value => value,
            Mode::Scene => node(Code::Emit(Box::new(value))),
            Mode::List => node(Code::Push(Box::new(value))),
            Mode::Discard => node(Code::Discard(Box::new(value))),
        }
    }

    fn boxed(&mut self, e: &Expr) -> Box<Node> {
        Box::new(self.expr(e, Mode::Value))
    }

    fn pair(&mut self, a: &Expr, b: &Expr) -> Box<(Node, Node)> {
        let a = self.expr(a, Mode::Value);
        Box::new((a, self.expr(b, Mode::Value)))
    }

    fn value(&mut self, e: &Expr, mode: Mode) -> Code {
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
            ExprKind::Binary { op, a, b, .. } => Code::Binary(*op, self.pair(a, b)),
            ExprKind::Index { of, index } => Code::Index(self.pair(of, index)),
            ExprKind::Field { of, field } => self.field(of, field),
            ExprKind::Call { callee, args } => self.call(callee, args, mode),
            ExprKind::If { .. } | ExprKind::For(_) | ExprKind::Block(_) => self.expr(e, mode).code,
        }
    }

    fn text(&mut self, parts: &[TextPart]) -> Code {
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

    fn list(&mut self, items: &[Expr]) -> Code {
        let collects = items.iter().any(|e| match &e.kind {
            ExprKind::For(_) => true,
            ExprKind::If { otherwise, .. } => otherwise.is_none(),
            _ => false,
        });
        let mode = if collects { Mode::List } else { Mode::Value };
        let nodes = items.iter().map(|e| self.expr(e, mode)).collect();
        if collects { Code::Collected(nodes) } else { Code::List(nodes) }
    }

    fn if_(&mut self, arms: &[(Expr, Block)], otherwise: Option<&Block>, span: Span, mode: Mode) -> Code {
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

    fn for_(&mut self, f: &For, span: Span, mode: Mode) -> Code {
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

    fn group(&mut self, args: &[Arg], body: &Block) -> Code {
        let Some(id) = catalog::find("group") else { return Code::Failed };
        let args = self.align_builtin(id, args, body.span);
        let outer = std::mem::replace(&mut self.in_group, true);
        let body = Box::new(self.block(body, Mode::Scene));
        self.in_group = outer;
        args.map_or(Code::Failed, |args| Code::Group { args, body })
    }

    /// The built-in word that an expression names, if nothing shadows it.
    fn builtin(&mut self, e: &Expr) -> Option<BuiltinId> {
        match &e.kind {
            ExprKind::Name(name) => match self.scopes.find(name) {
                Some((_, b, crosses)) if b.declared || crosses => None,
                _ => catalog::find(name),
            },
            ExprKind::Field { of, field } if self.is_std(of) => catalog::find(&field.name),
            _ => None,
        }
    }

    fn is_std(&mut self, e: &Expr) -> bool {
        matches!(&e.kind, ExprKind::Name(n) if n == "std") && self.scopes.find("std").is_none()
    }

    fn module(&mut self, e: &Expr) -> Option<usize> {
        let ExprKind::Name(name) = &e.kind else { return None };
        match self.scopes.find(name)?.1.kind {
            Kind::Module(m) => Some(m),
            _ => None,
        }
    }

    fn name(&mut self, ident: &Ident) -> Code {
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
    fn builtin_value(&mut self, ident: &Ident, later: Option<Span>) -> Code {
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

    fn of_itself(&self, ident: &Ident, bound: Span) -> Diagnostic {
        Diagnostic::error(format!("the value of `{0}` is made of `{0}` itself", ident.name))
            .at(ident.span, "it has no value yet")
            .at(bound, "it is bound here")
            .note("a line that ends with an operator goes on in the next one")
    }

    /// A word that stands without a call.
    fn word_value(&mut self, id: BuiltinId, span: Span) -> Code {
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
            _ if word.kind == word::Kind::Setting && word.name != "grid" => {
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

    fn unknown(&self, ident: &Ident, called: bool) -> Diagnostic {
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

    fn field(&mut self, of: &Expr, field: &Ident) -> Code {
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
        Code::Field(self.boxed(of), field.name.clone())
    }

    fn call(&mut self, callee: &Expr, args: &[Arg], mode: Mode) -> Code {
        if let Some(id) = self.builtin(callee) {
            return self.call_builtin(id, args, callee.span, mode);
        }
        if let ExprKind::Field { of, field } = &callee.kind {
            if let Some(m) = self.module(of)
                && let Some(Export { function: Some(id), broken: false, .. }) = self.export_quietly(m, &field.name)
            {
                return self.call_known(id, None, args, field.span);
            }
            if field.name == "with" && self.module(of).is_none() {
                let of = self.boxed(of);
                let args = self.named_args(args, "with");
                return args.map_or(Code::Failed, |a| Code::With(of, a));
            }
        }
        if let ExprKind::Name(name) = &callee.kind {
            let level = self.scopes.levels.len();
            match self.scopes.find(name) {
                Some((access, b, _)) if matches!(b.kind, Kind::Function(_)) => {
                    let Kind::Function(id) = b.kind else { return Code::Failed };
                    let at = callee.span;
                    let callee = match access {
                        Access::Global(_) => None,
                        _ => Some(self.boxed(callee)),
                    };
                    return self.call_known(id, callee, args, at);
                }
                None => {
                    let ident = Ident { name: name.clone(), span: callee.span };
                    let d = self.unknown(&ident, true);
                    self.errors.push(d);
                    self.args_alone(args);
                    return Code::Failed;
                }
                Some((_, b, _)) if b.kind == Kind::Broken && level > 0 => {
                    self.args_alone(args);
                    return Code::Failed;
                }
                _ => {}
            }
        }
        let callee = self.boxed(callee);
        let args = args.iter().map(|a| self.arg(a)).collect();
        Code::CallValue { callee, args }
    }

    fn export_quietly(&self, module: usize, name: &str) -> Option<Export> {
        self.exports[module].names.iter().find(|e| e.name == name).cloned()
    }

    /// Arguments of something unknown: their own mistakes are reported all the same.
    fn args_alone(&mut self, args: &[Arg]) {
        for a in args {
            self.expr(&a.value, Mode::Value);
        }
    }

    fn arg(&mut self, a: &Arg) -> ArgCode {
        let value = self.expr(&a.value, Mode::Value);
        let name_span = a.name.as_ref().map_or(value.span, |n| n.span);
        ArgCode { name: a.name.as_ref().map(|n| n.name.clone()), name_span, value }
    }

    /// Arguments that must all be named: `record(…)`, `.with(…)`.
    fn named_args(&mut self, args: &[Arg], what: &str) -> Option<Box<[ArgCode]>> {
        let mut good = true;
        let mut out: Vec<ArgCode> = Vec::new();
        for a in args {
            let arg = self.arg(a);
            match &arg.name {
                None => {
                    self.errors.push(
                        Diagnostic::error(format!("`{what}` takes named values"))
                            .at(arg.name_span, "a name is missing")
                            .note(match what {
                                "with" => "as in `leaf.with(size: 2)`",
                                _ => "as in `record(size: 2)`",
                            }),
                    );
                    good = false;
                }
                Some(name) => {
                    if let Some(first) = out.iter().find(|o| o.name.as_ref() == Some(name)) {
                        self.errors.push(
                            Diagnostic::error(format!("`{name}` is given twice"))
                                .at(arg.name_span, "the second time")
                                .at(first.name_span, "the first time"),
                        );
                        good = false;
                    }
                }
            }
            out.push(arg);
        }
        good.then(|| out.into())
    }

    fn call_builtin(&mut self, id: BuiltinId, args: &[Arg], span: Span, mode: Mode) -> Code {
        let word = catalog::word(id);
        if word.name == "record" {
            return self.named_args(args, "record").map_or(Code::Failed, Code::Record);
        }
        if let Run::Constant(_) = word.run {
            self.errors.push(
                Diagnostic::error(format!("`{0}` isn't a function", word.name)).at(span, "write it without `( )`"),
            );
            self.args_alone(args);
            return Code::Failed;
        }
        if word.kind == word::Kind::Setting
            && word.name != "grid"
            && (mode != Mode::Scene || self.in_group || self.scopes.levels.len() > 1)
        {
            self.errors.push(
                Diagnostic::error(format!("`{}` belongs at the top level of the file", word.name))
                    .at(span, "not within a block or function")
                    .note("it sets something for the whole picture and has no value"),
            );
            self.args_alone(args);
            return Code::Failed;
        }
        self.align_builtin(id, args, span).map_or(Code::Failed, |args| Code::CallBuiltin { word: id, args })
    }

    fn align_builtin(&mut self, id: BuiltinId, args: &[Arg], span: Span) -> Option<Box<[(u16, Node)]>> {
        let word = catalog::word(id);
        let params: Vec<Slot<'_>> = word
            .params
            .iter()
            .map(|p| Slot {
                name: p.name,
                required: p.default == word::Default::Required,
                positional: p.positional,
                rest: p.rest,
            })
            .collect();
        let places = self.align(
            &Signature { name: word.name, noun: "property", params: &params, takes: word.takes() },
            args,
            span,
        )?;
        Some(places.into_iter().map(|(i, node)| (i as u16, node)).collect())
    }

    fn call_known(&mut self, id: FunctionId, callee: Option<Box<Node>>, args: &[Arg], span: Span) -> Code {
        let Some(f) = self.program.functions.get(id.0 as usize) else { return Code::Failed };
        let name = f.name.clone();
        let params: Vec<(EcoString, bool)> = f.params.iter().map(|p| (p.name.clone(), p.required)).collect();
        let count = params.len();
        let slots: Vec<Slot<'_>> = params
            .iter()
            .map(|(name, required)| Slot { name, required: *required, positional: *required, rest: false })
            .collect();
        let names: Vec<&str> = slots.iter().map(|s| s.name).collect();
        let mut takes = match &names[..] {
            [] => format!("{name} takes nothing"),
            _ => format!("{name} takes: {}", names.join(", ")),
        };
        if catalog::find(&name).is_some() {
            takes = format!("your own {takes}; the built-in one is `std.{name}`");
        }
        let signature = Signature { name: &name, noun: "parameter", params: &slots, takes };
        let Some(places) = self.align(&signature, args, span) else { return Code::Failed };
        let mut out: Vec<Option<Node>> = (0..count).map(|_| None).collect();
        for (i, node) in places {
            out[i] = Some(node);
        }
        Code::Call { function: id, callee, args: out.into() }
    }

    /// Finds each argument's parameter; reports all that don't fit.
    fn align(&mut self, f: &Signature<'_>, args: &[Arg], span: Span) -> Option<Vec<(usize, Node)>> {
        let before = self.errors.len();
        let mut out: Vec<(usize, Node)> = Vec::new();
        let mut given: Vec<Option<Span>> = vec![None; f.params.len()];
        let mut next = 0;
        for a in args {
            let node = self.expr(&a.value, Mode::Value);
            let index = match &a.name {
                Some(name) => self.named(f, name),
                None => self.by_position(f, &mut next, node.span),
            };
            let Some(index) = index else { continue };
            let here = a.name.as_ref().map_or(node.span, |n| n.span);
            if let Some(slot) = given.get_mut(index) {
                if let Some(first) = *slot {
                    self.errors.push(
                        Diagnostic::error(format!("`{}` of `{}` is given twice", f.params[index].name, f.name))
                            .at(here, "the second time")
                            .at(first, if a.name.is_some() { "the first time" } else { "the first time, by name" }),
                    );
                    continue;
                }
                *slot = Some(here);
            }
            out.push((index, node));
        }
        let missing: Vec<&str> =
            f.params.iter().zip(&given).filter(|(p, g)| p.required && g.is_none()).map(|(p, _)| p.name).collect();
        // A misspelt name is missing too; once is enough.
        if !missing.is_empty() && self.errors.len() == before {
            let list = missing.iter().map(|m| format!("`{m}`")).collect::<Vec<_>>().join(" and ");
            let d = Diagnostic::error(format!("`{}` needs {list}", f.name)).at(span, "").note(f.takes.clone());
            self.errors.push(d);
        }
        (self.errors.len() == before).then_some(out)
    }

    fn named(&mut self, f: &Signature<'_>, name: &Ident) -> Option<usize> {
        if let Some(i) = f.params.iter().position(|p| p.name == name.name && !p.rest) {
            return Some(i);
        }
        let best = super::suggest::nearest_property(&name.name, f.params.iter().map(|p| p.name));
        let d = Diagnostic::error(format!("`{}` has no {} `{}`", f.name, f.noun, name.name))
            .at(name.span, did_you_mean(best))
            .note(f.takes.clone());
        self.errors.push(match best {
            Some(b) => d.fix(b),
            None => d,
        });
        None
    }

    fn by_position(&mut self, f: &Signature<'_>, next: &mut usize, span: Span) -> Option<usize> {
        let index = *next;
        *next += 1;
        match f.params.get(index) {
            Some(p) if p.positional => return Some(index),
            None if f.params.last().is_some_and(|p| p.rest) => return Some(index),
            _ => {}
        }
        let d = match f.params.get(index) {
            Some(p) => Diagnostic::error(format!("`{}` of `{}` must be named", p.name, f.name))
                .at(span, format!("write `{}: …`", p.name)),
            None => Diagnostic::error(format!("`{}` has too many arguments", f.name)).at(span, "this one is too much"),
        };
        self.errors.push(d.note(f.takes.clone()));
        None
    }
}

struct Slot<'a> {
    name: &'a str,
    required: bool,
    positional: bool,
    rest: bool,
}

struct Signature<'a> {
    name: &'a str,
    /// What its parameters are called: properties of shapes, parameters of functions.
    noun: &'static str,
    params: &'a [Slot<'a>],
    takes: String,
}

fn exports(statements: &[Statement], level: &Level) -> Exports {
    let bindings = level.blocks.first().map_or(&[][..], |b| &b[..]);
    let mut out = Exports::default();
    for b in bindings {
        let exported = statements.iter().any(|s| match &s.kind {
            StatementKind::Let { name, export, .. } | StatementKind::Fn { name, export, .. } => {
                *export && name.span == b.span
            }
            // It may have been exported; another error about it would only confuse.
            StatementKind::Broken { name: Some(name) } => *name == b.name,
            _ => false,
        });
        let At::Global(slot) = b.at else { continue };
        if exported {
            let function = if let Kind::Function(id) = b.kind { Some(id) } else { None };
            out.names.push(Export { name: b.name.clone(), slot, function, broken: b.kind == Kind::Broken });
        } else {
            out.private.push(b.name.clone());
        }
    }
    out
}
