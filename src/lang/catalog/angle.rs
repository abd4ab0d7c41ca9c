//! Angles and their functions. An angle carries its unit, so nothing here takes or gives plain degrees or radians.

use crate::lang::fault::{Fault, Outcome};
use crate::lang::value::{Value, number_text};
use crate::lang::word::{Args, Kind, Param, Run, Ty, Word, required};
use crate::math::fun;

const ANGLE: Param = required("angle", Ty::Angle, "an angle");
const RATIO: Param = required("x", Ty::Number, "from -1 to 1").within(-1.0, 1.0);

pub const WORDS: &[Word] = &[
    Word {
        name: "sin",
        kind: Kind::Maths,
        params: &[ANGLE],
        doc: "The sine of an angle.",
        example: "let half = sin(30deg)     // → 0.5\nfor i in 0..40 { sphere(at: [i / 4, sin(i * 18deg), 0], r: 0.15) }\ncamera(from: [5, 0, 14], at: [5, 0, 0])\nlight(at: [4, 8, 6])",
        run: Run::Angle(fun::sin_deg),
    },
    Word {
        name: "cos",
        kind: Kind::Maths,
        params: &[ANGLE],
        doc: "The cosine of an angle.",
        example: "let half = cos(60deg)     // → 0.5\nfor i in 0..12 { sphere(at: [3 * cos(i * 30deg), 3 * sin(i * 30deg), 0], r: 0.5) }\nlight(at: [4, 8, 6])",
        run: Run::Angle(fun::cos_deg),
    },
    Word {
        name: "tan",
        kind: Kind::Maths,
        params: &[ANGLE],
        doc: "The tangent of an angle, which must not be a quarter turn.",
        example: "let one = tan(45deg)      // → 1",
        run: Run::Call(|_, a| {
            let t = fun::tan_deg(a.number(0));
            if t.is_finite() {
                return Ok(Value::Number(t));
            }
            Err(Fault::new(format!("the tangent of {}deg is infinite", number_text(a.number(0)))).on(0).into())
        }),
    },
    Word {
        name: "asin",
        kind: Kind::Maths,
        params: &[RATIO],
        doc: "The angle from -90deg to 90deg that has this sine.",
        example: "let slope = asin(0.5)     // → 30deg",
        run: Run::Call(|_, a| angle(fun::asin_deg(a.number(0)))),
    },
    Word {
        name: "acos",
        kind: Kind::Maths,
        params: &[RATIO],
        doc: "The angle from 0deg to 180deg that has this cosine.",
        example: "let between = acos(dot([1, 0, 0], [0, 0, 1]))     // → 90deg",
        run: Run::Call(|_, a| angle(fun::acos_deg(a.number(0)))),
    },
    Word {
        name: "atan",
        kind: Kind::Maths,
        params: &[required("x", Ty::Number, "a number")],
        doc: "The angle between -90deg and 90deg that has this tangent.",
        example: "let diagonal = atan(1)    // → 45deg\n// A picture half as high as the scene is far away:\ncamera(from: [0, 0, 8], fov: 2 * atan(0.25))\nsphere()\nlight(at: [4, 8, 6])",
        run: Run::Call(|_, a| angle(fun::atan_deg(a.number(0)))),
    },
    Word {
        name: "atan2",
        kind: Kind::Maths,
        params: &[required("y", Ty::Number, "how far up"), required("x", Ty::Number, "how far to the right")],
        doc: "The angle of the direction (x, y), counter-clockwise from the x axis, -180deg to 180deg.",
        example: "let up = atan2(1, 0)      // → 90deg\nlet left = atan2(0, -1)   // → 180deg",
        run: Run::Call(|_, a| angle(fun::atan2(a.number(0), a.number(1)).to_degrees())),
    },
];

fn angle(degrees: f64) -> Outcome {
    Ok(Value::Angle(degrees))
}
