//! What an evaluation leaves for the next: parsed files, decoded pictures and meshes, known by content.

use super::parse::Parsed;
use super::request::{Evaluated, Failure};
use super::running::Running;
use crate::diag::FileId;
use crate::scene::{Image, Mesh};
use std::collections::HashMap;
use std::hash::Hash;
use std::sync::Arc;

/// What is kept from one evaluation to the next. It changes no result, only how long one takes.
///
/// A good evaluation lets go of all that it didn't use. One that failed or was cancelled may not have come to what the next
/// needs again, so it keeps what the last good one used.
#[derive(Debug, Default)]
pub struct Memory {
    pub(super) store: Store,
    /// A cancelled evaluation that is still ending, and has the store.
    pub(super) left: Option<Running<Done>>,
}

/// What a thread that evaluates gives back; the result is worth nothing where it was cancelled.
pub(super) type Done = (Result<Evaluated, Failure>, Store);

/// What is kept.
#[derive(Debug, Default)]
pub(super) struct Store {
    /// By the digest of the file's bytes and by the file's number, which stands in every span.
    pub(super) parses: Shelf<([u8; 32], FileId), Arc<Parsed>>,
    /// By the digest of the file's bytes.
    pub(super) pictures: Shelf<[u8; 32], Image>,
    /// By the digest of the file's bytes.
    pub(super) meshes: Shelf<[u8; 32], Mesh>,
}

impl Store {
    /// Ends an evaluation.
    pub(super) fn end(&mut self, good: bool) {
        self.parses.end(good);
        self.pictures.end(good);
        self.meshes.end(good);
    }

    /// How many parsed files and pictures there are.
    #[cfg(test)]
    pub(super) fn sizes(&self) -> (usize, usize) {
        (self.parses.0.len(), self.pictures.0.len())
    }
}

/// Things of one kind.
#[derive(Debug)]
pub(super) struct Shelf<K, V>(HashMap<K, Kept<V>>);

#[derive(Debug)]
struct Kept<V> {
    value: V,
    /// By this evaluation.
    used: bool,
    /// By the last good one.
    used_well: bool,
}

impl<K: Eq + Hash, V: Clone> Shelf<K, V> {
    /// What is kept under `key`; else what `make` gives, kept unless that is an error.
    pub(super) fn get<E>(&mut self, key: K, make: impl FnOnce() -> Result<V, E>) -> Result<V, E> {
        if let Some(kept) = self.0.get_mut(&key) {
            kept.used = true;
            return Ok(kept.value.clone());
        }
        let value = make()?;
        self.0.insert(key, Kept { value: value.clone(), used: true, used_well: false });
        Ok(value)
    }

    fn end(&mut self, good: bool) {
        self.0.retain(|_, kept| {
            kept.used_well = if good { kept.used } else { kept.used_well };
            std::mem::take(&mut kept.used) || kept.used_well
        });
    }
}

impl<K, V> Default for Shelf<K, V> {
    fn default() -> Self {
        Shelf(HashMap::new())
    }
}
