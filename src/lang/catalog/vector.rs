//! Vectors: lists of three numbers, for points, directions and sizes.

use crate::lang::fault::{Fault, Outcome};
use crate::lang::value::Value;
use crate::lang::word::{Args, Kind, Param, Run, Ty, Word, required};
use glam::DVec3;

const V: Param = required("v", Ty::Point, "a vector `[x, y, z]`");
const W: Param = required("w", Ty::Point, "another vector");

pub const WORDS: &[Word] = &[
    Word {
        name: "length",
        kind: Kind::Vector,
        params: &[required("v", Ty::Point, "a vector `[x, y, z]`; how many values a list has is `len(…)`")],
        doc: "The length of a vector.",
        example: "let five = length([3, 4, 0])      // → 5",
        run: Run::Call(|_, a| Ok(Value::Number(length(a.vec3(0))))),
    },
    Word {
        name: "distance",
        kind: Kind::Vector,
        params: &[required("from", Ty::Point, "a point `[x, y, z]`"), required("to", Ty::Point, "another point")],
        doc: "The distance of two points.",
        example: "let five = distance([1, 1, 0], [4, 5, 0])     // → 5",
        run: Run::Call(|_, a| finite(length(a.vec3(1) - a.vec3(0)))),
    },
    Word {
        name: "normalize",
        kind: Kind::Vector,
        params: &[required("v", Ty::Direction, "a vector other than [0, 0, 0]")],
        doc: "The vector of length 1 in the same direction.",
        example: "let up = normalize([0, 7, 0])     // → [0, 1, 0]",
        run: Run::Call(|_, a| vector((a.vec3(0) / a.vec3(0).abs().max_element()).normalize())),
    },
    Word {
        name: "dot",
        kind: Kind::Vector,
        params: &[V, W],
        doc: "The scalar product of two vectors: 0 when they are at right angles.",
        example: "let eleven = dot([1, 2, 0], [3, 4, 0])        // → 11",
        run: Run::Call(|_, a| finite(a.vec3(0).dot(a.vec3(1)))),
    },
    Word {
        name: "cross",
        kind: Kind::Vector,
        params: &[V, W],
        doc: "The vector product of two vectors: at right angles to both, by the right hand.",
        example: "let z = cross([1, 0, 0], [0, 1, 0])       // → [0, 0, 1]",
        run: Run::Call(|_, a| vector(a.vec3(0).cross(a.vec3(1)))),
    },
];

/// Without overflow on the way.
fn length(v: DVec3) -> f64 {
    let size = v.abs().max_element();
    if size == 0.0 { 0.0 } else { (v / size).length() * size }
}

fn vector(v: DVec3) -> Outcome {
    if v.is_finite() { Ok(Value::Vec3(v.to_array())) } else { Err(Fault::new("the result is too large").into()) }
}

fn finite(x: f64) -> Outcome {
    if x.is_finite() { Ok(Value::Number(x)) } else { Err(Fault::new("the result is too large").into()) }
}
