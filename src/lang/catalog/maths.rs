//! Numbers.

use crate::lang::ast::Op;
use crate::lang::fault::{Fault, Outcome, Stop};
use crate::lang::ops;
use crate::lang::value::Value;
use crate::lang::word::{Args, Host, Kind, Param, Run, Ty, Word, required, rest};
use crate::math::fun;
use std::f64::consts;

const X: Param = required("x", Ty::Number, "a number");
const QUANTITY: Param = required("x", Ty::Quantity, "a number or an angle");
const MORE: Param = rest("more", Ty::Quantity, "further ones of the same kind");
const LOW: Param = required("low", Ty::Number, "the lower limit");
const HIGH: Param = required("high", Ty::Number, "the upper limit");

/// A word that makes a number of a number.
const fn function(name: &'static str, f: fn(f64) -> f64, doc: &'static str, example: &'static str) -> Word {
    Word { name, kind: Kind::Maths, params: &[X], doc, example, run: Run::Number(f) }
}

/// A number with a name.
const fn constant(name: &'static str, value: fn() -> Value, doc: &'static str, example: &'static str) -> Word {
    Word { name, kind: Kind::Constant, params: &[], doc, example, run: Run::Constant(value) }
}

pub const WORDS: &[Word] = &[
    Word {
        name: "abs",
        kind: Kind::Maths,
        params: &[QUANTITY],
        doc: "A number or angle without its sign.",
        example: "let two = abs(-2)     // → 2",
        run: Run::Call(|_, a| Ok(kind(a)?(a.number(0).abs()))),
    },
    function("sign", sign, "1, 0 or -1 for a number above, at or below 0.", "let below = sign(-7)      // → -1"),
    function("floor", f64::floor, "The next whole number below.", "let below = floor(-1.5)       // → -2"),
    function("ceil", f64::ceil, "The next whole number above.", "let above = ceil(1.1)     // → 2"),
    function(
        "round",
        f64::round,
        "The nearest whole number; halves go away from 0.",
        "let two = round(1.5)      // → 2",
    ),
    function("sqrt", fun::sqrt, "The square root.", "let three = sqrt(9)       // → 3"),
    function("cbrt", fun::cbrt, "The cube root.", "let two = cbrt(8)     // → 2"),
    function("exp", fun::exp, "e to the power of a number.", "let one = exp(0)      // → 1"),
    function("log", fun::ln, "The natural logarithm, to base e.", "let zero = log(1)     // → 0"),
    function("log2", fun::log2, "The logarithm to base 2.", "let ten = log2(1024)      // → 10"),
    function("log10", fun::log10, "The logarithm to base 10.", "let three = log10(1000)       // → 3"),
    Word {
        name: "pow",
        kind: Kind::Maths,
        params: &[X, required("y", Ty::Number, "the power")],
        doc: "x to the power of y, as `x ^ y`.",
        example: "let nine = pow(3, 2)      // → 9",
        run: Run::Call(|_, a| Ok(Value::Number(ops::numbers(Op::Power, a.number(0), a.number(1))?))),
    },
    Word {
        name: "hypot",
        kind: Kind::Maths,
        params: &[X, required("y", Ty::Number, "another one")],
        doc: "The square root of x² + y²: the long side of a right-angled triangle.",
        example: "let five = hypot(3, 4)        // → 5",
        run: Run::Call(|_, a| finite(fun::hypot(a.number(0), a.number(1)))),
    },
    Word {
        name: "min",
        kind: Kind::Maths,
        params: &[QUANTITY, MORE],
        doc: "The smallest of some numbers, or of some angles.",
        example: "let one = min(3, 1, 2)        // → 1",
        run: Run::Call(|_, a| Ok(kind(a)?(fold(a, |x, y| if y < x { y } else { x })))),
    },
    Word {
        name: "max",
        kind: Kind::Maths,
        params: &[QUANTITY, MORE],
        doc: "The largest of some numbers, or of some angles.",
        example: "let three = max(3, 1, 2)      // → 3",
        run: Run::Call(|_, a| Ok(kind(a)?(fold(a, |x, y| if y > x { y } else { x })))),
    },
    Word {
        name: "clamp",
        kind: Kind::Maths,
        params: &[
            QUANTITY,
            required("low", Ty::Quantity, "the lower limit, of the same kind"),
            required("high", Ty::Quantity, "the upper limit, of the same kind"),
        ],
        doc: "A number or angle brought within two limits.",
        example: "let one = clamp(7, 0, 1)      // → 1\nlet tilt = clamp(50deg, -30deg, 30deg)      // → 30deg",
        run: Run::Call(|_, a| {
            let kind = kind(a)?;
            let (x, low, high) = (a.number(0), a.number(1), a.number(2));
            if low > high {
                return Err(Fault::new("`low` is above `high`").on(1).into());
            }
            Ok(kind(x.clamp(low, high)))
        }),
    },
    Word {
        name: "smoothstep",
        kind: Kind::Maths,
        params: &[LOW, HIGH, X],
        doc: "0 below `low`, 1 above `high`, and a smooth way between: 3s² - 2s³ of the share s of the way.",
        example: "let half = smoothstep(0, 10, 5)       // → 0.5\nfor i in 0..=20 { sphere(at: [i / 2 - 5, 3 * smoothstep(4, 16, i), 0], r: 0.3) }\nlight(at: [4, 8, 6])",
        run: Run::Call(|_, a| {
            let (low, high, x) = (a.number(0), a.number(1), a.number(2));
            if low >= high {
                return Err(Fault::new("`low` must be below `high`").on(0).into());
            }
            let s = ((x - low) / (high - low)).clamp(0.0, 1.0);
            finite(s * s * (3.0 - 2.0 * s))
        }),
    },
    Word {
        name: "lerp",
        kind: Kind::Maths,
        params: &[
            required("a", Ty::Any, "a number, angle, vector, color or pattern: the result where `u` is 0"),
            required("b", Ty::Any, "the same kind of value: the result where `u` is 1"),
            required("u", Ty::Number, "the share of `b`; beyond 0 and 1 it goes on straight"),
        ],
        doc: "The value (1 - u)·a + u·b on the straight way from a to b.",
        example: "let three = lerp(2, 4, 0.5)       // → 3\nlet corner = lerp(0deg, 90deg, 0.25)      // → 22.5deg\nlet middle = lerp([0, 0, 0], [2, 4, 6], 0.5)      // → [1, 2, 3]",
        run: Run::Call(lerp),
    },
    constant("pi", || Value::Number(consts::PI), "The circumference of a circle of diameter 1.", "let around = 2 * pi"),
    constant(
        "tau",
        || Value::Number(consts::TAU),
        "The circumference of a circle of radius 1: 2·pi.",
        "let around = tau",
    ),
    constant("e", || Value::Number(consts::E), "The base of natural logarithms.", "let one = log(e)      // → 1"),
    constant("none", || Value::None, "Nothing: what a property is that isn't given.", "let m = phong(ior: none)"),
];

fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// What makes a value of the kind that all of `a` are: numbers, or angles.
fn kind(a: &[Value]) -> Result<fn(f64) -> Value, Stop> {
    let is_angle = |v: &Value| matches!(v, Value::Angle(_));
    let angles = a.first().is_some_and(is_angle);
    match a.iter().position(|v| !matches!(v, Value::Unset) && is_angle(v) != angles) {
        Some(odd) => {
            let (got, others) = if angles { ("a number", "angles") } else { ("an angle", "numbers") };
            let fault = Fault::new(format!("numbers and angles can't be compared: this is {got} among {others}"));
            Err(fault.note("an angle carries its unit: `30deg`, `0.5turn`, `1.2rad`").on(odd).into())
        }
        None if angles => Ok(Value::Angle),
        None => Ok(Value::Number),
    }
}

fn fold(a: &[Value], f: impl Fn(f64, f64) -> f64) -> f64 {
    let given = (1..a.len()).filter(|i| a.given(*i));
    given.fold(a.number(0), |best, i| f(best, a.number(i)))
}

fn finite(x: f64) -> Outcome {
    if x.is_finite() { Ok(Value::Number(x)) } else { Err(Fault::new("the result is too large").into()) }
}

fn lerp(host: &mut dyn Host, a: &[Value]) -> Outcome {
    let span = host.place().span;
    Ok(ops::lerp(&a[0], &a[1], a.number(2), host.build(), span)?)
}
