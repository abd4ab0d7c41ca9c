//! Writing a file whole or not at all: under another name in the same folder first, then renamed. Whoever looks meanwhile
//! sees the old file; a fault or a full disk leaves it as it was.

use std::fs;
use std::io::{self, BufWriter, Seek};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A place for a file, found to be writable.
#[derive(Debug)]
pub struct OutputFile {
    /// Links followed.
    path: PathBuf,
    /// Whether it is something else than a file, such as `/dev/null`: written to, never replaced.
    device: bool,
}

impl OutputFile {
    /// Finds out whether `path` can be written, before the work whose result it shall hold. Changes nothing.
    ///
    /// # Errors
    /// No such folder, no permission, or `path` is a folder.
    pub fn new(path: &Path) -> io::Result<OutputFile> {
        match fs::metadata(path) {
            Ok(m) if m.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
            Ok(m) if !m.is_file() => Ok(OutputFile { path: path.to_path_buf(), device: true }),
            Ok(_) => {
                let file = OutputFile { path: path.canonicalize()?, device: false };
                file.scratch().map(|_| file)
            }
            Err(e) if e.kind() == io::ErrorKind::NotFound => {
                let file = OutputFile { path: path.to_path_buf(), device: false };
                file.scratch().map(|_| file)
            }
            Err(e) => Err(e),
        }
    }

    /// Makes the file of what `write` writes.
    ///
    /// # Errors
    /// Those of `write` and of the file system; the file is then what it was before.
    pub fn write(&self, write: impl FnOnce(&mut Scratch) -> io::Result<()>) -> io::Result<()> {
        if self.device {
            // A device may not be seekable, and formats go back to fill in their tables.
            let mut scratch = BufWriter::new(NamedTempFile::new()?);
            write(&mut scratch)?;
            let mut whole = scratch.into_inner()?.into_file();
            whole.rewind()?;
            io::copy(&mut whole, &mut fs::OpenOptions::new().write(true).open(&self.path)?)?;
            return Ok(());
        }
        let mut scratch = BufWriter::with_capacity(1 << 16, self.scratch()?);
        write(&mut scratch).map_err(nameless)?;
        let scratch = scratch.into_inner().map_err(|e| nameless(e.into_error()))?;
        if let Ok(old) = fs::metadata(&self.path) {
            // A file that is replaced keeps its permissions, as if it had been written over.
            fs::set_permissions(scratch.path(), old.permissions())?;
        }
        scratch.persist(&self.path)?;
        Ok(())
    }

    fn scratch(&self) -> io::Result<NamedTempFile> {
        let folder = match self.path.parent() {
            Some(p) if !p.as_os_str().is_empty() => p,
            _ => Path::new("."),
        };
        let mut builder = tempfile::Builder::new();
        builder.prefix(PREFIX);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // What a plain new file gets: the system takes the umask off. Without this it would be the owner's alone.
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        builder.tempfile_in(folder).map_err(nameless)
    }
}

/// The fault without the name of the scratch file, which the user doesn't know.
fn nameless(e: io::Error) -> io::Error {
    if e.to_string().contains(PREFIX) { e.kind().into() } else { e }
}

/// How names of scratch files begin.
const PREFIX: &str = ".rtdsl-";

/// Where the bytes go before the file is there.
pub type Scratch = BufWriter<NamedTempFile>;

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> =
            fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn whole_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let file = OutputFile::new(&path).unwrap();
        assert!(names(folder.path()).is_empty(), "asking changes nothing");
        file.write(|out| out.write_all(b"one")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"one");
        let fault = file.write(|out| {
            out.write_all(b"half of tw")?;
            Err(io::Error::other("full"))
        });
        assert_eq!(fault.unwrap_err().to_string(), "full");
        assert_eq!(fs::read(&path).unwrap(), b"one", "the old file stays");
        file.write(|out| out.write_all(b"three")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"three");
        assert_eq!(names(folder.path()), ["a.png"], "nothing is left behind");
    }

    #[test]
    fn what_can_not_be_written_is_refused_first() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(OutputFile::new(folder.path()).unwrap_err().kind(), io::ErrorKind::IsADirectory);
        let nowhere = folder.path().join("no/such/a.png");
        assert_eq!(OutputFile::new(&nowhere).unwrap_err().kind(), io::ErrorKind::NotFound);
    }

    #[cfg(unix)]
    #[test]
    fn links_devices_and_permissions() {
        use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let (path, link) = (folder.path().join("a.png"), folder.path().join("link.png"));
        let mode = |p: &Path| fs::metadata(p).unwrap().permissions().mode() & 0o777;
        fs::write(folder.path().join("plain"), "").unwrap();
        OutputFile::new(&path).unwrap().write(|out| out.write_all(b"one")).unwrap();
        assert_eq!(mode(&path), mode(&folder.path().join("plain")), "as the umask has it");
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        symlink(&path, &link).unwrap();
        OutputFile::new(&link).unwrap().write(|out| out.write_all(b"two")).unwrap();
        assert_eq!((fs::read(&path).unwrap(), mode(&path)), (b"two".to_vec(), 0o640));
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        let null = Path::new("/dev/null");
        OutputFile::new(null).unwrap().write(|out| out.write_all(b"three")).unwrap();
        assert!(fs::metadata(null).unwrap().file_type().is_char_device(), "not replaced");
    }
}
