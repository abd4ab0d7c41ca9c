//! The one hash behind everything random: keyed, without hidden state, fixed for the language edition.
//!
//! SplitMix64's finaliser (Steele, Lea, Flood, OOPSLA 2014) over a running state. Changing it changes pictures, so a test
//! pins its values.

/// A keyed hash under construction: feed keys, then draw values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KeyedHash(u64);

impl KeyedHash {
    /// The empty key of language edition 1.
    pub const fn new() -> Self {
        KeyedHash(0x7264_736c_0000_0001) // "rdsl", edition 1
    }

    /// Adds one 64-bit key; the order of keys matters.
    #[inline]
    pub const fn with(self, key: u64) -> Self {
        KeyedHash(mix(self.0.rotate_left(23) ^ key.wrapping_mul(0x9E37_79B9_7F4A_7C15)))
    }

    /// Adds a number: equal numbers are equal keys (-0 counts as 0).
    #[inline]
    pub fn with_f64(self, x: f64) -> Self {
        self.with(if x == 0.0 { 0 } else { x.to_bits() })
    }

    /// Adds text, its length included.
    pub fn with_text(self, text: &str) -> Self {
        let mut h = self.with(text.len() as u64 ^ 0x7465_7874);
        for chunk in text.as_bytes().chunks(8) {
            let mut word = [0u8; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            h = h.with(u64::from_le_bytes(word));
        }
        h
    }

    /// 64 uniform bits.
    #[inline]
    pub const fn bits(self) -> u64 {
        mix(self.0 ^ 0xD1B5_4A32_D192_ED03)
    }

    /// Uniform in [0, 1), a multiple of 2^-53.
    #[inline]
    pub fn unit(self) -> f64 {
        (self.bits() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }
}

impl Default for KeyedHash {
    fn default() -> Self {
        Self::new()
    }
}

#[inline]
const fn mix(mut z: u64) -> u64 {
    z = z.wrapping_add(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniform_and_keyed() {
        let n = 20_000;
        let mean = (0..n).map(|i| KeyedHash::new().with_f64(i as f64).unit()).sum::<f64>() / n as f64;
        assert!((mean - 0.5).abs() < 0.01, "{mean}");
        let h = KeyedHash::new();
        assert_ne!(h.with_text("ab").with_text("c"), h.with_text("a").with_text("bc"));
        assert_eq!(h.with_f64(0.0), h.with_f64(-0.0));
        assert_ne!(h.with_f64(1.0).with_f64(2.0).bits(), h.with_f64(2.0).with_f64(1.0).bits());
    }
}
