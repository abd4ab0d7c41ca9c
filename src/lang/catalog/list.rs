//! Lists and records.

use crate::lang::fault::{Fault, Outcome};
use crate::lang::value::Value;
use crate::lang::word::{Host, Kind, Run, Ty, Word, required};
use ecow::EcoVec;

pub const WORDS: &[Word] = &[
    Word {
        name: "len",
        kind: Kind::List,
        params: &[required("of", Ty::Any, "a list, range, text or record")],
        doc: "How many values a list, range or record has, or characters a text.",
        example: "let three = len([1, 2, 3])",
        run: Run::Call(|_, a| match a[0].length() {
            Some(n) => Ok(Value::Number(n as f64)),
            None => Err(Fault::new(format!("`len` can't count {}", a[0].kind())).on(0).into()),
        }),
    },
    Word {
        name: "map",
        kind: Kind::List,
        params: &[required("list", Ty::List, "the values"), required("f", Ty::Function, "a function of one value")],
        doc: "The list of what a function makes of each value.",
        example: "let squares = 0..5 |> map(x => x * x)",
        run: Run::Call(map),
    },
    Word {
        name: "record",
        kind: Kind::List,
        params: &[],
        doc: "Values with names: `record(a: 1)` has `.a`, and `.with(a: 2)` makes a changed copy.",
        example: "let leaf = record(size: 2, color: green)\nlet large = leaf.with(size: leaf.size * 2)",
        run: Run::Syntax,
    },
];

fn map(host: &mut dyn Host, a: &[Value]) -> Outcome {
    let n = a[0].length().unwrap_or(0);
    let mut out = EcoVec::new();
    for i in 0..n {
        host.spend(1)?;
        let item = a[0].item(i).unwrap_or(Value::None);
        out.push(host.call(&a[1], &[item])?);
    }
    Ok(Value::list(out))
}
