//! Operators. They fail without a place; the evaluator adds it.

use super::ast::Op;
use super::build::Build;
use super::fault::Fault;
use super::value::{Range, Value, number_text};
use super::word::kind_of;
use crate::diag::Span;
use crate::math::fun;
use crate::scene::{Color, PatternKind};
use ecow::EcoVec;

type Made = Result<Value, Box<Fault>>;

/// `a op b`, all but `and` and `or`, which needn't look at `b`.
pub fn binary(op: Op, a: &Value, b: &Value, build: &mut Build, span: Span) -> Made {
    match op {
        Op::Equal => a.equals(b, build).map(Value::Bool),
        Op::NotEqual => a.equals(b, build).map(|e| Value::Bool(!e)),
        Op::Less | Op::LessEqual | Op::Greater | Op::GreaterEqual => compare(op, a, b, build),
        Op::Range | Op::RangeInclusive => range(op, a, b, build),
        _ => arithmetic(op, a, b, build, span),
    }
}

/// (1 − u)·a + u·b: weights rather than a + u·(b − a), so that both ends are exact.
pub fn lerp(a: &Value, b: &Value, u: f64, build: &mut Build, span: Span) -> Made {
    let x = binary(Op::Multiply, &Value::Number(1.0 - u), a, build, span)?;
    let y = binary(Op::Multiply, &Value::Number(u), b, build, span)?;
    binary(Op::Add, &x, &y, build, span)
}

/// `-a`
pub fn negate(a: &Value, build: &mut Build, span: Span) -> Made {
    match a {
        Value::Number(n) => Ok(Value::Number(-n)),
        Value::Angle(n) => Ok(Value::Angle(-n)),
        Value::Vec3(v) => Ok(Value::Vec3(v.map(|x| -x))),
        Value::List(_) | Value::Pattern(_) => arithmetic(Op::Multiply, &Value::Number(-1.0), a, build, span),
        other => Err(Fault::new(format!("`-` can't turn {} round", kind_of(other, build)))),
    }
}

/// Two finite numbers.
pub fn numbers(op: Op, a: f64, b: f64) -> Result<f64, Box<Fault>> {
    let r = match op {
        Op::Add => a + b,
        Op::Subtract => a - b,
        Op::Multiply => a * b,
        Op::Divide if b == 0.0 => return Err(Fault::new("division by 0").label("this is 0 here").on(1)),
        Op::Remainder if b == 0.0 => {
            return Err(Fault::new("remainder of a division by 0").label("this is 0 here").on(1));
        }
        Op::Divide | Op::Remainder => quotient(op, a, b),
        Op::Power => fun::pow(a, b),
        _ => f64::NAN,
    };
    if r.is_finite() { Ok(r) } else { Err(not_finite(op, a, b)) }
}

/// `a / b`, or what is left of `a`: its sign is that of `b`, so that a pattern goes on below 0. `b` isn't 0.
#[inline]
pub fn quotient(op: Op, a: f64, b: f64) -> f64 {
    let q = a / b;
    if op == Op::Divide { q } else { a - b * q.floor() }
}

#[cold]
fn not_finite(op: Op, a: f64, b: f64) -> Box<Fault> {
    let (a_text, b_text, sign) = (number_text(a), number_text(b), op.symbol());
    if op == Op::Power && a < 0.0 && b.fract() != 0.0 {
        return Fault::new(format!("{a_text} ^ {b_text} isn't a number"))
            .note("a negative number has whole powers only");
    }
    if op == Op::Power && a == 0.0 {
        return Fault::new(format!("0 ^ {b_text} is a division by 0"));
    }
    Fault::new(format!("{a_text} {sign} {b_text} is too large")).note("the largest number is about 1.8e308")
}

fn compare(op: Op, a: &Value, b: &Value, build: &Build) -> Made {
    let order = match (a, b) {
        (Value::Number(x), Value::Number(y)) | (Value::Angle(x), Value::Angle(y)) => x.partial_cmp(y),
        (Value::Text(x), Value::Text(y)) => Some(x.cmp(y)),
        _ => None,
    };
    let Some(order) = order else {
        let fault =
            Fault::new(format!("`{}` can't compare {} and {}", op.symbol(), kind_of(a, build), kind_of(b, build)));
        return Err(match (a, b) {
            (Value::Bool(_), _) => fault.note("for `a < b < c` write `a < b and b < c`"),
            (Value::Number(_), Value::Angle(_)) | (Value::Angle(_), Value::Number(_)) => {
                fault.note("write the angle's unit: `30deg`")
            }
            _ => fault,
        });
    };
    Ok(Value::Bool(match op {
        Op::Less => order.is_lt(),
        Op::LessEqual => order.is_le(),
        Op::Greater => order.is_gt(),
        _ => order.is_ge(),
    }))
}

/// Ends of a range: beyond 2^53 whole numbers aren't told apart.
const RANGE_END: f64 = 9_007_199_254_740_992.0;

fn range(op: Op, a: &Value, b: &Value, build: &Build) -> Made {
    match (a, b) {
        (Value::Number(from), Value::Number(to)) if from.abs() <= RANGE_END && to.abs() <= RANGE_END => {
            Ok(Value::Range(Range { from: *from, to: *to, inclusive: op == Op::RangeInclusive }))
        }
        (Value::Number(_), Value::Number(_)) => {
            Err(Fault::new("the ends of a range lie within 9007199254740992, the last number that can be counted to"))
        }
        _ => {
            let (from, to) = (kind_of(a, build), kind_of(b, build));
            let fault = Fault::new(format!("a range goes from a number to a number, got {from} and {to}"));
            Err(match (a, b) {
                (Value::Angle(_), _) | (_, Value::Angle(_)) => {
                    fault.note("count with numbers and multiply: `for i in 0..9 { … i * 10deg … }`")
                }
                _ => fault,
            })
        }
    }
}

fn arithmetic(op: Op, a: &Value, b: &Value, build: &mut Build, span: Span) -> Made {
    use Value::{Angle, List, Number, Pattern, Vec3};
    match (a, b) {
        (Number(x), Number(y)) => numbers(op, *x, *y).map(Number),
        (Vec3(x), Vec3(y)) => zip3(op, x, y),
        (Vec3(x), Number(y)) if op != Op::Add && op != Op::Subtract => zip3(op, x, &[*y; 3]),
        (Number(x), Vec3(y)) if op == Op::Multiply => zip3(op, &[*x; 3], y),
        (Angle(x), Angle(y)) if matches!(op, Op::Add | Op::Subtract | Op::Remainder) => numbers(op, *x, *y).map(Angle),
        (Angle(x), Angle(y)) if op == Op::Divide => numbers(op, *x, *y).map(Number),
        (Angle(x), Number(y)) if matches!(op, Op::Multiply | Op::Divide) => numbers(op, *x, *y).map(Angle),
        (Number(x), Angle(y)) if op == Op::Multiply => numbers(op, *x, *y).map(Angle),
        (Value::Color(x), Value::Color(y)) if matches!(op, Op::Add | Op::Subtract | Op::Multiply) => {
            color(op, x.0, y.0)
        }
        (Value::Color(x), Number(y)) if matches!(op, Op::Multiply | Op::Divide) => color(op, x.0, [*y; 3]),
        (Number(x), Value::Color(y)) if op == Op::Multiply => color(op, [*x; 3], y.0),
        (Pattern(_), Pattern(_) | Number(_) | Value::Color(_)) | (Number(_) | Value::Color(_), Pattern(_)) => {
            patterns(op, a, b, build, span)
        }
        (List(x), List(y)) => lists(op, x, y, build, span),
        (List(x), Number(_)) if op != Op::Add && op != Op::Subtract => {
            each(x, build, |v, build| arithmetic(op, v, b, build, span))
        }
        (Number(_), List(y)) if op == Op::Multiply => each(y, build, |v, build| arithmetic(op, a, v, build, span)),
        (List(_), Vec3(_)) | (Vec3(_), List(_)) => Err(lengths(a, b)),
        _ => Err(unfit(op, a, b, build)),
    }
}

fn zip3(op: Op, a: &[f64; 3], b: &[f64; 3]) -> Made {
    if op == Op::Power {
        return Err(Fault::new("`^` takes numbers, got a list"));
    }
    Ok(Value::Vec3([numbers(op, a[0], b[0])?, numbers(op, a[1], b[1])?, numbers(op, a[2], b[2])?]))
}

fn color(op: Op, a: [f64; 3], b: [f64; 3]) -> Made {
    Ok(Value::Color(Color([numbers(op, a[0], b[0])?, numbers(op, a[1], b[1])?, numbers(op, a[2], b[2])?])))
}

fn lists(op: Op, a: &EcoVec<Value>, b: &EcoVec<Value>, build: &mut Build, span: Span) -> Made {
    if a.len() != b.len() {
        return Err(lengths(&Value::List(a.clone()), &Value::List(b.clone())));
    }
    build.spend(list_steps(a))?;
    let mut out = EcoVec::with_capacity(a.len());
    for (i, (x, y)) in a.iter().zip(b).enumerate() {
        pause(i, build)?;
        out.push(arithmetic(op, x, y, build, span)?);
    }
    Ok(Value::list(out))
}

fn each(items: &EcoVec<Value>, build: &mut Build, f: impl Fn(&Value, &mut Build) -> Made) -> Made {
    build.spend(list_steps(items))?;
    let mut out = EcoVec::with_capacity(items.len());
    for (i, v) in items.iter().enumerate() {
        pause(i, build)?;
        out.push(f(v, build)?);
    }
    Ok(Value::list(out))
}

/// What arithmetic on a list costs. Lists within lists may be one and the same many times over: even a short one counts.
pub fn list_steps(items: &EcoVec<Value>) -> u64 {
    1 + items.len() as u64 / 4
}

/// To be called with every number from 0 up: looks from time to time whether to go on.
pub fn pause(i: usize, build: &mut Build) -> Result<(), Box<Fault>> {
    // Some microseconds' worth.
    if i % 1024 == 1023 { build.spend(0) } else { Ok(()) }
}

fn lengths(a: &Value, b: &Value) -> Box<Fault> {
    let (a, b) = (a.length().unwrap_or(0), b.length().unwrap_or(0));
    Fault::new(format!("lists of {a} and of {b} don't go together item by item"))
}

fn patterns(op: Op, a: &Value, b: &Value, build: &mut Build, span: Span) -> Made {
    // a - b is a + (-1)·b, and a / n is a · (1/n).
    let b = match (op, b) {
        (Op::Subtract, b) => arithmetic(Op::Multiply, &Value::Number(-1.0), b, build, span)?,
        (Op::Divide, Value::Number(n)) => Value::Number(numbers(Op::Divide, 1.0, *n)?),
        (Op::Add | Op::Multiply, b) => b.clone(),
        _ => return Err(unfit(op, a, b, build)),
    };
    let (Some(x), Some(y)) = (build.paint(a), build.paint(&b)) else { return Err(unfit(op, a, &b, build)) };
    let kind = if matches!(op, Op::Add | Op::Subtract) { PatternKind::Add(x, y) } else { PatternKind::Multiply(x, y) };
    build.pattern(kind, span)
}

#[cold]
fn unfit(op: Op, a: &Value, b: &Value, build: &Build) -> Box<Fault> {
    let fault = Fault::new(format!("`{}` can't take {} and {}", op.symbol(), kind_of(a, build), kind_of(b, build)));
    match (a, b) {
        (Value::Angle(_), Value::Number(_)) | (Value::Number(_), Value::Angle(_)) => {
            fault.note("an angle carries its unit: `30deg`, `0.5turn`, `1.2rad`")
        }
        (Value::Color(_), Value::Number(n)) | (Value::Number(n), Value::Color(_)) => {
            fault.note(format!("for the color write `gray({0})` or `linear({0})`", number_text(*n)))
        }
        (Value::Text(_), _) | (_, Value::Text(_)) if op == Op::Add => {
            fault.note("texts are put together with `\"{a} and {b}\"`")
        }
        (Value::Vec3(_) | Value::List(_), Value::Number(n)) | (Value::Number(n), Value::Vec3(_) | Value::List(_))
            if matches!(op, Op::Add | Op::Subtract) =>
        {
            fault.note(format!("lists are added item by item: write `[{0}, {0}, {0}]`", number_text(*n)))
        }
        (Value::Node(_), Value::Node(_)) => fault.note("shapes are put together in a `group { … }`"),
        (Value::Node(_), Value::Vec3(_)) if op == Op::Add => fault.note("to move a shape write `|> move([x, y, z])`"),
        (Value::Node(_), Value::Number(_)) | (Value::Number(_), Value::Node(_)) if op == Op::Multiply => {
            fault.note("to enlarge a shape write `|> scale(2)`")
        }
        _ => fault,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diag::FileId;
    use crate::lang::limits::Limits;
    use std::sync::atomic::AtomicBool;

    fn run(op: Op, a: Value, b: Value) -> Result<String, String> {
        let span = Span { file: FileId(0), start: 0, end: 0 };
        binary(op, &a, &b, &mut Build::new(Limits::default(), &AtomicBool::new(false)), span)
            .map(|v| v.show(99))
            .map_err(|f| f.message)
    }

    #[test]
    fn units_are_kept_apart() {
        let (n, a) = (Value::Number(2.0), Value::Angle(30.0));
        assert_eq!(run(Op::Multiply, n.clone(), a.clone()), Ok("60deg".into()));
        assert_eq!(run(Op::Divide, a.clone(), a.clone()), Ok("1".into()));
        assert_eq!(run(Op::Divide, a.clone(), n.clone()), Ok("15deg".into()));
        assert_eq!(run(Op::Add, a.clone(), n.clone()), Err("`+` can't take an angle and a number".into()));
        assert!(run(Op::Multiply, a.clone(), a).is_err());
        assert!(run(Op::Divide, n, Value::Angle(2.0)).is_err());
    }

    #[test]
    fn results_are_finite() {
        let run = |op, a, b| run(op, Value::Number(a), Value::Number(b));
        assert_eq!(run(Op::Divide, 1.0, 0.0), Err("division by 0".into()));
        assert_eq!(run(Op::Power, -1.0, 0.5), Err("-1 ^ 0.5 isn't a number".into()));
        assert_eq!(run(Op::Multiply, 1e200, 1e200), Err("1e200 * 1e200 is too large".into()));
        assert_eq!(run(Op::Remainder, -1.0, 3.0), Ok("2".into()));
    }

    #[test]
    fn numeric_lists_add_and_scale() {
        let v = Value::Vec3([1.0, 2.0, 3.0]);
        assert_eq!(run(Op::Multiply, Value::Number(2.0), v.clone()), Ok("[2, 4, 6]".into()));
        assert_eq!(run(Op::Subtract, v.clone(), v.clone()), Ok("[0, 0, 0]".into()));
        assert!(run(Op::Add, v, Value::Number(1.0)).is_err());
    }
}
