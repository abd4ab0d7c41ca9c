//! Which pixels of a picture differ from their neighbours. It is looked at in blocks, and again only where something has changed. Codes
//! are made anew each time: to keep those of a whole picture takes longer.

use super::options::Crop;

/// Pixels of a block across: one ray for each of its pixels fills a batch.
pub const ACROSS: u32 = 32;
/// Pixels of a block, and of a band, down.
pub const BAND: u32 = 8;

/// What is known of pixels, but for their colours.
#[derive(Debug)]
pub struct Marks<'m> {
    /// How many passes each has had its rays of; they aren't many.
    pub levels: &'m mut [u8],
    /// Whether it lacks rays.
    pub lacking: &'m mut [bool],
}

/// Blocks of a picture, in rows.
#[derive(Clone, Copy, Debug)]
pub struct Blocks {
    /// How many stand in a row: in a band.
    pub across: usize,
    /// How many rows: bands.
    pub down: usize,
}

impl Blocks {
    /// Of a part of a picture.
    pub fn of(part: Crop) -> Blocks {
        Blocks { across: part.width.div_ceil(ACROSS) as usize, down: part.height.div_ceil(BAND) as usize }
    }

    /// How many there are.
    pub fn count(self) -> usize {
        self.across * self.down
    }

    /// How many bands hold some of these blocks; but no more than there are groups of `few` of them, for less isn't worth a thread.
    pub fn pieces(self, some: &[bool], few: usize) -> usize {
        let bands = some.chunks(self.across.max(1)).filter(|band| band.contains(&true)).count();
        bands.min(some.iter().filter(|some| **some).count() / few)
    }

    /// `some` blocks, and those that share a side with them.
    pub fn around(self, some: &[bool]) -> Vec<bool> {
        let mut around = some.to_vec();
        let beside = |(a, b): (usize, usize), around: &mut [bool]| {
            around[a] |= some[b];
            around[b] |= some[a];
        };
        for y in 0..self.down {
            for x in 0..self.across {
                let at = y * self.across + x;
                if x > 0 {
                    beside((at - 1, at), &mut around);
                }
                if y > 0 {
                    beside((at - self.across, at), &mut around);
                }
            }
        }
        around
    }
}

/// About the code of 8 bits of a channel. The root is close to the curve of sRGB, and every machine has it in its registers; so has
/// the sum the next whole number in its lowest bits.
#[inline(always)]
fn code(v: f32) -> u8 {
    /// 2^23: from here on `f32` are whole numbers.
    const WHOLE: f32 = 8_388_608.0;
    let v = if v > 0.0 { v } else { 0.0 };
    let v = if v < 1.0 { v } else { 1.0 };
    (255.0 * v.sqrt() + WHOLE).to_bits() as u8
}

/// Codes of a row of a block, and of one pixel more on each side.
type Row = [u8; 3 * (ACROSS as usize + 2)];

/// Those of the block from column `x` to `end` of a row. Beyond the picture's edge everything is as on this side.
fn row_of_codes(row: &[[f32; 3]], (x, end): (usize, usize), codes: &mut Row) {
    let (before, after) = (x.max(1) - 1, end.min(row.len() - 1));
    codes[..3].copy_from_slice(&row[before].map(code));
    for (code_of, v) in codes[3..].iter_mut().zip(row[x..end].as_flattened()) {
        *code_of = code(*v);
    }
    codes[3 * (end - x + 1)..][..3].copy_from_slice(&row[after].map(code));
}

/// What decides about pixels that are marked.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Neighbours of which a channel differs by more codes of 8 bits.
    pub codes: u8,
    /// As many passes pixels are to have.
    pub level: u8,
}

/// Marks those pixels of a band as lacking rays that have had too few passes, and either some, or differ too much
/// from a neighbour beside, above or below. Only `wanted` blocks are looked at, and those are left that have such pixels; `had` are those
/// in which any pixel has had some. `pixels` are of the whole picture, whose row `y` is the band's first.
pub fn mark(
    (pixels, width, y): (&[[f32; 3]], usize, usize),
    limits: Limits,
    marks: &mut Marks<'_>,
    (wanted, had): (&mut [bool], &[bool]),
) {
    let row = |y: usize| pixels.get(width * y..width * (y + 1));
    let rows = marks.levels.len() / width;
    for ((x, wanted), had) in (0..width).step_by(ACROSS as usize).zip(wanted).zip(had) {
        if !*wanted {
            continue;
        }
        let end = (x + ACROSS as usize).min(width);
        let codes_of = |y: usize, codes: &mut Row| {
            if let Some(row) = row(y) {
                row_of_codes(row, (x, end), codes);
            }
        };
        *wanted = false;
        let mut codes = [[0; 3 * (ACROSS as usize + 2)]; 3];
        codes_of(y, &mut codes[1]);
        codes[0] = codes[1];
        if let Some(y) = y.checked_sub(1) {
            codes_of(y, &mut codes[0]);
        }
        for at in 0..rows {
            codes[2] = codes[1];
            codes_of(y + at + 1, &mut codes[2]);
            let differ = differences(&codes);
            codes.rotate_left(1);
            let differ = &differ[..3 * (end - x)];
            if !had && differ.iter().fold(0, |most: u8, d| most.max(*d)) <= limits.codes {
                continue; // mostly, and the marks needn't be looked at
            }
            let here = at * width + x..at * width + end;
            let (levels, differ) = (&marks.levels[here.clone()], differ.as_chunks::<3>().0);
            for ((lacks, level), [r, g, b]) in marks.lacking[here].iter_mut().zip(levels).zip(differ) {
                let differs = (*r.max(g).max(b) > limits.codes) | (*level > 0);
                *lacks |= (*level < limits.level) & differs;
                *wanted |= *lacks;
            }
        }
    }
}

/// By how much the middle one of three rows differs at most from what is beside, above and below.
fn differences([above, here, below]: &[Row; 3]) -> [u8; 3 * ACROSS as usize] {
    let mut differ = [0; 3 * ACROSS as usize];
    for (i, differ) in differ.iter_mut().enumerate() {
        let own = here[i + 3];
        let beside = own.abs_diff(here[i]).max(own.abs_diff(here[i + 6]));
        *differ = beside.max(own.abs_diff(above[i + 3])).max(own.abs_diff(below[i + 3]));
    }
    differ
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::color::encode_srgb;

    #[test]
    fn pixels_are_marked_on_both_sides_of_what_differs() {
        // A picture of 70 × 11 with one pixel that differs, at every place.
        for (x, y) in (0..70).flat_map(|x| (0..11).map(move |y| (x, y))) {
            let mut pixels = vec![[0.001, 0.16, 0.002]; 770];
            pixels[70 * y + x][1] = 0.19; // 9 codes more: 102, 111
            let (mut levels, mut lacking) = (vec![0; 770], vec![false; 770]);
            let blocks = Blocks::of(Crop { x: 0, y: 0, width: 70, height: 11 });
            let mut wanted = vec![true; blocks.count()];
            let bands = levels.chunks_mut(560).zip(lacking.chunks_mut(560)).zip(wanted.chunks_mut(blocks.across));
            for (band, ((levels, lacking), wanted)) in bands.enumerate() {
                let limits = Limits { codes: 8, level: 1 };
                mark((&pixels, 70, 8 * band), limits, &mut Marks { levels, lacking }, (wanted, &[false; 3]));
            }
            for (i, lacks) in lacking.iter().enumerate() {
                let apart = (i % 70).abs_diff(x) + (i / 70).abs_diff(y);
                assert_eq!(*lacks, apart <= 1, "({x}, {y}): {i}");
                assert!(wanted[i / 560 * blocks.across + i % 70 / 32] || !lacks);
            }
            let mut marks = Marks { levels: &mut [0; 560], lacking: &mut [false; 560] };
            mark((&pixels, 70, 0), Limits { codes: 9, level: 1 }, &mut marks, (&mut [true; 3], &[false; 3]));
            assert!(marks.lacking.iter().all(|lacks| !lacks));
            // What had rays before gets more.
            marks.levels[3] = 1;
            let had = [true, false, false];
            mark((&pixels, 70, 0), Limits { codes: 9, level: 2 }, &mut marks, (&mut [true; 3], &had));
            assert!(marks.lacking.iter().enumerate().all(|(i, lacks)| *lacks == (i == 3)));
        }
    }

    #[test]
    fn codes_are_near_those_of_files() {
        for v in 0..=1000 {
            let true_code = (255.0 * encode_srgb(v as f64 / 1000.0)).round();
            let near = code(v as f32 / 1000.0);
            assert!((near as f64 - true_code).abs() <= 11.0, "{v}: {near}, {true_code}");
        }
        assert_eq!([-1.0, f32::NAN, -0.0, 1.0, 2.0, f32::INFINITY].map(code), [0, 0, 0, 255, 255, 255]);
    }

    #[test]
    fn neighbours_of_blocks_share_a_side() {
        let blocks = Blocks { across: 3, down: 3 };
        let around = |at: usize| {
            let mut some = [false; 9];
            some[at] = true;
            (0..9).filter(|i| blocks.around(&some)[*i]).collect::<Vec<_>>()
        };
        assert_eq!(around(4), [1, 3, 4, 5, 7]);
        assert_eq!((around(0), around(5)), (vec![0, 1, 3], vec![2, 4, 5, 8]));
    }
}
