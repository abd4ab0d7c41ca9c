//! Sorts a batch by what its rays met, without moving it: rays are taken by the register, with a mask of those concerned.
//!
//! Neighbouring rays mostly meet the same thing, so most registers belong to one run. Where a run is sparse, as behind a mirror
//! ball, it is packed first.

use super::batch::{Column, MOST, NONE};
use super::world::World;
use crate::math::real::Mask;
use crate::math::{Elem, Lane};

/// Neighbouring rays that fill one register, and which of them are meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LaneGroup {
    /// The first ray.
    pub first: u32,
    /// One bit a ray.
    pub bits: u32,
}

/// All rays of a batch whose hits are shaded together.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// What they met, by [`World::flock`].
    pub flock: u32,
    /// Where they are, in ascending order.
    pub groups: Vec<LaneGroup>,
    /// How many they are.
    pub count: usize,
    /// The one surface that all of them met; [`MANY`] where that isn't one.
    pub only: u32,
}

/// [`Run::only`] of rays that met several surfaces: no surface's number.
pub const MANY: u32 = u32::MAX;

impl LaneGroup {
    /// The place of the first ray in a column. Never beyond what a column holds, so that no access has to check it again.
    #[inline(always)]
    pub fn place(&self) -> usize {
        place(self.first as usize)
    }
}

/// A ray's number, known to be within a batch.
#[inline(always)]
pub fn place(number: usize) -> usize {
    if number < MOST { number } else { MOST }
}

impl Run {
    /// Adds rays; those of one register in one go after another.
    #[inline(always)]
    fn add(&mut self, first: usize, bits: u32) {
        self.count += bits.count_ones() as usize;
        let first = first as u32;
        match self.groups.last_mut() {
            Some(last) if last.first == first => last.bits |= bits,
            _ => self.groups.push(LaneGroup { first, bits }),
        }
    }

    fn begin(&mut self, only: u32) {
        self.groups.clear();
        self.count = 0;
        self.only = only;
    }

    /// Whether most places of its registers are empty, so that packing pays.
    pub fn is_sparse(&self, width: usize) -> bool {
        self.groups.len() > 1 && 2 * self.count < self.groups.len() * width
    }

    /// `count` rays from the first on.
    #[inline(always)]
    pub fn whole(&mut self, count: usize, width: usize, only: u32) {
        self.begin(only);
        self.count = count;
        let all = lanes_below(width, width);
        self.groups.extend((0..count.div_ceil(width)).map(|i| LaneGroup { first: (i * width) as u32, bits: all }));
        if let Some(last) = self.groups.last_mut() {
            last.bits = lanes_below(count - last.first as usize, width);
        }
    }
}

/// The bits of the first `n` places of a register.
#[inline(always)]
fn lanes_below(n: usize, width: usize) -> u32 {
    if n >= 32 { u32::MAX >> (32 - width) } else { ((1u32 << n) - 1) & (u32::MAX >> (32 - width)) }
}

/// A batch, sorted.
#[derive(Debug, Default)]
pub struct Runs {
    /// Rays that met nothing.
    pub missed: Run,
    runs: Vec<Run>,
    used: usize,
    /// The run of each flock; only true where that run says so too.
    run_of: Vec<u32>,
}

impl Runs {
    /// For batches of rays through a world of `primitives`.
    pub fn new(primitives: usize) -> Runs {
        Runs { run_of: vec![0; primitives], ..Runs::default() }
    }

    /// Those that met something.
    pub fn met(&self) -> &[Run] {
        &self.runs[..self.used]
    }

    /// Sorts the first `n` rays by what they met.
    #[inline(always)]
    pub fn sort<L: Lane>(&mut self, world: &World, ids: &Column<L::Elem>, n: usize) {
        self.missed.begin(MANY);
        self.used = 0;
        if n == 0 {
            return;
        }
        // Mostly all of a batch met the same.
        let first_id = ids[0].to_f64();
        if is_all::<L>(ids, n, first_id) {
            let (run, only) = match first_id == NONE {
                true => (&mut self.missed, MANY),
                false => (self.run_of(world.flock(first_id as u32), first_id as u32), first_id as u32),
            };
            run.whole(n, L::WIDTH, only);
            return;
        }
        let none = L::splat(NONE);
        for first in (0..n).step_by(L::WIDTH) {
            let id = L::load(&ids[first..]);
            let all = lanes_below(n - first, L::WIDTH);
            let missed = id.same(none).bits() & all;
            if missed != 0 {
                self.missed.add(first, missed);
            }
            let mut rest = all & !missed;
            while rest != 0 {
                let one = ids[first + rest.trailing_zeros() as usize].to_f64();
                let here = id.same(L::splat(one)).bits() & rest;
                let run = self.run_of(world.flock(one as u32), one as u32);
                if run.only != one as u32 {
                    run.only = MANY;
                }
                run.add(first, here);
                rest &= !here;
            }
        }
    }

    #[inline(always)]
    fn run_of(&mut self, flock: u32, id: u32) -> &mut Run {
        let known = self.run_of[flock as usize] as usize;
        if known < self.used && self.runs[known].flock == flock {
            return &mut self.runs[known];
        }
        self.new_run(flock, id)
    }

    #[inline(never)]
    fn new_run(&mut self, flock: u32, id: u32) -> &mut Run {
        if self.used == self.runs.len() {
            self.runs.push(Run::default()); // once for the most that a batch has had
        }
        self.run_of[flock as usize] = self.used as u32;
        self.used += 1;
        let run = &mut self.runs[self.used - 1];
        run.begin(id);
        run.flock = flock;
        run
    }
}

/// Whether the first `n` of `ids` are all `id`.
#[inline(always)]
fn is_all<L: Lane>(ids: &Column<L::Elem>, n: usize, id: f64) -> bool {
    let id = L::splat(id);
    let whole = n / L::WIDTH * L::WIDTH;
    for first in (0..whole).step_by(L::WIDTH) {
        if (!L::load(&ids[place(first)..]).same(id)).any() {
            return false;
        }
    }
    let rest = lanes_below(n - whole, L::WIDTH);
    rest == 0 || L::load(&ids[place(whole)..]).same(id).bits() & rest == rest
}
