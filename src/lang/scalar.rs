//! The fast way of the evaluator: what is a number, an angle or a truth value goes from part to part in registers. All else,
//! a mistake too, is left in the machine, and passed on from there.

use super::code::*;
use super::fault::{Outcome, Stop};
use super::machine::{Frame, Machine};
use super::value::Value;
use crate::diag::Span;
use ecow::EcoVec;
use std::mem::{forget, replace};

/// A value that fits a register.
#[derive(Clone, Copy, Debug)]
pub enum Scalar {
    None,
    False,
    True,
    Number(f64),
    /// In degrees.
    Angle(f64),
}

/// A value on its way to where it belongs.
pub enum Made {
    Scalar(Scalar),
    Vector([f64; 3]),
    Other(Value),
}

/// Not a [`Scalar`]: what it is stands in the machine, for whoever comes next.
#[derive(Clone, Copy, Debug)]
pub struct Other;

/// A scalar; anything else is left in the machine.
pub type Fast = Result<Scalar, Other>;

impl From<bool> for Scalar {
    fn from(b: bool) -> Scalar {
        if b { Scalar::True } else { Scalar::False }
    }
}

impl From<Scalar> for Value {
    #[inline]
    fn from(s: Scalar) -> Value {
        match s {
            Scalar::None => Value::None,
            Scalar::False => Value::Bool(false),
            Scalar::True => Value::Bool(true),
            Scalar::Number(x) => Value::Number(x),
            Scalar::Angle(x) => Value::Angle(x),
        }
    }
}

impl Value {
    /// Its number.
    #[inline(always)]
    pub fn number(&self) -> Option<f64> {
        if let Value::Number(x) = self { Some(*x) } else { None }
    }

    /// As a scalar, where it is one.
    #[inline(always)]
    fn scalar(&self) -> Option<Scalar> {
        match self {
            Value::Number(x) => Some(Scalar::Number(*x)),
            Value::Angle(x) => Some(Scalar::Angle(*x)),
            Value::Bool(b) => Some((*b).into()),
            Value::None => Some(Scalar::None),
            _ => None,
        }
    }

    /// Puts what was made in this one's place. A number on a number, by far the most frequent, is one store: to make a value
    /// and copy it would have the copy wait for its parts.
    #[inline(always)]
    pub fn put(&mut self, made: Made) {
        match (&mut *self, made) {
            (Value::Number(old), Made::Scalar(Scalar::Number(new))) => *old = new,
            (Value::Vec3(old), Made::Vector(new)) => *old = new,
            // Nothing is there to be let go of, which the compiler doesn't see.
            (Value::Unset, Made::Scalar(Scalar::Number(new))) => forget(replace(self, Value::Number(new))),
            (_, made) => self.put_any(made),
        }
    }

    #[inline(never)]
    fn put_any(&mut self, made: Made) {
        *self = match made {
            Made::Scalar(new) => new.into(),
            Made::Vector(new) => Value::Vec3(new),
            Made::Other(new) => new,
        };
    }
}

impl Machine<'_> {
    /// The value of a piece of program.
    #[inline]
    pub fn eval(&mut self, node: &Node, frame: Frame<'_>) -> Outcome {
        match self.scalar(node, frame) {
            Ok(scalar) => Ok(scalar.into()),
            Err(Other) => self.take(),
        }
    }

    /// What was left.
    #[inline]
    pub fn take(&mut self) -> Outcome {
        replace(&mut self.other, Ok(Value::None))
    }

    /// What was left, where it is a value; a mistake is left again.
    #[inline(never)]
    pub fn left(&mut self) -> Result<Value, Other> {
        match self.take() {
            Ok(value) => Ok(value),
            Err(stop) => Err(self.stop(stop)),
        }
    }

    /// Leaves what isn't a scalar.
    #[inline]
    pub fn leave(&mut self, outcome: Outcome) -> Fast {
        if let Ok(value) = &outcome
            && let Some(scalar) = value.scalar()
        {
            return Ok(scalar);
        }
        self.other = outcome;
        Err(Other)
    }

    /// Leaves a mistake.
    #[cold]
    pub fn stop(&mut self, stop: Stop) -> Other {
        self.other = Err(stop);
        Other
    }

    /// The value of a slot, where the node is no more than one.
    #[inline]
    fn slot<'a>(&'a self, node: &Node, frame: Frame<'a>) -> Option<&'a Value> {
        match &node.code {
            Code::Local(i) => Some(&self.stack[frame.base + *i as usize]),
            Code::Global(i) => Some(&self.globals[*i as usize]),
            Code::Capture(i) => frame.closure.and_then(|c| c.captures.get(*i as usize)),
            _ => None,
        }
    }

    /// As [`scalar`](Machine::scalar), and without a call for the leaves of the tree.
    #[inline(always)]
    pub fn operand(&mut self, node: &Node, frame: Frame<'_>) -> Fast {
        let value = match &node.code {
            Code::Local(i) => &self.stack[frame.base + *i as usize],
            Code::Const(v) => v,
            Code::Formula(f) => match self.formula(f, frame) {
                Some(s) => return Ok(s),
                None => return self.scalar(&f.tree, frame),
            },
            Code::Binary(operation) => return self.binary(operation, node, frame),
            _ => return self.scalar(node, frame),
        };
        match value {
            Value::Number(x) => Ok(Scalar::Number(*x)),
            _ => self.scalar(node, frame),
        }
    }

    /// The value of a piece of program.
    pub fn scalar(&mut self, node: &Node, frame: Frame<'_>) -> Fast {
        match &node.code {
            Code::Const(v) => match v.scalar() {
                Some(s) => Ok(s),
                None => self.rare(node, frame),
            },
            Code::Local(_) | Code::Global(_) | Code::Capture(_) => match self.slot(node, frame) {
                Some(v) if let Some(s) = v.scalar() => Ok(s),
                _ => self.rare(node, frame),
            },
            Code::Formula(f) => match self.formula(f, frame) {
                Some(s) => Ok(s),
                None => self.scalar(&f.tree, frame),
            },
            Code::Binary(operation) => self.binary(operation, node, frame),
            Code::Field { of, item, .. } => {
                if let Some(i) = item
                    && let Some(Value::Vec3(v)) = self.slot(of, frame)
                    && let Some(x) = v.get(usize::from(*i))
                {
                    return Ok(Scalar::Number(*x));
                }
                self.rare(node, frame)
            }
            Code::Apply(apply) => self.apply(apply, node.span, frame),
            Code::Call { function, callee, args } => {
                self.call_known(*function, callee.as_deref(), args, node.span, frame)
            }
            Code::Block(nodes) => self.block(nodes, frame),
            Code::If { arms, otherwise } => {
                for (condition, body) in arms {
                    if self.condition(condition, frame)? {
                        return self.scalar(body, frame);
                    }
                }
                otherwise.as_ref().map_or(Ok(Scalar::None), |n| self.scalar(n, frame))
            }
            Code::SetLocal(i, value) => {
                self.eval_into(value, frame, |m, made| m.stack[frame.base + *i as usize].put(made))?;
                Ok(Scalar::None)
            }
            Code::SetGlobal(i, value) => {
                self.eval_into(value, frame, |m, made| m.globals[*i as usize].put(made))?;
                Ok(Scalar::None)
            }
            Code::For(f) => self.for_(f, frame),
            Code::While(w) => self.while_(w, node.span, frame),
            Code::And(ab) => Ok((self.condition(&ab.0, frame)? && self.condition(&ab.1, frame)?).into()),
            Code::Or(ab) => Ok((self.condition(&ab.0, frame)? || self.condition(&ab.1, frame)?).into()),
            Code::Not(a) => Ok((!self.condition(a, frame)?).into()),
            _ => self.rare(node, frame),
        }
    }

    /// Evaluates, and gives the value to `put`; a mistake is left.
    #[inline(always)]
    pub fn eval_into(&mut self, node: &Node, frame: Frame<'_>, put: impl FnOnce(&mut Self, Made)) -> Result<(), Other> {
        if let Code::List(items) = &node.code
            && let Some(items) = items.as_array()
        {
            match self.vector(items, node.span, frame) {
                Ok(v) => put(self, Made::Vector(v)),
                Err(Other) => {
                    let list = self.left()?;
                    put(self, Made::Other(list));
                }
            }
            return Ok(());
        }
        match self.operand(node, frame) {
            Ok(scalar) => put(self, Made::Scalar(scalar)),
            Err(Other) => {
                let value = self.left()?;
                put(self, Made::Other(value));
            }
        }
        Ok(())
    }

    /// A list of three numbers; one of anything else is left.
    #[inline(always)]
    pub fn vector(&mut self, items: &[Node; 3], span: Span, frame: Frame<'_>) -> Result<[f64; 3], Other> {
        let [x, y, z] = items;
        let x = match self.operand(x, frame) {
            Ok(Scalar::Number(x)) => x,
            odd => return Err(self.list_of_three([None, None], odd, items, span, frame)),
        };
        let y = match self.operand(y, frame) {
            Ok(Scalar::Number(y)) => y,
            odd => return Err(self.list_of_three([Some(x), None], odd, items, span, frame)),
        };
        match self.operand(z, frame) {
            Ok(Scalar::Number(z)) => Ok([x, y, z]),
            odd => Err(self.list_of_three([Some(x), Some(y)], odd, items, span, frame)),
        }
    }

    /// Leaves a list of three values that aren't all numbers: `before` those that are, then `odd`.
    #[inline(never)]
    fn list_of_three(
        &mut self,
        before: [Option<f64>; 2],
        odd: Fast,
        items: &[Node; 3],
        span: Span,
        frame: Frame<'_>,
    ) -> Other {
        let mut values: EcoVec<Value> = before.into_iter().flatten().map(Value::Number).collect();
        let mut next = odd;
        loop {
            match next.map(Value::from).or_else(|Other| self.left()) {
                Ok(value) => values.push(value),
                Err(Other) => return Other,
            }
            let Some(node) = items.get(values.len()) else { break };
            next = self.scalar(node, frame);
        }
        for v in &values {
            if let Err(stop) = self.hold(v, span) {
                return self.stop(stop);
            }
        }
        self.other = Ok(Value::List(values));
        Other
    }

    /// A value; a mistake is left.
    #[inline]
    pub fn fresh(&mut self, node: &Node, frame: Frame<'_>) -> Result<Value, Other> {
        match self.scalar(node, frame) {
            Ok(scalar) => Ok(scalar.into()),
            Err(Other) => self.left(),
        }
    }

    /// Runs what has no value, or one that isn't asked for; a mistake is left.
    #[inline]
    pub fn run_part(&mut self, node: &Node, frame: Frame<'_>) -> Result<(), Other> {
        match self.scalar(node, frame) {
            Ok(_) => Ok(()),
            Err(Other) => self.left().map(drop),
        }
    }
}
