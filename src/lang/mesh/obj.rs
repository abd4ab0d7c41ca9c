//! OBJ, Wavefront's text format: a statement a line, of which points, directions and faces are read.
//!
//! "Object Files (.obj)", appendix B1 of the Advanced Visualizer manual, Alias|Wavefront, 1995. Curves, texture coordinates, groups
//! and material names are passed over.

use super::words::{self, words};
use super::{Raw, plural};
use crate::lang::limits::Limits;
use crate::scene::MeshData;

/// The largest number of a point or direction that a face names, and its line.
#[derive(Default)]
struct Largest {
    number: u32,
    line: usize,
}

/// The mesh that `bytes` describe; why they don't, in words, otherwise.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<Raw, String> {
    let mut raw = Raw::default();
    let (mut largest, mut largest_normal) = (Largest::default(), Largest::default());
    let mut corners: Vec<(u32, u32)> = Vec::new();
    for (line, text) in words::lines(bytes) {
        let mut words = words(text);
        let number = |w: Option<&[u8]>| words::number(w, line);
        match words.next() {
            Some(b"v") => raw.points.push([number(words.next())?, number(words.next())?, number(words.next())?]),
            Some(b"vn") => {
                let n = [number(words.next())?, number(words.next())?, number(words.next())?];
                raw.normals.push(n.map(|x| x as f32));
            }
            Some(b"f") => {
                corners.clear();
                for word in words {
                    let (point, normal) = corner(word, (raw.points.len(), raw.normals.len()), line)?;
                    note(&mut largest, point, line);
                    note(&mut largest_normal, normal, line);
                    corners.push((point, normal));
                }
                if corners.len() < 3 {
                    return Err(format!("line {line}: a face needs 3 corners at least"));
                }
                for w in corners[1..].windows(2) {
                    let face = [corners[0], w[0], w[1]];
                    raw.triangles.push(face.map(|c| c.0));
                    raw.normals_of.push(face.map(|c| c.1));
                }
            }
            _ => {}
        }
        super::check_size(&raw, limits)?;
    }
    for (largest, count, what) in
        [(largest, raw.points.len(), "point"), (largest_normal, raw.normals.len(), "direction")]
    {
        if largest.line > 0 && largest.number as usize >= count {
            let (line, n) = (largest.line, largest.number as u64 + 1);
            return Err(format!("line {line}: a face names {what} {n}, and there are {}", plural(count, what)));
        }
    }
    if raw.normals.is_empty() || raw.normals_of == raw.triangles {
        raw.normals_of = Vec::new();
    }
    Ok(raw)
}

fn note(largest: &mut Largest, number: u32, line: usize) {
    if number != MeshData::FLAT && (largest.line == 0 || number > largest.number) {
        *largest = Largest { number, line };
    }
}

/// The point and the direction of a corner, `7`, `7/2`, `7//3` or `7/2/3`, counted from 0.
fn corner(word: &[u8], (points, normals): (usize, usize), line: usize) -> Result<(u32, u32), String> {
    let mut numbers = word.split(|b| *b == b'/');
    let (point, _, normal) = (numbers.next(), numbers.next(), numbers.next());
    let number = |word: &[u8], count: usize| {
        let n: Option<i64> = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
        // From 1 upwards, or backwards from the last one so far.
        let n = n.and_then(|n| match n {
            1.. => Some(n - 1),
            0 => None,
            _ => (count as i64).checked_add(n).filter(|n| *n >= 0),
        });
        let n = n.and_then(|n| u32::try_from(n).ok()).filter(|n| *n != MeshData::FLAT);
        n.ok_or_else(|| format!("line {line}: a face can't have the corner `{}`", words::shown(word)))
    };
    let point = number(point.unwrap_or_default(), points)?;
    let normal = match normal {
        Some(n) if !n.is_empty() => number(n, normals)?,
        _ => MeshData::FLAT,
    };
    Ok((point, normal))
}
