//! Lines, words and numbers of the text formats.

/// The lines of a text, numbered from 1.
pub fn lines(bytes: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    (1..).zip(bytes.split(|b| *b == b'\n'))
}

/// The words of a line.
pub fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty())
}

/// The number that a word of line `line` is.
pub fn number(word: Option<&[u8]>, line: usize) -> Result<f64, String> {
    let word = word.ok_or_else(|| format!("line {line}: a number is missing"))?;
    let number = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
    number.ok_or_else(|| format!("line {line}: `{}` is no number", shown(word)))
}

/// A word as messages show it.
pub fn shown(word: &[u8]) -> String {
    /// Longer ones are cut off: they are no words.
    const LONGEST: usize = 40;
    let text: String = String::from_utf8_lossy(word).escape_debug().take(LONGEST + 1).collect();
    match text.char_indices().nth(LONGEST) {
        Some((at, _)) => format!("{}…", &text[..at]),
        None => text,
    }
}
