//! What the catalogue knows of a word: its chapter, parameters, sentence and example, and the function that does it.

use super::build::Build;
use super::fault::{Fault, Outcome, Stop};
use super::value::Value;
use crate::diag::{Place, Span};

pub(super) use super::args::Args;
pub use super::property::{Bounds, Default, Param, optional, required, rest};
pub use super::ty::Ty;
pub(super) use super::ty::{described, kind_of};

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
    /// Colours by name.
    ColorName,
    /// Lights.
    Light,
    /// Of the whole picture.
    Setting,
    /// Numbers and angles.
    Maths,
    /// Vectors.
    Vector,
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
            Kind::ColorName => "Color names",
            Kind::Light => "Lights",
            Kind::Setting => "Settings",
            Kind::Maths => "Numbers and angles",
            Kind::Vector => "Vectors",
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
    /// A number from an angle in degrees, likewise.
    Angle(fn(f64) -> f64),
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
pub(super) trait Host<'c> {
    /// The scene so far.
    fn build(&mut self) -> &mut Build<'c>;
    /// The call and the calls around it.
    fn place(&mut self) -> Place;
    /// The first parameter's argument, or the call where that can't be told.
    fn argument(&mut self) -> Span;
    /// Calls a function value by position.
    fn call(&mut self, function: &Value, args: &[Value]) -> Outcome;
    /// Uses up `n` of the budget of steps.
    fn spend(&mut self, n: u64) -> Result<(), Stop>;
    /// Uses up the budget of values that hold others, if `inner`, about to be put into one, does so itself.
    fn hold(&mut self, inner: &Value) -> Result<(), Stop>;
}

impl Word {
    /// Whether it sets something for the whole picture; ways of anti-aliasing are values that `render` takes.
    pub(super) fn sets_something(&self) -> bool {
        self.kind == Kind::Setting && !matches!(self.name, "grid" | "adaptive")
    }

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
        match (&self.run, self.params) {
            (Run::Constant(_), _) => self.name.to_owned(),
            // `record(…)` takes any names, `group(…) { … }` a block.
            (Run::Syntax, []) => format!("{}(name: value, …)", self.name),
            (Run::Syntax, _) => format!("{}({}) {{ … }}", self.name, params.join(", ")),
            _ => format!("{}({})", self.name, params.join(", ")),
        }
    }

    /// The value of a word that is one.
    pub(super) fn constant(&self) -> Option<Value> {
        if let Run::Constant(make) = self.run { Some(make()) } else { None }
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
