//! Rays in bulk, as columns: a kernel reads and writes several of them at a time. Numbers of slots and primitives are stored
//! as scalars too, so that they move with the rays; all stay exact (below 2^24 even in `f32`).

use crate::math::real::select3;
use crate::math::{Elem, Lane};
use std::ops::{Deref, DerefMut};

/// Most rays of a batch: a tile's pixels.
pub const MOST: usize = 256;

/// Columns are longer than a batch by this, so that the last lanes can be loaded and stored whole.
pub const PADDING: usize = 16;

/// One value a ray. Aligned as cache lines are, or every wide load would take two of them; and of one length for all, so that
/// checking one place of one column checks that place of all.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Column<E>([E; MOST + PADDING]);

/// One vector a ray.
pub type Column3<E> = [Column<E>; 3];

impl<E: Elem> Default for Column<E> {
    fn default() -> Column<E> {
        Column([E::default(); MOST + PADDING])
    }
}

impl<E> Deref for Column<E> {
    type Target = [E; MOST + PADDING];
    #[inline(always)]
    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl<E> DerefMut for Column<E> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.0
    }
}

/// The vectors of the rays from number `g` on.
#[inline(always)]
pub fn load3<L: Lane>(c: &Column3<L::Elem>, g: usize) -> [L; 3] {
    [L::load(&c[0][g..]), L::load(&c[1][g..]), L::load(&c[2][g..])]
}

/// Writes the vectors of the rays from number `g` on.
#[inline(always)]
pub fn store3<L: Lane>(c: &mut Column3<L::Elem>, g: usize, v: [L; 3]) {
    for i in 0..3 {
        v[i].store(&mut c[i][g..]);
    }
}

/// Writes the vectors of those rays from number `g` on that are `here`.
#[inline(always)]
pub fn put3<L: Lane>(c: &mut Column3<L::Elem>, g: usize, here: L::Mask, v: [L; 3]) {
    let old = load3(c, g);
    store3(c, g, select3(here, v, old));
}

/// [`RayBatch::source`] of rays from the camera, and the id of what a ray met that met nothing.
pub const NONE: f64 = -1.0;

/// A batch of rays.
#[derive(Clone, Debug, Default)]
pub struct RayBatch<E: Elem> {
    /// Origins, camera-relative.
    pub o: Column3<E>,
    /// Directions; any length but 0.
    pub d: Column3<E>,
    /// Weight of what the ray sees, by channel.
    pub weight: Column3<E>,
    /// Which pixel of the tile it belongs to.
    pub slot: Column<E>,
    /// The primitive that it starts on, or [`NONE`].
    pub source: Column<E>,
    /// The part of it.
    pub source_part: Column<E>,
    /// 1 where it leaves that primitive to the outside, 0 where to the inside.
    pub outward: Column<E>,
    /// Number of rays.
    pub len: usize,
}

/// What each ray of a batch met first.
#[derive(Clone, Debug, Default)]
pub struct HitColumns<E: Elem> {
    /// Distance along the ray, in units of its direction's length.
    pub t: Column<E>,
    /// The primitive, or [`NONE`].
    pub id: Column<E>,
    /// The part of it.
    pub part: Column<E>,
}
