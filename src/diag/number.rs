//! Numbers as people read them, wherever they stand.

/// `1,234,567`
pub fn thousands(n: u64) -> String {
    let digits = n.to_string();
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().map(|g| std::str::from_utf8(g).unwrap_or_default()).collect();
    groups.join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_stand_in_threes() {
        assert_eq!([0, 7, 1234, 1_234_567].map(thousands), ["0", "7", "1,234", "1,234,567"]);
    }
}
