//! Shapes.

use crate::lang::fault::{Fault, Outcome};
use crate::lang::value::Value;
use crate::lang::word::{Args, Default, Host, Kind, Param, Run, Ty, Word, optional, required};
use crate::scene::{NodeKind, Shape, range};
use glam::DVec3;

const MAT: Param =
    optional("mat", Ty::Material, Default::Absent, "its material; without one, the group's, or a plain gray");
const NAME: Param = optional("name", Ty::Text, Default::Absent, "what messages and `explain` call it");
const ORIGIN: Default = Default::Vec3([0.0; 3]);
const UP: Default = Default::Vec3([0.0, 1.0, 0.0]);

pub const WORDS: &[Word] = &[
    Word {
        name: "sphere",
        kind: Kind::Shape,
        params: &[
            optional("at", Ty::Point, ORIGIN, "its center"),
            optional("r", Ty::Length, Default::Number(1.0), "its radius").above(0.0),
            MAT,
            NAME,
        ],
        doc: "A sphere.",
        example: "sphere(at: [0, 1, 0], r: 1)\ncamera(from: [0, 2, 6], at: [0, 1, 0])\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| make(host, a, Shape::Sphere { at: a.vec3(0), r: a.number(1) })),
    },
    Word {
        name: "plane",
        kind: Kind::Shape,
        params: &[
            optional("y", Ty::Length, Default::Absent, "the height of a level plane"),
            optional("x", Ty::Length, Default::Absent, "where an upright plane crosses the x axis"),
            optional("z", Ty::Length, Default::Absent, "where an upright plane crosses the z axis"),
            optional("through", Ty::Point, Default::Absent, "a point of the plane"),
            optional("normal", Ty::Direction, Default::Absent, "a direction straight out of the plane"),
            MAT,
            NAME,
        ],
        doc: "An unbounded plane, given by one of `x`, `y` and `z`, or by `through` and `normal`.",
        example: "plane(y: 0, mat: matte(checker(gray(0.9), gray(0.3))))\nlight(at: [4, 8, 6])",
        run: Run::Call(plane),
    },
    Word {
        name: "box",
        kind: Kind::Shape,
        params: &[
            optional("size", Ty::Point, Default::Absent, "its width, height and depth").above(0.0),
            optional("at", Ty::Point, Default::Absent, "its center, [0, 0, 0] unless given"),
            optional("from", Ty::Point, Default::Absent, "one corner"),
            optional("to", Ty::Point, Default::Absent, "the opposite corner"),
            MAT,
            NAME,
        ],
        doc: "A box along the axes, given by `size` and its center `at`, or by two opposite corners `from` and `to`.",
        example: "box(size: [2, 1, 2])\nbox(from: [2, 0, 0], to: [3, 1, 1])\nlight(at: [4, 8, 6])",
        run: Run::Call(box_),
    },
    Word {
        name: "disc",
        kind: Kind::Shape,
        params: &[
            optional("at", Ty::Point, ORIGIN, "its center"),
            optional("normal", Ty::Direction, UP, "the direction that it faces"),
            optional("r", Ty::Length, Default::Number(1.0), "its radius").above(0.0),
            optional("hole", Ty::Length, Default::Number(0.0), "the radius of a hole in its middle").at_least(0.0),
            MAT,
            NAME,
        ],
        doc: "A flat disc, or a ring when it has a `hole`.",
        example: "disc(r: 2, hole: 1)\nlight(at: [4, 8, 6])",
        run: Run::Call(disc),
    },
    Word {
        name: "cylinder",
        kind: Kind::Shape,
        params: &[
            optional("from", Ty::Point, ORIGIN, "the center of one end"),
            optional("to", Ty::Point, UP, "the center of the other end"),
            optional("r", Ty::Length, Default::Number(1.0), "its radius").above(0.0),
            optional("caps", Ty::Bool, Default::Bool(true), "whether its ends are closed"),
            MAT,
            NAME,
        ],
        doc: "A round cylinder between two points.",
        example: "cylinder(from: [0, 0, 0], to: [0, 2, 0], r: 0.5)\nlight(at: [4, 8, 6])",
        run: Run::Call(cylinder),
    },
    Word {
        name: "cone",
        kind: Kind::Shape,
        params: &[
            optional("from", Ty::Point, ORIGIN, "the center of its base"),
            optional("to", Ty::Point, UP, "its tip, or the center of its top"),
            optional("r", Ty::Length, Default::Number(1.0), "the radius at `from`").at_least(0.0),
            optional("top", Ty::Length, Default::Number(0.0), "the radius at `to`").at_least(0.0),
            optional("caps", Ty::Bool, Default::Bool(true), "whether its ends are closed"),
            MAT,
            NAME,
        ],
        doc: "A round cone between two points; with a `top` it is cut off.",
        example: "cone(from: [0, 0, 0], to: [0, 2, 0], r: 1, top: 0.3)\nlight(at: [4, 8, 6])",
        run: Run::Call(cone),
    },
    Word {
        name: "torus",
        kind: Kind::Shape,
        params: &[
            optional("at", Ty::Point, ORIGIN, "its center"),
            optional("r", Ty::Length, Default::Number(1.0), "the radius of the circle in the middle of the tube")
                .above(0.0),
            optional("tube", Ty::Length, Default::Number(0.25), "the radius of the tube, below `r`").above(0.0),
            optional("axis", Ty::Direction, UP, "the direction that it goes round"),
            MAT,
            NAME,
        ],
        doc: "A ring with a round tube.",
        example: "torus(r: 1, tube: 0.3, axis: [0, 1, 1])\nlight(at: [4, 8, 6])",
        run: Run::Call(torus),
    },
    Word {
        name: "triangle",
        kind: Kind::Shape,
        params: &[
            required("points", Ty::Points(3), "its corners"),
            optional("normals", Ty::Directions(3), Default::Absent, "directions at the corners, for a smooth look"),
            MAT,
            NAME,
        ],
        doc: "A flat triangle.",
        example: "triangle(points: [[-1, 0, 0], [1, 0, 0], [0, 2, 0]])\nlight(at: [4, 8, 6])",
        run: Run::Call(triangle),
    },
    Word {
        name: "tetrahedron",
        kind: Kind::Shape,
        params: &[
            optional("points", Ty::Points(4), Default::Absent, "its corners"),
            optional("at", Ty::Point, Default::Absent, "its center, [0, 0, 0] unless given"),
            optional("size", Ty::Length, Default::Absent, "the length of its edges, 1 unless given").above(0.0),
            MAT,
            NAME,
        ],
        doc: "A solid with four corners, given by them, or a regular one by its center and the length of its edges.",
        example: "tetrahedron(at: [0, 1, 0], size: 2)\nlight(at: [4, 8, 6])",
        run: Run::Call(tetrahedron),
    },
];

/// Stores a shape; its material and name are the last two parameters.
fn make(host: &mut dyn Host, a: &[Value], shape: Shape) -> Outcome {
    let n = a.len();
    let material = if let Some(Value::Material(id)) = a.get(n - 2) { Some(*id) } else { None };
    let name = a.given(n - 1).then(|| a.text(n - 1).into());
    let place = host.place();
    Ok(host.build().node(NodeKind::Shape(shape), material, name, place)?)
}

fn plane(host: &mut dyn Host, a: &[Value]) -> Outcome {
    let axes: Vec<usize> = (0..3).filter(|i| a.given(*i)).collect();
    let (through, normal) = match (&axes[..], a.given(3), a.given(4)) {
        ([0], false, false) => (DVec3::new(0.0, a.number(0), 0.0), DVec3::Y),
        ([1], false, false) => (DVec3::new(a.number(1), 0.0, 0.0), DVec3::X),
        ([2], false, false) => (DVec3::new(0.0, 0.0, a.number(2)), DVec3::Z),
        ([], true, true) => (a.vec3(3), a.vec3(4)),
        ([], false, true) => (DVec3::ZERO, a.vec3(4)),
        ([], true, false) => return Err(Fault::new("a plane through a point needs a `normal` too").into()),
        ([], false, false) => {
            return Err(Fault::new("a plane needs a place")
                .note("write `plane(y: 0)`, or `through:` and `normal:`")
                .into());
        }
        _ => {
            return Err(Fault::new("a plane takes only one of `x`, `y` and `z`, or `through` and `normal`")
                .note("for a tilted plane write `plane(through: [0, 1, 0], normal: [1, 1, 0])`")
                .into());
        }
    };
    make(host, a, Shape::Plane { through, normal })
}

fn box_(host: &mut dyn Host, a: &[Value]) -> Outcome {
    let corners = (a.given(2), a.given(3));
    let (from, to) = match (a.given(0) || a.given(1), corners) {
        (_, (false, false)) => {
            let half = if a.given(0) { a.vec3(0) * 0.5 } else { DVec3::splat(0.5) };
            (a.vec3(1) - half, a.vec3(1) + half)
        }
        (false, (true, true)) => (a.vec3(2).min(a.vec3(3)), a.vec3(2).max(a.vec3(3))),
        (true, _) => {
            return Err(Fault::new("a box takes `size` and `at`, or `from` and `to`, not some of both").into());
        }
        (false, _) => return Err(Fault::new("a box with a corner needs the opposite one: `from` and `to`").into()),
    };
    for (axis, (lo, hi)) in ["x", "y", "z"].into_iter().zip(from.to_array().into_iter().zip(to.to_array())) {
        if lo >= hi {
            return Err(Fault::new(format!("this box has no thickness along {axis}"))
                .note("its corners must differ in x, y and z")
                .into());
        }
        if !range::is_supported(lo) || !range::is_supported(hi) {
            return Err(Fault::new("a corner of this box is outside the supported lengths, 1e-140 to 1e140").into());
        }
    }
    make(host, a, Shape::Box { from, to })
}

fn disc(host: &mut dyn Host, a: &[Value]) -> Outcome {
    let (r, hole) = (a.number(2), a.number(3));
    if hole >= r {
        return Err(Fault::new("the `hole` of a disc must be smaller than its `r`").on(3).into());
    }
    make(host, a, Shape::Disc { at: a.vec3(0), normal: a.vec3(1), r, hole })
}

fn ends(a: &[Value], what: &str) -> Result<(DVec3, DVec3), Box<Fault>> {
    if a.vec3(0) == a.vec3(1) {
        return Err(Fault::new(format!("`from` and `to` of this {what} are the same point")).on(1));
    }
    Ok((a.vec3(0), a.vec3(1)))
}

fn cylinder(host: &mut dyn Host, a: &[Value]) -> Outcome {
    let (from, to) = ends(a, "cylinder")?;
    make(host, a, Shape::Cylinder { from, to, r: a.number(2), caps: a.is_true(3) })
}

fn cone(host: &mut dyn Host, a: &[Value]) -> Outcome {
    let (from, to) = ends(a, "cone")?;
    let (r, top) = (a.number(2), a.number(3));
    if r == top {
        let fault = Fault::new("`r` and `top` of a cone must differ").on(3);
        return Err(if r == 0.0 { fault } else { fault.label("write a `cylinder`") }.into());
    }
    // The cone's formulas square its slope.
    if (r - top).abs() / (to - from).abs().max_element() > range::LARGEST {
        return Err(Fault::new("this cone is too flat for its width").note("write a `disc`").into());
    }
    make(host, a, Shape::Cone { from, to, r, top, caps: a.is_true(4) })
}

fn torus(host: &mut dyn Host, a: &[Value]) -> Outcome {
    let (r, tube) = (a.number(1), a.number(2));
    if tube >= r {
        return Err(Fault::new("the `tube` of a torus must be smaller than its `r`").on(2).into());
    }
    make(host, a, Shape::Torus { at: a.vec3(0), r, tube, axis: a.vec3(3) })
}

/// What rounding of three coordinates leaves of a sine: below it, corners are as good as on one line (or plane).
const FLAT: f64 = 8.0 * f64::EPSILON;

/// The directions from the first point to the others, the longest coordinate of each being 1.
fn edges(points: &[DVec3]) -> Option<Vec<DVec3>> {
    points[1..]
        .iter()
        .map(|p| {
            let edge = *p - points[0];
            let size = edge.abs().max_element();
            (size > 0.0).then(|| (edge / size).normalize())
        })
        .collect()
}

fn triangle(host: &mut dyn Host, a: &[Value]) -> Outcome {
    let Some(points) = a.points::<3>(0) else { return Ok(Value::None) };
    if edges(&points).is_none_or(|e| e[0].cross(e[1]).length() <= FLAT) {
        return Err(Fault::new("the corners of this triangle are on one line").on(0).into());
    }
    make(host, a, Shape::Triangle { points: Box::new(points), normals: a.points::<3>(1).map(Box::new) })
}

fn tetrahedron(host: &mut dyn Host, a: &[Value]) -> Outcome {
    let points = match (a.points::<4>(0), a.given(1) || a.given(2)) {
        (Some(points), false) => points,
        (Some(_), true) => {
            return Err(Fault::new("a tetrahedron takes `points`, or `at` and `size`, not some of both").into());
        }
        (None, _) => {
            // Every other corner of a cube: its edges are √2 times the cube's.
            let half = if a.given(2) { a.number(2) } else { 1.0 } / 8f64.sqrt();
            let corner = |x: f64, y: f64, z: f64| a.vec3(1) + DVec3::new(x, y, z) * half;
            [corner(1.0, 1.0, 1.0), corner(1.0, -1.0, -1.0), corner(-1.0, 1.0, -1.0), corner(-1.0, -1.0, 1.0)]
        }
    };
    if edges(&points).is_none_or(|e| e[0].cross(e[1]).dot(e[2]).abs() <= FLAT) {
        return Err(Fault::new("the corners of this tetrahedron are in one plane").into());
    }
    make(host, a, Shape::Tetrahedron { points: Box::new(points) })
}
