//! What Ctrl-C does: the first one ends the loop in good order, a second one ends the program at once, whatever it is doing.

use crate::app::Exit;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};
use std::sync::{Arc, Mutex, PoisonError};

/// The file that is being written under another name and not whole yet, if there is one: what an end in the middle takes
/// away.
#[derive(Clone, Debug, Default)]
pub struct Unwhole(Arc<Mutex<Option<PathBuf>>>);

impl Unwhole {
    /// From now on it is this one.
    pub fn set(&self, path: Option<&Path>) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = path.map(Path::to_path_buf);
    }

    fn remove(&self) {
        if let Some(path) = self.0.lock().unwrap_or_else(PoisonError::into_inner).take() {
            // Where it can't be removed, it is whole by now and has its own name, or nothing can be done.
            let _ = fs::remove_file(path);
        }
    }
}

/// What is to be done at each interruption; the first time it is `stop`.
pub fn handler(stop: impl Fn() + Send + 'static, unwhole: Unwhole) -> impl FnMut() + Send + 'static {
    counted(stop, move || {
        unwhole.remove();
        std::process::exit(Exit::Done as i32)
    })
}

/// Does `first` the first time and `again` each further time.
fn counted(first: impl Fn() + Send + 'static, again: impl Fn() + Send + 'static) -> impl FnMut() + Send + 'static {
    let came = AtomicBool::new(false);
    move || if came.swap(true, SeqCst) { again() } else { first() }
}

/// Done when it is dropped, however that comes: held by a thread without which others would go on in vain.
pub struct AtEnd<F: Fn()>(pub F);

impl<F: Fn()> Drop for AtEnd<F> {
    fn drop(&mut self) {
        (self.0)();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    #[test]
    fn the_second_time_is_another_matter() {
        let (tell, told) = channel();
        let again = tell.clone();
        let mut handler = counted(move || tell.send("first").unwrap(), move || again.send("again").unwrap());
        (0..3).for_each(|_| handler());
        drop(handler);
        assert_eq!(told.iter().collect::<Vec<_>>(), ["first", "again", "again"]);
    }

    #[test]
    fn half_a_file_is_taken_away() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(".rtdsl-x");
        fs::write(&path, "half").unwrap();
        let unwhole = Unwhole::default();
        unwhole.remove();
        assert!(path.exists());
        unwhole.set(Some(&path));
        unwhole.set(None);
        unwhole.remove();
        assert!(path.exists(), "it is whole");
        unwhole.set(Some(&path));
        unwhole.remove();
        assert!(!path.exists());
    }

    #[test]
    fn a_thread_that_panics_ends_the_loop() {
        let (tell, told) = channel();
        let at_end = AtEnd(move || tell.send("stop").unwrap());
        let died = std::thread::spawn(move || {
            let _at_end = at_end;
            std::panic::resume_unwind(Box::new("a fault"));
        });
        assert_eq!(told.recv(), Ok("stop"));
        assert!(died.join().is_err());
    }
}
