//! What a slot of a material is at the hits of one run: one value for all, or a column of a pattern's values.

use super::batch::{Column3, load3, store3};
use super::material::Slot;
use super::pattern_point::PatternPoint;
use super::run_of_hits::{FacedBy, RunOfHits, Surfaces};
use crate::math::real::splat3;
use crate::math::{Elem, Lane};

/// A slot's values.
#[derive(Clone, Copy)]
pub enum Paint<L> {
    /// The same everywhere.
    Same([L; 3]),
    /// A column of [`Paints`], by number.
    Column(usize),
}

/// Columns of patterns' values: as many as a material has slots that vary.
#[derive(Default)]
pub struct Paints<E: Elem> {
    columns: Vec<Column3<E>>,
    used: usize,
}

impl<E: Elem> Paints<E> {
    /// Forgets what is there.
    pub fn clear(&mut self) {
        self.used = 0;
    }

    /// The values of `paint` from ray number `g` on.
    #[inline(always)]
    pub fn at<L: Lane<Elem = E>>(&self, paint: Paint<L>, g: usize) -> [L; 3] {
        match paint {
            Paint::Same(value) => value,
            Paint::Column(i) => load3(&self.columns[i], g),
        }
    }

    fn new_column(&mut self) -> usize {
        if self.used == self.columns.len() {
            self.columns.push(Column3::default()); // once for the most slots that vary, not once a run
        }
        self.used += 1;
        self.used - 1
    }
}

impl<E: Elem> RunOfHits<'_, E> {
    /// The values of a slot at the hits.
    #[inline(always)]
    pub fn paint<L: Lane<Elem = E>>(&self, slot: Slot, s: &Surfaces<E>, paints: &mut Paints<E>) -> Paint<L> {
        let id = match slot {
            Slot::Constant(c) => return Paint::Same(splat3(c)),
            Slot::Pattern(id) => id,
        };
        let column = paints.new_column();
        self.paint_pattern::<L>(id, s, &mut paints.columns[column]);
        Paint::Column(column)
    }

    /// A pattern's values at the hits; in a function of its own, for patterns are large.
    fn paint_pattern<L: Lane<Elem = E>>(&self, id: u32, s: &Surfaces<E>, to: &mut Column3<E>) {
        L::vectorize(
            #[inline(always)]
            || {
                for group in self.hits.groups {
                    let g = group.place();
                    let mut outward = load3(&s.n, g);
                    if !s.all_outside {
                        let inside = L::load(&s.inside[g..]).same(L::one());
                        outward = FacedBy { inside }.face(outward);
                    }
                    let at: PatternPoint<'_, L> = self.frame.point(self.spaces, load3(&s.local, g), outward);
                    store3(to, g, self.world.patterns.eval_in_loop(id, &at));
                }
            },
        );
    }
}
