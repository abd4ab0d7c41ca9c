//! Randomness that is a function of its keys: the same keys, the same value, on every machine and after every edit.

use super::pattern::{OCTAVES, SEED};
use crate::lang::build::Build;
use crate::lang::fault::{Fault, Outcome};
use crate::lang::ops::{list_steps, pause};
use crate::lang::value::Value;
use crate::lang::word::{Args, Host, Kind, Param, Run, Ty, Word, required, rest};
use crate::math::fun::{cbrt, cos_deg, sin_deg, sqrt};
use crate::math::hash::KeyedHash;
use crate::math::noise::unit_noise;
use ecow::EcoVec;

const KEY: Param = required("key", Ty::Any, "a number, text, angle, truth value, color or list: what to be random by");
const KEYS: Param = rest("keys", Ty::Any, "further keys");
const LIST: Param = required("list", Ty::List, "a list or range");

pub const WORDS: &[Word] = &[
    Word {
        name: "rand",
        kind: Kind::Random,
        params: &[KEY, KEYS],
        doc: "A random number from 0 to below 1, always the same for the same keys.",
        example: "for i in 0..9 { sphere(at: [i, rand(i, \"height\"), 0], r: 0.2 + 0.2 * rand(i, \"size\")) }\ncamera(from: [4, 2, 12], at: [4, 0.5, 0])\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| Ok(Value::Number(hash_of(host, a, 0)?.unit()))),
    },
    Word {
        name: "pick",
        kind: Kind::Random,
        params: &[LIST, KEY, KEYS],
        doc: "A random value of a list or range, always the same for the same keys.",
        example: "for i in 0..9 {\n  let color = pick([tomato, gold, teal], i, \"color\")\n  sphere(at: [i, 0, 0], r: 0.4, mat: matte(color))\n}\ncamera(from: [4, 2, 12], at: [4, 0, 0])\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| {
            let n = a[0].length().unwrap_or(0);
            if n == 0 {
                return Err(Fault::new("the list is empty").on(0).into());
            }
            let i = index(hash_of(host, a, 1)?, n);
            Ok(a[0].item(i).unwrap_or(Value::None))
        }),
    },
    Word {
        name: "shuffle",
        kind: Kind::Random,
        params: &[LIST, KEY, KEYS],
        doc: "A list's values in a random order, always the same for the same keys.",
        example: "let seats = shuffle(1..=4, \"dinner\")\nfor seat in enumerate(seats) { sphere(at: [2 * seat[0], 0, 0], r: seat[1] / 5) }\nlight(at: [4, 8, 6])",
        run: Run::Call(shuffle),
    },
    Word {
        name: "on_sphere",
        kind: Kind::Random,
        params: &[KEY, KEYS],
        doc: "A random point on the sphere of radius 1 around the origin, always the same for the same keys.",
        example: "for i in 0..200 { sphere(at: 2 * on_sphere(i), r: 0.1) }\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| Ok(Value::Vec3(on_sphere(hash_of(host, a, 0)?)))),
    },
    Word {
        name: "in_sphere",
        kind: Kind::Random,
        params: &[KEY, KEYS],
        doc: "A random point in the sphere of radius 1 around the origin, always the same for the same keys.",
        example: "for i in 0..200 { sphere(at: 2 * in_sphere(i), r: 0.1) }\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| {
            // Volumes grow with the third power of the radius.
            let h = hash_of(host, a, 0)?;
            let r = cbrt(h.with(3).unit());
            Ok(Value::Vec3(on_sphere(h).map(|x| x * r)))
        }),
    },
    Word {
        name: "in_box",
        kind: Kind::Random,
        params: &[
            required("from", Ty::Point, "one corner"),
            required("to", Ty::Point, "the opposite corner"),
            KEY,
            KEYS,
        ],
        doc: "A random point in a box along the axes, always the same for the same keys.",
        example: "for i in 0..100 { sphere(at: in_box([-4, 0, -4], [4, 1, 4], i), r: 0.2) }\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| {
            let (h, from, to) = (hash_of(host, a, 2)?, a.vec3(0), a.vec3(1));
            Ok(Value::Vec3([0, 1, 2].map(|i| {
                let u = h.with(i as u64).unit();
                (1.0 - u) * from[i] + u * to[i]
            })))
        }),
    },
    Word {
        name: "noise_at",
        kind: Kind::Random,
        params: &[required("p", Ty::Point, "the point"), OCTAVES, SEED],
        doc: "Smooth noise at a point, from 0 to 1: what the pattern `noise()` is there.",
        example: "for x in -8..8 {\n  for z in -8..8 {\n    let height = 3 * noise_at([x, 0, z] * 0.2)\n    box(from: [x, 0, z], to: [x + 0.9, 0.1 + height, z + 0.9])\n  }\n}\ncamera(from: [6, 12, 16], at: [0, 0, 0])\nlight(at: [14, 18, 6])",
        run: Run::Call(|_, a| {
            Ok(Value::Number(unit_noise(a.vec3(0).to_array(), a.number(1) as u32, a.number(2) as u64)))
        }),
    },
];

/// The hash of the arguments from the one numbered `first` on.
pub fn hash_of(host: &mut dyn Host, args: &[Value], first: usize) -> Result<KeyedHash, Box<Fault>> {
    let build = host.build();
    let mut given = args.iter().enumerate().skip(first).filter(|(_, k)| !matches!(k, Value::Unset));
    given.try_fold(KeyedHash::new(), |h, (i, k)| add(h, k, build).map_err(|f| f.on(i)))
}

fn add(h: KeyedHash, key: &Value, build: &mut Build) -> Result<KeyedHash, Box<Fault>> {
    Ok(match key {
        Value::Number(n) => h.with_f64(*n),
        Value::Angle(n) => h.with(1).with_f64(*n),
        Value::Bool(b) => h.with(2 + u64::from(*b)),
        Value::Text(t) => h.with_text(t),
        Value::Color(c) => c.0.iter().fold(h.with(4), |h, x| h.with_f64(*x)),
        Value::Vec3(v) => v.iter().fold(h.with(3), |h, x| h.with_f64(*x)),
        Value::List(items) => {
            build.spend(list_steps(items))?;
            items.iter().enumerate().try_fold(h.with(items.len() as u64), |h, (i, item)| {
                pause(i, build)?;
                add(h, item, build)
            })?
        }
        other => return Err(Fault::new(format!("{} can't be a key of something random", other.kind()))),
    })
}

/// One of `n` positions.
fn index(h: KeyedHash, n: u64) -> u64 {
    ((h.unit() * n as f64) as u64).min(n - 1)
}

/// A uniform direction: heights on a sphere are uniform (Archimedes).
pub fn on_sphere(h: KeyedHash) -> [f64; 3] {
    let y = 2.0 * h.with(1).unit() - 1.0;
    let (turn, r) = (360.0 * h.with(2).unit(), sqrt(1.0 - y * y));
    [r * cos_deg(turn), y, r * sin_deg(turn)]
}

/// Fisher and Yates' exchange of each position with one of those before it.
fn shuffle(host: &mut dyn Host, a: &[Value]) -> Outcome {
    let h = hash_of(host, a, 1)?;
    let mut out = EcoVec::new();
    super::list::each(host, &a[0], |host, item| super::list::push(host, &mut out, item).map(|()| true))?;
    let items = out.make_mut();
    for i in (1..items.len()).rev() {
        pause(i, host.build())?;
        items.swap(i, index(h.with(i as u64), i as u64 + 1) as usize);
    }
    Ok(Value::list(out))
}
