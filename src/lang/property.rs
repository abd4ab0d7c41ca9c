//! The parameters of words, and the one way in which arguments are checked against them.

use super::build::Build;
use super::fault::Fault;
use super::ty::{Ty, described};
use super::value::{Value, number_text};
use crate::scene::range;

/// One parameter of a word.
#[derive(Debug)]
pub struct Param {
    /// Its name.
    pub name: &'static str,
    /// What it takes.
    pub ty: Ty,
    /// What it is when it is left out.
    pub default: Default,
    /// Allowed values.
    pub range: Option<Bounds>,
    /// Whether it is an amount of light, which is limited.
    pub light: bool,
    /// May go by position.
    pub positional: bool,
    /// Takes any number of further arguments by position; the last parameter only.
    pub rest: bool,
    /// A few words.
    pub doc: &'static str,
}

/// What a parameter is when it is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Default {
    /// It can't be.
    Required,
    /// Nothing; the word knows what to do.
    Absent,
    /// A number.
    Number(f64),
    /// An angle.
    Degrees(f64),
    /// A vector.
    Vec3([f64; 3]),
    /// Two numbers.
    Vec2([f64; 2]),
    /// A truth value.
    Bool(bool),
    /// A text.
    Text(&'static str),
    /// An sRGB grey.
    Gray(f64),
}

/// Allowed values of a number.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// The lower end.
    pub least: f64,
    /// Whether `least` itself is allowed.
    pub least_included: bool,
    /// The upper end, perhaps infinite.
    pub most: f64,
    /// Whether `most` itself is allowed.
    pub most_included: bool,
}

/// A parameter that must be given, by position or by name.
pub const fn required(name: &'static str, ty: Ty, doc: &'static str) -> Param {
    Param { name, ty, default: Default::Required, range: None, light: false, positional: true, rest: false, doc }
}

/// A parameter that may be left out, and must be named.
pub const fn optional(name: &'static str, ty: Ty, default: Default, doc: &'static str) -> Param {
    Param { name, ty, default, range: None, light: false, positional: false, rest: false, doc }
}

/// Any number of further arguments.
pub const fn rest(name: &'static str, ty: Ty, doc: &'static str) -> Param {
    Param { name, ty, default: Default::Absent, range: None, light: false, positional: true, rest: true, doc }
}

impl Param {
    /// Above `least`.
    pub const fn above(mut self, least: f64) -> Param {
        self.range = Some(Bounds { least, least_included: false, most: f64::INFINITY, most_included: true });
        self
    }
    /// At least `least`.
    pub const fn at_least(mut self, least: f64) -> Param {
        self.range = Some(Bounds { least, least_included: true, most: f64::INFINITY, most_included: true });
        self
    }
    /// From `least` to `most`.
    pub const fn within(mut self, least: f64, most: f64) -> Param {
        self.range = Some(Bounds { least, least_included: true, most, most_included: true });
        self
    }
    /// Between `least` and `most`, neither included.
    pub const fn between(mut self, least: f64, most: f64) -> Param {
        self.range = Some(Bounds { least, least_included: false, most, most_included: false });
        self
    }
    /// An amount of light: a colour, a share or a factor of one.
    pub const fn light(mut self) -> Param {
        self.light = true;
        self
    }
    /// May go by position though it has a default.
    pub const fn by_position(mut self) -> Param {
        self.positional = true;
        self
    }
}

impl Bounds {
    /// Whether `x` is allowed.
    pub fn allow(&self, x: f64) -> bool {
        let low = if self.least_included { x >= self.least } else { x > self.least };
        let high = if self.most_included { x <= self.most } else { x < self.most };
        low && high
    }
    /// In words: `above 0`, `from 1 to 10`.
    pub fn text(&self) -> String {
        self.text_in("")
    }
    /// In words, with a unit: `above 0deg and below 180deg`.
    pub fn text_in(&self, unit: &str) -> String {
        let [least, most] = [self.least, self.most].map(|x| format!("{}{unit}", number_text(x)));
        match (self.least_included, self.most.is_finite(), self.most_included) {
            (true, false, _) => format!("at least {least}"),
            (false, false, _) => format!("above {least}"),
            (true, true, true) => format!("from {least} to {most}"),
            (true, true, false) => format!("at least {least} and below {most}"),
            (false, true, true) => format!("above {least} and at most {most}"),
            (false, true, false) => format!("above {least} and below {most}"),
        }
    }
}

impl Default {
    /// As the language writes it; empty where there is none to show.
    pub fn text(&self) -> String {
        match self {
            Default::Required => String::new(),
            Default::Absent => "none".into(),
            Default::Gray(v) => format!("gray({})", number_text(*v)),
            other => other.value().show(60),
        }
    }
    /// The value; none where there isn't one.
    pub(super) fn value(&self) -> Value {
        match *self {
            Default::Required | Default::Absent => Value::Unset,
            Default::Number(n) => Value::Number(n),
            Default::Degrees(a) => Value::Angle(a),
            Default::Vec3(v) => Value::Vec3(v),
            Default::Vec2(v) => Value::list(v.map(Value::Number).into()),
            Default::Bool(b) => Value::Bool(b),
            Default::Text(t) => Value::Text(t.into()),
            Default::Gray(v) => Value::Color(crate::scene::Color::from_srgb([v; 3])),
        }
    }
}

impl Param {
    /// Checks one value. Only faults cost anything.
    pub(super) fn check(&self, value: &Value, build: &Build) -> Result<(), Box<Fault>> {
        if !self.ty.takes(value, build) {
            return Err(self.mistyped(value, build));
        }
        let size = |x: f64| {
            if range::is_supported(x) {
                return Ok(());
            }
            Err(Fault::new(format!("`{}` is outside the supported lengths, got {}", self.name, number_text(x)))
                .note("a length or coordinate is 0, or from 1e-140 to 1e140 in size"))
        };
        let bounded = |x: f64| match self.range {
            Some(b) if !b.allow(x) => {
                Err(Fault::new(format!("`{}` must be {}, got {}", self.name, b.text(), value.show(60))))
            }
            _ => Ok(()),
        };
        if self.light {
            amount(self.name, value, build)?;
        }
        match (self.ty, value) {
            (Ty::Length, Value::Number(n)) => {
                bounded(*n)?;
                size(*n)
            }
            (Ty::Number | Ty::Whole | Ty::NumberPaint | Ty::Paint | Ty::Level, Value::Number(n)) => bounded(*n),
            (Ty::Angle, Value::Angle(a)) => match self.range {
                Some(b) if !b.allow(*a) => {
                    Err(Fault::new(format!("`{}` must be {}, got {}", self.name, b.text_in("deg"), value.show(60))))
                }
                _ => Ok(()),
            },
            (Ty::Paint | Ty::Level, Value::Color(c)) if self.range.is_some() => c.0.into_iter().try_for_each(bounded),
            (Ty::Point | Ty::Direction, Value::Vec3(v)) => {
                v.iter().try_for_each(|x| size(*x))?;
                v.iter().try_for_each(|x| bounded(*x))?;
                if self.ty == Ty::Direction && *v == [0.0; 3] {
                    return Err(Fault::new(format!("`{}` has no direction: it is [0, 0, 0]", self.name)));
                }
                Ok(())
            }
            (Ty::Factors, Value::Number(n)) => self.factors(&[*n]).and_then(|()| size(*n)),
            (Ty::Factors, Value::Vec3(v)) => self.factors(v).and_then(|()| v.iter().try_for_each(|x| size(*x))),
            (Ty::Points(_) | Ty::Directions(_), Value::List(items)) => {
                for item in items {
                    if let Value::Vec3(v) = item {
                        v.iter().try_for_each(|x| size(*x))?;
                        if matches!(self.ty, Ty::Directions(_)) && *v == [0.0; 3] {
                            return Err(Fault::new(format!(
                                "one of `{}` has no direction: it is [0, 0, 0]",
                                self.name
                            )));
                        }
                    }
                }
                Ok(())
            }
            (Ty::Size, Value::List(items)) => items.iter().try_for_each(|v| match v {
                Value::Number(n) => bounded(*n).and_then(|()| size(*n)),
                _ => Ok(()),
            }),
            (Ty::Pair, Value::List(items)) => {
                items.iter().try_for_each(|v| if let Value::Number(n) = v { bounded(*n) } else { Ok(()) })
            }
            _ => Ok(()),
        }
    }

    fn factors(&self, v: &[f64]) -> Result<(), Box<Fault>> {
        if v.contains(&0.0) {
            return Err(Fault::new("a factor of 0 leaves nothing").note("scale by something other than 0"));
        }
        Ok(())
    }

    fn mistyped(&self, value: &Value, build: &Build) -> Box<Fault> {
        let (name, expected) = (self.name, self.ty.text());
        let got = described(value, build);
        let message = format!("`{name}` must be {expected}, got {got}");
        let fault = Fault::new(message);
        match (self.ty, value) {
            (Ty::Angle, Value::Number(n)) => {
                // Up to a full turn it may well be meant in radians.
                let small = n.abs() <= 6.3;
                let n = number_text(*n);
                let radians = if small { format!(" or `{n}rad`") } else { String::new() };
                fault.label(format!("write `{n}deg`{radians}")).fix(format!("{n}deg"))
            }
            (Ty::Number | Ty::Length, Value::Angle(_)) => fault.label("a number has no unit"),
            (Ty::Color | Ty::ColorPaint, Value::Number(n)) => {
                let n = number_text(*n);
                fault.label(format!("write `gray({n})`, or `linear({n})` for linear light")).fix(format!("gray({n})"))
            }
            (Ty::Color | Ty::ColorPaint | Ty::Paint | Ty::Level, Value::Vec3(_)) => {
                fault.label("for a color, write `rgb(…)` or `linear(…)`")
            }
            (Ty::Material, Value::Color(_) | Value::Pattern(_)) => fault.label("write `matte(…)` or `phong(color: …)`"),
            (Ty::Point | Ty::Direction, Value::List(items)) if items.len() == 2 => {
                fault.label("the third number is missing")
            }
            (Ty::Point | Ty::Direction, Value::List(items)) if items.len() == 3 => {
                let odd = items.iter().find(|v| !matches!(v, Value::Number(_))).unwrap_or(value);
                fault.label(format!("{} is in it", described(odd, build)))
            }
            (Ty::Text | Ty::Choice(_), Value::Number(_)) => fault.label("texts stand in quotes"),
            (Ty::Color | Ty::ColorPaint | Ty::Paint, Value::Text(_)) => {
                fault.label("a color's name stands without quotes")
            }
            (_, Value::Builtin(id)) => {
                fault.label(format!("to call it, write `{}(…)`", super::catalog::word(*id).name))
            }
            (_, Value::Function(_)) => fault.label("to call a function, write `( )` after its name"),
            _ => fault,
        }
    }
}

/// Checks that a number, a colour and all values of a pattern are amounts of light that can be traced.
pub(super) fn amount(name: &str, value: &Value, build: &Build) -> Result<(), Box<Fault>> {
    let size = build.size_of_channels(value);
    if size <= range::BRIGHTEST {
        return Ok(());
    }
    let found = match value {
        Value::Pattern(_) => format!("it can reach {}", number_text(size)),
        _ => format!("got {}", value.show(60)),
    };
    let most = number_text(range::BRIGHTEST);
    Err(Fault::new(format!("`{name}` is outside the supported amounts of light, {found}"))
        .note(format!("an amount of light is at most {most} in size; 1 is the brightest that a picture shows")))
}
