//! `rtdsl params`: what `--set` can change.

use super::args::ParamsArgs;
use super::load::{load, request};
use super::{Exit, Stop};
use crate::diag::Sources;
use crate::lang::{Param, ParamKind};
use serde::Serialize;
use std::io::{self, Write};

/// One parameter as JSON.
#[derive(Serialize)]
struct ParamJson<'a> {
    name: &'a str,
    description: Option<&'a str>,
    /// `"number" "choice" "switch" "color" "text" "other"`.
    kind: &'static str,
    /// Smallest and largest number.
    range: Option<[f64; 2]>,
    /// Whether only whole numbers are allowed.
    whole: bool,
    /// `"deg"` for angles.
    unit: Option<&'static str>,
    /// The values of a choice.
    choices: Option<&'a [String]>,
    default: &'a str,
    value: &'a str,
    /// Where it is declared.
    place: String,
}

/// Runs the command.
///
/// # Errors
/// The scene is wrong or can't be read, or standard output fails.
pub fn run(args: &ParamsArgs) -> Result<Exit, Stop> {
    let e = load(&request(&args.scene.file, &args.scene.set, &args.scene.allow_read)?, false)?;
    let text = if args.json {
        let all: Vec<ParamJson> = e.params.iter().map(|p| ParamJson::new(p, &e.sources)).collect();
        serde_json::to_string_pretty(&all).map_err(io::Error::from)? + "\n"
    } else {
        table(&e.params)
    };
    io::stdout().write_all(text.as_bytes())?;
    Ok(Exit::Done)
}

impl<'a> ParamJson<'a> {
    fn new(p: &'a Param, sources: &Sources) -> ParamJson<'a> {
        let mut json = ParamJson {
            name: &p.name,
            description: p.description.as_deref(),
            kind: kind_word(&p.kind),
            range: None,
            whole: false,
            unit: None,
            choices: None,
            default: &p.default,
            value: &p.value,
            place: sources.location(p.span),
        };
        match &p.kind {
            ParamKind::Number { range, whole, unit } => {
                json.range = range.map(|(a, b)| [a, b]);
                json.whole = *whole;
                json.unit = (!unit.is_empty()).then_some(unit);
            }
            ParamKind::Choice(choices) => json.choices = Some(choices),
            _ => {}
        }
        json
    }
}

fn kind_word(kind: &ParamKind) -> &'static str {
    match kind {
        ParamKind::Number { .. } => "number",
        ParamKind::Choice(_) => "choice",
        ParamKind::Switch => "switch",
        ParamKind::Color => "color",
        ParamKind::Text => "text",
        ParamKind::Other => "other",
    }
}

/// What a value may be, in words.
pub fn allowed(kind: &ParamKind) -> String {
    match kind {
        ParamKind::Number { range, whole, unit } => {
            let number = if *whole { "whole number" } else { "number" };
            match range {
                Some((a, b)) => format!("{number} from {a}{unit} to {b}{unit}"),
                None if unit.is_empty() => number.to_string(),
                None => "angle".to_string(),
            }
        }
        ParamKind::Choice(choices) => choices.join(" | "),
        ParamKind::Switch => "true | false".to_string(),
        ParamKind::Color => "color".to_string(),
        ParamKind::Text => "text".to_string(),
        ParamKind::Other => "expression".to_string(),
    }
}

/// One line a parameter: `name = value`, what is allowed, what it is for.
fn table(params: &[Param]) -> String {
    if params.is_empty() {
        return "the scene has no parameters\n".to_string();
    }
    let rows: Vec<[String; 3]> = params
        .iter()
        .map(|p| {
            let changed = if p.value == p.default { String::new() } else { format!(" (default {})", p.default) };
            let description = p.description.clone().unwrap_or_default();
            [format!("{} = {}{changed}", p.name, p.value), allowed(&p.kind), description]
        })
        .collect();
    let width = |i: usize| rows.iter().map(|r| r[i].chars().count()).max().unwrap_or(0);
    let (first, second) = (width(0), width(1));
    rows.iter().map(|[a, b, c]| format!("{a:<first$}  {b:<second$}  {c}").trim_end().to_string() + "\n").collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diag::{FileId, Span};

    fn param(name: &str, kind: ParamKind, value: &str, description: Option<&str>) -> Param {
        Param {
            name: name.into(),
            description: description.map(Into::into),
            kind,
            default: "1".into(),
            value: value.into(),
            number: None,
            color: None,
            span: Span::new(FileId(0), 0..1),
        }
    }

    #[test]
    fn a_table() {
        let count = ParamKind::Number { range: Some((10.0, 2000.0)), whole: true, unit: "" };
        let turn = ParamKind::Number { range: Some((0.0, 90.5)), whole: false, unit: "deg" };
        let params = [
            param("count", count, "50", Some("spheres on the spiral")),
            param("turn", turn, "1", None),
            param("style", ParamKind::Choice(vec!["matte".into(), "glass".into()]), "1", Some("skin")),
        ];
        let expected = "\
count = 50 (default 1)  whole number from 10 to 2000  spheres on the spiral
turn = 1                number from 0deg to 90.5deg
style = 1               matte | glass                 skin
";
        assert_eq!(table(&params), expected);
        assert_eq!(table(&[]), "the scene has no parameters\n");
    }
}
