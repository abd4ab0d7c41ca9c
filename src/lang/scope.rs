//! Which name means what, where: blocks within functions within a file.

use super::code::CaptureFrom;
use super::value::FunctionId;
use crate::diag::Span;
use ecow::EcoString;

/// A name and what it is bound to.
#[derive(Clone, Debug)]
pub struct Binding {
    pub name: EcoString,
    pub span: Span,
    pub kind: Kind,
    pub at: At,
    /// A global before its statement isn't there yet.
    pub declared: bool,
}

/// How it was bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    Let,
    Var,
    Parameter,
    Loop,
    Function(FunctionId),
    /// A module, by its index.
    Module(usize),
    /// By a statement with an error.
    Broken,
}

/// Where its value is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum At {
    Local(u32),
    Global(u32),
}

/// How running code reaches a name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Access {
    Local(u32),
    Global(u32),
    Capture(u32),
    Current,
}

/// A function being resolved; the file's top level is the outermost one.
#[derive(Default)]
pub struct Level {
    pub blocks: Vec<Vec<Binding>>,
    next: u32,
    pub slots: u32,
    pub captures: Vec<CaptureFrom>,
    /// The name by which a local function calls itself.
    pub own_name: Option<(EcoString, FunctionId, Span)>,
}

impl Level {
    /// A new slot for a local value.
    pub fn slot(&mut self) -> u32 {
        self.next += 1;
        self.slots = self.slots.max(self.next);
        self.next - 1
    }
    /// Begins a block; gives what [`leave`](Level::leave) needs.
    pub fn enter(&mut self) -> u32 {
        self.blocks.push(Vec::new());
        self.next
    }
    /// Ends a block; its slots are used again.
    pub fn leave(&mut self, mark: u32) {
        self.blocks.pop();
        self.next = mark;
    }
}

/// The functions around the text being resolved, outermost first.
#[derive(Default)]
pub struct Scopes {
    pub levels: Vec<Level>,
}

impl Scopes {
    /// The innermost function.
    pub fn top(&mut self) -> &mut Level {
        if self.levels.is_empty() {
            self.levels.push(Level::default());
        }
        let last = self.levels.len() - 1;
        &mut self.levels[last]
    }

    /// What `name` is bound to, how it is reached, and whether that crosses a function's border.
    pub fn find(&mut self, name: &str) -> Option<(Access, Binding, bool)> {
        let level = self.levels.len().checked_sub(1)?;
        self.find_at(name, level)
    }

    fn find_at(&mut self, name: &str, level: usize) -> Option<(Access, Binding, bool)> {
        let here = &self.levels[level];
        if let Some(b) = here.blocks.iter().rev().flat_map(|b| b.iter().rev()).find(|b| b.name == name) {
            let access = match b.at {
                At::Local(i) => Access::Local(i),
                At::Global(i) => Access::Global(i),
            };
            return Some((access, b.clone(), false));
        }
        if let Some((own, id, span)) = &here.own_name
            && own == name
        {
            let (kind, at) = (Kind::Function(*id), At::Local(0));
            return Some((
                Access::Current,
                Binding { name: own.clone(), span: *span, kind, at, declared: true },
                false,
            ));
        }
        let (access, binding, _) = self.find_at(name, level.checked_sub(1)?)?;
        let from = match access {
            Access::Global(_) => return Some((access, binding, true)),
            Access::Local(i) => CaptureFrom::Local(i),
            Access::Capture(i) => CaptureFrom::Capture(i),
            Access::Current => CaptureFrom::Current,
        };
        let captures = &mut self.levels[level].captures;
        let index = captures.iter().position(|c| *c == from).unwrap_or_else(|| {
            captures.push(from);
            captures.len() - 1
        });
        Some((Access::Capture(index as u32), binding, true))
    }

    /// Every name that can be seen, nearest first.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.levels
            .iter()
            .rev()
            .flat_map(|l| l.blocks.iter().rev().flat_map(|b| b.iter().rev().map(|x| x.name.as_str())))
    }
}
