//! The state of a running program: its frames, the scene so far, and budgets; and how a fault gets its place.

use super::build::Build;
use super::catalog;
use super::code::*;
use super::fault::{Fault, Outcome, Stop};
use super::limits::Limits;
use super::repeat::Repeats;
use super::request::Param;
use super::value::{Closure, FunctionId, Value};
use super::word::Host;
use crate::diag::{CallFrame, Diagnostic, Diagnostics, Place, Span};
use crate::scene::NodeId;
use ecow::EcoVec;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

/// Runs a program.
pub struct Machine<'p> {
    pub program: &'p Program,
    pub build: Build<'p>,
    pub limits: Limits,
    pub globals: Vec<Value>,
    /// The frames, one after the other.
    pub stack: Vec<Value>,
    pub calls: Vec<Call>,
    /// Expressions within each other over all running calls.
    pub nesting: usize,
    /// What the part that has just run gave, where that is no scalar.
    pub other: Outcome,
    /// What the scene blocks around have been given.
    pub collected: Vec<Vec<NodeId>>,
    /// The lists being made.
    pub lists: Vec<EcoVec<Value>>,
    pub text_bytes: usize,
    /// Lists, records and functions made so far that hold others.
    pub containers: usize,
    /// The call of a built-in word that is running.
    pub here: Span,
    /// Its first parameter's argument, or the call.
    pub argument: Span,
    /// Values from the command line by parameter name.
    pub set: HashMap<String, SetValue<'p>>,
    pub params: Vec<Param>,
    /// Whether the traces of shapes show arguments.
    pub record_arguments: bool,
    pub errors: Diagnostics,
    /// Default values' texts.
    pub sources: &'p crate::diag::Sources,
}

/// A value of `--set`.
pub struct SetValue<'p> {
    /// As it was typed.
    pub raw: String,
    /// All of it in its pseudo-file.
    pub span: Span,
    /// Its expression; why it isn't one, otherwise.
    pub node: Result<&'p Node, Diagnostic>,
}

/// A running call of a function of the program.
pub struct Call {
    pub function: FunctionId,
    pub base: usize,
    /// The call expression.
    pub span: Span,
    /// Its part of a trace, once one was asked for.
    pub frame: Option<Arc<CallFrame>>,
}

/// Where the running function finds its values.
#[derive(Clone, Copy)]
pub struct Frame<'a> {
    pub base: usize,
    pub closure: Option<&'a Arc<Closure>>,
}

impl<'p> Machine<'p> {
    /// Runs a file's outermost statements; one that fails makes its names unusable and the others go on.
    /// False where a budget is used up.
    pub fn run(&mut self, module: &'p ModuleCode, main: bool) -> bool {
        for (slot, id) in &module.functions {
            self.globals[*slot as usize] = Value::Function(Arc::new(Closure { function: *id, captures: Box::new([]) }));
        }
        let base = self.stack.len();
        self.stack.resize(base + module.slots as usize, Value::Unset);
        self.collected.push(Vec::new());
        let slots = base..base + module.slots as usize;
        let mut repeats = Repeats::new(module, &self.sources.get(module.file).text);
        let mut go_on = true;
        let mut statements = module.statements.iter();
        while go_on {
            let next = statements.as_slice().first();
            // What is like a statement is for the scene, as that is.
            let at = next.map_or(u32::MAX, |s| s.node.span.start);
            let (node, binds) = match (main.then(|| repeats.next_before(at)).flatten(), next) {
                (Some(node), _) => (node, &[][..]),
                (None, Some(s)) => {
                    statements.next();
                    if s.for_scene && !main {
                        continue;
                    }
                    (&s.node, &s.binds[..])
                }
                (None, None) => break,
            };
            if self.build.is_cancelled() {
                return false;
            }
            go_on = self.run_statement(node, binds, slots.clone());
        }
        self.stack.truncate(base);
        let roots = self.collected.pop().unwrap_or_default();
        if main {
            self.build.scene.roots = roots;
        }
        go_on
    }

    /// Runs an outermost statement, whose names are in `slots`; false where a budget is used up.
    fn run_statement(&mut self, node: &Node, binds: &[u32], slots: Range<usize>) -> bool {
        let Err(stop) = self.eval(node, Frame { base: slots.start, closure: None }) else { return true };
        for slot in binds {
            self.globals[*slot as usize] = Value::Poison;
        }
        let go_on = self.report(stop, node.span);
        self.stack.truncate(slots.end);
        self.calls.clear();
        self.nesting = 0;
        self.collected.truncate(1);
        self.lists.clear();
        go_on
    }

    fn report(&mut self, stop: Stop, span: Span) -> bool {
        let stop = match stop {
            Stop::Fault(f) => self.locate(f, span, &[]),
            other => other,
        };
        match stop {
            Stop::Error(d) => self.errors.push(*d),
            Stop::Fatal(d) => {
                self.errors.push(*d);
                return false;
            }
            Stop::Cancelled => return false,
            _ => {}
        }
        // One more than is shown, so that it can be said that there are more.
        self.errors.len() <= self.limits.errors
    }

    /// Gives a fault its place and the calls that led there.
    #[cold]
    #[expect(clippy::boxed_local, reason = "faults travel boxed")]
    pub fn locate(&self, fault: Box<Fault>, span: Span, args: &[(u16, Node)]) -> Stop {
        if self.build.is_cancelled() {
            return Stop::Cancelled;
        }
        let fault = *fault;
        let main = fault
            .argument
            .and_then(|i| args.iter().find(|(k, _)| usize::from(*k) == i))
            .map_or(span, |(_, node)| node.span);
        let mut d = Diagnostic::error(fault.message).at(main, fault.label);
        if let Some((other, text)) = fault.other {
            d = d.at(other, text);
        }
        d.notes = fault.notes;
        d.fix = fault.fix;
        d = d.from_place(Place { span: main, trace: self.trace_with_arguments() });
        if fault.fatal { Stop::Fatal(Box::new(d)) } else { Stop::Error(Box::new(d)) }
    }

    /// An error at `span`.
    #[cold]
    pub fn fail(&self, fault: Box<Fault>, span: Span) -> Stop {
        self.locate(fault, span, &[])
    }

    /// The running calls with their arguments.
    fn trace_with_arguments(&self) -> Option<Arc<CallFrame>> {
        let frame =
            |parent, c: &Call| Some(Arc::new(CallFrame { call: self.call_text(c).into(), span: c.span, parent }));
        self.calls.iter().fold(None, frame)
    }

    /// `bead(u: 0.25, i: 60)`
    fn call_text(&self, c: &Call) -> String {
        let Some(f) = self.program.functions.get(c.function.0 as usize) else { return String::new() };
        let args: Vec<String> = f
            .params
            .iter()
            .enumerate()
            .filter_map(|(i, p)| {
                let value = self.stack.get(c.base + i)?;
                (!matches!(value, Value::Unset)).then(|| format!("{}: {}", p.name, value.show(40)))
            })
            .collect();
        format!("{}({})", f.name, args.join(", "))
    }

    fn trace(&mut self) -> Option<Arc<CallFrame>> {
        let mut parent = None;
        for i in 0..self.calls.len() {
            if self.calls[i].frame.is_none() {
                let c = &self.calls[i];
                let call = if self.record_arguments {
                    self.call_text(c)
                } else {
                    self.program
                        .functions
                        .get(c.function.0 as usize)
                        .map_or(String::new(), |f| format!("{}(…)", f.name))
                };
                let frame = CallFrame { call: call.into(), span: c.span, parent };
                self.calls[i].frame = Some(Arc::new(frame));
            }
            parent = self.calls[i].frame.clone();
        }
        parent
    }

    /// Counts a turn of a loop or a call.
    #[inline]
    pub fn step(&mut self, span: Span) -> Result<(), Stop> {
        self.build.spend(1).map_err(|f| self.fail(f, span))
    }

    /// Counts a value that holds others, where `inner` is one that does so itself.
    #[inline]
    pub fn hold(&mut self, inner: &Value, span: Span) -> Result<(), Stop> {
        if !matches!(inner, Value::List(_) | Value::Record(_) | Value::Function(_)) {
            return Ok(());
        }
        self.containers += 1;
        let most = self.limits.containers;
        if self.containers <= most {
            return Ok(());
        }
        let message = format!("the scene puts more than {most} lists, records and functions into others");
        Err(self.fail(Fault::budget(message, "usually a loop that wraps a value in itself"), span))
    }

    /// The value of a slot that may be without one.
    #[cold]
    pub fn missing(&self, value: &Value, span: Span) -> Stop {
        match value {
            Value::Unset => self.fail(
                Fault::new(format!("`{}` is used before it has a value", self.sources.text(span)))
                    .note("the function is called above the line that binds it; move that line up"),
                span,
            ),
            _ => Stop::Reported,
        }
    }
}

impl<'p> Host<'p> for Machine<'p> {
    fn build(&mut self) -> &mut Build<'p> {
        &mut self.build
    }
    fn place(&mut self) -> Place {
        Place { span: self.here, trace: self.trace() }
    }
    fn argument(&mut self) -> Span {
        self.argument
    }
    fn call(&mut self, function: &Value, args: &[Value]) -> Outcome {
        let here = self.here;
        let named: Vec<(Option<ecow::EcoString>, Value)> = args.iter().map(|a| (None, a.clone())).collect();
        let out = self.call_value(function, named, here, &[]);
        self.here = here;
        out
    }
    fn spend(&mut self, n: u64) -> Result<(), Stop> {
        Ok(self.build.spend(n)?)
    }
    fn hold(&mut self, inner: &Value) -> Result<(), Stop> {
        let here = self.here;
        Machine::hold(self, inner, here)
    }
}

/// A word's name.
pub fn word_name(value: &Value, program: &Program) -> String {
    match value {
        Value::Builtin(id) => catalog::word(*id).name.to_owned(),
        Value::Function(c) => {
            program.functions.get(c.function.0 as usize).map_or(String::new(), |f| f.name.to_string())
        }
        _ => String::new(),
    }
}
