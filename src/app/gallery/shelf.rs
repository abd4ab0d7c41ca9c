//! The gallery's folder: which files in it are the gallery's own, and writing them only where they change. What others put
//! there is neither overwritten nor removed, and nothing outside is touched, whatever the manifest lists and wherever links
//! lead: it is a file that anyone can have edited.

use super::manifest::{self, Manifest, digest};
use super::mark::is_ours;
use crate::app::Stop;
use crate::diag::Diagnostic;
use crate::film::OutputFile;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::{self, Write};
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
        let listed = listed.iter().filter(|(name, _)| is_plain(name)).map(|(n, d)| (n.clone(), d.clone())).collect();
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
        let here = || self.bytes(name).map(|bytes| digest(&bytes));
        self.listed.get(name).is_some_and(|listed| here().as_ref() == Some(listed))
    }

    /// Whether `name` isn't there.
    pub fn lacks(&self, name: &str) -> bool {
        !self.path(name).exists()
    }

    /// Whether `name` may be written: it isn't there, or this program made it, and no link leads out of the folder.
    ///
    /// # Errors
    /// Someone else made it, or it lies elsewhere.
    pub fn claim(&self, name: &str) -> Result<(), Stop> {
        let path = self.path(name);
        self.hold(name)?;
        if self.lacks(name) || is_ours(&path) || self.is_emptied(name) {
            return Ok(());
        }
        let d = Diagnostic::error(format!("`{}` wasn't made by rtdsl", path.display()));
        Err(Stop::usage(d.note("the gallery would overwrite it: give it another folder with `-o`, or move the file")))
    }

    /// Makes `name` hold `bytes`; whether it had to be written.
    ///
    /// # Errors
    /// It belongs to someone else, lies elsewhere, or can't be written.
    pub fn put(&self, name: &str, bytes: &[u8]) -> Result<bool, Stop> {
        if self.bytes(name).is_some_and(|old| old == bytes) {
            return Ok(false);
        }
        self.claim(name)?;
        self.write(name, bytes)?;
        Ok(true)
    }

    /// Removes the files of the last run that aren't among `kept`, and folders that are empty then; their names. What has
    /// changed since, lies elsewhere or isn't this program's at all stays.
    ///
    /// # Errors
    /// One can't be removed.
    pub fn clear(&self, kept: &BTreeSet<String>) -> Result<Vec<String>, Stop> {
        let mut removed = Vec::new();
        for name in self.listed.keys().filter(|n| !kept.contains(*n) && self.is_within(n)) {
            let path = self.path(name);
            if !self.lacks(name) {
                if !self.is_intact(name) || !is_ours(&path) {
                    continue;
                }
                match fs::remove_file(&path) {
                    Ok(()) => removed.push(name.clone()),
                    Err(e) if e.kind() == io::ErrorKind::NotFound => {}
                    Err(e) => return Err(Stop::system(format!("`{}` can't be removed", path.display()), e)),
                }
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

    /// Whether the manifest may be written. Whose the one is that is there, [`Manifest::read`] says.
    ///
    /// # Errors
    /// It lies elsewhere.
    pub fn hold_manifest(&self) -> Result<(), Stop> {
        self.hold(manifest::FILE)
    }

    /// Writes the manifest, if it changed.
    ///
    /// # Errors
    /// It lies elsewhere, or can't be written.
    pub fn put_manifest(&self, manifest: &Manifest) -> Result<(), Stop> {
        let bytes = manifest.bytes();
        if self.bytes(manifest::FILE).is_some_and(|old| old == bytes) {
            return Ok(());
        }
        self.hold_manifest()?;
        self.write(manifest::FILE, &bytes)
    }

    fn write(&self, name: &str, bytes: &[u8]) -> Result<(), Stop> {
        let path = self.path(name);
        let folder = path.parent().unwrap_or(&self.folder);
        let write = || {
            fs::create_dir_all(folder)?;
            OutputFile::new(&path)?.write(|out| out.write_all(bytes))
        };
        write().map_err(|e| Stop::system(format!("`{}` can't be written", path.display()), e))
    }

    fn bytes(&self, name: &str) -> Option<Vec<u8>> {
        let path = self.path(name);
        // What isn't an ordinary file might never end.
        if !fs::metadata(&path).ok()?.is_file() { None } else { fs::read(path).ok() }
    }

    fn hold(&self, name: &str) -> Result<(), Stop> {
        if self.is_within(name) {
            return Ok(());
        }
        let d = Diagnostic::error(format!("`{}` lies outside the gallery's folder", self.path(name).display()));
        Err(Stop::usage(d.note("a link leads there; the gallery writes to its own folder alone, so remove the link")))
    }

    /// Whether `name` leads to a place in the folder, links followed.
    fn is_within(&self, name: &str) -> bool {
        let Ok(folder) = self.folder.canonicalize() else { return false };
        let path = self.path(name);
        // A part that isn't there, or is a link to nothing, leads nowhere else.
        let stays = |p: &Path| p.canonicalize().map_or(true, |p| p.starts_with(&folder));
        is_plain(name) && path.ancestors().take_while(|p| p.starts_with(&self.folder)).all(stays)
    }

    /// A file of ours without anything in it, as a crash of the system leaves one: nobody loses it.
    fn is_emptied(&self, name: &str) -> bool {
        self.listed.contains_key(name) && fs::metadata(self.path(name)).is_ok_and(|m| m.is_file() && m.len() == 0)
    }
}

/// Whether a name leads, by its text alone, to a place in the folder that it is a name in.
fn is_plain(name: &str) -> bool {
    let mut parts = Path::new(name).components().peekable();
    parts.peek().is_some() && parts.all(|p| matches!(p, Component::Normal(_)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Exit;

    /// A file of ours that holds `text`.
    fn ours(text: &str) -> String {
        format!("<!doctype html>\n<meta name=\"generator\" content=\"rtdsl\">\n{text}")
    }

    /// A folder with `out` and these files in it.
    fn desk(files: &[(&str, &str)]) -> tempfile::TempDir {
        let desk = tempfile::tempdir().unwrap();
        for (name, text) in files.iter().chain(&[("out/.keep", "")]) {
            let path = desk.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        desk
    }

    fn shelf(desk: &tempfile::TempDir, listed: &[(&str, &str)]) -> Shelf {
        let listed = listed.iter().map(|(n, text)| (n.to_string(), digest(text.as_bytes()))).collect();
        Shelf::new(&desk.path().join("out"), &listed)
    }

    #[test]
    fn what_is_ours_is_kept_up() {
        let (one, two) = (ours("one"), ours("two"));
        let desk = desk(&[("out/a", &one), ("out/sub/b", &one), ("out/c", &two), ("out/empty", "")]);
        let shelf = shelf(&desk, &[("a", &one), ("sub/b", &one), ("c", &one), ("empty", &one), ("gone/d", &one)]);
        assert!(shelf.is_intact("a") && !shelf.is_intact("c") && !shelf.is_intact("gone/d"));
        assert!(!shelf.put("a", one.as_bytes()).unwrap(), "nothing to write");
        assert!(shelf.put("a", two.as_bytes()).unwrap());
        assert!(shelf.put("new/e", b"three").unwrap());
        assert!(shelf.put("c", one.as_bytes()).unwrap(), "of a gallery whose manifest was lost");
        assert!(shelf.put("empty", one.as_bytes()).unwrap(), "what a crash left");
        assert_eq!(shelf.clear(&["a", "c", "empty"].map(String::from).into()).unwrap(), ["sub/b"]);
        assert!(!desk.path().join("out/sub").exists(), "an empty folder goes too");
    }

    #[test]
    fn what_others_made_stays() {
        let one = ours("one");
        let files = [
            ("out/foreign", "notes on rtdsl"),
            ("out/listed", "a user's"),
            ("out/known", "a user's, with its digest"),
            ("out/edited", &ours("by hand")),
            ("d", &one),
        ];
        let desk = desk(&files);
        let outside = desk.path().join("d").display().to_string();
        let listed = [
            ("listed", one.as_str()),
            ("known", "a user's, with its digest"),
            ("edited", &one),
            ("../d", &one),
            ("sub/../../d", &one),
            (&outside, &one),
            ("", &one),
            (".", &one),
        ];
        let shelf = shelf(&desk, &listed);
        for name in ["foreign", "listed", "known", "../d", "sub/../../d", &outside, "", "."] {
            assert_eq!(shelf.put(name, b"new").unwrap_err().exit, Exit::Usage, "{name}");
        }
        assert!(shelf.clear(&BTreeSet::new()).unwrap().is_empty());
        for (name, text) in files {
            assert_eq!(fs::read_to_string(desk.path().join(name)).unwrap(), text, "{name}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_lead_nowhere_else() {
        use std::os::unix::fs::symlink;
        let one = ours("one");
        let desk = desk(&[("user/a", &one), ("user/empty/x", ""), ("out/own", &one)]);
        let at = |name: &str| desk.path().join(name);
        fs::remove_file(at("user/empty/x")).unwrap();
        symlink(at("user"), at("out/sub")).unwrap();
        symlink(at("user/a"), at("out/a")).unwrap();
        symlink(at("out/own"), at("out/near")).unwrap();
        symlink(at("user"), at("out/gallery.json")).unwrap();
        symlink(at("out/own"), at("user/back")).unwrap();
        let names = ["sub/a", "a", "sub/new", "sub/deep/new", "sub/empty/x", "sub/back"];
        let shelf = shelf(&desk, &names.map(|n| (n, one.as_str())));
        for name in names {
            assert_eq!(shelf.put(name, b"new").unwrap_err().exit, Exit::Usage, "{name}");
        }
        assert_eq!(shelf.put_manifest(&Manifest::new("x".into())).unwrap_err().exit, Exit::Usage);
        assert!(shelf.clear(&BTreeSet::new()).unwrap().is_empty());
        assert_eq!(fs::read_to_string(at("user/a")).unwrap(), one);
        assert!(at("user/empty").is_dir() && at("user/back").exists() && !at("user/new").exists());
        assert!(shelf.put("near", b"new").unwrap(), "a link within the folder");
        assert_eq!(fs::read(at("out/own")).unwrap(), b"new");
    }
}
