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
    for (i, (class, this)) in all.iter().enumerate() {
        match (class, *this) {
            (Class::Keyword, "let" | "var" | "fn" | "param" | "for" | "as") => {
                names.extend(name_at(&all, i + 1));
                if *this == "fn" && word(i + 2) == "(" {
                    listed(&all, i + 2, &mut names);
                }
            }
            // import "file.scene" { a, b }
            (Class::Sign, "{") if i >= 2 && word(i - 2) == "import" => drop(listed(&all, i, &mut names)),
            (Class::Sign, "=>") if i > 0 => names.extend(name_at(&all, i - 1)),
            (Class::Sign, "(") => {
                // (a, b) => …; what stands in other brackets isn't bound by them.
                let mut parameters = HashSet::new();
                let end = listed(&all, i, &mut parameters);
                if word(end + 1) == "=>" {
                    names.extend(parameters);
                }
            }
            _ => {}
        }
    }
    names
}

fn name_at<'t>(all: &[(Class, &'t str)], i: usize) -> Option<&'t str> {
    all.get(i).filter(|t| t.0 == Class::Name).map(|t| t.1)
}

/// Adds the names that start the items between the bracket at `open` and its end, whose number is returned.
fn listed<'t>(all: &[(Class, &'t str)], open: usize, names: &mut HashSet<&'t str>) -> usize {
    let mut depth = 0usize;
    for (i, (class, sign)) in all.iter().enumerate().skip(open) {
        match (class, *sign) {
            (Class::Sign, "(" | "[" | "{") => depth += 1,
            (Class::Sign, ")" | "]" | "}") => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 {
            return i;
        }
        if i == open || depth == 1 && *sign == "," {
            names.extend(name_at(all, i + 1));
        }
    }
    all.len()
}
