//! Where patterns are asked for: points of a surface over a region, in the spaces of its patterns.

use super::super::pattern_point::Rows;
use super::super::surface_pattern::PatternFrame;
use super::super::world::World;
use super::met::Met;
use crate::math::Form;
use crate::math::real::three;

/// Where patterns are asked for: a point of the surface, homogeneous as [`Met::p`].
pub struct Spot<'s> {
    /// Coordinates in the space of the pattern at hand.
    pub p: [Coordinate; 3],
    /// In the lengths in which the shape was made, times w.
    local: [Form; 3],
    /// The denominator.
    pub w: Form,
    /// The maps from the shape's frame to all spaces.
    pub spaces: &'s [Rows],
}

/// The maps from a surface's frame to the spaces of its patterns.
#[derive(Default)]
pub struct Spaces {
    /// The surface.
    of: Option<u32>,
    rows: Vec<Rows>,
}

/// A coordinate of a point.
#[derive(Clone, Copy)]
pub struct Coordinate {
    /// Times w.
    pub over: Form,
    /// Where it is the same all over the surface: exactly that, so that a face along a pattern's line lies on one side of it.
    pub fixed: Option<f64>,
}

impl Spaces {
    /// Those of a surface: found anew unless it was the last one that was asked for.
    pub fn of(&mut self, world: &World, met: &Met<'_>) -> &[Rows] {
        if self.of != Some(met.start.id) {
            self.of = Some(met.start.id);
            self.rows.clear();
            PatternFrame::new(world, met.primitive, met.surfacing, &mut self.rows);
        }
        &self.rows
    }
}

impl<'s> Spot<'s> {
    /// Where a surface was met, whose lengths as made are `scale` times those of its frame; in the first of the spaces, if
    /// there is one.
    pub fn new(spaces: &'s [Rows], met: &Met<'_>, scale: f64) -> Option<Spot<'s>> {
        let nowhere = Coordinate { over: Form::constant(0.0), fixed: Some(0.0) };
        let local = met.local.map(|x| x.times(scale));
        let spot = Spot { p: [nowhere; 3], local, w: met.w, spaces };
        let p = spot.brought(spaces.first()?);
        Some(spot.within(p))
    }

    /// The point brought to another space.
    pub fn apply(rows: &Rows, p: [Coordinate; 3], w: Form) -> [Coordinate; 3] {
        rows.rows.map(|[x, y, z, shift]| {
            let factors = [x, y, z];
            let depends = (0..3).any(|i| factors[i] != 0.0 && p[i].fixed.is_none());
            let sum = three!(i => p[i].over.times(factors[i]));
            let over = (sum[0] + sum[1]) + (sum[2] + w.times(shift));
            let value = |i: usize| if factors[i] == 0.0 { 0.0 } else { factors[i] * p[i].fixed.unwrap_or(0.0) };
            let fixed = (!depends).then(|| (value(0) + value(1)) + (value(2) + shift));
            Coordinate { over, fixed }
        })
    }

    /// The coordinates themselves.
    pub fn point(&self) -> [Form; 3] {
        self.p.map(|x| x.fixed.map_or_else(|| x.over / self.w, Form::constant))
    }

    /// Another point of the same surface.
    pub fn moved(&self, p: [Form; 3]) -> Spot<'s> {
        let one = Form::constant(1.0);
        let p = p.map(|over| Coordinate { over, fixed: None });
        Spot { p, local: self.local.map(|x| x / self.w), w: one, spaces: self.spaces }
    }

    /// With other coordinates.
    pub fn within(&self, p: [Coordinate; 3]) -> Spot<'s> {
        Spot { p, local: self.local, w: self.w, spaces: self.spaces }
    }

    /// The point brought from the shape's frame to a space.
    pub fn brought(&self, rows: &Rows) -> [Coordinate; 3] {
        let zero = Form::constant(0.0);
        // A flat shape's own level is the only coordinate that stays the same in its frame.
        let local = self.local.map(|over| Coordinate { over, fixed: (over == zero).then_some(0.0) });
        Spot::apply(rows, local, self.w)
    }
}
