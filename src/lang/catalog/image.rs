//! Pictures from files as patterns.

use super::pattern::{AXES, add, axis};
use crate::lang::build::AssetFile;
use crate::lang::fault::{Fault, Outcome};
use crate::lang::value::Value;
use crate::lang::word::{Args, Default, Host, Kind, Run, Ty, Word, optional, required};
use crate::scene::{Filter, Mapping, PatternKind};

pub const WORDS: &[Word] = &[Word {
    name: "image",
    kind: Kind::Pattern,
    params: &[
        required(
            "file",
            Ty::Text,
            "a PNG or JPEG file, or a binary PPM or PGM; its path starts at the scene file's folder",
        ),
        optional(
            "mapping",
            Ty::Choice(&["spherical", "normal", "planar", "cylindrical"]),
            Default::Text("spherical"),
            "how it is laid on; a planar picture is one unit wide and high unless `scale` makes it larger",
        ),
        optional(
            "filter",
            Ty::Choice(&["bilinear", "nearest"]),
            Default::Text("bilinear"),
            "how it is read between its dots: smoothly, or as squares",
        ),
        optional("axis", AXES, Default::Absent, "the direction of a planar mapping, \"z\" unless given"),
    ],
    doc: "A picture from a file, laid on by longitude and latitude, by the surface's direction, flat, or round the y axis.",
    example: "sphere(mat: matte(image(\"assets/earth.png\") |> rotate(y: 100deg)))\nplane(z: -2, mat: matte(image(\"assets/earth.png\", mapping: \"planar\") |> scale([4, 2, 1])))\nlight(at: [4, 8, 6])",
    run: Run::Call(image),
}];

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
    // What is wrong with the picture is shown at its name.
    let span = host.argument();
    let image = host.build().image(AssetFile { path: a.text(0).into(), file: span.file, span });
    add(host, PatternKind::Image { image, mapping, filter })
}
