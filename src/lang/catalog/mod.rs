//! The vocabulary: every word of the language stands once in the tables of this folder, with its parameters, a sentence,
//! an example and the function that does it. Checking arguments, error messages, help and the reference are made from them.
//!
//! To add a word, add an entry to the table of its topic and the function beside it.

mod angle;
mod color;
mod css;
mod image;
mod light;
mod list;
mod material;
mod maths;
mod mixture;
mod pattern;
mod random;
mod scatter;
mod setting;
mod shape;
mod sort;
mod topic;
mod transform;
mod vector;

pub use topic::{TOPICS, Topic};

use super::value::BuiltinId;
use super::word::{Param, Word};
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};
use std::sync::OnceLock;

struct Catalog {
    words: Vec<&'static Word>,
    ids: HashMap<&'static str, BuiltinId, BuildHasherDefault<WordHasher>>,
}

/// FNV-1a (RFC 9923): the table is made anew by every process, and no text can put anything into it.
struct WordHasher(u64);

impl Default for WordHasher {
    fn default() -> Self {
        WordHasher(0xcbf2_9ce4_8422_2325)
    }
}

impl Hasher for WordHasher {
    fn write(&mut self, bytes: &[u8]) {
        self.0 = bytes.iter().fold(self.0, |h, b| (h ^ u64::from(*b)).wrapping_mul(0x0000_0100_0000_01b3));
    }

    fn finish(&self) -> u64 {
        self.0
    }
}

fn tables() -> &'static Catalog {
    static CATALOG: OnceLock<Catalog> = OnceLock::new();
    CATALOG.get_or_init(|| {
        let tables: [&'static [Word]; 16] = [
            shape::WORDS,
            transform::WORDS,
            material::WORDS,
            pattern::WORDS,
            mixture::WORDS,
            image::WORDS,
            color::WORDS,
            css::WORDS,
            light::WORDS,
            setting::WORDS,
            maths::WORDS,
            angle::WORDS,
            vector::WORDS,
            list::WORDS,
            random::WORDS,
            scatter::WORDS,
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
mod tests;
