//! The scene as the tracer sees it from one camera: camera-relative, in tables, and only what this scene requires.
//!
//! Primitives and lights are numbered by their content, not by their place in the text. So the order of objects in the text
//! never changes a pixel: where two surfaces coincide exactly, the same one is always in front, and an opaque one before one
//! that light goes through.

use super::ball::Ball;
use super::bounds::{Bounds, larger};
use super::bvh::{Bvh, TEST};
use super::camera::CameraFrame;
use super::confine::Confined;
use super::frame::LinearMap;
use super::material::{Slot, Surfacing};
use super::pattern::PatternTable;
use super::pattern_point::MadeDetail;
use super::place::Rescale;
use super::ray::Own;
use super::shape::primitive::Tables;
use super::shape::{Kind, Mesh, Primitive, Surface, TriangleData, Visit};
use super::touch::{lies_on, lies_on_triangle, neighbourhood};
use crate::math::{Affine, Dd, Mask, Real};
use crate::scene::range::{LARGEST_F32, SMALLEST_F32};
use crate::scene::{MaterialId, NodeId};

/// What a torus' kernel costs a ray, in tests of the tree's nodes; roughly.
const RING: u32 = 60;

/// The scene as the tracer sees it.
pub struct World {
    pub(super) primitives: Vec<Primitive>,
    /// Around each of them; none where most are in swarms. See [`World::ball`].
    pub(super) balls: Vec<Ball>,
    /// Whether any is a torus.
    pub(super) has_rings: bool,
    /// Node and material of each primitive in the scene.
    pub(super) origins: Vec<(NodeId, MaterialId)>,
    pub(super) maps: Vec<LinearMap>,
    pub(super) triangles: Vec<TriangleData>,
    pub(super) meshes: Vec<Mesh>,
    pub(super) owners: Owners,
    pub(super) spaces: Vec<MadeSpace>,
    pub(super) unbounded: Vec<Unbounded>,
    /// Boxes of primitives of extreme proportions, by ascending number.
    pub(super) extremes: Vec<(u32, Bounds)>,
    /// By primitive; see [`World::flock`].
    pub(super) flocks: Vec<u32>,
    pub(super) bvh: Bvh,
    pub(super) materials: Vec<Surfacing>,
    pub(super) patterns: PatternTable,
    pub(super) lights: Vec<PointLight>,
    pub(super) camera: CameraFrame,
    /// The camera's place in the scene.
    pub(super) eye: [f64; 3],
    pub(super) background: [f64; 3],
    pub(super) ambient: [f64; 3],
}

/// Which primitive a surface belongs to: with numbers beyond those of primitives, triangles belong to their mesh.
#[derive(Clone, Debug, Default)]
pub struct Owners {
    /// How many primitives there are.
    pub(super) primitives: u32,
    /// The first triangle of each mesh, ascending, and the primitive that it is.
    pub(super) meshes: Vec<(u32, u32)>,
}

impl Owners {
    /// The primitive that surface `id` belongs to.
    #[inline(always)]
    pub fn of(&self, id: u32) -> u32 {
        if id < self.primitives || self.meshes.is_empty() { id } else { self.meshes[self.mesh(id)].1 }
    }

    /// The number of the mesh that surface `id`, a triangle, belongs to.
    #[inline]
    fn mesh(&self, id: u32) -> usize {
        self.meshes.partition_point(|m| m.0 <= id).saturating_sub(1)
    }
}

/// The way from a primitive's frame to the space in which its shape was made.
pub(super) struct MadeSpace {
    pub(super) made_from_local: Affine,
    pub(super) rescale: Option<Box<Rescale>>,
    /// Only where a picture or a bump asks.
    pub(super) detail: Option<Box<MadeDetail>>,
}

/// A plane n·p = offset.
pub(super) struct Unbounded {
    pub(super) id: u32,
    pub(super) n: [f64; 3],
    pub(super) offset: f64,
}

/// A light, camera-relative, its power in its colour.
pub(super) struct PointLight {
    pub(super) at: [f64; 3],
    pub(super) color: [f64; 3],
    /// The primitives that it lies on.
    pub(super) touched: Box<[u32]>,
    pub(super) node: NodeId,
}

/// How a shape's own space lies.
pub(super) struct Made {
    pub(super) world_from_object: Affine,
    pub(super) centre: [Dd; 3],
    pub(super) half_height: f64,
}

impl World {
    pub(super) fn find_touched_surfaces(&mut self) {
        let mut lights = std::mem::take(&mut self.lights);
        for light in &mut lights {
            let around = neighbourhood(light.at);
            let mut near: Vec<u32> = self.unbounded.iter().map(|p| p.id).collect();
            self.bvh.gather(
                usize::MAX,
                |b| b.overlaps(&around),
                |id| {
                    near.push(id);
                    true
                },
            );
            near.retain(|&id| match self.primitives.get(id as usize) {
                Some(primitive) => lies_on(primitive, self.tables(), light.at),
                None => {
                    let (mesh, k) = self.triangle(id);
                    lies_on_triangle(mesh.corners(k), mesh.normal(k), light.at)
                }
            });
            light.touched = near.into();
        }
        self.lights = lights;
    }

    /// How many surfaces there are: primitives by number, then the triangles of meshes. A mesh itself is a primitive that no
    /// ray meets.
    pub fn surface_count(&self) -> u32 {
        self.meshes.last().map_or(self.owners.primitives, |m| m.first + m.len() as u32)
    }

    /// All primitives, by number.
    pub fn primitives(&self) -> &[Primitive] {
        &self.primitives
    }

    /// The tree over the bounded ones.
    pub fn tree(&self) -> &Bvh {
        &self.bvh
    }

    /// The tables that primitives refer to.
    #[inline(always)]
    pub fn tables(&self) -> Tables<'_> {
        Tables { maps: &self.maps, triangles: &self.triangles }
    }

    /// The ball around primitive `id`; `None` for a triangle of a mesh.
    #[inline(always)]
    pub(super) fn ball(&self, id: u32) -> Option<Ball> {
        if let Some(ball) = self.balls.get(id as usize) {
            return Some(*ball);
        }
        let primitive = self.primitives.get(id as usize)?;
        Some(Ball::around(primitive, &self.maps))
    }

    /// The primitive that surface `id` belongs to.
    #[inline(always)]
    pub(super) fn primitive(&self, id: u32) -> &Primitive {
        &self.primitives[self.owners.of(id) as usize]
    }

    /// Node and material of surface `id` in the scene.
    pub(super) fn origin(&self, id: u32) -> (NodeId, MaterialId) {
        self.origins[self.owners.of(id) as usize]
    }

    /// The mesh that surface `id` is a triangle of, and which. A number beyond all primitives is that of a triangle.
    #[inline]
    pub(super) fn triangle(&self, id: u32) -> (&Mesh, u32) {
        let mesh = &self.meshes[self.owners.mesh(id)];
        (mesh, id - mesh.first)
    }

    /// The mesh that all of `ids` are triangles of.
    #[inline(always)]
    pub(super) fn mesh_of(&self, ids: &[u32]) -> Option<&Mesh> {
        let first = *ids.first()?;
        if (first as usize) < self.primitives.len() {
            return None;
        }
        let (mesh, _) = self.triangle(first);
        let own = mesh.first..mesh.first + mesh.len() as u32;
        ids.iter().all(|id| own.contains(id)).then_some(mesh)
    }

    /// Calls `visit` for every crossing of rays with surface `id` at t > 0, and for some behind; see [`Primitive::crossings`].
    #[inline(always)]
    pub(super) fn crossings<R: Real, const AT_EYE: bool>(
        &self,
        id: u32,
        (o, d): ([R; 3], [R; 3]),
        own: Option<Own<R>>,
        visit: &mut impl Visit<R>,
    ) {
        if let Some(ball) = self.ball(id) {
            let mut met = !ball.passed_by::<R, AT_EYE>((o, d));
            if let Some(own) = &own {
                met = met | own.here; // what went in must come out, wherever rounding puts the start
            }
            if !met.any() {
                return;
            }
            let visit = &mut Confined::new(met, self.confines(id), (o, d), visit);
            return self.primitives[id as usize].crossings::<R, AT_EYE>(self.tables(), o, d, own, visit);
        }
        let (mesh, k) = self.triangle(id);
        mesh.crossing(k, (o, d), own, visit);
    }

    /// What testing `rays` side by side against surface `id` costs, in tests of the tree's nodes.
    #[inline(always)]
    pub(super) fn cost_of_test(&self, id: u32, rays: usize) -> u32 {
        if self.has_rings
            && let Some(Primitive { kind: Kind::Ring(_), .. }) = self.primitives.get(id as usize)
        {
            return RING * rays as u32; // one after another
        }
        TEST
    }

    /// Whether surface `id` is a primitive of its own whose crossings aren't confined.
    #[inline(always)]
    pub(super) fn is_plain(&self, id: u32) -> bool {
        (id as usize) < self.primitives.len() && self.confines(id).is_none()
    }

    /// The box that crossings with primitive `id` are kept to, if its proportions are extreme.
    #[inline(always)]
    pub(super) fn confines(&self, id: u32) -> Option<&Bounds> {
        if self.extremes.is_empty() {
            return None;
        }
        let at = self.extremes.binary_search_by_key(&id, |e| e.0).ok()?;
        Some(&self.extremes[at].1)
    }

    /// Surface `id` where rays are at `t`, on `part`.
    #[inline(always)]
    pub(super) fn surface<R: Real, const AT_EYE: bool>(
        &self,
        id: u32,
        (o, d): ([R; 3], [R; 3]),
        (t, part): (R, R),
    ) -> Surface<R> {
        if let Some(primitive) = self.primitives.get(id as usize) {
            return primitive.surface::<R, AT_EYE>(self.tables(), o, d, t, part);
        }
        let (mesh, k) = self.triangle(id);
        mesh.surface(k, (o, d))
    }

    /// The same world, but with every ray tested against every surface: what the tree must not change. For tests.
    pub fn without_tree(mut self) -> World {
        // Planes of which nothing can say that a ray doesn't meet them.
        let everywhere = |(id, _): (u32, Bounds)| Unbounded { id, n: [0.0; 3], offset: 0.0 };
        self.unbounded.extend(self.bvh.leaves().map(everywhere));
        self.bvh = Bvh::default();
        self
    }

    /// The material of primitive `id`.
    #[inline(always)]
    pub(super) fn surfacing(&self, id: u32) -> &Surfacing {
        &self.materials[self.primitive(id).material as usize]
    }

    /// The first surface, in the order of the text, whose size or place `f32` can't hold: tracing it so would draw something
    /// else. See [`range`](crate::scene::range).
    pub fn beyond_f32(&self) -> Option<NodeId> {
        let holds = |x: f64| x == 0.0 || (SMALLEST_F32..=LARGEST_F32).contains(&x.abs());
        let edges_hold = |[a, b, c]: [[f64; 3]; 3]| {
            let edge = |p: [f64; 3], q: [f64; 3]| (0..3).map(|i| (p[i] - q[i]).abs()).fold(0.0, larger);
            let near = [a, b, c].as_flattened().iter().all(|x| x.abs() <= LARGEST_F32);
            near && holds(edge(a, b)) && holds(edge(a, c))
        };
        let fits = |p: &Primitive| match &p.kind {
            Kind::Sphere(r) => holds(*r),
            Kind::Plane => true,
            Kind::Disc { r, hole } => holds(*r) && holds(*hole),
            Kind::Cuboid(half) => half.iter().all(|h| holds(*h)),
            Kind::Tube(t) => [t.radius, t.bottom, t.top].into_iter().all(holds),
            Kind::Ring(ring) => holds(ring.tube / ring.scale),
            Kind::Triangle(i) => edges_hold(self.triangles[*i as usize].v),
            Kind::Mesh(i) => {
                let mesh = &self.meshes[*i as usize];
                (0..mesh.len() as u32).all(|k| edges_hold(mesh.corners(k)))
            }
        };
        let near = |p: &Primitive| p.frame.centre.iter().all(|x| x.abs() <= LARGEST_F32);
        let misfit = |i: &usize| !(fits(&self.primitives[*i]) && near(&self.primitives[*i]));
        (0..self.primitives.len()).filter(misfit).map(|i| self.origins[i].0).min()
    }

    /// Bytes held for tracing.
    pub fn memory_bytes(&self) -> usize {
        self.primitives.len() * (size_of::<Primitive>() + size_of::<(NodeId, MaterialId)>())
            + self.maps.len() * size_of::<LinearMap>()
            + self.triangles.len() * size_of::<TriangleData>()
            + self.meshes.iter().map(|m| m.memory_bytes()).sum::<usize>()
            + self.spaces.len() * size_of::<MadeSpace>()
            + self.flocks.len() * size_of::<u32>()
            + self.balls.len() * size_of::<Ball>()
            + self.unbounded.len() * size_of::<Unbounded>()
            + self.extremes.len() * size_of::<(u32, Bounds)>()
            + self.lights.iter().map(|l| size_of::<PointLight>() + size_of_val(&*l.touched)).sum::<usize>()
            + self.materials.len() * size_of::<Surfacing>()
            + self.bvh.memory_bytes()
            + self.patterns.textures.iter().map(|t| t.memory_bytes()).sum::<usize>()
    }

    /// Whether light that meets primitive `id` goes on, dimmed by how much; `None` where a pattern decides.
    #[inline(always)]
    pub(super) fn constant_transmission(&self, id: u32) -> Option<[f64; 3]> {
        match self.surfacing(id).transmit {
            Slot::Constant(c) => Some(c),
            Slot::Pattern(_) => None,
        }
    }
}
