//! What a parameter takes: which values are of a type, and what it is called in messages.

use super::build::Build;
use super::suggest::or_list;
use super::value::Value;

/// What a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ty {
    /// Any value.
    Any,
    /// A number.
    Number,
    /// A number or an angle.
    Quantity,
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
    /// Two lengths.
    Size,
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
    /// At least two numbers, colours or patterns.
    Paints,
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

impl Ty {
    /// Whether a value is of the type.
    pub(super) fn takes(self, value: &Value, build: &Build) -> bool {
        match (self, value) {
            (Ty::Any, _) => true,
            (Ty::Number | Ty::Length | Ty::Quantity, Value::Number(_)) => true,
            (Ty::Whole, Value::Number(n)) => n.fract() == 0.0,
            (Ty::Angle | Ty::Quantity, Value::Angle(_)) => true,
            (Ty::Point | Ty::Direction | Ty::Factors, Value::Vec3(_)) | (Ty::Factors, Value::Number(_)) => true,
            (Ty::Points(n) | Ty::Directions(n), Value::List(items)) => {
                items.len() == n && items.iter().all(|v| matches!(v, Value::Vec3(_)))
            }
            (Ty::Pair, Value::List(items)) => {
                items.len() == 2 && items.iter().all(|v| matches!(v, Value::Number(n) if n.fract() == 0.0))
            }
            (Ty::Size, Value::List(items)) => items.len() == 2 && items.iter().all(|v| matches!(v, Value::Number(_))),
            (Ty::Paints, Value::Vec3(_)) => true,
            (Ty::Paints, Value::List(items)) => {
                let paint = |v: &Value| matches!(v, Value::Number(_) | Value::Color(_) | Value::Pattern(_));
                items.len() >= 2 && items.iter().all(paint)
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
            Ty::Quantity => "a number or an angle".into(),
            Ty::Whole => "a whole number".into(),
            Ty::Angle => "an angle".into(),
            Ty::Point => "a point `[x, y, z]`".into(),
            Ty::Direction => "a direction `[x, y, z]`".into(),
            Ty::Factors => "a factor, or three `[x, y, z]`".into(),
            Ty::Points(n) => format!("a list of {n} points `[x, y, z]`"),
            Ty::Directions(n) => format!("a list of {n} directions `[x, y, z]`"),
            Ty::Pair => "two whole numbers `[width, height]`".into(),
            Ty::Size => "two numbers `[width, height]`".into(),
            Ty::Paints => "a list of at least two numbers, colors or patterns".into(),
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
            Ty::AntiAliasing => "`off`, `grid(n)` or `adaptive(n)`".into(),
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
