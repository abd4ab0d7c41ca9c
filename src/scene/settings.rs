//! How the picture is to be made.

/// Size and quality; the command line may override each.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Pixels across, 1 to [`LARGEST_SIDE`](super::range::LARGEST_SIDE).
    pub width: u32,
    /// Pixels down, likewise.
    pub height: u32,
    /// Rays a pixel, where no accuracy is asked for.
    pub aa: AntiAliasing,
    /// How much the light counts that comes from around a pixel's middle.
    pub filter: PixelFilter,
    /// How close to the truth the picture has to come; as many rays as that takes.
    pub accuracy: Option<Accuracy>,
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
    /// One ray through the middle of each pixel, and up to so many more where neighbours differ.
    Adaptive(u32),
}

impl AntiAliasing {
    /// Largest n of a grid: 1,024 rays a pixel.
    pub const LARGEST_GRID: u32 = 32;

    /// Most further rays of a pixel that differs from its neighbours: those of the largest grid.
    pub const MOST_RAYS: u32 = Self::LARGEST_GRID * Self::LARGEST_GRID;

    /// Rays along one side of a pixel, of those that every pixel gets.
    pub fn side(self) -> u32 {
        match self {
            AntiAliasing::Off | AntiAliasing::Adaptive(_) => 1,
            AntiAliasing::Grid(n) => n,
        }
    }
}

/// How much the light counts that comes from around a pixel's middle: the same to all four sides, and 1 in all. What a pixel shows
/// is the light times these weights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PixelFilter {
    /// The same all over the pixel's square, nothing beyond: the mean.
    #[default]
    Box,
    /// Sharp: the cubic with a third each of blur and ringing, from a square of 4 pixels a side; its rim counts against the light.
    /// (Mitchell, Netravali, "Reconstruction filters in computer graphics", SIGGRAPH 1988.)
    Mitchell,
    /// Soft: a bell of standard deviation ½, less its value at 1½ pixels, where it ends.
    Gauss,
}

impl PixelFilter {
    /// Every one.
    pub const ALL: [PixelFilter; 3] = [PixelFilter::Box, PixelFilter::Mitchell, PixelFilter::Gauss];

    /// That of a name.
    pub fn named(name: &str) -> Option<PixelFilter> {
        Self::ALL.into_iter().find(|filter| filter.name() == name)
    }

    /// Its name in a scene.
    pub fn name(self) -> &'static str {
        match self {
            PixelFilter::Box => "box",
            PixelFilter::Mitchell => "mitchell",
            PixelFilter::Gauss => "gauss",
        }
    }
}

/// What is asked of a picture instead of a number of rays: an error, a time, or both, and then whichever is reached first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// Largest error of any channel of any pixel, as a share of white after the sRGB curve, [`LEAST_ERROR`](Self::LEAST_ERROR) to
    /// [`LARGEST_ERROR`](Self::LARGEST_ERROR): 2/255 are two codes of 8 bits. It is the distance from the pixel's true colour,
    /// which is the mean over its square, or what its filter makes of the light. `None` for the least that the time allows.
    pub error: Option<f64>,
    /// Seconds of tracing. `None` for as many as it takes.
    pub time: Option<f64>,
    /// Probability, between 0 and 1, with which a pixel keeps the error where that can't be proved but is bounded.
    pub confidence: f64,
}

impl Accuracy {
    /// Two thirds of a code of 16 bits, half of which is lost when codes are rounded.
    pub const LEAST_ERROR: f64 = 1e-5;
    /// Half of all there is between black and white.
    pub const LARGEST_ERROR: f64 = 0.5;
    /// Seconds: less isn't enough for a picture's first ray.
    pub const LEAST_TIME: f64 = 0.001;
    /// A week.
    pub const LONGEST_TIME: f64 = 604_800.0;
    /// One pixel in a thousand may fail.
    pub const CONFIDENCE: f64 = 0.999;
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
        Settings {
            width: 640,
            height: 480,
            aa: AntiAliasing::Off,
            filter: PixelFilter::Box,
            accuracy: None,
            max_depth: 8,
            precision: Precision::F64,
        }
    }
}
