//! Which pixels of a picture differ from their neighbours. It is looked at in blocks, and again only where something has changed.

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

    /// How many bands hold some of these blocks.
    pub fn bands(self, some: &[bool]) -> usize {
        some.chunks(self.across.max(1)).filter(|band| band.contains(&true)).count()
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

/// About the codes of 8 bits of as many pixels as there are places for. The root is close to the curve of sRGB, and lanes have it.
pub fn encode(pixels: &[[f32; 3]], codes: &mut [[u8; 3]]) {
    let codes = codes.as_flattened_mut().iter_mut();
    codes.zip(pixels.as_flattened()).for_each(|(code, v)| *code = (255.0 * v.clamp(0.0, 1.0).sqrt()) as u8);
}

/// Marks those pixels of a band as lacking rays that have had fewer than `level` passes, and either some, or differ by more than `most`
/// codes from a neighbour beside, above or below. Only `wanted` blocks are looked at, and those are left that have such pixels. `codes` are
/// of the whole picture, whose row `y` is the band's first.
pub fn mark(
    (codes, width, y): (&[[u8; 3]], usize, usize),
    (most, level): (u8, u8),
    marks: &mut Marks<'_>,
    wanted: &mut [bool],
) {
    let row = |y: usize| codes.get(width * y..width * (y + 1));
    for (x, wanted) in (0..width).step_by(ACROSS as usize).zip(wanted) {
        if !*wanted {
            continue;
        }
        let end = (x + ACROSS as usize).min(width);
        *wanted = false;
        let rows = marks.levels.chunks(width).zip(marks.lacking.chunks_mut(width));
        for (y, (levels, lacking)) in (y..).zip(rows) {
            let Some(here) = row(y) else { continue };
            let mut differ = [0; 3 * ACROSS as usize];
            let differ = &mut differ[..3 * (end - x)];
            let block = here[x..end].as_flattened();
            // Beyond the picture's edge everything is as on this side.
            for other in [y.checked_sub(1).and_then(row), row(y + 1)].into_iter().flatten() {
                note_differences(block, other[x..end].as_flattened(), differ);
            }
            let left = x.max(1);
            note_differences(
                here[left..end].as_flattened(),
                here[left - 1..].as_flattened(),
                &mut differ[3 * (left - x)..],
            );
            note_differences(block, here[x + 1..].as_flattened(), differ);
            let (levels, differ) = (&levels[x..end], differ.as_chunks::<3>().0);
            for ((lacks, had), [r, g, b]) in lacking[x..end].iter_mut().zip(levels).zip(differ) {
                let differs = (*r.max(g).max(b) > most) | (*had > 0);
                *lacks |= (*had < level) & differs;
                *wanted |= *lacks;
            }
        }
    }
}

/// Notes by how much `a` differ from those of `b` in the same place, as far as the shortest goes, where that is more.
fn note_differences(a: &[u8], b: &[u8], differ: &mut [u8]) {
    for ((a, b), differ) in a.iter().zip(b).zip(differ) {
        *differ = (*differ).max(a.abs_diff(*b));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::color::encode_srgb;

    #[test]
    fn pixels_are_marked_on_both_sides_of_what_differs() {
        // A picture of 70 × 11 with one pixel that differs, at every place.
        for (x, y) in (0..70).flat_map(|x| (0..11).map(move |y| (x, y))) {
            let mut codes = vec![[7, 100, 9]; 770];
            codes[70 * y + x][1] += 9;
            let (mut levels, mut lacking) = (vec![0; 770], vec![false; 770]);
            let blocks = Blocks::of(Crop { x: 0, y: 0, width: 70, height: 11 });
            let mut wanted = vec![true; blocks.count()];
            let bands = levels.chunks_mut(560).zip(lacking.chunks_mut(560)).zip(wanted.chunks_mut(blocks.across));
            for (band, ((levels, lacking), wanted)) in bands.enumerate() {
                mark((&codes, 70, 8 * band), (8, 1), &mut Marks { levels, lacking }, wanted);
            }
            for (i, lacks) in lacking.iter().enumerate() {
                let apart = (i % 70).abs_diff(x) + (i / 70).abs_diff(y);
                assert_eq!(*lacks, apart <= 1, "({x}, {y}): {i}");
                assert!(wanted[i / 560 * blocks.across + i % 70 / 32] || !lacks);
            }
            let mut marks = Marks { levels: &mut [0; 560], lacking: &mut [false; 560] };
            mark((&codes, 70, 0), (9, 1), &mut marks, &mut [true; 3]);
            assert!(marks.lacking.iter().all(|lacks| !lacks));
            // What had rays before gets more.
            marks.levels[3] = 1;
            mark((&codes, 70, 0), (9, 2), &mut marks, &mut [true; 3]);
            assert!(marks.lacking.iter().enumerate().all(|(i, lacks)| *lacks == (i == 3)));
        }
    }

    #[test]
    fn codes_are_near_those_of_files() {
        let mut codes = [[0; 3]];
        for v in 0..=1000 {
            encode(&[[v as f32 / 1000.0, -1.0, 2.0]], &mut codes);
            let true_code = (255.0 * encode_srgb(v as f64 / 1000.0)).round();
            assert!(
                (codes[0][0] as f64 - true_code).abs() <= 11.0 && codes[0][1..] == [0, 255],
                "{v}: {codes:?}, {true_code}"
            );
        }
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
