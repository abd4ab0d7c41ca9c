//! The scenes of a folder.

use super::link::slashed;
use std::collections::HashSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// A `.scene` file.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct SceneFile {
    /// Its path in the folder, with `/`: what the gallery calls it.
    pub name: String,
    /// How it is opened.
    pub path: PathBuf,
}

impl SceneFile {
    /// Its name without `.scene`.
    pub fn stem(&self) -> &str {
        self.name.strip_suffix(".scene").unwrap_or(&self.name)
    }
    /// Its picture, in the gallery's folder.
    pub fn picture(&self) -> String {
        format!("{}.png", self.stem())
    }
    /// The small picture for the index, in the gallery's folder.
    pub fn thumbnail(&self) -> String {
        format!("{}.thumb.png", self.stem())
    }
    /// Its page, in the gallery's folder. A scene called `index` doesn't get the index's name.
    pub fn page(&self) -> String {
        format!("{}.html", self.name)
    }
}

/// All scenes in `dir` and the folders within it, sorted by name. Hidden files and folders are left out, and so is `out`. A
/// folder that links lead to several times is entered once.
///
/// # Errors
/// A folder can't be read, or a name isn't UTF-8 and so can't be linked to.
pub fn find(dir: &Path, out: &Path) -> io::Result<Vec<SceneFile>> {
    let mut walk = Walk { scenes: Vec::new(), links: Vec::new(), seen: HashSet::new(), root: dir };
    walk.seen.extend(out.canonicalize().ok().filter(|out| dir.canonicalize().ok().as_ref() != Some(out)));
    walk.folder(dir)?;
    // Links come last: what lies in the folder itself keeps the name that it has there.
    while let Some(link) = walk.links.pop() {
        walk.folder(&link)?;
    }
    walk.scenes.sort();
    Ok(walk.scenes)
}

struct Walk<'a> {
    scenes: Vec<SceneFile>,
    /// Links to folders, still to be entered.
    links: Vec<PathBuf>,
    /// Folders that were entered, or aren't to be; links followed.
    seen: HashSet<PathBuf>,
    root: &'a Path,
}

impl Walk<'_> {
    fn folder(&mut self, folder: &Path) -> io::Result<()> {
        if !self.seen.insert(folder.canonicalize()?) {
            return Ok(());
        }
        let mut entries: Vec<PathBuf> = Vec::new();
        for entry in fs::read_dir(folder)? {
            entries.push(entry?.path());
        }
        entries.sort(); // folders list their files in any order
        for path in entries {
            if path.file_name().is_some_and(|n| n.as_encoded_bytes().starts_with(b".")) {
                continue;
            }
            if path.is_dir() {
                match path.is_symlink() {
                    true => self.links.push(path),
                    false => self.folder(&path)?,
                }
            } else if path.extension().is_some_and(|e| e == "scene") {
                let name = path.strip_prefix(self.root).ok().and_then(slashed);
                let odd = || io::Error::other(format!("the name `{}` isn't UTF-8", path.display()));
                self.scenes.push(SceneFile { name: name.ok_or_else(odd)?, path });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(dir: &Path, out: &Path) -> Vec<String> {
        find(dir, out).unwrap().into_iter().map(|s| s.name).collect()
    }

    #[test]
    fn folders_within_folders() {
        let desk = tempfile::tempdir().unwrap();
        let dir = desk.path();
        for folder in ["b/c", ".hidden", "out"] {
            fs::create_dir_all(dir.join(folder)).unwrap();
        }
        for file in ["b/c/x.scene", "a.scene", ".hidden/x.scene", ".x.scene", "out/x.scene", "b/x.txt", "b.scene"] {
            fs::write(dir.join(file), "").unwrap();
        }
        assert_eq!(names(dir, &dir.join("out")), ["a.scene", "b.scene", "b/c/x.scene"]);
        assert_eq!(names(dir, &dir.join("none")).len(), 4);
        assert_eq!(names(dir, dir).len(), 4, "pictures beside their scenes");
    }

    #[cfg(unix)]
    #[test]
    fn loops_end() {
        use std::os::unix::fs::symlink;
        let desk = tempfile::tempdir().unwrap();
        let dir = desk.path();
        fs::create_dir_all(dir.join("z")).unwrap();
        fs::write(dir.join("z/x.scene"), "").unwrap();
        symlink(dir, dir.join("a")).unwrap();
        symlink(dir.join("z"), dir.join("b")).unwrap();
        symlink(dir, dir.join("z/up")).unwrap();
        symlink(dir.join("nowhere"), dir.join("gone.scene")).unwrap();
        assert_eq!(names(dir, &dir.join("none")), ["gone.scene", "z/x.scene"]);
    }
}
