//! [`Follower`]: tells when a file that the picture depends on is no longer what was read.
//!
//! The system's notices only say when to look; what counts is what is found. So a look is the same whether a notice, the
//! clock or a new list of files asks for it, and a notice too many costs a few microseconds. A look asks the system for the
//! mark of every file (size, times, number), waits until the marks stand still, and reads only files whose mark is new.
//!
//! The waiting is the debouncing. It is done on the marks rather than by a debouncer of notices, because a debouncer knows
//! only of notices: it passes on a file that is still being written, holds up a finished one while its neighbours are
//! busy, and there is none where the clock asks. All files must stand still together: so a checkout of many is one change.

pub mod fingerprint;
pub mod notice;
#[cfg(test)]
mod tests;
pub mod trail;

use crate::lang::Dependency;
use fingerprint::{Content, Fingerprint, Mark};
use notice::{Ear, Maker, Notices};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};
use trail::Trail;

/// For how long no file may have changed before a change is told: the debounce. Editors and `git` pause for less between the
/// pieces of one save; for a person it is at once.
pub const QUIET: Duration = Duration::from_millis(40);

/// The same if a file that changed is now empty or missing: so it is in the middle of many editors' saves, and hardly ever at
/// the end. On a busy machine the middle may last.
pub const QUIET_IF_EMPTY: Duration = Duration::from_millis(150);

/// A change is told after this even if files don't stand still, so that a stream of writes can't hold it up for ever.
pub const MOST_WAIT: Duration = Duration::from_millis(500);

/// Between two looks while waiting for quiet, and at least between any two.
const STEP: Duration = Duration::from_millis(5);

/// How often to look without a notice: some changes make none (on file systems of other machines or systems, and when one is
/// mounted). It costs a few microseconds a file.
const BACKSTOP: Duration = Duration::from_secs(2);

/// The same where notices can't be had.
const FALLBACK: Duration = Duration::from_secs(1);

/// How changes are noticed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Means {
    /// The system tells.
    Notices,
    /// By looking every so often, as was asked for.
    Polling(Duration),
    /// By looking every so often, since the system can't tell of everything.
    Fallback {
        /// How often.
        every: Duration,
        /// Why it can't, as a part of a sentence.
        reason: String,
    },
}

/// Follows the files that a picture depends on and tells when their content is no longer what was read.
///
/// Dropped, it ends its threads; it doesn't wait for a report that is being made.
pub struct Follower {
    orders: Sender<Order>,
    means: Arc<Mutex<Means>>,
}

enum Order {
    Look,
    Follow(Vec<Dependency>),
    Stop,
}

impl Follower {
    /// Follows nothing yet. With `poll` it looks that often, and doesn't ask the system for notices.
    ///
    /// `changed` gets the files whose content differs from what [`Follower::follow`] said and from what was last told,
    /// named and ordered as there. It is called by a thread of the follower, never twice for the same content, except that
    /// it was something else in between.
    ///
    /// # Errors
    /// The system has no more threads.
    pub fn new(poll: Option<Duration>, changed: impl Fn(Vec<PathBuf>) + Send + 'static) -> std::io::Result<Follower> {
        Follower::start(poll, BACKSTOP, notice::system, Box::new(changed))
    }

    fn start(poll: Option<Duration>, backstop: Duration, make: Maker, changed: Changed) -> std::io::Result<Follower> {
        let (orders, inbox) = mpsc::channel();
        let wake = orders.clone();
        let ear = Ear::new(move || drop(wake.send(Order::Look)));
        let means = Arc::new(Mutex::new(poll.map_or(Means::Notices, Means::Polling)));
        let shown = means.clone();
        thread::Builder::new().name("follower".into()).spawn(move || {
            let notices = if poll.is_none() { Some(Notices::new(ear, make)) } else { None };
            let every = poll.unwrap_or(backstop);
            Looker { inbox, notices, backstop, every, means: shown, files: Vec::new(), change: None, changed }.run();
        })?;
        Ok(Follower { orders, means })
    }

    /// Follows these files, those that the newest text was made from, and no others. Looks at once whether one has changed
    /// since it was read. Returns at once; [`Follower::means`] may take a moment to follow.
    pub fn follow(&self, files: &[Dependency]) {
        let _ = self.orders.send(Order::Follow(files.to_vec())); // fails only if the thread has ended: then nobody looks
    }

    /// How changes are noticed at the moment.
    pub fn means(&self) -> Means {
        self.means.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl Drop for Follower {
    fn drop(&mut self) {
        let _ = self.orders.send(Order::Stop);
    }
}

type Changed = Box<dyn Fn(Vec<PathBuf>) + Send>;

/// What the thread works with.
struct Looker {
    inbox: Receiver<Order>,
    /// Where the system is asked to tell; none if it is to be looked by the clock alone.
    notices: Option<Notices>,
    backstop: Duration,
    /// How often to look in any case.
    every: Duration,
    means: Arc<Mutex<Means>>,
    files: Vec<Followed>,
    /// What is going on until all stand still.
    change: Option<Change>,
    changed: Changed,
}

/// A file, and what is known of it.
struct Followed {
    dependency: Dependency,
    /// What whoever asked for it takes it to hold: what was read or, later, what was told.
    taken: Content,
    /// It was there but wasn't read, for a reason that its content wouldn't change: taken as it is at first sight.
    unseen: bool,
    found: Option<Fingerprint>,
}

impl Followed {
    /// Whether it must be read to know what it holds.
    fn is_open(&self, mark: &Option<Mark>) -> bool {
        !self.found.as_ref().is_some_and(|f| f.holds(mark))
    }
}

/// A change that is going on.
struct Change {
    began: Instant,
    last: Instant,
    marks: Vec<Option<Mark>>,
}

impl Looker {
    fn run(mut self) {
        // At most this long until the next look.
        let mut wait = self.every;
        loop {
            // A pause whatever happens, so that many notices don't make many looks.
            let pause = wait.min(STEP);
            thread::sleep(pause);
            match self.inbox.recv_timeout(wait - pause) {
                Ok(Order::Stop) | Err(RecvTimeoutError::Disconnected) => return,
                Ok(Order::Follow(files)) => self.follow(files),
                Ok(Order::Look) | Err(RecvTimeoutError::Timeout) => {}
            }
            wait = self.look();
        }
    }

    fn follow(&mut self, files: Vec<Dependency>) {
        let mut before: HashMap<PathBuf, Followed> =
            self.files.drain(..).map(|f| (f.dependency.path.clone(), f)).collect();
        for dependency in files {
            let file = match before.remove(&dependency.path) {
                // Nothing was read since; what was told stays told.
                Some(known) if known.dependency == dependency => known,
                known => Followed {
                    taken: dependency.digest,
                    unseen: dependency.found && dependency.digest.is_none(),
                    found: known.and_then(|k| k.found),
                    dependency,
                },
            };
            self.files.push(file);
        }
        self.change = None;
    }

    /// Looks whether something changed, and tells if it has come to rest. Returns after how long to look again.
    fn look(&mut self) -> Duration {
        let now = Instant::now();
        if self.change.is_none() {
            self.cover(); // before the files are looked at: what happens from now on is heard
        }
        let fresh = self.notices.is_none();
        let marks: Vec<_> = self.files.iter().map(|f| Mark::of(&f.dependency.path, fresh)).collect();
        let open: Vec<usize> = (0..marks.len()).filter(|&i| self.files[i].is_open(&marks[i])).collect();
        if open.is_empty() {
            self.change = None;
            self.tell(); // what was read may be older than what was found
            return self.every;
        }
        let empty = open.iter().any(|&i| marks[i].as_ref().is_none_or(|m| m.size == 0));
        let change = self.change.get_or_insert_with(|| Change { began: now, last: now, marks: marks.clone() });
        if change.marks != marks {
            (change.last, change.marks) = (now, marks);
        }
        let overdue = now - change.began >= MOST_WAIT;
        let quiet = if empty { QUIET_IF_EMPTY } else { QUIET };
        let left = quiet.saturating_sub(now - change.last);
        if !overdue && !left.is_zero() {
            return left.min(STEP);
        }
        let mut torn = false;
        for i in open {
            let file = &mut self.files[i];
            let found = Fingerprint::read(&file.dependency.path, fresh, file.found.as_ref());
            torn |= found.torn;
            file.found = Some(found);
        }
        if torn && !overdue {
            change.last = now;
            return STEP;
        }
        self.change = None;
        // Folders may have come while nobody listened in them. If so, look again at once.
        let again = self.cover();
        self.tell();
        if again { Duration::ZERO } else { self.every }
    }

    /// Tells of the files that hold something else than they are taken to hold.
    fn tell(&mut self) {
        let mut paths = Vec::new();
        for file in &mut self.files {
            if let Some(found) = &file.found
                && found.content != file.taken
            {
                file.taken = found.content;
                if !file.unseen {
                    paths.push(file.dependency.path.clone());
                }
            }
            file.unseen &= file.found.is_none();
        }
        if !paths.is_empty() {
            (self.changed)(paths);
        }
    }

    /// Asks for notices of the folders that the files' paths go through now; whether others than before.
    fn cover(&mut self) -> bool {
        let Some(notices) = &mut self.notices else {
            return false;
        };
        let mut trail = Trail::default();
        for file in &self.files {
            trail.walk(&file.dependency.path);
        }
        let (other, fault) = notices.cover(trail);
        self.every = if fault.is_some() { FALLBACK.min(self.backstop) } else { self.backstop };
        let means = fault.map_or(Means::Notices, |reason| Means::Fallback { every: self.every, reason });
        *self.means.lock().unwrap_or_else(PoisonError::into_inner) = means;
        other
    }
}
