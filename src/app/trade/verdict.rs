//! What the figures mean, in words: what no longer pays, what must hold and doesn't, and what to choose.

use super::axis::Axis;
use super::front::{self, knee, slope};
use super::point::Point;
use super::reference::Kind;
use super::setting::{Way, digits, number};
use super::sweep::Sweep;
use crate::film::metric::{Errors, Range};
use crate::verify::lower_limit;
use serde::Serialize;

/// The error by which settings are judged against each other: the largest of any pixel, which is what can be asked for.
pub fn judged(errors: &Errors) -> Range {
    errors.max
}

/// What is concluded from a sweep.
#[derive(Clone, Debug, Serialize)]
pub struct Verdict {
    /// The points that none dominates in time and largest error, from the fastest to the most exact.
    pub front: Vec<usize>,
    /// The same for the RMSE.
    pub front_rmse: Vec<usize>,
    /// The point of the front behind which accuracy gets dearer.
    pub knee: Option<usize>,
    /// How steeply each dial buys accuracy.
    pub slopes: Vec<Slope>,
    /// What isn't worth its time, and what is worth knowing.
    pub remarks: Vec<String>,
    /// What must hold and doesn't.
    pub violations: Vec<String>,
}

/// How the error falls with time along a dial: error ~ time^slope.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Slope {
    /// The dial.
    pub axis: Axis,
    /// Of the RMSE.
    pub rmse: f64,
    /// Of the largest error.
    pub max: f64,
}

/// What to choose for an error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Suggestion {
    /// The error that is to be kept, in codes.
    pub asked: f64,
    /// The number of the cheapest point that keeps it; `None` where none does.
    pub point: Option<usize>,
    /// Its largest error; of the most exact point where none keeps the error.
    pub at_most: f64,
}

/// Changes below this many codes are seen by no one: a fifth of what rounding to a code does.
const INVISIBLE: f64 = 0.1;
/// Times nearer than this aren't told apart: runs on one machine differ by as much.
const SAME_TIME: f64 = 0.03;
/// How improbable it must be that so many bounded pixels break their bound by chance, before it isn't put down to it.
const CHANCE: f64 = 1e-3;

impl Verdict {
    /// Of a sweep.
    pub fn of(sweep: &Sweep) -> Verdict {
        let places: Vec<_> = sweep.points.iter().map(|p| p.place(judged)).collect();
        let front = front::front(&places);
        let by_rmse: Vec<_> = sweep.points.iter().map(|p| p.place(|e| e.rmse)).collect();
        let slopes = sweep.rows.iter().filter(|(axis, _)| has_slope(*axis)).filter_map(|(axis, row)| {
            let of = |all: &[(f64, f64)]| slope(&row.iter().map(|&i| all[i]).collect::<Vec<_>>());
            Some(Slope { axis: *axis, rmse: of(&by_rmse)?, max: of(&places)? })
        });
        Verdict {
            knee: knee(&places, &front),
            front_rmse: front::front(&by_rmse),
            slopes: slopes.collect(),
            remarks: dials(sweep).into_iter().chain(dominated(sweep)).collect(),
            violations: violations(sweep),
            front,
        }
    }
}

/// Whether each position of a dial buys accuracy for its time: what a limit of recursion cuts off comes to an end instead.
fn has_slope(axis: Axis) -> bool {
    matches!(axis, Axis::Error | Axis::Samples | Axis::Adaptive | Axis::Time)
}

/// The largest error that a picture may have: as measured, with the truth's own uncertainty, or as it says of itself where it says
/// something of every pixel, whichever is less.
fn at_most(p: &Point) -> f64 {
    let measured = judged(&p.errors).most;
    match p.claim {
        Some(claim) if claim.open == 0 && claim.codes < measured => claim.codes,
        _ => measured,
    }
}

/// The cheapest point whose largest error is surely `asked` codes at most.
pub fn suggestion(points: &[Point], asked: f64) -> Suggestion {
    let keeps = |(_, p): &(usize, &Point)| at_most(p) <= asked;
    let cheapest = |a: &(usize, &Point), b: &(usize, &Point)| a.1.cost.seconds.total_cmp(&b.1.cost.seconds);
    match points.iter().enumerate().filter(keeps).min_by(cheapest) {
        Some((point, found)) => Suggestion { asked, point: Some(point), at_most: at_most(found) },
        None => {
            let least = points.iter().map(at_most).fold(f64::INFINITY, |a, b| if b < a { b } else { a });
            Suggestion { asked, point: None, at_most: least }
        }
    }
}

/// What turning depth, precision and certificates does.
fn dials(sweep: &Sweep) -> Vec<String> {
    let mut remarks = Vec::new();
    let own = &sweep.points[0];
    for (axis, row) in &sweep.rows {
        let points = row.iter().map(|&i| &sweep.points[i]);
        match axis {
            Axis::Depth => {
                let depth = own.setting.depth;
                let shallow = points.clone().find(|p| p.setting.depth < depth && p.change <= INVISIBLE);
                if let Some(p) = shallow {
                    let cost = costs(own.cost.seconds, p.cost.seconds);
                    remarks.push(format!(
                        "depth {depth} {cost} more than depth {} and changes nothing above {} in this scene",
                        p.setting.depth,
                        above(p.change)
                    ));
                }
                for p in points.filter(|p| p.setting.depth > depth) {
                    let cost = costs(p.cost.seconds, own.cost.seconds);
                    let deeper = p.setting.depth;
                    remarks.push(match p.change <= INVISIBLE {
                        true => format!(
                            "depth {deeper} {cost} more than depth {depth} and changes nothing above {} in this scene",
                            above(p.change)
                        ),
                        false => format!(
                            "depth {deeper} changes the picture by up to {}/255: the scene's limit of {depth} cuts light off",
                            number(p.change)
                        ),
                    });
                }
            }
            Axis::Precision => {
                for p in points.filter(|p| p.setting.precision != own.setting.precision) {
                    remarks.push(format!(
                        "{} takes {} the time and changes the picture by up to {}/255",
                        p.setting.words(&sweep.base),
                        share(p.cost.seconds / own.cost.seconds),
                        number(p.change)
                    ));
                }
            }
            Axis::Certificates => {
                for p in points {
                    let Way::Sampled(codes) = p.setting.way else { continue };
                    let with = sweep.points.iter().find(|q| q.setting.way == Way::Error(codes));
                    if let Some(with) = with {
                        remarks.push(format!(
                            "without certificates, max error {}/255 takes {} the time, and none of it is proved",
                            number(codes),
                            share(p.cost.seconds / with.cost.seconds)
                        ));
                    }
                }
            }
            Axis::Error | Axis::Samples | Axis::Adaptive | Axis::Time | Axis::Mixed => {}
        }
    }
    remarks
}

/// What another setting beats: no worse in time, in the largest error and in the RMSE, and better in one by more than times on one
/// machine differ.
fn dominated(sweep: &Sweep) -> Vec<String> {
    let figures = |p: &Point| [p.cost.seconds, p.errors.max.value, p.errors.rmse.value];
    let beats = |a: &Point, b: &Point| {
        let pairs = || figures(a).into_iter().zip(figures(b));
        pairs().all(|(a, b)| a <= b) && pairs().any(|(a, b)| a < b * (1.0 - SAME_TIME))
    };
    let mut order: Vec<&Point> = sweep.points.iter().collect();
    order.sort_by(|a, b| a.cost.seconds.total_cmp(&b.cost.seconds));
    let sentence = |p: &Point| {
        let better = sweep.points.iter().filter(|q| beats(q, p));
        let by = better.min_by(|a, b| a.errors.rmse.value.total_cmp(&b.errors.rmse.value))?;
        Some(format!(
            "{} is dominated: {} takes {} its time and errs by {}/255 instead of {}/255 (RMSE {} instead of {})",
            p.setting.words(&sweep.base),
            by.setting.words(&sweep.base),
            share(by.cost.seconds / p.cost.seconds),
            digits(by.errors.max.value),
            digits(p.errors.max.value),
            digits(by.errors.rmse.value),
            digits(p.errors.rmse.value)
        ))
    };
    order.into_iter().filter_map(sentence).collect()
}

/// What must hold and doesn't.
fn violations(sweep: &Sweep) -> Vec<String> {
    let mut out = Vec::new();
    let is_estimate = matches!(sweep.reference.kind, Kind::Grid { .. });
    for p in &sweep.points {
        let name = p.setting.words(&sweep.base);
        // A grid's uncertainty is an estimate, which refutes no proof.
        let Some(claim) = p.claim.filter(|_| !is_estimate) else { continue };
        if p.broken.proved > 0 {
            out.push(format!("{name}: {} pixels that were proved are further off than proved", p.broken.proved));
        }
        if lower_limit(p.broken.bounded as u64, claim.bounded as u64, CHANCE) > 1.0 - sweep.confidence {
            out.push(format!(
                "{name}: {} of {} bounded pixels are further off than said, too many for a confidence of {}",
                p.broken.bounded, claim.bounded, sweep.confidence
            ));
        }
        // Where nothing else is said, what is said of the whole picture must hold as it stands.
        let least = judged(&p.errors).least;
        if claim.bounded + claim.estimated + claim.open == 0 && least > claim.codes + INVISIBLE {
            out.push(format!("{name}: says {}/255 and errs by {}/255", number(claim.codes), number(least)));
        }
    }
    for (axis, row) in sweep.rows.iter().filter(|(axis, _)| axis.is_a_budget()) {
        // A limit beyond the scene's own makes another picture than the scene asks for.
        let row: Vec<&Point> =
            row.iter().map(|&i| &sweep.points[i]).filter(|p| p.setting.depth <= sweep.base.depth).collect();
        for pair in row.windows(2) {
            let [before, after] = [pair[0], pair[1]].map(|p| p.errors.rmse);
            if after.least > before.most {
                out.push(format!(
                    "{}: {} errs by more than {}, with an RMSE of {}/255 instead of {}/255",
                    axis.word(),
                    pair[1].setting.words(&sweep.base),
                    pair[0].setting.words(&sweep.base),
                    number(after.value),
                    number(before.value)
                ));
            }
        }
    }
    out
}

/// `costs 31 %`, or that it costs nothing that could be told.
fn costs(dearer: f64, cheaper: f64) -> String {
    let more = dearer / cheaper - 1.0;
    if more < SAME_TIME { "costs nothing".into() } else { format!("costs {:.0} %", 100.0 * more) }
}

/// Of a time.
fn share(ratio: f64) -> String {
    match ratio {
        _ if ratio < 0.995 => format!("{ratio:.2} of"),
        _ if ratio < 10.0 => format!("{ratio:.1} times"),
        _ => format!("{ratio:.0} times"),
    }
}

/// A bound for a change that is invisible: 16-bit codes tell no finer than this.
fn above(change: f64) -> String {
    if change == 0.0 { "0.004/255".into() } else { format!("{}/255", number(change)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_for_times() {
        assert_eq!(costs(1.31, 1.0), "costs 31 %");
        assert_eq!(costs(1.01, 1.0), "costs nothing");
        assert_eq!([0.4, 1.26, 12.3].map(share), ["0.40 of", "1.3 times", "12 times"]);
    }
}
