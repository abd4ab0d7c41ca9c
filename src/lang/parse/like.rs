//! Statements like one before them but for the numbers in them, as programs write them by the thousand: they aren't parsed.
//!
//! A number counts only where it is all of an argument or of an item of a list: after `(`, `[`, `,` or `:`, and before `,`,
//! `)` or `]`. There it is an expression of its own, so another number in its place changes nothing of the grammar's view of the
//! rest. What a name means is left open, so nothing that binds one may stand between two statements that are to be alike.

use std::collections::HashMap;
use std::ops::Range;

/// A statement that is a template's with other numbers.
#[derive(Clone, Copy, Debug)]
pub struct Like {
    /// The template's number.
    pub template: u32,
    /// Its bytes in the file.
    pub start: u32,
    /// One past them.
    pub end: u32,
}

/// A statement that others are like: one that is an expression, parsed without a mistake.
#[derive(Clone, Debug)]
pub struct Template {
    /// Its place among the parsed statements.
    pub statement: usize,
    /// Its bytes in the file.
    pub range: Range<usize>,
}

/// A number in a statement: its bytes, counted from the statement's start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Number {
    /// Its first byte, the sign included.
    pub start: u32,
    /// One past its last.
    pub end: u32,
}

impl Number {
    /// Its value; `text` is the statement.
    pub fn value(self, text: &str) -> f64 {
        text.get(self.start as usize..self.end as usize).and_then(|digits| digits.parse().ok()).unwrap_or(0.0)
    }
}

/// Most bytes of a number: none so long is too large.
const LONGEST: usize = 300;

/// Most templates at a time: a text of that many kinds of lines was written by hand, or is alike in something else.
const MOST: usize = 1000;

/// The templates that a statement may be like.
#[derive(Default)]
pub(super) struct Likenesses {
    by_outline: HashMap<u64, Known>,
    /// Room for the numbers of a statement.
    numbers: Vec<Number>,
}

struct Known {
    template: u32,
    range: Range<usize>,
    numbers: Vec<Number>,
}

impl Likenesses {
    /// Nothing after this is like anything before it.
    pub(super) fn clear(&mut self) {
        self.by_outline.clear();
    }

    /// The outline of a statement that can be or have a template, and the template that it is like.
    pub(super) fn look(&mut self, file: &str, statement: &str) -> Option<(u64, Option<u32>)> {
        let outline = outline(statement, &mut self.numbers)?;
        let known = self.by_outline.get(&outline).filter(|known| {
            let template = file.get(known.range.clone()).unwrap_or("");
            outline_is_same(template, &known.numbers, statement, &self.numbers)
        });
        Some((outline, known.map(|known| known.template)))
    }

    /// Adds the statement that was looked at last as a template.
    pub(super) fn add(&mut self, outline: u64, template: u32, range: Range<usize>) {
        if self.by_outline.len() >= MOST {
            self.clear();
        }
        self.by_outline.insert(outline, Known { template, range, numbers: self.numbers.clone() });
    }
}

/// Whether all but their numbers is the same.
fn outline_is_same(a: &str, a_numbers: &[Number], b: &str, b_numbers: &[Number]) -> bool {
    if a_numbers.len() != b_numbers.len() {
        return false;
    }
    let (mut i, mut k) = (0, 0);
    for (x, y) in a_numbers.iter().zip(b_numbers) {
        if a.as_bytes().get(i..x.start as usize) != b.as_bytes().get(k..y.start as usize) {
            return false;
        }
        (i, k) = (x.end as usize, y.end as usize);
    }
    a.get(i..) == b.get(k..)
}

/// A hash of all but the numbers; `None` where there are none, or it is no statement of this kind.
fn outline(text: &str, out: &mut Vec<Number>) -> Option<u64> {
    numbers(text, out)?;
    let mut from = 0;
    let mut hash = out.len() as u64;
    let mut add = |part: &[u8]| {
        for word in part.chunks(8) {
            let mut bytes = [0; 8];
            bytes[..word.len()].copy_from_slice(word);
            // Multiply and turn: quick, and what it mixes up is told apart afterwards.
            hash = (hash ^ u64::from_le_bytes(bytes)).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29);
        }
        hash ^= part.len() as u64;
    };
    for n in out.iter() {
        add(&text.as_bytes()[from..n.start as usize]);
        from = n.end as usize;
    }
    add(&text.as_bytes()[from..]);
    Some(hash)
}

/// The numbers that are all of an argument or item. `None` where there are none, or where a block, a text or a second statement
/// makes it too much to be told at a glance.
pub fn numbers(text: &str, out: &mut Vec<Number>) -> Option<()> {
    out.clear();
    let bytes = text.as_bytes();
    let mut i = 0;
    // Whether an argument or item starts here.
    let mut opens = false;
    while let Some(c) = bytes.get(i) {
        match c {
            b'(' | b'[' | b',' | b':' => opens = true,
            b' ' => {}
            b'-' | b'0'..=b'9' if opens => {
                if let Some(end) = number_end(bytes, i)
                    && closes(bytes, end)
                    && end - i <= LONGEST
                {
                    out.push(Number { start: i as u32, end: end as u32 });
                    i = end;
                    continue;
                }
                opens = false;
            }
            b'"' | b'{' | b'}' | b';' | b'\n' | b'\r' | b'\t' => return None,
            _ => opens = false,
        }
        i += 1;
    }
    (!out.is_empty()).then_some(())
}

/// One past the digits that start at `i`, perhaps with a sign.
fn number_end(bytes: &[u8], i: usize) -> Option<usize> {
    let digits = |mut i: usize| {
        let start = i;
        while bytes.get(i).is_some_and(u8::is_ascii_digit) {
            i += 1;
        }
        (i > start).then_some(i)
    };
    let whole = digits(i + usize::from(bytes[i] == b'-'))?;
    match bytes.get(whole) {
        Some(b'.') => digits(whole + 1),
        _ => Some(whole),
    }
}

/// Whether what comes next, blanks aside, ends an argument or item.
fn closes(bytes: &[u8], mut i: usize) -> bool {
    while bytes.get(i) == Some(&b' ') {
        i += 1;
    }
    matches!(bytes.get(i), Some(b',' | b')' | b']'))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(text: &str) -> Option<Vec<f64>> {
        let mut out = Vec::new();
        numbers(text, &mut out).map(|()| out.iter().map(|n| n.value(text)).collect())
    }

    #[test]
    fn numbers_that_stand_alone_are_found() {
        assert_eq!(values("f(1, [-2.5 , 3], r: 4)"), Some(vec![1.0, -2.5, 3.0, 4.0]));
        assert_eq!(values("f(1 + 2, 30deg, 50%, 1e3, .5, 7.)"), None, "parts of expressions aren't");
        assert_eq!(values("f(a[0..3], #123, x1, 2)"), Some(vec![2.0]));
        assert_eq!(values("f({ 1 }, 2)"), None, "blocks are parsed");
        assert_eq!(values("f(1 /* */, 2)"), Some(vec![2.0]), "whether there are comments is looked at before");
    }

    #[test]
    fn outlines_differ_in_all_but_numbers() {
        let of = |text| outline(text, &mut Vec::new());
        assert_eq!(of("f(1, x: -2.5)"), of("f(33, x: 0)"));
        for other in ["f(1, y: 2)", "f(1,x: 2)", "g(1, x: 2)", "f(1, 2)", "f(1, x: y)", "f(1, x: 2 )"] {
            assert_ne!(of("f(1, x: 2)"), of(other), "{other}");
        }
    }
}
