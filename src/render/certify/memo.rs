//! Looks that were made before: windows of neighbours overlap, and have their regions in common.

use super::bound::Bound;
use super::certifier::Certifier;
use std::collections::HashMap;

/// What is known of regions of the picture. It changes no bit: what is known of a region depends on nothing but it.
#[derive(Default)]
pub struct Memo {
    known: HashMap<[u64; 4], (Bound, bool)>,
}

/// Regions that are kept at most: of some hundred pixels at an edge, in 3 MB.
const MOST: usize = 8192;

impl Memo {
    /// As [`Certifier::looked_at`]; only where a window reaches beyond its pixel is anything kept.
    pub fn looked_at(&mut self, certifier: &Certifier<'_>, rect: [f64; 4]) -> (Bound, bool) {
        if certifier.window.is_plain() {
            return certifier.looked_at(rect);
        }
        let key = rect.map(f64::to_bits);
        if let Some(known) = self.known.get(&key) {
            return *known;
        }
        if self.known.len() >= MOST {
            self.known.clear();
        }
        let found = certifier.looked_at(rect);
        self.known.insert(key, found);
        found
    }
}
