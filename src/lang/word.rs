//! What the catalogue knows of a word, and the one way in which arguments are checked against it.

use super::build::Build;
use super::fault::{Fault, Outcome, Stop};
use super::suggest::or_list;
use super::value::{Value, number_text};
use crate::diag::Place;
use crate::scene::range;

/// One word of the vocabulary.
#[derive(Debug)]
pub struct Word {
    /// As it is written.
    pub name: &'static str,
    /// Its chapter.
    pub kind: Kind,
    /// In the order in which they go by position.
    pub params: &'static [Param],
    /// One sentence.
    pub doc: &'static str,
    /// A complete program.
    pub example: &'static str,
    pub(super) run: Run,
}

/// What sort of word it is; the chapters of the reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Surfaces.
    Shape,
    /// What collects.
    Group,
    /// What moves and changes.
    Transform,
    /// How surfaces look.
    Material,
    /// What varies over a surface.
    Pattern,
    /// Colours.
    Color,
    /// Lights.
    Light,
    /// Of the whole picture.
    Setting,
    /// Numbers, angles, vectors.
    Maths,
    /// Lists and records.
    List,
    /// Texts.
    Text,
    /// Keyed randomness.
    Random,
    /// Fixed values.
    Constant,
}

impl Kind {
    /// The chapter's name.
    pub fn title(self) -> &'static str {
        match self {
            Kind::Shape => "Shapes",
            Kind::Group => "Groups",
            Kind::Transform => "Transforms",
            Kind::Material => "Materials",
            Kind::Pattern => "Patterns",
            Kind::Color => "Colors",
            Kind::Light => "Lights",
            Kind::Setting => "Settings",
            Kind::Maths => "Numbers",
            Kind::List => "Lists and records",
            Kind::Text => "Texts",
            Kind::Random => "Random",
            Kind::Constant => "Constants",
        }
    }
}

/// How a word does its work. `args` are one value a parameter, checked, then those of the rest parameter;
/// a parameter that was left out and has no default is [`Value::Unset`].
pub(super) enum Run {
    /// A call.
    Call(fn(host: &mut dyn Host, args: &[Value]) -> Outcome),
    /// A number from a number: the fast way of the most used words.
    Number(fn(f64) -> f64),
    /// The word alone is a value.
    Constant(fn() -> Value),
    /// The evaluator knows it: it takes names or a block of its own.
    Syntax,
}

impl std::fmt::Debug for Run {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Run")
    }
}

/// What a running word may ask of the evaluator.
pub(super) trait Host {
    /// The scene so far.
    fn build(&mut self) -> &mut Build;
    /// The call and the calls around it.
    fn place(&mut self) -> Place;
    /// Calls a function value by position.
    fn call(&mut self, function: &Value, args: &[Value]) -> Outcome;
    /// Uses up `n` of the budget of steps.
    fn spend(&mut self, n: u64) -> Result<(), Stop>;
}

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

/// What a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ty {
    /// Any value.
    Any,
    /// A number.
    Number,
    /// A whole number.
    Whole,
    /// A number that geometry is made of.
    Length,
    /// An angle.
    Angle,
    /// Three lengths.
    Point,
    /// A point that isn't the origin.
    Direction,
    /// One factor or three, none of them 0.
    Factors,
    /// So many points.
    Points(usize),
    /// So many directions.
    Directions(usize),
    /// Two whole numbers.
    Pair,
    /// A truth value.
    Bool,
    /// A text.
    Text,
    /// One of some texts.
    Choice(&'static [&'static str]),
    /// A colour.
    Color,
    /// A number or a colour.
    Level,
    /// A number, a colour or a pattern of either.
    Paint,
    /// A colour or a pattern of colours.
    ColorPaint,
    /// A number or a pattern of numbers.
    NumberPaint,
    /// A material.
    Material,
    /// A shape, light or group.
    Node,
    /// What transforms take.
    Movable,
    /// A pattern.
    Pattern,
    /// A list or range.
    List,
    /// A function.
    Function,
    /// `off` or `grid(n)`.
    AntiAliasing,
}

/// A parameter that must be given, by position or by name.
pub const fn required(name: &'static str, ty: Ty, doc: &'static str) -> Param {
    Param { name, ty, default: Default::Required, range: None, positional: true, rest: false, doc }
}
/// A parameter that may be left out, and must be named.
pub const fn optional(name: &'static str, ty: Ty, default: Default, doc: &'static str) -> Param {
    Param { name, ty, default, range: None, positional: false, rest: false, doc }
}
/// Any number of further arguments.
pub const fn rest(name: &'static str, ty: Ty, doc: &'static str) -> Param {
    Param { name, ty, default: Default::Absent, range: None, positional: true, rest: true, doc }
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
        let (least, most) = (number_text(self.least), number_text(self.most));
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
    fn value(&self) -> Value {
        match *self {
            Default::Required | Default::Absent => Value::Unset,
            Default::Number(n) => Value::Number(n),
            Default::Degrees(a) => Value::Angle(a),
            Default::Vec3(v) => Value::Vec3(v),
            Default::Bool(b) => Value::Bool(b),
            Default::Text(t) => Value::Text(t.into()),
            Default::Gray(v) => Value::Color(crate::scene::Color::from_srgb([v; 3])),
        }
    }
}

impl Word {
    /// `sphere takes: at, r, mat, name`.
    pub fn takes(&self) -> String {
        if self.params.is_empty() {
            return format!("{} takes nothing", self.name);
        }
        let names: Vec<&str> = self.params.iter().map(|p| p.name).collect();
        format!("{} takes: {}", self.name, names.join(", "))
    }

    /// `sphere(at: [0, 0, 0], r: 1, mat: none)`: as the reference shows it.
    pub fn signature(&self) -> String {
        let params: Vec<String> = self
            .params
            .iter()
            .map(|p| match p.default {
                Default::Required => p.name.to_owned(),
                _ if p.rest => format!("{}…", p.name),
                d => format!("{}: {}", p.name, d.text()),
            })
            .collect();
        match self.run {
            Run::Constant(_) => self.name.to_owned(),
            _ => format!("{}({})", self.name, params.join(", ")),
        }
    }

    /// Checks arguments in place and fills in defaults.
    pub(super) fn check(&self, args: &mut [Value], build: &Build) -> Result<(), Box<Fault>> {
        for (i, arg) in args.iter_mut().enumerate() {
            let Some(param) = self.params.get(i).or(self.params.last()) else { continue };
            match arg {
                Value::Unset => *arg = param.default.value(),
                Value::None if param.default == Default::Absent && param.ty != Ty::Any => *arg = Value::Unset,
                _ => param.check(arg, build).map_err(|f| f.on(i))?,
            }
        }
        Ok(())
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
        match (self.ty, value) {
            (Ty::Length, Value::Number(n)) => {
                bounded(*n)?;
                size(*n)
            }
            (Ty::Number | Ty::Whole | Ty::NumberPaint | Ty::Paint | Ty::Level, Value::Number(n)) => bounded(*n),
            (Ty::Angle, Value::Angle(a)) => match self.range {
                Some(b) if !b.allow(*a) => Err(Fault::new(format!(
                    "`{}` must be above {}deg and below {}deg, got {}",
                    self.name,
                    number_text(b.least),
                    number_text(b.most),
                    value.show(60)
                ))),
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
                let n = number_text(*n);
                fault.label(format!("write `{n}deg`, or `{n}rad` or `{n}turn`")).fix(format!("{n}deg"))
            }
            (Ty::Number | Ty::Length, Value::Angle(_)) => fault.label("a number has no unit"),
            (Ty::Color | Ty::ColorPaint, Value::Number(n)) => {
                let n = number_text(*n);
                fault.label(format!("write `gray({n})`, or `linear({n})` for linear light")).fix(format!("gray({n})"))
            }
            (Ty::Color | Ty::ColorPaint, Value::Vec3(_)) => fault.label("write `rgb(…)` or `linear(…)`"),
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

/// A value in a message: its kind, and itself where that is short and helps.
pub(super) fn described(value: &Value, build: &Build) -> String {
    match value {
        Value::Number(_) | Value::Angle(_) | Value::Bool(_) => {
            format!("{} ({})", kind_of(value, build), value.show(40))
        }
        Value::Vec3(_) => format!("the list {}", value.show(40)),
        Value::List(l) => format!("a list of {}", l.len()),
        Value::Text(_) => format!("the text {}", value.show(40)),
        _ => kind_of(value, build).into(),
    }
}

/// The kind of a value, as exactly as the scene knows it.
pub(super) fn kind_of(value: &Value, build: &Build) -> &'static str {
    match value {
        Value::Bool(_) => "a truth value",
        Value::Node(id) => match build.node_word(*id) {
            "light" => "a light",
            "group" => "a group",
            _ => "a shape",
        },
        Value::Pattern(id) if build.is_number(*id) => "a pattern of numbers",
        Value::Pattern(_) => "a pattern of colors",
        other => other.kind(),
    }
}

impl Ty {
    fn takes(self, value: &Value, build: &Build) -> bool {
        match (self, value) {
            (Ty::Any, _) => true,
            (Ty::Number | Ty::Length, Value::Number(_)) => true,
            (Ty::Whole, Value::Number(n)) => n.fract() == 0.0,
            (Ty::Angle, Value::Angle(_)) => true,
            (Ty::Point | Ty::Direction | Ty::Factors, Value::Vec3(_)) | (Ty::Factors, Value::Number(_)) => true,
            (Ty::Points(n) | Ty::Directions(n), Value::List(items)) => {
                items.len() == n && items.iter().all(|v| matches!(v, Value::Vec3(_)))
            }
            (Ty::Pair, Value::List(items)) => {
                items.len() == 2 && items.iter().all(|v| matches!(v, Value::Number(n) if n.fract() == 0.0))
            }
            (Ty::Bool, Value::Bool(_)) | (Ty::Text, Value::Text(_)) => true,
            (Ty::Choice(words), Value::Text(t)) => words.contains(&t.as_str()),
            (Ty::Color | Ty::ColorPaint | Ty::Paint | Ty::Level, Value::Color(_)) => true,
            (Ty::Paint | Ty::Pattern | Ty::Movable, Value::Pattern(_)) => true,
            (Ty::ColorPaint, Value::Pattern(id)) => !build.is_number(*id),
            (Ty::NumberPaint, Value::Pattern(id)) => build.is_number(*id),
            (Ty::Paint | Ty::NumberPaint | Ty::Level, Value::Number(_)) => true,
            (Ty::Material, Value::Material(_)) => true,
            (Ty::Node | Ty::Movable, Value::Node(_)) => true,
            (Ty::List, Value::List(_) | Value::Vec3(_) | Value::Range(_)) => true,
            (Ty::Function, Value::Function(_) | Value::Builtin(_)) => true,
            (Ty::AntiAliasing, Value::AntiAliasing(_)) => true,
            _ => false,
        }
    }

    /// In words, after "must be".
    pub fn text(self) -> String {
        match self {
            Ty::Any => "any value".into(),
            Ty::Number | Ty::Length => "a number".into(),
            Ty::Whole => "a whole number".into(),
            Ty::Angle => "an angle".into(),
            Ty::Point => "a point `[x, y, z]`".into(),
            Ty::Direction => "a direction `[x, y, z]`".into(),
            Ty::Factors => "a factor, or three `[x, y, z]`".into(),
            Ty::Points(n) => format!("a list of {n} points `[x, y, z]`"),
            Ty::Directions(n) => format!("a list of {n} directions `[x, y, z]`"),
            Ty::Pair => "two whole numbers `[width, height]`".into(),
            Ty::Bool => "`true` or `false`".into(),
            Ty::Text => "a text".into(),
            Ty::Choice(words) => {
                let quoted: Vec<String> = words.iter().map(|w| format!("\"{w}\"")).collect();
                or_list(quoted.iter().map(String::as_str))
            }
            Ty::Color => "a color".into(),
            Ty::Level => "a number or a color".into(),
            Ty::Paint => "a number, a color or a pattern".into(),
            Ty::ColorPaint => "a color or a pattern of colors".into(),
            Ty::NumberPaint => "a number or a pattern of numbers".into(),
            Ty::Material => "a material".into(),
            Ty::Node => "a shape, light or group".into(),
            Ty::Movable => "a shape, light, group or pattern".into(),
            Ty::Pattern => "a pattern".into(),
            Ty::List => "a list".into(),
            Ty::Function => "a function".into(),
            Ty::AntiAliasing => "`off` or `grid(n)`".into(),
        }
    }
}

/// Checked arguments, read by type. A wrong type can't come here; it reads as a harmless value all the same.
pub(super) trait Args {
    /// A number, or an angle in degrees.
    fn number(&self, i: usize) -> f64;
    /// Three numbers.
    fn vec3(&self, i: usize) -> glam::DVec3;
    /// A text, or an empty one.
    fn text(&self, i: usize) -> &str;
    /// Whether it was given, or has a default.
    fn given(&self, i: usize) -> bool;
    /// True.
    fn is_true(&self, i: usize) -> bool;
    /// A colour.
    fn color(&self, i: usize) -> crate::scene::Color;
    /// `N` points, where they were given.
    fn points<const N: usize>(&self, i: usize) -> Option<[glam::DVec3; N]>;
}

impl Args for [Value] {
    fn number(&self, i: usize) -> f64 {
        match self.get(i) {
            Some(Value::Number(n) | Value::Angle(n)) => *n,
            _ => 0.0,
        }
    }
    fn vec3(&self, i: usize) -> glam::DVec3 {
        match self.get(i) {
            Some(Value::Vec3(v)) => glam::DVec3::from_array(*v),
            _ => glam::DVec3::ZERO,
        }
    }
    fn text(&self, i: usize) -> &str {
        match self.get(i) {
            Some(Value::Text(t)) => t,
            _ => "",
        }
    }
    fn given(&self, i: usize) -> bool {
        !matches!(self.get(i), None | Some(Value::Unset))
    }
    fn is_true(&self, i: usize) -> bool {
        matches!(self.get(i), Some(Value::Bool(true)))
    }
    fn color(&self, i: usize) -> crate::scene::Color {
        match self.get(i) {
            Some(Value::Color(c)) => *c,
            _ => crate::scene::Color::BLACK,
        }
    }
    fn points<const N: usize>(&self, i: usize) -> Option<[glam::DVec3; N]> {
        let Some(Value::List(items)) = self.get(i) else { return None };
        let points: Vec<glam::DVec3> = (0..items.len()).map(|k| items.as_slice().vec3(k)).collect();
        points.try_into().ok()
    }
}
