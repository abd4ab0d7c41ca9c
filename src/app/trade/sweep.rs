//! Turns one dial after another and measures each position, for as long as the budget lasts.

use super::axis::Axis;
use super::maker::{Made, Maker};
use super::plan::positions;
use super::point::{Broken, Point};
use super::reference::Reference;
use super::setting::{Setting, Way, number};
use crate::film::metric::{Errors, change, written};
use crate::scene::Accuracy;
use serde::Serialize;

/// What was measured.
pub struct Sweep {
    /// The scene's own setting, the first of the points.
    pub base: Setting,
    /// The probability with which bounded pixels are to keep their error.
    pub confidence: f64,
    /// What all were measured against.
    pub reference: Reference,
    /// The settings that were measured.
    pub points: Vec<Point>,
    /// The dials, each with the numbers of its points from the cheapest to the dearest.
    pub rows: Vec<(Axis, Vec<usize>)>,
    /// What wasn't measured.
    pub left_out: Vec<LeftOut>,
}

/// A setting that wasn't measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LeftOut {
    /// The dial.
    pub axis: Axis,
    /// The setting in words.
    pub setting: String,
    /// Why.
    pub why: String,
    /// Whether it was begun.
    pub unfinished: bool,
}

/// Told of what is measured.
pub trait Told {
    /// So many steps more are to come.
    fn expect(&self, steps: usize);
    /// A step begins.
    fn begin(&self, what: &'static str);
    /// It is done.
    fn end(&self);
}

/// Most times that a setting is made: the least of five runs is within a few per cent of what the machine can do.
const MOST_RUNS: u32 = 5;
/// A setting may be begun if it is expected to take this share of what is left: expectations err, and cheaper ones of other
/// dials are to follow.
const SHARE: f64 = 0.5;
/// The share of what is left that a setting may take of which nothing is expected.
const UNKNOWN_SHARE: f64 = 0.15;
/// A picture that takes less than this share of what is left is made several times at once.
const NOTHING: f64 = 0.001;
/// All are made again if that is expected to take this share of what is left.
const REPEAT_SHARE: f64 = 0.8;
/// Depth and precision change the time by less than this, or the other way.
const ROOM: f64 = 1.5;

/// Measures the positions of `axes` around `base`. `None` where the user wanted no more before there was anything to compare.
pub fn sweep(maker: &Maker<'_>, base: Setting, axes: &[Axis], told: &dyn Told) -> Option<Sweep> {
    let plans: Vec<(Axis, Vec<Setting>)> = axes.iter().map(|axis| (*axis, positions(*axis, &base))).collect();
    let steps = plans.iter().map(|(_, settings)| settings.len()).sum::<usize>();
    told.expect(steps + 2);
    told.begin("the scene's own setting");
    let first = maker.make(&base, f64::INFINITY)?;
    told.end();
    told.begin("the reference");
    let reference = Reference::make(maker, &base, first.cost.seconds)?;
    told.end();

    let own = first.pixels.clone();
    let confidence = maker.options.accuracy.map_or(Accuracy::CONFIDENCE, |a| a.confidence);
    let mut sweep = Sweep { base, confidence, reference, points: Vec::new(), rows: Vec::new(), left_out: Vec::new() };
    let base_point = sweep.add(base, first, &own);
    sweep.settle(maker, base_point);
    let longest = plans.iter().map(|(_, settings)| settings.len()).max().unwrap_or(0);
    let mut rows: Vec<Vec<Option<usize>>> = vec![Vec::new(); plans.len()];
    // The cheapest of every dial first, so that a small budget still tells of all of them.
    for step in 0..longest {
        for ((axis, settings), row) in plans.iter().zip(&mut rows) {
            let Some(setting) = settings.get(step).filter(|_| !maker.budget.is_interrupted()) else { continue };
            told.begin(axis.word());
            row.push(sweep.measure(maker, *axis, setting, &own));
            told.end();
        }
    }
    sweep.rows = axes.iter().copied().zip(rows.into_iter().map(|row| row.into_iter().flatten().collect())).collect();
    for (axis, row) in &sweep.rows {
        row.iter().for_each(|&i| sweep.points[i].axes.push(*axis));
    }
    sweep.repeat(maker, told);
    Some(sweep)
}

impl Sweep {
    fn add(&mut self, setting: Setting, made: Made, own: &[[f32; 3]]) -> usize {
        let Made { pixels, cost, claim, certified } = made;
        let codes = written(&pixels);
        let truth = &self.reference.truth;
        self.points.push(Point {
            setting,
            axes: Vec::new(),
            cost,
            claim,
            broken: Broken::count(&codes, &certified, truth),
            errors: Errors::of(&codes, truth, &self.reference.seen),
            change: change(own, &pixels),
            codes,
        });
        self.points.len() - 1
    }

    /// The number of the setting's point; `None` where it is left out.
    fn measure(&mut self, maker: &Maker<'_>, axis: Axis, setting: &Setting, own: &[[f32; 3]]) -> Option<usize> {
        if let Some(known) = self.points.iter().position(|p| p.setting == *setting) {
            return Some(known);
        }
        if let Some(done) = self.done_before(setting) {
            let why = format!("the picture is as good as it gets after {} s", number(done));
            self.left_out.push(LeftOut { axis, setting: setting.words(&self.base), why, unfinished: false });
            return None;
        }
        let left = maker.budget.left();
        let expected = self.expected(setting);
        let room = SHARE * left;
        let cheaper = self.left_out.iter().find(|l| l.axis == axis && l.unfinished);
        let why = match (expected, cheaper) {
            _ if left <= 0.0 => Some("the budget is spent".into()),
            (_, Some(l)) => Some(format!("{} wasn't finished", l.setting)),
            (Some(seconds), _) if seconds > room => {
                Some(format!("expected to take {} s, and {} s are left", number(seconds), number(left)))
            }
            _ => None,
        };
        // What takes far longer than expected mustn't eat up the rest.
        let limit = if expected.is_some() { room } else { UNKNOWN_SHARE * left };
        let unfinished = why.is_none();
        let why = match why {
            Some(why) => why,
            None => match maker.make(setting, limit) {
                Some(made) => {
                    let point = self.add(*setting, made, own);
                    self.settle(maker, point);
                    return Some(point);
                }
                None if maker.budget.is_interrupted() => return None,
                None => format!("not finished in {} s", number(left - maker.budget.left())),
            },
        };
        self.left_out.push(LeftOut { axis, setting: setting.words(&self.base), why, unfinished });
        None
    }

    /// The time of a picture that didn't need all that it was given, where `setting` would give it more.
    fn done_before(&self, setting: &Setting) -> Option<f64> {
        let Way::Time(more) = setting.way else { return None };
        self.points.iter().find_map(|p| match p.setting.way {
            // What ends later than its time is told by the clock, not by the last error.
            Way::Time(given) if given < more && p.cost.seconds < 0.9 * given => Some(p.cost.seconds),
            _ => None,
        })
    }

    /// Seconds that a setting will take, from those that were measured; `None` where nothing tells.
    fn expected(&self, setting: &Setting) -> Option<f64> {
        let seconds = |p: &Point| p.cost.seconds;
        match setting.way {
            _ if setting.way == self.base.way => Some(ROOM * seconds(&self.points[0])),
            Way::Grid(n) => {
                let measured = self.points.iter().rev().find_map(|p| match p.setting.way {
                    Way::Grid(m) => Some(seconds(p) * (n * n) as f64 / (m * m) as f64),
                    _ => None,
                });
                // Nothing cheaper than this is swept.
                measured.or(Some(ROOM * seconds(&self.points[0]) * (n * n) as f64))
            }
            Way::Adaptive(n) => {
                let mut measured = self.points.iter().rev();
                let measured = measured.find_map(|p| match p.setting.way {
                    Way::Adaptive(m) => Some(seconds(p) * n as f64 / m as f64),
                    _ => None,
                });
                // No more than all pixels would take.
                measured.or(Some(ROOM * seconds(&self.points[0]) * n as f64))
            }
            Way::Error(codes) => {
                let known = self.reference.climb.expected(codes);
                let mut measured = self.points.iter().rev().filter(|p| matches!(p.setting.way, Way::Error(_)));
                match (measured.next(), measured.next()) {
                    (Some(last), Some(before)) => {
                        let growth = seconds(last) / seconds(before);
                        let on = seconds(last) * if growth > 1.0 { growth } else { 1.0 };
                        Some(if on < known { on } else { known })
                    }
                    _ => Some(known),
                }
            }
            Way::Time(seconds) => Some(seconds),
            Way::Sampled(_) => None,
        }
    }

    /// Makes a picture again that takes next to nothing: the first time, memory and caches are cold.
    fn settle(&mut self, maker: &Maker<'_>, point: usize) {
        let point = &mut self.points[point];
        while point.cost.runs < MOST_RUNS && point.cost.seconds < NOTHING * maker.budget.left() {
            let Some(made) = maker.make(&point.setting, f64::INFINITY) else { return };
            point.cost = point.cost.or(&made.cost);
        }
    }

    /// Makes all of them again, as often as the budget allows: times scatter, and the least says most.
    fn repeat(&mut self, maker: &Maker<'_>, told: &dyn Told) {
        // What is given a time takes that time.
        let mut again: Vec<usize> = (0..self.points.len()).collect();
        again.retain(|&i| !matches!(self.points[i].setting.way, Way::Time(_)) && self.points[i].cost.runs < MOST_RUNS);
        while !again.is_empty() {
            let seconds: f64 = again.iter().map(|&i| self.points[i].cost.seconds).sum();
            if seconds > REPEAT_SHARE * maker.budget.left() {
                return;
            }
            told.expect(again.len());
            for &i in &again {
                told.begin("times again");
                let Some(made) = maker.make(&self.points[i].setting, f64::INFINITY) else { return };
                self.points[i].cost = self.points[i].cost.or(&made.cost);
                told.end();
            }
            again.retain(|&i| self.points[i].cost.runs < MOST_RUNS);
        }
    }
}
