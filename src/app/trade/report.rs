//! What a sweep found, as data: `trade.json` and `trade.csv`. `docs/trade.md` tells of every field.

use super::axis::Axis;
use super::maker::{Claim, Cost};
use super::point::Point;
use super::reference::Kind;
use super::setting::{Setting, Way};
use super::sweep::{LeftOut, Sweep};
use super::verdict::{Suggestion, Verdict};
use crate::app::verify::report::Machine;
use crate::app::view::precision_word;
use crate::film::metric::{Errors, Range};
use serde::Serialize;

/// A whole sweep.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Counts up when a field changes its meaning or goes away.
    pub schema: u32,
    /// Version of rtdsl.
    pub version: &'static str,
    /// The scene's name.
    pub scene: String,
    /// Width and height of the pictures, in pixels.
    pub size: [u32; 2],
    /// Where it ran.
    pub machine: Machine,
    /// Threads that pictures were traced with.
    pub threads: usize,
    /// Seconds that it was allowed to take.
    pub budget: f64,
    /// Seconds that it took.
    pub seconds: f64,
    /// Whether it was ended before it was done.
    pub interrupted: bool,
    /// What all pictures were measured against.
    pub reference: ReferenceRow,
    /// Pixels of FLIP's picture that fill a degree of the eye's field.
    pub pixels_per_degree: f64,
    /// The settings; the first is the scene's own.
    pub points: Vec<Row>,
    /// The dials, each with the numbers of its points from the cheapest to the dearest.
    pub axes: Vec<(Axis, Vec<usize>)>,
    /// What was concluded.
    #[serde(flatten)]
    pub verdict: Verdict,
    /// What wasn't measured.
    pub left_out: Vec<LeftOut>,
    /// What to choose: for the error that was asked for, or for each that has a name.
    pub suggestions: Vec<Suggestion>,
    /// Whether an error was asked for.
    pub asked: bool,
}

/// What all pictures were measured against.
#[derive(Clone, Debug, Serialize)]
pub struct ReferenceRow {
    /// How it was made.
    #[serde(flatten)]
    pub kind: Kind,
    /// The same in words.
    pub words: String,
    /// The largest uncertainty of any pixel, in codes.
    pub uncertainty: f64,
    /// The root of the mean of its square.
    pub uncertainty_rms: f64,
    /// Seconds that it took.
    pub seconds: f64,
}

/// A setting that was measured.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// In words.
    pub setting: String,
    /// In a few characters.
    pub label: String,
    /// The arguments of `rtdsl render`; `null` for what only this sweep does.
    pub arguments: Option<String>,
    /// The dials of which it is a position.
    pub axes: Vec<Axis>,
    /// What decides how many rays a pixel gets.
    pub way: Way,
    /// Recursion limit.
    pub depth: u32,
    /// `"f64"` or `"f32"`.
    pub precision: &'static str,
    /// What it took.
    #[serde(flatten)]
    pub cost: Cost,
    /// The largest error, in codes; then the truth's uncertainty taken off and added.
    pub max: [f64; 3],
    /// The 99th percentile of the pixels' errors, likewise.
    pub p99: [f64; 3],
    /// The root of the mean square, likewise.
    pub rmse: [f64; 3],
    /// In decibels; `null` where it is infinite.
    pub psnr: f64,
    /// Mean of (x - r)² / (r² + 0.01) in linear light.
    pub rel_mse: f64,
    /// Mean of FLIP.
    pub flip: f64,
    /// The largest change of the scene's own picture, in codes.
    pub change: f64,
    /// What the picture says of its own error.
    pub claim: Option<Claim>,
    /// Pixels that break that: proved, bounded, estimated ones.
    pub broken: [usize; 3],
    /// Whether no other setting is better in time and largest error.
    pub front: bool,
}

impl Row {
    fn new(point: &Point, base: &Setting, front: bool) -> Row {
        let range = |r: Range| [r.value, r.least, r.most];
        let Errors { max, p99, rmse, psnr, rel_mse, flip } = point.errors;
        let broken = point.broken;
        Row {
            setting: point.setting.words(base),
            label: point.setting.label(base),
            arguments: point.setting.arguments(base),
            axes: point.axes.clone(),
            way: point.setting.way,
            depth: point.setting.depth,
            precision: precision_word(point.setting.precision),
            cost: point.cost,
            max: range(max),
            p99: range(p99),
            rmse: range(rmse),
            psnr,
            rel_mse,
            flip,
            change: point.change,
            claim: point.claim,
            broken: [broken.proved, broken.bounded, broken.estimated],
            front,
        }
    }
}

/// The rows of all points.
pub fn rows(sweep: &Sweep, verdict: &Verdict) -> Vec<Row> {
    let row = |(i, p)| Row::new(p, &sweep.base, verdict.front.contains(&i));
    sweep.points.iter().enumerate().map(row).collect()
}

/// The reference.
pub fn reference_row(sweep: &Sweep) -> ReferenceRow {
    let truth = &sweep.reference.truth;
    let squares: f64 = truth.uncertainty.iter().map(|u| u * u).sum();
    ReferenceRow {
        kind: sweep.reference.kind,
        words: sweep.reference.words(),
        uncertainty: truth.worst(),
        uncertainty_rms: (squares / truth.uncertainty.len().max(1) as f64).sqrt(),
        seconds: sweep.reference.seconds,
    }
}

impl Report {
    /// As a table with commas, a line for each point; texts with commas in quotes (RFC 4180).
    pub fn csv(&self) -> String {
        let mut text = String::from(
            "setting,arguments,axes,depth,precision,seconds,cpu_seconds,runs,camera_rays,rays,bounds,max,max_least,max_most,\
             p99,rmse,rmse_least,rmse_most,psnr,rel_mse,flip,change,claim,proved,bounded,estimated,open,front\r\n",
        );
        for row in &self.points {
            let axes: Vec<&str> = row.axes.iter().map(|a| a.word()).collect();
            let or_empty = |n: Option<String>| n.unwrap_or_default();
            let claim = |f: fn(&Claim) -> f64| or_empty(row.claim.as_ref().map(|c| f(c).to_string()));
            let cells = [
                row.setting.clone(),
                or_empty(row.arguments.clone()),
                axes.join(" "),
                row.depth.to_string(),
                row.precision.into(),
                row.cost.seconds.to_string(),
                or_empty(row.cost.cpu_seconds.map(|s| s.to_string())),
                row.cost.runs.to_string(),
                row.cost.camera_rays.to_string(),
                row.cost.rays.to_string(),
                row.cost.bounds.to_string(),
                row.max[0].to_string(),
                row.max[1].to_string(),
                row.max[2].to_string(),
                row.p99[0].to_string(),
                row.rmse[0].to_string(),
                row.rmse[1].to_string(),
                row.rmse[2].to_string(),
                row.psnr.to_string(),
                row.rel_mse.to_string(),
                row.flip.to_string(),
                row.change.to_string(),
                claim(|c| c.codes),
                claim(|c| c.proved as f64),
                claim(|c| c.bounded as f64),
                claim(|c| c.estimated as f64),
                claim(|c| c.open as f64),
                row.front.to_string(),
            ];
            text += &cells.map(|cell| quoted(&cell)).join(",");
            text += "\r\n";
        }
        text
    }

    /// Whether all that must hold holds, and a setting that was asked for was found.
    pub fn is_met(&self) -> bool {
        let is_found = self.suggestions.iter().all(|s| s.point.is_some());
        self.verdict.violations.is_empty() && (!self.asked || is_found)
    }
}

fn quoted(cell: &str) -> String {
    match cell.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", cell.replace('"', "\"\"")),
        false => cell.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_survive() {
        assert_eq!(quoted("grid 2×2, f32"), "\"grid 2×2, f32\"");
        assert_eq!(quoted("a\"b"), "\"a\"\"b\"");
        assert_eq!(quoted("plain"), "plain");
    }
}
