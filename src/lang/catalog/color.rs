//! Colors. `rgb`, `gray` and `hsv` are sRGB-encoded, as color pickers have them; `linear` is scene-linear light.

use crate::lang::fault::Fault;
use crate::lang::value::Value;
use crate::lang::word::{Args, Default, Kind, Param, Run, Ty, Word, optional, required};
use crate::scene::Color;

const fn channel(name: &'static str) -> Param {
    required(name, Ty::Number, "0 to 1").within(0.0, 1.0)
}

macro_rules! named {
    ($name:literal, $r:literal $g:literal $b:literal) => {
        Word {
            name: $name,
            kind: Kind::Color,
            params: &[],
            doc: concat!("The color that CSS calls ", $name, "."),
            example: concat!("sphere(mat: matte(", $name, "))\nlight(at: [4, 8, 6])"),
            run: Run::Constant(|| Value::Color(Color::from_srgb8([$r, $g, $b]))),
        }
    };
}

pub const WORDS: &[Word] = &[
    Word {
        name: "rgb",
        kind: Kind::Color,
        params: &[channel("r"), channel("g"), channel("b")],
        doc: "A color from its sRGB channels.",
        example: "sphere(mat: matte(rgb(1, 0.5, 0)))\nlight(at: [4, 8, 6])",
        run: Run::Call(|_, a| Ok(Value::Color(Color::from_srgb([a.number(0), a.number(1), a.number(2)])))),
    },
    Word {
        name: "linear",
        kind: Kind::Color,
        params: &[
            required("r", Ty::Number, "red; alone, all three"),
            optional("g", Ty::Number, Default::Absent, "green").by_position(),
            optional("b", Ty::Number, Default::Absent, "blue").by_position(),
        ],
        doc: "A color from its linear channels: amounts of light; 1 is the brightest that a picture shows.",
        example: "sphere(mat: matte(linear(0.9, 0.5, 0.1)))\nbackground(linear(0.2))\nlight(at: [4, 8, 6])",
        run: Run::Call(|_, a| match (a.given(1), a.given(2)) {
            (true, true) => Ok(Value::Color(Color([a.number(0), a.number(1), a.number(2)]))),
            (false, false) => Ok(Value::Color(Color::linear_gray(a.number(0)))),
            _ => Err(Fault::new("`linear` takes one number or three").into()),
        }),
    },
    Word {
        name: "gray",
        kind: Kind::Color,
        params: &[required("value", Ty::Number, "0 for black to 1 for white, sRGB").within(0.0, 1.0)],
        doc: "A grey.",
        example: "sphere(mat: matte(gray(0.8)))\nlight(at: [4, 8, 6])",
        run: Run::Call(|_, a| Ok(Value::Color(Color::from_srgb([a.number(0); 3])))),
    },
    Word {
        name: "hsv",
        kind: Kind::Color,
        params: &[
            required("hue", Ty::Angle, "0deg is red, 120deg green, 240deg blue"),
            required("saturation", Ty::Number, "0 for grey to 1").within(0.0, 1.0),
            required("value", Ty::Number, "0 for black to 1").within(0.0, 1.0),
        ],
        doc: "A color from hue, saturation and value.",
        example: "for i in 0..6 { sphere(at: [2 * i, 0, 0], mat: matte(hsv(i * 60deg, 0.8, 1))) }\nlight(at: [4, 8, 6])",
        run: Run::Call(|_, a| Ok(Value::Color(Color::from_hsv(a.number(0), a.number(1), a.number(2))))),
    },
    named!("black", 0 0 0),
    named!("white", 255 255 255),
    named!("silver", 192 192 192),
    named!("red", 255 0 0),
    named!("green", 0 128 0),
    named!("blue", 0 0 255),
    named!("yellow", 255 255 0),
    named!("cyan", 0 255 255),
    named!("magenta", 255 0 255),
    named!("orange", 255 165 0),
    named!("gold", 255 215 0),
    named!("pink", 255 192 203),
    named!("purple", 128 0 128),
    named!("brown", 165 42 42),
    named!("navy", 0 0 128),
    named!("teal", 0 128 128),
    named!("olive", 128 128 0),
    named!("maroon", 128 0 0),
    named!("lime", 0 255 0),
    named!("skyblue", 135 206 235),
];
