//! Threads that share a piece of work: as many as are useful. This one only waits for them, for its stack is of some other size.

use std::num::NonZero;
use std::sync::{Mutex, PoisonError};
use std::thread::{Builder, available_parallelism, scope};

/// Stack of a worker: patterns nest up to the language's limit, at a few hundred bytes a level.
const STACK: usize = 16 << 20;

/// Threads for `pieces` pieces of work where `asked` are wanted, or one a core.
pub fn useful(asked: Option<usize>, pieces: usize) -> usize {
    match pieces {
        0 | 1 => 1, // without asking the system, which takes its time
        _ => asked.unwrap_or_else(|| available_parallelism().map_or(1, NonZero::get)).clamp(1, pieces),
    }
}

/// Does `work` once on each of `threads` threads, at the same time, and gives back what each gave. Where the system has no
/// more threads, it is done by fewer.
pub fn crew<R: Send>(threads: usize, work: impl Fn() -> R + Sync) -> Vec<R> {
    scope(|s| {
        let start = |_| Builder::new().stack_size(STACK).spawn_scoped(s, &work).ok();
        let others: Vec<_> = (0..threads).map_while(start).collect();
        if others.is_empty() {
            return vec![work()]; // no threads to be had: this one does it
        }
        let join =
            |t: std::thread::ScopedJoinHandle<'_, R>| t.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        others.into_iter().map(join).collect()
    })
}

/// Does `work` on each of `pieces`, each by one of so many threads, which take them in order; gives back what the threads were given by
/// `start` to work with.
pub fn share_out<P, W: Send>(
    threads: usize,
    pieces: impl Iterator<Item = P> + Send,
    start: impl Fn() -> W + Sync,
    work: impl Fn(&mut W, P) + Sync,
) -> Vec<W> {
    let pieces = Mutex::new(pieces);
    let next = || pieces.lock().unwrap_or_else(PoisonError::into_inner).next();
    crew(threads, || {
        let mut with = start();
        while let Some(piece) = next() {
            work(&mut with, piece);
        }
        with
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Barrier;

    #[test]
    fn all_work_at_the_same_time() {
        let all_there = Barrier::new(3);
        let ids = crew(3, || {
            all_there.wait();
            std::thread::current().id()
        });
        assert!(ids.len() == 3 && ids[0] != ids[1] && ids[1] != ids[2]);
        assert_eq!(crew(1, || 7), [7]);
    }

    #[test]
    fn every_piece_is_worked_on_once() {
        let mut places = [0; 1000];
        let done = share_out(
            3,
            places.iter_mut().enumerate(),
            || 0,
            |count, (i, place)| {
                *place += i;
                *count += 1;
            },
        );
        assert_eq!((done.len(), done.iter().sum::<usize>()), (3, 1000));
        assert!(places.iter().enumerate().all(|(i, place)| i == *place));
    }

    #[test]
    fn no_more_threads_than_pieces() {
        assert_eq!((useful(Some(8), 3), useful(Some(2), 3), useful(None, 1), useful(Some(0), 9)), (3, 2, 1, 1));
    }
}
