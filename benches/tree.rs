//! The tree alone: how long it takes to build, and how many rays a second find their nearest surface, on one thread, in a mesh
//! of a million triangles and among 10^3 to 10^6 balls. `cargo bench --bench tree` prints medians; `-- --write FOLDER` also
//! leaves mesh and rays there for `benches/peers/embree.cpp`, which measures the same rays in Embree. No thresholds; figures
//! of one run compare only with each other, for machines drift.

use rtdsl::math::best::{InLanes, in_widest_lanes, in_widest_lanes_of_f32};
use rtdsl::math::hash::KeyedHash;
use rtdsl::math::{Affine, Elem, Lane, Mask, Real};
use rtdsl::render::bounds::Bounds;
use rtdsl::render::bvh::{Bvh, Company, Leaves, Spread};
use rtdsl::render::frame::Frame;
use rtdsl::render::shape::primitive::Tables;
use rtdsl::render::shape::{self, Kind, Primitive, Visit};
use rtdsl::scene::MeshData;
use std::path::Path;
use std::sync::Arc;
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

/// What rays are traced through: a mesh, or balls.
struct Scene {
    mesh: Option<shape::Mesh>,
    balls: Vec<Primitive>,
    boxes: Vec<(u32, Bounds)>,
}

#[derive(Clone, Copy)]
struct Ray {
    o: [f64; 3],
    d: [f64; 3],
    t_max: f64,
}

fn shifted(by: [f64; 3]) -> Affine {
    let mut map = Affine::IDENTITY;
    map.shift = by.map(rtdsl::math::Dd::new);
    map
}

fn frame(at: [f64; 3]) -> Frame {
    Frame::new(&shifted(at), |_| 0)
}

impl Scene {
    fn of(mesh: &Mesh) -> Scene {
        let points = mesh.vertices.iter().map(|v| v.map(f64::from)).collect();
        let data = Arc::new(MeshData::new(points, mesh.faces.clone()));
        let placed = shape::Mesh::new(&data, false, &shifted(EYE.map(|x| -x)), (0, 0));
        let boxes = (0..placed.len() as u32).map(|k| (k, Bounds::of_points(placed.corners(k)))).collect();
        Scene { mesh: Some(placed), balls: Vec::new(), boxes }
    }

    /// `n` balls in a room of 40 × 6 × 40, as large as leaves the room as full for every `n`.
    fn balls(n: usize) -> Scene {
        let mut scene = Scene { mesh: None, balls: Vec::new(), boxes: Vec::new() };
        let size = rtdsl::math::fun::pow(1e5 / n as f64, 1.0 / 3.0);
        for i in 0..n as u64 {
            let at = [40.0 * random(i, 1) - 20.0, 6.0 * random(i, 2), 40.0 * random(i, 3) - 20.0];
            let at = [0, 1, 2].map(|c| at[c] - [0.0, 14.0, 40.0][c]);
            let r = (0.05 + 0.07 * random(i, 4)) * size;
            let kind = Kind::Sphere(r);
            scene.balls.push(Primitive { kind, frame: frame(at), material: 0, space: Primitive::NO_SPACE });
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
                let spread = Spread::of_one(ray.o, ray.d);
                let one = Nearest {
                    scene,
                    o: ray.o.map(L::One::splat),
                    d: ray.d.map(L::One::splat),
                    t: L::One::splat(ray.t_max),
                    id: L::One::splat(NONE),
                    current: L::One::zero(),
                };
                let mut search = Alone::<L> { scene, o: ray.o.map(L::splat), d: ray.d.map(L::splat), one };
                tree.walk::<L::Boxes>(&spread, L::UNIT_ROUNDOFF, ray.t_max, &mut search);
                hits += search.one.id.lt(L::One::splat(NONE)).any() as usize;
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
        let (o, d) = (self.o, self.d);
        match &self.scene.mesh {
            Some(mesh) => mesh.crossing(id, (o, d), None, self),
            None => self.scene.balls[id as usize].crossings::<L, false>(NO_TABLES, o, d, None, self),
        }
    }
}

const NO_TABLES: Tables<'static> = Tables { maps: &[], triangles: &[] };

impl<L: Lane> Visit<L> for Nearest<'_, L> {
    #[inline(always)]
    fn crossing(&mut self, t: L, _: L, valid: L::Mask) {
        let nearer = t.lt(self.t) | (t.same(self.t) & self.current.lt(self.id));
        let m = valid & L::zero().lt(t) & nearer;
        self.t = L::select(m, t, self.t);
        self.id = L::select(m, self.current, self.id);
    }
}

/// One ray on its way: as many triangles at once as a register holds, or one ball.
struct Alone<'s, L: Lane> {
    scene: &'s Scene,
    o: [L; 3],
    d: [L; 3],
    one: Nearest<'s, L::One>,
}

/// What a ray meets of triangles: each lane of its own.
struct Met<L: Lane> {
    t: L,
    valid: L::Mask,
}

impl<L: Lane> Visit<L> for Met<L> {
    #[inline(always)]
    fn crossing(&mut self, t: L, _: L, valid: L::Mask) {
        (self.t, self.valid) = (t, valid);
    }
}

impl<L: Lane> Leaves for Alone<'_, L> {
    #[inline(always)]
    fn test(&mut self, ids: &[u32]) -> f64 {
        let Some(mesh) = &self.scene.mesh else {
            for id in ids {
                self.one.test_one(*id);
            }
            return self.t();
        };
        for ids in ids.chunks(L::WIDTH) {
            let mut met = Met { t: L::zero(), valid: L::Mask::splat(false) };
            let from_nowhere = (L::splat(-1.0), L::zero(), L::zero());
            mesh.crossings_of_one(ids, (self.o, self.d), from_nowhere, &mut met);
            let mut rest = (met.valid & L::zero().lt(met.t) & met.t.le(L::splat(self.t()))).bits();
            let mut t = [L::Elem::default(); 16];
            met.t.store(&mut t);
            while rest != 0 {
                let i = rest.trailing_zeros() as usize;
                rest &= rest - 1;
                if let Some(&id) = ids.get(i) {
                    self.one.current = L::One::splat(id as f64);
                    self.one.crossing(L::One::splat(t[i].to_f64()), L::One::zero(), Mask::splat(true));
                }
            }
        }
        self.t()
    }
}

impl<L: Lane> Alone<'_, L> {
    #[inline(always)]
    fn t(&self) -> f64 {
        let mut t = [L::Elem::default(); 16];
        self.one.t.store(&mut t);
        t[0].to_f64()
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
    let ways = [
        ("f64, alone", false, false),
        ("f64, a register at a time", true, false),
        ("f32, alone", false, true),
        ("f32, a register at a time", true, true),
    ];
    for (how, together, short) in ways {
        let trace = || Trace { scene, tree, rays, together };
        let (seconds, hits) = match short {
            true => timed(ROUNDS, || in_widest_lanes_of_f32(trace())),
            false => timed(ROUNDS, || in_widest_lanes(trace())),
        };
        let (rate, per) = (rays.len() as f64 / seconds / 1e6, seconds / rays.len() as f64 * 1e9);
        let share = 100.0 * hits as f64 / rays.len() as f64;
        println!("  {what:<14} {how:<26} {rate:7.2} M rays/s ({per:.0} ns a ray, {share:.1} % hit)");
    }
}

/// Builds the tree with one thread and with two.
fn build(what: &str, boxes: &[(u32, Bounds)], company: Company) -> Bvh {
    let never = std::sync::atomic::AtomicBool::new(false);
    let mut tree = Bvh::default();
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let mut seconds = Vec::new();
        for _ in 0..5 {
            let boxes = boxes.to_vec();
            let start = Instant::now();
            tree = pool.install(|| Bvh::build_unless(boxes, |_| company, &never)).unwrap_or_default();
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
    let tree = build(&format!("mesh of {} triangles", mesh.faces.len()), &scene.boxes, Company::Triangles);
    rate("camera rays", &scene, &tree, &all);
    rate("random rays", &scene, &tree, &lots);
}

fn balls() {
    for n in [1_000, 10_000, 100_000, 1_000_000] {
        let scene = Scene::balls(n);
        let tree = build(&format!("{n} balls"), &scene.boxes, Company::Balls);
        rate("camera rays", &scene, &tree, &camera_rays([0.0, 12.0, 40.0], 0.25));
    }
}

fn main() {
    mesh();
    balls();
}
