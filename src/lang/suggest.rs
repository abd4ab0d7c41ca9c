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
const SYNONYMS: [(&str, &str); 16] = [
    ("radius", "r"),
    ("center", "at"),
    ("centre", "at"),
    ("position", "at"),
    ("location", "from"),
    ("look_at", "at"),
    ("target", "at"),
    ("material", "mat"),
    ("colour", "color"),
    ("color", "mat"),
    ("colour", "mat"),
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

/// What others call the place and size of a shape that lies between two points here.
const BETWEEN: [&str; 10] =
    ["at", "height", "h", "length", "center", "centre", "position", "base", "axis", "direction"];

/// What to write for the unknown property `word` of something that has `names`: a label, and a replacement if it is one name.
pub fn property_meant<'a>(word: &str, names: impl Iterator<Item = &'a str> + Clone) -> (String, Option<&'a str>) {
    let has = |name| names.clone().any(|n| n == name);
    if BETWEEN.contains(&word) && has("from") && has("to") && !has("at") {
        return ("it lies between two points: write `from` and `to`".into(), None);
    }
    let best = nearest_property(word, names);
    (did_you_mean(best), best)
}

/// What other languages call the words of this one.
const FOREIGN_WORDS: [(&str, &str); 30] = [
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
    ("texture", "image"),
    ("color", "rgb"),
    ("grey", "gray"),
    ("colour", "rgb"),
    ("ln", "log"),
    ("random", "rand"),
    ("reduce", "fold"),
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
    fn foreign_words_lead_to_words_of_the_language() {
        let words = || crate::lang::catalog::catalog().iter().map(|w| w.name);
        for (there, here) in FOREIGN_WORDS {
            assert!(words().any(|w| w == here), "{there} leads to {here}, which isn't a word");
            assert!(words().all(|w| w != there), "{there} is a word itself");
        }
    }

    #[test]
    fn shapes_between_two_points_have_no_place_of_their_own() {
        let cylinder = ["from", "to", "r"];
        let (label, fix) = property_meant("height", cylinder.into_iter());
        assert_eq!((label.as_str(), fix), ("it lies between two points: write `from` and `to`", None));
        assert_eq!(property_meant("radius", cylinder.into_iter()).1, Some("r"));
    }

    #[test]
    fn lists_read_well() {
        assert_eq!(or_list(["a", "b", "c"]), "`a`, `b` or `c`");
        assert_eq!(or_list([]), "");
    }
}
