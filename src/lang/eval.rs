//! Evaluates expressions.

use super::code::*;
use super::fault::{Fault, Outcome, Stop};
use super::machine::{Frame, Machine};
use super::ops;
use super::scalar::{Fast, Made, Other};
use super::value::{Closure, Value};
use crate::diag::Span;
use ecow::{EcoString, EcoVec};
use std::sync::Arc;

impl Machine<'_> {
    /// What isn't for the fast way.
    #[inline(never)]
    pub fn rare(&mut self, node: &Node, frame: Frame<'_>) -> Fast {
        let outcome = self.any(node, frame);
        self.leave(outcome)
    }

    fn any(&mut self, node: &Node, frame: Frame<'_>) -> Outcome {
        let span = node.span;
        match &node.code {
            Code::Const(v) => Ok(v.clone()),
            Code::Local(i) => self.present(&self.stack[frame.base + *i as usize], span),
            Code::Global(i) => self.present(&self.globals[*i as usize], span),
            Code::Capture(i) => match frame.closure.and_then(|c| c.captures.get(*i as usize)) {
                Some(v) => self.present(v, span),
                None => Err(Stop::Reported),
            },
            Code::Field { of, name, .. } => {
                let value = self.eval(of, frame)?;
                self.field(&value, name, span)
            }
            Code::List(items) => self.list(items, span, frame),
            Code::CallBuiltin { word, args } => self.call_builtin(*word, args, span, frame),
            Code::CallValue { callee, args, hides } => {
                let function = self.eval(callee, frame)?;
                self.call_unknown(&function, callee.span, *hides, args, span, frame)
            }
            Code::Negate(a) => {
                let a = self.eval(a, frame)?;
                ops::negate(&a, &mut self.build, span).map_err(|f| self.fail(f, span))
            }
            Code::Index(ab) => {
                let of = self.eval(&ab.0, frame)?;
                let index = self.eval(&ab.1, frame)?;
                self.index(&of, &index, ab)
            }
            Code::Closure(function, captures) => {
                let captures: Box<[Value]> = captures.iter().map(|c| self.capture(*c, frame)).collect();
                for v in &captures {
                    self.hold(v, span)?;
                }
                Ok(Value::Function(Arc::new(Closure { function: *function, captures })))
            }
            Code::Discard(value) => self.discard(value, frame),
            Code::Emit(value) => {
                let v = self.eval(value, frame)?;
                self.emit(&v, value.span)?;
                Ok(Value::None)
            }
            Code::Push(value) => {
                let v = self.eval(value, frame)?;
                self.push(v, span)
            }
            Code::Collected(items) => self.collect(items, frame),
            Code::Text(parts) => self.text(parts, span, frame),
            Code::Record(args) => {
                let mut record = super::value::Record::default();
                for a in args {
                    let value = self.eval(&a.value, frame)?;
                    self.hold(&value, span)?;
                    record.insert(a.name.clone().unwrap_or_default(), value);
                }
                Ok(Value::Record(Arc::new(record)))
            }
            Code::Group { args, body } => self.group(args, body, span, frame),
            Code::With(of, args) => self.with(of, args, span, frame),
            Code::Module(slots) => {
                let values = slots.iter().map(|(name, slot)| (name.clone(), self.globals[*slot as usize].clone()));
                Ok(Value::Record(Arc::new(values.collect())))
            }
            Code::Param(p) => self.param(p, frame),
            Code::Current => frame.closure.map(|c| Value::Function(c.clone())).ok_or(Stop::Reported),
            Code::Failed => Err(Stop::Reported),
            _ => self.eval(node, frame),
        }
    }

    #[inline]
    pub fn present(&self, value: &Value, span: Span) -> Outcome {
        if matches!(value, Value::Unset | Value::Poison) {
            return Err(self.missing(value, span));
        }
        Ok(value.clone())
    }

    fn capture(&self, from: CaptureFrom, frame: Frame<'_>) -> Value {
        match from {
            CaptureFrom::Local(i) => self.stack[frame.base + i as usize].clone(),
            CaptureFrom::Capture(i) => {
                frame.closure.and_then(|c| c.captures.get(i as usize)).cloned().unwrap_or(Value::Poison)
            }
            CaptureFrom::Current => frame.closure.map_or(Value::Poison, |c| Value::Function(c.clone())),
        }
    }

    /// Evaluates what others don't depend on: a mistake is reported and the state is as before, so that others are found too.
    /// False where there was one; else `put` is given the value.
    #[inline]
    pub fn attempt(&mut self, node: &Node, frame: Frame<'_>, put: impl FnOnce(&mut Self, Made)) -> Result<bool, Stop> {
        let before = (self.stack.len(), self.calls.len(), self.nesting, self.collected.len(), self.lists.len());
        if let Ok(()) = self.eval_into(node, frame, put) {
            return Ok(true);
        }
        match self.take() {
            Err(Stop::Error(d)) if self.errors.len() <= self.limits.errors => self.errors.push(*d),
            Ok(_) | Err(Stop::Reported) => {}
            Err(stop) => return Err(stop),
        }
        self.stack.truncate(before.0);
        self.calls.truncate(before.1);
        self.nesting = before.2;
        self.collected.truncate(before.3);
        self.lists.truncate(before.4);
        Ok(false)
    }

    fn list(&mut self, items: &[Node], span: Span, frame: Frame<'_>) -> Outcome {
        if let Some(items) = items.as_array() {
            return match self.vector(items, span, frame) {
                Ok(v) => Ok(Value::Vec3(v)),
                Err(Other) => self.take(),
            };
        }
        let mut out = EcoVec::with_capacity(items.len());
        for n in items {
            if self.build.is_cancelled() {
                return Err(Stop::Cancelled);
            }
            let v = self.eval(n, frame)?;
            self.hold(&v, span)?;
            out.push(v);
        }
        Ok(Value::List(out))
    }

    fn text(&mut self, parts: &[TextCode], span: Span, frame: Frame<'_>) -> Outcome {
        let mut out = EcoString::new();
        let most = self.limits.text_length;
        for p in parts {
            match p {
                TextCode::Literal(s) => out.push_str(s),
                TextCode::Node(n) => out.push_str(&self.eval(n, frame)?.interpolated(most)),
            }
            if out.len() > most {
                let note = "usually a loop that makes a text longer and longer";
                return Err(self.fail(Fault::budget(format!("this text is longer than {most} letters"), note), span));
            }
        }
        self.text_bytes += out.len();
        if self.text_bytes > self.limits.text_total {
            let most = self.limits.text_total;
            let note = "usually a loop that runs too often";
            return Err(
                self.fail(Fault::budget(format!("the scene makes more than {most} letters of text"), note), span)
            );
        }
        Ok(Value::Text(out))
    }
}
