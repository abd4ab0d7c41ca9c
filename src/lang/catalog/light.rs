//! Lights.

use crate::lang::property::amount;
use crate::lang::value::Value;
use crate::lang::word::{Args, Default, Kind, Run, Ty, Word, optional, required};
use crate::scene::{Light, NodeKind};

pub const WORDS: &[Word] = &[Word {
    name: "light",
    kind: Kind::Light,
    params: &[
        required("at", Ty::Point, "where it is"),
        optional("color", Ty::Level, Default::Number(1.0), "its color, or a number for a gray; white unless given")
            .at_least(0.0)
            .light(),
        optional("power", Ty::Number, Default::Number(1.0), "a factor on its color").at_least(0.0).light(),
        optional("name", Ty::Text, Default::Absent, "what messages and `explain` call it"),
    ],
    doc: "A point that shines in all directions, equally strong at every distance.",
    example: "sphere()\nlight(at: [4, 8, 6])\nlight(at: [-6, 3, 2], color: #9fc4ff, power: 0.4)",
    run: Run::Call(|host, a| {
        let light = Light { at: a.vec3(0), color: a.level(1), power: a.number(2) };
        amount("color * power", &Value::Color(light.color * light.power), host.build()).map_err(|f| f.on(2))?;
        let name = a.given(3).then(|| a.text(3).into());
        let place = host.place();
        Ok(host.build().node(NodeKind::Light(light), None, name, place)?)
    }),
}];
