//! The magnitudes that geometry and light may have, and why: squares of lengths must neither overflow nor lose bits to
//! underflow, and products of light must stay numbers.

/// Largest supported magnitude of a coordinate or size: its square, 1e280, is far below the largest `f64`, 1.8e308.
pub const LARGEST: f64 = 1e140;
/// Smallest supported magnitude that isn't 0: its square, 1e-280, is far above the smallest normal `f64`, 2.2e-308.
pub const SMALLEST: f64 = 1e-140;
/// Largest magnitude that `f32` tracing holds: squares stay below 3.4e38 with room for a few additions.
pub const LARGEST_F32: f64 = 1e18;
/// Smallest magnitude other than 0 that `f32` tracing holds: squares stay above the smallest normal number, 1.2e-38.
pub const SMALLEST_F32: f64 = 1e-18;
/// Largest supported magnitude of an amount of light: a channel of a colour, a power, a share. A pixel sums products of a
/// weight, a share, a colour and a light, 1e24 at most: over ten million lights it is still far below the largest `f32`,
/// 3.4e38, so that no infinity arises and no NaN from it.
pub const BRIGHTEST: f64 = 1e6;
/// Largest exponent of a highlight: what rounding leaves of a cosine above 1 isn't raised to anything visible.
pub const SHINIEST: f64 = 1e6;
/// Widest and highest picture, in pixels: a row still fits the 32-bit sizes of picture files many times over.
pub const LARGEST_SIDE: u32 = 65_536;
/// Most pixels of a picture: 2^28, 3.2 GB of linear colours.
pub const MOST_PIXELS: u64 = 1 << 28;

/// Whether a coordinate is supported: 0, or of a magnitude from [`SMALLEST`] to [`LARGEST`].
pub fn is_supported(x: f64) -> bool {
    x == 0.0 || (SMALLEST..=LARGEST).contains(&x.abs())
}
