//! Patterns: colors and numbers that vary over a surface.

use crate::lang::build::PictureFile;
use crate::lang::fault::{Fault, Outcome};
use crate::lang::value::Value;
use crate::lang::word::{Args, Default, Host, Kind, Param, Run, Ty, Word, optional, required};
use crate::scene::{Filter, Mapping, PatternId, PatternKind};

const A: Param = required("a", Ty::Paint, "the first color, number or pattern");
const B: Param = required("b", Ty::Paint, "the second one");
const AXES: Ty = Ty::Choice(&["x", "y", "z"]);

pub const WORDS: &[Word] = &[
    Word {
        name: "checker",
        kind: Kind::Pattern,
        params: &[A, B, optional("size", Ty::Length, Default::Number(1.0), "the side of a cube").above(0.0)],
        doc: "Cubes of two kinds, as on a chess board but in space.",
        example: "plane(y: 0, mat: matte(checker(gray(0.9), gray(0.2), size: 2)))\nlight(at: [4, 8, 6])",
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
        doc: "Slabs of two kinds, one after the other.",
        example: "sphere(r: 3, mat: matte(stripes(#e60, #22c, axis: \"y\", size: 0.5)))\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| {
            let [pa, pb] = paints(host, a);
            add(host, PatternKind::Stripes { a: pa, b: pb, axis: axis(a.text(2)), size: a.number(3) })
        }),
    },
    Word {
        name: "image",
        kind: Kind::Pattern,
        params: &[
            required("file", Ty::Text, "a PNG or JPEG file; its path starts at the scene file's folder"),
            optional(
                "mapping",
                Ty::Choice(&["spherical", "normal", "planar", "cylindrical"]),
                Default::Text("spherical"),
                "how it is laid on",
            ),
            optional(
                "filter",
                Ty::Choice(&["bilinear", "nearest"]),
                Default::Text("bilinear"),
                "how it is read between its dots",
            ),
            optional("axis", AXES, Default::Absent, "the direction of a planar mapping, \"z\" unless given"),
        ],
        doc: "A picture from a file.",
        example: "let earth = image(\"assets/earth.png\", mapping: \"spherical\")\nlight(at: [4, 8, 6])",
        run: Run::Call(image),
    },
];

fn paints(host: &mut dyn Host, a: &[Value]) -> [PatternId; 2] {
    [0, 1].map(|i| host.build().paint(&a[i]).unwrap_or(PatternId(0)))
}

fn axis(name: &str) -> u8 {
    match name {
        "x" => 0,
        "y" => 1,
        _ => 2,
    }
}

fn add(host: &mut dyn Host, kind: PatternKind) -> Outcome {
    let span = host.place().span;
    Ok(host.build().pattern(kind, span)?)
}

fn image(host: &mut dyn Host, a: &[Value]) -> Outcome {
    let planar = a.text(1) == "planar";
    if a.given(3) && !planar {
        return Err(Fault::new("only a planar mapping has an `axis`").on(3).into());
    }
    let mapping = match a.text(1) {
        "normal" => Mapping::Normal,
        "planar" => Mapping::Planar { axis: axis(a.text(3)) },
        "cylindrical" => Mapping::Cylindrical,
        _ => Mapping::Spherical,
    };
    let filter = if a.text(2) == "nearest" { Filter::Nearest } else { Filter::Bilinear };
    let span = host.place().span;
    let image = host.build().image(PictureFile { path: a.text(0).into(), file: span.file, span });
    add(host, PatternKind::Image { image, mapping, filter })
}
