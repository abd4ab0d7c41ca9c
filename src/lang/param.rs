//! `param`: a value that the command line may set.

use super::ast::Op;
use super::code::{Code, Node, ParamCode};
use super::fault::{Fault, Outcome, Stop};
use super::machine::{Frame, Machine};
use super::request::{Param, ParamKind};
use super::suggest::{join_or, nearest};
use super::value::{Value, number_text};
use super::word::described;
use crate::diag::Span;

impl Machine<'_> {
    /// Evaluates a declaration: the default must fit it too.
    pub fn param(&mut self, p: &ParamCode, frame: Frame<'_>) -> Outcome {
        let default = self.eval(&p.default, frame)?;
        let kind = self.param_kind(p, &default, frame)?;
        self.fits(&kind, p, &default, p.default.span)?;
        let set = if p.main { self.set.remove(p.name.as_str()) } else { None };
        let mut value = default.clone();
        if let Some(set) = set {
            value = self.set_value(&kind, set.node, &set.raw, frame)?;
            self.fits(&kind, p, &value, set.span)?;
        }
        if p.main {
            self.params.push(Param {
                name: p.name.to_string(),
                description: p.description.as_ref().map(|d| d.to_string()),
                kind,
                default: default.show(200),
                value: value.show(200),
                number: match &value {
                    Value::Number(x) | Value::Angle(x) => Some(*x),
                    _ => None,
                },
                color: match &value {
                    Value::Color(c) => Some(*c),
                    _ => None,
                },
                span: p.name_span,
            });
        }
        self.globals[p.slot as usize] = value;
        Ok(Value::None)
    }

    fn set_value(
        &mut self,
        kind: &ParamKind,
        node: Result<&Node, crate::diag::Diagnostic>,
        raw: &str,
        frame: Frame<'_>,
    ) -> Outcome {
        let is_text = match kind {
            ParamKind::Choice(words) => words.iter().any(|w| w == raw),
            ParamKind::Text => !raw.trim_start().starts_with('"'),
            _ => false,
        };
        if is_text {
            return Ok(Value::Text(raw.into()));
        }
        match node {
            Ok(node) => self.eval(node, frame),
            Err(d) => Err(Stop::Error(Box::new(d))),
        }
    }

    fn param_kind(&mut self, p: &ParamCode, default: &Value, frame: Frame<'_>) -> Result<ParamKind, Stop> {
        if let Some(node) = &p.choices {
            let choices = self.eval(node, frame)?;
            let texts: Option<Vec<String>> = choices.items().and_then(|items| {
                items.iter().map(|v| if let Value::Text(t) = v { Some(t.to_string()) } else { None }).collect()
            });
            return match texts {
                Some(t) if !t.is_empty() => Ok(ParamKind::Choice(t)),
                _ => Err(self.fail(
                    Fault::new("`of` takes a list of texts").note("as in `of [\"matte\", \"glass\"]`"),
                    node.span,
                )),
            };
        }
        let range = match &p.range {
            Some(node) => Some(self.param_range(default, node, frame)?),
            None => None,
        };
        let whole = |x: f64| x.fract() == 0.0;
        Ok(match default {
            Value::Number(n) => {
                let whole = whole(*n) && range.is_some_and(|(lo, hi)| whole(lo) && whole(hi));
                ParamKind::Number { range, whole, unit: "" }
            }
            Value::Angle(_) => ParamKind::Number { range, whole: false, unit: "deg" },
            Value::Bool(_) => ParamKind::Switch,
            Value::Color(_) => ParamKind::Color,
            Value::Text(_) => ParamKind::Text,
            _ => ParamKind::Other,
        })
    }

    fn param_range(&mut self, default: &Value, node: &Node, frame: Frame<'_>) -> Result<(f64, f64), Stop> {
        let angle = matches!(default, Value::Angle(_));
        let example = if angle { "as in `in 0deg..=90deg`" } else { "as in `in 1..=10`" };
        let fault = match self.param_ends(node, frame)? {
            _ if !angle && !matches!(default, Value::Number(_)) => {
                Fault::new("only a number or an angle has a range").note("for texts write `of [\"a\", \"b\"]`")
            }
            Some((_, _, false)) => Fault::new("a parameter's range includes its end").label("write `..=`"),
            Some((Value::Number(a), Value::Number(b), _)) if !angle && a <= b => return Ok((a, b)),
            Some((Value::Angle(a), Value::Angle(b), _)) if angle && a <= b => return Ok((a, b)),
            Some((Value::Number(_), Value::Number(_), _)) if angle => {
                Fault::new("the range of an angle goes from an angle to an angle").note(example)
            }
            Some((Value::Angle(_), Value::Angle(_), _)) if !angle => {
                Fault::new("the range of a number goes from a number to a number").note(example)
            }
            Some((Value::Number(a), Value::Number(b), _)) | Some((Value::Angle(a), Value::Angle(b), _)) if a > b => {
                Fault::new("this range is empty").label("its end is below its start")
            }
            _ => Fault::new("`in` takes a range").note(example),
        };
        Err(self.fail(fault, node.span))
    }

    /// The ends of a range and whether it includes the last; as a value, a range has no unit.
    fn param_ends(&mut self, node: &Node, frame: Frame<'_>) -> Result<Option<(Value, Value, bool)>, Stop> {
        if let Code::Binary(ends) = &node.code
            && let Op::Range | Op::RangeInclusive = ends.op
        {
            let (a, b) = (self.eval(&ends.a, frame)?, self.eval(&ends.b, frame)?);
            return Ok(Some((a, b, ends.op == Op::RangeInclusive)));
        }
        Ok(match self.eval(node, frame)? {
            Value::Range(r) => Some((Value::Number(r.from), Value::Number(r.to), r.inclusive)),
            _ => None,
        })
    }

    fn fits(&mut self, kind: &ParamKind, p: &ParamCode, value: &Value, span: Span) -> Result<(), Stop> {
        let got = described(value, &self.build);
        let name = &p.name;
        let fault = match (kind, value) {
            (ParamKind::Number { range, whole, unit }, Value::Number(n) | Value::Angle(n)) => {
                if matches!(value, Value::Angle(_)) != (*unit == "deg") {
                    let expected = if *unit == "deg" { "an angle" } else { "a number" };
                    let fault = Fault::new(format!("parameter `{name}` must be {expected}, got {got}"));
                    match value {
                        Value::Number(n) => fault.label(format!("write `{}deg`", number_text(*n))),
                        _ => fault.label("a number has no unit"),
                    }
                } else if let Some((lo, hi)) = range
                    && !(*lo..=*hi).contains(n)
                {
                    let (lo, hi) = (number_text(*lo), number_text(*hi));
                    Fault::new(format!(
                        "parameter `{name}` must be from {lo}{unit} to {hi}{unit}, got {}",
                        value.show(40)
                    ))
                } else if *whole && n.fract() != 0.0 {
                    Fault::new(format!("parameter `{name}` must be a whole number, got {}", value.show(40)))
                } else {
                    return Ok(());
                }
            }
            (ParamKind::Choice(words), Value::Text(t)) if words.iter().any(|w| w == t.as_str()) => return Ok(()),
            (ParamKind::Choice(words), _) => {
                let best = if let Value::Text(t) = value { nearest(t, words.iter().map(String::as_str)) } else { None };
                let label = best.map_or(String::new(), |b| format!("did you mean \"{b}\"?"));
                let words: Vec<String> = words.iter().map(|w| format!("\"{w}\"")).collect();
                Fault::new(format!("parameter `{name}` must be {}, got {got}", join_or(&words))).label(label)
            }
            (ParamKind::Switch, Value::Bool(_))
            | (ParamKind::Color, Value::Color(_))
            | (ParamKind::Text, Value::Text(_))
            | (ParamKind::Other, _) => return Ok(()),
            (ParamKind::Number { unit: "deg", .. }, _) => {
                Fault::new(format!("parameter `{name}` must be an angle, got {got}"))
            }
            (ParamKind::Number { .. }, _) => Fault::new(format!("parameter `{name}` must be a number, got {got}")),
            (ParamKind::Switch, _) => Fault::new(format!("parameter `{name}` must be `true` or `false`, got {got}")),
            (ParamKind::Color, _) => Fault::new(format!("parameter `{name}` must be a color, got {got}")),
            (ParamKind::Text, _) => Fault::new(format!("parameter `{name}` must be a text, got {got}")),
        };
        let fault = if span == p.default.span { fault } else { fault.and_at(p.name_span, "declared here") };
        Err(self.fail(fault, span))
    }
}
