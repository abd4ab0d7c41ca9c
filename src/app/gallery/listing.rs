//! A scene's text as HTML: in colours, with numbered lines that can be linked to.

use crate::lang::catalog::{TOPICS, catalog};
use crate::lang::word::Kind;
use crate::lang::{TokenClass, highlight};
use std::collections::HashMap;

/// What is told of words, made once a run.
pub struct Listing {
    /// A sentence about each word and keyword, and whether it is a colour's name.
    words: HashMap<&'static str, (&'static str, bool)>,
}

impl Listing {
    /// With what the catalogue says of its words.
    pub fn of_catalog() -> Listing {
        let topics = TOPICS.iter().flat_map(|t| t.names.iter().map(|n| (*n, (first_sentence(t.doc), false))));
        let words = catalog().iter().map(|w| (w.name, (w.doc, w.kind == Kind::ColorName)));
        Listing { words: topics.chain(words).collect() }
    }

    /// The lines of `text`, each in an element with the id `L` and its number.
    pub fn html(&self, text: &str) -> String {
        let mut out = String::with_capacity(text.len() * 6);
        let mut line = 1;
        open_line(&mut out, line);
        for token in highlight(text) {
            let mut parts = text[token.range].split('\n');
            self.token(&mut out, token.class, parts.next().unwrap_or(""));
            for part in parts {
                out += "\n</span>";
                line += 1;
                open_line(&mut out, line);
                self.token(&mut out, token.class, part);
            }
        }
        out += "</span>";
        // What ends in a line's end has no line after it.
        let empty = {
            let mut l = String::new();
            open_line(&mut l, line);
            l + "</span>"
        };
        out.strip_suffix(empty.as_str()).filter(|rest| !rest.is_empty()).map(str::to_owned).unwrap_or(out)
    }

    fn token(&self, out: &mut String, class: TokenClass, text: &str) {
        let text = text.trim_end_matches('\r');
        let letter = match class {
            TokenClass::Comment => "c",
            TokenClass::Text => "t",
            TokenClass::Number => "n",
            TokenClass::Color => "h",
            TokenClass::Keyword => "k",
            TokenClass::Word => "w",
            TokenClass::Argument => "a",
            TokenClass::Sign => "s",
            TokenClass::Blank | TokenClass::Name => "",
        };
        if letter.is_empty() || text.is_empty() {
            escape(out, text);
            return;
        }
        let known = match class {
            TokenClass::Word | TokenClass::Keyword => self.words.get(text),
            _ => None,
        };
        let swatch = known.is_some_and(|k| k.1) || class == TokenClass::Color && is_color(text);
        if swatch {
            // Digits or a word of the catalogue, which CSS knows by the same name.
            *out += &format!("<i style=\"background:{text}\"></i>");
        }
        *out += &format!("<span class=\"{letter}\"");
        if let Some((doc, _)) = known {
            *out += " title=\"";
            escape(out, doc);
            out.push('"');
        }
        out.push('>');
        escape(out, text);
        *out += "</span>";
    }
}

fn open_line(out: &mut String, line: usize) {
    *out += &format!(
        "<span class=\"l\" id=\"L{line}\"><a href=\"#L{line}\" data-n=\"{line}\" aria-label=\"line {line}\"></a>"
    );
}

/// Whether `text` is a colour, not only something that begins like one.
fn is_color(text: &str) -> bool {
    let digits = text.trim_start_matches('#');
    matches!(digits.len(), 3 | 6) && digits.bytes().all(|b| b.is_ascii_hexdigit())
}

fn first_sentence(doc: &str) -> &str {
    doc.find(". ").map_or(doc, |end| &doc[..=end])
}

/// Adds `text` so that it means nothing in HTML, within an element or an attribute's double quotes.
pub fn escape(out: &mut String, text: &str) {
    for c in text.chars() {
        match c {
            '&' => *out += "&amp;",
            '<' => *out += "&lt;",
            '>' => *out += "&gt;",
            '"' => *out += "&quot;",
            // Not allowed in HTML, in whatever form.
            c if c.is_control() && c != '\t' => out.push('\u{FFFD}'),
            c => out.push(c),
        }
    }
}

/// `text` as HTML in which what stands in backticks is code.
pub fn prose(text: &str) -> String {
    let mut out = String::new();
    let parts: Vec<&str> = text.split('`').collect();
    let paired = parts.len() % 2 == 1;
    for (i, part) in parts.iter().enumerate() {
        match i % 2 {
            1 if paired => {
                out += "<code>";
                escape(&mut out, part);
                out += "</code>";
            }
            _ => {
                if i > 0 && !paired {
                    out.push('`');
                }
                escape(&mut out, part);
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_classes() {
        let html = Listing::of_catalog().html("sphere(r: 1)\r\n/* <a>\n */ #f80\n");
        assert_eq!(html.matches("class=\"l\"").count(), 3);
        for part in [
            "id=\"L3\"",
            "<span class=\"w\" title=\"",
            "<span class=\"c\">/* &lt;a&gt;</span>\n</span>",
            "<i style=\"background:#f80\"></i><span class=\"h\">#f80</span>",
            "<span class=\"a\">r</span>",
        ] {
            assert!(html.contains(part), "{part} in {html}");
        }
        assert!(!html.contains('\r'));
        assert_eq!(Listing::of_catalog().html("").matches("class=\"l\"").count(), 1);
        assert!(!Listing::of_catalog().html("#f8").contains("<i"), "not a color");
        assert!(Listing::of_catalog().html("tomato").contains("<i style=\"background:tomato\">"));
    }

    #[test]
    fn prose_has_code() {
        assert_eq!(prose("a `b<` c"), "a <code>b&lt;</code> c");
        assert_eq!(prose("a ` b"), "a ` b");
    }
}
