//! Patterns as the tracer evaluates them: constants folded, only what a live material shows.
//!
//! A pattern's space is reached from the shape's own frame by one composed map, so that the coordinate of a face that lies
//! on a cell boundary is the same number all over the face: no speckle. Below a turbulence, which bends space, maps are
//! applied one after another.
//!
//! Everything here uses plain products and sums: the same bits whether or not it is compiled with fused operations.

use super::pattern_node::PatternNode;
use super::pattern_point::{PatternPoint, apply};
use super::texture::{Edge, Texture};
use crate::math::fun;
use crate::math::noise::{cell_noise, unit_noise, vector_noise};
use crate::math::real::{Lane, Mask, Real, each3, select3, splat3, three};
use crate::scene::Mapping;

/// The patterns of a world.
#[derive(Clone, Debug, Default)]
pub struct PatternTable {
    /// Children stand before their parents.
    pub nodes: Vec<PatternNode>,
    /// From the space in which a shape is made to a pattern's own. Number 0 changes nothing.
    pub spaces: Vec<crate::math::Affine>,
    /// The pictures.
    pub textures: Vec<Texture>,
}

#[inline(always)]
fn apply_linear<R: Real>(rows: &[[f64; 3]; 3], p: [R; 3]) -> [R; 3] {
    each3!(*rows, [x, y, z] => (R::splat(x) * p[0] + R::splat(y) * p[1]) + R::splat(z) * p[2])
}

impl PatternTable {
    /// The value of pattern `id`.
    #[inline(always)]
    pub fn eval<R: Lane>(&self, id: u32, at: &PatternPoint<'_, R>) -> [R; 3] {
        let (id, p) = self.outermost(id, at);
        self.eval_at(id, p, at)
    }

    /// The same for a loop over many points: the commonest patterns are evaluated in it, without a call.
    #[inline(always)]
    pub fn eval_in_loop<R: Lane>(&self, id: u32, at: &PatternPoint<'_, R>) -> [R; 3] {
        let (id, p) = self.outermost(id, at);
        match &self.nodes[id as usize] {
            PatternNode::Checker(a, b, size) => self.checker((*a, *b), *size, p, at),
            PatternNode::Stripes(a, b, axis, size) => self.stripes((*a, *b), (*axis, *size), p, at),
            _ => self.eval_at(id, p, at),
        }
    }

    /// What has to be evaluated for pattern `id`, and where.
    #[inline(always)]
    fn outermost<R: Lane>(&self, id: u32, at: &PatternPoint<'_, R>) -> (u32, [R; 3]) {
        match &self.nodes[id as usize] {
            // It has a way of its own from the shape's frame, and doesn't ask for the point in the space in which that was made.
            PatternNode::InSpace(child, space) => (*child, apply(&at.spaces[*space as usize], at.local)),
            _ => (id, at.made()),
        }
    }

    /// The value of pattern `id` at `p` of the space that it stands in, which is the point `at` of the surface. Recursion is as deep as
    /// patterns nest, which the language limits. The commonest, constant colours, take no call.
    #[inline(always)]
    fn eval_at<R: Lane>(&self, id: u32, p: [R; 3], at: &PatternPoint<'_, R>) -> [R; 3] {
        match &self.nodes[id as usize] {
            PatternNode::Constant(c) => splat3(*c),
            _ => R::vectorize(
                #[inline(always)]
                || self.eval_here(id, p, at),
            ),
        }
    }

    #[inline(always)]
    fn eval_here<R: Lane>(&self, id: u32, p: [R; 3], at: &PatternPoint<'_, R>) -> [R; 3] {
        match &self.nodes[id as usize] {
            PatternNode::Constant(c) => splat3(*c),
            PatternNode::Checker(a, b, size) => self.checker((*a, *b), *size, p, at),
            PatternNode::Stripes(a, b, axis, size) => self.stripes((*a, *b), (*axis, *size), p, at),
            PatternNode::Rings(a, b, axis, size) => {
                let (i, j) = ((*axis as usize + 1) % 3, (*axis as usize + 2) % 3);
                let rho = (p[i] * p[i] + p[j] * p[j]).sqrt();
                self.by_parity((*a, *b), (rho / R::splat(*size)).floor(), p, at)
            }
            PatternNode::Gradient(a, b, axis, size) => {
                let s = clamp01(p[*axis as usize] / R::splat(*size));
                self.lerp((*a, *b), [s; 3], p, at)
            }
            PatternNode::Noise(a, b, octaves, seed) => {
                let [s] = R::each(
                    p,
                    #[inline(always)]
                    |p| [clamp01(unit_noise(p, *octaves, *seed))],
                );
                self.lerp((*a, *b), [s; 3], p, at)
            }
            PatternNode::Cells(a, b, seed) => {
                let [s] = R::each(
                    p,
                    #[inline(always)]
                    |p| [clamp01(cell_noise(p, *seed))],
                );
                self.lerp((*a, *b), [s; 3], p, at)
            }
            PatternNode::Brick(mortar, brick, size, gap) => {
                let [in_brick] = R::each(p, |p| [is_brick(p, *size, *gap)]); // 1 or 0
                self.choose(in_brick.same(R::zero()), (*mortar, *brick), p, at)
            }
            PatternNode::Image { texture, mapping, filter, turn, turn_normal } => {
                let texture = &self.textures[*texture as usize];
                let (v, edges): ([R; 3], _) = match mapping {
                    Mapping::Planar { .. } => (p, [Edge::Repeat; 2]),
                    Mapping::Normal => (apply_linear(turn_normal, at.normal()), [Edge::Clamp; 2]),
                    Mapping::Spherical | Mapping::Cylindrical => {
                        (apply_linear(turn, at.around_centre()), [Edge::Repeat, Edge::Clamp])
                    }
                };
                let half_height = match at.detail {
                    Some(detail) => detail.half_height,
                    None => 1.0,
                };
                R::each(
                    v,
                    #[inline(always)]
                    |v| {
                        let [x, y] = match mapping {
                            Mapping::Planar { axis } => planar(v, *axis),
                            Mapping::Normal => by_normal(v),
                            Mapping::Spherical => spherical(v),
                            Mapping::Cylindrical => [longitude(v), 0.5 + 0.5 * v[1] / half_height],
                        };
                        texture.at(x, y, *filter, edges)
                    },
                )
            }
            PatternNode::Mix(a, b, by) => {
                let share = self.eval_at(*by, p, at);
                self.lerp((*a, *b), share, p, at)
            }
            PatternNode::Blend(stops, by) => self.blend(stops, self.eval_at(*by, p, at)[0], p, at),
            PatternNode::InSpace(child, space) => {
                self.eval_at(*child, apply(&at.spaces[*space as usize], at.local), at)
            }
            PatternNode::Mapped(child, rows) => self.eval_at(*child, apply(rows, p), at),
            PatternNode::Turbulence(child, amount, octaves, seed) => {
                let moved = R::each(
                    p,
                    #[inline(always)]
                    |p| {
                        let v = vector_noise(p, *octaves, *seed);
                        three!(i => p[i] + amount * v[i])
                    },
                );
                self.eval_at(*child, moved, at)
            }
            PatternNode::Add(a, b) => {
                let (x, y) = (self.eval_at(*a, p, at), self.eval_at(*b, p, at));
                three!(i => x[i] + y[i])
            }
            PatternNode::Multiply(a, b) => {
                let (x, y) = (self.eval_at(*a, p, at), self.eval_at(*b, p, at));
                three!(i => x[i] * y[i])
            }
            PatternNode::Within(child, least, most) => {
                each3!(self.eval_at(*child, p, at), x => x.max(R::splat(*least)).min(R::splat(*most)))
            }
        }
    }

    #[inline(always)]
    fn checker<R: Lane>(&self, both: (u32, u32), size: f64, p: [R; 3], at: &PatternPoint<'_, R>) -> [R; 3] {
        let s = R::splat(size);
        let [x, y, z] = each3!(p, x => (x / s).floor());
        self.by_parity(both, x + y + z, p, at)
    }

    #[inline(always)]
    fn stripes<R: Lane>(
        &self,
        both: (u32, u32),
        (axis, size): (u8, f64),
        p: [R; 3],
        at: &PatternPoint<'_, R>,
    ) -> [R; 3] {
        self.by_parity(both, (p[axis as usize] / R::splat(size)).floor(), p, at)
    }

    #[inline(always)]
    fn by_parity<R: Lane>(&self, both: (u32, u32), n: R, p: [R; 3], at: &PatternPoint<'_, R>) -> [R; 3] {
        let half = n * R::splat(0.5);
        self.choose(half.floor().same(half), both, p, at)
    }

    /// `a` where `m`, else `b`; what no lane needs isn't evaluated.
    #[inline(always)]
    fn choose<R: Lane>(&self, m: R::Mask, (a, b): (u32, u32), p: [R; 3], at: &PatternPoint<'_, R>) -> [R; 3] {
        if !m.any() {
            self.eval_at(b, p, at)
        } else if !(!m).any() {
            self.eval_at(a, p, at)
        } else {
            select3(m, self.eval_at(a, p, at), self.eval_at(b, p, at))
        }
    }

    #[inline(always)]
    fn lerp<R: Lane>(&self, (a, b): (u32, u32), s: [R; 3], p: [R; 3], at: &PatternPoint<'_, R>) -> [R; 3] {
        let (a, b) = (self.eval_at(a, p, at), self.eval_at(b, p, at));
        three!(i => (R::one() - s[i]) * a[i] + s[i] * b[i])
    }

    #[inline(always)]
    fn blend<R: Lane>(&self, stops: &[u32], by: R, p: [R; 3], at: &PatternPoint<'_, R>) -> [R; 3] {
        let last = stops.len() - 1;
        let x = clamp01(by) * R::splat(last as f64);
        let mut out = self.eval_at(stops[0], p, at);
        for (k, &stop) in stops.iter().enumerate().skip(1) {
            let s = x - R::splat(k as f64 - 1.0);
            let here = R::zero().lt(s);
            if !here.any() {
                break;
            }
            let (s, c) = (s.min(R::one()), self.eval_at(stop, p, at));
            out = select3(here, three!(i => (R::one() - s) * out[i] + s * c[i]), out);
        }
        out
    }
}

/// `x` between 0 and 1; 0 for what isn't a number, as noise is where a point is too far away for its cell to have one.
#[inline(always)]
fn clamp01<R: Real>(x: R) -> R {
    x.max(R::zero()).min(R::one())
}

/// 1 within a brick, 0 in the mortar around it: half the gap on each side.
fn is_brick(p: [f64; 3], size: [f64; 2], gap: f64) -> f64 {
    let course = (p[1] / size[1]).floor();
    let shift = if (course * 0.5).floor() == course * 0.5 { 0.0 } else { 0.5 * size[0] };
    let within = |x: f64, s: f64| {
        let f = x - (x / s).floor() * s;
        f >= 0.5 * gap && f <= s - 0.5 * gap
    };
    if within(p[0] + shift, size[0]) && within(p[1], size[1]) { 1.0 } else { 0.0 }
}

/// u = asin(n.x)/π + ½, v = asin(n.y)/π + ½; clamped before asin, because a unit normal can be an ulp too long.
fn by_normal(n: [f64; 3]) -> [f64; 2] {
    let f = |x: f64| fun::asin(x.clamp(-1.0, 1.0)) * std::f64::consts::FRAC_1_PI + 0.5;
    [f(n[0]), f(n[1])]
}

/// The share of a turn around y, ½ at +z, growing towards +x.
fn longitude(v: [f64; 3]) -> f64 {
    0.5 + fun::atan2(v[0], v[2]) * (0.5 * std::f64::consts::FRAC_1_PI)
}

fn spherical(v: [f64; 3]) -> [f64; 2] {
    let len = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    let sine = if len > 0.0 { (v[1] / len).clamp(-1.0, 1.0) } else { 0.0 };
    [longitude(v), 0.5 + fun::asin(sine) * std::f64::consts::FRAC_1_PI]
}

/// The two coordinates across the axis, so that the picture is upright and not mirrored, seen from the axis' positive end.
fn planar(p: [f64; 3], axis: u8) -> [f64; 2] {
    match axis {
        0 => [-p[2], p[1]],
        1 => [p[0], -p[2]],
        _ => [p[0], p[1]],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(nodes: Vec<PatternNode>, p: [f64; 3]) -> f64 {
        let id = nodes.len() as u32 - 1;
        let table = PatternTable { nodes, ..PatternTable::default() };
        let at = PatternPoint { local: p, spaces: &[], n: p, detail: None };
        table.eval::<f64>(id, &at)[0]
    }

    fn two(kind: PatternNode) -> Vec<PatternNode> {
        vec![PatternNode::Constant([0.0; 3]), PatternNode::Constant([1.0; 3]), kind]
    }

    #[test]
    fn parity_is_by_floor_so_no_cell_is_double_width() {
        let checker = |x: f64| value(two(PatternNode::Checker(0, 1, 2.0)), [x, 0.5, 0.5]);
        assert_eq!([-3.0, -1.0, 1.0, 3.0].map(checker), [0.0, 1.0, 0.0, 1.0]);
        let stripes = |y: f64| value(two(PatternNode::Stripes(0, 1, 1, 1.0)), [9.0, y, 9.0]);
        assert_eq!([-1.5, -0.5, 0.5, 1.5].map(stripes), [0.0, 1.0, 0.0, 1.0]);
    }

    #[test]
    fn blends_meet_their_stops() {
        let nodes = |x: f64| {
            vec![
                PatternNode::Constant([0.0; 3]),
                PatternNode::Constant([1.0; 3]),
                PatternNode::Constant([5.0; 3]),
                PatternNode::Constant([x; 3]),
                PatternNode::Blend(vec![0, 1, 2], 3),
            ]
        };
        for (x, expected) in [(-1.0, 0.0), (0.25, 0.5), (0.5, 1.0), (0.75, 3.0), (2.0, 5.0)] {
            assert_eq!(value(nodes(x), [0.0; 3]), expected);
        }
    }

    #[test]
    fn bricks_are_laid_in_running_bond() {
        let wall = |x: f64, y: f64| value(two(PatternNode::Brick(0, 1, [2.0, 1.0], 0.1)), [x, y, 0.5]);
        assert_eq!(wall(1.0, 0.5), 1.0);
        assert_eq!(wall(0.02, 0.5), 0.0, "joint");
        assert_eq!(wall(0.02, 1.5), 1.0, "the next course is shifted by half a brick");
        assert_eq!(wall(1.02, 1.5), 0.0);
        assert_eq!(wall(1.0, 0.02), 0.0, "bed");
    }

    #[test]
    fn mappings_have_their_poles_and_seams_where_stated() {
        assert_eq!(by_normal([0.0, 0.0, 1.0]), [0.5, 0.5]);
        assert_eq!(by_normal([1.0 + 1e-16, 0.0, 0.0]), [1.0, 0.5]);
        assert_eq!(spherical([0.0, 0.0, 2.0]), [0.5, 0.5]);
        assert_eq!(spherical([0.0, 3.0, 0.0])[1], 1.0);
        assert_eq!(spherical([3.0, 0.0, 0.0]), [0.75, 0.5]);
        assert_eq!(spherical([0.0; 3])[1], 0.5);
    }
}
