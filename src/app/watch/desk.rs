//! Where the loop lays down what is to be painted next and the painter picks it up. Only the newest counts: what lies there
//! unstarted is replaced, what is being painted is told to stop.

use std::sync::atomic::{AtomicBool, Ordering::SeqCst};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Why there is something to paint, and with which values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Order {
    /// Files whose content changed, as messages name them.
    pub changed: Vec<String>,
    /// Parameters that a page changed.
    pub asked: Vec<String>,
    /// Values of parameters, as for `--set`.
    pub set: Vec<(String, String)>,
    /// Which of them come from a page: those that the scene no longer has are let go silently.
    pub from_page: Vec<String>,
}

/// How urgent an order is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Urgency {
    /// What is being painted shows a text that is out of date: it stops now.
    Now,
    /// What is being painted may show one picture first. While a slider moves there is always a newer value; if each stopped
    /// the one before, nothing would ever be seen.
    AfterOnePicture,
}

/// The desk.
#[derive(Default)]
pub struct Desk {
    state: Mutex<State>,
    bell: Condvar,
}

#[derive(Default)]
struct State {
    waiting: Option<Order>,
    current: Option<Arc<Leash>>,
    closed: bool,
}

/// What the painter asks now and then: shall I go on?
#[derive(Debug, Default)]
pub struct Leash {
    cancel: AtomicBool,
    shown: AtomicBool,
    cancel_when_shown: AtomicBool,
    cancelled_at: Mutex<Option<Instant>>,
}

impl Desk {
    /// Lays down an order.
    pub fn put(&self, mut order: Order, urgency: Urgency) {
        let mut state = self.state();
        if let Some(unstarted) = state.waiting.take() {
            merge(&mut order.changed, unstarted.changed);
            merge(&mut order.asked, unstarted.asked);
        }
        state.waiting = Some(order);
        if let Some(leash) = &state.current {
            match urgency {
                Urgency::Now => leash.pull(),
                Urgency::AfterOnePicture => leash.pull_when_shown(),
            }
        }
        self.bell.notify_all();
    }

    /// No more orders; what is being painted stops.
    pub fn close(&self) {
        let mut state = self.state();
        state.closed = true;
        state.current.iter().for_each(|leash| leash.pull());
        self.bell.notify_all();
    }

    /// Waits for the next order; `None` once the desk is closed.
    pub fn take(&self) -> Option<(Order, Arc<Leash>)> {
        let mut state = self.state();
        state.current = None;
        loop {
            if state.closed {
                return None;
            }
            if let Some(order) = state.waiting.take() {
                let leash = Arc::new(Leash::default());
                state.current = Some(Arc::clone(&leash));
                return Some((order, leash));
            }
            state = self.bell.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn merge(into: &mut Vec<String>, older: Vec<String>) {
    let newer = std::mem::replace(into, older);
    newer.into_iter().for_each(|n| {
        if !into.contains(&n) {
            into.push(n);
        }
    });
}

impl Leash {
    /// Set when the painter shall stop.
    pub fn cancel(&self) -> &AtomicBool {
        &self.cancel
    }

    /// A picture of this order can be seen.
    pub fn shown(&self) {
        self.shown.store(true, SeqCst);
        if self.cancel_when_shown.load(SeqCst) {
            self.pull();
        }
    }

    /// Whether the painter shall stop.
    pub fn is_pulled(&self) -> bool {
        self.cancel.load(SeqCst)
    }

    /// How long ago it was told to stop; `None` where it wasn't.
    pub fn since_cancelled(&self) -> Option<Duration> {
        let at = *self.cancelled_at.lock().unwrap_or_else(PoisonError::into_inner);
        at.map(|at| at.elapsed())
    }

    fn pull(&self) {
        self.cancelled_at.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert_with(Instant::now);
        self.cancel.store(true, SeqCst);
    }

    fn pull_when_shown(&self) {
        self.cancel_when_shown.store(true, SeqCst);
        if self.shown.load(SeqCst) {
            self.pull();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn order(changed: &[&str], asked: &[&str]) -> Order {
        let own = |all: &[&str]| all.iter().map(|s| s.to_string()).collect();
        Order { changed: own(changed), asked: own(asked), ..Order::default() }
    }

    #[test]
    fn the_newest_order_stands_for_all_that_were_not_started() {
        let desk = Desk::default();
        desk.put(order(&["a"], &[]), Urgency::Now);
        desk.put(order(&["b", "a"], &["count"]), Urgency::Now);
        let (taken, leash) = desk.take().unwrap();
        assert_eq!(taken, order(&["a", "b"], &["count"]));
        assert!(!leash.cancel().load(SeqCst), "nothing was being painted yet");
        desk.put(order(&["c"], &[]), Urgency::Now);
        assert!(leash.cancel().load(SeqCst) && leash.since_cancelled().is_some());
        assert_eq!(desk.take().unwrap().0, order(&["c"], &[]));
        desk.close();
        assert!(desk.take().is_none());
    }

    #[test]
    fn a_slider_lets_one_picture_be_seen() {
        let desk = Desk::default();
        desk.put(order(&[], &["x"]), Urgency::Now);
        let (_, leash) = desk.take().unwrap();
        desk.put(order(&[], &["x"]), Urgency::AfterOnePicture);
        assert!(!leash.cancel().load(SeqCst));
        leash.shown();
        assert!(leash.cancel().load(SeqCst));
        let (_, leash) = desk.take().unwrap();
        leash.shown();
        desk.put(order(&[], &["x"]), Urgency::AfterOnePicture);
        assert!(leash.cancel().load(SeqCst), "one was shown before");
    }
}
