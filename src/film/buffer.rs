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
    /// A name for exactly this picture, as [`Digest`] makes it.
    pub fn hash(&self) -> String {
        let mut digest = Digest::new(self.width, self.height);
        let mut bytes = Vec::new();
        for row in self.pixels.chunks(self.width.max(1) as usize) {
            bytes.clear();
            to_bytes(row, &mut bytes);
            digest.add(&bytes);
        }
        digest.end()
    }
}

/// Makes a name for exactly one picture from its pixels, row by row: BLAKE3 of its size and of every channel's bits, in
/// hexadecimal. Equal pictures have equal names on every machine; +0 and -0 are different.
pub struct Digest(blake3::Hasher);

impl Digest {
    /// For a picture of this size.
    pub fn new(width: u32, height: u32) -> Digest {
        let mut hasher = blake3::Hasher::new();
        hasher.update(&width.to_le_bytes());
        hasher.update(&height.to_le_bytes());
        Digest(hasher)
    }

    /// Adds pixels, as [`to_bytes`] gives them.
    pub fn add(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// The name.
    pub fn end(self) -> String {
        self.0.finalize().to_hex().to_string()
    }
}

/// Adds the bits of pixels to `out`, 12 bytes each: the least byte of a channel first.
pub fn to_bytes(pixels: &[[f32; 3]], out: &mut Vec<u8>) {
    out.extend(pixels.as_flattened().iter().flat_map(|v| v.to_bits().to_le_bytes()));
}

/// Adds to `out` the pixels that [`to_bytes`] made `bytes` of.
pub fn from_bytes(bytes: &[u8], out: &mut Vec<[f32; 3]>) {
    let channel = |b: &[u8; 4]| f32::from_bits(u32::from_le_bytes(*b));
    let (channels, _) = bytes.as_chunks();
    out.extend(channels.as_chunks().0.iter().map(|[r, g, b]| [channel(r), channel(g), channel(b)]));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_and_back() {
        let pixels = [[1.5, -0.0, f32::MAX], [f32::from_bits(1), 0.1, -7.0]];
        let (mut bytes, mut back) = (Vec::new(), Vec::new());
        to_bytes(&pixels, &mut bytes);
        from_bytes(&bytes, &mut back);
        assert!(bytes.len() == 24 && back == pixels && back[0][1].is_sign_negative());
    }

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
