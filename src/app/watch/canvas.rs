//! The picture as far as it has come, while it is traced: final tiles over what was there before.

use crate::app::progress::Bar;
use crate::film::Film;
use crate::render::{Crop, Progress};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::Duration;

/// Finished tiles, and the bar on the terminal.
pub struct Canvas {
    /// Those that nobody has looked at yet; nothing where nobody will.
    tiles: Option<Mutex<Vec<Tile>>>,
    finished: AtomicU64,
    /// Pixels that will be traced.
    all: u64,
    bar: Bar,
    ended: Mutex<bool>,
    bell: Condvar,
}

/// A tile and its pixels, row by row.
type Tile = (Crop, Vec<[f32; 3]>);

impl Canvas {
    /// For a picture of which `all` pixels will be traced; whether anybody will look at it meanwhile.
    pub fn new(all: u64, is_seen: bool, bar: Bar) -> Canvas {
        Canvas {
            tiles: is_seen.then(Mutex::default),
            finished: AtomicU64::new(0),
            all,
            bar,
            ended: Mutex::default(),
            bell: Condvar::new(),
        }
    }

    /// Puts the tiles that were finished since the last time into `film`.
    pub fn copy_to(&self, film: &mut Film) {
        let Some(tiles) = &self.tiles else { return };
        let tiles = std::mem::take(&mut *tiles.lock().unwrap_or_else(PoisonError::into_inner));
        let width = film.width as usize;
        for (tile, pixels) in tiles {
            for (row, y) in pixels.chunks(tile.width.max(1) as usize).zip(tile.y as usize..) {
                let start = y * width + tile.x as usize;
                if let Some(place) = film.pixels.get_mut(start..start + row.len()) {
                    place.copy_from_slice(row);
                }
            }
        }
    }

    /// No more tiles come.
    pub fn end(&self) {
        self.bar.clear();
        *self.ended.lock().unwrap_or_else(PoisonError::into_inner) = true;
        self.bell.notify_all();
    }

    /// Waits so long at most; whether it has ended.
    pub fn ends_within(&self, most: Duration) -> bool {
        let ended = self.ended.lock().unwrap_or_else(PoisonError::into_inner);
        *self.bell.wait_timeout_while(ended, most, |ended| !*ended).unwrap_or_else(PoisonError::into_inner).0
    }

    /// The share of pixels that is final, 0 to 1.
    pub fn progress(&self) -> f64 {
        self.finished.load(Relaxed) as f64 / self.all.max(1) as f64
    }
}

impl Progress for Canvas {
    fn finished(&self, tile: Crop, rows: &[&mut [[f32; 3]]]) {
        self.bar.finished(tile, rows);
        self.finished.fetch_add(tile.width as u64 * tile.height as u64, Relaxed);
        if let Some(tiles) = &self.tiles {
            let pixels = rows.iter().flat_map(|row| row.iter().copied()).collect();
            tiles.lock().unwrap_or_else(PoisonError::into_inner).push((tile, pixels));
        }
    }
}

/// `film` drawn larger, blended between its pixels: what a coarse picture says about the full one.
pub fn enlarged(film: &Film, width: u32, height: u32) -> Film {
    let mut out = Film::new(width, height);
    let (from_w, from_h) = (film.width as usize, film.height as usize);
    // The middle of an outer pixel, counted from the middles of the inner ones; which two it lies between, and where.
    let between = |at: usize, outer: u32, inner: usize| {
        let x = ((at as f32 + 0.5) / outer as f32 * inner as f32 - 0.5).clamp(0.0, (inner - 1) as f32);
        let first = x as usize;
        (first, (first + 1).min(inner - 1), x - first as f32)
    };
    let columns: Vec<_> = (0..width as usize).map(|x| between(x, width, from_w)).collect();
    for (y, row) in out.pixels.chunks_mut(width as usize).enumerate() {
        let (y0, y1, fy) = between(y, height, from_h);
        for (pixel, &(x0, x1, fx)) in row.iter_mut().zip(&columns) {
            let at = |x: usize, y: usize| film.pixels[y * from_w + x];
            *pixel = mix(mix(at(x0, y0), at(x1, y0), fx), mix(at(x0, y1), at(x1, y1), fx), fy);
        }
    }
    out
}

fn mix(a: [f32; 3], b: [f32; 3], t: f32) -> [f32; 3] {
    std::array::from_fn(|c| a[c] + t * (b[c] - a[c]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_find_their_place() {
        let canvas = Canvas::new(12, true, Bar::new(12, true));
        let mut row = [[1.0; 3], [2.0; 3]];
        canvas.finished(Crop { x: 2, y: 1, width: 2, height: 1 }, &[&mut row]);
        let mut film = Film::new(4, 3);
        canvas.copy_to(&mut film);
        assert_eq!(film.pixels[6..8], [[1.0; 3], [2.0; 3]]);
        assert_eq!(film.pixels.iter().filter(|p| **p != [0.0; 3]).count(), 2);
        assert!((canvas.progress() - 2.0 / 12.0).abs() < 1e-9);
    }

    #[test]
    fn enlarging_keeps_corners_and_blends_between() {
        let mut small = Film::new(2, 1);
        small.pixels[1] = [1.0, 2.0, 4.0];
        let large = enlarged(&small, 8, 3);
        assert_eq!((large.pixels[0], large.pixels[7], large.pixels[23]), ([0.0; 3], [1.0, 2.0, 4.0], [1.0, 2.0, 4.0]));
        assert!(large.pixels[..8].windows(2).all(|p| p[0][0] <= p[1][0]));
        assert_eq!(enlarged(&small, 2, 1), small);
    }
}
