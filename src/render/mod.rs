//! From scene to film: the world as the tracer sees it, and the tracer.
//!
//! [`World::build`] takes from a scene what its picture requires; [`render`] traces it tile by tile; [`probe`] tells what one
//! pixel sees. Within: `shape/` holds the kernels, one a file, each written once for every scalar; `bvh`, `cull` and `candidates` find
//! what a batch of rays can meet; `tracer`, `shade`, `illuminate` and `light` follow the rays; `pattern`, `material` and `paint` colour what
//! they meet. [`certify`] bounds what all rays of a region see, and brings pixels to a stated error; a `sketch` sends more rays where
//! neighbours differ.

mod assemble;
mod ball;
pub mod batch;
mod belt;
mod between;
pub mod bounds;
pub mod bvh;
pub mod camera;
mod candidates;
mod census;
pub mod certify;
mod closest;
mod confine;
mod crew;
pub mod cull;
mod digest;
mod dispatch;
mod feature;
mod filter;
mod flock;
mod footprint;
pub mod frame;
mod gathered;
mod graft;
mod highlight;
mod illuminate;
mod known;
mod laid_out;
mod lattice;
mod light;
mod marks;
pub mod material;
mod nearest;
pub mod optics;
pub mod options;
mod paint;
pub mod pattern;
pub mod pattern_node;
mod pattern_point;
mod place;
mod probe;
pub mod ray;
mod retrace;
mod run;
mod run_of_hits;
mod search;
mod shade;
mod shadow_rays;
pub mod shape;
mod sketch;
mod slabs;
mod sobol;
mod span;
mod spawn;
mod standing;
mod supersampler;
mod surface_pattern;
mod surfaces;
mod sweep;
mod taps;
mod texture;
mod tile;
mod touch;
mod tracer;
mod way;
pub mod world;

pub use dispatch::{Develop, instructions, rays_at_a_time, render, stream};
pub use options::{Crop, Feature, Instructions, Options, Probe, Progress, RayCounts, Rendered, Silent, Streamed};
pub use probe::probe;
pub use retrace::{Built, Plan, Retraced, Retracer};
pub use search::Search;
pub use tile::radiance;
pub use world::World;
