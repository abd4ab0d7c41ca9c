//! Names of files as links, and ways from one folder to another.

use std::path::{Component, Path, PathBuf};

/// `path` with `/` between its parts; `None` where a part isn't UTF-8.
pub fn slashed(path: &Path) -> Option<String> {
    let parts: Option<Vec<&str>> = path.iter().map(|p| p.to_str()).collect();
    Some(parts?.join("/"))
}

/// The way from folder `from` to `to`, both absolute and with links followed; `None` where there is none (two drives).
pub fn way(from: &Path, to: &Path) -> Option<PathBuf> {
    let (mut a, mut b) = (from.components().peekable(), to.components().peekable());
    let mut shared = 0;
    while let (Some(x), Some(y)) = (a.peek(), b.peek())
        && x == y
    {
        a.next();
        b.next();
        shared += 1;
    }
    let ups = a.map(|_| Component::ParentDir);
    (shared > 0).then(|| ups.chain(b).collect())
}

/// `path` without `.` and `..` where they can be taken back. Where links stand in it, it may lead elsewhere.
pub fn tidy(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if matches!(out.components().next_back(), Some(Component::Normal(_))) => {
                out.pop();
            }
            part => out.push(part),
        }
    }
    out
}

/// `path` as a link: what has a meaning in one, or isn't ASCII, is percent-encoded (RFC 3986).
pub fn href(path: &str) -> String {
    let encoded = path.bytes().map(|b| match b {
        b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => (b as char).to_string(),
        _ => format!("%{b:02X}"),
    });
    encoded.collect()
}

/// The link from a page to another file of the site; both are named from the site's folder.
pub fn between(page: &str, file: &str) -> String {
    format!("{}{}", "../".repeat(page.matches('/').count()), href(file))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways() {
        let way = |a: &str, b: &str| way(Path::new(a), Path::new(b)).and_then(|p| slashed(&p));
        assert_eq!(way("/a/b", "/a/c/d").as_deref(), Some("../c/d"));
        assert_eq!(way("/a", "/a/b").as_deref(), Some("b"));
        assert_eq!(way("/a/b", "c"), None);
        let tidy = |p: &str| slashed(&tidy(Path::new(p))).unwrap();
        assert_eq!(tidy("a/../b/./c"), "b/c");
        assert_eq!(tidy("../a/../../b"), "../../b");
    }

    #[test]
    fn links() {
        assert_eq!(href("a b/ü#1 100%\"<.png"), "a%20b/%C3%BC%231%20100%25%22%3C.png");
        assert_eq!(between("sub/a.html", "b c.png"), "../b%20c.png");
        assert_eq!(between("a.html", "sub/b.png"), "sub/b.png");
    }
}
