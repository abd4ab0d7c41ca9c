//! Calls: every argument finds its parameter, or is reported.

use super::{Export, Mode, Resolver};
use crate::diag::{Diagnostic, Span};
use crate::lang::ast::*;
use crate::lang::catalog;
use crate::lang::code::*;
use crate::lang::scope::{Access, Kind};
use crate::lang::suggest::property_meant;
use crate::lang::value::{BuiltinId, FunctionId, Value};
use crate::lang::word::{self, Run};
use ecow::EcoString;

impl Resolver {
    pub(super) fn call(&mut self, callee: &Expr, args: &[Arg], mode: Mode) -> Code {
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
        let hides = match &callee.kind {
            ExprKind::Name(name) if catalog::find(name).is_some() => self.scopes.find(name).map(|(_, b, _)| b.span),
            _ => None,
        };
        let callee = self.boxed(callee);
        let args = args.iter().map(|a| self.arg(a)).collect();
        Code::CallValue { callee, args, hides }
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
    pub(super) fn named_args(&mut self, args: &[Arg], what: &str) -> Option<Box<[ArgCode]>> {
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

    pub(super) fn call_builtin(&mut self, id: BuiltinId, args: &[Arg], span: Span, mode: Mode) -> Code {
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
        if word.sets_something() && (mode != Mode::Scene || self.in_group || self.scopes.levels.len() > 1) {
            self.errors.push(
                Diagnostic::error(format!("`{}` belongs at the top level of the file", word.name))
                    .at(span, "not within a block or function")
                    .note("it sets something for the whole picture and has no value"),
            );
            self.args_alone(args);
            return Code::Failed;
        }
        let Some(args) = self.align_builtin(id, args, span) else { return Code::Failed };
        let function = match word.run {
            Run::Number(f) => Function1::OfNumber(f),
            Run::Angle(f) => Function1::OfAngle(f),
            _ => return Code::CallBuiltin { word: id, args },
        };
        match <Box<[_; 1]>>::try_from(args) {
            Ok(args) => Code::Apply(Box::new(Apply { word: id, function, args: *args })),
            Err(args) => Code::CallBuiltin { word: id, args },
        }
    }

    pub(super) fn align_builtin(&mut self, id: BuiltinId, args: &[Arg], span: Span) -> Option<Box<[(u16, Node)]>> {
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

    pub(super) fn call_known(&mut self, id: FunctionId, callee: Option<Box<Node>>, args: &[Arg], span: Span) -> Code {
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
                None => self.by_position(f, &mut next, &node),
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
        let (label, best) = property_meant(&name.name, f.params.iter().map(|p| p.name));
        let d = Diagnostic::error(format!("`{}` has no {} `{}`", f.name, f.noun, name.name))
            .at(name.span, label)
            .note(f.takes.clone());
        self.errors.push(match best {
            Some(b) => d.fix(b),
            None => d,
        });
        None
    }

    fn by_position(&mut self, f: &Signature<'_>, next: &mut usize, arg: &Node) -> Option<usize> {
        let span = arg.span;
        let index = *next;
        *next += 1;
        match f.params.get(index) {
            Some(p) if p.positional => return Some(index),
            None if f.params.last().is_some_and(|p| p.rest) => return Some(index),
            _ => {}
        }
        let d = match f.params.get(index) {
            Some(_)
                if let Code::Const(angle @ Value::Angle(_)) = &arg.code
                    && f.noun == "property"
                    && f.name == "rotate" =>
            {
                let a = angle.show(40);
                Diagnostic::error("`rotate` turns about an axis, which must be named")
                    .at(span, format!("write `x: {a}`, `y: {a}` or `z: {a}`"))
            }
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
