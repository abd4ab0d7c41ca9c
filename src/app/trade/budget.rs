//! The time that there is, and the two things that end work before it is done: that time, and the user.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

/// The time that all measuring may take. Clones are the same budget.
#[derive(Clone)]
pub struct Budget {
    end: Instant,
    /// Set while work is to end.
    cancel: Arc<AtomicBool>,
    /// Set once the user wants it to.
    interrupted: Arc<AtomicBool>,
}

impl Budget {
    /// So many seconds from now on.
    pub fn new(seconds: f64) -> Budget {
        let length = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
        // A century is as good as for ever, and no clock overflows.
        let length = length.min(Duration::from_secs(100 * 365 * 86_400));
        Budget { end: Instant::now() + length, cancel: Arc::default(), interrupted: Arc::default() }
    }

    /// Seconds that are left.
    pub fn left(&self) -> f64 {
        self.end.saturating_duration_since(Instant::now()).as_secs_f64()
    }

    /// What the user does who wants no more.
    pub fn interrupt(&self) {
        self.interrupted.store(true, SeqCst);
        self.cancel.store(true, SeqCst);
    }

    /// Whether the user did.
    pub fn is_interrupted(&self) -> bool {
        self.interrupted.load(SeqCst)
    }

    /// Does `work`, which ends soon after the flag that it is given is set: after `seconds`, at the end of the budget or when the
    /// user wants it, whichever comes first.
    pub fn within<T>(&self, seconds: f64, work: impl FnOnce(&AtomicBool) -> T) -> T {
        let left = self.left();
        let seconds = if seconds < left { seconds } else { left };
        let alarm = Alarm::set(seconds, Arc::clone(&self.cancel));
        let done = work(&self.cancel);
        // The alarm is over; what the user wants isn't.
        drop(alarm);
        self.cancel.store(false, SeqCst);
        if self.is_interrupted() {
            self.cancel.store(true, SeqCst);
        }
        done
    }
}

/// Sets a flag after a time; silent from when it is dropped.
struct Alarm {
    off: Option<Sender<()>>,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl Alarm {
    fn set(seconds: f64, flag: Arc<AtomicBool>) -> Alarm {
        let (off, wait) = channel();
        let length = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
        let wake = move || {
            if wait.recv_timeout(length) == Err(RecvTimeoutError::Timeout) {
                flag.store(true, SeqCst);
            }
        };
        // Without a thread to be had, work isn't cut short.
        let thread = std::thread::Builder::new().name("alarm".into()).spawn(wake).ok();
        Alarm { off: Some(off), thread }
    }
}

impl Drop for Alarm {
    fn drop(&mut self) {
        drop(self.off.take());
        if let Some(thread) = self.thread.take() {
            // Over at once: it waits for nothing but this. It can't have panicked.
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn until_cancelled(cancel: &AtomicBool) {
        while !cancel.load(SeqCst) {
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    #[test]
    fn work_ends_and_the_next_may_begin() {
        let budget = Budget::new(1000.0);
        budget.within(0.01, until_cancelled);
        assert!(!budget.within(500.0, |cancel| cancel.load(SeqCst)), "the flag is down again");
        let user = budget.clone();
        budget.within(500.0, |cancel| {
            user.interrupt();
            until_cancelled(cancel);
        });
        assert!(budget.is_interrupted() && budget.within(500.0, |cancel| cancel.load(SeqCst)), "once and for all");
        assert!(budget.left() > 900.0);
    }

    #[test]
    fn nothing_is_left_of_a_budget_that_is_spent() {
        let budget = Budget::new(0.0);
        assert_eq!(budget.left(), 0.0);
        budget.within(500.0, until_cancelled);
        assert!(Budget::new(f64::INFINITY).left() > 1e9);
    }
}
