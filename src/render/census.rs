//! Who is who from one world to the next: primitives are known by their content, so that a change of the text shows as what
//! it removed, added and painted anew, wherever in the text it was made.

use super::bounds::Bounds;
use super::bvh::Bvh;
use super::digest::{KeyStart, LengthKey, MaterialDigest, content_key, power_to_unit};
use super::material::{Slot, Surfacing};
use super::place::{Form, Placed};
use super::shape::Kind;
use super::world::{Made, World};
use crate::math::Affine;
use crate::scene::Mesh;
use std::sync::OnceLock;

/// What a primitive is known and numbered by. Of two surfaces in the same place, that with the lower number is seen: an
/// opaque one rather than one that lets light through, so that glass on a table stands on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct PrimitiveKey {
    /// Its shape and place, after whether it lets light through.
    pub geometry: (bool, LengthKey),
    /// All of its look: its material.
    pub look: u64,
    /// And, where patterns show, the space that they stand in.
    pub space: LengthKey,
    /// The part of its look that shadows show.
    pub transmit: u64,
}

impl PrimitiveKey {
    /// The key of a shape at its place. Geometry goes before look, so that painting never brings another of two coincident
    /// surfaces to the front.
    pub fn new(
        placed: &Placed,
        made: impl FnOnce() -> Made,
        (material, surfacing): (MaterialDigest, &Surfacing),
        meshes: &[Mesh],
    ) -> PrimitiveKey {
        let geometry = (surfacing.lets_through(), geometry(placed, meshes));
        let (look, mut transmit) = (material.all, material.transmit);
        if !surfacing.patterned {
            return PrimitiveKey { geometry, look, space: LengthKey::default(), transmit };
        }
        let space = pattern_space(placed, &made());
        if let Slot::Pattern(_) = surfacing.transmit {
            transmit = content_key([transmit, space.content, space.power, space.signed].into_iter());
        }
        PrimitiveKey { geometry, look, space, transmit }
    }
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

/// The new number of every old surface, from that of every old primitive: triangles go with their mesh.
pub fn surfaces_renumbered(mut renumbered: Vec<u32>, before: &World, after: &World) -> Vec<u32> {
    for mesh in &before.meshes {
        let there = renumbered[mesh.owner as usize];
        let new = after.meshes.iter().find(|m| m.owner == there);
        renumbered.extend((0..mesh.len() as u32).map(|k| new.map_or(u32::MAX, |m| m.first + k)));
    }
    renumbered
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
        let bounded: Vec<(u32, Bounds)> =
            world.bvh.leaves().filter(|l| is_new[world.owners.of(l.0) as usize]).collect();
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

/// What the keys of spheres begin with whose frame is the world's, but for its origin.
static MOVED_SPHERE: OnceLock<KeyStart> = OnceLock::new();

/// Knows a shape and its place: all lengths, camera-relative, and what has no length.
fn geometry(p: &Placed, meshes: &[Mesh]) -> LengthKey {
    // A stretched frame holds the scale that sizes don't; of any other frame the largest entry is about 1.
    let unit = power_to_unit(p.world_from_local.linear.iter().flatten().map(|x| x.hi));
    let frame = || p.world_from_local.linear.into_iter().flatten().flat_map(move |x| [x.hi * unit, x.lo * unit]);
    let shift = p.world_from_local.shift.into_iter().flat_map(|x| [x.hi, x.lo]);
    let in_frame = |plain: &[f64], sizes: &[f64]| {
        let lengths = sizes.iter().map(|x| x / unit).chain(shift);
        let start = || KeyStart::new(plain.iter().copied().chain(frame()));
        // Most frames are only moved.
        match plain {
            [1.0] if p.world_from_local.is_translation() => MOVED_SPHERE.get_or_init(start).with_lengths(lengths),
            _ => start().with_lengths(lengths),
        }
    };
    match &p.form {
        Form::Framed(kind) => match kind {
            Kind::Sphere(r) => in_frame(&[1.0], &[*r]),
            Kind::Plane => in_frame(&[2.0], &[]),
            Kind::Disc { r, hole } => in_frame(&[3.0], &[*r, *hole]),
            Kind::Cuboid(half) => in_frame(&[4.0], half),
            Kind::Tube(t) => in_frame(&[5.0, t.slope, t.caps as u8 as f64], &[t.radius, t.bottom, t.top]),
            Kind::Ring(r) => in_frame(&[6.0], &[r.r / r.scale, r.tube / r.scale]),
            Kind::Triangle(_) | Kind::Mesh(_) => in_frame(&[7.0], &[]),
        },
        Form::Triangle(v, n, shading) => LengthKey::new(
            [n].into_iter().chain(shading.iter().flatten()).flatten().copied(),
            v.iter().flatten().copied(),
        ),
        Form::Mesh(id, smooth) => {
            let mesh = &meshes[id.0 as usize];
            let mut plain = [8.0, *smooth as u8 as f64, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
            for (word, bytes) in plain[2..].iter_mut().zip(mesh.digest.chunks(4)) {
                *word = bytes.iter().fold(0u32, |w, b| w << 8 | *b as u32) as f64;
            }
            let [lo, hi] = mesh.data.bounds;
            in_frame(&plain, &(hi - lo).to_array())
        }
    }
}

/// Knows the space in which a shape's patterns are evaluated, and what pictures and bumps know of the shape. The lengths are
/// those of the map from there to the world; those in which the shape was made don't change with the world's.
fn pattern_space(p: &Placed, made: &Made) -> LengthKey {
    let flat = |m: &Affine| m.linear.into_iter().flatten().flat_map(|x| [x.hi, x.lo]);
    // The same whether or not the frame was scaled: a turned sphere's map takes the scale back.
    let unit = power_to_unit(p.made_from_local.linear.iter().flatten().map(|x| x.hi));
    let from_local = flat(&p.made_from_local).map(|x| x * unit);
    let origin = p.made_from_local.shift.into_iter().flat_map(|x| [x.hi, x.lo]);
    let faces = p.faces_as_made().into_iter().flatten();
    let shape = made.centre.into_iter().flat_map(|x| [x.hi, x.lo]).chain([made.half_height]);
    LengthKey::new(from_local.chain(origin).chain(faces).chain(shape), flat(&made.world_from_object))
}
