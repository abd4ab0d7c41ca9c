//! Reads scene files and what they import. Only files beneath the project's folder, or beneath a folder that the user
//! allowed, are read; links and `..` don't lead out of it.

use super::ast::{Path as WrittenPath, StatementKind};
use super::limits::Limits;
use super::memory::Store;
use super::parse::{Parsed, parse};
use super::request::{Dependency, Input, Request};
use super::suggest::nearest;
use crate::diag::{Diagnostic, Diagnostics, FileId, Source, Sources, Span};
use std::collections::HashMap;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// A parsed file.
pub struct Module {
    pub file: FileId,
    pub parsed: Arc<Parsed>,
    /// One an `import` statement: its module, or `None` where it couldn't be read.
    pub imports: Vec<Option<usize>>,
}

/// Reads files and remembers them.
pub struct Loader<'m> {
    pub sources: Sources,
    /// Every file that was read or looked for.
    pub files: Vec<Dependency>,
    /// Imported ones before those that import them; the main file is the last.
    pub modules: Vec<Module>,
    pub errors: Diagnostics,
    /// The folder that the main text's paths start from.
    folder: PathBuf,
    /// Folders that may be read, links resolved.
    allowed: Vec<PathBuf>,
    by_path: HashMap<PathBuf, Option<usize>>,
    /// What was read of each file, links followed.
    digests: HashMap<PathBuf, [u8; 32]>,
    /// Files being imported, outermost first, with the names to show.
    importing: Vec<(PathBuf, String)>,
    pub limits: Limits,
    pub store: &'m mut Store,
    cancel: &'m AtomicBool,
}

impl<'m> Loader<'m> {
    /// Reads the main file and all that it imports. An error where the main file can't be read.
    pub fn load(
        request: &Request,
        limits: Limits,
        store: &'m mut Store,
        cancel: &'m AtomicBool,
    ) -> (Loader<'m>, Result<(), Diagnostic>) {
        let mut loader = Loader {
            sources: Sources::new(),
            files: Vec::new(),
            modules: Vec::new(),
            errors: Vec::new(),
            folder: PathBuf::new(),
            allowed: request.allow_read.iter().filter_map(|p| p.canonicalize().ok()).collect(),
            by_path: HashMap::new(),
            digests: HashMap::new(),
            importing: Vec::new(),
            limits,
            store,
            cancel,
        };
        let read = loader.main(&request.main);
        (loader, read)
    }

    fn main(&mut self, input: &Input) -> Result<(), Diagnostic> {
        let (name, path, bytes, digest) = match input {
            Input::Text { name, bytes, folder } => {
                self.folder = folder.clone();
                self.allowed.extend(folder.canonicalize());
                (name.clone(), None, bytes.clone(), *blake3::hash(bytes).as_bytes())
            }
            Input::File(path) => {
                let file = self.depend(path.clone());
                let name = path.display().to_string();
                let unreadable = |e: &io::Error| Diagnostic::error(format!("can't read `{name}`: {}", reason(e)));
                let full = path.canonicalize().map_err(|e| unreadable(&e))?;
                self.files[file].found = true;
                let bytes = read(&full, self.limits.file_bytes).map_err(|e| unreadable(&e))?;
                let digest = self.was_read(file, &full, &bytes);
                self.folder = full.parent().unwrap_or(Path::new("/")).to_owned();
                // The project is the current folder where the file is in it, else the file's own.
                let here = std::env::current_dir().and_then(|d| d.canonicalize()).ok();
                let root = here.filter(|d| full.starts_with(d)).unwrap_or_else(|| self.folder.clone());
                self.allowed.push(root);
                self.importing.push((full.clone(), name.clone()));
                (name, Some(full), bytes, digest)
            }
        };
        let (file, is_text) = self.add(name, path, bytes);
        self.module(file, is_text.then_some(digest));
        Ok(())
    }

    /// Adds a text, and says whether it is one; where it isn't UTF-8, an error and what can be shown of it.
    fn add(&mut self, name: String, path: Option<PathBuf>, bytes: Vec<u8>) -> (FileId, bool) {
        // Byte-order marks: UTF-8's is no part of the text, UTF-16's tells that this is another encoding.
        let utf16 = bytes.starts_with(b"\xFF\xFE") || bytes.starts_with(b"\xFE\xFF");
        let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").map(<[u8]>::to_vec).unwrap_or(bytes);
        match String::from_utf8(bytes) {
            Ok(text) => (self.sources.add(Source { name, path, text }), true),
            Err(e) => {
                let at = e.utf8_error().valid_up_to();
                let byte = e.as_bytes().get(at).copied().unwrap_or(0);
                // Everything from there on is left out: its positions would be wrong.
                let good = e.as_bytes().get(..at).unwrap_or(&[]);
                let text = format!("{}\u{FFFD}", String::from_utf8_lossy(good));
                let file = self.sources.add(Source { name, path, text });
                let what = match utf16 {
                    true => "this looks like UTF-16".to_owned(),
                    false => format!("the byte {byte:#04x} is no part of a letter"),
                };
                self.errors.push(
                    Diagnostic::error("this file isn't UTF-8 text")
                        .at(Span::new(file, at..at + 3), what)
                        .note("save it as UTF-8 in your editor"),
                );
                (file, false)
            }
        }
    }

    /// Parses a file, unless it isn't text and has no `digest`; reads its imports, and adds it.
    fn module(&mut self, file: FileId, digest: Option<[u8; 32]>) -> usize {
        let parsed = digest.map(|digest| self.parse(file, digest)).unwrap_or_default();
        self.errors.extend(parsed.errors.iter().cloned());
        let mut imports = Vec::new();
        for s in &parsed.statements {
            if self.is_cancelled() {
                break;
            }
            if let StatementKind::Import { path, .. } = &s.kind {
                imports.push(self.import(file, path));
            }
        }
        self.modules.push(Module { file, parsed, imports });
        self.modules.len() - 1
    }

    fn parse(&mut self, file: FileId, digest: [u8; 32]) -> Arc<Parsed> {
        let (text, cancel) = (&self.sources.get(file).text, self.cancel);
        let parsed = self.store.parses.get((digest, file), || {
            let parsed = Arc::new(parse(file, text, cancel));
            // What was broken off is no use to the next evaluation.
            if cancel.load(Relaxed) { Err(parsed) } else { Ok(parsed) }
        });
        parsed.unwrap_or_else(|part| part)
    }

    fn import(&mut self, from: FileId, path: &WrittenPath) -> Option<usize> {
        let (full, name, dependency) = match self.find(from, &path.text, path.span) {
            Ok(found) => found,
            Err(d) => {
                self.errors.push(d);
                return None;
            }
        };
        if let Some(start) = self.importing.iter().position(|(p, _)| *p == full) {
            let mut circle: Vec<&str> = self.importing[start..].iter().map(|(_, n)| n.as_str()).collect();
            circle.push(&name);
            let note = format!("the circle: {}", circle.join(" → "));
            self.errors.push(Diagnostic::error("files import each other in a circle").at(path.span, "").note(note));
            return None;
        }
        if let Some(known) = self.by_path.get(&full) {
            return *known;
        }
        if self.importing.len() >= self.limits.import_depth {
            let most = self.limits.import_depth;
            self.errors.push(Diagnostic::error(format!("imports are nested more than {most} deep")).at(path.span, ""));
            return None;
        }
        let index = match read(&full, self.limits.file_bytes) {
            Ok(bytes) => {
                let digest = self.was_read(dependency, &full, &bytes);
                self.importing.push((full.clone(), name.clone()));
                let before = self.errors.len();
                let (file, is_text) = self.add(name, Some(full.clone()), bytes);
                if let Some(d) = self.errors.get_mut(before) {
                    *d = d.clone().at(path.span, "imported here");
                }
                let index = self.module(file, is_text.then_some(digest));
                self.importing.pop();
                Some(index)
            }
            Err(e) => {
                self.errors
                    .push(Diagnostic::error(format!("can't read `{}`: {}", path.text, reason(&e))).at(path.span, ""));
                None
            }
        };
        self.by_path.insert(full, index);
        index
    }

    /// Whether nobody waits for the result any more.
    pub fn is_cancelled(&self) -> bool {
        self.cancel.load(Relaxed)
    }

    /// Notes a file that is looked for; its number in `files`.
    fn depend(&mut self, path: PathBuf) -> usize {
        if let Some(known) = self.files.iter().position(|f| f.path == path) {
            return known;
        }
        self.files.push(Dependency { path, digest: None, found: false });
        self.files.len() - 1
    }

    /// Notes what was read at `full`, links followed, for file number `file`; gives its digest.
    pub fn was_read(&mut self, file: usize, full: &Path, bytes: &[u8]) -> [u8; 32] {
        let digest = *blake3::hash(bytes).as_bytes();
        self.files[file].digest = Some(digest);
        self.digests.insert(full.to_owned(), digest);
        digest
    }

    /// The file that a text names by a path relative to its own folder, how messages show it, and its number in `files`.
    pub fn find(&mut self, from: FileId, written: &str, span: Span) -> Result<(PathBuf, String, usize), Diagnostic> {
        let source = self.sources.get(from);
        let folder = source.path.as_deref().and_then(Path::parent).unwrap_or(&self.folder);
        let path = folder.join(written);
        let shown = Path::new(&source.name).parent().unwrap_or(Path::new("")).join(written).display().to_string();
        if written.is_empty() {
            return Err(Diagnostic::error("the name of the file is missing").at(span, ""));
        }
        let file = self.depend(path.clone());
        let full = path.canonicalize().map_err(|e| {
            let d = Diagnostic::error(format!("can't read `{written}`: {}", reason(&e)));
            let d = match self.neighbour(&path, written) {
                Some(best) => d.at(span, format!("did you mean `{best}`?")),
                None => d.at(span, ""),
            };
            d.note("a path starts at the folder of the file that names it")
        })?;
        self.files[file].found = true;
        if !self.allowed.iter().any(|root| full.starts_with(root)) {
            return Err(Diagnostic::error(format!("`{written}` is outside the project"))
                .at(span, "")
                .note("a scene may read only files beneath its project's folder; `--allow-read DIR` allows another"));
        }
        if let Some(digest) = self.digests.get(&full) {
            self.files[file].digest = Some(*digest); // read before, under this name or another
        }
        Ok((full, shown, file))
    }
    /// The path as written with the name of a file of the same folder that is spelt almost alike.
    fn neighbour(&self, path: &Path, written: &str) -> Option<String> {
        let folder = path.parent()?.canonicalize().ok()?;
        if !self.allowed.iter().any(|root| folder.starts_with(root)) {
            return None;
        }
        let mut names: Vec<String> =
            std::fs::read_dir(folder).ok()?.filter_map(|f| f.ok()?.file_name().into_string().ok()).collect();
        names.sort(); // folders list their files in any order
        let name = path.file_name()?.to_str()?;
        // Most files of a folder end alike: what counts is the name before the ending.
        let stem = |name: &str| Path::new(name).file_stem().and_then(|s| s.to_str()).unwrap_or("").to_owned();
        let wanted = stem(name);
        names.retain(|n| stem(n) == wanted || nearest(&wanted, [stem(n).as_str()]).is_some());
        let best = nearest(name, names.iter().map(String::as_str))?;
        Some(format!("{}{best}", written.strip_suffix(name)?))
    }
}

/// The bytes of an ordinary file of at most `most` bytes.
pub fn read(path: &Path, most: usize) -> io::Result<Vec<u8>> {
    let meta = std::fs::metadata(path)?;
    if meta.is_dir() {
        return Err(io::Error::other("it is a folder"));
    }
    if !meta.is_file() {
        return Err(io::Error::other("it isn't an ordinary file"));
    }
    if meta.len() > most as u64 {
        return Err(io::Error::other(format!("it is larger than {} MB", most >> 20)));
    }
    std::fs::read(path)
}

/// Why, in words that are the same on every system.
pub fn reason(e: &io::Error) -> String {
    match e.kind() {
        io::ErrorKind::NotFound => "there is no such file".into(),
        io::ErrorKind::PermissionDenied => "permission denied".into(),
        io::ErrorKind::InvalidInput => "its name can't be that of a file".into(),
        _ => e.to_string(),
    }
}
