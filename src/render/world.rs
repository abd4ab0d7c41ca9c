//! The scene as the tracer sees it from one camera: camera-relative, in tables, and only what this scene requires.
//!
//! Primitives and lights are numbered by their content, not by their place in the text. So the order of objects in the text
//! never changes a pixel: where two surfaces coincide exactly, the same one is always in front, and an opaque one before one
//! that light goes through.

use super::bounds::{Bounds, larger};
use super::bvh::Bvh;
use super::camera::CameraFrame;
use super::census::{PrimitiveKey, same_geometry};
use super::digest::{LengthKey, MaterialDigest, material_digests};
use super::frame::Frame;
use super::material::{MaterialCompiler, Slot, Surfacing};
use super::pattern::PatternTable;
use super::place::{Form, Placed, Rescale, place, world_bounds};
use super::ray::Own;
use super::shape::primitive::Tables;
use super::shape::{Kind, Primitive, Surface, TriangleData, Visit};
use super::touch::{lies_on, neighbourhood};
use crate::math::real::three;
use crate::math::{Affine, Dd, Real};
use crate::render::frame::LinearMap;
use crate::scene::range::{LARGEST_F32, SMALLEST_F32};
use crate::scene::{Camera, Instance, MaterialId, NodeId, NodeKind, Scene};
use glam::DVec3;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// The scene as the tracer sees it.
pub struct World {
    pub(super) primitives: Vec<Primitive>,
    /// Node and material of each primitive in the scene.
    pub(super) origins: Vec<(NodeId, MaterialId)>,
    pub(super) maps: Vec<LinearMap>,
    pub(super) triangles: Vec<TriangleData>,
    pub(super) spaces: Vec<MadeSpace>,
    pub(super) unbounded: Vec<Unbounded>,
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

/// The way from a primitive's frame to the space in which its shape was made.
pub(super) struct MadeSpace {
    pub(super) made_from_local: Affine,
    pub(super) rescale: Option<Rescale>,
    /// Only where a picture or a bump asks.
    pub(super) detail: Option<MadeDetail>,
}

/// What pictures and bumps need of a shape.
pub(super) struct MadeDetail {
    /// World normals to normals of the space in which the shape was made, but for their length.
    pub(super) made_normal_from_world: [[f64; 3]; 3],
    /// And back.
    pub(super) world_normal_from_made: [[f64; 3]; 3],
    /// From the shape's centre to the origin of its frame, in the space in which it was made.
    pub(super) from_centre: [f64; 3],
    pub(super) half_height: f64,
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

/// A primitive with what it is numbered by.
struct Entry {
    key: PrimitiveKey,
    placed: Placed,
    instance: Instance,
    made: Made,
}

/// How a shape's own space lies.
pub(super) struct Made {
    pub(super) world_from_object: Affine,
    pub(super) centre: [Dd; 3],
    pub(super) half_height: f64,
}

impl World {
    /// Prepares `scene` as seen by `camera`.
    pub fn build(scene: &Scene, camera: &Camera) -> World {
        match World::build_keyed(scene, camera, None, &AtomicBool::new(false)) {
            Some((world, _)) => world,
            None => unreachable!("nothing cancels it"),
        }
    }

    /// Prepares `scene` as seen by `camera`, and says what each primitive is known by; `None` where `cancel` was set
    /// meanwhile. The tree of the world `before`, with its keys, goes on living where little changed.
    pub(super) fn build_keyed(
        scene: &Scene,
        camera: &Camera,
        before: Option<(&World, &[PrimitiveKey])>,
        cancel: &AtomicBool,
    ) -> Option<(World, Vec<PrimitiveKey>)> {
        let go_on = || if cancel.load(Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        let to_camera = Affine::translation(-camera.from);
        let (mut shapes, mut lights) = (Vec::new(), Vec::new());
        // From the camera down: what moves both scene and camera cancels first, exactly.
        let visited = scene.try_for_each_instance_from(&to_camera, |i| {
            match &scene.node(i.node).kind {
                NodeKind::Light(light) => {
                    let at = i.world_from_object.apply(light.at).to_array();
                    let color = (light.color * light.power).0;
                    if color != [0.0; 3] {
                        lights.push(PointLight { at, color, touched: Box::default(), node: i.node });
                    }
                }
                NodeKind::Shape(_) => shapes.push(i),
                NodeKind::Group(_) | NodeKind::Transformed { .. } => {}
            }
            go_on()
        });
        if visited.is_break() {
            return None;
        }
        lights.sort_by_cached_key(|l| LengthKey::new(l.color.into_iter(), l.at.into_iter()));

        let mut world = World {
            primitives: Vec::new(),
            origins: Vec::new(),
            maps: Vec::new(),
            triangles: Vec::new(),
            spaces: Vec::new(),
            unbounded: Vec::new(),
            flocks: Vec::new(),
            bvh: Bvh::default(),
            materials: Vec::new(),
            patterns: PatternTable::default(),
            lights,
            camera: CameraFrame::new(camera),
            eye: camera.from.to_array(),
            background: scene.background.0,
            ambient: scene.ambient.0,
        };
        let digests = material_digests(scene);
        let numbers = world.compile_materials(scene, &shapes, &digests);
        let mut entries = Vec::with_capacity(shapes.len());
        for instance in shapes {
            let NodeKind::Shape(shape) = &scene.node(instance.node).kind else { continue };
            if go_on().is_break() {
                return None;
            }
            let world_from_object = instance.world_from_object;
            for placed in place(shape, &world_from_object) {
                let (centre, half_height) = middle(shape);
                let made = Made { world_from_object, centre, half_height };
                let material = instance.material.0 as usize;
                let surfacing = &world.materials[numbers[material] as usize];
                let key = PrimitiveKey::new(&placed, &made, digests[material], surfacing);
                entries.push(Entry { key, placed, instance: instance.clone(), made });
            }
        }
        // Entries are large: their keys and numbers are sorted, and they stay where they are.
        let mut order: Vec<(PrimitiveKey, u32)> = entries.iter().zip(0..).map(|(e, i)| (e.key, i)).collect();
        order.sort_unstable();
        let keys: Vec<PrimitiveKey> = order.iter().map(|o| o.0).collect();
        let mut bounded = Vec::with_capacity(entries.len());
        for (_, i) in order {
            world.add(&entries[i as usize], &numbers, &mut bounded);
            if go_on().is_break() {
                return None;
            }
        }
        // Boxes are relative to the camera's place.
        let before = before.filter(|(old, _)| old.eye == world.eye);
        world.bvh = match before.and_then(|b| grafted(b, &keys, &bounded)) {
            Some(tree) => tree,
            None => Bvh::build_unless(bounded, u32::MAX, cancel)?,
        };
        if go_on().is_break() {
            return None;
        }
        world.find_touched_surfaces();
        world.find_flocks();
        Some((world, keys))
    }

    /// Compiles the materials that shapes wear; gives each scene material its number here. They are compiled in the order of
    /// their content: which patterns get a space of their own, where there are too many, isn't left to the text.
    fn compile_materials(&mut self, scene: &Scene, shapes: &[Instance], digests: &[MaterialDigest]) -> Vec<u32> {
        let mut worn: Vec<usize> = Vec::new();
        let mut numbers = vec![u32::MAX; scene.materials.len()];
        for i in shapes {
            let number = &mut numbers[i.material.0 as usize];
            if *number == u32::MAX {
                *number = 0;
                worn.push(i.material.0 as usize);
            }
        }
        worn.sort_by_key(|&m| digests[m].all);
        let mut compiler = MaterialCompiler::new(scene);
        for m in worn {
            numbers[m] = self.materials.len() as u32;
            self.materials.push(compiler.compile(&scene.materials[m], !self.lights.is_empty()));
        }
        self.patterns = compiler.finish();
        numbers
    }

    fn add(&mut self, entry: &Entry, numbers: &[u32], bounded: &mut Vec<(u32, Bounds)>) {
        let Entry { placed, instance, made, .. } = entry;
        let id = self.primitives.len() as u32;
        let material = numbers[instance.material.0 as usize];
        let surfacing = &self.materials[material as usize];
        let mut space = Primitive::NO_SPACE;
        if surfacing.patterned {
            space = self.spaces.len() as u32;
            let detail = (surfacing.pictured || surfacing.bump.is_some()).then(|| {
                let back = made.world_from_object.inverse().unwrap_or(Affine::IDENTITY);
                MadeDetail {
                    made_normal_from_world: transposed(&made.world_from_object),
                    world_normal_from_made: transposed(&back),
                    from_centre: three!(i => (placed.made_from_local.shift[i] - made.centre[i]).round()),
                    half_height: made.half_height,
                }
            });
            self.spaces.push(MadeSpace { made_from_local: placed.made_from_local, rescale: placed.rescale, detail });
        }
        let maps = &mut self.maps;
        let frame = Frame::new(&placed.world_from_local, |m| {
            maps.push(m);
            maps.len() as u32 - 1
        });
        let kind = match placed.form {
            Form::Framed(kind) => kind,
            Form::Triangle(v, n, shading) => {
                self.triangles.push(TriangleData { v, n, shading });
                bounded.push((id, Bounds::of_points(v)));
                Kind::Triangle(self.triangles.len() as u32 - 1)
            }
        };
        match placed.extent {
            Some(extent) => bounded.push((id, world_bounds(extent, &placed.world_from_local))),
            None if matches!(kind, Kind::Plane) => {
                let n = frame.normal_to_world(&self.maps, [0.0, 1.0, 0.0]);
                let offset = (0..3).map(|i| n[i] * frame.centre[i]).sum();
                self.unbounded.push(Unbounded { id, n, offset });
            }
            None => {}
        }
        self.primitives.push(Primitive { kind, frame, material, space });
        self.origins.push((instance.node, instance.material));
    }

    fn find_touched_surfaces(&mut self) {
        let mut lights = std::mem::take(&mut self.lights);
        for light in &mut lights {
            let around = neighbourhood(light.at);
            let mut near: Vec<u32> = self.unbounded.iter().map(|p| p.id).collect();
            self.bvh.gather(
                |b| b.overlaps(&around),
                |id| {
                    near.push(id);
                    true
                },
            );
            near.retain(|&id| lies_on(&self.primitives[id as usize], self.tables(), light.at));
            light.touched = near.into();
        }
        self.lights = lights;
    }

    /// All surfaces, by number.
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

    /// The primitive that surface `id` belongs to.
    #[inline(always)]
    pub(super) fn primitive(&self, id: u32) -> &Primitive {
        &self.primitives[id as usize]
    }

    /// Calls `visit` for every crossing of lines with surface `id`; see [`Primitive::crossings`].
    #[inline(always)]
    pub(super) fn crossings<R: Real, const AT_EYE: bool>(
        &self,
        id: u32,
        (o, d): ([R; 3], [R; 3]),
        own: Option<Own<R>>,
        visit: &mut impl Visit<R>,
    ) {
        self.primitive(id).crossings::<R, AT_EYE>(self.tables(), o, d, own, visit);
    }

    /// Surface `id` where rays are at `t`, on `part`.
    #[inline(always)]
    pub(super) fn surface<R: Real, const AT_EYE: bool>(
        &self,
        id: u32,
        (o, d): ([R; 3], [R; 3]),
        (t, part): (R, R),
    ) -> Surface<R> {
        self.primitive(id).surface::<R, AT_EYE>(self.tables(), o, d, t, part)
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
        let fits = |p: &Primitive| match &p.kind {
            Kind::Sphere(r) => holds(*r),
            Kind::Plane => true,
            Kind::Disc { r, hole } => holds(*r) && holds(*hole),
            Kind::Cuboid(half) => half.iter().all(|h| holds(*h)),
            Kind::Tube(t) => [t.radius, t.bottom, t.top].into_iter().all(holds),
            Kind::Ring(ring) => holds(ring.tube / ring.scale),
            Kind::Triangle(i) => {
                let [a, b, c] = self.triangles[*i as usize].v;
                let edge = |p: [f64; 3], q: [f64; 3]| (0..3).map(|i| (p[i] - q[i]).abs()).fold(0.0, larger);
                holds(edge(a, b)) && holds(edge(a, c))
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
            + self.spaces.len() * size_of::<MadeSpace>()
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

/// The old world's tree, with what became of its primitives.
fn grafted(
    (old, old_keys): (&World, &[PrimitiveKey]),
    keys: &[PrimitiveKey],
    bounded: &[(u32, Bounds)],
) -> Option<Bvh> {
    let renumbered = same_geometry(old_keys, keys);
    let mut is_new = vec![true; keys.len()];
    renumbered.iter().filter(|&&id| id != u32::MAX).for_each(|&id| is_new[id as usize] = false);
    old.bvh.grafted(&renumbered, bounded.iter().filter(|b| is_new[b.0 as usize]).copied().collect())
}

/// Centre and half height of a shape in the space in which it is made; a plane's point and ½.
fn middle(shape: &crate::scene::Shape) -> ([Dd; 3], f64) {
    use crate::scene::Shape::*;
    let exactly = |p: &DVec3| p.to_array().map(Dd::new);
    let of_points = |points: &[DVec3]| {
        let (lo, hi) = points.iter().fold((points[0], points[0]), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
        // The middle of two numbers far out may lie between two numbers.
        let half = ((hi - lo) * 0.5).to_array();
        (three!(i => exactly(&lo)[i] + Dd::new(half[i])), half[1])
    };
    let (centre, half) = match shape {
        Sphere { at, r } => (exactly(at), *r),
        Plane { through, .. } => (exactly(through), 0.5),
        Box { from, to } => of_points(&[*from, *to]),
        Disc { at, r, .. } => (exactly(at), *r),
        Cylinder { from, to, .. } | Cone { from, to, .. } => of_points(&[*from, *to]),
        Torus { at, tube, .. } => (exactly(at), *tube),
        Triangle { points, .. } => of_points(&points[..]),
        Tetrahedron { points } => of_points(&points[..]),
    };
    (centre, if half > 0.0 { half } else { 0.5 })
}

/// The transposed linear part: normals go by the inverse transposed.
fn transposed(map: &Affine) -> [[f64; 3]; 3] {
    let m = map.linear_f64();
    std::array::from_fn(|r| std::array::from_fn(|c| m[c][r]))
}
