//! Small pictures of large ones.

use crate::film::Film;

/// `film` with `width` pixels across, which is less than it has, in its own proportions: each pixel is the mean, in linear
/// light, of the area that it covers.
pub fn shrink(film: &Film, width: u32) -> Film {
    let height = scaled(film.height, width, film.width);
    let mut small = Film::new(width, height);
    let (columns, rows) = (spans(film.width, width), spans(film.height, height));
    let pixels = small
        .pixels
        .chunks_mut(width.max(1) as usize)
        .zip(&rows)
        .flat_map(|(row, span)| row.iter_mut().zip(&columns).map(move |(pixel, column)| (pixel, column, span)));
    for (pixel, column, row) in pixels {
        let (mut sum, mut area) = ([0.0; 3], 0.0);
        for &(y, dy) in row {
            for &(x, dx) in column {
                let Some(p) = film.pixels.get(y * film.width as usize + x) else { continue };
                sum = std::array::from_fn(|c| sum[c] + dx * dy * p[c] as f64);
                area += dx * dy;
            }
        }
        *pixel = sum.map(|s| (s / area) as f32);
    }
    small
}

/// `side` in the proportion `to : from`, rounded, at least 1.
pub fn scaled(side: u32, to: u32, from: u32) -> u32 {
    let (side, to, from) = (side as u64, to as u64, from.max(1) as u64);
    ((side * to + from / 2) / from).clamp(1, u32::MAX as u64) as u32
}

/// For each of `to` pixels, the pixels of `from` that it covers and how much of each, in parts of its own.
fn spans(from: u32, to: u32) -> Vec<Vec<(usize, f64)>> {
    let (from, to) = (from as u64, to as u64);
    // In units in which a large pixel has the length `from` and a small one `to`.
    let span = |i: u64| {
        let (start, end) = (i * from, (i + 1) * from);
        (start / to..end.div_ceil(to))
            .map(|k| (k as usize, (end.min((k + 1) * to) - start.max(k * to)) as f64))
            .collect()
    };
    (0..to).map(span).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_counts_by_its_area() {
        let mut film = Film::new(3, 1);
        film.pixels = vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let small = shrink(&film, 2);
        let third = |x: f32| (x * 3.0).round() as i32;
        assert_eq!((small.width, small.height), (2, 1));
        assert_eq!(small.pixels[0].map(third), [2, 1, 0]);
        assert_eq!(small.pixels[1].map(third), [0, 1, 2]);
    }

    #[test]
    fn an_even_picture_stays_even() {
        let mut film = Film::new(1280, 719);
        film.pixels.fill([0.25, 0.5, 4.0]);
        let small = shrink(&film, 480);
        assert_eq!((small.width, small.height), (480, 270));
        assert!(small.pixels.iter().all(|p| *p == [0.25, 0.5, 4.0]));
        assert_eq!(scaled(1, 1, 100), 1, "never nothing");
    }
}
