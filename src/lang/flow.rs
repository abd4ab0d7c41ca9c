//! What is run in turn, again and again, or on a condition.

use super::code::*;
use super::fault::{Fault, Stop};
use super::machine::{Frame, Machine};
use super::scalar::{Fast, Made, Other, Scalar};
use super::value::Value;
use super::word::described;
use crate::diag::Span;

impl Machine<'_> {
    /// The value of the last one. What is only added to the scene is independent of what comes after: a mistake in it
    /// doesn't hide theirs.
    pub fn block(&mut self, nodes: &[Node], frame: Frame<'_>) -> Fast {
        let Some((last, before)) = nodes.split_last() else { return Ok(Scalar::None) };
        let mut failed = false;
        for n in before {
            if self.build.is_cancelled() {
                return Err(self.stop(Stop::Cancelled));
            }
            if let Code::Emit(_) = n.code {
                failed |= !self.attempt(n, frame, |_, _| {}).map_err(|stop| self.stop(stop))?;
            } else {
                self.run_part(n, frame)?;
            }
        }
        if self.build.is_cancelled() {
            return Err(self.stop(Stop::Cancelled));
        }
        let value = if let Code::Emit(_) = last.code {
            failed |= !self.attempt(last, frame, |_, _| {}).map_err(|stop| self.stop(stop))?;
            Ok(Scalar::None)
        } else if failed {
            self.run_part(last, frame).map(|()| Scalar::None)
        } else {
            return self.scalar(last, frame);
        };
        if value.is_ok() && failed { Err(self.stop(Stop::Reported)) } else { value }
    }

    #[inline(never)]
    pub fn for_(&mut self, f: &ForCode, frame: Frame<'_>) -> Fast {
        let over = self.fresh(&f.over, frame)?;
        let slot = frame.base + f.slot as usize;
        if let Value::Range(range) = over {
            for i in 0..range.len() {
                self.stack[slot].put(Made::Scalar(Scalar::Number(range.from + i as f64)));
                self.turn(f, frame)?;
            }
            return Ok(Scalar::None);
        }
        if !matches!(over, Value::List(_) | Value::Vec3(_)) {
            let stop = self.no_list(f, &over);
            return Err(self.stop(stop));
        }
        for i in 0..over.length().unwrap_or(0) {
            self.stack[slot] = over.item(i).unwrap_or(Value::None);
            self.turn(f, frame)?;
        }
        Ok(Scalar::None)
    }

    #[inline(never)]
    pub fn while_(&mut self, parts: &(Node, Node), span: Span, frame: Frame<'_>) -> Fast {
        let (condition, body) = parts;
        while self.condition(condition, frame)? {
            self.step(span).map_err(|stop| self.stop(stop))?;
            self.run_part(body, frame)?;
        }
        Ok(Scalar::None)
    }

    /// One turn of a loop.
    #[inline]
    fn turn(&mut self, f: &ForCode, frame: Frame<'_>) -> Result<(), Other> {
        self.step(f.over.span).map_err(|stop| self.stop(stop))?;
        if let Some(guard) = &f.guard
            && !self.condition(guard, frame)?
        {
            return Ok(());
        }
        self.run_part(&f.body, frame)
    }

    /// Whether a condition holds.
    pub fn condition(&mut self, node: &Node, frame: Frame<'_>) -> Result<bool, Other> {
        let value = match self.operand(node, frame) {
            Ok(Scalar::True) => return Ok(true),
            Ok(Scalar::False) => return Ok(false),
            Ok(scalar) => scalar.into(),
            Err(Other) => self.left()?,
        };
        let stop = self.no_condition(&value, node.span);
        Err(self.stop(stop))
    }

    /// Why there is no loop over a value.
    #[cold]
    fn no_list(&mut self, f: &ForCode, over: &Value) -> Stop {
        let got = described(over, &self.build);
        let fault = Fault::new(format!("`for` goes through a list or a range, got {got}"));
        let fault = if let Value::Number(_) = over { fault.label("for a count write `0..n`") } else { fault };
        self.fail(fault, f.over.span)
    }

    /// Why a value is no condition.
    #[cold]
    fn no_condition(&mut self, value: &Value, span: Span) -> Stop {
        let got = described(value, &self.build);
        let fault = Fault::new(format!("a condition must be true or false, got {got}"));
        let fault = match value {
            Value::Number(_) => fault.label("compare it with something, as in `n > 0`"),
            Value::Angle(_) => fault.label("compare it with something, as in `a > 0deg`"),
            _ => fault,
        };
        self.fail(fault, span)
    }
}
