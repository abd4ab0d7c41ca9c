//! Numbers, times and arguments as people and shells read them: the same wherever they stand.

pub use crate::diag::thousands;

/// A word for a POSIX shell.
pub fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-./:=,+@%".contains(c);
    match !word.is_empty() && word.chars().all(plain) {
        true => word.to_string(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

/// Microseconds in words, with three digits at most up to a second.
pub fn duration(microseconds: u64) -> String {
    let x = microseconds as f64;
    match microseconds {
        0..1_000 => format!("{:.2} ms", x / 1e3),
        1_000..10_000 => format!("{:.1} ms", x / 1e3),
        10_000..1_000_000 => format!("{:.0} ms", x / 1e3),
        _ => format!("{:.2} s", x / 1e6),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers() {
        assert_eq!([120, 5_300, 53_000, 5_310_000].map(duration), ["0.12 ms", "5.3 ms", "53 ms", "5.31 s"]);
    }

    #[test]
    fn words_survive_a_shell() {
        assert_eq!(["a-b/c.scene", "r=1,5", "", "a b"].map(quoted), ["a-b/c.scene", "r=1,5", "''", "'a b'"]);
        assert_eq!(
            ["it's", "$HOME", "~", "#f80", "a\nb"].map(quoted),
            [r"'it'\''s'", "'$HOME'", "'~'", "'#f80'", "'a\nb'"]
        );
    }
}
