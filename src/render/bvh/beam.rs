//! Rays on their way through the tree, as its nodes see them.
//!
//! A [`Beam`] stands for one ray or for several that run alike: intervals of origins and of inverse directions, as two numbers
//! an axis, the one that makes the entry into a box earliest and the one that makes the exit latest. So a node is tested by
//! the same few instructions for one ray or sixteen, and all roundings are in the beam: a box is missed only if every
//! ray surely misses it.

use super::node::{Fit, power_below};
use crate::math::real::{each3, three};
use crate::math::{Elem, Lane, Mask};
use crate::render::batch::PADDING;
use crate::render::bounds::{Bounds, larger, smaller};
use crate::render::span::stored;

/// Rays in the tree's units.
#[derive(Clone, Copy, Debug)]
pub struct Beam {
    /// Rows of the faces that rays enter by, and leave by.
    pub(super) near_row: [usize; 3],
    pub(super) far_row: [usize; 3],
    /// What is subtracted from those faces, and what the difference is multiplied by.
    pub(super) near_from: [f32; 3],
    pub(super) near_inverse: [f32; 3],
    pub(super) far_from: [f32; 3],
    pub(super) far_inverse: [f32; 3],
    /// Where all rays enter the tree.
    start: f64,
    /// A t of the tree for one of the world.
    speed: f64,
    /// Roundings of t that two surfaces at the same place may differ by, relatively.
    tie: f64,
    /// Whether it is one ray.
    pub(super) is_one: bool,
}

/// Origins and directions of rays: smallest and largest, by axis.
#[derive(Clone, Copy, Debug)]
pub struct Spread {
    /// Of origins.
    pub o: [[f64; 2]; 3],
    /// Of directions.
    pub d: [[f64; 2]; 3],
}

/// More lanes than any register has.
const LANES: usize = 16;

/// The largest number in the lanes of `alive`.
#[inline(always)]
pub fn farthest<L: Lane>(t: L, alive: L::Mask) -> f64 {
    let t = L::select(alive, t, L::splat(f64::NEG_INFINITY));
    let mut all = [L::Elem::default(); LANES];
    t.store(&mut all);
    let mut most = f64::NEG_INFINITY;
    for x in &all[..L::WIDTH] {
        most = larger(x.to_f64(), most);
    }
    most
}

impl Spread {
    /// Of one ray.
    #[inline(always)]
    pub fn of_one(o: [f64; 3], d: [f64; 3]) -> Spread {
        Spread { o: [[o[0]; 2], [o[1]; 2], [o[2]; 2]], d: [[d[0]; 2], [d[1]; 2], [d[2]; 2]] }
    }

    /// Of the lanes of `alive`.
    #[inline(always)]
    pub fn of<L: Lane>(o: [L; 3], d: [L; 3], alive: L::Mask) -> Spread {
        let alive = alive.bits();
        Spread {
            o: [range(o[0], alive), range(o[1], alive), range(o[2], alive)],
            d: [range(d[0], alive), range(d[1], alive), range(d[2], alive)],
        }
    }

    /// Whether it is of one ray.
    #[inline(always)]
    fn is_one(&self) -> bool {
        (0..3).all(
            #[inline(always)]
            |i| self.o[i][0] == self.o[i][1] && self.d[i][0] == self.d[i][1],
        )
    }

    /// Whether the rays run so much alike that a box which the beam meets is met by most of them.
    #[inline(always)]
    pub fn is_narrow(&self) -> bool {
        let alike =
            |[least, most]: [f64; 2]| (least >= 0.0 && most <= 2.0 * least) || (most <= 0.0 && least >= 2.0 * most);
        alike(self.d[0]) && alike(self.d[1]) && alike(self.d[2])
    }
}

/// Smallest and largest number in the lanes of `alive`.
#[inline(always)]
fn range<L: Lane>(v: L, alive: u32) -> [f64; 2] {
    let mut all = [L::Elem::default(); LANES];
    v.store(&mut all);
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for (k, x) in all[..L::WIDTH].iter().enumerate() {
        if alive >> k & 1 == 1 {
            (least, most) = (smaller(x.to_f64(), least), larger(x.to_f64(), most));
        }
    }
    [least, most]
}

/// Roundings of `f64` in a beam's own numbers, and some to spare.
const F64_SLACK: f64 = 16.0 * f64::EPSILON;
/// Of `f32` in a node's test: face minus origin, the inverse, their product; with those of the beam's own numbers, and some to
/// spare.
const F32_SLACK: f64 = 4.0 * f32::EPSILON as f64;
/// Far below every coordinate that matters: covers what [`STEEPEST`] leaves out.
const LEAST: f64 = 1.0 / (1u128 << 90) as f64;
/// A ray moves so little along an axis that it might as well stand still.
const STEEPEST: f64 = (1u128 << 100) as f64;

/// Rays along one axis.
#[derive(Clone, Copy)]
struct Along {
    /// The way they go, 1 or -1; `None` where they go both ways, so that this axis says nothing.
    way: Option<f64>,
    /// One by the fastest and the slowest of them, in t of the world.
    inverse: [f64; 2],
}

impl Along {
    #[inline(always)]
    fn new([least, most]: [f64; 2]) -> Along {
        let way = if least >= 0.0 {
            Some(1.0)
        } else if most <= 0.0 {
            Some(-1.0)
        } else {
            None
        };
        let (a, b) = (1.0 / least.abs(), 1.0 / most.abs());
        Along { way, inverse: if way == Some(1.0) { [b, a] } else { [a, b] } }
    }
}

impl Beam {
    /// The rays of `spread` before they meet the tree in `bounds`; `None` where all miss it. `u` is the unit roundoff of the
    /// kernels that will meet its primitives.
    #[inline(always)]
    pub(super) fn new(fit: &Fit, bounds: &Bounds, spread: &Spread, u: f64) -> Option<Beam> {
        let Spread { o, d } = spread;
        let (mut reach, mut fastest) = (0.0, 0.0);
        for i in 0..3 {
            reach = larger(larger(o[i][0].abs(), o[i][1].abs()), reach);
            fastest = larger(larger(d[i][0].abs(), d[i][1].abs()), fastest);
        }
        // How far a turned surface may seem off by what its frame makes of an origin this far out: 16 roundings, as many as
        // boxes are wider by for their own distance.
        let reach = 16.0 * u * reach;
        // In a shorter format box, centre and size are rounded too.
        let shorter = if u > f64::EPSILON { 16.0 * u } else { 0.0 };
        let along = [Along::new(d[0]), Along::new(d[1]), Along::new(d[2])];
        let (mut start, mut end) = (0.0, f64::INFINITY);
        for i in 0..3 {
            let Some(way) = along[i].way else { continue };
            let slack = reach + (shorter + F64_SLACK) * larger(bounds.lo[i].abs(), bounds.hi[i].abs());
            let (up, down) = (bounds.hi[i] - o[i][0] + slack, bounds.lo[i] - o[i][1] - slack);
            let (enter, leave) = if way > 0.0 { (down, up) } else { (-up, -down) };
            let (enter, leave) = (enter * along[i].inverse[0], leave * along[i].inverse[1]);
            start = if enter > start { enter } else { start };
            end = if leave < end { leave } else { end };
        }
        let start = start * (1.0 - F64_SLACK);
        if start > end * (1.0 + F64_SLACK) || !(start < f64::INFINITY) {
            return None;
        }
        let size = power_below(fastest);
        let wide = 1.0 + F32_SLACK + shorter;
        let mut beam = Beam {
            near_row: [0, 1, 2],
            far_row: [3, 4, 5],
            // As if from far behind: what both ways come to.
            near_from: [STEEPEST as f32; 3],
            near_inverse: [1.0; 3],
            far_from: [-STEEPEST as f32; 3],
            far_inverse: [1.0; 3],
            start,
            speed: fit.scale * size,
            tie: 8.0 * u + F64_SLACK,
            is_one: spread.is_one(),
        };
        for i in 0..3 {
            let Some(way) = along[i].way else { continue };
            let (low, high) = (o[i][0] + start * d[i][0], o[i][1] + start * d[i][1]);
            let gone = larger(o[i][0].abs(), o[i][1].abs()) + start * larger(d[i][0].abs(), d[i][1].abs());
            let far = larger(bounds.lo[i].abs(), bounds.hi[i].abs());
            let slack = reach + F64_SLACK * (gone + fit.origin[i].abs()) + shorter * far;
            let (low, high) = ((low - fit.origin[i] - slack) * fit.scale, (high - fit.origin[i] + slack) * fit.scale);
            let low = (low - low.abs() * (F32_SLACK + shorter) - LEAST) as f32;
            let high = (high + high.abs() * (F32_SLACK + shorter) + LEAST) as f32;
            let inverse = |k: usize| smaller(along[i].inverse[k] * size, STEEPEST);
            beam.near_inverse[i] = (way * inverse(0) / wide) as f32;
            beam.far_inverse[i] = (way * inverse(1) * wide) as f32;
            if way > 0.0 {
                (beam.near_from[i], beam.far_from[i]) = (high, low);
            } else {
                (beam.near_from[i], beam.far_from[i]) = (low, high);
                (beam.near_row[i], beam.far_row[i]) = (i + 3, i);
            }
        }
        Some(beam)
    }

    /// A t of the world in the tree's units, no smaller; wide enough that a box which begins at the very t of a hit isn't
    /// passed over: it may hide another hit there.
    #[inline(always)]
    pub fn reach(&self, t_max: f64) -> f32 {
        let slack = self.tie * (t_max.abs() + self.start);
        let t = ((t_max - self.start) + slack) * self.speed;
        (t + t.abs() * F32_SLACK) as f32
    }
}

/// The largest magnitude of the three, in each lane.
#[inline(always)]
fn largest<L: Lane>(v: [L; 3]) -> L {
    v[0].abs().max(v[1].abs()).max(v[2].abs())
}

/// The rays of a register, each a [`Beam`] of its own: what they are made of is computed for all of them at once.
pub struct Beams<L: Lane> {
    near_from: [[L::Elem; PADDING]; 3],
    near_inverse: [[L::Elem; PADDING]; 3],
    far_from: [[L::Elem; PADDING]; 3],
    far_inverse: [[L::Elem; PADDING]; 3],
    start: [L::Elem; PADDING],
    /// The power of two that brings the fastest component of a direction to 1 or a little more.
    size: [L::Elem; PADDING],
    /// One bit a ray: those that may meet the tree; and, by axis, those that go up along it.
    met: u32,
    up: [u32; 3],
}

impl<L: Lane> Beams<L> {
    /// The rays from `o` along `d` before they meet the tree in `bounds`. The numbers of a [`Beam`], but for a rounding here and there,
    /// which its slack is for.
    #[inline(always)]
    pub(super) fn new(fit: &Fit, bounds: &Bounds, (o, d): ([L; 3], [L; 3])) -> Beams<L> {
        let (zero, u) = (L::zero(), L::UNIT_ROUNDOFF);
        let reach = L::splat(16.0 * u) * largest(o);
        let mut sizes = stored(largest(d));
        for x in &mut sizes[..L::WIDTH] {
            *x = L::Elem::from_f64(power_below(x.to_f64()));
        }
        let unit = L::load(&sizes);
        let inverse = each3!(d, x => L::one() / x.abs());
        let rises = each3!(d, x => zero.le(x));
        let (mut start, mut end) = (zero, L::splat(f64::INFINITY));
        for i in 0..3 {
            let slack = reach + L::splat(F64_SLACK * larger(bounds.lo[i].abs(), bounds.hi[i].abs()));
            let (up, down) = (L::splat(bounds.hi[i]) - o[i] + slack, L::splat(bounds.lo[i]) - o[i] - slack);
            let enter = L::select(rises[i], down, -up) * inverse[i];
            let leave = L::select(rises[i], up, -down) * inverse[i];
            (start, end) = (enter.max(start), leave.min(end));
        }
        let start = start * L::splat(1.0 - F64_SLACK);
        let met = start.le(end * L::splat(1.0 + F64_SLACK)) & start.lt(L::splat(f64::INFINITY));
        let scale = L::splat(fit.scale);
        let from = three!(i => {
            let middle = start.mul_add(d[i], o[i]) - L::splat(fit.origin[i]);
            let gone = start.mul_add(d[i].abs(), o[i].abs());
            let slack = reach + L::splat(F64_SLACK) * (gone + L::splat(fit.origin[i].abs()));
            let (low, high) = ((middle - slack) * scale, (middle + slack) * scale);
            let low = low - low.abs().mul_add(L::splat(F32_SLACK), L::splat(LEAST));
            let high = high + high.abs().mul_add(L::splat(F32_SLACK), L::splat(LEAST));
            (L::select(rises[i], high, low), L::select(rises[i], low, high))
        });
        let inverse = three!(i => {
            let inverse = (inverse[i] * unit).min(L::splat(STEEPEST));
            let signed = L::select(rises[i], inverse, -inverse);
            (signed * L::splat(1.0 / (1.0 + F32_SLACK)), signed * L::splat(1.0 + F32_SLACK))
        });
        Beams {
            near_from: each3!(&from, x => stored(x.0)),
            near_inverse: each3!(&inverse, x => stored(x.0)),
            far_from: each3!(&from, x => stored(x.1)),
            far_inverse: each3!(&inverse, x => stored(x.1)),
            start: stored(start),
            size: sizes,
            met: met.bits(),
            up: each3!(rises, x => x.bits()),
        }
    }

    /// Ray number `k`; `None` where it misses the tree.
    #[inline(always)]
    pub(super) fn get(&self, fit: &Fit, k: usize) -> Option<Beam> {
        let k = k % PADDING;
        if self.met >> k & 1 == 0 {
            return None;
        }
        let lower = each3!(self.up, up => 3 * (1 - (up >> k & 1) as usize));
        let of =
            |v: &[[L::Elem; PADDING]; 3]| [v[0][k].to_f64() as f32, v[1][k].to_f64() as f32, v[2][k].to_f64() as f32];
        Some(Beam {
            near_row: [lower[0], 1 + lower[1], 2 + lower[2]],
            far_row: [3 - lower[0], 4 - lower[1], 5 - lower[2]],
            near_from: of(&self.near_from),
            near_inverse: of(&self.near_inverse),
            far_from: of(&self.far_from),
            far_inverse: of(&self.far_inverse),
            start: self.start[k].to_f64(),
            speed: fit.scale * self.size[k].to_f64(),
            tie: 8.0 * L::UNIT_ROUNDOFF + F64_SLACK,
            is_one: true,
        })
    }
}

/// Rays of a register, for each to go through the tree by itself.
#[allow(clippy::large_enum_variant)] // it stays where it is made
pub enum Rays<L: Lane> {
    /// In the tree's units.
    Ready(Beams<L>),
    /// Origins and directions of a shorter format.
    Shorter([[L::Elem; PADDING]; 3], [[L::Elem; PADDING]; 3]),
}
