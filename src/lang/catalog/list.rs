//! Lists and records. A range goes wherever a list does.

use crate::lang::ast::Op;
use crate::lang::fault::{Fault, Outcome, Stop};
use crate::lang::ops;
use crate::lang::value::Value;
use crate::lang::word::{Args, Default, Host, Kind, Param, Run, Ty, Word, optional, required, rest};
use ecow::EcoVec;

const LIST: Param = required("list", Ty::List, "a list or range");
const F: Param = required("f", Ty::Function, "a function of one value");

pub const WORDS: &[Word] = &[
    Word {
        name: "len",
        kind: Kind::List,
        params: &[required("of", Ty::Any, "a list, range, text or record")],
        doc: "How many values a list, range or record has, or characters a text.",
        example: "let three = len([10, 20, 30])     // → 3",
        run: Run::Call(|_, a| match a[0].length() {
            Some(n) => Ok(Value::Number(n as f64)),
            None => Err(Fault::new(format!("`len` can't count {}", a[0].kind())).on(0).into()),
        }),
    },
    Word {
        name: "map",
        kind: Kind::List,
        params: &[LIST, F],
        doc: "The list of what a function makes of each value.",
        example: "let squares = 0..5 |> map(x => x * x)     // → [0, 1, 4, 9, 16]",
        run: Run::Call(|host, a| Ok(Value::list(made(host, &a[0], |host, item| host.call(&a[1], &[item]).map(Some))?))),
    },
    Word {
        name: "filter",
        kind: Kind::List,
        params: &[LIST, required("f", Ty::Function, "a function of one value that gives true or false")],
        doc: "The list of those values for which a function gives true.",
        example: "let odd = 0..10 |> filter(x => x % 2 == 1)       // → [1, 3, 5, 7, 9]",
        run: Run::Call(|host, a| {
            let kept = made(host, &a[0], |host, item| match host.call(&a[1], std::slice::from_ref(&item))? {
                Value::Bool(keep) => Ok(keep.then_some(item)),
                other => {
                    let got = other.kind();
                    Err(Fault::new(format!("the function must give true or false, got {got}")).on(1).into())
                }
            })?;
            Ok(Value::list(kept))
        }),
    },
    Word {
        name: "fold",
        kind: Kind::List,
        params: &[
            LIST,
            required("start", Ty::Any, "the first result"),
            required("f", Ty::Function, "a function of the result so far and the next value"),
        ],
        doc: "One value made of a list: starting with `start`, the result so far and each value in turn make the next result.",
        example: "let product = [2, 3, 4] |> fold(1, (so_far, x) => so_far * x)      // → 24\nlet largest = [2, 9, 4] |> fold(0, max)      // → 9",
        run: Run::Call(|host, a| {
            let mut result = a[1].clone();
            each(host, &a[0], |host, item| {
                result = host.call(&a[2], &[std::mem::replace(&mut result, Value::None), item])?;
                Ok(true)
            })?;
            Ok(result)
        }),
    },
    Word {
        name: "sum",
        kind: Kind::List,
        params: &[LIST],
        doc: "The sum of a list of numbers, angles, vectors, colors or patterns; of an empty one 0.",
        example: "let ten = sum([1, 2, 3, 4])       // → 10\nlet corner = sum([[1, 0, 0], [0, 2, 0]])      // → [1, 2, 0]",
        run: Run::Call(|host, a| {
            let span = host.place().span;
            let mut result = None;
            each(host, &a[0], |host, item| {
                result = Some(match &result {
                    None => item,
                    Some(so_far) => ops::binary(Op::Add, so_far, &item, host.build(), span)?,
                });
                Ok(true)
            })?;
            Ok(result.unwrap_or(Value::Number(0.0)))
        }),
    },
    Word {
        name: "steps",
        kind: Kind::List,
        params: &[
            required("from", Ty::Any, "the first value: a number, angle, vector or color"),
            required("to", Ty::Any, "the last one"),
            required("n", Ty::Whole, "how many").within(2.0, 10_000_000.0),
        ],
        doc: "A list of n values, evenly spaced from the first to the last, both included.",
        example: "let fifths = steps(0, 1, 6)       // → [0, 0.2, 0.4, 0.6, 0.8, 1]\nfor angle in steps(0deg, 180deg, 9) { sphere(at: [3 * cos(angle), 3 * sin(angle), 0], r: 0.4) }\nlight(at: [4, 8, 6])",
        run: Run::Call(steps),
    },
    Word {
        name: "zip",
        kind: Kind::List,
        params: &[LIST, required("other", Ty::List, "another one, as long")],
        doc: "The list of pairs of the values of two lists.",
        example: "let pairs = zip([1, 2], [10, 20])     // → [[1, 10], [2, 20]]",
        run: Run::Call(|host, a| {
            let (n, m) = (a[0].length(), a[1].length());
            if n != m {
                let (n, m) = (n.unwrap_or(0), m.unwrap_or(0));
                return Err(Fault::new(format!("lists of {n} and of {m} have no pairs")).on(1).into());
            }
            let mut i = 0;
            let pairs = made(host, &a[0], |_, item| {
                i += 1;
                Ok(Some(Value::list([item, a[1].item(i - 1).unwrap_or(Value::None)].into())))
            })?;
            Ok(Value::list(pairs))
        }),
    },
    Word {
        name: "enumerate",
        kind: Kind::List,
        params: &[LIST],
        doc: "The list of pairs of a position, from 0, and the value there.",
        example: "for entry in enumerate([red, gold, green]) {\n  sphere(at: [2.5 * entry[0], 0, 0], mat: matte(entry[1]))\n}\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| {
            let mut i = -1.0;
            let pairs = made(host, &a[0], |_, item| {
                i += 1.0;
                Ok(Some(Value::list([Value::Number(i), item].into())))
            })?;
            Ok(Value::list(pairs))
        }),
    },
    Word {
        name: "sort",
        kind: Kind::List,
        params: &[
            LIST,
            optional("by", Ty::Function, Default::Absent, "a function that gives what to sort a value by")
                .by_position(),
        ],
        doc: "A list in rising order of its numbers, angles or texts, or of those that `by` makes of its values; equal ones keep their order.",
        example: "let rising = sort([3, 1, 2])      // → [1, 2, 3]\nlet longest_last = sort([\"mirror\", \"ball\"], by: len)      // → [\"ball\", \"mirror\"]",
        run: Run::Call(super::sort::sort),
    },
    Word {
        name: "reverse",
        kind: Kind::List,
        params: &[LIST],
        doc: "A list from its end to its beginning.",
        example: "let down = reverse(1..=3)     // → [3, 2, 1]",
        run: Run::Call(|host, a| {
            let mut out = EcoVec::new();
            for i in (0..a[0].length().unwrap_or(0)).rev() {
                host.spend(1)?;
                push(host, &mut out, a[0].item(i).unwrap_or(Value::None))?;
            }
            Ok(Value::list(out))
        }),
    },
    Word {
        name: "concat",
        kind: Kind::List,
        params: &[LIST, rest("more", Ty::List, "further lists")],
        doc: "Several lists one after the other; `+` adds lists number by number instead.",
        example: "let four = concat([1, 2], [3], [4])       // → [1, 2, 3, 4]",
        run: Run::Call(|host, a| {
            let mut out = EcoVec::new();
            for list in (0..a.len()).filter(|i| a.given(*i)).map(|i| &a[i]) {
                each(host, list, |host, item| push(host, &mut out, item).map(|()| true))?;
            }
            Ok(Value::list(out))
        }),
    },
    Word {
        name: "slice",
        kind: Kind::List,
        params: &[
            LIST,
            required("from", Ty::Whole, "the position of the first value, counted from 0").at_least(0.0),
            optional(
                "to",
                Ty::Whole,
                Default::Absent,
                "the position after the last value; the list's end unless given",
            )
            .by_position()
            .at_least(0.0),
        ],
        doc: "The values of a list from one position up to, but without, another.",
        example: "let middle = slice([10, 20, 30, 40], 1, 3)        // → [20, 30]",
        run: Run::Call(|host, a| {
            let n = a[0].length().unwrap_or(0);
            let to = if a.given(2) { a.number(2) } else { n as f64 };
            if to > n as f64 {
                return Err(Fault::new(format!("the list has {n} values, `to` is beyond them")).on(2).into());
            }
            if a.number(1) > to {
                return Err(Fault::new("`from` is after the end of the slice").on(1).into());
            }
            let (from, to) = (a.number(1) as u64, to as u64);
            let mut out = EcoVec::new();
            for i in from..to {
                host.spend(1)?;
                push(host, &mut out, a[0].item(i).unwrap_or(Value::None))?;
            }
            Ok(Value::list(out))
        }),
    },
    Word {
        name: "first",
        kind: Kind::List,
        params: &[LIST],
        doc: "The first value of a list.",
        example: "let ten = first([10, 20, 30])     // → 10",
        run: Run::Call(|_, a| end(&a[0], |_| 0)),
    },
    Word {
        name: "last",
        kind: Kind::List,
        params: &[LIST],
        doc: "The last value of a list.",
        example: "let thirty = last([10, 20, 30])       // → 30",
        run: Run::Call(|_, a| end(&a[0], |n| n - 1)),
    },
    Word {
        name: "contains",
        kind: Kind::List,
        params: &[
            required("list", Ty::Any, "a list or range, or a text"),
            required("value", Ty::Any, "what to look for"),
        ],
        doc: "Whether a list has a value, or a text another text.",
        example: "let yes = contains([1, 2, 3], 2)      // → true\nlet no = contains(\"marble\", \"glass\")     // → false",
        run: Run::Call(contains),
    },
    Word {
        name: "join",
        kind: Kind::List,
        params: &[LIST, optional("by", Ty::Text, Default::Text(""), "what stands between them").by_position()],
        doc: "One text of a list's values.",
        example: "let point = join([1, 2, 3], by: \", \")       // → \"1, 2, 3\"",
        run: Run::Call(join),
    },
    Word {
        name: "record",
        kind: Kind::List,
        params: &[],
        doc: "Values with names: `record(a: 1)` has `.a`, and `.with(a: 2)` makes a changed copy.",
        example: "let leaf = record(size: 2, color: green)\nlet large = leaf.with(size: leaf.size * 2)\nlet four = large.size     // → 4",
        run: Run::Syntax,
    },
];

/// Calls `visit` with each value until it gives false; every one costs a step.
pub fn each(
    host: &mut dyn Host,
    list: &Value,
    mut visit: impl FnMut(&mut dyn Host, Value) -> Result<bool, Stop>,
) -> Result<(), Stop> {
    for i in 0..list.length().unwrap_or(0) {
        host.spend(1)?;
        let Some(item) = list.item(i) else { break };
        if !visit(host, item)? {
            break;
        }
    }
    Ok(())
}

/// Adds a value to a list that is being made, within the budgets.
pub fn push(host: &mut dyn Host, out: &mut EcoVec<Value>, value: Value) -> Result<(), Stop> {
    let most = host.build().limits.list_length;
    if out.len() >= most {
        let message = format!("this list has more than {most} values");
        return Err(Fault::budget(message, "usually a list that is made too often").into());
    }
    host.hold(&value)?;
    out.push(value);
    Ok(())
}

/// A list of the values that a function gives for those of another.
fn made(
    host: &mut dyn Host,
    list: &Value,
    mut f: impl FnMut(&mut dyn Host, Value) -> Result<Option<Value>, Stop>,
) -> Result<EcoVec<Value>, Stop> {
    let mut out = EcoVec::new();
    each(host, list, |host, item| {
        if let Some(value) = f(host, item)? {
            push(host, &mut out, value)?;
        }
        Ok(true)
    })?;
    Ok(out)
}

fn end(list: &Value, which: impl Fn(u64) -> u64) -> Outcome {
    match list.length() {
        Some(n) if n > 0 => Ok(list.item(which(n)).unwrap_or(Value::None)),
        _ => Err(Fault::new("the list is empty").on(0).into()),
    }
}

fn steps(host: &mut dyn Host, a: &[Value]) -> Outcome {
    let span = host.place().span;
    let last = a.number(2) - 1.0;
    let mut out = EcoVec::new();
    for i in 0..a.number(2) as u64 {
        host.spend(1)?;
        let value = ops::lerp(&a[0], &a[1], i as f64 / last, host.build(), span)?;
        push(host, &mut out, value)?;
    }
    Ok(Value::list(out))
}

fn contains(host: &mut dyn Host, a: &[Value]) -> Outcome {
    if let (Value::Text(text), Value::Text(part)) = (&a[0], &a[1]) {
        return Ok(Value::Bool(text.contains(part.as_str())));
    }
    if !matches!(a[0], Value::List(_) | Value::Vec3(_) | Value::Range(_)) {
        let got = a[0].kind();
        return Err(Fault::new(format!("`contains` looks in a list, or for a text in a text, got {got}")).on(0).into());
    }
    let mut found = false;
    each(host, &a[0], |host, item| {
        found = item.equals(&a[1], host.build())?;
        Ok(!found)
    })?;
    Ok(Value::Bool(found))
}

fn join(host: &mut dyn Host, a: &[Value]) -> Outcome {
    let most = host.build().limits.text_length;
    let mut out = ecow::EcoString::new();
    let mut first = true;
    each(host, &a[0], |_, item| {
        if !std::mem::replace(&mut first, false) {
            out.push_str(a.text(1));
        }
        out.push_str(&item.interpolated(most));
        if out.len() > most {
            return Err(Fault::budget(format!("this text is longer than {most} bytes"), "join fewer values").into());
        }
        Ok(true)
    })?;
    Ok(Value::Text(out))
}
