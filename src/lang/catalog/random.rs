//! Randomness that is a function of its keys: the same keys, the same value, on every machine and after every edit.

use crate::lang::fault::Fault;
use crate::lang::value::Value;
use crate::lang::word::{Kind, Param, Run, Ty, Word, required, rest};
use crate::math::fun::{cos_deg, sin_deg, sqrt};
use crate::math::hash::KeyedHash;

const KEY: Param = required("key", Ty::Any, "a number, text, angle, truth value or list: what to be random by");
const KEYS: Param = rest("keys", Ty::Any, "further keys");

pub const WORDS: &[Word] = &[
    Word {
        name: "rand",
        kind: Kind::Random,
        params: &[KEY, KEYS],
        doc: "A random number from 0 to below 1, always the same for the same keys.",
        example: "for i in 0..9 { sphere(at: [i, rand(i, \"height\"), 0], r: 0.3) }\nlight(at: [4, 8, 6])",
        run: Run::Call(|_, a| Ok(Value::Number(hash(a)?.unit()))),
    },
    Word {
        name: "on_sphere",
        kind: Kind::Random,
        params: &[KEY, KEYS],
        doc: "A random point on the sphere of radius 1 around the origin, always the same for the same keys.",
        example: "for i in 0..99 { sphere(at: on_sphere(i), r: 0.1) }\nlight(at: [4, 8, 6])",
        run: Run::Call(|_, a| {
            // Archimedes: heights on a sphere are uniform.
            let h = hash(a)?;
            let y = 2.0 * h.with(1).unit() - 1.0;
            let (turn, r) = (360.0 * h.with(2).unit(), sqrt(1.0 - y * y));
            Ok(Value::Vec3([r * cos_deg(turn), y, r * sin_deg(turn)]))
        }),
    },
];

fn hash(keys: &[Value]) -> Result<KeyedHash, Box<Fault>> {
    let given = keys.iter().enumerate().filter(|(_, k)| !matches!(k, Value::Unset));
    given.into_iter().try_fold(KeyedHash::new(), |h, (i, k)| add(h, k).map_err(|f| f.on(i)))
}

fn add(h: KeyedHash, key: &Value) -> Result<KeyedHash, Box<Fault>> {
    Ok(match key {
        Value::Number(n) => h.with_f64(*n),
        Value::Angle(n) => h.with(1).with_f64(*n),
        Value::Bool(b) => h.with(2 + u64::from(*b)),
        Value::Text(t) => h.with_text(t),
        Value::Color(c) => c.0.iter().fold(h.with(4), |h, x| h.with_f64(*x)),
        Value::Vec3(v) => v.iter().fold(h.with(3), |h, x| h.with_f64(*x)),
        Value::List(items) => items.iter().try_fold(h.with(items.len() as u64), add)?,
        other => return Err(Fault::new(format!("{} can't be a key of something random", other.kind()))),
    })
}
