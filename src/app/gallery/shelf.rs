//! The gallery's folder: which files in it are the gallery's own, and writing them only where they change. What others put
//! there is neither overwritten nor removed.

use super::manifest::{self, Manifest, digest};
use crate::app::Stop;
use crate::diag::Diagnostic;
use crate::film::OutputFile;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::{self, Read, Write};
use std::path::{Component, Path, PathBuf};

/// The folder and what the last run left in it.
pub struct Shelf {
    folder: PathBuf,
    /// Digests of the gallery's files, by name, as the manifest has them.
    listed: BTreeMap<String, String>,
}

impl Shelf {
    /// The shelf in `folder`, on which `listed` stands.
    pub fn new(folder: &Path, listed: &BTreeMap<String, String>) -> Shelf {
        // A manifest is a file that anyone can have edited: its names must not lead out of the folder.
        let inside = |name: &str| {
            let mut parts = Path::new(name).components().peekable();
            parts.peek().is_some() && parts.all(|p| matches!(p, Component::Normal(_)))
        };
        let listed = listed.iter().filter(|(name, _)| inside(name)).map(|(n, d)| (n.clone(), d.clone())).collect();
        Shelf { folder: folder.to_path_buf(), listed }
    }

    /// Where `name` is.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// The digest of `name` as the last run left it.
    pub fn listed(&self, name: &str) -> Option<&String> {
        self.listed.get(name)
    }

    /// Whether `name` is as the last run left it.
    pub fn is_intact(&self, name: &str) -> bool {
        let here = || fs::read(self.path(name)).ok().map(|bytes| digest(&bytes));
        self.listed.get(name).is_some_and(|listed| here().as_ref() == Some(listed))
    }

    /// Whether `name` isn't there.
    pub fn lacks(&self, name: &str) -> bool {
        !self.path(name).exists()
    }

    /// Whether `name` may be written: it isn't there, or the gallery or another command of this program made it.
    ///
    /// # Errors
    /// Someone else made it.
    pub fn claim(&self, name: &str) -> Result<(), Stop> {
        if self.listed.contains_key(name) || self.lacks(name) || is_ours(&self.path(name)) {
            return Ok(());
        }
        let d = Diagnostic::error(format!("`{}` wasn't made by rtdsl", self.path(name).display()));
        Err(Stop::usage(d.note("the gallery would overwrite it: give it another folder with `-o`, or move the file")))
    }

    /// Makes `name` hold `bytes`; whether it had to be written.
    ///
    /// # Errors
    /// It belongs to someone else or can't be written.
    pub fn put(&self, name: &str, bytes: &[u8]) -> Result<bool, Stop> {
        let path = self.path(name);
        if fs::read(&path).is_ok_and(|old| old == bytes) {
            return Ok(false);
        }
        self.claim(name)?;
        let folder = path.parent().unwrap_or(&self.folder);
        let write = || {
            fs::create_dir_all(folder)?;
            OutputFile::new(&path)?.write(|out| out.write_all(bytes))
        };
        write().map_err(|e| Stop::system(format!("`{}` can't be written", path.display()), e))?;
        Ok(true)
    }

    /// Removes the files of the last run that aren't among `kept`, and folders that are empty then; their names.
    ///
    /// # Errors
    /// One can't be removed.
    pub fn clear(&self, kept: &BTreeSet<String>) -> Result<Vec<String>, Stop> {
        let mut removed = Vec::new();
        for name in self.listed.keys().filter(|n| !kept.contains(*n)) {
            let path = self.path(name);
            match fs::remove_file(&path) {
                Ok(()) => removed.push(name.clone()),
                Err(e) if e.kind() == io::ErrorKind::NotFound => {}
                Err(e) => return Err(Stop::system(format!("`{}` can't be removed", path.display()), e)),
            }
            let mut folder = Path::new(name).parent();
            while let Some(f) = folder.filter(|f| !f.as_os_str().is_empty()) {
                // Fails, as it should, where something is left in it.
                if fs::remove_dir(self.folder.join(f)).is_err() {
                    break;
                }
                folder = f.parent();
            }
        }
        Ok(removed)
    }

    /// Writes the manifest, if it changed.
    ///
    /// # Errors
    /// It can't be written.
    pub fn put_manifest(&self, manifest: &Manifest) -> Result<(), Stop> {
        self.put(manifest::FILE, &manifest.bytes()).map(|_| ())
    }
}

/// Whether a file says near its beginning that this program made it: pictures carry its name as text, pages and the style
/// sheet as a remark.
fn is_ours(path: &Path) -> bool {
    let mut head = Vec::new();
    // Of a picture this is the header and the first entry of its recipe.
    let read = fs::File::open(path).and_then(|f| f.take(512).read_to_end(&mut head));
    read.is_ok() && head.windows(5).any(|w| w == b"rtdsl")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Exit;

    #[test]
    fn only_what_is_listed_is_touched() {
        let desk = tempfile::tempdir().unwrap();
        let at = |name: &str| desk.path().join("out").join(name);
        fs::create_dir_all(at("sub")).unwrap();
        for (name, text) in [("a.png", "one"), ("sub/b.png", "two"), ("c.png", "foreign"), ("../d.png", "outside")] {
            fs::write(at(name), text).unwrap();
        }
        let listed = ["a.png", "sub/b.png", "../d.png", "/etc/hostname", "", "gone.png"];
        let listed = listed.iter().map(|n| (n.to_string(), digest(b"one"))).collect();
        let shelf = Shelf::new(&desk.path().join("out"), &listed);
        assert!(shelf.is_intact("a.png") && !shelf.is_intact("sub/b.png") && !shelf.is_intact("gone.png"));
        assert!(!shelf.put("a.png", b"one").unwrap(), "nothing to write");
        assert!(shelf.put("a.png", b"three").unwrap());
        assert!(shelf.put("new/e.png", b"four").unwrap());
        assert_eq!(shelf.put("c.png", b"five").unwrap_err().exit, Exit::Usage);
        fs::write(at("c.html"), "<!-- rtdsl -->").unwrap();
        assert!(shelf.put("c.html", b"six").unwrap(), "of a gallery whose manifest was lost");
        assert_eq!(shelf.clear(&BTreeSet::from(["a.png".to_string()])).unwrap(), ["sub/b.png"]);
        assert!(!at("sub").exists(), "an empty folder goes too");
        for left in ["a.png", "c.png", "../d.png"] {
            assert!(at(left).exists(), "{left}");
        }
    }
}
