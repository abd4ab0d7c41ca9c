//! Numbers, angles and vectors.

use crate::lang::ast::Op;
use crate::lang::fault::{Fault, Outcome};
use crate::lang::ops;
use crate::lang::value::Value;
use crate::lang::word::{Args, Host, Kind, Param, Run, Ty, Word, required, rest};
use crate::math::fun;

const X: Param = required("x", Ty::Number, "a number");
const ANGLE: Param = required("angle", Ty::Angle, "an angle");
const V: Param = required("v", Ty::Point, "a vector `[x, y, z]`");
const MORE: Param = rest("more", Ty::Number, "further numbers");

/// A word that makes a number of a number.
const fn function(name: &'static str, f: fn(f64) -> f64, doc: &'static str, example: &'static str) -> Word {
    Word { name, kind: Kind::Maths, params: &[X], doc, example, run: Run::Number(f) }
}

pub const WORDS: &[Word] = &[
    Word {
        name: "sin",
        kind: Kind::Maths,
        params: &[ANGLE],
        doc: "The sine of an angle.",
        example: "let half = sin(30deg)",
        run: Run::Call(|_, a| Ok(Value::Number(fun::sin_deg(a.number(0))))),
    },
    Word {
        name: "cos",
        kind: Kind::Maths,
        params: &[ANGLE],
        doc: "The cosine of an angle.",
        example: "let half = cos(60deg)",
        run: Run::Call(|_, a| Ok(Value::Number(fun::cos_deg(a.number(0))))),
    },
    Word {
        name: "tan",
        kind: Kind::Maths,
        params: &[ANGLE],
        doc: "The tangent of an angle.",
        example: "let one = tan(45deg)",
        run: Run::Call(|_, a| {
            let t = fun::tan_deg(a.number(0));
            if t.is_finite() {
                Ok(Value::Number(t))
            } else {
                Err(Fault::new("the tangent of 90deg is infinite").into())
            }
        }),
    },
    Word {
        name: "atan2",
        kind: Kind::Maths,
        params: &[required("y", Ty::Number, "upwards"), required("x", Ty::Number, "to the right")],
        doc: "The angle of the direction (x, y), from -180deg to 180deg.",
        example: "let up = atan2(1, 0)",
        run: Run::Call(|_, a| Ok(Value::Angle(fun::atan2(a.number(0), a.number(1)).to_degrees()))),
    },
    function("abs", f64::abs, "A number without its sign.", "let two = abs(-2)"),
    function("floor", f64::floor, "The next whole number below.", "let one = floor(1.9)"),
    function("ceil", f64::ceil, "The next whole number above.", "let two = ceil(1.1)"),
    function("round", f64::round, "The nearest whole number; halves go away from 0.", "let two = round(1.5)"),
    function("sqrt", fun::sqrt, "The square root.", "let three = sqrt(9)"),
    function("exp", fun::exp, "The exponential function.", "let e = exp(1)"),
    function("ln", fun::ln, "The natural logarithm.", "let zero = ln(1)"),
    Word {
        name: "min",
        kind: Kind::Maths,
        params: &[X, MORE],
        doc: "The smallest of some numbers.",
        example: "let one = min(3, 1, 2)",
        run: Run::Call(|_, a| Ok(Value::Number(fold(a, |x, y| if y < x { y } else { x })))),
    },
    Word {
        name: "max",
        kind: Kind::Maths,
        params: &[X, MORE],
        doc: "The largest of some numbers.",
        example: "let three = max(3, 1, 2)",
        run: Run::Call(|_, a| Ok(Value::Number(fold(a, |x, y| if y > x { y } else { x })))),
    },
    Word {
        name: "clamp",
        kind: Kind::Maths,
        params: &[X, required("low", Ty::Number, "the least"), required("high", Ty::Number, "the most")],
        doc: "A number brought within two limits.",
        example: "let one = clamp(7, 0, 1)",
        run: Run::Call(|_, a| {
            let (x, low, high) = (a.number(0), a.number(1), a.number(2));
            if low > high {
                return Err(Fault::new("`low` is above `high`").on(1).into());
            }
            Ok(Value::Number(x.clamp(low, high)))
        }),
    },
    Word {
        name: "lerp",
        kind: Kind::Maths,
        params: &[
            required("a", Ty::Any, "what it is at 0"),
            required("b", Ty::Any, "what it is at 1"),
            required("u", Ty::Number, "the share of `b`"),
        ],
        doc: "Between two values: numbers, angles, vectors or colors.",
        example: "let middle = lerp(2, 4, 0.5)\nlet orange_ish = lerp(red, yellow, 0.5)",
        run: Run::Call(lerp),
    },
    Word {
        name: "length",
        kind: Kind::Maths,
        params: &[V],
        doc: "The length of a vector.",
        example: "let five = length([3, 4, 0])",
        run: Run::Call(|_, a| {
            let v = a.vec3(0);
            let size = v.abs().max_element();
            Ok(Value::Number(if size == 0.0 { 0.0 } else { (v / size).length() * size }))
        }),
    },
    Word {
        name: "normalize",
        kind: Kind::Maths,
        params: &[required("v", Ty::Direction, "a vector other than [0, 0, 0]")],
        doc: "The vector of length 1 in the same direction.",
        example: "let up = normalize([0, 7, 0])",
        run: Run::Call(|_, a| Ok(Value::Vec3((a.vec3(0) / a.vec3(0).abs().max_element()).normalize().to_array()))),
    },
    Word {
        name: "dot",
        kind: Kind::Maths,
        params: &[V, required("w", Ty::Point, "another vector")],
        doc: "The scalar product of two vectors.",
        example: "let eleven = dot([1, 2, 0], [3, 4, 0])",
        run: Run::Call(|_, a| finite(a.vec3(0).dot(a.vec3(1)))),
    },
    Word {
        name: "cross",
        kind: Kind::Maths,
        params: &[V, required("w", Ty::Point, "another vector")],
        doc: "The vector product of two vectors, at right angles to both.",
        example: "let z = cross([1, 0, 0], [0, 1, 0])",
        run: Run::Call(|_, a| {
            let v = a.vec3(0).cross(a.vec3(1));
            if v.is_finite() {
                Ok(Value::Vec3(v.to_array()))
            } else {
                Err(Fault::new("the product is too large").into())
            }
        }),
    },
    Word {
        name: "pi",
        kind: Kind::Constant,
        params: &[],
        doc: "The circumference of a circle of diameter 1.",
        example: "let around = 2 * pi",
        run: Run::Constant(|| Value::Number(std::f64::consts::PI)),
    },
    Word {
        name: "none",
        kind: Kind::Constant,
        params: &[],
        doc: "Nothing: what a property is that isn't given.",
        example: "let m = phong(ior: none)",
        run: Run::Constant(|| Value::None),
    },
];

fn fold(a: &[Value], f: impl Fn(f64, f64) -> f64) -> f64 {
    let given = (1..a.len()).filter(|i| a.given(*i));
    given.fold(a.number(0), |best, i| f(best, a.number(i)))
}

fn finite(x: f64) -> Outcome {
    if x.is_finite() { Ok(Value::Number(x)) } else { Err(Fault::new("the product is too large").into()) }
}

fn lerp(host: &mut dyn Host, a: &[Value]) -> Outcome {
    let u = a.number(2);
    if let (Value::Number(x), Value::Number(y)) = (&a[0], &a[1]) {
        return finite((1.0 - u) * x + u * y);
    }
    // Weights rather than a + u·(b − a), so that both ends are exact.
    let span = host.place().span;
    let build = host.build();
    let x = ops::binary(Op::Multiply, &Value::Number(1.0 - u), &a[0], build, span)?;
    let y = ops::binary(Op::Multiply, &a[2], &a[1], build, span)?;
    Ok(ops::binary(Op::Add, &x, &y, build, span)?)
}
