//! Patterns: colors and numbers that vary over a surface. Pictures are in `image`, mixtures in `mixture`.

use crate::lang::fault::Outcome;
use crate::lang::value::Value;
use crate::lang::word::{Args, Default, Host, Kind, Param, Run, Ty, Word, optional, required};
use crate::scene::{PatternId, PatternKind};

const A: Param = required("a", Ty::Paint, "the first color, number or pattern");
const B: Param = required("b", Ty::Paint, "the second one");
const LOW: Param = optional("a", Ty::Paint, Default::Number(0.0), "the color, number or pattern at 0").by_position();
const HIGH: Param = optional("b", Ty::Paint, Default::Number(1.0), "the one at 1").by_position();
pub const AXES: Ty = Ty::Choice(&["x", "y", "z"]);
/// Octaves of every noise.
pub const OCTAVES: Param =
    optional("octaves", Ty::Whole, Default::Number(4.0), "layers, each of half the size and half the strength")
        .within(1.0, 16.0);
/// Seeds of every noise; whole numbers that a float holds exactly.
pub const SEED: Param =
    optional("seed", Ty::Whole, Default::Number(0.0), "another arrangement").within(0.0, 9007199254740992.0);

pub const WORDS: &[Word] = &[
    Word {
        name: "checker",
        kind: Kind::Pattern,
        params: &[A, B, optional("size", Ty::Length, Default::Number(1.0), "the side of a cube").above(0.0)],
        doc: "Cubes of two kinds, as on a chess board but in space: `a` where floor(x/size) + floor(y/size) + floor(z/size) is even.",
        example: "plane(y: 0, mat: matte(checker(gray(0.9), gray(0.2), size: 2)))\ncamera(from: [3, 3, 8])\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| {
            let [pa, pb] = paints(host, a);
            add(host, PatternKind::Checker { a: pa, b: pb, size: a.number(2) })
        }),
    },
    Word {
        name: "stripes",
        kind: Kind::Pattern,
        params: &[
            A,
            B,
            optional("axis", AXES, Default::Text("x"), "the direction across the stripes"),
            optional("size", Ty::Length, Default::Number(1.0), "the width of each stripe").above(0.0),
        ],
        doc: "Slabs of two kinds, one after the other: `a` from 0 to `size` along the axis, then `b`, and so on.",
        example: "sphere(r: 3, mat: matte(stripes(#e60, #22c, axis: \"y\", size: 0.5)))\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| {
            let [pa, pb] = paints(host, a);
            add(host, PatternKind::Stripes { a: pa, b: pb, axis: axis(a.text(2)), size: a.number(3) })
        }),
    },
    Word {
        name: "rings",
        kind: Kind::Pattern,
        params: &[
            A,
            B,
            optional("axis", AXES, Default::Text("y"), "the direction that the rings go round"),
            optional("size", Ty::Length, Default::Number(1.0), "the thickness of each ring").above(0.0),
        ],
        doc: "Shells of two kinds around an axis, as in the trunk of a tree: `a` the innermost, out to `size`, then `b`, and so on.",
        example: "let wood = rings(#a9713d, #7c4a21, size: 0.2) |> turbulence(0.15) |> rotate(x: 80deg)\nsphere(r: 2, mat: phong(color: wood, specular: 0.3))\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| {
            let [pa, pb] = paints(host, a);
            add(host, PatternKind::Rings { a: pa, b: pb, axis: axis(a.text(2)), size: a.number(3) })
        }),
    },
    Word {
        name: "gradient",
        kind: Kind::Pattern,
        params: &[
            LOW,
            HIGH,
            optional("axis", AXES, Default::Text("y"), "the direction along which it changes"),
            optional("size", Ty::Length, Default::Number(1.0), "the length over which it changes").above(0.0),
        ],
        doc: "An even change from `a` at coordinate 0 to `b` at coordinate `size`, and no change beyond them.",
        example: "let dawn = gradient(tomato, midnightblue, size: 2) |> move([0, -1, 0])\nsphere(mat: matte(dawn))\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| {
            let [pa, pb] = paints(host, a);
            add(host, PatternKind::Gradient { a: pa, b: pb, axis: axis(a.text(2)), size: a.number(3) })
        }),
    },
    Word {
        name: "noise",
        kind: Kind::Pattern,
        params: &[LOW, HIGH, OCTAVES, SEED],
        doc: "Clouds between `a` and `b`: smooth noise with features of about size 1 and, with more octaves, finer ones in them.",
        example: "let clouds = noise(royalblue, white, octaves: 6) |> scale(0.8)\nsphere(r: 2, mat: matte(clouds))\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| {
            let [pa, pb] = paints(host, a);
            add(host, PatternKind::Noise { a: pa, b: pb, octaves: a.number(2) as u32, seed: a.number(3) as u64 })
        }),
    },
    Word {
        name: "cells",
        kind: Kind::Pattern,
        params: &[LOW, HIGH, SEED],
        doc: "Cells around scattered points, one in each cube of side 1: from `a` at a point to `b` at distance 1 from the nearest one.",
        example: "let scales = cells(gold, maroon) |> scale(0.4)\nsphere(r: 2, mat: phong(color: scales, specular: 0.4))\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| {
            let [pa, pb] = paints(host, a);
            add(host, PatternKind::Cells { a: pa, b: pb, seed: a.number(2) as u64 })
        }),
    },
    Word {
        name: "brick",
        kind: Kind::Pattern,
        params: &[
            required("brick", Ty::Paint, "the color, number or pattern of the bricks"),
            required("mortar", Ty::Paint, "that of the mortar between them"),
            optional("size", Ty::Size, Default::Vec2([2.0, 1.0]), "width and height of a brick with its mortar")
                .above(0.0),
            optional("gap", Ty::Length, Default::Number(0.1), "the thickness of the mortar").at_least(0.0),
        ],
        doc: "A brick wall, courses along x laid up y, every other one shifted by half a brick; the same at every z.",
        example: "let wall = brick(firebrick, lightgray, size: [0.6, 0.25], gap: 0.04)\nplane(z: 0, mat: matte(wall))\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| {
            let [brick, mortar] = paints(host, a);
            let size = [a.item(2, 0), a.item(2, 1)];
            add(host, PatternKind::Brick { mortar, brick, size, gap: a.number(3) })
        }),
    },
];

/// The first two arguments.
fn paints(host: &mut dyn Host, a: &[Value]) -> [PatternId; 2] {
    [0, 1].map(|i| host.build().paint(&a[i]).unwrap_or(PatternId(0)))
}

/// The number of an axis by its name.
pub fn axis(name: &str) -> u8 {
    match name {
        "x" => 0,
        "y" => 1,
        _ => 2,
    }
}

/// Stores a pattern.
pub fn add(host: &mut dyn Host, kind: PatternKind) -> Outcome {
    let span = host.place().span;
    Ok(host.build().pattern(kind, span)?)
}
