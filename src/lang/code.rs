//! The program as it is run: names have become slots, arguments stand in the order of the parameters.

use super::ast::Op;
use super::parse::Parsed;
use super::value::{BuiltinId, FunctionId, Value};
use crate::diag::{FileId, Span};
use ecow::EcoString;
use std::sync::Arc;

/// A piece of program and its text.
#[derive(Debug)]
pub struct Node {
    pub code: Code,
    pub span: Span,
}

// The tag has a byte of its own: that is one instruction less, wherever it is looked at.
#[derive(Debug)]
#[repr(u8)]
pub enum Code {
    Const(Value),
    Local(u32),
    Global(u32),
    Capture(u32),
    /// The function that is running.
    Current,
    /// A mistake here has been reported.
    Failed,
    List(Box<[Node]>),
    /// A list of what `for`, `if` and plain items push.
    Collected(Box<[Node]>),
    Text(Box<[TextCode]>),
    Negate(Box<Node>),
    Not(Box<Node>),
    Binary(Box<Operation>),
    And(Box<(Node, Node)>),
    Or(Box<(Node, Node)>),
    If {
        arms: Box<[(Node, Node)]>,
        otherwise: Option<Box<Node>>,
    },
    For(Box<ForCode>),
    While(Box<(Node, Node)>),
    /// The last one is the value.
    Block(Box<[Node]>),
    /// Computes something whose value must be nothing.
    Discard(Box<Node>),
    /// Adds a shape or light to the scene block around.
    Emit(Box<Node>),
    /// Adds a value to the list around.
    Push(Box<Node>),
    SetLocal(u32, Box<Node>),
    SetGlobal(u32, Box<Node>),
    /// Arguments with the places of their parameters; those of a rest parameter count on.
    CallBuiltin {
        word: BuiltinId,
        args: Box<[(u16, Node)]>,
    },
    /// Arithmetic of numbers.
    Formula(Box<Formula>),
    Apply(Box<Apply>),
    /// A function known beforehand: one argument a parameter. `callee` is its value, where it carries captures.
    Call {
        function: FunctionId,
        callee: Option<Box<Node>>,
        args: Box<[Option<Node>]>,
    },
    CallValue {
        callee: Box<Node>,
        args: Box<[ArgCode]>,
        /// Where the callee's name is bound, if that hides a built-in word.
        hides: Option<Span>,
    },
    Record(Box<[ArgCode]>),
    Group {
        args: Box<[(u16, Node)]>,
        body: Box<Node>,
    },
    Index(Box<(Node, Node)>),
    Field {
        of: Box<Node>,
        name: EcoString,
        /// The item that `.x`, `.y` or `.z` is.
        item: Option<u8>,
    },
    With(Box<Node>, Box<[ArgCode]>),
    Closure(FunctionId, Box<[CaptureFrom]>),
    /// A module as a record: its exports' slots.
    Module(Box<[(EcoString, u32)]>),
    Param(Box<ParamCode>),
}

/// An operator and what it takes.
#[derive(Debug)]
pub struct Operation {
    pub op: Op,
    pub a: Node,
    pub b: Node,
}

/// A word that makes a number of one number or angle, and its argument, placed as in a `CallBuiltin`.
#[derive(Debug)]
pub struct Apply {
    pub word: BuiltinId,
    pub function: Function1,
    pub args: [(u16, Node); 1],
}

/// What such a word computes.
#[derive(Clone, Copy, Debug)]
pub enum Function1 {
    OfNumber(fn(f64) -> f64),
    /// In degrees.
    OfAngle(fn(f64) -> f64),
}

/// An expression of numbers.
#[derive(Debug)]
pub struct Formula {
    pub steps: Vec<Step>,
    pub is_angle: bool,
    /// The ordinary way.
    pub tree: Node,
}

/// One step. There is a number at hand, the result so far.
#[derive(Clone, Copy, Debug)]
pub enum Step {
    /// Keeps the number at hand for later and goes on with another.
    Take(Source),
    /// The number at hand and a further one. The most frequent have cases of their own: they are found with one jump.
    AddConstant(f64),
    MultiplyConstant(f64),
    DivideConstant(f64),
    AddLocal(u32),
    SubtractLocal(u32),
    MultiplyLocal(u32),
    DivideLocal(u32),
    With(Op, Source),
    /// The number kept last, an operator, and the one at hand.
    Join(Op),
    Number(fn(f64) -> f64),
    /// Of an angle: -0 is 0.
    Angle(fn(f64) -> f64),
    Negate,
}

#[derive(Clone, Copy, Debug)]
pub enum Source {
    Constant(f64),
    Local(u32),
    Global(u32),
    /// An item of a vector.
    Item(u32, u8),
}

#[derive(Debug)]
pub enum TextCode {
    Literal(EcoString),
    Node(Node),
}

#[derive(Debug)]
pub struct ForCode {
    pub slot: u32,
    pub over: Node,
    pub guard: Option<Node>,
    pub body: Node,
}

/// An argument whose function isn't known beforehand.
#[derive(Debug)]
pub struct ArgCode {
    pub name: Option<EcoString>,
    /// Where the name stands, or the value.
    pub name_span: Span,
    pub value: Node,
}

/// Where a closure takes a value from when it is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CaptureFrom {
    Local(u32),
    Capture(u32),
    Current,
}

#[derive(Debug)]
pub struct ParamCode {
    pub slot: u32,
    pub name: EcoString,
    pub name_span: Span,
    pub default: Node,
    pub range: Option<Node>,
    pub choices: Option<Node>,
    pub description: Option<EcoString>,
    /// Whether it is the main file's, which `--set` can reach.
    pub main: bool,
}

/// A function.
#[derive(Debug)]
pub struct FnCode {
    /// `function` where it has none.
    pub name: EcoString,
    pub params: Vec<ParamSlot>,
    /// Whether a parameter has one.
    pub has_defaults: bool,
    /// Values that its frame holds.
    pub slots: u32,
    /// Expressions within each other.
    pub depth: u32,
    pub body: Node,
}

#[derive(Debug)]
pub struct ParamSlot {
    pub name: EcoString,
    /// Must be given.
    pub required: bool,
    pub default: Option<Node>,
}

/// An outermost statement.
#[derive(Debug)]
pub struct TopStatement {
    pub node: Node,
    /// Globals that are unusable when it fails.
    pub binds: Vec<u32>,
    /// Adds to the scene or sets something: skipped in a module.
    pub for_scene: bool,
}

/// A file.
#[derive(Debug)]
pub struct ModuleCode {
    pub file: FileId,
    /// With the statements that are like others.
    pub parsed: Arc<Parsed>,
    /// Which of `statements` its templates are, where others can be run as copies of them.
    pub templates: Vec<Option<usize>>,
    pub statements: Vec<TopStatement>,
    pub slots: u32,
    /// Functions of the top level and their slots: there before anything runs.
    pub functions: Vec<(u32, FunctionId)>,
}

/// Everything that is run.
#[derive(Debug, Default)]
pub struct Program {
    pub functions: Vec<FnCode>,
    pub globals: u32,
    /// In the order in which they run; the main file is the last.
    pub modules: Vec<ModuleCode>,
}
