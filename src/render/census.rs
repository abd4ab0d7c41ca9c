//! Who is who from one world to the next: primitives are known by their content, so that a change of the text shows as what
//! it removed, added and painted anew, wherever in the text it was made.

use super::bounds::Bounds;
use super::bvh::Bvh;
use super::world::World;

/// What a primitive is known and numbered by. Of two surfaces in the same place, that with the lower number is seen: an
/// opaque one rather than one that lets light through, so that glass on a table stands on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PrimitiveKey {
    /// Its shape and place, after whether it lets light through.
    pub geometry: (bool, u64, u64),
    /// All of its material.
    pub material: u64,
    /// What its material lets through.
    pub transmit: u64,
}

/// The new number of every old primitive whose shape and place are still there, whatever its look; `u32::MAX` for others.
/// Both lists are sorted, as worlds number their primitives.
pub fn same_geometry(before: &[PrimitiveKey], after: &[PrimitiveKey]) -> Vec<u32> {
    let mut k = 0;
    let new_number = |old: &PrimitiveKey| {
        while after.get(k).is_some_and(|new| new.geometry < old.geometry) {
            k += 1;
        }
        let is_there = after.get(k).is_some_and(|new| new.geometry == old.geometry);
        k += is_there as usize; // the next twin has its own
        if is_there { k as u32 - 1 } else { u32::MAX }
    };
    before.iter().map(new_number).collect()
}

/// How a world differs from the one before it.
pub struct Change {
    /// The new number of every old primitive that is still there, if only painted anew; `u32::MAX` for the others.
    pub renumbered: Vec<u32>,
    /// Whether an old primitive is gone.
    pub removed: Vec<bool>,
    /// Whether an old primitive has the same shape, place and transparency, but another look.
    pub painted: Vec<bool>,
    /// How many were painted.
    pub painted_count: usize,
    /// The new bounded primitives.
    pub added: Bvh,
    /// The new planes, by number.
    pub added_planes: Vec<u32>,
}

impl Change {
    /// Finds out what became of `before`; both lists are sorted, as worlds number their primitives.
    pub fn between(before: &[PrimitiveKey], after: &[PrimitiveKey], world: &World) -> Change {
        let n = before.len();
        let mut change = Change {
            renumbered: vec![u32::MAX; n],
            removed: vec![false; n],
            painted: vec![false; n],
            painted_count: 0,
            added: Bvh::default(),
            added_planes: Vec::new(),
        };
        let mut added: Vec<u32> = Vec::new();
        let (mut i, mut k) = (0, 0);
        while i < n || k < after.len() {
            // All of one shape and place, in both.
            let geometry = match (before.get(i), after.get(k)) {
                (Some(a), Some(b)) => a.geometry.min(b.geometry),
                (Some(a), None) => a.geometry,
                (None, Some(b)) => b.geometry,
                (None, None) => break,
            };
            let run = |all: &[PrimitiveKey], from: usize| {
                from + all[from..].iter().take_while(|x| x.geometry == geometry).count()
            };
            let (i_end, k_end) = (run(before, i), run(after, k));
            let (old, new) = (&before[i..i_end], &after[k..k_end]);
            if old == new {
                (i..i_end).zip(k..k_end).for_each(|(a, b)| change.renumbered[a] = b as u32);
            } else if let ([a], [b]) = (old, new)
                && a.transmit == b.transmit
            {
                // With twins at the same place, paint would decide which of them is in front.
                (change.renumbered[i], change.painted[i]) = (k as u32, true);
                change.painted_count += 1;
            } else {
                change.removed[i..i_end].fill(true);
                added.extend(k as u32..k_end as u32);
            }
            (i, k) = (i_end, k_end);
        }
        change.add(&added, world);
        change
    }

    fn add(&mut self, added: &[u32], world: &World) {
        if added.is_empty() {
            return;
        }
        let mut is_new = vec![false; world.primitives.len()];
        added.iter().for_each(|&id| is_new[id as usize] = true);
        let bounded: Vec<(u32, Bounds)> = world.bvh.leaves().iter().filter(|l| is_new[l.0 as usize]).copied().collect();
        self.added_planes = world.unbounded.iter().map(|p| p.id).filter(|&id| is_new[id as usize]).collect();
        self.added = Bvh::build(bounded);
    }

    /// Whether nothing changed but the order of numbers.
    pub fn is_nothing(&self) -> bool {
        self.painted_count == 0 && !self.removed.contains(&true) && self.adds_nothing()
    }

    /// Whether nothing was added.
    pub fn adds_nothing(&self) -> bool {
        self.added.is_empty() && self.added_planes.is_empty()
    }
}
