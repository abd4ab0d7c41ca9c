//! How changes are noticed: by notices, by the clock, or by the clock because notices can't be had; and the end of it.

use super::*;
use notify::{Config, Error, ErrorKind, EventHandler, RecursiveMode, Watcher, WatcherKind};

/// A system with no watch to spare.
struct Exhausted;

impl Watcher for Exhausted {
    fn new<F: EventHandler>(_: F, _: Config) -> notify::Result<Self> {
        Ok(Exhausted)
    }
    fn watch(&mut self, _: &Path, _: RecursiveMode) -> notify::Result<()> {
        Err(Error::new(ErrorKind::MaxFilesWatch))
    }
    fn unwatch(&mut self, _: &Path) -> notify::Result<()> {
        Err(Error::watch_not_found())
    }
    fn kind() -> WatcherKind {
        WatcherKind::NullWatcher
    }
}

fn follow_an_edit(desk: &mut Desk) {
    desk.write("a", "old");
    desk.follow(&["a", "x/b"]);
    desk.write("a", "new");
    desk.changed("a");
    fs::create_dir(desk.path("x")).unwrap();
    desk.write("x/b", "here");
    desk.changed("x/b");
    desk.only_sentinel();
}

#[test]
fn notices_are_the_rule() {
    let mut desk = Desk::new();
    follow_an_edit(&mut desk);
    assert_eq!(desk.follower.means(), Means::Notices);
}

#[test]
fn the_clock_will_do() {
    let often = Duration::from_millis(20);
    let mut desk = Desk::with(Some(often), |_| unreachable!("the system isn't asked"));
    follow_an_edit(&mut desk);
    assert_eq!(desk.follower.means(), Means::Polling(often));
}

#[test]
fn without_watches_the_clock_takes_over_and_it_is_said() {
    let mut desk = Desk::with(None, |_| Ok(Box::new(Exhausted)));
    desk.follow(&[]);
    let Means::Fallback { every, reason } = desk.follower.means() else {
        panic!("{:?}", desk.follower.means());
    };
    assert_eq!(every, FALLBACK);
    assert!(reason.contains("can't be watched: the system has no more watches"), "{reason}");
}

#[test]
fn without_notices_the_clock_takes_over_and_it_is_said() {
    let mut desk = Desk::with(None, |_| Err(Error::generic("too many watchers")));
    desk.follow(&[]);
    assert_eq!(desk.follower.means(), Means::Fallback { every: FALLBACK, reason: "too many watchers".into() });
}

#[test]
fn dropped_it_ends() {
    for poll in [None, Some(NEVER)] {
        let mut desk = Desk::with(poll, notice::system);
        if poll.is_none() {
            desk.follow(&[]);
        }
        let Desk { follower, told, .. } = desk;
        drop(follower);
        // What was to be called is gone, and with it the thread that had it.
        assert_eq!(told.recv_timeout(PATIENCE), Err(RecvTimeoutError::Disconnected));
    }
}
