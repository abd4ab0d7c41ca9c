//! Materials.

use crate::lang::ast::Op;
use crate::lang::fault::Outcome;
use crate::lang::ops;
use crate::lang::property::amount;
use crate::lang::value::Value;
use crate::lang::word::{Args, Default, Host, Kind, Param, Run, Ty, Word, optional, required};
use crate::scene::material::MaterialDefaults as D;
use crate::scene::{Material, range};

/// The slots, for `phong` and for `.with`.
pub const SLOTS: &[Param] = &[
    optional("color", Ty::ColorPaint, Default::Gray(0.8), "its own color").light(),
    optional("ambient", Ty::Paint, Default::Number(D::AMBIENT), "how much of the scene's ambient light it gives back")
        .at_least(0.0)
        .light(),
    optional("diffuse", Ty::Paint, Default::Number(D::DIFFUSE), "how much of the lights' light it scatters")
        .at_least(0.0)
        .light(),
    optional("specular", Ty::Paint, Default::Number(D::SPECULAR), "how strong its highlights are")
        .at_least(0.0)
        .light(),
    optional("shininess", Ty::NumberPaint, Default::Number(D::SHININESS), "how small its highlights are")
        .within(0.0, range::SHINIEST),
    optional("reflect", Ty::Paint, Default::Number(D::REFLECT), "how much it mirrors").at_least(0.0).light(),
    optional("transmit", Ty::Paint, Default::Number(D::TRANSMIT), "how much of what lies behind it shows through")
        .at_least(0.0)
        .light(),
    optional(
        "ior",
        Ty::Number,
        Default::Absent,
        "how strongly it bends light against the air around it: 1.33 for water, 1.5 for glass",
    )
    .within(1.0, 10.0),
    optional(
        "bump",
        Ty::NumberPaint,
        Default::Absent,
        "a height that roughens it, in units of the space in which the shape is made; its slope tilts the normal, so a pattern with steps, such as `checker`, does nothing",
    ),
];

pub const WORDS: &[Word] = &[
    Word {
        name: "phong",
        kind: Kind::Material,
        params: SLOTS,
        doc: "A material by Phong's formula: matte color, highlights, mirror image and transparency, each a plain value or a pattern.",
        example: "sphere(mat: phong(color: #c33, specular: 0.5, shininess: 60, reflect: 0.1))\nlight(at: [4, 8, 6])",
        run: Run::Call(phong),
    },
    Word {
        name: "matte",
        kind: Kind::Material,
        params: &[required("color", Ty::ColorPaint, "its color").light()],
        doc: "A material without highlights: `phong(color: …)`.",
        example: "sphere(mat: matte(#c33))\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| with(host, &[("color", a[0].clone())])),
    },
    Word {
        name: "plastic",
        kind: Kind::Material,
        params: &[required("color", Ty::ColorPaint, "its color").light()],
        doc: "A smooth, colored material with white highlights: `phong(color: …, specular: 0.5, shininess: 60)`.",
        example: "sphere(mat: plastic(tomato))\nsphere(at: [2.5, 0, 0], mat: plastic(checker(white, teal, size: 0.5)))\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| {
            with(host, &[("color", a[0].clone()), ("specular", Value::Number(0.5)), ("shininess", Value::Number(60.0))])
        }),
    },
    Word {
        name: "metal",
        kind: Kind::Material,
        params: &[
            required("color", Ty::ColorPaint, "its color, which its mirror image and its highlights have too").light(),
            optional("reflect", Ty::Number, Default::Number(0.6), "how much it mirrors").at_least(0.0).light(),
        ],
        doc: "A polished metal: a little matte color, and highlights and a mirror image in that color.",
        example: "sphere(mat: metal(gold))\nplane(y: -1, mat: matte(checker(gray(0.9), gray(0.3))))\nbackground(skyblue)\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| {
            let span = host.place().span;
            let reflect = ops::binary(Op::Multiply, &a[0], &a[1], host.build(), span)?;
            let n = Value::Number;
            let slots = [("color", a[0].clone()), ("diffuse", n(0.4)), ("specular", a[0].clone())];
            with(host, &[&slots[..], &[("shininess", n(80.0)), ("reflect", reflect)]].concat())
        }),
    },
    Word {
        name: "mirror",
        kind: Kind::Material,
        params: &[
            optional("tint", Ty::Paint, Default::Number(1.0), "the color of what it mirrors").at_least(0.0).light(),
            optional("reflect", Ty::Number, Default::Number(0.9), "how much of it").at_least(0.0).light(),
        ],
        doc: "A mirror without a color of its own, but with a small highlight.",
        example: "sphere(mat: mirror(tint: #fd8))\nplane(y: -1, mat: matte(checker(white, black)))\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| {
            let span = host.place().span;
            let reflect = ops::binary(Op::Multiply, &a[0], &a[1], host.build(), span)?;
            polished(host, &[("reflect", reflect)])
        }),
    },
    Word {
        name: "glass",
        kind: Kind::Material,
        params: &[
            optional("tint", Ty::Paint, Default::Number(1.0), "the color of what shows through").at_least(0.0).light(),
            optional("ior", Ty::Number, Default::Number(1.5), "how strongly it bends light against the air around it")
                .within(1.0, 10.0),
        ],
        doc: "Clear or colored glass, which bends light and mirrors at its edges.",
        example: "sphere(mat: glass(tint: #8fc))\nplane(y: -1, mat: matte(checker(white, black)))\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| polished(host, &[("transmit", a[0].clone()), ("ior", a[1].clone())])),
    },
];

fn phong(host: &mut dyn Host, a: &[Value]) -> Outcome {
    let slots: Vec<(&str, Value)> =
        SLOTS.iter().enumerate().filter(|(i, _)| a.given(*i)).map(|(i, p)| (p.name, a[i].clone())).collect();
    with(host, &slots)
}

/// The default material with some slots set.
fn with(host: &mut dyn Host, slots: &[(&str, Value)]) -> Outcome {
    let place = host.place();
    let build = host.build();
    let mut m = Material { place: Some(place), ..build.scene.materials[0].clone() };
    for (name, value) in slots {
        // Products of two arguments; each of them alone has been found to be one.
        if matches!(*name, "reflect" | "transmit") {
            amount(name, value, build)?;
        }
        build.set_slot(&mut m, name, value);
    }
    Ok(build.material(m)?)
}

/// A clear, smooth surface: it has no color of its own but a small highlight.
fn polished(host: &mut dyn Host, slots: &[(&str, Value)]) -> Outcome {
    let n = Value::Number;
    let mut all = vec![("ambient", n(0.0)), ("diffuse", n(0.0)), ("specular", n(0.5)), ("shininess", n(200.0))];
    all.extend_from_slice(slots);
    with(host, &all)
}
