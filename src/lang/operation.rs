//! Operators, and words that make a number of one number or angle: scalars first, all else the long way.

use super::ast::Op;
use super::code::*;
use super::machine::{Frame, Machine};
use super::ops;
use super::scalar::{Fast, Other, Scalar};
use super::value::Value;
use crate::diag::Span;

impl Machine<'_> {
    /// The value of an operator and what it takes.
    #[inline(never)]
    pub fn binary(&mut self, operation: &Operation, node: &Node, frame: Frame<'_>) -> Fast {
        let a = match self.operand(&operation.a, frame) {
            Ok(a) => a,
            Err(Other) => return self.of_other(operation, node, frame),
        };
        let b = self.operand(&operation.b, frame);
        if let (Scalar::Number(x), Ok(Scalar::Number(y))) = (a, b) {
            let number = match operation.op {
                Op::Add => x + y,
                Op::Subtract => x - y,
                Op::Multiply => x * y,
                Op::Divide | Op::Remainder => ops::quotient(operation.op, x, y),
                Op::Less => return Ok((x < y).into()),
                Op::Greater => return Ok((x > y).into()),
                _ => f64::NAN,
            };
            // What isn't finite is a mistake, or an operator of the long way.
            if number.is_finite() {
                return Ok(Scalar::Number(number));
            }
        }
        self.of_scalar(operation, a, b, node)
    }

    /// An operator on a scalar and any value.
    #[inline(never)]
    fn of_scalar(&mut self, operation: &Operation, a: Scalar, b: Fast, node: &Node) -> Fast {
        if let (Op::Multiply, Scalar::Number(x), Ok(Scalar::Angle(y)))
        | (Op::Multiply, Scalar::Angle(x), Ok(Scalar::Number(y))) = (operation.op, a, b)
            && (x * y).is_finite()
        {
            return Ok(Scalar::Angle(x * y));
        }
        let b = b.map_or_else(|Other| self.left(), |b| Ok(b.into()))?;
        self.operate(operation, &a.into(), &b, node)
    }

    /// An operator on what was left and what comes next.
    #[inline(never)]
    fn of_other(&mut self, operation: &Operation, node: &Node, frame: Frame<'_>) -> Fast {
        let a = self.left()?;
        let b = self.fresh(&operation.b, frame)?;
        self.operate(operation, &a, &b, node)
    }

    /// An operator on any two values.
    fn operate(&mut self, operation: &Operation, a: &Value, b: &Value, node: &Node) -> Fast {
        let outcome = ops::binary(operation.op, a, b, &mut self.build, node.span).map_err(|f| {
            let span = if f.argument == Some(1) { operation.b.span } else { node.span };
            self.fail(f, span)
        });
        self.leave(outcome)
    }

    /// A word that makes a number of one number or angle.
    pub fn apply(&mut self, apply: &Apply, span: Span, frame: Frame<'_>) -> Fast {
        let [(_, of)] = &apply.args;
        let mut value = match self.operand(of, frame) {
            Ok(scalar) => {
                let y = match (scalar, apply.function) {
                    (Scalar::Number(x), Function1::OfNumber(f)) => f(x),
                    (Scalar::Angle(x), Function1::OfAngle(f)) => f(x + 0.0), // -0 is 0
                    _ => f64::NAN,
                };
                if y.is_finite() {
                    return Ok(Scalar::Number(y));
                }
                scalar.into()
            }
            Err(Other) => self.left()?,
        };
        let outcome = self.run_word(apply.word, std::slice::from_mut(&mut value), span, &apply.args);
        self.leave(outcome)
    }
}
