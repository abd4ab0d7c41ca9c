//! What a run works on: the folder of scenes, the gallery's folder and what the last run left there, the options.

use super::link::{slashed, tidy, way};
use super::manifest::{self, Entry, Foreign, Manifest, Used, digest, digest_of};
use super::scene_file::{SceneFile, find};
use super::shelf::Shelf;
use crate::app::Stop;
use crate::app::args::GalleryArgs;
use crate::app::view::aa_word;
use crate::diag::Diagnostic;
use crate::lang::Evaluated;
use crate::scene::{AntiAliasing, PixelFilter};
use std::collections::HashMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The version of everything that decides a picture, and of what decides a page besides.
const PICTURES: &str = concat!(env!("CARGO_PKG_VERSION"), "+", env!("RTDSL_PICTURES"));
pub(super) const PAGES: &str = concat!(env!("RTDSL_PICTURES"), "+", env!("RTDSL_PAGES"));

/// A run's subject.
pub struct Project {
    /// The folder of the scenes, links followed.
    pub folder: PathBuf,
    /// The gallery's folder.
    pub out: PathBuf,
    /// All scenes.
    pub scenes: Vec<SceneFile>,
    /// Whether each is among those asked for.
    pub asked: Vec<bool>,
    /// What the last run left.
    pub old: Manifest,
    /// The files of the last run.
    pub shelf: Shelf,
    /// Pixels across of every picture, if not the scene's own.
    pub width: Option<u32>,
    /// Rays a pixel, if not the scene's own.
    pub aa: Option<AntiAliasing>,
    /// How a pixel's light is weighed, if not the scene's own way.
    pub filter: Option<PixelFilter>,
    /// Folders that scenes may read besides.
    pub allow_read: Vec<PathBuf>,
    /// Digests of files in this run, by path.
    digests: Mutex<HashMap<String, Option<String>>>,
}

/// The gallery's folder unless given.
const OUT: &str = "gallery";

impl Project {
    /// Looks at the folders; makes that of the gallery, unless `args` only ask to check.
    ///
    /// # Errors
    /// There are no scenes, none is asked for, a folder can't be read, or the gallery is that of another folder.
    pub fn open(args: &GalleryArgs) -> Result<Project, Stop> {
        let unreadable = |e| Stop::system(format!("the folder `{}` can't be read", args.dir.display()), e);
        let folder = args.dir.canonicalize().map_err(unreadable)?;
        let out = args.out.clone().unwrap_or_else(|| OUT.into());
        let scenes = find(&args.dir, &out).map_err(unreadable)?;
        if scenes.is_empty() {
            return Err(Stop::usage(Diagnostic::error(format!("there are no scenes in `{}`", args.dir.display()))));
        }
        let asked: Vec<bool> = scenes.iter().map(|s| args.only.as_ref().is_none_or(|glob| is_match(glob, s))).collect();
        if let (Some(glob), false) = (&args.only, asked.contains(&true)) {
            let d = Diagnostic::error(format!("no scene in `{}` matches `{glob}`", args.dir.display()));
            return Err(Stop::usage(d.note("the pattern is for the path in the folder, as in `chess*` or `lib/*`")));
        }
        if !args.check {
            fs::create_dir_all(&out)
                .map_err(|e| Stop::system(format!("the folder `{}` can't be made", out.display()), e))?;
        }
        let to_scenes = out.canonicalize().ok().and_then(|out| way(&out, &folder)).and_then(|w| slashed(&w));
        let to_scenes = to_scenes.unwrap_or_default();
        let old = old_manifest(&out)?;
        if let Some(other) = old.as_ref().map(|m| &m.folder).filter(|f| **f != to_scenes) {
            let d = Diagnostic::error(format!("`{}` holds the gallery of another folder: `{other}`", out.display()))
                .note("making this one there would remove that one's pictures; give it its own folder with `-o`")
                .note(format!("if the scenes have moved, remove `{}` first", out.join(manifest::FILE).display()));
            return Err(Stop::usage(d));
        }
        let old = old.unwrap_or_else(|| Manifest::new(to_scenes));
        Ok(Project {
            shelf: Shelf::new(&out, &old.files),
            folder,
            out,
            scenes,
            asked,
            old,
            width: args.width,
            aa: args.aa,
            filter: args.filter,
            allow_read: args.allow_read.clone(),
            digests: Mutex::default(),
        })
    }

    /// What the last run knew of a scene.
    pub fn entry(&self, scene: &SceneFile) -> Option<&Entry> {
        self.old.scenes.get(&scene.name)
    }

    /// Whether the name of a scene's small picture is free: `a.thumb.scene` has a picture of that name, and keeps it.
    pub fn has_thumbnail(&self, scene: &SceneFile) -> bool {
        let name = scene.thumbnail();
        !self.scenes.iter().any(|s| s.picture() == name)
    }

    /// The options as words for `rtdsl render`, of a picture of `size`.
    pub fn view_words(&self, size: [u32; 2]) -> Vec<String> {
        let size = self.width.map(|_| ["--size".into(), format!("{}x{}", size[0], size[1])]);
        let aa = self.aa.map(|aa| ["--aa".into(), aa_word(aa)]);
        let filter = self.filter.map(|f| ["--filter".into(), f.name().into()]);
        size.into_iter().chain(aa).chain(filter).flatten().collect()
    }

    /// The digest of what decides a picture that is made with `files` now.
    pub fn key<'a>(&self, files: impl IntoIterator<Item = (&'a str, String)>) -> String {
        let allowed: Vec<String> = self.allow_read.iter().map(|p| p.display().to_string()).collect();
        let options = format!("{:?} {:?} {allowed:?}", self.width, self.aa);
        // Without it the digest is as it was before there were filters.
        let options = self.filter.map_or(options.clone(), |f| format!("{options} {}", f.name()));
        let files = files.into_iter().flat_map(|(path, digest)| [path.to_string(), digest]);
        let parts: Vec<String> = [PICTURES.to_string(), options].into_iter().chain(files).collect();
        digest_of(parts.iter().map(String::as_str))
    }

    /// Whether the entry holds for the files as they are, by their digests alone.
    pub fn holds(&self, entry: &Entry) -> bool {
        let now: Option<Vec<(&str, String)>> =
            entry.files.iter().map(|f| Some((f.path.as_str(), self.digest(&f.path)?))).collect();
        now.is_some_and(|now| !now.is_empty() && self.key(now) == entry.key)
    }

    /// Why the entry doesn't hold.
    pub fn reason(&self, entry: &Entry) -> String {
        if entry.key.is_empty() {
            return "it has no picture yet".into();
        }
        let changed = entry.files.iter().find(|f| self.digest(&f.path).as_ref() != Some(&f.digest));
        match changed {
            Some(f) => format!("`{}` changed", f.path),
            None => "the options or the renderer changed".into(),
        }
    }

    /// The digest of the file at `path`, from the folder of the scenes; `None` where there is none.
    pub fn digest(&self, path: &str) -> Option<String> {
        let known = || self.digests.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(digest) = known().get(path) {
            return digest.clone();
        }
        // Others go on meanwhile; two that ask for the same file at once both read it.
        let found = self.bytes(path).map(|bytes| digest(&bytes));
        known().entry(path.to_string()).or_insert(found).clone()
    }

    /// The text at `path`, from the folder of the scenes; what isn't UTF-8 in it is replaced.
    pub fn text(&self, path: &str) -> String {
        let text = String::from_utf8_lossy(&self.bytes(path).unwrap_or_default()).into_owned();
        text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text)
    }

    fn bytes(&self, path: &str) -> Option<Vec<u8>> {
        let path = self.folder.join(path);
        // What isn't an ordinary file might never end.
        if !fs::metadata(&path).ok()?.is_file() { None } else { fs::read(path).ok() }
    }

    /// The files that a scene read, the scene itself first.
    pub fn used(&self, scene: &SceneFile, evaluated: &Evaluated) -> Vec<Used> {
        let texts: Vec<&Path> = evaluated.sources.iter().filter_map(|(_, s)| s.path.as_deref()).collect();
        let mut used: Vec<Used> = Vec::new();
        for (i, file) in evaluated.files.iter().enumerate() {
            let Some(digest) = file.digest else { continue };
            let full = file.path.canonicalize().unwrap_or_default();
            let path = if i == 0 { scene.name.clone() } else { self.path_of(&file.path) };
            if !used.iter().any(|u| u.path == path) {
                let text = texts.contains(&full.as_path());
                used.push(Used { path, digest: blake3::Hash::from_bytes(digest).to_hex().to_string(), text });
            }
        }
        used
    }

    /// `path` from the folder of the scenes, without detours where that leads to the same file.
    fn path_of(&self, path: &Path) -> String {
        let path = way(&self.folder, path).unwrap_or_else(|| path.to_path_buf());
        let tidied = tidy(&path);
        let same = |p: &Path| self.folder.join(p).canonicalize().ok();
        let best = if same(&tidied) == same(&path) { tidied } else { path };
        slashed(&best).unwrap_or_else(|| best.display().to_string())
    }
}

/// What the last run left in `out`, as its manifest tells.
fn old_manifest(out: &Path) -> Result<Option<Manifest>, Stop> {
    let path = out.join(manifest::FILE);
    let bytes = match fs::read(&path) {
        Ok(bytes) => bytes,
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(e) => return Err(Stop::system(format!("`{}` can't be read", path.display()), e)),
    };
    Manifest::read(&bytes).map_err(|Foreign| {
        let d = Diagnostic::error(format!("`{}` wasn't made by rtdsl", path.display()));
        Stop::usage(d.note("the gallery would overwrite it: give it another folder with `-o`, or move the file"))
    })
}

/// Whether a pattern matches a scene's path, with or without `.scene`.
fn is_match(glob: &glob::Pattern, scene: &SceneFile) -> bool {
    glob.matches(&scene.name) || glob.matches(scene.stem())
}
