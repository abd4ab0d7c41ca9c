//! A number for the content of each pattern and material, whatever its place in the text: what makes the order of objects
//! not matter.

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
            numbers(12, rows.as_flattened())
        }
        K::Turbulence { amount, octaves, seed, .. } => numbers(13, &[*amount, *octaves as f64]).with(*seed),
        K::Add(..) => numbers(14, &[]),
        K::Multiply(..) => numbers(15, &[]),
    };
    kind.children().into_iter().fold(own, |h, c| h.with(before[c.0 as usize])).bits()
}
