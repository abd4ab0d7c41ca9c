//! Whose a file is: the marks that this program leaves in what it makes. Without one of them a file is someone else's.

use std::fs;
use std::io::{BufRead, BufReader, Read, Seek};
use std::path::Path;

/// The start of the style sheet.
const STYLE: &[u8] = b"/* Made by rtdsl gallery. */";
/// In the head of every page.
const PAGE: &[u8] = b"<meta name=\"generator\" content=\"rtdsl\">";

/// In so many bytes a page's mark stands; before it there is only the page's own beginning, the same for all.
const HEAD: u64 = 512;

/// Whether the file at `path` is one that this program made: a page, the style sheet, or a picture of any command.
pub fn is_ours(path: &Path) -> bool {
    // What isn't an ordinary file might never end.
    if !fs::metadata(path).is_ok_and(|m| m.is_file()) {
        return false;
    }
    let Ok(file) = fs::File::open(path) else { return false };
    let mut head = Vec::new();
    if (&file).take(HEAD).read_to_end(&mut head).is_err() {
        return false;
    }
    if head.starts_with(STYLE) || head.starts_with(b"<!doctype html>") && head.windows(PAGE.len()).any(|w| w == PAGE) {
        return true;
    }
    let mut file = BufReader::new(file);
    file.rewind().is_ok() && entries(file).iter().any(|(name, text)| is_recipe(name, text))
}

/// Whether an entry is of a [`Recipe`](crate::film::Recipe).
fn is_recipe(name: &str, text: &str) -> bool {
    name.starts_with("rtdsl:") || name == "Software" && text.starts_with("rtdsl ")
}

/// The texts before the pixels of a PNG file; none where it is something else.
pub fn entries(file: impl BufRead + Seek) -> Vec<(String, String)> {
    let Ok(reader) = png::Decoder::new(file).read_info() else { return Vec::new() };
    let info = reader.info();
    let plain = info.uncompressed_latin1_text.iter().map(|t| (t.keyword.clone(), t.text.clone()));
    let unicode = info.utf8_text.iter().map(|t| (t.keyword.clone(), t.get_text().unwrap_or_default()));
    plain.chain(unicode).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::gallery::maker::png;
    use crate::film::{Film, Recipe};

    #[test]
    fn marks_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let ours = |bytes: &[u8]| {
            let path = folder.path().join("x");
            fs::write(&path, bytes).unwrap();
            is_ours(&path)
        };
        let picture = png(&Film::new(4, 4), &Recipe::new()).unwrap();
        assert!(ours(&picture));
        assert!(ours(&png(&Film::new(4, 4), &Recipe::default().with("rtdsl:scene", "1")).unwrap()));
        assert!(ours(&picture[..picture.len() - 20]), "cut off within its pixels");
        assert!(ours(include_bytes!("templates/style.css")));
        assert!(ours(include_bytes!("templates/index.html")) && ours(include_bytes!("templates/scene.html")));

        assert!(!ours(&png(&Film::new(4, 4), &Recipe::default().with("Comment", "after rtdsl")).unwrap()));
        for foreign in ["", "notes on rtdsl", "<!doctype html><p>about rtdsl", "rtdsl 1\nsphere()", "\u{89}PNG rtdsl:"]
        {
            assert!(!ours(foreign.as_bytes()), "{foreign}");
        }
        assert!(!is_ours(folder.path()) && !is_ours(&folder.path().join("none")));
    }
}
