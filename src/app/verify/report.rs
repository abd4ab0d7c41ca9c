//! What a run of the programme found, as data: `--json`. `docs/verify.md` tells of every field.

use crate::render::{Instructions, instructions, rays_at_a_time};
use crate::scene::Precision;
use crate::verify::{Bound, Figure, Histogram, Outcome, Size};
use serde::Serialize;

/// A whole run.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Counts up when a field changes its meaning or goes away.
    pub schema: u32,
    /// Version of rtdsl.
    pub version: &'static str,
    /// `"quick"` or `"extremes"`.
    pub size: &'static str,
    /// Where it ran.
    pub machine: Machine,
    /// Names of the scenes whose pictures were checked.
    pub scenes: Vec<String>,
    /// Whether every figure keeps its bound.
    pub kept: bool,
    /// Wall-clock seconds.
    pub seconds: f64,
    /// The checks, in the order of the programme.
    pub checks: Vec<Checked>,
}

/// What a machine brings with it.
#[derive(Clone, Debug, Serialize)]
pub struct Machine {
    /// Its family, as `x86_64`.
    pub arch: &'static str,
    /// Its system, as `linux`.
    pub os: &'static str,
    /// Instructions that pictures are traced with: `AVX2 and FMA`, or `common`.
    pub instructions: &'static str,
    /// Rays that one instruction works on; every width of this build.
    pub lane_widths: Vec<usize>,
    /// Threads that share the work.
    pub threads: usize,
}

/// One check.
#[derive(Clone, Debug, Serialize)]
pub struct Checked {
    /// Its name, as `--only` takes it.
    pub name: &'static str,
    /// What it shows.
    pub what: &'static str,
    /// Cases tried.
    pub cases: u64,
    /// Wall-clock seconds.
    pub seconds: f64,
    /// Whether every figure keeps its bound.
    pub kept: bool,
    /// What was measured.
    pub figures: Vec<Measured>,
    /// The first case that was out of bounds.
    pub first_failure: Option<String>,
}

/// One figure.
#[derive(Clone, Debug, Serialize)]
pub struct Measured {
    /// What was measured.
    pub what: String,
    /// The value; `null` where it isn't a finite number.
    pub value: f64,
    /// Its unit; empty for counts.
    pub unit: &'static str,
    /// The largest value allowed.
    pub at_most: Option<f64>,
    /// The smallest value allowed.
    pub at_least: Option<f64>,
    /// Whether it keeps its bound.
    pub kept: bool,
    /// How many values lie below each edge and not below the one before; the last edge is `null`, for all above.
    pub histogram: Option<Vec<(Option<f64>, u64)>>,
}

impl Machine {
    /// This one.
    pub fn this() -> Machine {
        let width = |precision| rays_at_a_time(Instructions::Best, precision);
        let mut lane_widths = vec![width(Precision::F64), width(Precision::F32)];
        lane_widths.dedup();
        Machine {
            arch: std::env::consts::ARCH,
            os: std::env::consts::OS,
            instructions: instructions(Instructions::Best),
            lane_widths,
            threads: rayon::current_num_threads(),
        }
    }

    /// In words.
    pub fn words(&self) -> String {
        let Machine { arch, os, instructions, lane_widths, threads } = self;
        let widths: Vec<String> = lane_widths.iter().map(usize::to_string).collect();
        let threads = if *threads == 1 { "1 thread".into() } else { format!("{threads} threads") };
        format!("{arch} {os}, {instructions} instructions, lanes of {}, {threads}", widths.join(" and "))
    }
}

impl Checked {
    /// What `outcome` says.
    pub fn new(name: &'static str, what: &'static str, seconds: f64, outcome: Outcome) -> Checked {
        Checked {
            name,
            what,
            cases: outcome.cases,
            seconds,
            kept: outcome.is_within(),
            figures: outcome.figures.iter().map(Measured::new).collect(),
            first_failure: outcome.first_failure,
        }
    }
}

impl Measured {
    fn new(figure: &Figure) -> Measured {
        let (at_most, at_least) = match figure.bound {
            Bound::AtMost(x) => (Some(x), None),
            Bound::AtLeast(x) => (None, Some(x)),
            Bound::None => (None, None),
        };
        let bins = |h: &Histogram| h.bins().iter().map(|(edge, n)| (edge.is_finite().then_some(*edge), *n)).collect();
        Measured {
            what: figure.what.clone(),
            value: figure.value,
            unit: figure.unit,
            at_most,
            at_least,
            kept: figure.is_within(),
            histogram: figure.histogram.as_ref().map(bins),
        }
    }
}

/// How a size is called.
pub fn size_word(size: Size) -> &'static str {
    match size {
        Size::Quick => "quick",
        Size::Long => "extremes",
    }
}
