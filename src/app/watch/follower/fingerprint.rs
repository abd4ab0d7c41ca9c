//! What is known of a file's content, and how to find out without reading it again for nothing.

use crate::lang::LARGEST_FILE;
use std::fs::{File, Metadata};
use std::io;
use std::path::Path;
use std::time::{Duration, Instant, SystemTime};

/// BLAKE3 of a file's bytes, or of the mark of one that is too large for the language; `None` where there is nothing to read:
/// no file, a folder, a device, no permission.
pub type Content = Option<[u8; 32]>;

/// What the system says of an ordinary file without its bytes being read. Links are followed: it is that of the file at
/// their end, so that it also changes when a link is pointed elsewhere.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mark {
    /// Bytes.
    pub size: u64,
    modified: Option<SystemTime>,
    /// When anything of it last changed; where the system keeps that, no program can set it.
    changed: Option<SystemTime>,
    /// Device and number of the file, where the system has them.
    file: (u64, u64),
}

impl Mark {
    /// The mark of the ordinary file at `path`, if there is one. `fresh` asks a network file system's server and doesn't
    /// take what was remembered of an earlier question: opening a file does that.
    pub fn of(path: &Path, fresh: bool) -> Option<Mark> {
        // Only an ordinary file is ever opened: opening a pipe would wait for its other end.
        let known = std::fs::metadata(path).ok().filter(Metadata::is_file)?;
        let newest = if fresh { File::open(path).and_then(|f| f.metadata()).ok() } else { None };
        Some(Mark::from(newest.as_ref().unwrap_or(&known)))
    }

    #[cfg(unix)]
    fn from(meta: &Metadata) -> Mark {
        use std::os::unix::fs::MetadataExt;
        let seconds = u64::try_from(meta.ctime()).ok();
        let since = seconds.zip(u32::try_from(meta.ctime_nsec()).ok()).map(|(s, ns)| Duration::new(s, ns));
        let changed = since.and_then(|d| SystemTime::UNIX_EPOCH.checked_add(d));
        Mark { size: meta.len(), modified: meta.modified().ok(), changed, file: (meta.dev(), meta.ino()) }
    }

    #[cfg(not(unix))]
    fn from(meta: &Metadata) -> Mark {
        let modified = meta.modified().ok();
        Mark { size: meta.len(), modified, changed: modified, file: (0, 0) }
    }

    /// Whether anything written after `time` is sure to give another mark: clocks of file systems go in steps. The mark has
    /// stood `unchanged` for so long by then.
    fn outdated_by_changes_after(&self, time: SystemTime, unchanged: Duration) -> bool {
        self.changed.is_some_and(|changed| {
            // The clock of another machine's file system may be ahead of ours for ever, but goes on as ours does.
            if unchanged > LONGEST_STEP {
                return true;
            }
            let part = changed.duration_since(SystemTime::UNIX_EPOCH).map_or(0, |d| d.subsec_nanos());
            // Where parts of a second are kept, time goes in the kernel's ticks, at most 10 ms; else in seconds.
            let step = if part == 0 { LONGEST_STEP } else { Duration::from_millis(20) };
            time.duration_since(changed).is_ok_and(|age| age > step)
        })
    }
}

/// The longest step of a file system's clock: that of FAT.
const LONGEST_STEP: Duration = Duration::from_secs(2);

/// What a file held when it was read.
#[derive(Clone, Debug)]
pub struct Fingerprint {
    /// Its content.
    pub content: Content,
    /// It was changed while it was read: the content is a mixture.
    pub torn: bool,
    mark: Option<Mark>,
    /// When it was first seen to have this mark.
    since: Instant,
    /// As long as the mark stays, the content does.
    lasting: bool,
}

impl Fingerprint {
    /// Reads the file at `path`, of which `last` was known.
    pub fn read(path: &Path, fresh: bool, last: Option<&Fingerprint>) -> Fingerprint {
        let (start, now) = (SystemTime::now(), Instant::now());
        let mark = Mark::of(path, fresh);
        let since = last.filter(|l| l.mark == mark).map_or(now, |l| l.since);
        let Some(before) = &mark else {
            return Fingerprint { content: None, torn: false, mark, since, lasting: true };
        };
        let content = match before.size > LARGEST_FILE as u64 {
            true => Some(*blake3::hash(format!("{before:?}").as_bytes()).as_bytes()),
            false => digest(path).ok(),
        };
        let torn = Mark::of(path, fresh).as_ref() != Some(before);
        // What couldn't be read may be readable a moment later without any mark of it: another program had it locked.
        let lasting = content.is_some() && !torn && before.outdated_by_changes_after(start, now - since);
        Fingerprint { content, torn, mark, since, lasting }
    }

    /// Whether a file that has this mark now still holds the same, without reading it.
    pub fn holds(&self, now: &Option<Mark>) -> bool {
        self.lasting && self.mark == *now
    }
}

fn digest(path: &Path) -> io::Result<[u8; 32]> {
    let mut hasher = blake3::Hasher::new();
    hasher.update_reader(File::open(path)?)?;
    Ok(*hasher.finalize().as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn contents_are_digests() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        assert_eq!(Fingerprint::read(&path, false, None).content, None);
        fs::write(&path, "text").unwrap();
        for fresh in [false, true] {
            let read = Fingerprint::read(&path, fresh, None);
            assert_eq!(read.content, Some(*blake3::hash(b"text").as_bytes()));
            assert!(!read.torn);
        }
        assert_eq!(Fingerprint::read(folder.path(), false, None).content, None, "a folder has no content");
    }

    #[test]
    fn a_mark_is_believed_once_the_clock_has_gone_on() {
        let at = |ms| SystemTime::UNIX_EPOCH + Duration::from_millis(ms);
        let mark = |ms| Mark { size: 1, modified: None, changed: Some(at(ms)), file: (0, 0) };
        let new = Duration::ZERO;
        let fine = mark(100_005);
        assert!(!fine.outdated_by_changes_after(at(100_010), new));
        assert!(fine.outdated_by_changes_after(at(100_040), new));
        let coarse = mark(100_000);
        assert!(!coarse.outdated_by_changes_after(at(101_500), new));
        assert!(coarse.outdated_by_changes_after(at(102_500), new));
        let ahead = mark(200_005);
        assert!(!ahead.outdated_by_changes_after(at(100_000), LONGEST_STEP), "the file's clock is ahead");
        assert!(ahead.outdated_by_changes_after(at(100_000), LONGEST_STEP * 2), "but goes on");
        assert!(!Mark { changed: None, ..fine }.outdated_by_changes_after(at(200_000), LONGEST_STEP * 2));
    }

    #[test]
    fn a_mark_is_remembered_as_long_as_it_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, "text").unwrap();
        let first = Fingerprint::read(&path, false, None);
        let second = Fingerprint::read(&path, false, Some(&first));
        assert_eq!(second.since, first.since);
        fs::write(&path, "longer text").unwrap();
        assert!(Fingerprint::read(&path, false, Some(&second)).since > first.since);
    }

    #[test]
    fn of_what_is_too_large_to_be_read_the_mark_counts() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        let file = File::create(&path).unwrap();
        file.set_len(LARGEST_FILE as u64 + 1).unwrap(); // a hole, which takes no space
        let content = || Fingerprint::read(&path, false, None).content;
        let before = content();
        assert!(before.is_some());
        assert_eq!(content(), before);
        file.set_modified(SystemTime::UNIX_EPOCH).unwrap();
        assert_ne!(content(), before, "nothing of it was read");
    }

    #[cfg(unix)]
    #[test]
    fn another_file_of_the_same_size_and_time_has_another_mark() {
        let folder = tempfile::tempdir().unwrap();
        let (a, b) = (folder.path().join("a"), folder.path().join("b"));
        let time = SystemTime::UNIX_EPOCH + Duration::from_secs(1_000_000_000);
        for (path, text) in [(&a, "one"), (&b, "two")] {
            fs::write(path, text).unwrap();
            File::options().write(true).open(path).unwrap().set_modified(time).unwrap();
        }
        let before = Mark::of(&a, false);
        fs::rename(&b, &a).unwrap();
        assert_ne!(Mark::of(&a, false), before);
    }
}
