//! Makes a world of a scene: finds every shape's place, numbers the shapes by their content, and lays them out for tracing.
//!
//! Shapes are placed twice: once for what they are numbered by, and again, in the order of their numbers, for good. What a
//! shape's place is made of is far larger than what is kept of it, and placing is quicker than moving that through memory.

use super::ball::ball_radius;
use super::bounds::Bounds;
use super::bvh::Bvh;
use super::camera::CameraFrame;
use super::census::PrimitiveKey;
use super::confine::is_extreme;
use super::digest::{LengthKey, MaterialDigest, material_digests};
use super::frame::{Axes, Frame, LinearMap};
use super::laid_out::LaidOut;
use super::material::MaterialCompiler;
use super::pattern::PatternTable;
use super::place::{Form, Placed, parts, world_bounds};
use super::shape::{Kind, Mesh, Primitive, TriangleData};
use super::standing::{Part, Standing, made, made_space};
use super::world::{MadeSpace, Owners, Unbounded, World};
use crate::math::Affine;
use crate::scene::{Camera, MaterialId, MeshId, NodeId, NodeKind, Scene};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Shapes that a thread takes at once: a fraction of a millisecond. Fewer aren't worth waking another thread for.
const AT_ONCE: usize = 1 << 11;
/// Pieces of that size that are laid out before they are put together: what is kept twice meanwhile stays small.
const PIECES: usize = 8;

/// What a world knows of a stretch of its primitives. Numbers of maps, triangles and spaces count from its own first.
#[derive(Default)]
struct Piece {
    primitives: Vec<Primitive>,
    origins: Vec<(NodeId, MaterialId)>,
    maps: Vec<LinearMap>,
    triangles: Vec<TriangleData>,
    spaces: Vec<MadeSpace>,
    unbounded: Vec<Unbounded>,
    extremes: Vec<(u32, Bounds)>,
    bounded: Vec<(u32, Bounds)>,
    meshes: Vec<(u32, MeshId, bool, Affine)>,
}

impl World {
    /// Prepares `scene` as seen by `camera`.
    pub fn build(scene: &Scene, camera: &Camera) -> World {
        grown(World::lay_out(scene, camera, false, &NEVER))
    }

    /// As [`build`](World::build), for those who need the scene's shapes for nothing else: they are let go of as soon as they have
    /// their places, for they take as much memory as the world does.
    pub fn build_of(scene: &mut Scene, camera: &Camera) -> World {
        let laid_out = World::lay_out(scene, camera, false, &NEVER);
        (scene.nodes, scene.roots) = (Vec::new(), Vec::new());
        grown(laid_out)
    }

    /// Prepares `scene` as seen by `camera`, and says what each primitive is known by; `None` where `cancel` was set
    /// meanwhile. The tree of the world `before`, with its keys, goes on living where little changed.
    pub(super) fn build_keyed(
        scene: &Scene,
        camera: &Camera,
        before: Option<(&World, &[PrimitiveKey])>,
        cancel: &AtomicBool,
    ) -> Option<(World, Vec<PrimitiveKey>)> {
        World::lay_out(scene, camera, true, cancel)?.grow(before, cancel)
    }

    /// All but the tree and what is found by it. The keys are none unless they are `wanted`.
    fn lay_out(scene: &Scene, camera: &Camera, wanted: bool, cancel: &AtomicBool) -> Option<LaidOut> {
        let (standing, lights) = Standing::visit(scene, camera, cancel)?;
        let mut world = World {
            primitives: Vec::new(),
            origins: Vec::new(),
            maps: Vec::new(),
            triangles: Vec::new(),
            meshes: Vec::new(),
            owners: Owners::default(),
            spaces: Vec::new(),
            unbounded: Vec::new(),
            extremes: Vec::new(),
            flocks: Vec::new(),
            balls: Vec::new(),
            has_rings: false,
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
        let numbers = world.compile_materials(&standing, &digests);
        let (order, keys) = world.in_order(&standing, &digests, &numbers, wanted, cancel)?;
        let bounded = world.fill(&standing, &order, &numbers, cancel)?;
        Some(LaidOut { world, keys, bounded })
    }

    /// Compiles the materials that shapes wear; gives each scene material its number here. They are compiled in the order of
    /// their content: which patterns get a space of their own, where there are too many, isn't left to the text.
    fn compile_materials(&mut self, standing: &Standing<'_>, digests: &[MaterialDigest]) -> Vec<u32> {
        let scene = standing.scene;
        let mut worn: Vec<usize> = Vec::new();
        let mut numbers = vec![u32::MAX; scene.materials.len()];
        for (_, material, _) in &standing.shapes {
            let number = &mut numbers[material.0 as usize];
            if *number == u32::MAX {
                *number = 0;
                worn.push(material.0 as usize);
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

    /// All parts of all shapes in the order of their keys, and the keys, where they are `wanted`.
    fn in_order(
        &self,
        standing: &Standing<'_>,
        digests: &[MaterialDigest],
        numbers: &[u32],
        wanted: bool,
        cancel: &AtomicBool,
    ) -> Option<(Vec<Part>, Vec<PrimitiveKey>)> {
        let mut all = Vec::with_capacity(standing.shapes.len());
        for ((node, ..), shape) in standing.shapes.iter().zip(0..) {
            if let NodeKind::Shape(kind) = &standing.scene.node(*node).kind {
                all.extend((0..parts(kind) as u8).map(|part| Part { shape, part }));
            }
        }
        let mut keys = vec![PrimitiveKey::default(); all.len()];
        let find = |(parts, keys): (&[Part], &mut [PrimitiveKey])| {
            if cancel.load(Relaxed) {
                return;
            }
            for (part, key) in parts.iter().zip(keys) {
                let Some((placed, shape, around)) = standing.part(*part) else { continue };
                let material = standing.shapes[part.shape as usize].1.0 as usize;
                let look = (digests[material], &self.materials[numbers[material] as usize]);
                let made = || made(standing.scene, shape, around);
                *key = PrimitiveKey::new(&placed, made, look, &standing.scene.meshes);
            }
        };
        let few = all.len() <= AT_ONCE;
        match few {
            true => find((&all, &mut keys)),
            false => all.par_chunks(AT_ONCE).zip(keys.par_chunks_mut(AT_ONCE)).for_each(find),
        }
        // Keys are large: short beginnings of them are sorted, and where those are equal the rest decides.
        let beginning = |(clear, length): (bool, LengthKey)| (clear as u64) << 63 | length.content >> 1;
        let mut order: Vec<(u64, u32)> = keys.iter().map(|k| beginning(k.geometry)).zip(0..).collect();
        let by_key = |a: &(u64, u32), b: &(u64, u32)| {
            a.0.cmp(&b.0).then_with(|| keys[a.1 as usize].cmp(&keys[b.1 as usize])).then(a.1.cmp(&b.1))
        };
        match few {
            true => order.sort_unstable_by(by_key),
            false => order.par_sort_unstable_by(by_key),
        }
        if cancel.load(Relaxed) {
            return None;
        }
        let keys = if wanted { order.iter().map(|o| keys[o.1 as usize]).collect() } else { Vec::new() };
        Some((order.into_iter().map(|o| all[o.1 as usize]).collect(), keys))
    }

    /// Fills the tables; gives the boxes of what has bounds and is no ball.
    fn fill(
        &mut self,
        standing: &Standing<'_>,
        order: &[Part],
        numbers: &[u32],
        cancel: &AtomicBool,
    ) -> Option<Vec<(u32, Bounds)>> {
        self.primitives.reserve_exact(order.len());
        self.origins.reserve_exact(order.len());
        let mut bounded = Vec::new();
        let mut meshes = Vec::new();
        for stretch in order.chunks(AT_ONCE * PIECES) {
            if cancel.load(Relaxed) {
                return None;
            }
            let first = self.primitives.len() as u32;
            let piece = |(i, parts): (usize, &[Part])| {
                Piece::new(self, standing, (parts, first + (i * AT_ONCE) as u32), numbers)
            };
            let pieces: Vec<Piece> = match stretch.len() <= AT_ONCE {
                true => vec![piece((0, stretch))],
                false => stretch.par_chunks(AT_ONCE).enumerate().map(piece).collect(),
            };
            pieces.into_iter().for_each(|p| self.append(p, &mut bounded, &mut meshes));
        }
        self.add_meshes(standing.scene, meshes, &mut bounded);
        Some(bounded)
    }

    fn append(
        &mut self,
        piece: Piece,
        bounded: &mut Vec<(u32, Bounds)>,
        meshes: &mut Vec<(u32, MeshId, bool, Affine)>,
    ) {
        let (maps, triangles) = (self.maps.len() as u32, self.triangles.len() as u32);
        let (spaces, before) = (self.spaces.len() as u32, meshes.len() as u32);
        self.primitives.extend(piece.primitives.into_iter().map(|mut p| {
            if let Axes::Linear(map) = &mut p.frame.axes {
                *map += maps;
            }
            match &mut p.kind {
                Kind::Triangle(i) => *i += triangles,
                Kind::Mesh(i) => *i += before,
                _ => {}
            }
            if p.space != Primitive::NO_SPACE {
                p.space += spaces;
            }
            p
        }));
        self.origins.extend(piece.origins);
        self.maps.extend(piece.maps);
        self.triangles.extend(piece.triangles);
        self.spaces.extend(piece.spaces);
        self.unbounded.extend(piece.unbounded);
        self.extremes.extend(piece.extremes);
        bounded.extend(piece.bounded);
        meshes.extend(piece.meshes);
    }

    /// Adds the triangles of meshes, with numbers after those of all primitives.
    fn add_meshes(
        &mut self,
        scene: &Scene,
        meshes: Vec<(u32, MeshId, bool, Affine)>,
        bounded: &mut Vec<(u32, Bounds)>,
    ) {
        self.owners.primitives = self.primitives.len() as u32;
        let mut first = self.owners.primitives;
        for (owner, id, smooth, world_from_object) in meshes {
            let mesh = Mesh::new(&scene.mesh(id).data, smooth, &world_from_object, (first, owner));
            self.owners.meshes.push((first, owner));
            let triangles = (0..mesh.len() as u32).into_par_iter().with_min_len(AT_ONCE);
            bounded.par_extend(triangles.map(|k| (first + k, Bounds::of_points(mesh.corners(k)))));
            first += mesh.len() as u32;
            self.meshes.push(mesh);
        }
    }
}

/// For what nothing cancels.
static NEVER: AtomicBool = AtomicBool::new(false);

/// The world that nothing has cancelled.
fn grown(laid_out: Option<LaidOut>) -> World {
    match laid_out.and_then(|laid_out| laid_out.grow(None, &NEVER)) {
        Some((world, _)) => world,
        None => unreachable!("nothing cancels it"),
    }
}

impl Piece {
    /// Lays out `parts`, of which the first has the number `first`.
    fn new(world: &World, standing: &Standing<'_>, (parts, first): (&[Part], u32), numbers: &[u32]) -> Piece {
        let mut piece = Piece {
            primitives: Vec::with_capacity(parts.len()),
            origins: Vec::with_capacity(parts.len()),
            ..Piece::default()
        };
        for (part, id) in parts.iter().zip(first..) {
            let (node, material, _) = standing.shapes[part.shape as usize];
            let Some((placed, shape, around)) = standing.part(*part) else { continue };
            let number = numbers[material.0 as usize];
            let surfacing = &world.materials[number as usize];
            let mut space = Primitive::NO_SPACE;
            if surfacing.patterned {
                space = piece.spaces.len() as u32;
                let detailed = surfacing.pictured || surfacing.bump.is_some();
                piece.spaces.push(made_space(&placed, &made(standing.scene, shape, around), detailed));
            }
            piece.add(id, placed, number, space);
            piece.origins.push((node, material));
        }
        piece
    }

    fn add(&mut self, id: u32, placed: Placed, material: u32, space: u32) {
        let maps = &mut self.maps;
        let frame = Frame::new(&placed.world_from_local, |m| {
            maps.push(m);
            maps.len() as u32 - 1
        });
        let kind = match placed.form {
            Form::Framed(kind) => kind,
            Form::Triangle(v, n, shading) => {
                self.triangles.push(TriangleData { v, n, shading });
                self.bounded.push((id, Bounds::of_points(v)));
                Kind::Triangle(self.triangles.len() as u32 - 1)
            }
            Form::Mesh(mesh, smooth) => {
                self.meshes.push((id, mesh, smooth, placed.world_from_local));
                Kind::Mesh(self.meshes.len() as u32 - 1)
            }
        };
        match placed.extent {
            Some(extent) => {
                let bounds = world_bounds(extent, &placed.world_from_local);
                if is_extreme(extent[1], &placed.world_from_local) {
                    self.extremes.push((id, bounds));
                }
                if ball_radius(&kind, &frame).is_none() {
                    self.bounded.push((id, bounds));
                }
            }
            None if matches!(kind, Kind::Plane) => {
                let n = frame.normal_to_world(&self.maps, [0.0, 1.0, 0.0]);
                // As rays find it: of a plane that passes by here, but is said to go through somewhere far away, the coordinates
                // cancel.
                let from_here = frame.localize::<f64, true>(&self.maps, [0.0; 3], n);
                let offset = -(from_here.o[1] + from_here.o_lo[1]) / from_here.d[1];
                self.unbounded.push(Unbounded { id, n, offset });
            }
            None => {}
        }
        self.primitives.push(Primitive { kind, frame, material, space });
    }
}
