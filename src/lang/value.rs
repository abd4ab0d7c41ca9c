//! The values of the language. Cloning one costs at most a reference count.

use super::build::Build;
use super::fault::Fault;
use super::ops::{list_steps, pause};
use crate::scene::{AntiAliasing, Color, MaterialId, NodeId, PatternId};
use ecow::{EcoString, EcoVec};
use std::fmt::Write;
use std::sync::Arc;

/// Any value.
#[derive(Clone, Debug)]
pub enum Value {
    /// A slot before its `let`, and a parameter that wasn't given.
    Unset,
    /// What a failed statement was to make; using it is no new error.
    Poison,
    /// `none`, and what a setting or a loop gives.
    None,
    Bool(bool),
    Number(f64),
    /// In degrees.
    Angle(f64),
    /// A list of three numbers: points and directions, without an allocation.
    Vec3([f64; 3]),
    List(EcoVec<Value>),
    Text(EcoString),
    Color(Color),
    Range(Range),
    Record(Arc<Record>),
    Function(Arc<Closure>),
    Builtin(BuiltinId),
    Pattern(PatternId),
    Material(MaterialId),
    /// A shape, light or group.
    Node(NodeId),
    /// `off`, `grid(n)`
    AntiAliasing(AntiAliasing),
}

/// `from..to` or `from..=to`, whole steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    pub from: f64,
    pub to: f64,
    pub inclusive: bool,
}

impl Range {
    /// How many values it has.
    pub fn len(self) -> u64 {
        let span = self.to - self.from;
        let n = if self.inclusive { span.floor() + 1.0 } else { span.ceil() };
        if n > 0.0 { n as u64 } else { 0 }
    }
}

/// Named values, in the order in which they were written.
pub type Record = indexmap::IndexMap<EcoString, Value>;

/// A word of the catalogue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuiltinId(pub u16);

/// A function of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FunctionId(pub u32);

/// A function and the values that it took along.
#[derive(Debug)]
pub struct Closure {
    pub function: FunctionId,
    pub captures: Box<[Value]>,
}

impl Value {
    /// What it is, in words.
    pub fn kind(&self) -> &'static str {
        match self {
            Value::Unset | Value::Poison | Value::None => "nothing",
            Value::Bool(_) => "true or false",
            Value::Number(_) => "a number",
            Value::Angle(_) => "an angle",
            Value::Vec3(_) | Value::List(_) => "a list",
            Value::Text(_) => "a text",
            Value::Color(_) => "a color",
            Value::Range(_) => "a range",
            Value::Record(_) => "a record",
            Value::Function(_) | Value::Builtin(_) => "a function",
            Value::Pattern(_) => "a pattern",
            Value::Material(_) => "a material",
            Value::Node(_) => "a shape, light or group",
            Value::AntiAliasing(_) => "a way of anti-aliasing",
        }
    }

    /// Whether its own numbers, but not those in a list, are ones that can be counted with.
    pub fn is_finite(&self) -> bool {
        match self {
            Value::Number(n) | Value::Angle(n) => n.is_finite(),
            Value::Vec3(v) | Value::Color(Color(v)) => v.iter().all(|x| x.is_finite()),
            _ => true,
        }
    }

    /// A list of these values.
    pub fn list(items: EcoVec<Value>) -> Value {
        match items[..] {
            [Value::Number(x), Value::Number(y), Value::Number(z)] => Value::Vec3([x, y, z]),
            _ => Value::List(items),
        }
    }

    /// The items, where it is a list.
    pub fn items(&self) -> Option<EcoVec<Value>> {
        match self {
            Value::Vec3(v) => Some(v.iter().map(|x| Value::Number(*x)).collect()),
            Value::List(items) => Some(items.clone()),
            _ => None,
        }
    }

    /// How many values a list, range or text has.
    pub fn length(&self) -> Option<u64> {
        match self {
            Value::Vec3(_) => Some(3),
            Value::List(l) => Some(l.len() as u64),
            Value::Range(r) => Some(r.len()),
            Value::Text(t) => Some(t.chars().count() as u64),
            Value::Record(r) => Some(r.len() as u64),
            _ => None,
        }
    }

    /// Item `i` of a list or range.
    pub fn item(&self, i: u64) -> Option<Value> {
        match self {
            Value::Vec3(v) => v.get(usize::try_from(i).ok()?).map(|x| Value::Number(*x)),
            Value::List(l) => l.get(usize::try_from(i).ok()?).cloned(),
            Value::Range(r) => (i < r.len()).then(|| Value::Number(r.from + i as f64)),
            _ => None,
        }
    }

    /// As the language would write it, cut to about `most` bytes.
    pub fn show(&self, most: usize) -> String {
        let mut out = String::new();
        self.write(&mut out, most);
        if out.len() > most {
            let cut = (0..=most).rev().find(|i| out.is_char_boundary(*i)).unwrap_or(0);
            out.truncate(cut);
            out.push('…');
        }
        out
    }

    fn write(&self, out: &mut String, most: usize) {
        if out.len() > most {
            return;
        }
        match self {
            Value::Bool(b) => out.push_str(if *b { "true" } else { "false" }),
            Value::Number(n) => out.push_str(&number_text(*n)),
            Value::Angle(a) => {
                let _ = write!(out, "{}deg", number_text(*a));
            }
            Value::Text(t) => {
                let _ = write!(out, "\"{t}\"");
            }
            Value::Color(Color([r, g, b])) => {
                let _ = write!(out, "linear({}, {}, {})", number_text(*r), number_text(*g), number_text(*b));
            }
            Value::Range(r) => {
                let dots = if r.inclusive { "..=" } else { ".." };
                let _ = write!(out, "{}{dots}{}", number_text(r.from), number_text(r.to));
            }
            Value::Vec3(v) => {
                let _ = write!(out, "[{}, {}, {}]", number_text(v[0]), number_text(v[1]), number_text(v[2]));
            }
            Value::List(items) => {
                out.push('[');
                for (i, item) in items.iter().enumerate() {
                    if i > 0 {
                        out.push_str(", ");
                    }
                    item.write(out, most);
                    if out.len() > most {
                        return;
                    }
                }
                out.push(']');
            }
            Value::Record(r) => {
                out.push_str("record(");
                for (i, (k, v)) in r.iter().enumerate() {
                    let _ = write!(out, "{}{k}: ", if i > 0 { ", " } else { "" });
                    v.write(out, most);
                }
                out.push(')');
            }
            Value::None | Value::Unset | Value::Poison => out.push_str("none"),
            Value::AntiAliasing(AntiAliasing::Off) => out.push_str("off"),
            Value::AntiAliasing(AntiAliasing::Grid(n)) => {
                let _ = write!(out, "grid({n})");
            }
            Value::AntiAliasing(AntiAliasing::Adaptive(n)) => {
                let _ = write!(out, "adaptive({n})");
            }
            Value::Function(_) | Value::Builtin(_) => out.push_str("function"),
            Value::Pattern(_) => out.push_str("pattern"),
            Value::Material(_) => out.push_str("material"),
            Value::Node(_) => out.push_str("shape"),
        }
    }

    /// As it stands in a text's `{…}`: like [`show`](Value::show), but text without quotes and nothing cut.
    pub fn interpolated(&self, limit: usize) -> String {
        match self {
            Value::Text(t) => t.to_string(),
            other => other.show(limit),
        }
    }

    /// `#rrggbb` of a color that a picture can show; empty for other values.
    pub fn color_code(&self) -> String {
        let Value::Color(c) = self else { return String::new() };
        let [r, g, b] = c.to_srgb().map(|v| (v * 255.0).round() as u8);
        format!("#{r:02x}{g:02x}{b:02x}")
    }

    /// Whether two values are equal; functions can't be compared.
    pub fn equals(&self, other: &Value, build: &mut Build) -> Result<bool, Box<Fault>> {
        Ok(match (self, other) {
            (Value::Number(a), Value::Number(b)) | (Value::Angle(a), Value::Angle(b)) => a == b,
            (Value::Bool(a), Value::Bool(b)) => a == b,
            (Value::Text(a), Value::Text(b)) => a == b,
            (Value::Color(a), Value::Color(b)) => a == b,
            (Value::Range(a), Value::Range(b)) => a == b,
            (Value::Pattern(a), Value::Pattern(b)) => a == b,
            (Value::Material(a), Value::Material(b)) => a == b,
            (Value::Node(a), Value::Node(b)) => a == b,
            (Value::Vec3(a), Value::Vec3(b)) => a == b,
            (Value::List(a), Value::List(b)) if a.len() == b.len() => {
                build.spend(list_steps(a))?;
                for (i, (x, y)) in a.iter().zip(b).enumerate() {
                    pause(i, build)?;
                    if !x.equals(y, build)? {
                        return Ok(false);
                    }
                }
                true
            }
            (Value::Record(a), Value::Record(b)) if a.len() == b.len() => {
                build.spend(1)?;
                for (k, x) in a.iter() {
                    match b.get(k) {
                        Some(y) if x.equals(y, build)? => {}
                        _ => return Ok(false),
                    }
                }
                true
            }
            (Value::None, Value::None) => true,
            (Value::Function(_) | Value::Builtin(_), Value::Function(_) | Value::Builtin(_)) => {
                return Err(Fault::new("functions can't be compared"));
            }
            (Value::Number(_), Value::Angle(_)) | (Value::Angle(_), Value::Number(_)) => {
                return Err(
                    Fault::new("a number and an angle can't be compared").note("write the angle's unit: `30deg`")
                );
            }
            _ => false,
        })
    }
}

/// The shortest text that reads back as the same number; powers of ten where that is shorter.
pub fn number_text(n: f64) -> String {
    let n = if n == 0.0 { 0.0 } else { n };
    let size = n.abs();
    if size != 0.0 && !(1e-5..1e15).contains(&size) { format!("{n:e}") } else { format!("{n}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_small() {
        assert!(size_of::<Value>() <= 32, "{}", size_of::<Value>());
    }

    #[test]
    fn numbers_read_well() {
        assert_eq!(number_text(0.25), "0.25");
        assert_eq!(number_text(-0.0), "0");
        assert_eq!(number_text(1e140), "1e140");
        assert_eq!(number_text(1_000_000.0), "1000000");
    }

    #[test]
    fn ranges_count_their_values() {
        let r = |from, to, inclusive| Range { from, to, inclusive }.len();
        assert_eq!(r(0.0, 3.0, false), 3);
        assert_eq!(r(0.0, 3.0, true), 4);
        assert_eq!(r(0.0, 2.5, false), 3);
        assert_eq!(r(3.0, 0.0, true), 0);
    }
}
