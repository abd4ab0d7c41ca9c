//! What a scene calls itself: the comment at its top.

use crate::lang::{TokenClass, highlight};

/// A scene's title and what it says of itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Title {
    /// The first line of the first comment, without its full stop; empty where there is none.
    pub title: String,
    /// The lines that follow in the same comment.
    pub description: String,
}

/// The title of the scene `text`. The comment stands at its top, after the edition at most; an empty line ends it.
pub fn title(text: &str) -> Title {
    let mut lines: Vec<String> = Vec::new();
    for token in highlight(text) {
        let part = &text[token.range.clone()];
        match token.class {
            TokenClass::Comment => lines.extend(bare(part)),
            TokenClass::Blank if lines.is_empty() || part.matches('\n').count() < 2 => {}
            // rtdsl 1
            TokenClass::Keyword if part == "rtdsl" && lines.is_empty() => {}
            TokenClass::Number if lines.is_empty() && text.starts_with("rtdsl") => {}
            _ => break,
        }
    }
    let mut lines = lines.into_iter();
    let first = lines.next().unwrap_or_default();
    let title = first.strip_suffix('.').unwrap_or(&first).to_string();
    Title { title, description: lines.collect::<Vec<_>>().join(" ") }
}

/// The lines of a comment without its signs and without empty ones.
fn bare(comment: &str) -> Vec<String> {
    let inner = comment.strip_prefix("/*").map(|c| c.strip_suffix("*/").unwrap_or(c));
    let lines = inner.unwrap_or(comment).lines().map(|l| l.trim().trim_start_matches(['/', '*']).trim().to_string());
    lines.filter(|l| !l.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn titles() {
        let of = |text: &str| {
            let t = title(text);
            (t.title, t.description)
        };
        let both = |a: &str, b: &str| (a.to_string(), b.to_string());
        assert_eq!(
            of("rtdsl 1\n// Sea: waves.\n// Two\n// lines.\n\n// more\nsphere()"),
            both("Sea: waves", "Two lines.")
        );
        assert_eq!(of("\n\n/// A ball\nsphere() // not this"), both("A ball", ""));
        assert_eq!(of("/*\n * A block.\n * It goes on.\n */\nsphere()"), both("A block", "It goes on."));
        assert_eq!(of("sphere() // not this"), both("", ""));
        assert_eq!(of("// only\r\n// this\r\n"), both("only", "this"));
        assert_eq!(of(""), both("", ""));
    }
}
