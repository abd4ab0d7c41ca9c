//! PLY, the Stanford polygon format, text and binary: a header that describes rows of numbers, and the rows.
//!
//! Greg Turk, "The PLY polygon file format", 1994. Points and faces are read and whatever else a file has is passed over.

use super::words::shown;
use super::{AT_ONCE, Raw, point_number};
use crate::lang::limits::Limits;
use rayon::prelude::*;

/// How a number is stored.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Number {
    fn named(name: &str) -> Option<Number> {
        Some(match name {
            "char" | "int8" => Number::I8,
            "uchar" | "uint8" => Number::U8,
            "short" | "int16" => Number::I16,
            "ushort" | "uint16" => Number::U16,
            "int" | "int32" => Number::I32,
            "uint" | "uint32" => Number::U32,
            "float" | "float32" => Number::F32,
            "double" | "float64" => Number::F64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Number::I8 | Number::U8 => 1,
            Number::I16 | Number::U16 => 2,
            Number::I32 | Number::U32 | Number::F32 => 4,
            Number::F64 => 8,
        }
    }

    /// The number at the front of `bytes`, which holds it.
    #[inline(always)]
    fn read(self, bytes: &[u8], order: Order) -> f64 {
        fn front<const N: usize>(bytes: &[u8], order: Order) -> [u8; N] {
            let mut own = [0; N];
            own.copy_from_slice(&bytes[..N]);
            if order == Order::Big {
                own.reverse();
            }
            own
        }
        match self {
            Number::I8 => i8::from_le_bytes(front(bytes, order)) as f64,
            Number::U8 => bytes[0] as f64,
            Number::I16 => i16::from_le_bytes(front(bytes, order)) as f64,
            Number::U16 => u16::from_le_bytes(front(bytes, order)) as f64,
            Number::I32 => i32::from_le_bytes(front(bytes, order)) as f64,
            Number::U32 => u32::from_le_bytes(front(bytes, order)) as f64,
            Number::F32 => f32::from_le_bytes(front(bytes, order)) as f64,
            Number::F64 => f64::from_le_bytes(front(bytes, order)),
        }
    }
}

/// The order of a number's bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Order {
    Little,
    Big,
}

/// A column of a table.
#[derive(Debug)]
struct Property {
    name: String,
    number: Number,
    /// Of a list: how its length is stored.
    length: Option<Number>,
}

/// A table.
#[derive(Debug)]
struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

impl Element {
    /// Bytes of a row, where all have the same.
    fn stride(&self) -> Option<usize> {
        self.properties.iter().map(|p| p.length.is_none().then(|| p.number.size())).sum()
    }

    fn column(&self, names: &[&str]) -> Option<usize> {
        self.properties.iter().position(|p| names.contains(&p.name.as_str()))
    }
}

struct Header {
    /// `None` for text.
    order: Option<Order>,
    elements: Vec<Element>,
    /// Where the rows begin.
    end: usize,
}

/// The mesh that `bytes` describe; why they don't, in words, otherwise.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<Raw, String> {
    let header = header(bytes, limits)?;
    let points = header.elements.iter().find(|e| e.name == "vertex").map_or(0, |e| e.count);
    let rows = &bytes[header.end..];
    let mut rows = Rows { rest: rows, order: header.order };
    let mut raw = Raw::default();
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => vertices(element, &mut rows, &mut raw)?,
            "face" => faces(element, &mut rows, points, limits, &mut raw)?,
            _ => rows.pass_over(element)?,
        }
    }
    Ok(raw)
}

fn header(bytes: &[u8], limits: &Limits) -> Result<Header, String> {
    let (mut order, mut elements, mut end) = (Err(String::from("its header has no `format`")), Vec::new(), 0);
    loop {
        let Some(length) = bytes[end..].iter().position(|b| *b == b'\n') else {
            return Err("its header doesn't end".into());
        };
        let line = String::from_utf8_lossy(&bytes[end..end + length]);
        end += length + 1;
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let odd = || format!("its header has the line `{}`", shown(line.trim().as_bytes()));
        match words[..] {
            ["ply" | "comment" | "obj_info", ..] | [] => {}
            ["end_header"] => break,
            ["format", kind, _] => {
                order = Ok(match kind {
                    "ascii" => None,
                    "binary_little_endian" => Some(Order::Little),
                    "binary_big_endian" => Some(Order::Big),
                    _ => return Err(odd()),
                });
            }
            ["element", name, count] => {
                let count: u64 = count.parse().map_err(|_| odd())?;
                if matches!(name, "vertex" | "face") && count > limits.surfaces {
                    return Err(super::too_large(limits));
                }
                let count = usize::try_from(count).map_err(|_| odd())?;
                if elements.iter().any(|e: &Element| e.name == name) {
                    return Err(odd()); // of two tables of points, which one do faces mean?
                }
                elements.push(Element { name: name.to_owned(), count, properties: Vec::new() });
            }
            ["property", ref kind @ .., name] => {
                let (Some(element), Some(number)) = (elements.last_mut(), kind.last().and_then(|k| Number::named(k)))
                else {
                    return Err(odd());
                };
                let length = match kind {
                    [_] => None,
                    ["list", length, _] => Some(Number::named(length).ok_or_else(odd)?),
                    _ => return Err(odd()),
                };
                element.properties.push(Property { name: name.to_owned(), number, length });
            }
            _ => return Err(odd()),
        }
    }
    Ok(Header { order: order?, elements, end })
}

/// What is still to be read.
struct Rows<'b> {
    rest: &'b [u8],
    order: Option<Order>,
}

impl<'b> Rows<'b> {
    #[inline]
    fn number(&mut self, number: Number) -> Result<f64, String> {
        match self.order {
            Some(order) => Ok(number.read(self.take(number.size())?, order)),
            None => self.word(),
        }
    }

    fn word(&mut self) -> Result<f64, String> {
        let rest = self.rest.trim_ascii_start();
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        let (word, rest) = rest.split_at(length);
        self.rest = rest;
        if word.is_empty() {
            return Err(ends_early());
        }
        let number = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
        number.ok_or_else(|| format!("`{}` is no number", shown(word)))
    }

    fn take(&mut self, bytes: usize) -> Result<&'b [u8], String> {
        let (taken, rest) = self.rest.split_at_checked(bytes).ok_or_else(ends_early)?;
        self.rest = rest;
        Ok(taken)
    }

    /// The length of a list.
    fn length(&mut self, number: Number) -> Result<usize, String> {
        let n = self.number(number)?;
        // Every item takes a byte at least.
        match n >= 0.0 && n.fract() == 0.0 && n <= self.rest.len() as f64 {
            true => Ok(n as usize),
            false if n > 0.0 => Err(ends_early()),
            false => Err(format!("a list can't have {n} items")),
        }
    }

    fn pass_over_value(&mut self, p: &Property) -> Result<(), String> {
        let n = p.length.map_or(Ok(1), |length| self.length(length))?;
        match self.order {
            Some(_) => self.take(n.saturating_mul(p.number.size())).map(|_| ()),
            None => (0..n).try_for_each(|_| self.word().map(|_| ())),
        }
    }

    fn pass_over(&mut self, element: &Element) -> Result<(), String> {
        if let (Some(_), Some(stride)) = (self.order, element.stride()) {
            return self.take(element.count.saturating_mul(stride)).map(|_| ());
        }
        if element.properties.is_empty() {
            return Ok(());
        }
        (0..element.count).try_for_each(|_| element.properties.iter().try_for_each(|p| self.pass_over_value(p)))
    }
}

fn ends_early() -> String {
    "it is damaged: it ends too early".into()
}

fn vertices(element: &Element, rows: &mut Rows<'_>, raw: &mut Raw) -> Result<(), String> {
    let scalar = |name: &str| {
        let at = element.column(&[name]);
        at.filter(|&i| element.properties[i].length.is_none()).ok_or_else(|| format!("its points have no `{name}`"))
    };
    let columns = [scalar("x")?, scalar("y")?, scalar("z")?];
    let directions = match [scalar("nx"), scalar("ny"), scalar("nz")] {
        [Ok(x), Ok(y), Ok(z)] => Some([x, y, z]),
        _ => None,
    };
    if let (Some(order), Some(stride)) = (rows.order, element.stride()) {
        let table = rows.take(element.count.saturating_mul(stride))?;
        let place = |i: usize| element.properties[..i].iter().map(|p| p.number.size()).sum::<usize>();
        let three = |columns: [usize; 3]| {
            let [x, y, z] = columns.map(|i| (element.properties[i].number, place(i)));
            move |row: &[u8]| [x, y, z].map(|(number, at)| number.read(&row[at..], order))
        };
        let lines = || table.par_chunks_exact(stride).with_min_len(AT_ONCE);
        raw.points = lines().map(three(columns)).collect();
        if let Some(directions) = directions {
            let direction = three(directions);
            raw.normals = lines().map(|row| direction(row).map(|x| x as f32)).collect();
        }
        return Ok(());
    }
    let mut values = vec![0.0; element.properties.len()];
    for _ in 0..element.count {
        for (value, p) in values.iter_mut().zip(&element.properties) {
            match p.length {
                None => *value = rows.number(p.number)?,
                Some(_) => rows.pass_over_value(p)?,
            }
        }
        raw.points.push(columns.map(|i| values[i]));
        if let Some(directions) = directions {
            raw.normals.push(directions.map(|i| values[i] as f32));
        }
    }
    Ok(())
}

fn faces(element: &Element, rows: &mut Rows<'_>, points: usize, limits: &Limits, raw: &mut Raw) -> Result<(), String> {
    let list = element.column(&["vertex_indices", "vertex_index"]);
    let list = list.filter(|&i| element.properties[i].length.is_some());
    let list = list.ok_or("its faces have no list `vertex_indices`")?;
    if let ([Property { length: Some(Number::U8), number: Number::I32 | Number::U32, .. }], Some(order)) =
        (&element.properties[..], rows.order)
        && let Some(triangles) = plain_triangles(rows, element.count, order, points)
    {
        raw.triangles = triangles;
        return Ok(());
    }
    for face in 1..=element.count {
        for (i, p) in element.properties.iter().enumerate() {
            let (true, Some(length)) = (i == list, p.length) else {
                rows.pass_over_value(p)?;
                continue;
            };
            let n = rows.length(length)?;
            let mut fan = [0; 2];
            for k in 0..n {
                let corner = point_number(rows.number(p.number)?, points, face)?;
                match k {
                    0 | 1 => fan[k] = corner,
                    _ => {
                        raw.triangles.push([fan[0], fan[1], corner]);
                        fan[1] = corner;
                    }
                }
            }
            super::check_size(raw, limits)?;
        }
    }
    Ok(())
}

/// The faces where all are triangles that name points which there are: rows of one size, then, which are read at once.
fn plain_triangles(rows: &mut Rows<'_>, count: usize, order: Order, points: usize) -> Option<Vec<[u32; 3]>> {
    const STRIDE: usize = 1 + 3 * 4;
    let (table, rest) = rows.rest.split_at_checked(count.checked_mul(STRIDE)?)?;
    let lines = || table.par_chunks_exact(STRIDE).with_min_len(AT_ONCE);
    let index = |row: &[u8], k: usize| Number::U32.read(&row[1 + 4 * k..], order) as u32;
    let fits = |row: &[u8]| row[0] == 3 && (0..3).all(|k| (index(row, k) as usize) < points);
    if !lines().all(fits) {
        return None;
    }
    rows.rest = rest;
    Some(lines().map(|row| [index(row, 0), index(row, 1), index(row, 2)]).collect())
}
