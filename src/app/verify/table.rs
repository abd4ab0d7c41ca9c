//! What a run found, for people: in the terminal, or as a table in Markdown.

use super::report::{Checked, Machine, Measured, Report};
use crate::app::words::thousands;
use anstyle::{AnsiColor, Style};
use std::fmt::Write as _;

/// The first lines: version, size and machine.
pub fn heading(version: &str, size: &str, machine: &Machine) -> String {
    format!("rtdsl {version} on {}; {size} programme\n", machine.words())
}

/// One check: its figures, and how it ended.
pub fn block(check: &Checked) -> String {
    let (bold, plain) = (Style::new().bold(), Style::new().render_reset());
    let mut text = format!("\n{bold}{}{plain}: {}\n", check.name, check.what);
    let rows: Vec<[String; 3]> = check.figures.iter().map(|f| [f.what.clone(), value(f), bound(f)]).collect();
    let width = |c: usize| rows.iter().map(|r| r[c].chars().count()).max().unwrap_or(0);
    let (what, value, bound) = (width(0), width(1), width(2));
    for (row, figure) in rows.iter().zip(&check.figures) {
        let mut line = format!("  {:<what$}  {:>value$}  {:<bound$}", row[0], row[1], row[2]);
        if !figure.kept {
            let red = AnsiColor::Red.on_default().bold();
            let _ = write!(line, "  {red}out of bounds{plain}");
        }
        if let Some(spread) = spread(figure) {
            let _ = write!(line, "  {spread}");
        }
        let _ = writeln!(text, "{}", line.trim_end());
    }
    if let (false, Some(first)) = (check.kept, &check.first_failure) {
        let _ = writeln!(text, "  the first case out of bounds: {first}");
    }
    let kept = if check.kept { "within bounds" } else { "out of bounds" };
    let _ = writeln!(text, "  {} cases in {:.2} s: {kept}", thousands(check.cases), check.seconds);
    text
}

/// The last line.
pub fn footing(report: &Report) -> String {
    let broken: Vec<&str> = report.checks.iter().filter(|c| !c.kept).map(|c| c.name).collect();
    let n = report.checks.len();
    match broken.as_slice() {
        [] => format!("\nAll figures of {n} checks are within their bounds ({:.1} s).\n", report.seconds),
        broken => format!("\n{} of {n} checks are out of bounds: {}.\n", broken.len(), broken.join(", ")),
    }
}

/// The whole run as a table in Markdown.
pub fn markdown(report: &Report, command: &str) -> String {
    let mut text = format!(
        "Made by `{command}`: rtdsl {} on {}, {:.0} s. Scenes: {}.\n\n",
        report.version,
        report.machine.words(),
        report.seconds,
        if report.scenes.is_empty() { "none".into() } else { report.scenes.join(", ") }
    );
    text += "| check | figure | value | bound | kept | spread |\n|---|---|--:|---|---|---|\n";
    for check in &report.checks {
        let cases = format!("{} cases", thousands(check.cases));
        let _ = writeln!(text, "| **{}** | *{}*: {cases} | | | | |", check.name, cell(check.what));
        for f in &check.figures {
            let (spread, kept) = (spread(f).unwrap_or_default(), if f.kept { "yes" } else { "**no**" });
            let _ =
                writeln!(text, "| | {} | {} | {} | {kept} | {} |", cell(&f.what), value(f), bound(f), cell(&spread));
        }
    }
    text
}

/// Text that ends no cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('<', "&lt;")
}

fn value(f: &Measured) -> String {
    format!("{} {}", number(f.value), f.unit).trim_end().into()
}

fn bound(f: &Measured) -> String {
    match (f.at_most, f.at_least) {
        (Some(0.0), _) if f.unit.is_empty() => "none allowed".into(),
        (Some(x), _) => format!("at most {}", number(x)),
        (_, Some(x)) => format!("at least {}", number(x)),
        _ => String::new(),
    }
}

/// Counts whole, other numbers with three digits.
fn number(x: f64) -> String {
    let size = x.abs();
    match size {
        _ if x.fract() == 0.0 && size < 1e12 => format!("{}{}", if x < 0.0 { "-" } else { "" }, thousands(size as u64)),
        100.0..1e6 => format!("{x:.0}"),
        10.0..100.0 => format!("{x:.1}"),
        0.01..10.0 => format!("{x:.2}"),
        _ if !x.is_finite() => x.to_string(),
        _ => format!("{x:.2e}"),
    }
}

/// A histogram on one line: a bar for each power of two, from the first that counts to the last. Every bin that isn't empty
/// has a bar.
fn spread(f: &Measured) -> Option<String> {
    let bins = f.histogram.as_ref()?;
    let first = bins.iter().position(|b| b.1 > 0)?;
    let last = bins.iter().rposition(|b| b.1 > 0)?;
    let most = bins.iter().map(|b| b.1).max()?;
    let bar = |n: u64| match n {
        0 => ' ',
        _ => ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'][(n * 7 / most) as usize % 8],
    };
    let bars: String = bins[first..=last].iter().map(|b| bar(b.1)).collect();
    let edge = |i: usize| match bins[i].0 {
        None => "more".into(),
        Some(e) if e < 1.0 => format!("<1/{}", 1.0 / e),
        Some(e) => format!("<{e}"),
    };
    Some(if first == last { format!("all {}", edge(first)) } else { format!("{} {bars} {}", edge(first), edge(last)) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::{Bound, Figure, Histogram, Outcome};

    /// One figure within its bound, one not.
    fn check() -> Checked {
        let mut histogram = Histogram::new();
        [0.1, 0.2, 0.2, 1.5, 1.5, 1.5, 1.5, 1.5].iter().for_each(|e| histogram.add(*e));
        let error = Figure::new("t error | max", 1.5, "ulp", Bound::AtMost(4.0));
        let figures = vec![Figure { histogram: Some(histogram), ..error }, Figure::none_of("rays lost", 1234)];
        let outcome = Outcome { cases: 2000, figures, first_failure: Some("ray 7".into()) };
        Checked::new("kernel", "rays find spheres", 0.5, outcome)
    }

    #[test]
    fn a_check_for_people() {
        let text = anstream::adapter::strip_str(&block(&check())).to_string();
        let expected = "
kernel: rays find spheres
  t error | max  1.50 ulp  at most 4     <1/8 ▂▃  █ <2
  rays lost         1,234  none allowed  out of bounds
  the first case out of bounds: ray 7
  2,000 cases in 0.50 s: out of bounds
";
        assert_eq!(text, expected);
    }

    #[test]
    fn a_run_in_markdown() {
        let report = Report {
            schema: 1,
            version: "1.2.3",
            size: "quick",
            machine: Machine { arch: "a", os: "b", instructions: "common", lane_widths: vec![1], threads: 1 },
            scenes: vec!["x.scene".into()],
            kept: false,
            seconds: 2.0,
            checks: vec![check()],
        };
        let expected = "Made by `rtdsl verify`: rtdsl 1.2.3 on a b, common instructions, lanes of 1, 1 thread, 2 s. Scenes: x.scene.

| check | figure | value | bound | kept | spread |
|---|---|--:|---|---|---|
| **kernel** | *rays find spheres*: 2,000 cases | | | | |
| | t error \\| max | 1.50 ulp | at most 4 | yes | &lt;1/8 ▂▃  █ &lt;2 |
| | rays lost | 1,234 | none allowed | **no** |  |
";
        assert_eq!(markdown(&report, "rtdsl verify"), expected);
        assert_eq!(footing(&report), "\n1 of 1 checks are out of bounds: kernel.\n");
    }

    #[test]
    fn numbers_have_three_digits_or_are_whole() {
        let shown = [0.0, 4.0, 1_234_567.0, 0.4567, 12.345, 1e-9, f64::NAN].map(number);
        assert_eq!(shown, ["0", "4", "1,234,567", "0.46", "12.3", "1.00e-9", "NaN"]);
    }
}
