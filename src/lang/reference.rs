//! What can be looked up of the language, made from its tables: help for a terminal and chapters of `docs/language.md`.

use super::catalog::{TOPICS, Topic, catalog};
use super::limits::{ARROW_DEPTH, BRACKET_DEPTH, EXPRESSION_DEPTH, Limits};
use super::word::{Default, Kind, Param, Ty, Word};

/// Everything that [`help`] knows: the words of the language, its keywords and its operators.
pub fn topics() -> Vec<&'static str> {
    let words = catalog().iter().map(|w| w.name);
    words.chain(TOPICS.iter().flat_map(|t| t.names.iter().copied())).collect()
}

/// All about one topic as plain text that ends in a newline: how it is written, what it does, its parameters, an example,
/// and where to look next. Of the name of a parameter, whose it is. `None` if there is no such topic.
pub fn help(topic: &str) -> Option<String> {
    let word = catalog().iter().find(|w| w.name == topic);
    let own = word.map(|w| word_help(w)).or_else(|| TOPICS.iter().find(|t| t.names.contains(&topic)).map(topic_help));
    match (own, parameter_help(topic)) {
        (Some(own), Some(parameter)) => Some(format!("{own}\n{parameter}")),
        (own, parameter) => own.or(parameter),
    }
}

/// The names of all parameters, of which [`help`] tells too.
pub fn parameters() -> Vec<&'static str> {
    let params = catalog().iter().flat_map(|w| w.params);
    let mut names: Vec<&str> = params.filter(|p| !p.rest).map(|p| p.name).collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// The chapter of this title in Markdown, its words in the order of their table; `Keywords and signs` is one too. `None` if
/// there is no such chapter.
pub fn chapter(title: &str) -> Option<String> {
    match title {
        SIGNS => return Some(TOPICS.iter().map(topic_section).collect::<Vec<_>>().join("\n")),
        LIMITS => return Some(limits()),
        _ => {}
    }
    let words: Vec<&Word> = catalog().iter().copied().filter(|w| w.kind.title() == title).collect();
    match words.first()?.kind {
        Kind::ColorName => Some(color_names(&words)),
        _ => Some(words.iter().map(|w| word_section(w)).collect::<Vec<_>>().join("\n")),
    }
}

/// The topics of a chapter; of the colors' names none, for there are too many to read.
pub fn chapter_topics(title: &str) -> Vec<&'static str> {
    match title {
        SIGNS => TOPICS.iter().flat_map(|t| t.names.iter().copied()).collect(),
        _ => {
            let words = catalog().iter().filter(|w| w.kind.title() == title && w.kind != Kind::ColorName);
            words.map(|w| w.name).collect()
        }
    }
}

/// The titles of all chapters.
pub fn chapters() -> Vec<&'static str> {
    let mut titles: Vec<&str> = Vec::new();
    for w in catalog() {
        if !titles.contains(&w.kind.title()) {
            titles.push(w.kind.title());
        }
    }
    titles.extend([SIGNS, LIMITS]);
    titles
}

/// The chapter of what isn't a word.
const SIGNS: &str = "Keywords and signs";
/// The chapter of budgets.
const LIMITS: &str = "Limits";
/// Columns of help on a terminal.
const WIDTH: usize = 80;

fn word_help(w: &Word) -> String {
    let mut out = format!("{}\n\n{}", w.signature(), wrapped(w.doc, ""));
    if !w.params.is_empty() {
        let rows: Vec<[String; 3]> = w.params.iter().map(|p| [p.name.to_owned(), takes(p), default(p)]).collect();
        let width = rows.iter().map(|[name, ..]| name.chars().count()).max().unwrap_or(0);
        out += "\n";
        for ([name, takes, default], p) in rows.iter().zip(w.params) {
            let line = format!("{}: {takes}{default}", p.doc);
            let indent = " ".repeat(width + 4);
            out += &format!("  {name:<width$}  {}", wrapped(&line, &indent));
        }
    }
    let others = catalog().iter().filter(|o| o.kind == w.kind && o.name != w.name).map(|o| o.name);
    let see: Vec<&str> = if w.kind == Kind::ColorName { vec!["#", "rgb", "mix"] } else { others.collect() };
    out + &ending(w.example, &see)
}

/// Which words have a parameter of this name, and what it is to them; those to which it is the same stand together.
fn parameter_help(name: &str) -> Option<String> {
    let mut meanings: Vec<(String, Vec<&str>)> = Vec::new();
    for word in catalog() {
        let Some(p) = word.params.iter().find(|p| p.name == name && !p.rest) else { continue };
        let meaning = format!("{}: {}", p.doc, takes(p));
        match meanings.iter_mut().find(|(known, _)| *known == meaning) {
            Some((_, words)) => words.push(word.name),
            None => meanings.push((meaning, vec![word.name])),
        }
    }
    let of_one = |(meaning, words): &(String, Vec<&str>)| {
        format!("  {}      {}", wrapped(&words.join(", "), "  "), wrapped(meaning, "      "))
    };
    let text: String = meanings.iter().map(of_one).collect();
    (!text.is_empty()).then(|| format!("`{name}: …` is given to:\n\n{text}"))
}

fn topic_help(t: &Topic) -> String {
    format!("{}\n\n{}{}", t.form, wrapped(t.doc, ""), ending(t.example, t.see))
}

fn ending(example: &str, see: &[&str]) -> String {
    let example: String = example.lines().map(|l| format!("    {l}\n")).collect();
    let see = if see.is_empty() { String::new() } else { format!("\nSee also: {}", wrapped(&see.join(", "), "  ")) };
    format!("\nExample:\n{example}{see}")
}

/// `text` in lines of at most [`WIDTH`] columns, all but the first after `indent`.
fn wrapped(text: &str, indent: &str) -> String {
    let mut out = String::new();
    let mut column = indent.chars().count();
    for (i, word) in text.split(' ').enumerate() {
        let len = word.chars().count();
        if i > 0 && column + 1 + len > WIDTH {
            out += &format!("\n{indent}");
            column = indent.chars().count();
        } else if i > 0 {
            out.push(' ');
            column += 1;
        }
        out += word;
        column += len;
    }
    out + "\n"
}

/// `a number in scene units, above 0`
fn takes(p: &Param) -> String {
    let unit = match p.ty {
        Ty::Length => " in scene units",
        _ => "",
    };
    let range = match (p.range, p.ty) {
        (Some(b), Ty::Angle) => format!(", {}", b.text_in("deg")),
        (Some(b), _) => format!(", {}", b.text()),
        (None, _) => String::new(),
    };
    format!("{}{unit}{range}", p.ty.text())
}

fn default(p: &Param) -> String {
    let default = p.default.text();
    match default.as_str() {
        "" | "none" => String::new(),
        d => format!("; {d} unless given"),
    }
}

fn word_section(w: &Word) -> String {
    let mut out = format!("### `{}`\n\n```text\n{}\n```\n\n{}\n\n", w.name, w.signature(), w.doc);
    if !w.params.is_empty() {
        out += "| Name | Takes | Unless given | Meaning |\n|---|---|---|---|\n";
        for p in w.params {
            let name = if p.rest { format!("{}…", p.name) } else { p.name.to_owned() };
            let default = match p.default.text().as_str() {
                "" => "must be given".to_owned(),
                "none" => String::new(),
                d => format!("`{d}`"),
            };
            let by_position =
                if p.positional && p.default != Default::Required && !p.rest { "; *by position*" } else { "" };
            out += &format!("| `{name}` | {} | {default} | {}{by_position} |\n", takes(p), p.doc);
        }
        out += "\n";
    }
    out + &sample(w.example)
}

fn topic_section(t: &Topic) -> String {
    let names: Vec<String> = t.names.iter().map(|n| format!("`{n}`")).collect();
    format!("### {}\n\n```text\n{}\n```\n\n{}\n\n{}", names.join(" "), t.form, t.doc, sample(t.example))
}

fn sample(text: &str) -> String {
    format!("```scene\n{text}\n```\n")
}

/// All names with their codes, a few a line.
fn color_names(words: &[&Word]) -> String {
    let name = |w: &&Word| format!("`{}` {}", w.name, w.constant().map_or(String::new(), |v| v.color_code()));
    let rows = words.chunks(4).map(|row| {
        let mut cells: Vec<String> = row.iter().map(name).collect();
        cells.resize(4, String::new());
        format!("| {} |\n", cells.join(" | "))
    });
    format!("| | | | |\n|---|---|---|---|\n{}", rows.collect::<String>())
}

fn limits() -> String {
    let l = Limits::default();
    let rows: [(&str, u64); 18] = [
        ("bytes of one scene file", l.file_bytes as u64),
        ("imports within imports", l.import_depth as u64),
        ("brackets within brackets", BRACKET_DEPTH as u64),
        ("functions `=>` within each other", ARROW_DEPTH.into()),
        ("parts of an expression within each other", EXPRESSION_DEPTH.into()),
        ("steps: calls, turns of loops, values of lists", l.steps),
        ("calls within calls", l.call_depth as u64),
        ("values in one list", l.list_length as u64),
        ("lists, records and functions put into others", l.containers as u64),
        ("letters of one text", l.text_length as u64),
        ("letters of all texts", l.text_total as u64),
        ("shapes, lights and groups that are made; likewise patterns; likewise materials", l.objects as u64),
        ("shapes and lights in the scene, one that is used again counted again", l.instances),
        ("patterns within patterns", l.pattern_depth.into()),
        ("patterns that make up one pattern, one that is used again counted again", l.pattern_size),
        ("triangles of meshes and other surfaces, at all their places together", l.surfaces),
        ("dots of a picture file", l.image_texels),
        ("mistakes reported in one run", l.errors as u64),
    ];
    let rows: String = rows.iter().map(|(what, n)| format!("| {what} | {} |\n", grouped(*n))).collect();
    format!("| At most | |\n|---|---|\n{rows}")
}

/// `50,000,000`
fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let first = digits.len() % 3;
    let mut out = digits[..first].to_owned();
    for i in (first..digits.len()).step_by(3) {
        out += if out.is_empty() { "" } else { "," };
        out += &digits[i..i + 3];
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn every_topic_has_help_that_fits_a_terminal() {
        let all = topics();
        assert_eq!(all.iter().collect::<HashSet<_>>().len(), all.len(), "a topic stands twice");
        for topic in &all {
            let text = help(topic).unwrap_or_default();
            assert!(text.contains("Example:\n") && text.ends_with('\n'), "{topic}");
            let prose = text.split("Example:").next().unwrap_or("").lines().skip(1);
            assert!(prose.clone().all(|l| l.chars().count() <= WIDTH), "{topic}: {text}");
        }
        assert_eq!(help("no such topic"), None);
        assert!(TOPICS.iter().flat_map(|t| t.see).all(|s| all.contains(s)), "every `see also` exists");
    }

    #[test]
    fn help_reads_well() {
        let text = help("disc").unwrap_or_default();
        assert_eq!(
            text,
            "disc(at: [0, 0, 0], normal: [0, 1, 0], r: 1, hole: 0, mat: none, name: none)\n\n\
             A flat disc, or a ring when it has a `hole`.\n\n  \
             at      its center: a point `[x, y, z]`; [0, 0, 0] unless given\n  \
             normal  the direction that it faces: a direction `[x, y, z]`; [0, 1, 0] unless\n          given\n  \
             r       its radius: a number in scene units, above 0; 1 unless given\n  \
             hole    the radius of a hole in its middle: a number in scene units, at least\n          0; 0 unless given\n  \
             mat     its material; without one, the group's, or a plain gray: a material\n  \
             name    what messages and `explain` call it: a text\n\n\
             Example:\n    disc(r: 2, hole: 1)\n    light(at: [4, 8, 6])\n\n\
             See also: sphere, plane, box, cylinder, cone, torus, triangle, tetrahedron, mesh\n"
        );
    }

    #[test]
    fn chapters_hold_every_word_once() {
        let all: String = chapters().iter().filter_map(|t| chapter(t)).collect();
        for w in catalog().iter().filter(|w| w.kind != Kind::ColorName) {
            assert_eq!(
                all.matches(&format!("\n### `{}`\n", w.name)).count()
                    + usize::from(all.starts_with(&format!("### `{}`\n", w.name))),
                1,
                "{}",
                w.name
            );
        }
        assert!(all.contains("`rebeccapurple` #663399"));
        assert_eq!(chapter("no such chapter"), None);
        assert_eq!([7, 200, 1000, 50_000_000].map(grouped), ["7", "200", "1,000", "50,000,000"]);
    }
}
