//! Mixtures of patterns, colors and numbers. Of plain values they are plain values.

use super::pattern::add;
use crate::lang::fault::{Fault, Outcome};
use crate::lang::value::Value;
use crate::lang::word::{Host, Kind, Run, Ty, Word, required};
use crate::scene::{Color, PatternKind};

pub const WORDS: &[Word] = &[
    Word {
        name: "mix",
        kind: Kind::Pattern,
        params: &[
            required("a", Ty::Paint, "a color, number or pattern: the result where `by` is 0"),
            required("b", Ty::Paint, "the result where `by` is 1"),
            required("by", Ty::Paint, "the share of `b`; a color is taken channel by channel"),
        ],
        doc: "Two patterns, colors or numbers mixed: (1 - by)·a + by·b, in linear light.",
        example: "let rust = noise(octaves: 5) |> scale(0.5)\nsphere(mat: phong(color: mix(steelblue, sienna, rust), reflect: mix(0.4, 0, rust)))\nsphere(at: [2.5, 0, 0], mat: matte(mix(steelblue, white, 0.4)))\nlight(at: [4, 8, 6])",
        run: Run::Call(mix),
    },
    Word {
        name: "blend",
        kind: Kind::Pattern,
        params: &[
            required("stops", Ty::Paints, "colors, numbers or patterns, evenly spaced from 0 to 1"),
            required("by", Ty::NumberPaint, "the position between them; below 0 it is 0, above 1 it is 1"),
        ],
        doc: "The way along a list of colors, numbers or patterns, each mixed with the next, in linear light.",
        example: "let embers = blend([black, darkred, orange, lightyellow], by: noise(octaves: 6))\nsphere(r: 2, mat: phong(color: embers, ambient: 4))\nlight(at: [4, 8, 6])",
        run: Run::Call(blend),
    },
];

fn mix(host: &mut dyn Host, a: &[Value]) -> Outcome {
    if let [Some(x), Some(y), Some(by)] = [0, 1, 2].map(|i| Plain::new(&a[i])) {
        return x.mixed(y, by).value();
    }
    let [Some(x), Some(y), Some(by)] = [0, 1, 2].map(|i| host.build().paint(&a[i])) else { return Ok(Value::None) };
    add(host, PatternKind::Mix { a: x, b: y, by })
}

fn blend(host: &mut dyn Host, a: &[Value]) -> Outcome {
    let items = a[0].items().unwrap_or_default();
    let plain: Option<Vec<Plain>> = items.iter().map(Plain::new).collect();
    if let (Some(stops), Value::Number(by)) = (plain, &a[1]) {
        // Two stops at least: the type of the parameter.
        let last = stops.len() - 1;
        let x = by.clamp(0.0, 1.0) * last as f64;
        let k = (x.floor() as usize).min(last - 1);
        let share = Plain { channels: [x - k as f64; 3], number: true };
        return stops[k].mixed(stops[k + 1], share).value();
    }
    let stops = items.iter().filter_map(|v| host.build().paint(v)).collect();
    let Some(by) = host.build().paint(&a[1]) else { return Ok(Value::None) };
    add(host, PatternKind::Blend { stops, by })
}

/// A number or a color.
#[derive(Clone, Copy)]
struct Plain {
    channels: [f64; 3],
    number: bool,
}

impl Plain {
    fn new(v: &Value) -> Option<Plain> {
        match v {
            Value::Number(n) => Some(Plain { channels: [*n; 3], number: true }),
            Value::Color(c) => Some(Plain { channels: c.0, number: false }),
            _ => None,
        }
    }
    fn mixed(self, b: Plain, by: Plain) -> Plain {
        let one = |i: usize| (1.0 - by.channels[i]) * self.channels[i] + by.channels[i] * b.channels[i];
        Plain { channels: std::array::from_fn(one), number: self.number && b.number && by.number }
    }
    fn value(self) -> Outcome {
        if !self.channels.iter().all(|v| v.is_finite()) {
            return Err(Fault::new("the result is too large").into());
        }
        Ok(if self.number { Value::Number(self.channels[0]) } else { Value::Color(Color(self.channels)) })
    }
}
