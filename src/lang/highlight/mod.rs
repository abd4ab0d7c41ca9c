//! A text in tokens, for showing it in colours. Comments and texts are those that the scanner found, literals and words
//! those of the grammar; so what is shown is what is meant. Works on broken texts too.

mod binding;

use super::catalog::find;
use super::parse::{Rule, length_of};
use super::scan;
use crate::diag::FileId;
use binding::bound_names;
use pest::unicode::{XID_CONTINUE, XID_START};
use std::collections::HashSet;
use std::ops::Range;

/// A piece of a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Token {
    /// Its bytes; never empty, and whole characters.
    pub range: Range<usize>,
    /// What it is.
    pub class: TokenClass,
}

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TokenClass {
    /// Space and line ends.
    Blank,
    /// `// …` or `/* … */`.
    Comment,
    /// A text with its quotes, or the part of it before, between or after its `{…}`.
    Text,
    /// A number with its unit.
    Number,
    /// `#f80`.
    Color,
    /// A word of the grammar.
    Keyword,
    /// A word of the catalogue that no name of the file hides.
    Word,
    /// The name in `name: value` of a call or of a function's parameters.
    Argument,
    /// Any other name.
    Name,
    /// An operator, a bracket, or anything that the language doesn't know.
    Sign,
}

use TokenClass as Class;

/// The tokens of `text`, in order; together they are the text.
pub fn highlight(text: &str) -> Vec<Token> {
    let (prepared, _) = scan::prepare(FileId(0), text);
    let mut known: Vec<Token> = Vec::new();
    known.extend(prepared.comments.into_iter().map(|range| Token { range, class: Class::Comment }));
    known.extend(prepared.texts.into_iter().map(|range| Token { range, class: Class::Text }));
    known.retain(|t| !t.range.is_empty());
    known.sort_by_key(|t| t.range.start);

    let mut tokens = Vec::new();
    let mut at = 0;
    for token in known {
        code(text, at..token.range.start, &mut tokens);
        at = token.range.end;
        tokens.push(token);
    }
    code(text, at..text.len(), &mut tokens);
    contextual_words(text, &prepared.statements, &mut tokens);
    name(text, &mut tokens);
    tokens
}

/// Adds the tokens of a part without comments and texts.
fn code(text: &str, part: Range<usize>, tokens: &mut Vec<Token>) {
    let mut at = part.start;
    while let Some(c) = text.get(at..part.end).and_then(|rest| rest.chars().next()) {
        let rest = &text[at..part.end];
        let (class, len) = first(rest, c);
        let end = at + len.max(c.len_utf8());
        tokens.push(Token { range: at..end, class });
        at = end;
    }
}

/// The class and length of the token that `rest` starts with; `c` is its first character.
fn first(rest: &str, c: char) -> (Class, usize) {
    if c.is_whitespace() {
        return (Class::Blank, run(rest, char::is_whitespace));
    }
    if c == '#' {
        let word = 1 + run(&rest[1..], is_word);
        return (Class::Color, length_of(Rule::color, &rest[..word]).unwrap_or(word));
    }
    if c.is_ascii_digit() || c == '.' && rest[1..].starts_with(|d: char| d.is_ascii_digit()) {
        let most = run(rest, |c| is_word(c) || "._+-%(".contains(c)).min(longest(rest));
        if let Some(len) = length_of(Rule::number, &rest[..most]) {
            return (Class::Number, len);
        }
    }
    if XID_START(c) || c == '_' {
        let word = run(rest, is_word);
        let is_name = length_of(Rule::ident, &rest[..word]) == Some(word);
        return (if is_name { Class::Name } else { Class::Keyword }, word);
    }
    let sign = SIGNS.iter().find(|s| rest.starts_with(**s));
    (Class::Sign, sign.map_or(c.len_utf8(), |s| s.len()))
}

/// Operators of several characters, the longest first.
const SIGNS: [&str; 12] = ["..=", "|>", "..", "==", "!=", "<=", ">=", "=>", "+=", "-=", "*=", "/="];

/// The most bytes of a number that are looked at in one go: the parser takes time for all it is given, so that a long line of
/// sums would take the square of its length.
fn longest(rest: &str) -> usize {
    rest.floor_char_boundary(256)
}

fn run(text: &str, wanted: impl Fn(char) -> bool) -> usize {
    text.find(|c| !wanted(c)).unwrap_or(text.len())
}

fn is_word(c: char) -> bool {
    XID_CONTINUE(c) || c == '_'
}

/// Words that are keywords in one kind of statement and names elsewhere: `of` in a `param`, and the edition's `rtdsl`.
fn contextual_words(text: &str, statements: &[scan::Piece], tokens: &mut [Token]) {
    for (i, statement) in statements.iter().enumerate() {
        let from = tokens.partition_point(|t| t.range.start < statement.range.start);
        let to = tokens.partition_point(|t| t.range.start < statement.range.end);
        let Some((first, rest)) = tokens.get_mut(from..to).and_then(|t| t.split_first_mut()) else { continue };
        match &text[first.range.clone()] {
            "rtdsl" if i == 0 && first.class == Class::Name => first.class = Class::Keyword,
            "param" => {
                let of = |t: &&mut Token| t.class == Class::Name && &text[t.range.clone()] == "of";
                if let Some(of) = rest.iter_mut().find(of) {
                    of.class = Class::Keyword;
                }
            }
            _ => {}
        }
    }
}

/// Tells words of the catalogue and names of arguments from other names.
fn name(text: &str, tokens: &mut [Token]) {
    let hidden: HashSet<&str> = bound_names(text, tokens);
    let mut open: Vec<u8> = Vec::new();
    // The last two tokens that aren't blanks or comments.
    let (mut before, mut last) = ("", "");
    for i in 0..tokens.len() {
        let (class, word) = (tokens[i].class, &text[tokens[i].range.clone()]);
        match (class, word) {
            (Class::Blank | Class::Comment, _) => continue,
            (Class::Sign, "(" | "[" | "{") => open.push(word.as_bytes()[0]),
            (Class::Sign, ")" | "]" | "}") => drop(open.pop()),
            (Class::Name, _) => {
                let next = tokens[i + 1..].iter().find(|t| !matches!(t.class, Class::Blank | Class::Comment));
                let colon = next.is_some_and(|t| &text[t.range.clone()] == ":");
                let of_std = last == "." && before == "std";
                if colon && open.last() == Some(&b'(') {
                    tokens[i].class = Class::Argument;
                } else if find(word).is_some() && (of_std || last != "." && !hidden.contains(word)) {
                    tokens[i].class = Class::Word;
                }
            }
            _ => {}
        }
        (before, last) = (last, word);
    }
}

#[cfg(test)]
mod tests;
