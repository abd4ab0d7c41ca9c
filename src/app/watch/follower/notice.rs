//! The system's notices of changes in folders, and which folders they are asked for.

use super::trail::Trail;
use notify::event::{AccessKind, AccessMode, EventKind, ModifyKind};
use notify::{Config, ErrorKind, Event, EventHandler, RecommendedWatcher, RecursiveMode, Watcher};
use std::collections::{BTreeMap, HashSet};
use std::fs::Metadata;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

/// What hears the system's notices. Most are of no interest, and there may be thousands a second; so it only notes that
/// something may have changed, and wakes who is to look.
pub struct Ear {
    heard: Mutex<Heard>,
    wake: Box<dyn Fn() + Send + Sync>,
}

#[derive(Default)]
struct Heard {
    names: HashSet<String>,
    /// Something that matters happened since it was last asked.
    news: bool,
    /// Paths at which a folder went or came; watches of what was there are void.
    moved: HashSet<PathBuf>,
}

impl Ear {
    /// An ear that calls `wake` when there is something new, once until [`Ear::take`].
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> Arc<Ear> {
        Arc::new(Ear { heard: Mutex::default(), wake: Box::new(wake) })
    }

    fn heard(&self) -> MutexGuard<'_, Heard> {
        self.heard.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Where folders came and went since the last call.
    pub fn take(&self) -> HashSet<PathBuf> {
        let mut heard = self.heard();
        heard.news = false;
        std::mem::take(&mut heard.moved)
    }

    fn hear(&self, event: &notify::Result<Event>) {
        let mut heard = self.heard();
        match event {
            // Notices were lost, and with them perhaps that a folder went: every path starts with the empty one.
            Err(_) => drop(heard.moved.insert(PathBuf::new())),
            Ok(e) if e.need_rescan() => drop(heard.moved.insert(PathBuf::new())),
            Ok(e) if !is_change(&e.kind) => return,
            Ok(e) if !e.paths.is_empty() && !e.paths.iter().any(|p| Trail::concerns(&heard.names, p)) => return,
            Ok(e) if matches!(e.kind, EventKind::Remove(_) | EventKind::Modify(ModifyKind::Name(_))) => {
                heard.moved.extend(e.paths.iter().cloned());
            }
            Ok(_) => {}
        }
        if !std::mem::replace(&mut heard.news, true) {
            (self.wake)();
        }
    }
}

/// Whether it tells of a change. Reading a file makes notices too; to heed them would be to look for ever.
fn is_change(kind: &EventKind) -> bool {
    !matches!(kind, EventKind::Access(a) if *a != AccessKind::Close(AccessMode::Write))
}

struct Hearer(Arc<Ear>);

impl EventHandler for Hearer {
    fn handle_event(&mut self, event: notify::Result<Event>) {
        self.0.hear(&event);
    }
}

/// Makes the system's watcher, which tells `Ear` what happens.
pub type Maker = fn(Arc<Ear>) -> notify::Result<Box<dyn Watcher + Send>>;

/// The system's own.
pub fn system(ear: Arc<Ear>) -> notify::Result<Box<dyn Watcher + Send>> {
    Ok(Box::new(RecommendedWatcher::new(Hearer(ear), Config::default())?))
}

/// The folders that notices are asked for.
pub struct Notices {
    ear: Arc<Ear>,
    watcher: notify::Result<Box<dyn Watcher + Send>>,
    watched: BTreeMap<PathBuf, Identity>,
}

impl Notices {
    /// None yet.
    pub fn new(ear: Arc<Ear>, make: Maker) -> Notices {
        Notices { watcher: make(ear.clone()), ear, watched: BTreeMap::new() }
    }

    /// Asks for notices of the folders of `trail` and no others. Returns whether other folders are watched than before, so
    /// that something may have happened there unheard; and why a change may go unheard from now on.
    pub fn cover(&mut self, trail: Trail) -> (bool, Option<String>) {
        self.ear.heard().names = trail.names;
        let watcher = match &mut self.watcher {
            Ok(watcher) => watcher,
            Err(e) => return (false, Some(reason(e))),
        };
        let moved = self.ear.take();
        let folders: BTreeMap<PathBuf, Identity> =
            trail.folders.into_iter().filter_map(|f| Some((f.clone(), identity(&f)?))).collect();
        let stays = |folder: &PathBuf, identity: &Identity| {
            folders.get(folder) == Some(identity) && !moved.iter().any(|m| folder.starts_with(m))
        };
        let before = self.watched.len();
        // First those that go: a folder under a new name still has its old watch, and would lose the new one with it.
        self.watched.retain(|folder, identity| {
            let stays = stays(folder, identity);
            if !stays {
                let _ = watcher.unwatch(folder); // it fails where the folder is gone, and its watch with it
            }
            stays
        });
        let mut other = self.watched.len() != before;
        let mut faults = Vec::new();
        for (folder, identity) in folders {
            if self.watched.contains_key(&folder) {
                continue;
            }
            match watcher.watch(&folder, RecursiveMode::NonRecursive) {
                Ok(()) => {
                    self.watched.insert(folder, identity);
                    other = true;
                }
                Err(e) => faults.push((folder, e)),
            }
        }
        let fault = faults.iter().find(|(folder, e)| match &e.kind {
            // It is gone already; its parent tells when it comes back.
            ErrorKind::PathNotFound => false,
            ErrorKind::Io(e) if e.kind() == io::ErrorKind::NotFound => false,
            // Folders near the root are often closed to the eye, and hardly ever change.
            ErrorKind::Io(e) if e.kind() == io::ErrorKind::PermissionDenied => {
                !self.watched.keys().any(|w| w.starts_with(folder))
            }
            _ => true,
        });
        (other, fault.map(|(folder, e)| format!("`{}` can't be watched: {}", folder.display(), reason(e))))
    }
}

/// What tells a folder from another that took its place: device, number and time of creation, as far as the system has them.
type Identity = (u64, u64, Option<SystemTime>);

/// `None` where there is no folder.
fn identity(path: &Path) -> Option<Identity> {
    let meta = std::fs::metadata(path).ok().filter(Metadata::is_dir)?;
    let created = meta.created().ok();
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        Some((meta.dev(), meta.ino(), created))
    }
    #[cfg(not(unix))]
    Some((0, 0, created))
}

fn reason(e: &notify::Error) -> String {
    match &e.kind {
        ErrorKind::MaxFilesWatch => "the system has no more watches (fs.inotify.max_user_watches)".into(),
        ErrorKind::Io(e) => e.to_string(),
        ErrorKind::Generic(text) => text.clone(),
        _ => e.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use notify::event::{CreateKind, DataChange, Flag, MetadataKind};
    use std::sync::atomic::{AtomicU32, Ordering};

    #[test]
    fn only_what_may_matter_wakes_and_only_once() {
        let woken = Arc::new(AtomicU32::new(0));
        let count = woken.clone();
        let ear = Ear::new(move || {
            count.fetch_add(1, Ordering::SeqCst);
        });
        ear.heard().names = ["a.scene".to_owned()].into();
        let hear = |kind: EventKind, path: &str| {
            ear.hear(&Ok(Event::new(kind).add_path(Path::new("/folder").join(path))));
            ear.hear(&Ok(Event::new(kind).add_path(Path::new("/folder").join(path))));
            let moved = ear.take().len();
            (woken.swap(0, Ordering::SeqCst), moved)
        };
        let modified = EventKind::Modify(ModifyKind::Data(DataChange::Any));
        assert_eq!(hear(modified, "a.scene"), (1, 0));
        assert_eq!(hear(EventKind::Create(CreateKind::File), "A.Scene"), (1, 0), "as some file systems spell it");
        assert_eq!(hear(EventKind::Modify(ModifyKind::Metadata(MetadataKind::Any)), "a.scene"), (1, 0), "permissions");
        assert_eq!(hear(EventKind::Access(AccessKind::Close(AccessMode::Write)), "a.scene"), (1, 0));
        assert_eq!(hear(EventKind::Remove(notify::event::RemoveKind::Any), "a.scene"), (1, 1));
        for reading in [AccessKind::Read, AccessKind::Open(AccessMode::Any), AccessKind::Close(AccessMode::Read)] {
            assert_eq!(hear(EventKind::Access(reading), "a.scene"), (0, 0), "{reading:?}");
        }
        if cfg!(unix) {
            assert_eq!(hear(modified, "b.scene"), (0, 0));
        }
        ear.hear(&Ok(Event::new(EventKind::Other).set_flag(Flag::Rescan)));
        assert!(ear.take().iter().all(|m| Path::new("/any/folder").starts_with(m)));
        ear.hear(&Err(notify::Error::generic("lost")));
        assert_eq!(woken.load(Ordering::SeqCst), 2);
    }
}
