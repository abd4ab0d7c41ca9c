//! A picture on its way out: tiles are handed out row by row of tiles, their pixels come back in any order, and the rows of
//! pixels are given on in order, by whichever thread finished what was missing. Only a few rows of tiles are there at a
//! time, however large the picture is.

use super::options::Crop;
use std::collections::VecDeque;
use std::io;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// The picture on its way.
pub struct Belt {
    part: Crop,
    side: u32,
    pixel_bytes: usize,
    /// Bands that are there at a time.
    ahead: usize,
    state: Mutex<State>,
    /// A band was given on, or all was stopped.
    moved: Condvar,
}

struct State {
    /// The tile to be handed out next.
    next: usize,
    /// Bands that were given on.
    gone: usize,
    /// Those that are there, from number `gone` on.
    bands: VecDeque<Band>,
    /// Room for another.
    spare: Vec<Vec<u8>>,
    /// Whether a thread is giving on.
    giving: bool,
    stopped: bool,
    fault: Option<io::Error>,
}

/// A row of tiles.
struct Band {
    bytes: Vec<u8>,
    /// Tiles that aren't back yet.
    missing: usize,
}

/// Tiles a thread that may be there: enough that one slow tile keeps nobody waiting for long.
const TILES_A_THREAD: usize = 256;

impl Belt {
    /// For the tiles of side `side` of `part`, with so many bytes a pixel, made by so many threads.
    pub fn new(part: Crop, side: u32, pixel_bytes: usize, threads: usize) -> Belt {
        let columns = part.width.div_ceil(side).max(1) as usize;
        let ahead = 1 + (TILES_A_THREAD * threads).div_ceil(columns);
        let state = State {
            next: 0,
            gone: 0,
            bands: VecDeque::new(),
            spare: Vec::new(),
            giving: false,
            stopped: false,
            fault: None,
        };
        Belt { part, side, pixel_bytes, ahead, state: Mutex::new(state), moved: Condvar::new() }
    }

    /// The next tile to be made; `None` where there is none, or all was stopped. Waits while too many are there.
    pub fn next(&self) -> Option<Crop> {
        let (part, side) = (self.part, self.side);
        let columns = part.width.div_ceil(side) as usize;
        let rows = part.height.div_ceil(side) as usize;
        let mut state = self.lock();
        loop {
            if state.stopped || state.next == columns * rows {
                return None;
            }
            let band = state.next / columns;
            if band < state.gone + self.ahead {
                let (x, y) = ((state.next % columns) as u32 * side, band as u32 * side);
                let (width, height) = (side.min(part.width - x), side.min(part.height - y));
                if band == state.gone + state.bands.len() {
                    let mut bytes = state.spare.pop().unwrap_or_default();
                    bytes.resize(height as usize * self.row_bytes(), 0);
                    state.bands.push_back(Band { bytes, missing: columns });
                }
                state.next += 1;
                return Some(Crop { x: part.x + x, y: part.y + y, width, height });
            }
            state = self.moved.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Brings back a tile's pixels, row by row, and gives `take` what is complete: one thread at a time, in order.
    pub fn put(&self, tile: Crop, pixels: &[u8], take: &(dyn Fn(&[u8]) -> io::Result<()> + Sync)) {
        let mut state = self.lock();
        let number = ((tile.y - self.part.y) / self.side) as usize - state.gone;
        let (start, length) =
            ((tile.x - self.part.x) as usize * self.pixel_bytes, tile.width as usize * self.pixel_bytes);
        let Some(band) = state.bands.get_mut(number) else { return };
        for (row, piece) in band.bytes.chunks_mut(self.row_bytes()).zip(pixels.chunks(length)) {
            row[start..start + length].copy_from_slice(piece);
        }
        band.missing -= 1;
        if state.giving {
            return; // that thread looks again before it ends
        }
        state.giving = true;
        while !state.stopped
            && let Some(Band { bytes, .. }) = state.bands.pop_front_if(|band| band.missing == 0)
        {
            state.gone += 1;
            drop(state);
            self.moved.notify_all();
            let given = take(&bytes);
            state = self.lock();
            state.spare.push(bytes);
            if let Err(e) = given {
                state.fault = Some(e);
                state.stopped = true;
                self.moved.notify_all();
            }
        }
        state.giving = false;
    }

    /// No more tiles are handed out.
    pub fn stop(&self) {
        self.lock().stopped = true;
        self.moved.notify_all();
    }

    /// The fault that stopped it, if one did.
    pub fn end(self) -> io::Result<()> {
        let state = self.state.into_inner().unwrap_or_else(PoisonError::into_inner);
        state.fault.map_or(Ok(()), Err)
    }

    fn row_bytes(&self) -> usize {
        self.part.width as usize * self.pixel_bytes
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // Every change is finished before anything can panic.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Stops a belt where the thread that works on it panics, so that none waits for it.
pub struct Watchman<'b>(pub &'b Belt);

impl Drop for Watchman<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.stop();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PART: Crop = Crop { x: 5, y: 3, width: 37, height: 21 };

    /// What `pixels` shall hold: two bytes a pixel, its place.
    fn codes(tile: Crop) -> Vec<u8> {
        (0..tile.height)
            .flat_map(|y| (0..tile.width).flat_map(move |x| [(tile.x + x) as u8, (tile.y + y) as u8]))
            .collect()
    }

    #[test]
    fn tiles_in_any_order_make_rows_in_order() {
        let belt = Belt::new(PART, 8, 2, 1);
        let out = Mutex::new(Vec::new());
        let take = |rows: &[u8]| {
            out.lock().unwrap().extend_from_slice(rows);
            Ok(())
        };
        let mut tiles = Vec::new();
        while let Some(tile) = belt.next() {
            tiles.push(tile);
        }
        assert_eq!(tiles.len(), 15);
        for tile in tiles.iter().rev() {
            assert!(out.lock().unwrap().is_empty(), "nothing goes before the very first tile");
            belt.put(*tile, &codes(*tile), &take);
        }
        assert!(*out.lock().unwrap() == codes(PART));
        belt.end().unwrap();
    }

    #[test]
    fn only_a_few_rows_of_tiles_are_there() {
        let wide = Crop { x: 0, y: 0, width: 256, height: 9 };
        let belt = Belt::new(wide, 1, 1, 1); // so that two of its rows may be there
        let tiles: Vec<Crop> = (0..512).filter_map(|_| belt.next()).collect();
        std::thread::scope(|s| {
            let waiting = s.spawn(|| belt.next());
            for tile in &tiles[..256] {
                assert!(!waiting.is_finished());
                belt.put(*tile, &[0], &|_| Ok(()));
            }
            assert_eq!(waiting.join().unwrap().map(|t| (t.x, t.y)), Some((0, 2)));
        });
    }

    #[test]
    fn a_fault_and_a_panic_stop_it() {
        let belt = Belt::new(PART, 32, 2, 1);
        let tiles = [belt.next().unwrap(), belt.next().unwrap()];
        for tile in tiles {
            belt.put(tile, &codes(tile), &|_| Err(io::Error::other("full")));
        }
        assert!(belt.next().is_none());
        assert_eq!(belt.end().unwrap_err().to_string(), "full");

        let belt = Belt::new(PART, 1, 2, 1);
        let panics = || {
            let _watchman = Watchman(&belt);
            std::panic::resume_unwind(Box::new("a fault elsewhere"));
        };
        std::thread::scope(|s| assert!(s.spawn(panics).join().is_err()));
        assert!(belt.next().is_none());
    }
}
