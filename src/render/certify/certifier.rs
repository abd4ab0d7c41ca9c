//! What certificates need of a world, found once: how bright anything can be, and tables of its pictures.

use super::super::bounds::{Bounds, larger, smaller};
use super::super::camera::PixelGrid;
use super::super::filter::Kernel;
use super::super::material::{Slot, Surfacing};
use super::super::options::Options;
use super::super::pattern_node::PatternNode;
use super::super::shape::Primitive;
use super::super::world::World;
use super::bound::{Bound, Span, hull};
use super::bundle::Few;
use super::study::Study;
use super::target::Target;
use super::window::Window;
use crate::math::Form;

/// A world, as seen by its camera in a picture of a given size, about which certificates are made.
pub struct Certifier<'w> {
    pub(super) world: &'w World,
    pub(super) grid: PixelGrid<'w>,
    /// How often rays go on.
    pub(super) depth: u32,
    /// Where a pixel's light comes from.
    pub(super) window: Window,
    /// Where the light surely lies that rays see which go on so many times more, and every part of that light.
    ceilings: Vec<[Span; 3]>,
    /// The same for what each material gives back.
    gives: Vec<Gives>,
    /// Where the values of each pattern lie.
    patterns: Vec<[Span; 3]>,
    /// What rays that go on bring isn't looked for where it is no more than that.
    pub(super) faint: f64,
}

impl<'w> Certifier<'w> {
    /// Looks through the world once.
    pub fn new(world: &'w World, options: &Options) -> Certifier<'w> {
        let depth = options.max_depth;
        let patterns = pattern_ranges(world);
        let (gives, ceilings) = ceilings(world, &patterns, depth);
        let (grid, window) = (world.camera.grid(options), Window::new(Kernel::of(options.filter)));
        Certifier { world, grid, depth, window, ceilings, gives, patterns, faint: 0.0 }
    }

    /// For pictures that are to reach a target: then what is too faint to matter is left unknown.
    pub fn for_target(self, target: &Target) -> Certifier<'w> {
        Certifier { faint: target.faint(), ..self }
    }

    /// What is known of the light in a rectangle of the picture, in pixels: left, top, right, bottom. ξ grows to the right and η
    /// downwards.
    pub fn region(&self, rect: [f64; 4]) -> Bound {
        self.looked_at(rect).0
    }

    /// One form for the light all over a rectangle, if there is one: quicker than [`region`](Certifier::region) where there
    /// is none.
    pub fn form(&self, rect: [f64; 4]) -> Option<[Form; 3]> {
        let mut study = Study::new(self);
        study.undivided = true;
        study.rectangle(rect).form.filter(|form| form.iter().all(|f| f.is_known()))
    }

    /// As [`region`](Certifier::region); and whether parts of it are best rows of its whole width.
    pub(super) fn looked_at(&self, rect: [f64; 4]) -> (Bound, bool) {
        let mut study = Study::new(self);
        (study.rectangle(rect), study.in_rows)
    }

    /// Where the light surely lies that a ray sees which goes on `depth` times at most.
    pub fn ceiling(&self, depth: u32) -> [Span; 3] {
        let last = self.ceilings.len() - 1;
        self.ceilings[(depth as usize).min(last)]
    }

    /// Where the own light of surface `id` lies.
    pub(super) fn own_ceiling(&self, id: u32) -> [Span; 3] {
        self.gives(id).own
    }

    /// Where the light lies that surface `id` sends to rays which go on `depth` times at most, but for what goes straight
    /// through it.
    pub(super) fn surface_ceiling(&self, id: u32, depth: u32) -> [Span; 3] {
        let gives = self.gives(id);
        let straight = self.straight_through(id).is_some();
        self.with_onward(gives, if straight { gives.mirrored } else { gives.onward }, depth)
    }

    /// Where the light lies, and every part of it, that rays see which meet some of these surfaces or none, and go on `depth`
    /// times at most.
    pub(super) fn ceiling_among(&self, ids: &[u32], depth: u32) -> [Span; 3] {
        let background = self.world.background.map(|x| hull([x; 2], [0.0; 2]));
        ids.iter().fold(background, |all, id| {
            let gives = self.gives(*id);
            let one = self.with_onward(gives, gives.onward, depth);
            [0, 1, 2].map(|c| hull(all[c], one[c]))
        })
    }

    fn gives(&self, id: u32) -> &Gives {
        &self.gives[self.world.primitive(id).material as usize]
    }

    /// Own light and a share of what comes from further on.
    fn with_onward(&self, gives: &Gives, share: [f64; 3], depth: u32) -> [Span; 3] {
        let Some(depth) = depth.checked_sub(1) else { return gives.own };
        let light = self.ceiling(depth);
        [0, 1, 2].map(|c| [0, 1].map(|end| (gives.own[c][end] + share[c] * light[c][end]) * UP))
    }

    /// Where the values of a material's slot lie.
    pub(super) fn slot_range(&self, slot: Slot) -> [Span; 3] {
        slot_range(&self.patterns, slot)
    }

    /// Where the values of pattern `id` lie.
    pub(super) fn pattern_range(&self, id: u32) -> [Span; 3] {
        self.patterns[id as usize]
    }

    /// A primitive's lengths as they were made, over those of its frame.
    pub(super) fn made_scale(&self, primitive: &Primitive) -> f64 {
        let made = self.world.spaces.get(primitive.space as usize);
        made.and_then(|m| m.rescale.as_ref()).map_or(1.0, |r| r.inverse)
    }

    /// The surfaces that aren't excluded, if they are few.
    pub(super) fn gather(
        &self,
        keep: impl FnMut(&Bounds) -> bool,
        mut keep_plane: impl FnMut([f64; 3], f64) -> bool,
    ) -> Option<Few> {
        let mut few = Few::none();
        let mut fits = true;
        for p in &self.world.unbounded {
            if keep_plane(p.n, p.offset) {
                fits &= few.push(p.id);
            }
        }
        self.world.bvh.gather(usize::MAX, keep, |id| {
            fits &= few.push(id);
            fits
        });
        fits.then_some(few)
    }
}

/// What a material gives back at most.
#[derive(Clone, Copy)]
struct Gives {
    /// Where its own light lies.
    own: [Span; 3],
    /// How much of what it mirrors.
    mirrored: [f64; 3],
    /// How much of what it mirrors and of what comes through it, together.
    onward: [f64; 3],
}

/// A few roundings of each step, upwards.
const UP: f64 = 1.0 + 1.0 / (1u64 << 40) as f64;

/// By material: what it gives back; by how often rays go on: where the light lies that they see. Every sum of some of
/// their parts lies there, too.
fn ceilings(world: &World, patterns: &[[Span; 3]], depth: u32) -> (Vec<Gives>, Vec<[Span; 3]>) {
    let slot = |s: Slot, c: usize| slot_range(patterns, s)[c];
    let magnitude = |s: Span| larger(s[0].abs(), s[1].abs());
    let lights: [f64; 3] = [0, 1, 2].map(|c| world.lights.iter().map(|l| l.color[c].abs()).sum());
    // The most light of its own, and the most of what is seen behind or mirrored, that a material gives back.
    let own = |m: &Surfacing, c: usize| {
        let of = |s: Slot| magnitude(slot(s, c));
        of(m.color) * (of(m.ambient) * world.ambient[c].abs() + of(m.diffuse) * lights[c]) + of(m.specular) * lights[c]
    };
    let onward = |m: &Surfacing, c: usize| magnitude(slot(m.reflect, c)) + magnitude(slot(m.transmit, c));
    let negative = |m: &Surfacing| {
        [m.color, m.ambient, m.diffuse, m.specular, m.reflect, m.transmit]
            .iter()
            .any(|s| (0..3).any(|c| slot(*s, c)[0] < 0.0))
    };
    let most = |f: &dyn Fn(&Surfacing) -> f64| world.materials.iter().fold(0.0, |m, x| larger(m, f(x)));
    let any_negative = world.materials.iter().any(negative)
        || world.background.iter().chain(&world.ambient).any(|x| *x < 0.0)
        || world.lights.iter().any(|l| l.color.iter().any(|x| *x < 0.0));
    let up = |x: f64| x * UP;
    let mut all: Vec<[Span; 3]> = Vec::new();
    let span = |most: f64| if any_negative { [-most, most] } else { [0.0, most] };
    let gives = |m: &Surfacing| Gives {
        own: [0, 1, 2].map(|c| span(up(own(m, c)))),
        mirrored: [0, 1, 2].map(|c| magnitude(slot(m.reflect, c))),
        onward: [0, 1, 2].map(|c| up(onward(m, c))),
    };
    let gives = world.materials.iter().map(gives).collect();
    let background = world.background.map(f64::abs);
    let mut light = [0, 1, 2].map(|c| up(larger(background[c], most(&|m| own(m, c)))));
    all.push(light.map(span));
    for _ in 0..depth {
        let next = [0, 1, 2].map(|c| up(larger(background[c], most(&|m| own(m, c) + onward(m, c) * light[c]))));
        let next = [0, 1, 2].map(|c| larger(next[c], light[c]));
        if next == light || !next.iter().all(|x| x.is_finite()) {
            break;
        }
        light = next;
        all.push(light.map(span));
    }
    (gives, all)
}

/// Where the values of a slot lie.
fn slot_range(patterns: &[[Span; 3]], slot: Slot) -> [Span; 3] {
    match slot {
        Slot::Constant(v) => v.map(|x| [x; 2]),
        Slot::Pattern(id) => patterns[id as usize],
    }
}

/// Where the values of each pattern lie.
fn pattern_ranges(world: &World) -> Vec<[Span; 3]> {
    let mut ranges: Vec<[Span; 3]> = Vec::with_capacity(world.patterns.nodes.len());
    for node in &world.patterns.nodes {
        let of = |id: u32| ranges[id as usize];
        let each = |f: &dyn Fn(usize) -> Span| [0, 1, 2].map(f);
        let between = |a: u32, b: u32| each(&|c| hull(of(a)[c], of(b)[c]));
        let range = match node {
            PatternNode::Constant(v) => v.map(|x| [x; 2]),
            PatternNode::Checker(a, b, _)
            | PatternNode::Stripes(a, b, ..)
            | PatternNode::Rings(a, b, ..)
            | PatternNode::Gradient(a, b, ..)
            | PatternNode::Noise(a, b, ..)
            | PatternNode::Cells(a, b, _)
            | PatternNode::Brick(a, b, ..) => between(*a, *b),
            // Texels lie between 0 and 1.
            PatternNode::Image { .. } => [[0.0, 1.0]; 3],
            // By the share, wherever it leads: a + s·(b − a).
            PatternNode::Mix(a, b, by) => each(&|c| {
                let (a, b, s) = (of(*a)[c], of(*b)[c], of(*by)[c]);
                let one = |x: Span, s: Span| {
                    let all = [x[0] * s[0], x[0] * s[1], x[1] * s[0], x[1] * s[1]];
                    all.iter().fold([all[0]; 2], |m, x| [smaller(m[0], *x), larger(m[1], *x)])
                };
                let (p, q) = (one(a, [1.0 - s[1], 1.0 - s[0]]), one(b, s));
                [p[0] + q[0], p[1] + q[1]]
            }),
            PatternNode::Blend(stops, _) => each(&|c| stops.iter().fold(of(stops[0])[c], |m, s| hull(m, of(*s)[c]))),
            PatternNode::InSpace(child, _) | PatternNode::Mapped(child, _) | PatternNode::Turbulence(child, ..) => {
                of(*child)
            }
            PatternNode::Add(a, b) => each(&|c| [of(*a)[c][0] + of(*b)[c][0], of(*a)[c][1] + of(*b)[c][1]]),
            PatternNode::Multiply(a, b) => each(&|c| {
                let (a, b) = (of(*a)[c], of(*b)[c]);
                let all = [a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]];
                all.iter().fold([all[0]; 2], |m, x| [smaller(m[0], *x), larger(m[1], *x)])
            }),
            PatternNode::Within(child, least, most) => {
                each(&|c| of(*child)[c].map(|x| smaller(larger(x, *least), *most)))
            }
        };
        ranges.push(range);
    }
    ranges
}
