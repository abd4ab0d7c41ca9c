//! PNG files. The `png` crate reads them, but for what is of one byte a texel: that is inflated where it stays, for it is the
//! quickest to read of all pictures, and a copy would take a good part of the time.

use super::{Picture, ReadError};
use crate::scene::Texels;
use std::io::Cursor;

const DAMAGED: ReadError = ReadError::Damaged("PNG");

/// The picture, if its size is `allowed`.
///
/// # Errors
/// That of `allowed`, and a file that isn't whole.
pub fn read(bytes: &[u8], allowed: impl Fn(u32, u32) -> Result<(), ReadError>) -> Result<Picture, ReadError> {
    let damaged = |_| DAMAGED;
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::EXPAND);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let info = decoder.read_header_info().map_err(damaged)?;
    let (width, height) = info.size();
    allowed(width, height)?;
    let texels = match (info.color_type, info.bit_depth, info.interlaced) {
        (png::ColorType::Grayscale, png::BitDepth::Eight, false) => Texels::gray(one_byte(bytes, width, height)?),
        (png::ColorType::Indexed, png::BitDepth::Eight, false) => {
            let colors = palette(bytes)?;
            Texels::Numbers { numbers: one_byte(bytes, width, height)?, colors }
        }
        _ => Texels::Colors(colors(decoder)?),
    };
    Ok(Picture { width, height, texels })
}

/// What the `png` crate makes of the file, brought to three channels of 8 bits.
fn colors(decoder: png::Decoder<Cursor<&[u8]>>) -> Result<Vec<u8>, ReadError> {
    let damaged = |_| DAMAGED;
    let mut reader = decoder.read_info().map_err(damaged)?;
    let form = reader.output_color_type();
    let mut data = vec![0; reader.output_buffer_size().ok_or(DAMAGED)?];
    reader.next_frame(&mut data).map_err(damaged)?;
    if form == (png::ColorType::Rgb, png::BitDepth::Eight) {
        return Ok(data);
    }
    let (samples, is_wide) = (form.0.samples(), form.1 == png::BitDepth::Sixteen);
    let texel = |texel: &[u8]| {
        let at = |i: usize| match is_wide {
            false => texel[i],
            // The nearest of 256 steps.
            true => ((u16::from_be_bytes([texel[2 * i], texel[2 * i + 1]]) as u32 + 128) / 257) as u8,
        };
        if samples < 3 { [at(0); 3] } else { [at(0), at(1), at(2)] }
    };
    let texels: Vec<[u8; 3]> = data.chunks_exact(samples << u32::from(is_wide)).map(texel).collect();
    Ok(texels.into_flattened())
}

/// The pixels of a file with one byte each, in rows that follow each other.
fn one_byte(bytes: &[u8], width: u32, height: u32) -> Result<Vec<u8>, ReadError> {
    let (width, height) = (width as usize, height as usize);
    // Each row is headed by the number of its filter.
    let mut data = vec![0; (width + 1) * height];
    let mut inflater = fdeflate::Decompressor::new();
    // Each chunk has a checksum already.
    inflater.ignore_adler32();
    let mut filled = 0;
    let pieces = chunks(bytes).filter_map(|(kind, piece)| (kind == *b"IDAT").then_some(piece));
    for (mut piece, is_last) in pieces.map(|piece| (piece, false)).chain([(&[][..], true)]) {
        while filled < data.len() && !inflater.is_done() {
            let (consumed, produced) = inflater.read(piece, &mut data, filled, is_last).map_err(|_| DAMAGED)?;
            filled += produced;
            piece = &piece[consumed..];
            if piece.is_empty() {
                break;
            }
        }
    }
    if filled < data.len() {
        return Err(DAMAGED);
    }
    let black = vec![0; width];
    for y in 0..height {
        let (from, to) = (y * (width + 1), y * width);
        let filter = data[from];
        data.copy_within(from + 1..from + 1 + width, to);
        let (before, row) = data.split_at_mut(to);
        let row = &mut row[..width];
        unfilter(filter, before.rchunks_exact(width).next().unwrap_or(&black), row).ok_or(DAMAGED)?;
    }
    data.truncate(width * height);
    Ok(data)
}

/// Brings back a row of which each byte was filtered (PNG Specification, Third Edition, 9.2), where a pixel is one byte.
/// `None`: there is no such filter. A function of its own, for so the rows are known not to overlap.
#[inline(never)]
fn unfilter(filter: u8, above: &[u8], row: &mut [u8]) -> Option<()> {
    let (mut left, mut corner) = (0u8, 0u8);
    match filter {
        0 => {}
        1 => row.iter_mut().for_each(|x| {
            *x = x.wrapping_add(left);
            left = *x;
        }),
        2 => row.iter_mut().zip(above).for_each(|(x, b)| *x = x.wrapping_add(*b)),
        3 => row.iter_mut().zip(above).for_each(|(x, b)| {
            *x = x.wrapping_add(left.midpoint(*b));
            left = *x;
        }),
        4 => row.iter_mut().zip(above).for_each(|(x, &b)| {
            let far = |i: u8| (i16::from(left) + i16::from(b) - i16::from(corner) - i16::from(i)).unsigned_abs();
            let (a_far, b_far, c_far) = (far(left), far(b), far(corner));
            let nearest = if a_far <= b_far && a_far <= c_far {
                left
            } else if b_far <= c_far {
                b
            } else {
                corner
            };
            *x = x.wrapping_add(nearest);
            (left, corner) = (*x, b);
        }),
        _ => return None,
    }
    Some(())
}

/// The colours that the numbers of a file stand for; black for numbers that stand for none.
fn palette(bytes: &[u8]) -> Result<Box<[[u8; 3]; 256]>, ReadError> {
    let (_, listed) = chunks(bytes).find(|(kind, _)| kind == b"PLTE").ok_or(DAMAGED)?;
    let mut colors = Box::new([[0; 3]; 256]);
    for (color, listed) in colors.iter_mut().zip(listed.as_chunks().0) {
        *color = *listed;
    }
    Ok(colors)
}

/// The chunks of a file, as far as they are whole: what each is, and what it holds.
fn chunks(bytes: &[u8]) -> impl Iterator<Item = ([u8; 4], &[u8])> {
    let mut rest = bytes.get(8..).unwrap_or(&[]);
    std::iter::from_fn(move || {
        let (length, from_kind) = rest.split_first_chunk()?;
        let length = u32::from_be_bytes(*length) as usize;
        let (kind_and_data, after) = from_kind.split_at_checked(length.checked_add(4)?)?;
        let (sum, after) = after.split_first_chunk()?;
        let (kind, data) = kind_and_data.split_first_chunk()?;
        rest = after;
        (crc32fast::hash(kind_and_data) == u32::from_be_bytes(*sum)).then_some((*kind, data))
    })
}
