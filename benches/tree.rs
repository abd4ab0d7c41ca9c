//! The tree alone: how long it takes to build, and how many rays a second find their nearest surface, on one thread, in a mesh
//! of a million triangles and among 10^3 to 10^6 balls. `cargo bench --bench tree` prints medians; `-- --write FOLDER` also
//! leaves mesh and rays there for `benches/peers/embree.cpp`, which measures the same rays in Embree. No thresholds; figures
//! of one run compare only with each other, for machines drift.

use rtdsl::math::best::{InLanes, in_widest_lanes};
use rtdsl::math::hash::KeyedHash;
use rtdsl::math::{Affine, Elem, Lane, Mask, Real};
use rtdsl::render::bounds::Bounds;
use rtdsl::render::bvh::{Bvh, Leaves, Spread};
use rtdsl::render::frame::Frame;
use rtdsl::render::shape::primitive::Tables;
use rtdsl::render::shape::{Kind, Primitive, TriangleData, Visit};
use std::path::Path;
use std::time::Instant;

/// Cells along an edge of the cube that the mesh is made of: 6·2·289² triangles.
const CELLS: usize = 289;
/// Where the mesh is seen from, towards its middle.
const EYE: [f64; 3] = [0.0, 5.0, 14.0];
const SIZE: [usize; 2] = [1280, 720];
const ROUNDS: usize = 7;

fn random(i: u64, k: u64) -> f64 {
    KeyedHash::new().with(i).with(k).unit()
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let len = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    v.map(|x| x / len)
}

fn direction(i: u64) -> [f64; 3] {
    let (z, p) = (2.0 * random(i, 0) - 1.0, 360.0 * random(i, 1));
    let e = (1.0 - z * z).sqrt();
    [e * rtdsl::math::fun::cos_deg(p), e * rtdsl::math::fun::sin_deg(p), z]
}

/// A ball of radius 3 on which seven octaves of waves lie.
struct Mesh {
    vertices: Vec<[f32; 3]>,
    faces: Vec<[u32; 3]>,
}

impl Mesh {
    fn new() -> Mesh {
        let n = CELLS as u32;
        let t = |i: u32| rtdsl::math::fun::tan_deg((2.0 * i as f64 / n as f64 - 1.0) * 45.0);
        let waves: Vec<([f64; 3], f64, f64)> = (0..56)
            .map(|k| {
                let octave = (1 << (k / 8)) as f64;
                (direction(1000 + k).map(|x| x * 2.2 * octave), 360.0 * random(k, 9), 1.0 / octave)
            })
            .collect();
        let (mut vertices, mut faces) = (Vec::new(), Vec::new());
        for side in 0..6 {
            let first = vertices.len() as u32;
            for i in 0..=n {
                for j in 0..=n {
                    let (u, v) = (t(i), t(j));
                    let cube = [[u, v, 1.0], [v, u, -1.0], [1.0, u, v], [-1.0, v, u], [v, 1.0, u], [u, -1.0, v]];
                    let p = unit(cube[side]);
                    let wave = |(w, phase, size): &([f64; 3], f64, f64)| {
                        let along = (p[0] * w[0] + p[1] * w[1] + p[2] * w[2]).to_degrees() + phase;
                        size * rtdsl::math::fun::sin_deg(along)
                    };
                    let r = 3.0 + 0.22 * waves.iter().map(wave).sum::<f64>();
                    vertices.push(p.map(|x| (x * r) as f32));
                }
            }
            let at = |i: u32, j: u32| first + i * (n + 1) + j;
            for i in 0..n {
                for j in 0..n {
                    let q = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                    faces.extend([[q[0], q[1], q[2]], [q[0], q[2], q[3]]]);
                }
            }
        }
        Mesh { vertices, faces }
    }
}

/// What rays are traced through.
struct Scene {
    primitives: Vec<Primitive>,
    triangles: Vec<TriangleData>,
    boxes: Vec<(u32, Bounds)>,
}

#[derive(Clone, Copy)]
struct Ray {
    o: [f64; 3],
    d: [f64; 3],
    t_max: f64,
}

fn frame(at: [f64; 3]) -> Frame {
    let mut map = Affine::IDENTITY;
    for (to, x) in map.shift.iter_mut().zip(at) {
        *to = rtdsl::math::Dd::new(x);
    }
    Frame::new(&map, |_| 0)
}

impl Scene {
    fn of(mesh: &Mesh) -> Scene {
        let mut scene = Scene { primitives: Vec::new(), triangles: Vec::new(), boxes: Vec::new() };
        for (face, i) in mesh.faces.iter().zip(0..) {
            let v = face.map(|k| {
                let p = mesh.vertices[k as usize];
                [0, 1, 2].map(|c| p[c] as f64 - EYE[c])
            });
            scene.triangles.push(TriangleData { v, n: [0.0, 0.0, 1.0], shading: None });
            let kind = Kind::Triangle(i);
            scene.primitives.push(Primitive { kind, frame: frame([0.0; 3]), material: 0, space: Primitive::NO_SPACE });
            scene.boxes.push((i, Bounds::of_points(v)));
        }
        scene
    }

    /// `n` balls in a room of 40 × 6 × 40, as large as leaves the room as full for every `n`.
    fn balls(n: usize) -> Scene {
        let mut scene = Scene { primitives: Vec::new(), triangles: Vec::new(), boxes: Vec::new() };
        let size = rtdsl::math::fun::pow(1e5 / n as f64, 1.0 / 3.0);
        for i in 0..n as u64 {
            let at = [40.0 * random(i, 1) - 20.0, 6.0 * random(i, 2), 40.0 * random(i, 3) - 20.0];
            let at = [0, 1, 2].map(|c| at[c] - [0.0, 14.0, 40.0][c]);
            let r = (0.05 + 0.07 * random(i, 4)) * size;
            let kind = Kind::Sphere(r);
            scene.primitives.push(Primitive { kind, frame: frame(at), material: 0, space: Primitive::NO_SPACE });
            scene.boxes.push((i as u32, Bounds::around(at, [r; 3])));
        }
        scene
    }
}

/// Finds what rays meet first; gives how many meet anything. `together`: as many rays at a time as a register holds.
struct Trace<'s> {
    scene: &'s Scene,
    tree: &'s Bvh,
    rays: &'s [Ray],
    together: bool,
}

impl InLanes for Trace<'_> {
    type Out = usize;
    #[inline(always)]
    fn run<L: Lane>(self) -> usize {
        let Trace { scene, tree, rays, together } = self;
        let mut hits = 0;
        if !together {
            for ray in rays {
                let mut nearest = Nearest { scene, o: ray.o, d: ray.d, t: ray.t_max, id: NONE, current: 0.0 };
                let spread = Spread::of_one(ray.o, ray.d);
                tree.walk::<L::Boxes>(&spread, <f64 as Real>::UNIT_ROUNDOFF, ray.t_max, &mut nearest);
                hits += (nearest.id != NONE) as usize;
            }
            return hits;
        }
        for rays in rays.chunks_exact(L::WIDTH) {
            let mut columns = [[L::Elem::default(); 16]; 7];
            for (k, ray) in rays.iter().enumerate() {
                for c in 0..3 {
                    columns[c][k] = L::Elem::from_f64(ray.o[c]);
                    columns[3 + c][k] = L::Elem::from_f64(ray.d[c]);
                }
                columns[6][k] = L::Elem::from_f64(ray.t_max);
            }
            let o = [L::load(&columns[0]), L::load(&columns[1]), L::load(&columns[2])];
            let d = [L::load(&columns[3]), L::load(&columns[4]), L::load(&columns[5])];
            let t = L::load(&columns[6]);
            let mut nearest = Nearest { scene, o, d, t, id: L::splat(NONE), current: L::zero() };
            tree.traverse(
                o,
                d,
                t,
                #[inline(always)]
                |id| {
                    nearest.test_one(id);
                    nearest.t
                },
            );
            hits += nearest.id.lt(L::splat(NONE)).bits().count_ones() as usize;
        }
        hits
    }
}

/// More than any number of a primitive.
const NONE: f64 = 4e9;

/// Keeps the nearest crossing.
struct Nearest<'s, L> {
    scene: &'s Scene,
    o: [L; 3],
    d: [L; 3],
    t: L,
    id: L,
    current: L,
}

impl<L: Lane> Nearest<'_, L> {
    #[inline(always)]
    fn test_one(&mut self, id: u32) {
        self.current = L::splat(id as f64);
        let tables = Tables { maps: &[], triangles: &self.scene.triangles };
        let (o, d) = (self.o, self.d);
        self.scene.primitives[id as usize].crossings::<L, false>(tables, o, d, None, self);
    }
}

impl<L: Lane> Visit<L> for Nearest<'_, L> {
    #[inline(always)]
    fn crossing(&mut self, t: L, _: L, valid: L::Mask) {
        let nearer = t.lt(self.t) | (t.same(self.t) & self.current.lt(self.id));
        let m = valid & L::zero().lt(t) & nearer;
        self.t = L::select(m, t, self.t);
        self.id = L::select(m, self.current, self.id);
    }
}

impl Leaves for Nearest<'_, f64> {
    #[inline(always)]
    fn test(&mut self, ids: &[u32]) -> f64 {
        for id in ids {
            self.test_one(*id);
        }
        self.t
    }
}

/// Rays from the eye, in tiles of 4 × 4 pixels.
fn camera_rays(from: [f64; 3], zoom: f64) -> Vec<Ray> {
    let w = unit(from.map(|x| -x));
    let (u, v) = ([1.0, 0.0, 0.0], [0.0, -w[2], w[1]]);
    let mut rays = Vec::new();
    for (y, x) in (0..SIZE[1] / 4).flat_map(|y| (0..SIZE[0] / 4).map(move |x| (4 * y, 4 * x))) {
        for k in 0..16 {
            let (px, py) = ((x + k % 4) as f64 + 0.5, (y + k / 4) as f64 + 0.5);
            let sx = (2.0 * px / SIZE[0] as f64 - 1.0) * zoom * 16.0 / 9.0;
            let sy = (1.0 - 2.0 * py / SIZE[1] as f64) * zoom;
            let d = unit([0, 1, 2].map(|i| w[i] + sx * u[i] + sy * v[i]));
            rays.push(Ray { o: [0.0; 3], d, t_max: f64::INFINITY });
        }
    }
    rays
}

fn median(mut seconds: Vec<f64>) -> f64 {
    seconds.sort_by(f64::total_cmp);
    seconds[seconds.len() / 2]
}

fn timed<T>(rounds: usize, mut f: impl FnMut() -> T) -> (f64, T) {
    let mut last = None;
    let seconds = (0..rounds).map(|_| {
        let start = Instant::now();
        last = Some(f());
        start.elapsed().as_secs_f64()
    });
    let seconds = median(seconds.collect());
    (seconds, last.expect("at least one round"))
}

fn rate(what: &str, scene: &Scene, tree: &Bvh, rays: &[Ray]) {
    for (how, together) in [("alone", false), ("a register at a time", true)] {
        let (seconds, hits) = timed(ROUNDS, || in_widest_lanes(Trace { scene, tree, rays, together }));
        let (rate, per) = (rays.len() as f64 / seconds / 1e6, seconds / rays.len() as f64 * 1e9);
        let share = 100.0 * hits as f64 / rays.len() as f64;
        println!("  {what:<22} {how:<22} {rate:7.2} M rays/s ({per:.0} ns a ray, {share:.1} % hit)");
    }
}

/// Builds the tree with one thread and with two. All primitives from `batched_from` on may share leaves.
fn build(what: &str, boxes: &[(u32, Bounds)], batched_from: u32) -> Bvh {
    let never = std::sync::atomic::AtomicBool::new(false);
    let mut tree = Bvh::default();
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let mut seconds = Vec::new();
        for _ in 0..5 {
            let boxes = boxes.to_vec();
            let start = Instant::now();
            tree = pool.install(|| Bvh::build_unless(boxes, batched_from, &never)).unwrap_or_default();
            seconds.push(start.elapsed().as_secs_f64());
        }
        println!("{what}: {:.1} ms to build, {threads} threads", median(seconds) * 1e3);
    }
    println!("  {:.1} MB", tree.memory_bytes() as f64 / 1e6);
    tree
}

fn mesh() {
    let mesh = Mesh::new();
    let scene = Scene::of(&mesh);
    if let Some(folder) = std::env::args().skip_while(|a| a != "--write").nth(1) {
        let write = |name: &str, bytes: Vec<u8>| std::fs::write(Path::new(&folder).join(name), bytes).expect("written");
        write("mesh.v.f32", mesh.vertices.iter().flatten().flat_map(|x| x.to_le_bytes()).collect());
        write("mesh.f.u32", mesh.faces.iter().flatten().flat_map(|x| x.to_le_bytes()).collect());
    }
    let all = camera_rays(EYE, 0.25);
    let room = scene.boxes.iter().fold(Bounds::EMPTY, |b, x| b.union(x.1));
    let lots: Vec<Ray> = (0..1 << 20)
        .map(|i| Ray {
            o: [0, 1, 2].map(|c| room.lo[c] + (room.hi[c] - room.lo[c]) * random(i, 10 + c as u64)),
            d: direction((1 << 32) + i),
            t_max: f64::INFINITY,
        })
        .collect();
    let tree = build(&format!("mesh of {} triangles", mesh.faces.len()), &scene.boxes, 0);
    rate("camera rays", &scene, &tree, &all);
    rate("random rays", &scene, &tree, &lots);
}

fn balls() {
    for n in [1_000, 10_000, 100_000, 1_000_000] {
        let scene = Scene::balls(n);
        let tree = build(&format!("{n} balls"), &scene.boxes, u32::MAX);
        rate("camera rays", &scene, &tree, &camera_rays([0.0, 12.0, 40.0], 0.25));
    }
}

fn main() {
    mesh();
    balls();
}
