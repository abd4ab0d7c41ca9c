//! The syntax tree: what was written, before names mean anything.

use crate::diag::Span;
use crate::scene::Color;
use ecow::EcoString;

/// A name where it stands.
#[derive(Clone, Debug)]
pub struct Ident {
    pub name: EcoString,
    pub span: Span,
}

/// An expression.
#[derive(Debug)]
pub struct Expr {
    pub kind: ExprKind,
    pub span: Span,
    /// Expressions within each other, this one included.
    pub depth: u32,
}

#[derive(Debug)]
pub enum ExprKind {
    Number(f64),
    /// In degrees.
    Angle(f64),
    Bool(bool),
    Color(Color),
    Text(Vec<TextPart>),
    Name(EcoString),
    List(Vec<Expr>),
    Lambda(Box<Function>),
    If {
        arms: Vec<(Expr, Block)>,
        otherwise: Option<Block>,
    },
    For(Box<For>),
    Block(Block),
    /// `group(…) { … }`
    Group {
        args: Vec<Arg>,
        body: Block,
    },
    Negate(Box<Expr>),
    Not(Box<Expr>),
    Binary {
        op: Op,
        a: Box<Expr>,
        b: Box<Expr>,
    },
    /// A call; `x |> f(y)` is one too, with `x` as first argument.
    Call {
        callee: Box<Expr>,
        args: Vec<Arg>,
    },
    Index {
        of: Box<Expr>,
        index: Box<Expr>,
    },
    Field {
        of: Box<Expr>,
        field: Ident,
    },
}

#[derive(Debug)]
pub enum TextPart {
    Literal(EcoString),
    Expr(Expr),
}

#[derive(Debug)]
pub struct Arg {
    pub name: Option<Ident>,
    pub value: Expr,
}

#[derive(Debug)]
pub struct Function {
    pub params: Vec<ParamDecl>,
    pub body: Expr,
}

#[derive(Debug)]
pub struct ParamDecl {
    pub name: Ident,
    pub default: Option<Expr>,
}

#[derive(Debug)]
pub struct For {
    pub name: Ident,
    pub over: Expr,
    pub guard: Option<Expr>,
    pub body: Block,
}

#[derive(Debug)]
pub struct Block {
    pub statements: Vec<Statement>,
    pub span: Span,
}

#[derive(Debug)]
pub struct Statement {
    pub kind: StatementKind,
    pub span: Span,
}

#[derive(Debug)]
pub enum StatementKind {
    Let {
        name: Ident,
        value: Expr,
        export: bool,
    },
    Var {
        name: Ident,
        value: Expr,
    },
    Assign {
        name: Ident,
        op: Option<Op>,
        op_span: Span,
        value: Expr,
    },
    Fn {
        name: Ident,
        function: Function,
        export: bool,
    },
    While {
        condition: Expr,
        body: Block,
    },
    Import {
        path: Path,
        names: ImportNames,
    },
    Param(Box<ParamStatement>),
    Expr(Expr),
    /// A statement with a syntax error, reported already, and the name that it was to bind.
    Broken {
        name: Option<EcoString>,
    },
}

#[derive(Debug)]
pub struct Path {
    pub text: EcoString,
    pub span: Span,
}

#[derive(Debug)]
pub enum ImportNames {
    /// `as tree`
    Module(Ident),
    /// `{ oak, ash as tree }`: what it is there, and here.
    Some(Vec<(Ident, Ident)>),
}

/// `param name: default in range "description"` or `of choices`.
#[derive(Debug)]
pub struct ParamStatement {
    pub name: Ident,
    pub default: Expr,
    pub range: Option<Expr>,
    pub choices: Option<Expr>,
    pub description: Option<EcoString>,
}

/// Operators of two values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Op {
    Or,
    And,
    Equal,
    NotEqual,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Range,
    RangeInclusive,
    Add,
    Subtract,
    Multiply,
    Divide,
    Remainder,
    Power,
}

impl Op {
    /// As it is written.
    pub fn symbol(self) -> &'static str {
        match self {
            Op::Or => "or",
            Op::And => "and",
            Op::Equal => "==",
            Op::NotEqual => "!=",
            Op::Less => "<",
            Op::LessEqual => "<=",
            Op::Greater => ">",
            Op::GreaterEqual => ">=",
            Op::Range => "..",
            Op::RangeInclusive => "..=",
            Op::Add => "+",
            Op::Subtract => "-",
            Op::Multiply => "*",
            Op::Divide => "/",
            Op::Remainder => "%",
            Op::Power => "^",
        }
    }
    /// From its symbol; `|>` isn't one.
    pub fn from_symbol(s: &str) -> Option<Op> {
        use Op::*;
        [
            Or,
            And,
            Equal,
            NotEqual,
            Less,
            LessEqual,
            Greater,
            GreaterEqual,
            Range,
            RangeInclusive,
            Add,
            Subtract,
            Multiply,
            Divide,
            Remainder,
            Power,
        ]
        .into_iter()
        .find(|op| op.symbol() == s)
    }
    /// How strongly it binds. `|>` is 1, `not` 4, the sign `-` 9.
    pub fn strength(self) -> u32 {
        match self {
            Op::Or => 2,
            Op::And => 3,
            Op::Equal | Op::NotEqual | Op::Less | Op::LessEqual | Op::Greater | Op::GreaterEqual => 5,
            Op::Range | Op::RangeInclusive => 6,
            Op::Add | Op::Subtract => 7,
            Op::Multiply | Op::Divide | Op::Remainder => 8,
            Op::Power => 10,
        }
    }
}
