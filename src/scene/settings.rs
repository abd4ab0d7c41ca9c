//! How the picture is to be made.

/// Size and quality; the command line may override each.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Pixels across, 1 to [`LARGEST_SIDE`](super::range::LARGEST_SIDE).
    pub width: u32,
    /// Pixels down, likewise.
    pub height: u32,
    /// Rays a pixel.
    pub aa: AntiAliasing,
    /// Reflections and transmissions that a camera ray may go through, one after another; 0 shows surfaces alone.
    pub max_depth: u32,
    /// Arithmetic of the tracer.
    pub precision: Precision,
}

/// Rays a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AntiAliasing {
    /// One ray through the middle of each pixel.
    Off,
    /// A regular n × n grid of rays, whose colours are averaged.
    Grid(u32),
}

impl AntiAliasing {
    /// Largest n of a grid: 1,024 rays a pixel.
    pub const LARGEST_GRID: u32 = 32;

    /// Rays along one side of a pixel.
    pub fn side(self) -> u32 {
        match self {
            AntiAliasing::Off => 1,
            AntiAliasing::Grid(n) => n,
        }
    }
}

/// Arithmetic of the tracer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// 64-bit floating point, the default.
    F64,
    /// 32-bit floating point: a draft, not for scenes with large or small lengths.
    F32,
}

impl Settings {
    /// Largest recursion limit: deeper than any picture shows, small enough for fixed buffers.
    pub const LARGEST_DEPTH: u32 = 100;
}

impl Default for Settings {
    fn default() -> Self {
        Settings { width: 640, height: 480, aa: AntiAliasing::Off, max_depth: 8, precision: Precision::F64 }
    }
}
