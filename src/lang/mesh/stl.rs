//! STL, 3D Systems' format for stereolithography, text and binary: triangles, each with its corners written out.
//!
//! "Stereolithography Interface Specification", 3D Systems, 1988. The normals that it writes beside the corners follow from them
//! and aren't read. Corners at the same place become one point.

use super::words::{self, words};
use super::{Raw, check_size};
use crate::lang::limits::Limits;
use crate::math::hash::KeyedHash;

/// Text before the triangles, and their count.
const HEADER: usize = 80 + 4;
/// Bytes of a triangle: normal and three corners, of three numbers each, and two bytes more.
const STRIDE: usize = 12 * 4 + 2;

/// Whether `bytes` are a binary file: its length follows from its count.
pub fn is_binary(bytes: &[u8]) -> bool {
    count(bytes).is_some_and(|n| bytes.len() as u64 == HEADER as u64 + n as u64 * STRIDE as u64)
}

fn count(bytes: &[u8]) -> Option<u32> {
    Some(u32::from_le_bytes(*bytes.get(80..HEADER)?.first_chunk()?))
}

/// The mesh of a binary file.
pub fn read_binary(bytes: &[u8], limits: &Limits) -> Result<Raw, String> {
    let count = count(bytes).unwrap_or(0) as usize;
    if count as u64 > limits.surfaces {
        return Err(super::too_large(limits));
    }
    let mut merger = Merger::new(3 * count);
    for row in bytes.get(HEADER..).unwrap_or_default().chunks_exact(STRIDE) {
        let number = |k: usize| f32::from_le_bytes([row[4 * k], row[4 * k + 1], row[4 * k + 2], row[4 * k + 3]]) as f64;
        let corner = |k: usize| [number(k), number(k + 1), number(k + 2)];
        let triangle = [corner(3), corner(6), corner(9)].map(|p| merger.number(p));
        merger.raw.triangles.push(triangle);
    }
    Ok(merger.raw)
}

/// The mesh of a text file.
pub fn read_text(bytes: &[u8], limits: &Limits) -> Result<Raw, String> {
    let mut merger = Merger::new(0);
    // Corners of the loop at hand: how many, the first and the last.
    let (mut corners, mut first, mut last) = (0, 0, 0);
    for (line, text) in words::lines(bytes) {
        let mut words = words(text);
        let number = |w: Option<&[u8]>| words::number(w, line);
        match words.next().map(<[u8]>::to_ascii_lowercase).as_deref() {
            Some(b"vertex") => {
                let p = [number(words.next())?, number(words.next())?, number(words.next())?];
                let point = merger.number(p);
                match corners {
                    0 => first = point,
                    1 => {}
                    _ => merger.raw.triangles.push([first, last, point]),
                }
                (corners, last) = (corners + 1, point);
            }
            Some(b"outer") => corners = 0,
            Some(b"endloop") if corners < 3 => return Err(format!("line {line}: this face has fewer than 3 corners")),
            Some(b"solid" | b"facet" | b"endloop" | b"endfacet" | b"endsolid") | None => {}
            Some(other) => {
                return Err(format!("line {line}: an STL file has no `{}`", words::shown(other)));
            }
        }
        check_size(&merger.raw, limits)?;
    }
    Ok(merger.raw)
}

/// Numbers points: those at the same place have the same number.
struct Merger {
    raw: Raw,
    /// Numbers of points by their hash, with room for twice as many; [`FREE`](Merger::FREE) where there is none.
    table: Vec<u32>,
}

impl Merger {
    const FREE: u32 = u32::MAX;

    /// With room for `corners` corners; of a closed mesh, six have the same place.
    fn new(corners: usize) -> Merger {
        Merger { raw: Raw::default(), table: vec![Merger::FREE; (corners / 2).next_power_of_two().max(16)] }
    }

    fn number(&mut self, p: [f64; 3]) -> u32 {
        if 2 * (self.raw.points.len() + 1) > self.table.len() {
            self.table = vec![Merger::FREE; 2 * self.table.len()];
            for i in 0..self.raw.points.len() {
                let at = self.find(self.raw.points[i]);
                self.table[at] = i as u32;
            }
        }
        let at = self.find(p);
        if self.table[at] == Merger::FREE {
            self.table[at] = self.raw.points.len() as u32;
            self.raw.points.push(p);
        }
        self.table[at]
    }

    /// Where in the table `p` stands, or would.
    fn find(&self, p: [f64; 3]) -> usize {
        let mask = self.table.len() - 1;
        let mut at = p.iter().fold(KeyedHash::new(), |h, x| h.with_f64(*x)).bits() as usize & mask;
        // The table is never full.
        while self.table[at] != Merger::FREE && self.raw.points[self.table[at] as usize] != p {
            at = (at + 1) & mask;
        }
        at
    }
}
