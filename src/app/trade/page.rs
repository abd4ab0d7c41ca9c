//! The page that shows everything: `index.html`, which needs no other file.

use super::image::{GAIN, difference, link};
use super::report::Report;
use super::setting::number;
use super::sweep::Sweep;
use super::table::{HEADS, cells, conclusions, heading, recommendation};
use minijinja::Environment;
use serde::Serialize;
use std::io;

/// What the template is given.
#[derive(Serialize)]
struct Page<'p> {
    /// The scene's name without its folder.
    scene: &'p str,
    /// A few lines: what was measured, where, against what.
    heading: Vec<String>,
    recommendation: Vec<String>,
    /// The plot; well-formed.
    plot: &'p str,
    heads: [&'static str; 13],
    rows: Vec<Line>,
    conclusions: Vec<String>,
    violations: &'p [String],
    left_out: Vec<String>,
    pictures: Vec<Shown>,
    reference: String,
    width: u32,
    height: u32,
    gain: u8,
}

/// A line of the table.
#[derive(Serialize)]
struct Line {
    cells: [String; 13],
    front: bool,
    knee: bool,
    own: bool,
}

/// A picture and how it differs from the truth.
#[derive(Serialize)]
struct Shown {
    name: String,
    why: String,
    picture: String,
    difference: String,
    error: String,
}

/// The page, with the plot in it.
///
/// # Errors
/// A picture can't be encoded, or the template doesn't fit.
pub fn page(sweep: &Sweep, report: &Report, plot: &str) -> io::Result<String> {
    let verdict = &report.verdict;
    let truth = sweep.reference.truth.written();
    let mut chosen: Vec<(usize, &str)> = Vec::new();
    let all = [
        (verdict.front.first().copied(), "the fastest"),
        (verdict.knee, "the knee"),
        (verdict.front.last().copied(), "the most exact"),
        (report.suggestions.iter().filter(|_| report.asked).find_map(|s| s.point), "what is suggested"),
        (Some(0), "the scene's own"),
    ];
    for (point, why) in all {
        if let Some(point) = point
            && chosen.iter().all(|(i, _)| *i != point)
        {
            chosen.push((point, why));
        }
    }
    let shown = |(i, why): (usize, &str)| -> io::Result<Shown> {
        let codes = &sweep.points[i].codes;
        Ok(Shown {
            name: report.points[i].setting.clone(),
            why: why.into(),
            picture: link(codes, report.size)?,
            difference: link(&difference(codes, &truth), report.size)?,
            error: number(report.points[i].max[0]),
        })
    };
    // From the fastest on.
    let mut order: Vec<usize> = (0..report.points.len()).collect();
    order.sort_by(|&i, &j| report.points[i].cost.seconds.total_cmp(&report.points[j].cost.seconds));
    let line = |i: usize| Line {
        cells: cells(&report.points[i]),
        front: report.points[i].front,
        knee: verdict.knee == Some(i),
        own: i == 0,
    };
    let page = Page {
        scene: report.scene.rsplit(['/', '\\']).next().unwrap_or_default(),
        heading: heading(report).lines().map(String::from).collect(),
        recommendation: recommendation(report).lines().map(String::from).collect(),
        plot,
        heads: HEADS,
        rows: order.into_iter().map(line).collect(),
        conclusions: conclusions(report),
        violations: &verdict.violations,
        left_out: report.left_out.iter().map(|l| format!("{}: {}", l.setting, l.why)).collect(),
        pictures: chosen.into_iter().map(shown).collect::<io::Result<_>>()?,
        reference: link(&truth, report.size)?,
        width: report.size[0],
        height: report.size[1],
        gain: GAIN,
    };
    let mut env = Environment::new();
    // By the name's ending, values are escaped.
    env.add_template("trade.html", include_str!("templates/trade.html")).map_err(io::Error::other)?;
    let template = env.get_template("trade.html").map_err(io::Error::other)?;
    template
        .render(minijinja::Value::from(minijinja::value::Serde(page)))
        .map(|html| html + "\n")
        .map_err(io::Error::other)
}
