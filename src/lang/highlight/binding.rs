//! The names that a file gives to things of its own, found without parsing it: where it is broken, it is shown all the same.

use super::{Token, TokenClass as Class};
use std::collections::HashSet;

/// Every name that is bound somewhere in the text: by `let`, `var`, `fn`, `param`, `for`, `import`, or as a function's
/// parameter.
pub fn bound_names<'t>(text: &'t str, tokens: &[Token]) -> HashSet<&'t str> {
    let all: Vec<(Class, &str)> = tokens
        .iter()
        .filter(|t| !matches!(t.class, Class::Blank | Class::Comment))
        .map(|t| (t.class, &text[t.range.clone()]))
        .collect();
    let word = |i: usize| all.get(i).map_or("", |t| t.1);
    let mut names = HashSet::new();
    let mut open: Vec<List> = Vec::new();
    for (i, (class, this)) in all.iter().enumerate() {
        match (class, *this) {
            (Class::Keyword, "let" | "var" | "fn" | "param" | "for" | "as") => names.extend(name_at(&all, i + 1)),
            (Class::Sign, "=>") if i > 0 => names.extend(name_at(&all, i - 1)),
            (Class::Sign, "(" | "[" | "{") => {
                // fn name(a, b); import "file.scene" { a, b }
                let two_before = i.checked_sub(2).and_then(|k| all.get(k));
                let binds = match *this {
                    "(" => two_before == Some(&(Class::Keyword, "fn")),
                    "{" => two_before.is_some_and(|t| t.1 == "import"),
                    _ => false,
                };
                open.push(List { round: *this == "(", binds, names: name_at(&all, i + 1).into_iter().collect() });
            }
            (Class::Sign, ",") => {
                if let Some(list) = open.last_mut() {
                    list.names.extend(name_at(&all, i + 1));
                }
            }
            (Class::Sign, ")" | "]" | "}") => {
                // (a, b) => …; what stands in other brackets isn't bound by them.
                let list = open.pop().filter(|l| l.binds || l.round && word(i + 1) == "=>");
                names.extend(list.into_iter().flat_map(|l| l.names));
            }
            _ => {}
        }
    }
    // Nothing closes these yet, as in a text that is being written.
    names.extend(open.into_iter().filter(|l| l.binds).flat_map(|l| l.names));
    names
}

/// What stands between two brackets, as far as it was read.
struct List<'t> {
    /// Between `(` and `)`.
    round: bool,
    /// It binds names, whatever follows.
    binds: bool,
    /// Those that its items start with.
    names: Vec<&'t str>,
}

fn name_at<'t>(all: &[(Class, &'t str)], i: usize) -> Option<&'t str> {
    all.get(i).filter(|t| t.0 == Class::Name).map(|t| t.1)
}
