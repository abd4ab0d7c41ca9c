//! What a picture was made from, kept inside it as text: enough to make the same picture again.

use crate::diag::{FileId, Sources};

/// Names and values, in the order in which they are written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recipe {
    entries: Vec<(String, String)>,
}

impl Recipe {
    /// The recipe that names this program.
    pub fn new() -> Recipe {
        Recipe::default().with("Software", concat!("rtdsl ", env!("CARGO_PKG_VERSION")))
    }

    /// Adds a value under `name`: 1 to 79 printable ASCII characters, as PNG demands of its keywords. Control characters of
    /// the value become spaces, so that it stays one line.
    pub fn with(mut self, name: &str, value: impl AsRef<str>) -> Recipe {
        let value = value.as_ref().replace(char::is_control, " ");
        self.entries.push((name.to_string(), value));
        self
    }

    /// Names and values.
    pub fn entries(&self) -> impl Iterator<Item = (&str, &str)> {
        self.entries.iter().map(|(name, value)| (name.as_str(), value.as_str()))
    }

    /// One `name: value` line an entry.
    pub fn lines(&self) -> String {
        self.entries().map(|(name, value)| format!("{name}: {value}\n")).collect()
    }
}

/// BLAKE3 of the scene's texts, in hexadecimal: the main one and its modules, in the order in which they were read. Neither
/// where they lie nor what parameters were given changes it.
pub fn scene_digest(sources: &Sources) -> String {
    let mut hasher = blake3::Hasher::new();
    for (id, source) in sources.iter() {
        if id == FileId(0) || source.path.is_some() {
            hasher.update(&(source.text.len() as u64).to_le_bytes());
            hasher.update(source.text.as_bytes());
        }
    }
    hasher.finalize().to_hex().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diag::Source;

    #[test]
    fn lines_are_lines() {
        let recipe = Recipe::default().with("a", "1\n2").with("b", "ä");
        assert_eq!(recipe.lines(), "a: 1 2\nb: ä\n");
        assert!(Recipe::new().lines().starts_with("Software: rtdsl "));
    }

    #[test]
    fn a_digest_is_of_the_texts() {
        let digest = |texts: &[(&str, bool)]| {
            let mut sources = Sources::new();
            for (text, file) in texts {
                let path = file.then(|| format!("/{text}").into());
                sources.add(Source { name: "n".into(), path, text: text.to_string() });
            }
            scene_digest(&sources)
        };
        assert_eq!(digest(&[("a", true)]), digest(&[("a", false)]), "the place doesn't count");
        assert_eq!(digest(&[("a", true), ("--set", false)]), digest(&[("a", true)]), "parameters don't count");
        assert_ne!(digest(&[("ab", true), ("c", true)]), digest(&[("a", true), ("bc", true)]));
    }
}
