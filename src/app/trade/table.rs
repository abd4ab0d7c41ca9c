//! A sweep for people, in the terminal.

use super::report::{Report, Row};
use super::setting::{digits, number};
use super::verdict::{Slope, Suggestion};
use crate::app::verify::report::Machine;
use crate::app::words::{duration, thousands};
use anstyle::{AnsiColor, Style};
use std::fmt::Write as _;

/// The heads of the table's columns.
pub const HEADS: [&str; 13] =
    ["setting", "wall", "cpu", "runs", "camera rays", "bounds", "max", "±", "p99", "RMSE", "PSNR", "relMSE", "FLIP"];

/// A point in words, a cell for each of [`HEADS`].
pub fn cells(row: &Row) -> [String; 13] {
    let time = |seconds: f64| duration((seconds * 1e6) as u64);
    [
        row.setting.clone(),
        time(row.cost.seconds),
        row.cost.cpu_seconds.map_or("–".into(), time),
        row.cost.runs.to_string(),
        thousands(row.cost.camera_rays),
        if row.cost.bounds == 0 { "–".into() } else { thousands(row.cost.bounds) },
        digits(row.max[0]),
        digits(half(row.max)),
        digits(row.p99[0]),
        digits(row.rmse[0]),
        if row.psnr.is_finite() { format!("{:.1}", row.psnr) } else { "∞".into() },
        format!("{:.1e}", row.rel_mse),
        format!("{:.4}", row.flip),
    ]
}

/// How far the truth may be from the value, the larger way.
fn half([value, least, most]: [f64; 3]) -> f64 {
    let (down, up) = (value - least, most - value);
    if down > up { down } else { up }
}

/// The first lines: what was measured, where, against what.
pub fn heading(report: &Report) -> String {
    let Report { version, scene, size: [width, height], budget, seconds, .. } = report;
    let machine = Machine::words(&report.machine);
    let mut text = format!(
        "rtdsl {version} on {machine}\n{scene}, {width}×{height}, {} points in {seconds:.1} s of {} s\n",
        report.points.len(),
        number(*budget)
    );
    let reference = &report.reference;
    let _ = writeln!(
        text,
        "reference: {}; it is known to {}/255, on the average (RMS) to {}/255",
        reference.words,
        number(reference.uncertainty),
        number(reference.uncertainty_rms)
    );
    text + "errors in codes of 8 bits (n/255) of the written picture, whose rounding alone is up to 0.5\n"
}

/// The table, and what follows from it.
pub fn body(report: &Report) -> String {
    let (bold, plain) = (Style::new().bold(), Style::new().render_reset());
    let lines: Vec<[String; 13]> =
        std::iter::once(HEADS.map(String::from)).chain(report.points.iter().map(cells)).collect();
    let width = |c: usize| lines.iter().map(|l| l[c].chars().count()).max().unwrap_or(0);
    let widths: [usize; 13] = std::array::from_fn(width);
    let mut order: Vec<usize> = (0..report.points.len()).collect();
    order.sort_by(|&i, &j| report.points[i].cost.seconds.total_cmp(&report.points[j].cost.seconds));
    let line = |cells: &[String; 13]| {
        let mut text = String::new();
        for (c, (cell, width)) in cells.iter().zip(widths).enumerate() {
            let _ = match c {
                0 => write!(text, "{cell:<width$}"),
                _ => write!(text, "  {cell:>width$}"),
            };
        }
        text
    };
    let mut text = format!("\n{bold}{}{plain}\n", line(&lines[0]));
    for i in order {
        let mut marks = Vec::new();
        if report.points[i].front {
            marks.push("front");
        }
        if report.verdict.knee == Some(i) {
            marks.push("knee");
        }
        if i == 0 {
            marks.push("the scene's own");
        }
        let row = line(&lines[i + 1]);
        let _ = match report.points[i].front {
            true => writeln!(text, "{bold}{row}{plain}  {}", marks.join(", ")),
            false => writeln!(text, "{}", format!("{row}  {}", marks.join(", ")).trim_end()),
        };
    }
    text.push('\n');
    for line in conclusions(report) {
        let _ = writeln!(text, "{line}");
    }
    for out in &report.left_out {
        let _ = writeln!(text, "left out: {}: {}", out.setting, out.why);
    }
    let red = AnsiColor::Red.on_default().bold();
    for violation in &report.verdict.violations {
        let _ = writeln!(text, "{red}doesn't hold{plain}: {violation}");
    }
    text
}

/// What follows from the figures, a sentence a line.
pub fn conclusions(report: &Report) -> Vec<String> {
    let slope = |s: &Slope| format!("{}: RMSE ~ time^{:.2}, largest error ~ time^{:.2}", s.axis.word(), s.rmse, s.max);
    let slopes = report.verdict.slopes.iter().map(slope);
    slopes.chain([bend(report)]).chain(report.verdict.remarks.iter().cloned()).filter(|line| !line.is_empty()).collect()
}

/// The last lines: what to choose.
pub fn recommendation(report: &Report) -> String {
    let line = |s: &Suggestion| match s.point {
        Some(point) => format!(
            "for {}/255: {}: at most {}/255, a margin of {}/255\n",
            number(s.asked),
            named(&report.points[point]),
            number(s.at_most),
            number(s.asked - s.at_most)
        ),
        None => format!(
            "for {}/255: none of these settings surely keeps it; the best errs by {}/255 at most\n",
            number(s.asked),
            number(s.at_most)
        ),
    };
    report.suggestions.iter().map(line).collect()
}

/// Where accuracy begins to get dearer.
fn bend(report: &Report) -> String {
    match (report.verdict.knee, report.verdict.front.as_slice()) {
        (Some(knee), _) => {
            let row = &report.points[knee];
            format!("the knee: {}: errs by {}/255; beyond it time buys less", named(row), digits(row.max[0]))
        }
        (None, [fast, .., exact]) => {
            let [fast, exact] = [*fast, *exact].map(|i| &report.points[i]);
            format!("no knee: from {} to {} the front doesn't bend towards less", named(fast), named(exact))
        }
        (None, _) => String::new(),
    }
}

/// A setting, how to ask for it, and its time.
fn named(row: &Row) -> String {
    let asked = row.arguments.as_ref().map_or(String::new(), |a| format!(" ({a})"));
    format!("{}{asked}, {}", row.setting, duration((row.cost.seconds * 1e6) as u64))
}
