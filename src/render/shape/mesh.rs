//! A mesh in the world: many triangles that share corners, so that what two of them have in common is the same numbers.
//!
//! Only the corners stand in the world. A triangle's normal is computed where a ray meets it, from the corners as the file has
//! them: far out in the world there would be less left of them.

use super::triangle::{self, Sides};
use super::{Surface, Visit};
use crate::math::real::{axpy, each3, minus, splat3, three};
use crate::math::{Affine, Elem, Lane, Real};
use crate::render::batch::PADDING;
use crate::render::place::{face_normal, normal_to_world, normals_map};
use crate::render::ray::Own;
use crate::scene::MeshData;
use glam::DVec3;
use rayon::prelude::*;
use std::sync::Arc;

/// A mesh where it stands.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// The number of its first triangle among the world's surfaces; the others follow in the order of the file.
    pub first: u32,
    /// The primitive that it is.
    pub owner: u32,
    /// The triangles, between points as the file has them.
    data: Arc<MeshData>,
    /// The same points, relative to the camera.
    points: Vec<[f64; 3]>,
    /// Takes normals to the world, but for their length.
    to_world: [[f64; 3]; 3],
    /// The file's normals in the world, of unit length; none where the mesh looks flat.
    normals: Vec<[f64; 3]>,
}

impl Mesh {
    /// The triangles of `data`, brought to the camera-relative world by `world_from_object`.
    pub fn new(data: &Arc<MeshData>, smooth: bool, world_from_object: &Affine, (first, owner): (u32, u32)) -> Mesh {
        let to_world = normals_map(world_from_object);
        let normals = if smooth { &data.normals[..] } else { &[] };
        let normal = |n: &[f32; 3]| normal_to_world(&to_world, DVec3::from_array(n.map(f64::from)));
        Mesh {
            first,
            owner,
            points: placed_points(&data.points, world_from_object),
            normals: normals.par_iter().with_min_len(AT_ONCE).map(normal).collect(),
            data: Arc::clone(data),
            to_world,
        }
    }

    /// How many triangles there are.
    pub fn len(&self) -> usize {
        self.data.triangles.len()
    }

    /// Whether normals for shading are those of its triangles.
    pub fn is_flat(&self) -> bool {
        self.normals.is_empty()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The corners of triangle `k` in the camera-relative world.
    #[inline(always)]
    pub fn corners(&self, k: u32) -> [[f64; 3]; 3] {
        let [a, b, c] = self.data.triangles[k as usize];
        [self.points[a as usize], self.points[b as usize], self.points[c as usize]]
    }

    /// The unit normal of triangle `k` in the world, towards the side from which its corners go round counter-clockwise in the
    /// space of the file.
    #[inline]
    pub fn normal(&self, k: u32) -> [f64; 3] {
        normal_to_world(&self.to_world, face_normal(self.data.corners(k as usize)))
    }

    /// The shading normals at the corners of triangle `k`: three times its own where it looks flat.
    #[inline]
    fn shading(&self, k: u32, n: [f64; 3]) -> [[f64; 3]; 3] {
        match self.data.normals_of(k as usize) {
            Some(of) => of.map(|i| self.normals[i as usize]),
            None => [n; 3],
        }
    }

    /// Calls `visit(t, part, valid)` for the crossing of lines with triangle `k`.
    #[inline(always)]
    pub fn crossing<R: Real>(&self, k: u32, (o, d): ([R; 3], [R; 3]), own: Option<Own<R>>, visit: &mut impl Visit<R>) {
        let [a, b, c] = self.corners(k);
        triangle::crossing([splat3(a), splat3(b), splat3(c)], o, d, own, visit);
    }

    /// The surface where rays meet triangle `k`; its local point is the point in the space of the file.
    #[inline(always)]
    pub fn surface<R: Real>(&self, k: u32, (o, d): ([R; 3], [R; 3])) -> Surface<R> {
        let [a, b, c] = self.corners(k);
        let n = self.normal(k);
        let shading = match self.normals.is_empty() {
            true => None,
            false => Some(each3!(self.shading(k, n), n => splat3(n))),
        };
        let sides = Sides { v: [splat3(a), splat3(b), splat3(c)], n: splat3(n), shading };
        let made = each3!(self.data.corners(k as usize), p => splat3(p.to_array()));
        with_made_point(triangle::surface(sides, o, d), made)
    }

    /// The surfaces where rays meet triangles, each lane its own, whose numbers are in `k`.
    #[inline(always)]
    pub fn surfaces<L: Lane>(&self, k: L, (o, d): ([L; 3], [L; 3])) -> Surface<L> {
        let v = self.gathered(k);
        let made = rows(L::each(
            [k],
            #[inline(always)]
            |[k]| nine(self.data.corners(k as usize).map(|p| p.to_array())),
        ));
        let n = L::each(
            [k],
            #[inline(always)]
            |[k]| self.normal(k as u32),
        );
        let shading = match self.normals.is_empty() {
            true => None,
            false => Some(rows(L::each(
                [k],
                #[inline(always)]
                |[k]| nine(self.shading(k as u32, self.normal(k as u32))),
            ))),
        };
        with_made_point(triangle::surface(Sides { v, n, shading }, o, d), made)
    }

    /// Calls `visit(t, part, valid)` for the crossings of one ray, the same in all lanes, with the surfaces `ids`, as many as lanes
    /// or fewer: each lane its own. Those that are over take the first one again. Gives the numbers by lane.
    #[inline(always)]
    pub fn crossings_of_one<L: Lane>(
        &self,
        ids: &[u32],
        (o, d): ([L; 3], [L; 3]),
        (source, part, outward): (L, L, L),
        visit: &mut impl Visit<L>,
    ) -> L {
        let mut v = [[[L::Elem::default(); PADDING]; 3]; 3];
        let mut numbers = [L::Elem::default(); PADDING];
        for i in 0..L::WIDTH {
            let id = ids[if i < ids.len() { i } else { 0 }];
            numbers[i] = L::Elem::from_f64(id as f64);
            for (to, from) in v.iter_mut().zip(self.corners(id - self.first)) {
                for (to, from) in to.iter_mut().zip(from) {
                    to[i] = L::Elem::from_f64(from);
                }
            }
        }
        let k = L::load(&numbers);
        let own = Own::of(source.same(k), part, outward.same(L::one()));
        let v = each3!(&v, p => each3!(p, x => L::load(x)));
        triangle::crossing(v, o, d, own, visit);
        k
    }

    /// The corners of triangles, each lane its own, whose numbers are in `k`.
    #[inline(always)]
    pub fn gathered<L: Lane>(&self, k: L) -> [[L; 3]; 3] {
        rows(L::each(
            [k],
            #[inline(always)]
            |[k]| nine(self.corners(k as u32)),
        ))
    }

    /// Bytes it occupies, without what all meshes of its file share.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Mesh>() + size_of_val(&self.points[..]) + size_of_val(&self.normals[..])
    }
}

#[inline(always)]
fn nine([a, b, c]: [[f64; 3]; 3]) -> [f64; 9] {
    [a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]]
}

#[inline(always)]
fn rows<L: Lane>(v: [L; 9]) -> [[L; 3]; 3] {
    [[v[0], v[1], v[2]], [v[3], v[4], v[5]], [v[6], v[7], v[8]]]
}

/// Points that a thread takes at once: some tens of microseconds.
const AT_ONCE: usize = 1 << 12;

fn placed_points(points: &[[f64; 3]], world_from_object: &Affine) -> Vec<[f64; 3]> {
    let all = points.par_iter().with_min_len(AT_ONCE);
    if world_from_object.is_translation() {
        let shift = world_from_object.shift;
        return all.map(|p| three!(i => (shift[i] + crate::math::Dd::new(p[i])).round())).collect();
    }
    all.map(|p| world_from_object.apply(DVec3::from_array(*p)).to_array()).collect()
}

/// The surface with the point of the file's space in place of the weights.
#[inline(always)]
fn with_made_point<R: Real>(s: Surface<R>, [a, b, c]: [[R; 3]; 3]) -> Surface<R> {
    let [beta, _, gamma] = s.local;
    Surface { local: axpy(gamma, minus(c, a), axpy(beta, minus(b, a), a)), ..s }
}
