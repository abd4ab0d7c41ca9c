//! Stands in for `src/lang/running.rs` on a machine without threads: the work is done at once, by whoever asks for it.

use std::io;
use std::sync::atomic::AtomicBool;

/// Work that is done.
#[derive(Debug)]
pub struct Running<T>(T);

impl<T> Running<T> {
    /// Does `work`; nobody is there to cancel it.
    pub fn start(work: impl FnOnce(&AtomicBool) -> T) -> io::Result<Running<T>> {
        Ok(Running(work(&AtomicBool::new(false))))
    }

    /// What it gave.
    pub fn wait(self, _: &AtomicBool) -> Result<T, Running<T>> {
        Ok(self.0)
    }

    /// What it gave.
    pub fn join(self) -> T {
        self.0
    }
}
