//! Several things done at the same time.

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

/// What `work` gives for each of `items`, in their order, on up to `hands` threads. Each is begun in the order given.
pub fn each<T: Sync, R: Send>(items: &[T], hands: usize, work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let done: Mutex<Vec<(usize, R)>> = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        let hand = || {
            while let Some((i, item)) = Some(next.fetch_add(1, Relaxed)).and_then(|i| Some((i, items.get(i)?))) {
                let result = work(item);
                done.lock().unwrap_or_else(PoisonError::into_inner).push((i, result));
            }
        };
        for _ in 1..hands.min(items.len()) {
            scope.spawn(hand);
        }
        hand(); // this thread works too, and alone where there are no others to be had
    });
    let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    done.sort_by_key(|(i, _)| *i);
    done.into_iter().map(|(_, result)| result).collect()
}

/// Threads that this machine runs at the same time.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, |n| n.get())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_stay_in_order() {
        let items: Vec<usize> = (0..100).collect();
        for hands in [0, 1, 3, 200] {
            assert_eq!(each(&items, hands, |i| i * 2), items.iter().map(|i| i * 2).collect::<Vec<_>>());
        }
        assert!(each(&[0; 0], 4, |i| *i).is_empty());
    }
}
