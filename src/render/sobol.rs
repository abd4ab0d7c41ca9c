//! Points for samples: Sobol's first two dimensions, scrambled as Owen does, by hashes (Laine, Karras, EGSR 2011; Burley, "Practical
//! hash-based Owen scrambling", JCGT 9(4), 2020).

use crate::math::hash::KeyedHash;

/// Point number `i` of the sequence that `key` scrambles, in [0, 1)².
pub fn point(i: u32, key: KeyedHash) -> [f64; 2] {
    let (order, axes) = (key.with(0).bits() as u32, key.with(1).bits());
    let i = scrambled(i, order);
    let x = i.reverse_bits();
    // The second dimension's direction numbers: rows of Pascal's triangle modulo 2.
    let (mut y, mut v, mut rest) = (0u32, 1u32 << 31, i);
    while rest != 0 {
        if rest & 1 != 0 {
            y ^= v;
        }
        rest >>= 1;
        v ^= v >> 1;
    }
    let unit = |x: u32| x as f64 * (1.0 / (1u64 << 32) as f64);
    [unit(scrambled(x, axes as u32)), unit(scrambled(y, (axes >> 32) as u32))]
}

/// Each bit flipped by a hash of the bits above it.
fn scrambled(x: u32, seed: u32) -> u32 {
    let mut x = x.reverse_bits();
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^= x.wrapping_mul(0x53a2_2864);
    x.reverse_bits()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_elementary_box_holds_one_point() {
        for seed in 0..4 {
            for (columns, rows) in [(1, 256), (16, 16), (256, 1), (4, 64)] {
                let mut seen = vec![false; 256];
                for i in 0..256 {
                    let [x, y] = point(i, KeyedHash::new().with(seed));
                    let at = (x * columns as f64) as usize * rows + (y * rows as f64) as usize;
                    assert!(!std::mem::replace(&mut seen[at], true), "{columns}×{rows}");
                }
            }
        }
    }
}
