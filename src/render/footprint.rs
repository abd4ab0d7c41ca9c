//! What the rays of one tile depended on: which surfaces they met, and which parts of space they went through. From it
//! follows whether a change of the scene can move a pixel of the tile.
//!
//! A tile's pixels are a function of three things: the surfaces that its rays met first, the surfaces that stood between
//! those and the lights, and that nothing else stood in the way. The first two are kept by number; the third as the same cones
//! and boxes of points by which the tracer itself decides what a batch of rays may meet.

use super::bounds::{Bounds, larger};
use super::cull::Cone;
use super::world::{Owners, World};

/// What the rays of one tile depended on.
#[derive(Clone, Debug, Default)]
pub struct Footprint {
    /// Primitives that rays met first, ascending.
    pub seen: Box<[u32]>,
    /// Primitives that stood between a seen point and a light, ascending.
    pub shading: Box<[u32]>,
    /// The mirrored and transmitted rays.
    pub beams: Box<[Beam]>,
    /// Boxes around points from which lights were looked for.
    pub lit: Box<[Bounds]>,
    /// Whether a ray met nothing.
    pub background: bool,
}

/// The directions of a batch of rays, and a box around their origins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Holds every origin.
    pub origins: Bounds,
    /// The middle direction, of unit length; 0 for all directions.
    pub axis: [f64; 3],
    /// The smallest cosine between it and a ray.
    pub cos: f64,
}

impl Beam {
    /// The region that the rays stay in.
    pub fn cone(&self, margin: f64) -> Cone {
        Cone::of_directions(self.origins.centre(), self.origins.radius(), self.axis, self.cos, margin)
    }

    /// Holds the rays of both.
    fn union(self, o: Beam) -> Beam {
        let origins = self.origins.union(o.origins);
        let sum: [f64; 3] = std::array::from_fn(|i| self.axis[i] + o.axis[i]);
        let len = dot(sum, sum).sqrt();
        let axis = sum.map(|x| x / len);
        // The wider of the two as seen from the new axis: cos(a + b), while a + b is less than half a turn.
        let seen = |b: Beam| {
            let c = dot(axis, b.axis) - ROUNDING;
            let sine = |c: f64| larger(1.0 - c * c, 0.0).sqrt();
            if c < -b.cos { -1.0 } else { c * b.cos - sine(c) * sine(b.cos) - ROUNDING }
        };
        let cos = if seen(self) < seen(o) { seen(self) } else { seen(o) };
        if len > 0.5 && cos > -1.0 { Beam { origins, axis, cos } } else { Beam { origins, axis: [0.0; 3], cos: -1.0 } }
    }
}

/// More than the roundings of a cosine that is put together from four others.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Most beams and most boxes that are kept of a tile; what comes after is put together with the last.
const MOST: usize = 24;

/// Notes what the rays of a tile do, while they are traced. Costs nothing where it is off.
#[derive(Debug, Default)]
pub struct Recorder {
    on: bool,
    owners: Owners,
    seen: Marks,
    shading: Marks,
    beams: Vec<Beam>,
    lit: Vec<Bounds>,
    background: bool,
    /// Batches and runs since the start of the sample: those of another sample with the same number took nearly the same
    /// way, and are put together.
    beams_so_far: usize,
    lit_so_far: usize,
}

impl Recorder {
    /// Notes what tiles of `world` do.
    pub fn new(world: &World) -> Recorder {
        Recorder::of(world.owners.clone(), world.primitives.len())
    }

    fn of(owners: Owners, primitives: usize) -> Recorder {
        let marks = || Marks::new(primitives);
        Recorder { on: true, owners, seen: marks(), shading: marks(), ..Recorder::default() }
    }

    /// Notes nothing.
    pub fn off() -> Recorder {
        Recorder::default()
    }

    /// Whether anything is noted.
    #[inline(always)]
    pub fn is_on(&self) -> bool {
        self.on
    }

    /// The tile's next sample begins.
    pub fn sample(&mut self) {
        (self.beams_so_far, self.lit_so_far) = (0, 0);
    }

    /// Rays met these surfaces first.
    pub fn saw(&mut self, ids: impl Iterator<Item = u32>) {
        ids.for_each(|id| self.seen.mark(self.owners.of(id)));
    }

    /// A ray met nothing.
    pub fn saw_background(&mut self) {
        self.background = true;
    }

    /// A shadow ray was stopped or dimmed by this surface.
    #[cold]
    pub fn shaded(&mut self, id: u32) {
        self.shading.mark(self.owners.of(id));
    }

    /// A batch of mirrored or transmitted rays set out.
    pub fn beam(&mut self, beam: Beam) {
        merge(&mut self.beams, &mut self.beams_so_far, beam, Beam::union);
    }

    /// Lights were looked for from points in this box.
    pub fn lit(&mut self, points: Bounds) {
        merge(&mut self.lit, &mut self.lit_so_far, points, Bounds::union);
    }

    /// The footprint of the tile that is finished; the next one begins.
    pub fn take(&mut self) -> Footprint {
        let footprint = Footprint {
            seen: self.seen.take(),
            shading: self.shading.take(),
            beams: self.beams.as_slice().into(),
            lit: self.lit.as_slice().into(),
            background: self.background,
        };
        self.beams.clear();
        self.lit.clear();
        self.background = false;
        footprint
    }
}

fn merge<T: Copy>(all: &mut Vec<T>, so_far: &mut usize, new: T, union: impl Fn(T, T) -> T) {
    let at = (*so_far).min(MOST - 1);
    match all.get_mut(at) {
        Some(old) => *old = union(*old, new),
        None => all.push(new),
    }
    *so_far += 1;
}

/// A set of primitives that is emptied in proportion to what is in it.
#[derive(Debug, Default)]
struct Marks {
    is_in: Vec<bool>,
    members: Vec<u32>,
}

impl Marks {
    fn new(n: usize) -> Marks {
        Marks { is_in: vec![false; n], members: Vec::new() }
    }

    fn mark(&mut self, id: u32) {
        if let Some(mark) = self.is_in.get_mut(id as usize)
            && !std::mem::replace(mark, true)
        {
            self.members.push(id);
        }
    }

    fn take(&mut self) -> Box<[u32]> {
        for &id in &self.members {
            self.is_in[id as usize] = false;
        }
        self.members.sort_unstable();
        let members = self.members.as_slice().into();
        self.members.clear();
        members
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::hash::KeyedHash;

    #[test]
    fn a_union_of_beams_holds_the_rays_of_both() {
        let random = |i: u64, k: u64| KeyedHash::new().with(i).with(k).unit() * 2.0 - 1.0;
        let unit = |i: u64, k: u64| {
            let v = [random(i, k), random(i, k + 1), random(i, k + 2)];
            v.map(|x| x / dot(v, v).sqrt())
        };
        let mut narrow = 0;
        for i in 0..3000 {
            let beam = |k: u64| {
                let axis = unit(i, k);
                let spread = 0.5 + 0.5 * random(i, k + 3);
                let cos = 1.0 - 2.0 * (spread * spread) * (spread * spread);
                Beam { origins: Bounds::around(unit(i, k + 4), [0.1; 3]), axis, cos }
            };
            let (a, b) = (beam(0), beam(100));
            let both = a.union(b);
            narrow += (both.cos > 0.0) as u32;
            for k in 0..200 {
                let d = unit(i, 1000 + 10 * k);
                if dot(d, a.axis) >= a.cos || dot(d, b.axis) >= b.cos {
                    assert!(dot(d, both.axis) >= both.cos, "case {i}: {a:?} {b:?} {both:?}");
                }
            }
            for c in [a.axis, b.axis] {
                assert!(dot(c, both.axis) >= both.cos);
            }
        }
        assert!(narrow > 300, "{narrow}");
    }

    #[test]
    fn a_tile_leaves_nothing_to_the_next() {
        let mut r = Recorder::of(Owners::default(), 4);
        r.saw([2, 1, 2].into_iter());
        r.shaded(3);
        r.saw_background();
        let first = r.take();
        assert_eq!((&*first.seen, &*first.shading, first.background), (&[1, 2][..], &[3][..], true));
        let second = r.take();
        assert!(second.seen.is_empty() && second.shading.is_empty() && !second.background);
    }
}
