//! The study of one region: what all its steps share, and the cut in two.

use super::super::bounds::larger;
use super::bound::{Bound, Span};
use super::bundle::Bundle;
use super::certifier::Certifier;
use super::polygon::Polygon;
use super::spot::Spaces;
use crate::math::Form;

/// Most cuts of one region. A region that needs more is better divided: pieces cost as much as a smaller region does.
const MOST_PIECES: u32 = 96;

/// What the study of one region knows and has spent.
pub struct Study<'c> {
    /// The scene.
    pub scene: &'c Certifier<'c>,
    /// Where the light of the rays at hand surely lies, whatever they meet.
    pub ceiling: [Span; 3],
    /// Whether only one form for all of the region is of any use: then nothing is cut.
    pub undivided: bool,
    /// Whether a mean was taken that is the better known the wider the region is.
    pub in_rows: bool,
    /// Surfaces of glass so far.
    pub bends: u32,
    /// Of the surface that was painted last.
    pub spaces: Spaces,
    /// The most weight of the rays at hand.
    weight: f64,
    /// Cuts so far.
    pieces: u32,
}

/// Goes on with a polygon on which a test has come out so.
pub type Branch<'b, 'c> = &'b mut dyn FnMut(&mut Study<'c>, &Polygon, bool) -> Bound;

impl<'c> Study<'c> {
    /// With nothing known and nothing spent.
    pub fn new(scene: &'c Certifier<'c>) -> Study<'c> {
        Study {
            scene,
            ceiling: [[0.0; 2]; 3],
            undivided: false,
            in_rows: false,
            bends: 0,
            spaces: Spaces::default(),
            weight: 1.0,
            pieces: 0,
        }
    }

    /// What is known of the light in a rectangle of the picture: left, top, right, bottom.
    pub fn rectangle(&mut self, rect: [f64; 4]) -> Bound {
        let [left, top, right, bottom] = rect;
        let x = Form { x: 0.5 * (right - left), ..Form::between(0.5 * (left + right), 0.5 * (left + right)) };
        let y = Form { y: 0.5 * (bottom - top), ..Form::between(0.5 * (top + bottom), 0.5 * (top + bottom)) };
        let (o, d) = self.scene.grid.ray::<Form>(x, y);
        let (square, depth) = (Polygon::square(), self.scene.depth);
        let bound = self.seen(&square, &Bundle { o, d, start: None, rect: Some(rect) }, depth);
        bound.knowing(&square, self.scene.ceiling(depth))
    }

    /// What is sure without looking.
    pub fn unknown(&self, p: &Polygon) -> Bound {
        Bound::within(p, self.ceiling)
    }

    /// The light of rays that go on up to `depth` times more and carry these shares: looked for, unless it is too faint to matter or
    /// of less than the `least` weight.
    pub fn onward(
        &mut self,
        p: &Polygon,
        shares: [Form; 3],
        (depth, least): (u32, f64),
        look: impl FnOnce(&mut Self) -> Bound,
    ) -> Bound {
        let ceiling = self.scene.ceiling(depth);
        let sizes = shares.map(|f| p.range(f)).map(|(lo, hi)| larger(lo.abs(), hi.abs()));
        let most = |of: &dyn Fn(usize) -> f64| (0..3).map(|c| sizes[c] * of(c)).fold(0.0, larger);
        let weight = self.weight * most(&|_| 1.0);
        if weight < least || self.weight * most(&|c| ceiling[c][1] - ceiling[c][0]) <= self.scene.faint {
            return Bound::within(p, ceiling).through(p, shares);
        }
        let outer = (self.weight, self.ceiling);
        (self.weight, self.ceiling) = (weight, ceiling);
        let bound = look(self).limited(p, ceiling);
        (self.weight, self.ceiling) = outer;
        bound.through(p, shares)
    }

    /// Goes both ways of the test g ≥ 0, each on its side of the cut.
    pub fn split(&mut self, p: &Polygon, g: Form, branch: Branch<'_, 'c>) -> Bound {
        let (lo, hi) = p.range(g);
        if lo >= 0.0 {
            return branch(self, p, true);
        }
        if hi < 0.0 {
            return branch(self, p, false);
        }
        self.pieces += 1;
        if self.undivided || self.pieces > MOST_PIECES || p.is_full() {
            return self.unknown(p);
        }
        let (yes, no) = (p.clipped(g), p.clipped(-g));
        if no.is_empty() {
            return branch(self, p, true);
        }
        if yes.is_empty() {
            return branch(self, p, false);
        }
        let a = branch(self, &yes, true);
        let b = branch(self, &no, false);
        Bound::joined(p, (&yes, a), (&no, b))
    }

    /// Whether all of the tests g ≥ 0 hold.
    pub fn split_all(&mut self, p: &Polygon, tests: &[Form], branch: Branch<'_, 'c>) -> Bound {
        let Some((first, rest)) = tests.split_first() else { return branch(self, p, true) };
        self.split(p, *first, &mut |study, q, yes| match yes {
            true => study.split_all(q, rest, branch),
            false => branch(study, q, false),
        })
    }
}
