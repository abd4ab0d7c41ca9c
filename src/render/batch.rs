//! Rays in bulk, as columns: a kernel reads and writes several of them at a time. Numbers of slots and primitives are stored
//! as scalars too, so that they move with the rays; all stay exact (below 2^24 even in `f32`).

use crate::math::{Elem, Lane};

/// One value a ray.
pub type Column<E> = Box<[E]>;
/// One vector a ray.
pub type Column3<E> = [Column<E>; 3];

/// Columns are longer than a batch by this, so that the last lanes can be loaded and stored whole.
pub const PADDING: usize = 16;

/// A column for `n` rays.
pub fn column<E: Elem>(n: usize) -> Column<E> {
    vec![E::default(); n + PADDING].into_boxed_slice()
}

/// Three columns for `n` rays.
pub fn column3<E: Elem>(n: usize) -> Column3<E> {
    [column(n), column(n), column(n)]
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

/// [`RayBatch::source`] of rays from the camera, and the id of what a ray met that met nothing.
pub const NONE: f64 = -1.0;

/// A batch of rays.
#[derive(Clone, Debug)]
pub struct RayBatch<E> {
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

impl<E: Elem> RayBatch<E> {
    /// Room for `n` rays.
    pub fn new(n: usize) -> RayBatch<E> {
        RayBatch {
            o: column3(n),
            d: column3(n),
            weight: column3(n),
            slot: column(n),
            source: column(n),
            source_part: column(n),
            outward: column(n),
            len: 0,
        }
    }
}

/// What each ray of a batch met first.
#[derive(Clone, Debug)]
pub struct HitColumns<E> {
    /// Distance along the ray, in units of its direction's length.
    pub t: Column<E>,
    /// The primitive, or [`NONE`].
    pub id: Column<E>,
    /// The part of it.
    pub part: Column<E>,
}

impl<E: Elem> HitColumns<E> {
    /// Room for `n` rays.
    pub fn new(n: usize) -> HitColumns<E> {
        HitColumns { t: column(n), id: column(n), part: column(n) }
    }
}
