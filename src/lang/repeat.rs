//! Runs statements that are like another but for their numbers: what that one was resolved to, with other numbers in other
//! places. So a hundred thousand of them need the space of one.

use super::code::*;
use super::parse::like::{Like, Number, numbers};
use super::value::Value;
use crate::diag::Span;

/// A template's code, and where its numbers stand.
struct Copy {
    node: Node,
    numbers: Vec<Number>,
    /// The template's first byte in the file.
    start: u32,
}

/// The statements of a file that are like others.
pub struct Repeats<'m> {
    module: &'m ModuleCode,
    text: &'m str,
    likes: std::slice::Iter<'m, Like>,
    copies: Vec<Option<Copy>>,
    /// Room for the numbers of one.
    numbers: Vec<Number>,
}

impl<'m> Repeats<'m> {
    pub fn new(module: &'m ModuleCode, text: &'m str) -> Repeats<'m> {
        let copy = |statement: &Option<usize>| {
            let template = &module.statements.get((*statement)?)?.node;
            copy_of(template, text)
        };
        let copies = module.templates.iter().map(copy).collect();
        let likes = module.parsed.likes.iter();
        Repeats { module, text, likes, copies, numbers: Vec::new() }
    }

    /// The next one, where it stands before byte `at`.
    pub fn next_before(&mut self, at: u32) -> Option<&Node> {
        loop {
            let like = self.likes.as_slice().first().filter(|l| l.start < at)?;
            self.likes.next();
            let template = like.template as usize;
            // Those of a template that can't be copied stand among the others.
            let Some(original) = self.module.templates.get(template).copied().flatten() else { continue };
            let (Some(original), Some(Some(copy))) =
                (self.module.statements.get(original), self.copies.get_mut(template))
            else {
                continue;
            };
            let text = self.text.get(like.start as usize..like.end as usize)?;
            numbers(text, &mut self.numbers)?;
            let change = Change { old: &copy.numbers, new: &self.numbers, text, from: copy.start, to: like.start };
            change.apply(&mut copy.node, &original.node);
            return self.copies.get(template)?.as_ref().map(|copy| &copy.node);
        }
    }
}

/// Whether others can be run as copies of this node, a whole statement of `text`.
pub fn can_be_copied(node: &Node, text: &str) -> bool {
    copy_of(node, text).is_some()
}

fn copy_of(template: &Node, text: &str) -> Option<Copy> {
    let mut old = Vec::new();
    let text = text.get(template.span.range())?;
    numbers(text, &mut old)?;
    let (mut node, start) = (copied(template)?, template.span.start);
    let change = Change { old: &old, new: &old, text, from: start, to: start };
    // Every number must be a constant of its own in the code.
    (change.apply(&mut node, template) == old.len()).then_some(Copy { node, numbers: old, start })
}

/// A copy of code of the kinds that plain statements are made of.
fn copied(node: &Node) -> Option<Node> {
    let boxed = |node: &Node| copied(node).map(Box::new);
    let code = match &node.code {
        Code::Const(v) => Code::Const(v.clone()),
        Code::Global(i) => Code::Global(*i),
        Code::List(items) => Code::List(items.iter().map(copied).collect::<Option<_>>()?),
        Code::Emit(of) => Code::Emit(boxed(of)?),
        Code::Field { of, name, item } => Code::Field { of: boxed(of)?, name: name.clone(), item: *item },
        Code::Index(ab) => Code::Index(Box::new((copied(&ab.0)?, copied(&ab.1)?))),
        Code::CallBuiltin { word, args } => {
            let args = args.iter().map(|(i, n)| Some((*i, copied(n)?)));
            Code::CallBuiltin { word: *word, args: args.collect::<Option<_>>()? }
        }
        Code::Call { function, callee: None, args } => {
            let arg = |a: &Option<Node>| match a {
                Some(n) => copied(n).map(Some),
                None => Some(None),
            };
            let args = args.iter().map(arg).collect::<Option<_>>()?;
            Code::Call { function: *function, callee: None, args }
        }
        _ => return None,
    };
    Some(Node { code, span: node.span })
}

/// What makes the code of one statement that of another.
struct Change<'a> {
    old: &'a [Number],
    new: &'a [Number],
    /// Of the new one.
    text: &'a str,
    /// Where the statements start in the file.
    from: u32,
    to: u32,
}

impl Change<'_> {
    /// Changes a copy of `original`; gives how many numbers it has set.
    fn apply(&self, copy: &mut Node, original: &Node) -> usize {
        copy.span = self.span(original.span);
        match (&mut copy.code, &original.code) {
            (Code::Const(value), Code::Const(Value::Number(_))) => {
                let (start, end) = (original.span.start - self.from, original.span.end - self.from);
                let Some(k) = self.old.iter().position(|n| (n.start, n.end) == (start, end)) else { return 0 };
                let Some(new) = self.new.get(k) else { return 0 };
                *value = Value::Number(new.value(self.text));
                1
            }
            (Code::List(copy), Code::List(original)) => self.apply_all(copy.iter_mut(), original.iter()),
            (Code::Emit(copy), Code::Emit(original)) => self.apply(copy, original),
            (Code::Field { of: copy, .. }, Code::Field { of: original, .. }) => self.apply(copy, original),
            (Code::Index(copy), Code::Index(original)) => {
                self.apply(&mut copy.0, &original.0) + self.apply(&mut copy.1, &original.1)
            }
            (Code::CallBuiltin { args: copy, .. }, Code::CallBuiltin { args: original, .. }) => {
                self.apply_all(copy.iter_mut().map(|a| &mut a.1), original.iter().map(|a| &a.1))
            }
            (Code::Call { args: copy, .. }, Code::Call { args: original, .. }) => {
                self.apply_all(copy.iter_mut().flatten(), original.iter().flatten())
            }
            _ => 0,
        }
    }

    fn apply_all<'n>(
        &self,
        copies: impl Iterator<Item = &'n mut Node>,
        originals: impl Iterator<Item = &'n Node>,
    ) -> usize {
        copies.zip(originals).map(|(copy, original)| self.apply(copy, original)).sum()
    }

    fn span(&self, old: Span) -> Span {
        Span { start: self.place(old.start), end: self.place(old.end), ..old }
    }

    /// Where a byte of the template outside its numbers, or at an end of one, is in the other.
    fn place(&self, at: u32) -> u32 {
        let at = at.saturating_sub(self.from);
        let before = self.old.iter().zip(self.new).take_while(|(old, _)| old.end <= at).last();
        self.to + before.map_or(at, |(old, new)| at - old.end + new.end)
    }
}
