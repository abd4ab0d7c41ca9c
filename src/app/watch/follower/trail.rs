//! The way from the root to a file: every folder in which a change could make its path lead elsewhere.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::ffi::OsStr;
use std::path::{Component, Path, PathBuf};

/// Most steps of one path, those of its links included. The system itself allows 40 links; what leads further leads in a
/// circle.
const MOST_STEPS: usize = 400;

/// The folders and names that a number of paths go through, links included.
///
/// A file that is replaced, a link that is pointed elsewhere, a folder that goes and comes back: each is the change of
/// one name in one of the folders. They are watched rather than the files, because a watch stays with the file it was
/// set on, and editors save by putting another in its place.
#[derive(Debug, Default)]
pub struct Trail {
    /// Real paths: no links in them. Where a path ends early, the last is the nearest folder that exists.
    pub folders: BTreeSet<PathBuf>,
    /// Names that matter in them, as `fold` leaves them.
    pub names: HashSet<String>,
    /// Where each path leads that was walked.
    ends: HashMap<PathBuf, Option<PathBuf>>,
}

impl Trail {
    /// Walks one more path.
    pub fn walk(&mut self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
        self.end(&path, MOST_STEPS);
    }

    /// The real path of what is at `path`; `None` where nothing is.
    fn end(&mut self, path: &Path, steps: usize) -> Option<PathBuf> {
        if let Some(end) = self.ends.get(path) {
            return end.clone();
        }
        let end = self.find(path, steps.checked_sub(1)?);
        self.ends.insert(path.to_path_buf(), end.clone());
        end
    }

    fn find(&mut self, path: &Path, steps: usize) -> Option<PathBuf> {
        let Some(parent) = path.parent() else {
            return Some(path.to_path_buf()); // the root
        };
        let folder = self.end(parent, steps)?;
        let name = match path.components().next_back()? {
            Component::Normal(name) => name,
            // Above the root is the root.
            Component::ParentDir => return Some(folder.parent().unwrap_or(&folder).to_path_buf()),
            _ => return Some(folder),
        };
        self.names.insert(fold(name));
        let place = folder.join(name);
        let meta = std::fs::symlink_metadata(&place);
        let link = meta.as_ref().is_ok_and(|m| m.is_symlink());
        // The notices of macOS are of all that lies beneath a folder. So there not every folder up to the root is watched,
        // only those in which a name changes in practice: files, links, and what is missing.
        let solid = meta.as_ref().is_ok_and(|m| m.is_dir());
        if !(cfg!(target_os = "macos") && solid) {
            self.folders.insert(folder.clone());
        }
        if link {
            return self.end(&folder.join(std::fs::read_link(&place).ok()?), steps);
        }
        meta.ok().map(|_| place)
    }

    /// Whether a change of the file or folder at `path` can matter, judged by its name.
    pub fn concerns(names: &HashSet<String>, path: &Path) -> bool {
        match path.file_name() {
            // Windows may give a file's short name.
            Some(name) if cfg!(unix) => !name.is_ascii() || names.contains(&fold(name)),
            _ => true,
        }
    }
}

/// A name as it is compared: some file systems take capitals for small letters, and tell of a file by its own spelling.
/// What they do with letters beyond ASCII isn't guessed at: see [`Trail::concerns`].
fn fold(name: &OsStr) -> String {
    name.to_string_lossy().to_ascii_lowercase()
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::fs;
    use std::os::unix::fs::symlink;

    fn root() -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let real = folder.path().canonicalize().unwrap();
        (folder, real)
    }

    fn trail(path: PathBuf) -> Trail {
        let mut trail = Trail::default();
        trail.walk(&path);
        trail
    }

    #[test]
    fn every_folder_on_the_way_is_found() {
        let (_keep, root) = root();
        fs::create_dir_all(root.join("releases/one/deep")).unwrap();
        fs::create_dir(root.join("elsewhere")).unwrap();
        fs::write(root.join("releases/one/deep/file"), "").unwrap();
        symlink("releases/one", root.join("current")).unwrap();
        symlink(root.join("current/../one/deep/file"), root.join("elsewhere/link")).unwrap();
        let trail = trail(root.join("elsewhere/./link"));
        for folder in ["elsewhere", "", "releases", "releases/one", "releases/one/deep"] {
            let folder = root.join(folder).components().collect::<PathBuf>();
            let watched = !cfg!(target_os = "macos") || folder.ends_with("elsewhere") || folder.ends_with("deep");
            assert!(!watched || trail.folders.contains(&folder), "{}", folder.display());
        }
        for name in ["link", "current", "one", "deep", "file"] {
            assert!(Trail::concerns(&trail.names, &Path::new("/x").join(name)), "{name}");
            assert!(Trail::concerns(&trail.names, &Path::new("/x").join(name.to_uppercase())), "{name}");
        }
        assert!(!Trail::concerns(&trail.names, Path::new("/x/unrelated")));
        assert!(Trail::concerns(&trail.names, Path::new("/")));
    }

    #[test]
    fn what_is_missing_is_awaited_in_the_nearest_folder() {
        let (_keep, root) = root();
        let trail = trail(root.join("not/yet/there"));
        assert!(trail.folders.contains(&root));
        assert!(!trail.folders.contains(&root.join("not")));
        assert!(Trail::concerns(&trail.names, &root.join("not")));
    }

    #[test]
    fn circles_end() {
        let (_keep, root) = root();
        symlink("b", root.join("a")).unwrap();
        symlink("a", root.join("b")).unwrap();
        symlink("self/self", root.join("self")).unwrap();
        for name in ["a", "self/x"] {
            assert!(trail(root.join(name)).folders.contains(&root), "{name}");
        }
        trail(root.join("x/".repeat(5000))); // far too deep
    }
}
