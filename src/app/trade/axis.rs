//! The dials of a sweep: one list for the command line, the sweep and what is written of it.

use clap::ValueEnum;
use serde::Serialize;

/// A dial: what is turned while all else stays as the scene has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// The largest error that is asked for.
    Error,
    /// Rays a pixel.
    Samples,
    /// The most rays a pixel, where neighbours differ.
    Adaptive,
    /// The time that tracing may take.
    Time,
    /// Reflections and transmissions one after another.
    Depth,
    /// 64 bits or 32.
    Precision,
    /// Bounds of regions, or samples alone.
    Certificates,
    /// Rays and depth at once: a few settings, spread evenly.
    Mixed,
}

impl Axis {
    /// All, in the order in which they are swept.
    pub const ALL: [Axis; 8] = [
        Axis::Error,
        Axis::Samples,
        Axis::Adaptive,
        Axis::Time,
        Axis::Depth,
        Axis::Precision,
        Axis::Certificates,
        Axis::Mixed,
    ];

    /// Its name on the command line.
    pub fn word(self) -> &'static str {
        match self {
            Axis::Error => "error",
            Axis::Samples => "samples",
            Axis::Adaptive => "adaptive",
            Axis::Time => "time",
            Axis::Depth => "depth",
            Axis::Precision => "precision",
            Axis::Certificates => "certificates",
            Axis::Mixed => "mixed",
        }
    }

    /// Whether a further turn of it is meant to bring the picture nearer to the truth, in the order in which it is swept.
    pub fn is_a_budget(self) -> bool {
        matches!(self, Axis::Error | Axis::Samples | Axis::Adaptive | Axis::Time | Axis::Depth)
    }
}
