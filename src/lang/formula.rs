//! Arithmetic of plain numbers as a list of steps: what an expression is where all names in it stand for numbers, as they
//! nearly always do. It has no other effect than its value, so wherever one of its names stands for something else, or a
//! result isn't finite, it is given up and the expression evaluated from the start in the ordinary way, which knows what to say.

use super::ast::Op;
use super::code::*;
use super::machine::{Frame, Machine};
use super::ops;
use super::scalar::Scalar;
use super::value::Value;
use crate::math::fun;

/// Most numbers that are kept for later, and most steps: an expression that is given up has cost no more than that.
const KEPT: usize = 8;
const STEPS: usize = 64;

/// The node, as a formula where it can be one.
pub fn with_formula(node: Node) -> Node {
    let compiled = match &node.code {
        Code::Binary(o) => operation(o),
        Code::Apply(a) => applied(a),
        Code::Negate(of) => part(of).map(|p| p.then(Step::Negate)),
        _ => None,
    };
    match compiled {
        Some(Part { steps, is_angle }) if steps.len() <= STEPS && depth(&steps) <= KEPT => {
            let span = node.span;
            Node { code: Code::Formula(Box::new(Formula { steps, is_angle, tree: node })), span }
        }
        _ => node,
    }
}

/// The steps of a part, and what it is.
struct Part {
    steps: Vec<Step>,
    is_angle: bool,
}

impl Part {
    fn then(mut self, step: Step) -> Part {
        self.steps.push(step);
        self
    }
}

fn part(node: &Node) -> Option<Part> {
    let (source, is_angle) = match &node.code {
        Code::Formula(f) => return Some(Part { steps: f.steps.clone(), is_angle: f.is_angle }),
        Code::Const(Value::Number(x)) => (Source::Constant(*x), false),
        Code::Const(Value::Angle(x)) => (Source::Constant(*x), true),
        Code::Local(i) => (Source::Local(*i), false),
        Code::Global(i) => (Source::Global(*i), false),
        Code::Field { of, item: Some(item), .. } => match of.code {
            Code::Local(i) => (Source::Item(i, *item), false),
            _ => return None,
        },
        _ => return None,
    };
    Some(Part { steps: vec![Step::Take(source)], is_angle })
}

fn operation(o: &Operation) -> Option<Part> {
    let (mut a, b) = (part(&o.a)?, part(&o.b)?);
    a.is_angle = match (a.is_angle, o.op, b.is_angle) {
        (false, Op::Add | Op::Subtract | Op::Multiply | Op::Divide | Op::Remainder | Op::Power, false) => false,
        (true, Op::Add | Op::Subtract | Op::Remainder, true) => true,
        (true, Op::Divide, true) => false,
        (true, Op::Multiply | Op::Divide, false) | (false, Op::Multiply, true) => true,
        _ => return None,
    };
    match b.steps[..] {
        [Step::Take(source)] => a.steps.push(match (o.op, source) {
            (Op::Add, Source::Constant(c)) => Step::AddConstant(c),
            (Op::Subtract, Source::Constant(c)) => Step::AddConstant(-c),
            (Op::Multiply, Source::Constant(c)) => Step::MultiplyConstant(c),
            (Op::Divide, Source::Constant(c)) => Step::DivideConstant(c),
            (Op::Add, Source::Local(i)) => Step::AddLocal(i),
            (Op::Subtract, Source::Local(i)) => Step::SubtractLocal(i),
            (Op::Multiply, Source::Local(i)) => Step::MultiplyLocal(i),
            (Op::Divide, Source::Local(i)) => Step::DivideLocal(i),
            (op, source) => Step::With(op, source),
        }),
        _ => {
            a.steps.extend(b.steps);
            a.steps.push(Step::Join(o.op));
        }
    }
    Some(a)
}

fn applied(apply: &Apply) -> Option<Part> {
    let [(_, of)] = &apply.args;
    let of = part(of)?;
    let step = match (apply.function, of.is_angle) {
        (Function1::OfNumber(f), false) => Step::Number(f),
        (Function1::OfAngle(f), true) => Step::Angle(f),
        _ => return None,
    };
    Some(Part { is_angle: false, ..of.then(step) })
}

/// Most numbers that are kept at once.
fn depth(steps: &[Step]) -> usize {
    let mut most = 0;
    steps.iter().fold(0, |depth: usize, step| {
        let depth = match step {
            Step::Take(_) => depth + 1,
            Step::Join(_) => depth.saturating_sub(1),
            _ => depth,
        };
        most = depth.max(most);
        depth
    });
    most
}

impl Machine<'_> {
    /// Its value, where all is as it nearly always is.
    #[inline]
    pub fn formula(&self, formula: &Formula, frame: Frame<'_>) -> Option<Scalar> {
        let x = self.number_of(&formula.steps, frame)?;
        Some(if formula.is_angle { Scalar::Angle(x) } else { Scalar::Number(x) })
    }

    fn number_of(&self, steps: &[Step], frame: Frame<'_>) -> Option<f64> {
        let (locals, globals) = (self.stack.get(frame.base..)?, &self.globals[..]);
        let local = |i: u32| locals.get(i as usize)?.number();
        let mut kept = [0.0; KEPT];
        let (mut depth, mut x) = (0, 0.0);
        for step in steps {
            x = match step {
                Step::Take(source) => {
                    *kept.get_mut(depth)? = x;
                    depth += 1;
                    source.read(locals, globals)?
                }
                Step::AddConstant(c) => x + c,
                Step::MultiplyConstant(c) => x * c,
                Step::DivideConstant(c) => x / c,
                Step::AddLocal(i) => x + local(*i)?,
                Step::SubtractLocal(i) => x - local(*i)?,
                Step::MultiplyLocal(i) => x * local(*i)?,
                Step::DivideLocal(i) => x / local(*i)?,
                Step::With(op, source) => compute(*op, x, source.read(locals, globals)?),
                Step::Join(op) => {
                    depth -= 1;
                    compute(*op, *kept.get(depth)?, x)
                }
                Step::Number(f) => f(x),
                Step::Angle(f) => f(x + 0.0),
                Step::Negate => -x,
            };
            if !x.is_finite() {
                return None;
            }
        }
        Some(x)
    }
}

impl Source {
    #[inline(always)]
    fn read(self, locals: &[Value], globals: &[Value]) -> Option<f64> {
        match self {
            Source::Constant(x) => Some(x),
            Source::Local(i) => locals.get(i as usize)?.number(),
            Source::Global(i) => globals.get(i as usize)?.number(),
            Source::Item(i, item) => match locals.get(i as usize)? {
                Value::Vec3(v) => v.get(usize::from(item)).copied(),
                _ => None,
            },
        }
    }
}

#[inline(always)]
fn compute(op: Op, x: f64, y: f64) -> f64 {
    match op {
        Op::Add => x + y,
        Op::Subtract => x - y,
        Op::Multiply => x * y,
        Op::Divide | Op::Remainder => ops::quotient(op, x, y),
        Op::Power => fun::pow(x, y),
        _ => f64::NAN,
    }
}
