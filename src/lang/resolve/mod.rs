//! From syntax tree to program: finds what every name means, and reports every one that means nothing.

mod call;
mod expr;
mod module;
mod name;
mod statement;

use super::ast::*;
use super::catalog;
use super::code::*;
use super::load::Module;
use super::parse::like::Like;
use super::parse::parse_like;
use super::repeat::can_be_copied;
use super::scope::{At, Binding, Kind, Level, Scopes};
use super::value::{FunctionId, Value};
use crate::diag::{Diagnostic, Diagnostics, FileId, Span};
use ecow::EcoString;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

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
    /// Only a part of it is added where `cancel` is set meanwhile.
    pub fn file(&mut self, module: &Module, text: &str, main: bool, cancel: &AtomicBool) {
        let (parsed, imports) = (&module.parsed, &module.imports);
        let statements = &parsed.statements;
        self.scopes = Scopes::default();
        self.ended.clear();
        self.main = main;
        self.scopes.levels.push(Level::default());
        self.scopes.top().enter();
        let functions = self.declare(statements, imports, cancel);
        let mut out = Vec::new();
        let mut templates = Vec::new();
        let mut likes = parsed.likes.iter().peekable();
        for (i, s) in statements.iter().enumerate().take_while(|_| !cancel.load(Relaxed)) {
            while let Some(like) = likes.next_if(|like| like.start < s.span.start) {
                out.extend(self.like(like, &templates, module.file, text, cancel));
            }
            let before = self.errors.len();
            let top = self.top_statement(s);
            if let Some(template) = parsed.templates.get(templates.len())
                && template.statement == i
            {
                let is_good = self.errors.len() == before;
                let can_be = |t: &&TopStatement| t.node.span.range() == template.range && can_be_copied(&t.node, text);
                templates.push(top.as_ref().filter(|_| is_good).filter(can_be).map(|_| out.len()));
            }
            out.extend(top);
        }
        for like in likes {
            out.extend(self.like(like, &templates, module.file, text, cancel));
        }
        let level = self.scopes.levels.pop().unwrap_or_default();
        self.exports.push(module::exports(statements, &level));
        let (file, parsed, slots) = (module.file, parsed.clone(), level.slots);
        self.program.modules.push(ModuleCode { file, parsed, templates, statements: out, slots, functions });
    }

    /// A statement that is like another, unless it can be run as a copy of that.
    fn like(
        &mut self,
        like: &Like,
        templates: &[Option<usize>],
        file: FileId,
        text: &str,
        cancel: &AtomicBool,
    ) -> Option<TopStatement> {
        if cancel.load(Relaxed) || templates.get(like.template as usize).is_some_and(Option::is_some) {
            return None;
        }
        let (statement, errors) = parse_like(file, text, like, cancel);
        self.errors.extend(errors);
        self.top_statement(&statement?)
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
    fn declare(
        &mut self,
        statements: &[Statement],
        imports: &[Option<usize>],
        cancel: &AtomicBool,
    ) -> Vec<(u32, FunctionId)> {
        let mut functions = Vec::new();
        let mut imports = imports.iter();
        for s in statements.iter().take_while(|_| !cancel.load(Relaxed)) {
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
        let has_defaults = f.params.iter().any(|p| p.default.is_some());
        self.program.functions.push(FnCode { name: name.clone(), params, has_defaults, slots: 0, depth: 1, body });
        FunctionId(self.program.functions.len() as u32 - 1)
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
}
