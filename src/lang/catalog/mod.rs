//! The vocabulary: every word of the language stands once in the tables of this folder, with its parameters, a sentence,
//! an example and the function that does it. Checking arguments, error messages, help and the reference are made from them.
//!
//! To add a word, add an entry to the table of its topic and the function beside it.

mod color;
mod light;
mod list;
mod material;
mod maths;
mod pattern;
mod random;
mod setting;
mod shape;
mod transform;

use super::value::BuiltinId;
use super::word::{Param, Word};
use std::collections::HashMap;
use std::sync::OnceLock;

struct Catalog {
    words: Vec<&'static Word>,
    ids: HashMap<&'static str, BuiltinId>,
}

fn tables() -> &'static Catalog {
    static CATALOG: OnceLock<Catalog> = OnceLock::new();
    CATALOG.get_or_init(|| {
        let tables: [&'static [Word]; 10] = [
            shape::WORDS,
            transform::WORDS,
            material::WORDS,
            pattern::WORDS,
            color::WORDS,
            light::WORDS,
            setting::WORDS,
            maths::WORDS,
            list::WORDS,
            random::WORDS,
        ];
        let words: Vec<&'static Word> = tables.into_iter().flatten().collect();
        let ids = words.iter().enumerate().map(|(i, w)| (w.name, BuiltinId(i as u16))).collect();
        Catalog { words, ids }
    })
}

/// Every word, by topic.
pub fn catalog() -> &'static [&'static Word] {
    &tables().words
}

/// The word of this name.
pub(super) fn find(name: &str) -> Option<BuiltinId> {
    tables().ids.get(name).copied()
}

/// The slots of a material, as `phong` and `.with` take them.
pub fn material_slots() -> &'static [Param] {
    material::SLOTS
}

/// The word that an id names.
pub(super) fn word(id: BuiltinId) -> &'static Word {
    tables().words[id.0 as usize]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lang::word::{Default, Run};

    #[test]
    fn every_word_is_documented_once() {
        assert_eq!(tables().ids.len(), catalog().len(), "a word stands twice");
        for w in catalog() {
            assert!(w.doc.ends_with('.') && w.doc.len() > 5, "{}: {}", w.name, w.doc);
            assert!(!w.example.is_empty(), "{} has no example", w.name);
            assert!(w.example.contains(w.name), "{}'s example doesn't show it", w.name);
            for p in w.params {
                assert!(!p.doc.is_empty(), "{}.{}", w.name, p.name);
            }
        }
    }

    #[test]
    fn parameters_follow_the_rules() {
        for w in catalog() {
            let positional: Vec<bool> = w.params.iter().map(|p| p.positional).collect();
            assert!(positional.is_sorted_by(|a, b| a >= b), "{}: what goes by position comes first", w.name);
            assert!(w.params.iter().rev().skip(1).all(|p| !p.rest), "{}: rest is last", w.name);
            if let Run::Constant(_) = w.run {
                assert!(w.params.is_empty());
            }
            assert!(w.params.iter().all(|p| p.default != Default::Required || p.positional), "{}", w.name);
        }
    }
}
