//! Pictures to files in memory, on a thread that can be left behind: encoders don't look at a leash, and a large picture
//! takes them longer than anyone who waits for a newer one should notice.

use super::desk::Leash;
use crate::film::{self, Film, Format, Recipe};
use std::io::{self, Cursor, Seek, SeekFrom, Write};
use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread::Builder;
use std::time::Duration;

/// How often it is looked whether to give up: less is felt by nobody, and this costs nothing yet.
const LOOK: Duration = Duration::from_millis(2);

/// Bytes handed on between two looks at the leash: a slow disk takes some milliseconds.
const PIECE: usize = 1 << 18;

/// `film` as a file in memory; `None`, within milliseconds, where the leash is pulled meanwhile.
pub fn encode(film: &Arc<Film>, format: Format, recipe: &Recipe, leash: &Arc<Leash>) -> Option<io::Result<Vec<u8>>> {
    let (film, recipe, seen) = (Arc::clone(film), recipe.clone(), Arc::clone(leash));
    let (end, ends) = channel();
    let work = move || {
        let mut file = Tied { out: Cursor::new(Vec::new()), leash: &seen };
        let encoded = film::encode(&film, format, &recipe, &mut file).map(|()| file.out.into_inner());
        drop(end.send(encoded)); // fails only where nobody waits any more
    };
    let thread = match Builder::new().name("encoder".into()).spawn(work) {
        Ok(thread) => thread,
        Err(e) => return Some(Err(e)),
    };
    loop {
        if leash.is_pulled() {
            return None;
        }
        match ends.recv_timeout(LOOK) {
            // Broken off as it was pulled.
            Ok(Err(_)) if leash.is_pulled() => return None,
            Ok(encoded) => return Some(encoded),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                return match thread.join() {
                    Err(panic) => std::panic::resume_unwind(panic),
                    Ok(()) => Some(Err(io::Error::other("the encoder gave nothing"))),
                };
            }
        }
    }
}

/// Hands `file` on to `out`.
///
/// # Errors
/// Those of `out`, and one where the leash is pulled before the end.
pub fn hand_on(file: &[u8], out: &mut impl Write, leash: &Leash) -> io::Result<()> {
    let mut out = Tied { out, leash };
    file.chunks(PIECE).try_for_each(|piece| out.write_all(piece))
}

/// A sink that takes nothing more once the leash is pulled.
struct Tied<'l, W> {
    out: W,
    leash: &'l Leash,
}

impl<W: Write> Write for Tied<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.leash.is_pulled() {
            // Not `Interrupted`: that would be tried again.
            true => Err(io::Error::other("given up for a newer picture")),
            false => self.out.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

impl<W: Seek> Seek for Tied<'_, W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.out.seek(to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::watch::desk::{Desk, Order, Urgency};
    use crate::film::{Compression, Depth};

    const FORMATS: [Format; 4] =
        [Format::PNG, Format::Png(Depth::Sixteen, Compression::Fast), Format::Exr, Format::Hdr];

    #[test]
    fn the_same_bytes_or_none() {
        let film = Arc::new(Film::new(40, 30));
        let desk = Desk::default();
        desk.put(Order::default(), Urgency::Now);
        let (_, leash) = desk.take().unwrap();
        for format in FORMATS {
            let mut plain = Cursor::new(Vec::new());
            film::encode(&film, format, &Recipe::new(), &mut plain).unwrap();
            let file = encode(&film, format, &Recipe::new(), &leash).unwrap().unwrap();
            assert_eq!(file, plain.into_inner());
            let mut out = Vec::new();
            hand_on(&file, &mut out, &leash).unwrap();
            assert_eq!(out, file);
        }
        desk.close();
        for format in FORMATS {
            assert!(encode(&film, format, &Recipe::new(), &leash).is_none());
        }
        let mut out = Vec::new();
        assert!(hand_on(&[1, 2], &mut out, &leash).is_err() && out.is_empty());
    }

    #[test]
    fn a_fault_of_the_format_is_told() {
        let nothing = Arc::new(Film::new(0, 4));
        let fault = encode(&nothing, FORMATS[0], &Recipe::new(), &Arc::default());
        assert!(fault.unwrap().is_err());
    }
}
