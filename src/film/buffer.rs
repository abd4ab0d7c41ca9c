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

impl Film {
    /// A name for exactly this picture: BLAKE3 of its size and of every channel's bits, in hexadecimal. Equal pictures have
    /// equal names on every machine; +0 and -0 are different.
    pub fn hash(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        hasher.update(&self.width.to_le_bytes());
        hasher.update(&self.height.to_le_bytes());
        for row in self.pixels.chunks(self.width.max(1) as usize) {
            let bytes: Vec<u8> = row.as_flattened().iter().flat_map(|v| v.to_bits().to_le_bytes()).collect();
            hasher.update(&bytes);
        }
        hasher.finalize().to_hex().to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_tell_pictures_apart() {
        let black = Film::new(2, 3);
        assert_eq!(black.hash(), Film::new(2, 3).hash());
        assert_ne!(black.hash(), Film::new(3, 2).hash(), "the size counts");
        let mut other = black.clone();
        other.pixels[5][2] = f32::from_bits(1);
        assert_ne!(black.hash(), other.hash(), "the last bit counts");
    }
}
