//! Whether the tree finds what testing every surface finds: the same t, to the bit, and the same surface.

use super::batch::{HitColumns, MOST, NONE, RayBatch};
use super::bounds::{Bounds, larger};
use super::candidates::Candidates;
use super::frame::Axes;
use super::nearest::nearest;
use super::shape::Kind;
use super::way::Way;
use super::world::World;
use crate::math::hash::KeyedHash;
use crate::math::real::three;

/// What the tree and a search through everything found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Search {
    /// Rays sent.
    pub rays: u64,
    /// Rays that met something.
    pub hits: u64,
    /// Rays of which t or the surface differ.
    pub differing: u64,
    /// The first of those: origin, relative to the camera, and direction.
    pub first: Option<([f64; 3], [f64; 3])>,
}

impl Search {
    /// Sends rays, drawn by lot from `lot`, into the world: from the camera's place and from anywhere around the surfaces, aimed
    /// into their boxes, at the boxes' faces, edges and corners, and along the axes.
    pub fn through(world: &World, rays: u64, lot: u64) -> Search {
        let planes: Vec<u32> = world.unbounded.iter().map(|p| p.id).collect();
        let by_tree = Candidates { ids: planes, tree: true, vain: 0 };
        let by_list = Candidates { ids: (0..world.surface_count()).collect(), tree: false, vain: 0 };
        // Their own, for the tree's are a little wider: a ray is to run along the very face.
        let boxes: Vec<Bounds> = world.bvh.leaves().map(|(id, b)| box_of(world, id).unwrap_or(b)).collect();
        let mut search = Search::default();
        let (mut batch, mut found) = (RayBatch::<f64>::default(), [HitColumns::default(), HitColumns::default()]);
        while search.rays < rays {
            batch.len = (rays - search.rays).min(MOST as u64) as usize;
            for i in 0..batch.len {
                let (o, d) = ray(&boxes, KeyedHash::new().with(lot).with(search.rays + i as u64));
                for c in 0..3 {
                    (batch.o[c][i], batch.d[c][i]) = (o[c], d[c]);
                }
                batch.source[i] = NONE;
            }
            nearest::<f64, false>(world, &by_tree, &batch, &mut found[0], &mut Way::default());
            nearest::<f64, false>(world, &by_list, &batch, &mut found[1], &mut Way::default());
            let what =
                |hits: &HitColumns<f64>, i: usize| (hits.t[i].to_bits(), hits.id[i].to_bits(), hits.part[i].to_bits());
            for i in 0..batch.len {
                search.hits += (found[1].id[i] != NONE) as u64;
                if what(&found[0], i) != what(&found[1], i) {
                    search.differing += 1;
                    search.first = search.first.or(Some((three!(c => batch.o[c][i]), three!(c => batch.d[c][i]))));
                }
            }
            search.rays += batch.len as u64;
        }
        search
    }
}

/// Rays run along an axis plane, or at a larger angle than this to it: 2^-40, thousands of roundings.
const LEAST_ANGLE: f64 = 1.0 / (1u64 << 40) as f64;

/// Origin and direction.
fn ray(boxes: &[Bounds], key: KeyedHash) -> ([f64; 3], [f64; 3]) {
    let unit = |k: u64| key.with(k).unit();
    let pick = |k: u64| boxes.get((unit(k) * boxes.len() as f64) as usize).copied().unwrap_or(ANYWHERE);
    // A coordinate between the faces of the box, on one of them, or beyond them by up to its size.
    let within = |b: Bounds, k: u64, spread: f64| {
        three!(i => {
            let s = match (unit(k + i as u64) * 4.0) as u32 {
                0 => 0.0,
                1 => 1.0,
                _ => (unit(k + 3 + i as u64) - 0.5) * spread + 0.5,
            };
            if s == 1.0 { b.hi[i] } else { b.lo[i] + s * (b.hi[i] - b.lo[i]) }
        })
    };
    let o = if unit(1) < 0.25 { [0.0; 3] } else { within(pick(2), 10, 3.0) };
    let target = within(pick(3), 20, 1.0);
    let mut d = three!(i => target[i] - o[i]);
    if unit(4) < 0.1 {
        d[(unit(5) * 3.0) as usize] = 0.0;
    }
    // From a face to the same face it runs along it exactly. At an angle of a few roundings which of two faces comes first is for
    // rounding to say, and a kernel may say otherwise than the box around it does.
    let longest = d.iter().map(|x| x.abs()).fold(0.0, larger);
    let d = d.map(|x| if x.abs() < LEAST_ANGLE * longest { 0.0 } else { x });
    (o, if d == [0.0; 3] { [0.0, 0.0, -1.0] } else { d })
}

/// The box of a shape whose frame has the world's axes, or of a triangle.
fn box_of(world: &World, id: u32) -> Option<Bounds> {
    let primitive = world.primitives.get(id as usize)?;
    let r = |r: f64| Some([[0.0; 3], [r; 3]]);
    let extent = match &primitive.kind {
        Kind::Sphere(radius) => r(*radius),
        Kind::Disc { r, .. } => Some([[0.0; 3], [*r, 0.0, *r]]),
        Kind::Cuboid(half) => Some([[0.0; 3], *half]),
        Kind::Tube(t) => {
            let widest = larger(t.radius + t.slope * t.bottom, t.radius + t.slope * t.top);
            Some([[0.0, 0.5 * (t.bottom + t.top), 0.0], [widest, 0.5 * (t.top - t.bottom), widest]])
        }
        Kind::Ring(ring) => {
            let (far, tube) = ((ring.r + ring.tube) / ring.scale, ring.tube / ring.scale);
            Some([[0.0; 3], [far, tube, far]])
        }
        Kind::Triangle(i) => return Some(Bounds::of_points(world.triangles.get(*i as usize)?.v)),
        Kind::Plane | Kind::Mesh(_) => None,
    };
    let ([centre, half], Axes::Cyclic(_)) = (extent?, primitive.frame.axes) else { return None };
    let place = |v: [f64; 3]| primitive.frame.vector_to_world(&world.maps, v);
    let (c, half) = (place(centre), place(half));
    Some(Bounds::around(three!(i => c[i] + primitive.frame.centre[i]), half))
}

/// For a world without bounded surfaces.
const ANYWHERE: Bounds = Bounds { lo: [-1.0; 3], hi: [1.0; 3] };
