//! "Did you mean …?": the nearest spelling among the names that would be right.

/// Nobody misspells a longer word, and the distance takes time with its length.
const LONGEST_WORD: usize = 64;

/// The candidate nearest to `word` by Damerau–Levenshtein distance, if it is near enough: a third of the word's letters,
/// at least one, but not all of them. Of equally near ones the first wins. Case is ignored at first: `Sphere` is `sphere`.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let letters = word.chars().count();
    if letters > LONGEST_WORD {
        return None;
    }
    let cutoff = (letters / 3).max(1).min(letters.saturating_sub(1));
    let lower = word.to_lowercase();
    candidates
        .into_iter()
        .filter(|c| *c != word && c.len() <= 4 * LONGEST_WORD)
        .map(|c| (strsim::damerau_levenshtein(&lower, &c.to_lowercase()), c))
        .filter(|(d, _)| *d <= cutoff)
        .min_by_key(|(d, _)| *d)
        .map(|(_, c)| c)
}

/// What other scene languages call properties, and what they are called here.
const SYNONYMS: [(&str, &str); 14] = [
    ("radius", "r"),
    ("center", "at"),
    ("centre", "at"),
    ("position", "at"),
    ("location", "from"),
    ("look_at", "at"),
    ("target", "at"),
    ("material", "mat"),
    ("colour", "color"),
    ("roughness", "shininess"),
    ("reflection", "reflect"),
    ("transparency", "transmit"),
    ("intensity", "power"),
    ("open", "caps"),
];

/// Like [`nearest`], for the names of properties: also finds one by what others call it, itself misspelt perhaps.
pub fn nearest_property<'a>(word: &str, names: impl Iterator<Item = &'a str> + Clone) -> Option<&'a str> {
    nearest(word, names.clone()).or_else(|| {
        let usable = SYNONYMS.iter().filter(|(_, here)| names.clone().any(|n| n == *here));
        let foreign: Vec<&str> = usable.clone().map(|(there, _)| *there).collect();
        let meant = foreign.iter().find(|f| **f == word).copied().or_else(|| nearest(word, foreign.iter().copied()))?;
        let (_, here) = usable.clone().find(|(there, _)| *there == meant)?;
        names.clone().find(|n| n == here)
    })
}

/// What other languages call the words of this one.
const FOREIGN_WORDS: [(&str, &str); 29] = [
    ("ball", "sphere"),
    ("cube", "box"),
    ("cuboid", "box"),
    ("block", "box"),
    ("rect", "box"),
    ("tube", "cylinder"),
    ("donut", "torus"),
    ("ring", "torus"),
    ("circle", "disc"),
    ("disk", "disc"),
    ("ground", "plane"),
    ("pyramid", "tetrahedron"),
    ("translate", "move"),
    ("shift", "move"),
    ("resize", "scale"),
    ("turn", "rotate"),
    ("spin", "rotate"),
    ("point_light", "light"),
    ("light_source", "light"),
    ("lamp", "light"),
    ("sky", "background"),
    ("material", "phong"),
    ("diffuse", "matte"),
    ("metal", "mirror"),
    ("texture", "image"),
    ("color", "rgb"),
    ("grey", "gray"),
    ("log", "ln"),
    ("random", "rand"),
];

/// Like [`nearest`], for what can be used: the names of a scene, nearest scope first, then the words of the language,
/// by what others call them too.
pub fn nearest_word<'a>(
    word: &str,
    names: impl Iterator<Item = &'a str>,
    words: impl Iterator<Item = &'a str> + Clone,
) -> Option<&'a str> {
    let foreign = FOREIGN_WORDS.iter().find(|(there, _)| *there == word);
    let foreign = foreign.and_then(|(_, here)| words.clone().find(|w| w == here));
    foreign.or_else(|| nearest(word, names.chain(words)))
}

/// `did you mean …?`, or nothing.
pub fn did_you_mean(best: Option<&str>) -> String {
    best.map_or(String::new(), |b| format!("did you mean `{b}`?"))
}

/// `a, b or c`, each in back quotes.
pub fn or_list<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    let quoted: Vec<String> = words.into_iter().map(|w| format!("`{w}`")).collect();
    join_or(&quoted)
}

/// `a, b or c`.
pub fn join_or(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [one] => one.clone(),
        [head @ .., last] => format!("{} or {last}", head.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_words_are_found_and_far_ones_are_not() {
        let words = ["r", "at", "mat", "name", "radius", "sphere"];
        assert_eq!(nearest("raduis", words), Some("radius"));
        assert_eq!(nearest("Sphere", words), Some("sphere"));
        assert_eq!(nearest("cylinder", words), None);
        assert_eq!(nearest("ta", words), Some("at"), "a swap is one step");
    }

    #[test]
    fn properties_are_known_by_other_names_too() {
        let names = ["at", "r", "mat", "name"];
        assert_eq!(nearest_property("raduis", names.into_iter()), Some("r"));
        assert_eq!(nearest_property("centre", names.into_iter()), Some("at"));
        assert_eq!(nearest_property("banana", names.into_iter()), None);
    }

    #[test]
    fn lists_read_well() {
        assert_eq!(or_list(["a", "b", "c"]), "`a`, `b` or `c`");
        assert_eq!(or_list([]), "");
    }
}
