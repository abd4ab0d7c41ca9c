//! Literals: numbers with units, texts, colours.

use super::Rule;
use super::builder::{Builder, Parsed, Parts};
use crate::diag::{Diagnostic, Span};
use crate::lang::ast::*;
use crate::lang::suggest::nearest;
use crate::scene::Color;
use ecow::EcoString;
use pest::iterators::Pair;

impl Builder<'_> {
    pub(super) fn number(&mut self, pair: Pair<'_, Rule>) -> Parsed<Expr> {
        let span = self.span(&pair);
        let mut parts = pair.into_inner();
        let digits = parts.next().map_or("", |p| p.as_str());
        let value: f64 = digits.replace('_', "").parse().unwrap_or(f64::INFINITY);
        let too_large = || Diagnostic::error("this number is too large").at(span, "the largest is about 1.8e308");
        if !value.is_finite() {
            return Err(too_large());
        }
        let Some(unit) = parts.next() else {
            return self.make(span, 0, ExprKind::Number(value));
        };
        let angle = |degrees: f64| {
            if degrees.is_finite() {
                Ok(ExprKind::Angle(degrees))
            } else {
                Err(too_large().note("angles are kept in degrees"))
            }
        };
        let kind = match unit.as_str() {
            "deg" => ExprKind::Angle(value),
            "turn" => angle(value * 360.0)?,
            "rad" => angle(value.to_degrees())?,
            "%" => ExprKind::Number(value / 100.0),
            other => {
                let span = self.span(&unit);
                let d = Diagnostic::error(format!("`{other}` isn't a unit")).note("units are: deg, turn, rad and %");
                return Err(match nearest(other, ["deg", "turn", "rad"]) {
                    Some(best) => d.at(span, format!("did you mean `{best}`?")).fix(best),
                    None if other.starts_with(|c: char| c.is_alphabetic()) => {
                        d.at(span, "lengths have no unit; for a product write `*`")
                    }
                    None => d.at(span, ""),
                });
            }
        };
        self.make(span, 0, kind)
    }

    pub(super) fn text_parts(&mut self, pair: Pair<'_, Rule>) -> Parsed<Vec<TextPart>> {
        let mut out = Vec::new();
        for part in pair.into_inner() {
            if part.as_rule() == Rule::interpolation {
                out.push(TextPart::Expr(self.expr(Parts::of(part).next()?)?));
            } else {
                out.push(TextPart::Literal(self.unescape(&part)?));
            }
        }
        Ok(out)
    }

    pub(super) fn unescape(&self, part: &Pair<'_, Rule>) -> Parsed<EcoString> {
        let mut out = EcoString::new();
        let mut chars = part.as_str().char_indices();
        while let Some((at, c)) = chars.next() {
            if c != '\\' {
                out.push(c);
                continue;
            }
            match chars.next().map(|(_, c)| c) {
                Some('n') => out.push('\n'),
                Some('t') => out.push('\t'),
                Some(c @ ('"' | '\\' | '{' | '}')) => out.push(c),
                other => {
                    let start = self.offset + part.as_span().start() + at;
                    let len = 1 + other.map_or(0, char::len_utf8);
                    return Err(Diagnostic::error(format!("`\\{}` means nothing in a text", other.unwrap_or(' ')))
                        .at(Span::new(self.file, start..start + len), "for a backslash write `\\\\`")
                        .note("a text knows: \\n \\t \\\" \\\\ \\{ \\}"));
                }
            }
        }
        Ok(out)
    }

    /// A text without `{…}`: a path, a description.
    pub(super) fn plain_text(&mut self, pair: Pair<'_, Rule>) -> Parsed<EcoString> {
        let span = self.span(&pair);
        let mut out = EcoString::new();
        for part in self.text_parts(pair)? {
            match part {
                TextPart::Literal(s) => out.push_str(&s),
                TextPart::Expr(_) => return Err(Diagnostic::error("this text must be plain").at(span, "no `{…}` here")),
            }
        }
        Ok(out)
    }
}

pub(super) fn parse_color(text: &str) -> Option<Color> {
    let digits: Vec<u8> =
        text.strip_prefix('#')?.chars().map(|c| c.to_digit(16).map(|d| d as u8)).collect::<Option<_>>()?;
    match digits[..] {
        [r, g, b] => Some(Color::from_srgb8([r * 17, g * 17, b * 17])),
        [r1, r0, g1, g0, b1, b0] => Some(Color::from_srgb8([r1 * 16 + r0, g1 * 16 + g0, b1 * 16 + b0])),
        _ => None,
    }
}

pub(super) fn bad_color(text: &str, span: Span) -> Diagnostic {
    Diagnostic::error(format!("`{text}` isn't a color"))
        .at(span, "expected 3 or 6 digits from 0 to f")
        .note("as in `#f80` or `#ff8800`")
}
