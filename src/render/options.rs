//! What is asked of the tracer, and what it gives back.

use super::certify::Certificate;
use crate::diag::Place;
use crate::film::Film;
use crate::scene::{Accuracy, AntiAliasing, MaterialId, NodeId, PixelFilter, Precision, Settings};

/// How to trace: the scene's settings with the command line's changes.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Pixels across of the whole picture.
    pub width: u32,
    /// Pixels down of the whole picture.
    pub height: u32,
    /// Rays a pixel, where no accuracy is asked for.
    pub aa: AntiAliasing,
    /// How a pixel's light is weighed; one ray through its middle is shown as it is.
    pub filter: PixelFilter,
    /// How close to the truth the picture has to come; then `aa` isn't looked at, and `precision` is 64 bits.
    pub accuracy: Option<Accuracy>,
    /// The distance of codes that will be written, as a share of white: an error is told with their rounding. 0 where colours
    /// aren't rounded. Without an accuracy it isn't looked at.
    pub quantum: f64,
    /// Reflections and transmissions one after another.
    pub max_depth: u32,
    /// Arithmetic.
    pub precision: Precision,
    /// The part of the picture that is made; `None` for all of it.
    pub crop: Option<Crop>,
    /// Worker threads; `None` for one a core. Never changes a bit of the picture.
    pub threads: Option<usize>,
    /// Side of a tile in pixels, 1 to 16; for tests: never changes a bit of the picture.
    pub tile: u32,
    /// Instructions of the processor; for tests: never changes a bit of the picture.
    pub instructions: Instructions,
}

/// Which instructions of the processor the tracer uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instructions {
    /// The best that this machine has.
    Best,
    /// The best that this machine has, but for its widest registers: four numbers at a time instead of eight.
    Narrow,
    /// Those that every processor of its family has. Where fused multiply-add isn't among them, the library stands in.
    Common,
}

/// A part of the picture, in pixels; within it and not empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// First column.
    pub x: u32,
    /// First row, from the top.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Options {
    /// The scene's own settings.
    pub fn from_settings(s: &Settings) -> Options {
        Options {
            width: s.width,
            height: s.height,
            aa: s.aa,
            filter: s.filter,
            accuracy: s.accuracy,
            quantum: 1.0 / 255.0,
            max_depth: s.max_depth,
            precision: s.precision,
            crop: None,
            threads: None,
            tile: 16, // the best size measured: its rays and hits stay in the first-level cache, and fill a batch
            instructions: Instructions::Best,
        }
    }
    /// Side of a tile, within what batches have room for.
    pub fn tile_side(&self) -> u32 {
        self.tile.clamp(1, 16)
    }

    /// The tiles of the picture, row by row.
    pub fn tiles(&self) -> Vec<Crop> {
        let (part, side) = (self.crop_or_all(), self.tile_side());
        let start = |from: u32, length: u32| (0..length.div_ceil(side)).map(move |k| from + k * side);
        let size = |at: u32, from: u32, length: u32| side.min(from + length - at);
        let row = |y: u32| {
            let height = size(y, part.y, part.height);
            start(part.x, part.width).map(move |x| Crop { x, y, width: size(x, part.x, part.width), height })
        };
        start(part.y, part.height).flat_map(row).collect()
    }

    /// Whether tiles are made one by one, each for itself, in one go.
    pub fn is_by_tiles(&self) -> bool {
        self.accuracy.is_none() && !matches!(self.aa, AntiAliasing::Adaptive(_))
    }

    /// Whether every pixel is one ray through its middle.
    pub fn takes_one_ray(&self) -> bool {
        self.is_by_tiles() && self.aa.side() == 1
    }

    /// The part that is made, written out.
    pub fn crop_or_all(&self) -> Crop {
        self.crop.unwrap_or(Crop { x: 0, y: 0, width: self.width, height: self.height })
    }
}

/// Told of finished work; called from worker threads.
pub trait Progress: Sync {
    /// A tile is finished: its place in the picture, and its rows.
    fn finished(&self, tile: Crop, rows: &[&mut [[f32; 3]]]);
}

/// A [`Progress`] that tells nobody.
pub struct Silent;

impl Progress for Silent {
    fn finished(&self, _tile: Crop, _rows: &[&mut [[f32; 3]]]) {}
}

/// How many rays were traced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// From the camera.
    pub camera: u64,
    /// Towards lights.
    pub shadow: u64,
    /// Mirrored.
    pub reflected: u64,
    /// Gone through a surface, straight on or refracted.
    pub transmitted: u64,
}

impl RayCounts {
    /// Both together.
    pub fn plus(self, o: RayCounts) -> RayCounts {
        RayCounts {
            camera: self.camera + o.camera,
            shadow: self.shadow + o.shadow,
            reflected: self.reflected + o.reflected,
            transmitted: self.transmitted + o.transmitted,
        }
    }
}

/// A finished picture.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// Linear light; of the crop's size where there is one.
    pub film: Film,
    /// Rays by kind.
    pub rays: RayCounts,
    /// Threads that worked.
    pub threads: usize,
    /// What can be said of its error, where [`Options::accuracy`] asked.
    pub certificate: Option<Box<Certificate>>,
}

/// A finished picture that went out row by row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Streamed {
    /// Rays by kind.
    pub rays: RayCounts,
    /// Threads that worked.
    pub threads: usize,
}

/// One ability of the renderer.
#[derive(Clone, Debug, PartialEq)]
pub struct Feature {
    /// Its name, in words of the language: "reflection", "image patterns", "shadows", …
    pub name: &'static str,
    /// The text that first required it; `None` where the scene does without.
    pub required_by: Option<Place>,
    /// Whether it is in use even without a text (a default material, say).
    pub in_use: bool,
    /// What using it means for memory and time, or what leaving it out saves.
    pub detail: String,
}

/// What one pixel sees.
#[derive(Clone, Debug)]
pub struct Probe {
    /// The shape's node.
    pub node: NodeId,
    /// Its material.
    pub material: MaterialId,
    /// Where the ray meets it, in scene units.
    pub point: [f64; 3],
    /// The unit normal there, towards the viewer.
    pub normal: [f64; 3],
    /// Distance from the ray's origin, in scene units.
    pub distance: f64,
    /// The base colour there, linear.
    pub color: [f64; 3],
    /// Every light's node, and the share of it that arrives: 0 where the surface faces away or lies in shadow.
    pub lights: Vec<(NodeId, [f64; 3])>,
}
