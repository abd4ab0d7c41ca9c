//! A sweep for people, in the terminal.

use super::report::{Report, Row};
use super::setting::{digits, number};
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
    for slope in &report.verdict.slopes {
        let _ = writeln!(
            text,
            "{}: RMSE ~ time^{:.2}, largest error ~ time^{:.2}",
            slope.axis.word(),
            slope.rmse,
            slope.max
        );
    }
    for remark in &report.verdict.remarks {
        let _ = writeln!(text, "{remark}");
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

/// The last line: what to choose.
pub fn recommendation(report: &Report) -> String {
    let named = |i: usize| {
        let row = &report.points[i];
        let asked = row.arguments.as_ref().map_or(String::new(), |a| format!(" ({a})"));
        format!("{}{asked}, {}", row.setting, duration((row.cost.seconds * 1e6) as u64))
    };
    match (report.asked, &report.suggestion) {
        (Some(asked), Some(s)) => format!(
            "for {}/255: {}: at most {}/255, a margin of {}/255\n",
            number(asked),
            named(s.point),
            number(s.at_most),
            number(s.margin)
        ),
        (Some(asked), None) => {
            let best = report.points.iter().map(|p| p.max[2]).fold(f64::INFINITY, |a, b| if b < a { b } else { a });
            format!(
                "for {}/255: none of these settings keeps it; the best is at most {}/255\n",
                number(asked),
                number(best)
            )
        }
        (None, _) => match report.verdict.knee {
            Some(knee) => {
                format!(
                    "the knee: {}: errs by {}/255; what is dearer buys less for its time\n",
                    named(knee),
                    number(report.points[knee].max[0])
                )
            }
            None => match (report.verdict.front.first(), report.verdict.front.last()) {
                (Some(&fast), Some(&exact)) if fast != exact => {
                    format!("no knee: from {} to {} accuracy has one price\n", named(fast), named(exact))
                }
                (Some(&only), _) => format!("the only one worth its time: {}\n", named(only)),
                _ => String::new(),
            },
        },
    }
}
