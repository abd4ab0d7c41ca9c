//! What one pixel sees, in words of the scene: for `rtdsl explain`.

use super::batch::{HitColumns, NONE, RayBatch};
use super::candidates::Candidates;
use super::footprint::Recorder;
use super::light::occlusion;
use super::material::Slot;
use super::nearest::nearest;
use super::options::{Options, Probe};
use super::shadow_rays::{Shadow, ShadowRays};
use super::shape::primitive::spawn_point;
use super::surface_pattern::PatternFrame;
use super::way::Way;
use super::world::{PointLight, World};
use crate::math::real::{Bool, dot, minus, scaled};

/// What the ray through the middle of pixel (x, y) sees; `None` for the background.
pub fn probe(world: &World, options: &Options, x: u32, y: u32) -> Option<Probe> {
    let (o, d) = world.camera.grid(options).ray::<f64>(x as f64 + 0.5, y as f64 + 0.5);
    let mut rays = RayBatch::<f64>::default();
    for c in 0..3 {
        (rays.o[c][0], rays.d[c][0]) = (o[c], d[c]);
    }
    (rays.source[0], rays.len) = (NONE, 1);
    let mut everything = Candidates::default();
    everything.gather(world, usize::MAX - 1, |_| true, |_, _| true);
    let mut hits = HitColumns::<f64>::default();
    nearest::<f64, false>(world, &everything, &rays, &mut hits, &mut Way::default());
    if hits.id[0] == NONE {
        return None;
    }
    let (id, t, part) = (hits.id[0] as u32, hits.t[0], hits.part[0]);
    let primitive = world.primitive(id);
    let surface = world.surface::<f64, false>(id, (o, d), (t, part));
    let towards = if dot(surface.n, d) > 0.0 { -1.0 } else { 1.0 };
    let normal = scaled(towards, surface.n);

    let surfacing = world.surfacing(id);
    let mut spaces = Vec::new();
    let frame = PatternFrame::new(world, primitive, surfacing, &mut spaces);
    let color = match surfacing.color {
        Slot::Constant(c) => c,
        Slot::Pattern(p) => world.patterns.eval(p, &frame.point(&spaces, surface.local, surface.n)),
    };
    let from = spawn_point(surface.p, normal, surface.offset);
    let mut scratch = Shadow::default();
    let mut arriving = |number: usize, light: &PointLight| {
        let to = minus(light.at, from);
        let distance = dot(to, to).sqrt();
        let l = scaled(1.0 / distance, to);
        if !(dot(normal, l) > 0.0) {
            return [0.0; 3];
        }
        let outward = if towards > 0.0 { 1.0 } else { 0.0 };
        let touched = &light.touched;
        let rays = ShadowRays { source: id as f64, part, outward, o: from, l, distance, light: number, touched };
        occlusion(world, &everything, &rays, Bool(true), &mut scratch, &mut Recorder::off())
    };
    let lights = world.lights.iter().enumerate().map(|(i, l)| (l.node, arriving(i, l))).collect();
    let (node, material) = world.origin(id);
    let point: [f64; 3] = std::array::from_fn(|i| surface.p[i] + world.eye[i]);
    let distance = t * dot(d, d).sqrt();
    Some(Probe { node, material, point, normal, distance, color, lights })
}
