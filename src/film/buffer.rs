//! The picture in linear light, as the renderer leaves it.

/// A rectangle of linear RGB pixels; row 0 is the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// `width × height` pixels, row by row; every channel finite.
    pub pixels: Vec<[f32; 3]>,
}

impl Film {
    /// A black picture.
    pub fn new(width: u32, height: u32) -> Film {
        Film { width, height, pixels: vec![[0.0; 3]; width as usize * height as usize] }
    }
}
