//! A number for the content of each pattern and material, whatever its place in the text: what makes the order of objects
//! not matter. And one for the content of what stands in space, by which a scene that is scaled or mirrored as a whole keeps
//! its order.

use super::bounds::larger;
use crate::math::affine::reciprocal_power;
use crate::math::hash::KeyedHash;
use crate::scene::{Filter, Mapping, PatternId, PatternKind, Scene};

/// A material's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MaterialDigest {
    /// Of all of it.
    pub all: u64,
    /// Of what it lets through.
    pub transmit: u64,
}

/// The digests of every material of the scene.
pub fn material_digests(scene: &Scene) -> Vec<MaterialDigest> {
    let mut patterns: Vec<u64> = Vec::with_capacity(scene.patterns.len());
    for p in &scene.patterns {
        let digest = pattern_digest(scene, &p.kind, &patterns);
        patterns.push(digest);
    }
    let of = |id: PatternId| patterns[id.0 as usize];
    let digest = |m: &crate::scene::Material| {
        let slots = [m.color, m.ambient, m.diffuse, m.specular, m.shininess, m.reflect, m.transmit];
        let rest = [m.ior.map_or(0, f64::to_bits), m.bump.map_or(0, of)];
        let all = content_key(slots.into_iter().map(of).chain(rest));
        MaterialDigest { all, transmit: of(m.transmit) }
    };
    scene.materials.iter().map(digest).collect()
}

/// A number that depends on nothing but the given words.
pub fn content_key(words: impl Iterator<Item = u64>) -> u64 {
    words.fold(KeyedHash::new(), KeyedHash::with).bits()
}

/// Knows and orders things with lengths. What is different differs in it, as good as surely. But the order is that of shapes
/// without their scale and signs first: all lengths times a power of two, which is exact, leave the order as it is, and
/// so does a mirror, but for things that are each other's mirror image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct LengthKey {
    /// Of magnitudes, lengths brought to unit size.
    pub content: u64,
    /// The power of two by which they were brought there: the exponent's bits, which grow with it.
    pub power: u64,
    /// Of the same with their signs.
    pub signed: u64,
}

impl LengthKey {
    /// The key of `plain` numbers (a NaN stands for none) and `lengths`.
    pub fn new(plain: impl Iterator<Item = f64>, lengths: impl Iterator<Item = f64> + Clone) -> LengthKey {
        KeyStart::new(plain).with_lengths(lengths)
    }
}

/// The beginning of a [`LengthKey`]: many things have the same.
#[derive(Clone, Copy, Debug)]
pub struct KeyStart {
    content: KeyedHash,
    signed: KeyedHash,
}

impl KeyStart {
    /// Of `plain` numbers (a NaN stands for none).
    pub fn new(plain: impl Iterator<Item = f64>) -> KeyStart {
        plain.fold(KeyStart { content: KeyedHash::new(), signed: KeyedHash::new() }, KeyStart::with)
    }

    // -0 counts as 0.
    fn with(self, x: f64) -> KeyStart {
        KeyStart { content: self.content.with_f64(x.abs()), signed: self.signed.with_f64(x) }
    }

    /// The whole key.
    pub fn with_lengths(self, lengths: impl Iterator<Item = f64> + Clone) -> LengthKey {
        let power = power_to_unit(lengths.clone());
        let all = lengths.map(|x| x * power).fold(self, KeyStart::with);
        LengthKey { content: all.content.bits(), power: power.to_bits(), signed: all.signed.bits() }
    }
}

/// The power of two that brings the largest magnitude into 1..2; 1 where that is 0.
pub fn power_to_unit(x: impl Iterator<Item = f64>) -> f64 {
    let largest = x.map(f64::abs).fold(0.0, larger);
    if largest.is_normal() { reciprocal_power(largest) } else { 1.0 }
}

fn pattern_digest(scene: &Scene, kind: &PatternKind, before: &[u64]) -> u64 {
    use PatternKind as K;
    let numbers = |tag: u64, v: &[f64]| v.iter().fold(KeyedHash::new().with(tag), |h, x| h.with_f64(*x));
    let own = match kind {
        K::Constant(c) => numbers(1, &c.0),
        K::Checker { size, .. } => numbers(2, &[*size]),
        K::Stripes { axis, size, .. } => numbers(3, &[*axis as f64, *size]),
        K::Rings { axis, size, .. } => numbers(4, &[*axis as f64, *size]),
        K::Gradient { axis, size, .. } => numbers(5, &[*axis as f64, *size]),
        K::Noise { octaves, seed, .. } => numbers(6, &[*octaves as f64]).with(*seed),
        K::Cells { seed, .. } => numbers(7, &[]).with(*seed),
        K::Brick { size, gap, .. } => numbers(8, &[size[0], size[1], *gap]),
        K::Image { image, mapping, filter } => {
            let mapping = match mapping {
                Mapping::Spherical => 0.0,
                Mapping::Normal => 1.0,
                Mapping::Cylindrical => 2.0,
                Mapping::Planar { axis } => 3.0 + *axis as f64,
            };
            let filter = (*filter == Filter::Nearest) as u8 as f64;
            let content = &scene.images[image.0 as usize].digest;
            let words = content.chunks(8).map(|b| b.iter().fold(0u64, |w, &x| w << 8 | x as u64));
            words.fold(numbers(9, &[mapping, filter]), KeyedHash::with)
        }
        K::Mix { .. } => numbers(10, &[]),
        K::Blend { stops, .. } => numbers(11, &[stops.len() as f64]),
        K::Transformed { parent_from_child, .. } => {
            let rows = super::material::rows(parent_from_child);
            numbers(12, rows.rows.as_flattened())
        }
        K::Turbulence { amount, octaves, seed, .. } => numbers(13, &[*amount, *octaves as f64]).with(*seed),
        K::Add(..) => numbers(14, &[]),
        K::Multiply(..) => numbers(15, &[]),
    };
    kind.children().into_iter().fold(own, |h, c| h.with(before[c.0 as usize])).bits()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_tell_everything_apart_and_keep_their_order_at_every_scale() {
        let lengths = |i: u64, s: f64| [1, 2, 3].map(|k| s * (KeyedHash::new().with(i).with(k).unit() - 0.5));
        let key = |i: u64, s: f64| LengthKey::new([1.0].into_iter(), lengths(i, s).into_iter());
        let order = |s: f64| {
            // Things of one form in several sizes, too.
            let key = |i: u64| key(i % 50, s * [1.0, 2.0, -2.0][i as usize / 50]);
            let mut ids: Vec<u64> = (0..150).collect();
            ids.sort_by_key(|&i| key(i));
            assert!(ids.windows(2).all(|w| key(w[0]) != key(w[1])));
            ids
        };
        for k in [-400, -1, 1, 400] {
            assert_eq!(order(1.0), order(f64::from_bits(((1023 + k) as u64) << 52)), "2^{k}");
        }
        let plain = |x: f64| LengthKey::new([x].into_iter(), [3.0].into_iter());
        assert_ne!(plain(1.0), plain(2.0), "what has no length has a size");
        assert_eq!(plain(0.0), plain(-0.0));
        let mirrored = LengthKey::new([1.0].into_iter(), lengths(7, 1.0).into_iter().map(|x| -x));
        assert!(mirrored != key(7, 1.0) && mirrored.content == key(7, 1.0).content);
    }
}
