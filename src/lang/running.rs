//! Work on a thread of its own that can be left behind: to give up is a matter of milliseconds even where the work needs
//! longer to notice, or to give back its memory.

use super::limits::STACK_BYTES;
use std::convert::Infallible;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread::{Builder, JoinHandle};
use std::time::Duration;

/// A thread at work, with a stack that fits the limits on nesting.
#[derive(Debug)]
pub struct Running<T> {
    thread: JoinHandle<T>,
    /// Brings nothing, but is cut off when the work ends.
    ends: Receiver<Infallible>,
    /// Whether the work shall be given up.
    cancel: Arc<AtomicBool>,
}

/// How often it is looked whether to give up: less is felt by nobody, and this costs nothing yet.
const LOOK: Duration = Duration::from_millis(2);

impl<T: Send + 'static> Running<T> {
    /// Starts `work`, which looks at the flag that it is given.
    pub fn start(work: impl FnOnce(&AtomicBool) -> T + Send + 'static) -> io::Result<Running<T>> {
        let cancel = Arc::new(AtomicBool::new(false));
        let (seen, (end, ends)) = (cancel.clone(), channel());
        let work = move || {
            let _end = end;
            work(&seen)
        };
        Ok(Running { thread: Builder::new().stack_size(STACK_BYTES).spawn(work)?, ends, cancel })
    }

    /// What it gives; where `cancel` is set before, the thread, told to end and still ending.
    pub fn wait(self, cancel: &AtomicBool) -> Result<T, Running<T>> {
        loop {
            if cancel.load(Relaxed) {
                self.cancel.store(true, Relaxed);
                return Err(self);
            }
            if self.ends.recv_timeout(LOOK) != Err(RecvTimeoutError::Timeout) {
                return Ok(self.join());
            }
        }
    }

    /// What it gives.
    pub fn join(self) -> T {
        self.thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}
