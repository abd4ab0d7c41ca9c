//! Calls: of built-in words and of functions, with arguments bound by position or name.

use super::catalog;
use super::code::*;
use super::fault::{Fault, Outcome, Stop};
use super::machine::{Call, Frame, Machine, word_name};
use super::scalar::{Fast, Other};
use super::suggest::property_meant;
use super::value::{BuiltinId, Closure, FunctionId, Value, number_text};
use super::word::{Args, Default, Run, Word, described};
use crate::diag::Span;
use ecow::EcoString;
use std::sync::Arc;

/// What a function without a name is called in call chains.
pub const NAMELESS: &str = "function";
/// Words with more parameters keep their arguments on the heap.
const FEW: usize = 4;

impl Machine<'_> {
    /// A built-in word, its arguments placed already.
    pub fn call_builtin(&mut self, id: BuiltinId, args: &[(u16, Node)], span: Span, frame: Frame<'_>) -> Outcome {
        let word = catalog::word(id);
        let most = args.last().map_or(0, |(i, _)| usize::from(*i) + 1);
        let count = args.iter().map(|(i, _)| usize::from(*i) + 1).max().unwrap_or(most).max(word.params.len());
        if count <= FEW {
            let mut values = [const { Value::Unset }; FEW];
            self.arguments(&mut values, args, frame)?;
            self.run_word(id, &mut values[..count], span, args)
        } else {
            let mut values = vec![Value::Unset; count];
            self.arguments(&mut values, args, frame)?;
            self.run_word(id, &mut values, span, args)
        }
    }

    /// Evaluates arguments; mistakes in several of them are all reported.
    fn arguments(&mut self, values: &mut [Value], args: &[(u16, Node)], frame: Frame<'_>) -> Result<(), Stop> {
        let mut failed = false;
        for (i, node) in args {
            failed |= !self.attempt(node, frame, |_, made| values[usize::from(*i)].put(made))?;
        }
        if failed { Err(Stop::Reported) } else { Ok(()) }
    }

    /// Reports every argument of a word that doesn't fit its parameter.
    #[cold]
    fn misfits(&mut self, word: &'static Word, values: &mut [Value], span: Span, args: &[(u16, Node)]) -> Stop {
        let mut stops = Vec::new();
        for (i, value) in values.iter().enumerate() {
            let Some(param) = word.params.get(i).or(word.params.last()) else { continue };
            let absent = matches!(value, Value::Unset | Value::None) && param.default != Default::Required;
            if let (false, Err(fault)) = (absent, param.check(value, &self.build)) {
                let meaning = format!("`{}` of `{}`: {}", param.name, word.name, param.doc);
                stops.push(self.locate(fault.on(i).note_once(meaning), span, args));
            }
        }
        let last = stops.pop().unwrap_or(Stop::Reported);
        for stop in stops {
            if let Stop::Error(d) = stop {
                self.errors.push(*d);
            }
        }
        last
    }

    /// Checks a word's arguments and runs it.
    pub fn run_word(&mut self, id: BuiltinId, values: &mut [Value], span: Span, args: &[(u16, Node)]) -> Outcome {
        let word = catalog::word(id);
        if let (Run::Number(f), [Value::Number(x)]) = (&word.run, &*values) {
            let y = f(*x);
            if y.is_finite() {
                return Ok(Value::Number(y));
            }
            let x_text = number_text(*x);
            let fault = match word.name {
                "sqrt" => Fault::new(format!("{x_text} has no square root")).note("numbers from 0 up have one"),
                "log" | "log2" | "log10" => {
                    Fault::new(format!("{x_text} has no logarithm")).note("numbers above 0 have one")
                }
                name => {
                    Fault::new(format!("`{name}` of {x_text} is too large")).note("the largest number is about 1.8e308")
                }
            };
            return Err(self.locate(fault.on(0), span, args));
        }
        if word.check(values, &self.build).is_err() {
            return Err(self.misfits(word, values, span, args));
        }
        self.here = span;
        self.argument = args.iter().find(|(i, _)| *i == 0).map_or(span, |(_, node)| node.span);
        let result = match &word.run {
            Run::Call(run) => run(self, values),
            Run::Angle(f) => Ok(Value::Number(f(values.number(0)))),
            Run::Number(_) | Run::Constant(_) | Run::Syntax => Ok(Value::None),
        };
        let result = result.and_then(|value| match value.is_finite() {
            true => Ok(value),
            false => Err(Fault::new(format!("the result of `{}` is too large", word.name)).into()),
        });
        result.map_err(|stop| match stop {
            Stop::Fault(f) => self.locate(f, span, args),
            other => other,
        })
    }

    /// A function known beforehand.
    pub fn call_known(
        &mut self,
        function: FunctionId,
        callee: Option<&Node>,
        args: &[Option<Node>],
        span: Span,
        frame: Frame<'_>,
    ) -> Fast {
        let closure = match callee {
            None => None,
            Some(node) => match self.fresh(node, frame)? {
                Value::Function(c) => Some(c),
                _ => return Err(self.stop(Stop::Reported)),
            },
        };
        let Some(f) = self.program.functions.get(function.0 as usize) else { return Err(self.stop(Stop::Reported)) };
        // The frame is there before the arguments are, so that each is put where it belongs.
        let base = self.stack.len();
        self.stack.extend((0..f.slots).map(|_| Value::Unset));
        for (i, arg) in args.iter().enumerate() {
            let Some(node) = arg else { continue };
            self.eval_into(node, frame, |m, made| m.stack[base + i].put(made))?;
        }
        self.enter(function, f, closure.as_ref(), base, span)
    }

    /// Runs a function whose frame is on the stack from `base`, with its arguments.
    fn enter(
        &mut self,
        function: FunctionId,
        f: &FnCode,
        closure: Option<&Arc<Closure>>,
        base: usize,
        span: Span,
    ) -> Fast {
        self.step(span).map_err(|stop| self.stop(stop))?;
        self.nesting += f.depth as usize;
        if self.calls.len() >= self.limits.call_depth || self.nesting > self.limits.nesting {
            let stop = self.too_nested(f, span);
            return Err(self.stop(stop));
        }
        self.calls.push(Call { function, base, span, frame: None });
        let frame = Frame { base, closure };
        if f.has_defaults {
            for (i, p) in f.params.iter().enumerate() {
                if let (Some(default), Value::Unset) = (&p.default, &self.stack[base + i]) {
                    self.stack[base + i] = self.fresh(default, frame)?;
                }
            }
        }
        let value = self.scalar(&f.body, frame);
        // After a mistake things stay as they are: whoever goes on puts them right.
        if value.is_ok() || self.other.is_ok() {
            self.stack.truncate(base);
            self.calls.pop();
            self.nesting -= f.depth as usize;
        }
        value
    }

    #[cold]
    fn too_nested(&mut self, f: &FnCode, span: Span) -> Stop {
        let fault = Fault::new(format!("calls are nested more than {} deep", self.calls.len()))
            .label(format!("{} calls itself without an end?", called(&f.name)))
            .note("a function that calls itself needs a case in which it doesn't");
        self.fail(fault, span)
    }

    /// A call of a value. `callee` is its text, and `hides` where that is bound if it hides a built-in word.
    pub fn call_unknown(
        &mut self,
        function: &Value,
        callee: Span,
        hides: Option<Span>,
        args: &[ArgCode],
        span: Span,
        frame: Frame<'_>,
    ) -> Outcome {
        if !matches!(function, Value::Function(_) | Value::Builtin(_)) {
            let got = described(function, &self.build);
            let mut fault = Fault::new("only functions can be called").label(format!("this is {got}"));
            if let Some(bound) = hides {
                let name = self.sources.text(bound);
                let note = format!("the built-in one is `std.{name}`; or choose another name here");
                fault = fault.and_at(bound, "your own value of this name").note(note);
            }
            return Err(self.fail(fault, callee));
        }
        let mut values = Vec::with_capacity(args.len());
        for a in args {
            values.push((a.name.clone(), self.eval(&a.value, frame)?));
        }
        self.call_value(function, values, span, args)
    }

    /// A call of a value with values; `args` are their texts, where there are any.
    pub fn call_value(
        &mut self,
        function: &Value,
        values: Vec<(Option<EcoString>, Value)>,
        span: Span,
        args: &[ArgCode],
    ) -> Outcome {
        let program = self.program;
        let (params, rest): (Vec<(&str, bool, bool)>, bool) = match function {
            Value::Builtin(id) => {
                let word = catalog::word(*id);
                let params =
                    word.params.iter().map(|p| (p.name, p.default == Default::Required, p.positional)).collect();
                (params, word.params.last().is_some_and(|p| p.rest))
            }
            Value::Function(c) => {
                let Some(f) = program.functions.get(c.function.0 as usize) else { return Err(Stop::Reported) };
                (f.params.iter().map(|p| (p.name.as_str(), p.required, p.required)).collect(), false)
            }
            _ => return Err(self.fail(Fault::new("only functions can be called"), span)),
        };
        let name = word_name(function, program);
        let the = called(&name);
        let names: Vec<&str> = params.iter().map(|(n, _, _)| *n).collect();
        let takes = match &names[..] {
            [] => "it takes nothing".to_owned(),
            _ => format!("it takes: {}", names.join(", ")),
        };
        let noun = if let Value::Builtin(_) = function { "property" } else { "parameter" };
        let mut placed = vec![Value::Unset; params.len()];
        let mut next = 0;
        for (k, (arg, value)) in values.into_iter().enumerate() {
            let here = args.get(k).map_or(span, |a| a.name_span);
            let index = match &arg {
                Some(arg) => params.iter().position(|(n, _, _)| *n == arg.as_str()),
                None => {
                    next += 1;
                    let fits = params.get(next - 1).map_or(rest, |(_, _, positional)| *positional);
                    fits.then_some(next - 1)
                }
            };
            let Some(index) = index else {
                let fault = match &arg {
                    Some(arg) => Fault::new(format!("{the} has no {noun} `{arg}`"))
                        .label(property_meant(arg, names.iter().copied()).0),
                    None => match params.get(next - 1) {
                        Some((p, _, _)) => {
                            Fault::new(format!("`{p}` of {the} must be named")).label(format!("write `{p}: …`"))
                        }
                        None => Fault::new(format!("{the} has too many arguments")).label("this one is too much"),
                    },
                };
                return Err(self.fail(fault.note(takes), here));
            };
            if index >= placed.len() {
                placed.resize(index + 1, Value::Unset);
            }
            if !matches!(placed[index], Value::Unset) {
                return Err(self
                    .fail(Fault::new(format!("`{}` of {the} is given twice", names.get(index).unwrap_or(&""))), here));
            }
            placed[index] = value;
        }
        if let Some((missing, _, _)) =
            params.iter().zip(&placed).find(|((_, r, _), v)| *r && matches!(v, Value::Unset)).map(|(p, _)| p)
        {
            return Err(self.fail(Fault::new(format!("{the} needs `{missing}`")).note(takes), span));
        }
        match function {
            Value::Builtin(id) => self.run_word(*id, &mut placed, span, &[]),
            Value::Function(c) => {
                let Some(f) = program.functions.get(c.function.0 as usize) else { return Err(Stop::Reported) };
                let base = self.stack.len();
                self.stack.extend(placed);
                self.stack.resize(base + f.slots as usize, Value::Unset);
                match self.enter(c.function, f, Some(c), base, span) {
                    Ok(scalar) => Ok(scalar.into()),
                    Err(Other) => self.take(),
                }
            }
            _ => Ok(Value::None),
        }
    }
}

/// A function in a message; one without a name is called by none.
fn called(name: &str) -> String {
    if name == NAMELESS { "this function".into() } else { format!("`{name}`") }
}
