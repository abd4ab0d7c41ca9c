//! Colors. `rgb`, `gray` and `hsv` are sRGB-encoded, as color pickers have them; `linear` is scene-linear light.

use crate::lang::fault::Fault;
use crate::lang::value::Value;
use crate::lang::word::{Args, Default, Kind, Param, Run, Ty, Word, optional, required};
use crate::scene::Color;

const fn channel(name: &'static str) -> Param {
    required(name, Ty::Number, "0 to 1").within(0.0, 1.0)
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
    Word {
        name: "oklch",
        kind: Kind::Color,
        params: &[
            required("lightness", Ty::Number, "0 for black to 1 for white").within(0.0, 1.0),
            required("chroma", Ty::Number, "how colorful: 0 for grey, about 0.3 at most").within(0.0, 1.0),
            required("hue", Ty::Angle, "about 30deg is red, 140deg green, 260deg blue"),
        ],
        doc: "A color from lightness, chroma and hue as the eye judges them (Oklch); where a screen can't show so much chroma, it has the most that can be shown.",
        example: "for i in 0..12 {\n  let hue = i * 30deg\n  sphere(at: [3 * cos(hue), 3 * sin(hue), 0], r: 0.7, mat: matte(oklch(0.7, 0.12, hue)))\n}\nlight(at: [4, 8, 6])",
        run: Run::Call(|_, a| Ok(Value::Color(oklch(a.number(0), a.number(1), a.number(2))))),
    },
];

/// The color, its chroma lowered until all channels lie in 0..=1.
fn oklch(lightness: f64, chroma: f64, hue: f64) -> Color {
    // Oklab's matrices are rounded: white comes out this much off.
    const ROUNDING: f64 = 1e-6;
    let fits = |c: Color| c.0.iter().all(|v| (-ROUNDING..=1.0 + ROUNDING).contains(v));
    let (mut low, mut high) = (0.0, chroma);
    if fits(Color::from_oklch(lightness, chroma, hue)) {
        low = chroma;
    }
    // Halving 40 times leaves less than a 1e-12th.
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if fits(Color::from_oklch(lightness, middle, hue)) { low = middle } else { high = middle }
    }
    Color(Color::from_oklch(lightness, low, hue).0.map(|v| v.clamp(0.0, 1.0)))
}
