//! Where a shape stands: the map between the world and the shape's own frame.
//!
//! The world's origin is the camera, so a scene moved as a whole gives the same numbers. A centre is kept as hi + lo, and a
//! ray's origin reaches the shape's frame with its rounding error beside it (TwoSum, TwoProd): the coefficients of a far
//! shape are then as good as those of a near one.

use super::ray::LocalRay;
use crate::math::real::{dot, each3, splat3, three};
use crate::math::{Affine, Real};

/// Placement of a shape.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// The frame's origin, relative to the camera.
    pub centre: [f64; 3],
    /// What `centre` misses of the exact origin.
    pub centre_lo: [f64; 3],
    /// The axes.
    pub axes: Axes,
}

/// The axes of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// The world's axes, renamed: local axis i is world axis (i + k) mod 3. Exact and free.
    Cyclic(u8),
    /// Any invertible linear map, by its number in the world's table.
    Linear(u32),
}

/// An invertible linear map and its inverse, by rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearMap {
    /// World vectors to local ones.
    pub local_from_world: [[f64; 3]; 3],
    /// Local vectors to world ones.
    pub world_from_local: [[f64; 3]; 3],
    /// Whether it only exchanges axes and signs: a mirror, a quarter turn. Such a map is exact, and normals keep their length.
    pub exchange: bool,
    /// Whether it keeps lengths, all but exactly.
    pub rigid: bool,
}

/// What a rotation's numbers, each rounded once, may leave of the right angles and unit lengths of its rows, and more: 2^-48.
const RIGID: f64 = 1.0 / (1u64 << 48) as f64;

impl LinearMap {
    /// The map with these rows and its inverse's.
    pub fn new(world_from_local: [[f64; 3]; 3], local_from_world: [[f64; 3]; 3]) -> LinearMap {
        let exchange = world_from_local.as_flattened().iter().all(|x| *x == 0.0 || x.abs() == 1.0)
            && world_from_local.iter().all(|row| row.iter().filter(|x| **x != 0.0).count() == 1);
        let rows = &local_from_world;
        let rigid =
            (0..3).all(|i| (0..=i).all(|k| (dot(rows[i], rows[k]) - if i == k { 1.0 } else { 0.0 }).abs() <= RIGID));
        LinearMap { local_from_world, world_from_local, exchange, rigid }
    }
}

impl Frame {
    /// The frame whose map to the camera-relative world is `world_from_local`; `add` stores a linear map where one is needed.
    pub fn new(world_from_local: &Affine, add: impl FnOnce(LinearMap) -> u32) -> Frame {
        let rows = world_from_local.linear_f64();
        let cyclic = (0..3u8).find(|&k| rows == cyclic_rows(k));
        let axes = match cyclic {
            Some(k) => Axes::Cyclic(k),
            None => {
                let inverse = world_from_local.inverse().unwrap_or(Affine::IDENTITY); // a valid scene has no singular map
                Axes::Linear(add(LinearMap::new(rows, inverse.linear_f64())))
            }
        };
        Frame { centre: world_from_local.shift.map(|s| s.hi), centre_lo: world_from_local.shift.map(|s| s.lo), axes }
    }

    /// The ray in this frame. `AT_EYE` says that every origin is exactly 0, which spares the subtraction.
    #[inline(always)]
    pub fn localize<R: Real, const AT_EYE: bool>(&self, maps: &[LinearMap], o: [R; 3], d: [R; 3]) -> LocalRay<R> {
        let f: [(R, R); 3] = three!(i => {
            let (c, c_lo) = (R::splat(-self.centre[i]), R::splat(-self.centre_lo[i]));
            if AT_EYE {
                (c, c_lo)
            } else {
                let (hi, lo) = o[i].two_sum(c);
                (hi, lo + c_lo)
            }
        });
        let d_lo = [R::zero(); 3];
        let renamed = |a: usize, b: usize, c: usize| LocalRay {
            o: [f[a].0, f[b].0, f[c].0],
            o_lo: [f[a].1, f[b].1, f[c].1],
            d: [d[a], d[b], d[c]],
            d_lo,
        };
        match self.axes {
            Axes::Cyclic(0) => renamed(0, 1, 2),
            Axes::Cyclic(1) => renamed(1, 2, 0),
            Axes::Cyclic(_) => renamed(2, 0, 1),
            Axes::Linear(m) => {
                let rows = &maps[m as usize].local_from_world;
                let (from, from_lo) = (each3!(f, x => x.0), each3!(f, x => x.1));
                let mut out = LocalRay { o: d, o_lo: d, d, d_lo };
                for (r, row) in rows.iter().enumerate() {
                    let a = splat3::<R>(*row);
                    let (o, o_lo) = long_dot(a, from);
                    (out.o[r], out.o_lo[r]) = (o, o_lo + dot(a, from_lo));
                    (out.d[r], out.d_lo[r]) = long_dot(a, d);
                }
                out
            }
        }
    }

    /// A local point in the world.
    #[inline(always)]
    pub fn point_to_world<R: Real>(&self, maps: &[LinearMap], p: [R; 3]) -> [R; 3] {
        let v = self.vector_to_world(maps, p);
        three!(i => v[i] + R::splat(self.centre[i]))
    }

    /// A local vector in the world.
    #[inline(always)]
    pub fn vector_to_world<R: Real>(&self, maps: &[LinearMap], v: [R; 3]) -> [R; 3] {
        match self.axes {
            Axes::Cyclic(0) => v,
            Axes::Cyclic(1) => [v[2], v[0], v[1]],
            Axes::Cyclic(_) => [v[1], v[2], v[0]],
            Axes::Linear(m) => each3!(maps[m as usize].world_from_local, row => dot(each3!(row, x => R::splat(x)), v)),
        }
    }

    /// A local unit normal as a unit normal of the world: normals go by the inverse transposed.
    #[inline(always)]
    pub fn normal_to_world<R: Real>(&self, maps: &[LinearMap], n: [R; 3]) -> [R; 3] {
        match self.axes {
            Axes::Cyclic(_) => self.vector_to_world(maps, n),
            Axes::Linear(m) if maps[m as usize].exchange => self.vector_to_world(maps, n),
            Axes::Linear(m) => {
                let a = &maps[m as usize].local_from_world;
                let w: [R; 3] = three!(j => dot(three!(i => R::splat(a[i][j])), n));
                let scale = R::one() / dot(w, w).sqrt();
                each3!(w, x => x * scale)
            }
        }
    }

    /// Bound, by component, on how far [`point_to_world`](Frame::point_to_world) of a local point that is itself within
    /// `error` of the surface can be from the surface, the rounding of one addition that follows included.
    #[inline(always)]
    pub fn world_error<R: Real>(&self, maps: &[LinearMap], p: [R; 3], error: [R; 3]) -> [R; 3] {
        let u = R::UNIT_ROUNDOFF;
        // Of the large part: three products of the map, the sum with the centre, the addition that follows, one to spare.
        let gamma = R::splat(6.0 * u);
        let size = three!(i => gamma.mul_add(p[i].abs(), error[i]));
        let spread = match self.axes {
            Axes::Cyclic(_) => self.vector_to_world(maps, size),
            Axes::Linear(m) => {
                each3!(maps[m as usize].world_from_local, row => dot(each3!(row, x => R::splat(x.abs())), size))
            }
        };
        // Of the centre: its low part, the sum with it, the addition that follows.
        three!(i => spread[i] + R::splat(3.0 * u * self.centre[i].abs()))
    }
}

/// The dot product, rounded as if it were summed exactly, and what that leaves out (Ogita, Rump, Oishi, SIAM J. Sci. Comput. 26,
/// 2005: Dot2). Of a ray all but along a face the terms cancel, and their rounding errors are the result.
#[inline(always)]
fn long_dot<R: Real>(a: [R; 3], b: [R; 3]) -> (R, R) {
    let (s0, e0) = a[0].two_prod(b[0]);
    let (p1, e1) = a[1].two_prod(b[1]);
    let (p2, e2) = a[2].two_prod(b[2]);
    let (s1, g1) = s0.two_sum(p1);
    let (s2, g2) = s1.two_sum(p2);
    s2.two_sum(((e0 + e1) + (e2 + g1)) + g2)
}

fn cyclic_rows(k: u8) -> [[f64; 3]; 3] {
    // world[(i + k) % 3] = local[i], so row r has its 1 in column (r - k) mod 3.
    std::array::from_fn(|r| std::array::from_fn(|c| if (c + k as usize) % 3 == r { 1.0 } else { 0.0 }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn cyclic_frames_are_inverse_to_themselves() {
        for k in 0..3u8 {
            let mut a = Affine::translation(DVec3::new(10.0, 20.0, 30.0));
            a.linear = cyclic_rows(k).map(|r| r.map(crate::math::Dd::new));
            let frame = Frame::new(&a, |_| panic!("no table needed"));
            assert_eq!(frame.axes, Axes::Cyclic(k));
            let ray = frame.localize::<f64, false>(&[], [11.0, 22.0, 33.0], [1.0, 2.0, 3.0]);
            assert_eq!(frame.point_to_world(&[], ray.o), [11.0, 22.0, 33.0]);
            assert_eq!(frame.vector_to_world(&[], ray.d), [1.0, 2.0, 3.0]);
        }
    }

    #[test]
    fn mirrors_and_quarter_turns_keep_normals_to_the_bit() {
        let n = [0.1, 0.7, 0.3]; // of no unit length: a normalised one would differ
        let normal = |a: Affine| {
            let mut maps = Vec::new();
            let frame = Frame::new(&a, |m| {
                maps.push(m);
                0
            });
            frame.normal_to_world::<f64>(&maps, n)
        };
        assert_eq!(normal(Affine::scaling(DVec3::new(-1.0, 1.0, 1.0))), [-0.1, 0.7, 0.3]);
        assert_eq!(normal(Affine::rotation(2, 90.0)), [-0.7, 0.1, 0.3]);
        assert_ne!(normal(Affine::scaling(DVec3::new(-1.0, 2.0, 1.0))), [-0.1, 0.7, 0.3]);
    }

    #[test]
    fn a_direction_along_a_face_keeps_its_last_bits() {
        use crate::math::Dd;
        let mut tiny = 0;
        for i in 1..1000 {
            let k = i as f64;
            let turn = Affine::rotation_about(DVec3::new(k, 1.0, -0.3 * k), 0.37 * k);
            let mut maps = Vec::new();
            let frame = Frame::new(&turn, |m| {
                maps.push(m);
                0
            });
            let across = DVec3::from_array(maps[0].local_from_world[1]).cross(DVec3::new(1.0, k, 0.2)).normalize();
            let d = across.to_array();
            let fast = frame.localize::<f64, false>(&maps, [0.0; 3], d).d[1];
            let exact = frame.localize::<Dd, false>(&maps, [Dd::default(); 3], d.map(Dd::new)).d[1].hi;
            assert!((fast - exact).abs() <= 1e-12 * exact.abs(), "{i}: {fast} for {exact}");
            tiny += (exact.abs() < 1e-15 && exact != 0.0) as u32;
        }
        assert!(tiny > 500, "{tiny}");
    }

    #[test]
    fn linear_frames_keep_the_low_part() {
        let a = Affine::translation(DVec3::new(1e15, 0.0, 0.0)).compose(&Affine::rotation(2, 30.0));
        let mut maps = Vec::new();
        let frame = Frame::new(&a, |m| {
            maps.push(m);
            0
        });
        let ray = frame.localize::<f64, false>(&maps, [0.1, 0.0, 0.0], [1.0, 0.0, 0.0]);
        let total = (ray.o[0] - maps[0].local_from_world[0][0] * -1e15) + ray.o_lo[0];
        assert!((total - 0.1 * maps[0].local_from_world[0][0]).abs() < 0.07, "{total}");
        assert_ne!(ray.o_lo[0], 0.0);
    }
}
