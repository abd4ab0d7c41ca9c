//! What moves, turns, scales and distorts shapes, lights, groups and patterns; and `group` itself.

use super::pattern::{OCTAVES, SEED};
use crate::lang::fault::{Fault, Outcome};
use crate::lang::value::Value;
use crate::lang::word::{Args, Default, Host, Kind, Param, Run, Ty, Word, optional, required};
use crate::math::Affine;
use crate::scene::{NodeKind, PatternKind};
use glam::DVec3;

const THING: Param = required("thing", Ty::Movable, "a shape, light, group or pattern; comes before `|>`");

pub const WORDS: &[Word] = &[
    Word {
        name: "group",
        kind: Kind::Group,
        params: &[
            optional("mat", Ty::Material, Default::Absent, "the material of everything in it that has none"),
            optional("name", Ty::Text, Default::Absent, "what messages and `explain` call it"),
        ],
        doc: "Several shapes and lights as one: `group { … }` collects those in its block.",
        example: "group(mat: matte(#c33)) {\n  sphere()\n  box(at: [2, 0, 0])\n} |> rotate(y: 30deg)\nlight(at: [4, 8, 6])",
        run: Run::Syntax,
    },
    Word {
        name: "move",
        kind: Kind::Transform,
        params: &[THING, required("by", Ty::Point, "how far along x, y and z")],
        doc: "Moves something.",
        example: "sphere() |> move([0, 1, 0])\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| transform(host, a, Affine::translation(a.vec3(1)))),
    },
    Word {
        name: "scale",
        kind: Kind::Transform,
        params: &[THING, required("by", Ty::Factors, "one factor, or one each for x, y and z")],
        doc: "Makes something larger or smaller, seen from the origin.",
        example: "sphere() |> scale([2, 1, 1])\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| {
            let by = if let Some(Value::Number(s)) = a.get(1) { DVec3::splat(*s) } else { a.vec3(1) };
            transform(host, a, Affine::scaling(by))
        }),
    },
    Word {
        name: "rotate",
        kind: Kind::Transform,
        params: &[
            THING,
            optional("x", Ty::Angle, Default::Absent, "the angle about the x axis"),
            optional("y", Ty::Angle, Default::Absent, "the angle about the y axis"),
            optional("z", Ty::Angle, Default::Absent, "the angle about the z axis"),
            optional("axis", Ty::Direction, Default::Absent, "any other axis through the origin"),
            optional("angle", Ty::Angle, Default::Absent, "the angle about `axis`"),
        ],
        doc: "Turns something about an axis through the origin, counter-clockwise seen from the axis' tip.",
        example: "box() |> rotate(y: 30deg) |> rotate(axis: [1, 0, 1], angle: 0.1turn)\nlight(at: [4, 8, 6])",
        run: Run::Call(rotate),
    },
    Word {
        name: "turbulence",
        kind: Kind::Transform,
        params: &[
            required("pattern", Ty::Pattern, "comes before `|>`"),
            required("amount", Ty::Length, "about the largest displacement").at_least(0.0),
            OCTAVES,
            SEED,
        ],
        doc: "Stirs a pattern: every point of it is displaced by smooth noise.",
        example: "plane(y: 0, mat: matte(stripes(white, black) |> turbulence(0.4)))\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| {
            let Some(Value::Pattern(child)) = a.first() else { return Ok(Value::None) };
            let (octaves, seed) = (a.number(2) as u32, a.number(3) as u64);
            let kind = PatternKind::Turbulence { child: *child, amount: a.number(1), octaves, seed };
            let span = host.place().span;
            Ok(host.build().pattern(kind, span)?)
        }),
    },
];

fn transform(host: &mut dyn Host, a: &[Value], parent_from_child: Affine) -> Outcome {
    let place = host.place();
    Ok(match a.first() {
        Some(Value::Node(child)) => host.build().node(
            NodeKind::Transformed { child: *child, parent_from_child: Box::new(parent_from_child) },
            None,
            None,
            place,
        )?,
        Some(Value::Pattern(child)) => {
            host.build().pattern(PatternKind::Transformed { child: *child, parent_from_child }, place.span)?
        }
        _ => Value::None,
    })
}

fn rotate(host: &mut dyn Host, a: &[Value]) -> Outcome {
    let axes: Vec<usize> = (1..4).filter(|i| a.given(*i)).collect();
    let map = match (&axes[..], a.given(4), a.given(5)) {
        ([i], false, false) => Affine::rotation(i - 1, a.number(*i)),
        ([], true, true) => Affine::rotation_about(a.vec3(4), a.number(5)),
        ([], true, false) => return Err(Fault::new("`rotate` about an `axis` needs an `angle`").into()),
        ([], false, true) => return Err(Fault::new("`rotate` by an `angle` needs an `axis`").into()),
        ([], false, false) => {
            return Err(Fault::new("`rotate` needs an angle").note("as in `rotate(y: 30deg)`").into());
        }
        _ => {
            return Err(Fault::new("`rotate` turns about one axis at a time")
                .note("the order matters: write `rotate(x: 10deg) |> rotate(y: 20deg)`")
                .into());
        }
    };
    transform(host, a, map)
}
