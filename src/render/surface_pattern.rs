//! Where on a surface a pattern is asked for, and how a height pattern tilts the normal.

use super::material::{Slot, Surfacing, rows};
use super::pattern_point::{MadeDetail, PatternPoint, Rows, turned};
use super::place::{RESIDUE, Rescale};
use super::shape::{Kind, Primitive};
use super::world::{MadeSpace, World};
use crate::math::real::{axpy, dot, each3, minus, scaled, splat3, three};
use crate::math::{Lane, Real};

/// The maps from one primitive's frame to the spaces of its material's patterns.
pub struct PatternFrame<'w> {
    world: &'w World,
    surfacing: &'w Surfacing,
    made: Option<&'w MadeSpace>,
    /// What of it is asked for each register: looked up once.
    rescale: Option<&'w Rescale>,
    detail: Option<&'w MadeDetail>,
}

impl<'w> PatternFrame<'w> {
    /// Composes the maps into `spaces`: once for each run of hits, none for a material without patterns.
    pub fn new(world: &'w World, primitive: &Primitive, surfacing: &'w Surfacing, spaces: &mut Vec<Rows>) -> Self {
        let made = match primitive.space {
            Primitive::NO_SPACE => None,
            space => Some(&world.spaces[space as usize]),
        };
        if let Some(made) = made {
            spaces.resize(world.patterns.spaces.len(), Rows::default());
            let by_corners = matches!(primitive.kind, Kind::Triangle(_));
            for &k in surfacing.spaces.iter() {
                let map = world.patterns.spaces[k as usize].compose(&made.made_from_local);
                spaces[k as usize] = without_residue(rows(&map), by_corners);
            }
        }
        let rescale = made.and_then(|made| made.rescale.as_deref());
        let detail = made.and_then(|made| made.detail.as_deref());
        PatternFrame { world, surfacing, made, rescale, detail }
    }

    /// Whether normals are tilted by a pattern.
    pub fn has_bump(&self) -> bool {
        self.surfacing.bump.is_some() && self.made.is_some()
    }

    /// The point `local` of the primitive's frame, with outward normal `n` in the world.
    #[inline(always)]
    pub fn point<'s, R: Real>(&'s self, spaces: &'s [Rows], local: [R; 3], n: [R; 3]) -> PatternPoint<'s, R> {
        self.point_as_made(spaces, self.as_made(local), n)
    }

    /// A point of the primitive's frame in the lengths in which the shape was made.
    #[inline(always)]
    fn as_made<R: Real>(&self, local: [R; 3]) -> [R; 3] {
        let Some(rescale) = self.rescale else { return local };
        three!(i => {
            let mut x = local[i] * R::splat(rescale.inverse);
            for (scaled, made) in rescale.faces[i] {
                x = R::select(local[i].same(R::splat(scaled)), R::splat(made), x);
            }
            x
        })
    }

    #[inline(always)]
    fn point_as_made<'s, R: Real>(&'s self, spaces: &'s [Rows], local: [R; 3], n: [R; 3]) -> PatternPoint<'s, R> {
        PatternPoint { local, spaces, n, detail: self.detail }
    }

    /// What the material lets through at a point.
    #[inline(always)]
    pub fn transmission<R: Lane>(&self, world: &World, at: &PatternPoint<'_, R>) -> [R; 3] {
        match self.surfacing.transmit {
            Slot::Constant(c) => splat3(c),
            Slot::Pattern(id) => world.patterns.eval(id, at),
        }
    }
}

/// Takes the rounding error of rotations out of a map: entries far below the largest of their row become 0. The coordinate of
/// a flat face that lies along a cell boundary is then one number all over the face, and no speckle can arise. A
/// triangle's frame is made of its edges, so there the largest entry of all decides.
fn without_residue(map: Rows, by_corners: bool) -> Rows {
    let mut rows = map.rows;
    let largest = |r: &[f64]| r.iter().fold(0.0, |m: f64, x| if x.abs() > m { x.abs() } else { m });
    let of_all = rows.iter().map(|r| largest(&r[..3])).fold(0.0, |m: f64, x| if x > m { x } else { m });
    for row in &mut rows {
        let limit = RESIDUE * if by_corners { of_all } else { largest(&row[..3]) };
        for x in &mut row[..3] {
            if x.abs() <= limit {
                *x = 0.0;
            }
        }
    }
    Rows::new(rows)
}

/// The normal `ns` tilted by the slope of the height pattern: n − ∇h along the surface, in the space in which the shape was
/// made (Blinn, "Simulation of wrinkled surfaces", SIGGRAPH 1978). Slopes are central differences, a fraction of a feature
/// wide.
#[inline(always)]
pub fn bumped<R: Lane>(frame: &PatternFrame<'_>, spaces: &[Rows], local: [R; 3], n: [R; 3], ns: [R; 3]) -> [R; 3] {
    let (Some((pattern, step)), Some(made)) = (frame.surfacing.bump, frame.made) else { return ns };
    let Some(detail) = &made.detail else { return ns };
    let heights = Heights { frame, spaces, pattern, step, local: frame.as_made(local), n };
    let gradient: [R; 3] = match made.made_from_local.inverse() {
        Some(back) => {
            let m = back.linear_f64();
            three!(i => heights.slope([m[0][i], m[1][i], m[2][i]]))
        }
        None => {
            // A triangle: slopes along two directions in its plane, made square by Gram and Schmidt.
            let m = made.made_from_local.linear_f64();
            let (e1, e2) = ([m[0][0], m[1][0], m[2][0]], [m[0][2], m[1][2], m[2][2]]);
            let along = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            let l1 = along(e1, e1).sqrt();
            let u = e1.map(|x| x / l1);
            let share = along(e2, u);
            let rest: [f64; 3] = std::array::from_fn(|i| e2[i] - share * u[i]);
            let l2 = along(rest, rest).sqrt();
            let v = rest.map(|x| x / l2);
            let su = heights.slope([1.0 / l1, 0.0, 0.0]);
            let sv = heights.slope([-share / (l1 * l2), 0.0, 1.0 / l2]);
            axpy(sv, splat3(v), scaled(su, splat3(u)))
        }
    };
    let m = turned(&detail.made_normal_from_world, ns);
    let tilted = minus(m, axpy(-dot(m, gradient), m, gradient));
    turned(&detail.world_normal_from_made, tilted)
}

/// A height pattern around a point.
struct Heights<'a, R> {
    frame: &'a PatternFrame<'a>,
    spaces: &'a [Rows],
    pattern: u32,
    step: f64,
    /// The point, in the lengths in which the shape was made.
    local: [R; 3],
    n: [R; 3],
}

impl<R: Lane> Heights<'_, R> {
    /// The slope per unit of the made space, along the local vector `v` that takes one step there.
    #[inline(always)]
    fn slope(&self, v: [f64; 3]) -> R {
        let v: [R; 3] = each3!(v, x => R::splat(x * self.step));
        let h = R::splat(self.step);
        (self.height(R::one(), v) - self.height(-R::one(), v)) / (h + h)
    }

    /// The height at `side` times `v` from the point. Pictures laid on by normal stay where they are.
    #[inline(always)]
    fn height(&self, side: R, v: [R; 3]) -> R {
        let q = self.frame.point_as_made(self.spaces, axpy(side, v, self.local), self.n);
        self.frame.world.patterns.eval(self.pattern, &q)[0]
    }
}
