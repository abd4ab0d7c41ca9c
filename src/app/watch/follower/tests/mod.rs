//! The follower on a real file system. No test waits for nothing to happen: where nothing must be told, another file is
//! changed afterwards, and must be the only one told of.

mod editor;
mod folder;
#[cfg(unix)]
mod link;
mod means;
mod state;

use super::notice::{self, Maker};
use super::*;
use std::fs;
use std::path::Path;
use std::sync::mpsc::RecvTimeoutError;

/// Far more than it ever takes, for a machine that is busy with other things.
const PATIENCE: Duration = Duration::from_secs(10);

/// No test may pass because of the clock where it is about notices.
const NEVER: Duration = Duration::from_secs(3600);

/// A folder with a follower. Its own file `sentinel` is always followed.
struct Desk {
    _keep: tempfile::TempDir,
    root: PathBuf,
    follower: Follower,
    told: Receiver<Vec<PathBuf>>,
    followed: Vec<PathBuf>,
}

impl Desk {
    fn new() -> Desk {
        Desk::with(None, notice::system)
    }

    fn with(poll: Option<Duration>, make: Maker) -> Desk {
        let keep = tempfile::tempdir().unwrap();
        let root = keep.path().to_path_buf();
        let (tell, told) = mpsc::channel();
        let follower = Follower::start(poll, NEVER, make, Box::new(move |paths| drop(tell.send(paths)))).unwrap();
        let desk = Desk { _keep: keep, root, follower, told, followed: Vec::new() };
        desk.write("sentinel", "0");
        desk
    }

    fn path(&self, name: &str) -> PathBuf {
        self.root.join(name)
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    fn rename(&self, from: &str, to: &str) {
        fs::rename(self.path(from), self.path(to)).unwrap();
    }

    /// Follows these files and the sentinel as they are now, and waits until that is established.
    fn follow(&mut self, names: &[&str]) {
        self.followed = names.iter().chain(&["sentinel"]).map(|n| self.path(n)).collect();
        self.read();
        self.only_sentinel();
    }

    /// Does what the loop does after a report: reads all files and follows what was read.
    fn read(&self) {
        self.follower.follow(&self.followed.iter().map(|p| dependency(p)).collect::<Vec<_>>());
    }

    /// The next report's files, as their names in the folder. The text is read anew.
    fn report(&self) -> Vec<String> {
        let paths = self.told.recv_timeout(PATIENCE).expect("a report");
        self.read();
        paths.iter().map(|p| p.strip_prefix(&self.root).unwrap().to_str().unwrap().to_owned()).collect()
    }

    /// `name` is told of, and it alone.
    #[track_caller]
    fn changed(&self, name: &str) {
        assert_eq!(self.report(), [name]);
    }

    /// Nothing is told of but what is done here.
    #[track_caller]
    fn only_sentinel(&self) {
        let text = fs::read_to_string(self.path("sentinel")).unwrap();
        self.write("sentinel", &format!("{text}+"));
        self.changed("sentinel");
    }

    /// The same after what can't be done in one step: on a machine that stopped between the steps, what was in the middle
    /// is rightly told.
    #[track_caller]
    fn only_sentinel_after_a_blink(&self) {
        self.write("sentinel", "blink");
        while !self.told.recv_timeout(PATIENCE).expect("a report").contains(&self.path("sentinel")) {}
        self.read();
    }
}

/// What the language says of a file that it reads now.
fn dependency(path: &Path) -> Dependency {
    let digest = fs::read(path).ok().map(|bytes| *blake3::hash(&bytes).as_bytes());
    Dependency { path: path.to_path_buf(), digest, found: digest.is_some() }
}
