//! Pictures whose pixels are known exactly: shapes of one gray before another, in a parallel view in which a pixel is one unit
//! wide. Edges, discs, needles, dust, checkers, each in any place and direction.

use super::covered::{Square, disc, polygon};
use super::kept::Kept;
use crate::math::fun;
use crate::render::certify::{Pixel, Target, certify, code};
use crate::render::{Options, World};
use crate::scene::{AntiAliasing, Camera, Color, Pattern, PatternId, PatternKind, PixelFilter, Projection, Shape};
use crate::verify::draw::Draw;
use crate::verify::stage::{Stage, Surface};
use crate::verify::{Bound, Check, Figure, Outcome, Size};
use glam::DVec3;
use rayon::prelude::*;

/// The check.
pub const CHECK: Check = Check {
    name: "coverage",
    what: "pixels keep the error that is stated of them, where their true value is a closed form",
    run,
};

/// Pixels along a side of a picture.
const SIDE: u32 = 12;

/// A picture and its truth.
pub(super) struct Known {
    stage: Stage,
    /// The linear value of each pixel, row by row.
    truth: Vec<f64>,
}

/// What is asked of the pictures.
pub(super) struct Ask {
    pub(super) what: &'static str,
    pub(super) target: Target,
}

/// Every way in which a pixel's error can come to be stated.
fn asks() -> Vec<Ask> {
    let few = |codes, confidence| Target { evaluations: 1, confidence, ..Target::new(codes) };
    vec![
        Ask { what: "16/255", target: Target::new(16.0) },
        Ask { what: "4/255", target: Target::new(4.0) },
        Ask { what: "2/255", target: Target::new(2.0) },
        Ask { what: "1/255", target: Target::new(1.0) },
        Ask { what: "0.25/255, 16 bits", target: Target { quantum: 1.0 / 257.0, ..Target::new(0.25) } },
        // Most of what could be proved isn't tried to: so that much is sampled.
        Ask { what: "4/255 after one look, confidence 99.9 %", target: few(4.0, 0.999) },
        Ask { what: "8/255 after one look, confidence 90 %", target: few(8.0, 0.9) },
        Ask { what: "4/255 without certificates", target: Target { certificates: false, ..Target::new(4.0) } },
    ]
}

fn run(size: Size) -> Outcome {
    let mut outcome = Outcome::default();
    ask(&mut outcome, asks(), size.pick(10, 600), (PixelFilter::Box, &KINDS), "");
    outcome
}

/// Asks pictures of so many seeds, each of every kind, and adds what becomes of it to `outcome`, with figures that begin `of` what they are;
/// last comes a negative control.
pub(super) fn ask(
    outcome: &mut Outcome,
    asks: Vec<Ask>,
    seeds: u64,
    (filter, kinds): (PixelFilter, &[Kind]),
    of: &str,
) {
    for Ask { what, target } in asks {
        // Samples alone take about a hundred times as long.
        let seeds = if target.certificates { seeds } else { seeds.div_ceil(10) };
        let (kept, first) = tried(seeds, &target, filter, kinds);
        outcome.cases += kept.cases();
        outcome.figures.extend(kept.figures(&format!("{of}{what}"), target.confidence));
        outcome.first_failure = outcome.first_failure.take().or(first);
    }
    // The negative control: bounds of which a tenth is believed have to be found out.
    let weakened = Target { believed: 0.1, ..Target::new(4.0) };
    let (kept, _) = tried(seeds, &weakened, filter, kinds);
    outcome.cases += kept.cases();
    let text = format!("{of}negative control, bounds made ten times narrower: broken");
    outcome.figures.push(Figure::new(text, kept.broken() as f64, "", Bound::AtLeast(1.0)));
}

/// Pictures of so many seeds, each of every kind, brought to `target`; and the first pixel that breaks its word.
fn tried(seeds: u64, target: &Target, filter: PixelFilter, kinds: &[Kind]) -> (Kept, Option<String>) {
    let one = |seed: u64| {
        let mut kept = Kept::default();
        let mut first = None;
        for (kind, make) in kinds {
            let known = make(&mut Draw::new(kind, seed));
            let world = World::build(&known.stage.scene, &known.stage.scene.cameras[0]);
            let options = Options {
                width: SIDE,
                height: SIDE,
                aa: AntiAliasing::Off,
                filter,
                threads: Some(1),
                ..Options::from_settings(&known.stage.scene.settings)
            };
            let pixels = certify(&world, &options, target);
            for (i, (pixel, truth)) in pixels.iter().zip(&known.truth).enumerate() {
                let error = off(pixel, *truth, target.quantum);
                if kept.count(pixel, target, error, 0.0) && first.is_none() {
                    let (x, y) = (i as u32 % SIDE, i as u32 / SIDE);
                    let status = pixel.status;
                    first = Some(format!("{kind}, seed {seed}, pixel {x},{y}: {status:?}, off by {error:.4}/255"));
                }
            }
        }
        (kept, first)
    };
    // In the order of seeds, whoever works on them.
    let all: Vec<_> = (0..seeds).into_par_iter().map(one).collect();
    all.into_iter().fold((Kept::default(), None), |(kept, first), (k, f)| (kept.and(k), first.or(f)))
}

/// How far the code that is written for a gray pixel is from that of `truth`.
pub(super) fn off(pixel: &Pixel, truth: f64, quantum: f64) -> f64 {
    let written = |v: f64| if quantum > 0.0 { (code(v) / quantum).round() * quantum } else { code(v) };
    pixel.value.iter().map(|&v| (written(v) - code(truth)).abs()).fold(0.0, |m, e| if e > m { e } else { m })
}

/// A kind of pictures, and one of them by lot.
pub(super) type Kind = (&'static str, fn(&mut Draw) -> Known);

const KINDS: [Kind; 5] =
    [("edges", edge), ("discs", ball), ("needles", needles), ("dust", dust), ("checkers", checker)];

/// Two grays, far enough apart to see a difference between them.
pub(super) fn grays(draw: &mut Draw) -> [f64; 2] {
    let dark = draw.between(0.0, 0.3);
    let bright = draw.between(0.4, 1.0);
    if draw.once_in(2) { [dark, bright] } else { [bright, dark] }
}

/// Shapes of gray `[1]` before gray `[0]`; `covered` is the area of them in a square.
pub(super) fn before(grays: [f64; 2], shapes: Vec<Shape>, covered: impl Fn(Square) -> f64) -> Known {
    let mut stage = Stage::new();
    stage.scene.background = Color::linear_gray(grays[0]);
    stage.scene.ambient = Color::WHITE;
    let half = 0.5 * SIDE as f64;
    let projection = Projection::Orthographic { height: SIDE as f64 };
    stage.scene.cameras =
        vec![Camera { from: DVec3::new(0.0, 0.0, 50.0), at: DVec3::ZERO, projection, ..Camera::default() }];
    for shape in shapes {
        stage.shape(shape, Surface { ambient: grays[1], ..Surface::default() });
    }
    let truth = squares(half).map(|s| grays[0] + (grays[1] - grays[0]) * covered(s)).collect();
    Known { stage, truth }
}

/// The squares of the pixels, row by row, where the picture's middle is the origin.
fn squares(half: f64) -> impl Iterator<Item = Square> {
    let (rows, columns) = (0..SIDE, 0..SIDE);
    rows.flat_map(move |y| {
        columns.clone().map(move |x| {
            let (left, top) = (x as f64 - half, half - y as f64);
            [left, top - 1.0, left + 1.0, top]
        })
    })
}

/// A direction in the picture.
fn direction(draw: &mut Draw) -> [f64; 2] {
    let turn = draw.between(0.0, 360.0);
    [fun::cos_deg(turn), fun::sin_deg(turn)]
}

fn triangle(corners: [[f64; 2]; 3], z: f64) -> Shape {
    Shape::Triangle { points: Box::new(corners.map(|[x, y]| DVec3::new(x, y, z))), normals: None }
}

/// Half of the picture, with an edge in any direction.
fn edge(draw: &mut Draw) -> Known {
    let grays = grays(draw);
    let ([x, y], d) = (random_point(draw), direction(draw));
    let far = 100.0;
    let along = |s: f64, t: f64| [x + s * d[0] - t * d[1], y + s * d[1] + t * d[0]];
    let corners = [along(-far, 0.0), along(far, 0.0), along(0.0, far)];
    before(grays, vec![triangle(corners, 0.0)], |s| polygon(&corners, s))
}

/// A ball, from a twentieth of a pixel to most of the picture.
fn ball(draw: &mut Draw) -> Known {
    let grays = grays(draw);
    let centre = random_point(draw);
    let r = draw.magnitude(-4, 2);
    let shape = Shape::Sphere { at: DVec3::new(centre[0], centre[1], 0.0), r };
    before(grays, vec![shape], |s| disc(centre, r, s))
}

/// Four lines a tenth of a pixel wide, or less, that nowhere cross: each in its own quarter.
fn needles(draw: &mut Draw) -> Known {
    let grays = grays(draw);
    let quarter = 0.25 * SIDE as f64;
    let all: Vec<[[f64; 2]; 3]> = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]]
        .map(|[x, y]| {
            let d = direction(draw);
            let (length, width) = (0.9 * quarter, draw.between(0.01, 0.1));
            let at = |s: f64, t: f64| [quarter * x + s * d[0] - t * d[1], quarter * y + s * d[1] + t * d[0]];
            [at(-length, 0.0), at(length, -width), at(length, width)]
        })
        .to_vec();
    let shapes = all.iter().map(|c| triangle(*c, 0.0)).collect();
    before(grays, shapes, |s| all.iter().map(|c| polygon(c, s)).sum())
}

/// Dots of a tenth of a pixel and less, one in the middle of every third pixel or somewhere else in it.
fn dust(draw: &mut Draw) -> Known {
    let grays = grays(draw);
    let mut dots = Vec::new();
    for square in squares(0.5 * SIDE as f64) {
        if draw.once_in(3) {
            let r = draw.between(0.01, 0.1);
            let at = |draw: &mut Draw, lo: f64| draw.between(lo + r, lo + 1.0 - r);
            dots.push(([at(draw, square[0]), at(draw, square[1])], r));
        }
    }
    let ball = |(c, r): &([f64; 2], f64)| Shape::Sphere { at: DVec3::new(c[0], c[1], 0.0), r: *r };
    let shapes = dots.iter().map(ball).collect();
    before(grays, shapes, |s| dots.iter().map(|(c, r)| disc(*c, *r, s)).sum())
}

/// A checker from fine to coarse, in any direction.
fn checker(draw: &mut Draw) -> Known {
    let [a, b] = grays(draw);
    let (size, [x, z], up) = (draw.between(0.3, 4.0), random_point(draw), direction(draw));
    let mut known = before([0.0, a], vec![Shape::Plane { through: DVec3::ZERO, normal: DVec3::Y }], |_| 0.0);
    let scene = &mut known.stage.scene;
    let mut add = |pattern| {
        scene.patterns.push(pattern);
        PatternId(scene.patterns.len() as u32 - 1)
    };
    let (even, odd) = (add(Pattern::constant(Color::linear_gray(a))), add(Pattern::constant(Color::linear_gray(b))));
    let pattern = add(Pattern { kind: PatternKind::Checker { a: even, b: odd, size }, span: None });
    let white = add(Pattern::constant(Color::WHITE));
    for material in &mut scene.materials {
        (material.color, material.ambient) = (pattern, white);
    }
    scene.cameras[0].from = DVec3::new(x, 50.0, z);
    scene.cameras[0].at = DVec3::new(x, 0.0, z);
    scene.cameras[0].up = DVec3::new(up[0], 0.0, up[1]);
    // The view is straight down: to its right is view × up.
    let right = [-up[1], up[0]];
    let on_plane = |p: f64, q: f64| [x + p * right[0] + q * up[0], z + p * right[1] + q * up[1]];
    known.truth = squares(0.5 * SIDE as f64)
        .map(|[x0, y0, x1, y1]| {
            let pixel = [on_plane(x0, y0), on_plane(x1, y0), on_plane(x1, y1), on_plane(x0, y1)];
            a + (b - a) * odd_share(&pixel, size)
        })
        .collect();
    known
}

/// The area of a unit square's odd cells.
fn odd_share(pixel: &[[f64; 2]; 4], size: f64) -> f64 {
    let cells = |axis: usize| {
        let of = pixel.map(|p| (p[axis] / size).floor() as i64);
        of.iter().fold([of[0], of[0]], |[lo, hi], &c| [lo.min(c), hi.max(c)])
    };
    let ([i0, i1], [j0, j1]) = (cells(0), cells(1));
    let all = (i0..=i1).flat_map(|i| (j0..=j1).map(move |j| (i, j)));
    let odd = all.filter(|(i, j)| (i + j).rem_euclid(2) == 1);
    odd.map(|(i, j)| polygon(pixel, [i as f64 * size, j as f64 * size, (i + 1) as f64 * size, (j + 1) as f64 * size]))
        .sum()
}

/// Anywhere in the picture.
pub(super) fn random_point(draw: &mut Draw) -> [f64; 2] {
    let half = 0.5 * SIDE as f64;
    [draw.between(-half, half), draw.between(-half, half)]
}
