//! Linear light to the display codes of sRGB, exactly: the code is the one whose encoded value lies nearest. No formula is
//! evaluated per pixel: the places where one code gives way to the next are computed once, from the same
//! [`decode_srgb`] that reads colours, and looked up. So the codes have the same bits
//! everywhere, and developing takes a nanosecond a channel.

use crate::scene::color::decode_srgb;
use std::sync::LazyLock;

/// Bits of a channel in a picture file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// 0 to 255.
    Eight,
    /// 0 to 65,535.
    Sixteen,
}

impl Depth {
    /// The code of full white.
    pub fn white(self) -> u16 {
        match self {
            Depth::Eight => u8::MAX as u16,
            Depth::Sixteen => u16::MAX,
        }
    }

    /// Bytes of a code in a file.
    pub fn bytes(self) -> usize {
        match self {
            Depth::Eight => 1,
            Depth::Sixteen => 2,
        }
    }
}

/// The table for one depth. It divides values into buckets by exponent and leading bits of the mantissa.
pub struct Developer(Table);

enum Table {
    Eight(Box<Eight>),
    Sixteen(Box<Sixteen>),
}

/// A bucket holds one threshold at most. It is kept as the code of its first value, times [`STEP`], and what the threshold
/// in it lacks to `STEP`: adding a value's other bits carries into the code where it reaches the threshold.
type Eight = [u32; 16 * BUCKETS];

/// At 1 a bucket holds 68 thresholds, nearly evenly spaced.
struct Sixteen {
    /// By bucket: a straight line through the codes, off by one at most.
    lines: [[f32; 2]; 32 * BUCKETS],
    /// Where each code begins, and where one more would.
    starts: [f32; 1 << 16 | 1],
}

/// Buckets for each power of two. With half of them, some would hold two thresholds of 8 bits.
const BUCKETS: usize = 1 << 8;
/// Bits of an `f32` that don't choose its bucket.
const SHIFT: u32 = 23 - BUCKETS.ilog2();
/// One code of 8 bits; more than the bits that don't choose the bucket can make.
const STEP: u32 = 1 << 16;

/// The first value of a table of `n` buckets that ends just below 2: the first code but 0 begins at 2^-12.7 with 8 bits, at
/// 2^-20.7 with 16, so that 16 and 32 powers of two are enough.
const fn least(n: usize) -> f32 {
    start(n, 0)
}

/// Where bucket `i` of `n` begins.
const fn start(n: usize, i: usize) -> f32 {
    let end = 128 * BUCKETS; // the bucket of 2, counted from 0's
    f32::from_bits(((end - n + i) as u32) << SHIFT)
}

/// The bucket of a value from `least(n)` to 1: `end` in [`start`] is a multiple of `n`, 16 or 32 times `BUCKETS`.
#[inline(always)]
fn bucket(v: f32, n: usize) -> usize {
    (v.to_bits() >> SHIFT) as usize & (n - 1)
}

/// Black for less than there is a bucket for, and for NaN, which no picture holds.
#[inline(always)]
fn clamp(v: f32, n: usize) -> f32 {
    let v = if v > least(n) { v } else { least(n) };
    if v < 1.0 { v } else { 1.0 }
}

impl Developer {
    /// The table for `depth`.
    pub fn of(depth: Depth) -> &'static Developer {
        static EIGHT: LazyLock<Developer> = LazyLock::new(|| Developer(Table::Eight(eight())));
        static SIXTEEN: LazyLock<Developer> = LazyLock::new(|| Developer(Table::Sixteen(sixteen())));
        match depth {
            Depth::Eight => &EIGHT,
            Depth::Sixteen => &SIXTEEN,
        }
    }

    /// The code of a linear value; below 0 is 0, above 1 is white. (NaN, which no picture holds, is 0.)
    pub fn code(&self, v: f32) -> u16 {
        match &self.0 {
            Table::Eight(table) => code_8(table, v) as u16,
            Table::Sixteen(table) => code_16(table, v),
        }
    }

    /// Adds the codes of pixels as a file holds them: 16 bits with the larger byte first.
    pub fn develop(&self, pixels: &[[f32; 3]], out: &mut Vec<u8>) {
        match &self.0 {
            Table::Eight(table) => fill(pixels, out, |v| [code_8(table, v)]),
            Table::Sixteen(table) => fill(pixels, out, |v| code_16(table, v).to_be_bytes()),
        }
    }
}

fn fill<const N: usize>(pixels: &[[f32; 3]], out: &mut Vec<u8>, code: impl Fn(f32) -> [u8; N]) {
    let before = out.len();
    out.resize(before + N * 3 * pixels.len(), 0);
    let (codes, _) = out[before..].as_chunks_mut::<N>();
    match pixels.first() {
        // Much of many pictures is background.
        Some(pixel) if is_uniform(pixels.as_flattened()) => codes.as_chunks_mut().0.fill(pixel.map(code)),
        _ => codes.iter_mut().zip(pixels.as_flattened()).for_each(|(place, v)| *place = code(*v)),
    }
}

/// Whether all pixels are equal. Many are compared before it is asked, so that lanes can do it.
fn is_uniform(channels: &[f32]) -> bool {
    let next = channels.get(3..).unwrap_or(&[]);
    let equal = |(a, b): (&[f32], &[f32])| a.iter().zip(b).fold(true, |all, (a, b)| all & (a == b));
    next.chunks(64).zip(channels.chunks(64)).all(equal)
}

#[inline(always)]
fn code_8(table: &Eight, v: f32) -> u8 {
    let v = clamp(v, table.len());
    let rest = v.to_bits() & ((1 << SHIFT) - 1);
    ((table[bucket(v, table.len())] + rest) / STEP) as u8
}

#[inline(always)]
fn code_16(table: &Sixteen, v: f32) -> u16 {
    let v = clamp(v, table.lines.len());
    let [a, b] = table.lines[bucket(v, table.lines.len())];
    let near = (a + b * v) as u16;
    let (begins, ends) = (table.starts[near as usize], table.starts[near as usize + 1]);
    near + (v >= ends) as u16 - (v < begins) as u16
}

/// The smallest value of each code but 0.
fn thresholds(depth: Depth) -> Vec<f32> {
    let white = depth.white();
    // Half-way between two codes in encoded space; a value exactly there takes the brighter.
    (1..=white).map(|k| at_least(decode_srgb((k as f64 - 0.5) / white as f64))).collect()
}

fn eight() -> Box<Eight> {
    let thresholds = thresholds(Depth::Eight);
    let mut table = Box::new([0; 16 * BUCKETS]);
    let n = table.len();
    let mut code = 0;
    for (i, entry) in table.iter_mut().enumerate() {
        let reached = |code: usize, v: f32| thresholds.get(code).is_some_and(|&t| t <= v);
        if reached(code, start(n, i)) {
            code += 1;
        }
        *entry = code as u32 * STEP;
        if reached(code, start(n, i + 1).next_down()) {
            *entry += STEP - (thresholds[code].to_bits() & ((1 << SHIFT) - 1));
            code += 1;
        }
    }
    table
}

fn sixteen() -> Box<Sixteen> {
    let thresholds = thresholds(Depth::Sixteen);
    let mut table = Box::new(Sixteen { lines: [[0.0; 2]; 32 * BUCKETS], starts: [0.0; 1 << 16 | 1] });
    let [.., before, last] = thresholds[..] else { return table };
    // Code 0 reaches as far below 0 as above.
    let starts = std::iter::once(-thresholds[0]).chain(thresholds).chain([last + (last - before)]);
    for (start, v) in table.starts.iter_mut().zip(starts) {
        *start = v;
    }
    let Sixteen { lines, starts } = &mut *table;
    let n = lines.len();
    let mut code = 0;
    // The code at `v`, with how far it is to the next.
    let mut at = |v: f32| {
        while code + 2 < starts.len() && starts[code + 1] <= v {
            code += 1;
        }
        code as f32 + (v - starts[code]) / (starts[code + 1] - starts[code])
    };
    for (i, line) in lines.iter_mut().enumerate() {
        let (from, to) = (start(n, i), start(n, i + 1));
        let (low, high) = (at(from), at(to));
        let slope = (high - low) / (to - from);
        *line = [low - slope * from, slope];
    }
    table
}

/// The smallest `f32` that isn't below `x`, which is positive and normal.
fn at_least(x: f64) -> f32 {
    let near = x as f32;
    if (near as f64) < x { near.next_up() } else { near }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::color::encode_srgb;

    #[test]
    fn thresholds_are_exact() {
        for depth in [Depth::Eight, Depth::Sixteen] {
            let table = Developer::of(depth);
            let white = depth.white();
            for k in 1..=white {
                let half_way = decode_srgb((k as f64 - 0.5) / white as f64);
                let above = at_least(half_way);
                assert!(above as f64 >= half_way && (above.next_down() as f64) < half_way);
                assert_eq!(table.code(above), k);
                assert_eq!(table.code(above.next_down()), k - 1);
            }
        }
    }

    /// Codes never fall within a bucket, so that its ends and the thresholds speak for all values.
    #[test]
    fn every_bucket_is_right_at_both_ends() {
        for depth in [Depth::Eight, Depth::Sixteen] {
            let (table, thresholds) = (Developer::of(depth), thresholds(depth));
            for n in [16 * BUCKETS, 32 * BUCKETS] {
                for i in 0..n {
                    for v in [start(n, i), start(n, i + 1).next_down()] {
                        assert!(v > 1.0 || bucket(v, n) == i);
                        assert_eq!(table.code(v) as usize, thresholds.partition_point(|&t| t <= v), "{v}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_row_has_the_codes_of_its_channels() {
        let pixels: Vec<[f32; 3]> = (0..50).map(|i| [i as f32 / 40.0, -0.1, i as f32 * i as f32 / 9e3]).collect();
        let codes = |depth| pixels.as_flattened().iter().map(move |&v| Developer::of(depth).code(v));
        let mut row = vec![9];
        Developer::of(Depth::Eight).develop(&pixels, &mut row);
        assert!(row[0] == 9 && row[1..].iter().map(|&b| b as u16).eq(codes(Depth::Eight)));
        row.clear();
        Developer::of(Depth::Eight).develop(&[[0.2, 0.5, f32::NAN], [0.2, 0.5, 0.0]], &mut row);
        Developer::of(Depth::Eight).develop(&[[0.2, 0.5, 1.0]; 2], &mut row);
        assert_eq!(row, [124, 188, 0, 124, 188, 0, 124, 188, 255, 124, 188, 255]);
        row.clear();
        Developer::of(Depth::Sixteen).develop(&pixels, &mut row);
        assert!(row.chunks(2).map(|b| u16::from_be_bytes([b[0], b[1]])).eq(codes(Depth::Sixteen)));
    }

    #[test]
    fn codes_are_the_nearest() {
        for depth in [Depth::Eight, Depth::Sixteen] {
            let table = Developer::of(depth);
            let white = depth.white() as f64;
            for i in 0..=100_000 {
                let v = i as f32 / 100_000.0;
                let exact = encode_srgb(v as f64) * white;
                let distance = (table.code(v) as f64 - exact).abs();
                // The two formulas of the standard meet only to 1e-7 of white, hence the slack, in codes.
                assert!(distance <= 0.5 + 1e-7 * white, "{v}: {distance}");
            }
        }
    }

    #[test]
    fn codes_come_back_and_the_ends_hold() {
        for depth in [Depth::Eight, Depth::Sixteen] {
            let table = Developer::of(depth);
            let white = depth.white();
            for k in 0..=white {
                assert_eq!(table.code(decode_srgb(k as f64 / white as f64) as f32), k);
            }
            for dark in [0.0, -0.0, -1.0, f32::NEG_INFINITY, f32::NAN, f32::MIN_POSITIVE, f32::from_bits(1)] {
                assert_eq!(table.code(dark), 0);
            }
            for bright in [1.0, 1.5, f32::MAX, f32::INFINITY, 1f32.next_down()] {
                assert_eq!(table.code(bright), white);
            }
        }
    }
}
