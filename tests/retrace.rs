//! What watching rests on: a picture of which only the tiles were traced that a change can have moved is, bit for bit, the
//! picture of which all were traced. Tried over random edits of random scenes.

use rtdsl::lang::{Input, Request, evaluate};
use rtdsl::math::hash::KeyedHash;
use rtdsl::render::{Crop, Options, Progress, Retracer, Silent, World, render};
use rtdsl::scene::{AntiAliasing, Precision, Scene};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

/// Nothing is cancelled.
static NEVER: AtomicBool = AtomicBool::new(false);

/// Where the picture is that scenes show.
const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");

/// Random numbers by key.
struct Chance(KeyedHash, u64);

impl Chance {
    fn new(seed: u64) -> Chance {
        Chance(KeyedHash::new().with(seed), 0)
    }
    fn unit(&mut self) -> f64 {
        self.1 += 1;
        self.0.with(self.1).unit()
    }
    fn below(&mut self, n: usize) -> usize {
        ((self.unit() * n as f64) as usize).min(n - 1)
    }
    fn from(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * self.unit()
    }
    fn point(&mut self) -> [f64; 3] {
        [self.from(-4.0, 4.0), self.from(0.0, 3.0), self.from(-6.0, 2.0)]
    }
    fn one<'a>(&mut self, of: &[&'a str]) -> &'a str {
        of[self.below(of.len())]
    }
}

/// A scene that edits can change, part by part.
#[derive(Clone)]
struct Draft {
    /// Shape, look, and where it is put.
    objects: Vec<[String; 3]>,
    lights: Vec<String>,
    rest: [String; 3],
}

fn shape(c: &mut Chance) -> String {
    let ([x, y, z], [u, v, w]) = (c.point(), c.point());
    let r = c.from(0.1, 0.8);
    match c.below(9) {
        0 | 1 => format!("sphere(at: [{x}, {y}, {z}], r: {r}"),
        2 => format!("box(from: [{x}, {y}, {z}], to: [{}, {}, {}]", x + r, y + r, z + 2.0 * r),
        3 => format!("cylinder(from: [{x}, {y}, {z}], to: [{u}, {v}, {w}], r: {}", r / 2.0),
        4 => format!("cone(from: [{x}, {y}, {z}], to: [{u}, {v}, {w}], r: {r}"),
        5 => format!("torus(at: [{x}, {y}, {z}], r: {}, tube: {}", r + 0.1, r / 3.0),
        6 => format!("triangle([[{x}, {y}, {z}], [{u}, {v}, {w}], [{}, {}, {}]]", x + 1.0, y + 1.5, z),
        7 => format!("disc(at: [{x}, {y}, {z}], normal: [{u}, 1, {w}], r: {r}"),
        _ => format!("plane(through: [0, {}, -9], normal: [0.1, 1, {}]", -r, c.from(0.0, 0.3)),
    }
}

fn look(c: &mut Chance) -> String {
    let [r, g, b] = [c.unit(), c.unit(), c.unit()];
    let color = format!("rgb({r}, {g}, {b})");
    match c.below(12) {
        7 => format!("matte(checker({color}, white, size: 0.4) |> rotate(z: {}deg))", c.from(0.0, 90.0)),
        8 => format!("phong(color: {color}, specular: 0.3, bump: noise() |> scale(0.2))"),
        9 => {
            format!("matte(image(\"assets/earth.png\", mapping: \"{}\"))", c.one(&["normal", "cylindrical", "planar"]))
        }
        10 => format!("phong(color: {color}, transmit: checker(black, white, size: {}))", c.from(0.2, 0.6)),
        11 => format!("matte(stripes({color}, black, axis: \"x\", size: 0.2))"),
        0 => format!("phong(color: {color}, specular: 0.4, reflect: 0.3)"),
        1 => format!("mirror(tint: {color})"),
        2 => format!("phong(color: {color}, transmit: {})", c.one(&["0.5", "0.9", "1", "noise()"])),
        3 => "glass()".to_string(),
        4 => format!("matte(checker({color}, white, size: 0.5))"),
        _ => format!("matte({color})"),
    }
}

/// Where a shape is put: transforms that move it, and such that only turn what is painted on it.
fn place(c: &mut Chance) -> String {
    match c.below(6) {
        0 => format!(" |> rotate(y: {}deg)", c.from(0.0, 90.0)),
        1 => format!(" |> move([{}, 0, 0])", c.from(-1.0, 1.0)),
        2 => format!(" |> scale({}) |> rotate(x: 20deg)", c.from(0.5, 1.5)),
        _ => String::new(),
    }
}

fn light(c: &mut Chance) -> String {
    let [x, y, z] = c.point();
    let power = c.from(0.2, 1.0);
    match c.below(4) {
        0 => format!("light(at: [1, 1.75, -1], power: {power})"), // on the lamp
        _ => format!("light(at: [{x}, {}, {z}], power: {power})", y + 3.0),
    }
}

impl Draft {
    fn new(c: &mut Chance) -> Draft {
        // Some scenes are so large that their tree is kept and only grafted on.
        let n = 2 + c.below(9) + if c.below(5) == 0 { 80 } else { 0 };
        let lamp = ["sphere(at: [1, 1.25, -1], r: 0.5".into(), "matte(white)".into(), String::new()];
        Draft {
            objects: (0..n).map(|_| [shape(c), look(c), place(c)]).chain([lamp]).collect(),
            lights: (0..c.below(3)).map(|_| light(c)).collect(),
            rest: [
                "background(#203040)".into(),
                "ambient(0.3)".into(),
                "camera(from: [0, 2, 9], at: [0, 1, 0], fov: 45deg)".into(),
            ],
        }
    }

    fn edit(&mut self, c: &mut Chance) {
        let at = c.below(self.objects.len());
        match c.below(20) {
            0..=4 => self.objects[at][1] = look(c),
            5..=7 => self.objects[at][0] = shape(c),
            8 => self.objects.push([shape(c), look(c), place(c)]),
            9 if self.objects.len() > 1 => drop(self.objects.remove(at)),
            10 => self.objects.reverse(),
            11 => {
                // A twin in the same place, of another look: which of them is seen?
                let twin = [self.objects[at][0].clone(), look(c), self.objects[at][2].clone()];
                self.objects.push(twin);
            }
            12 => self.lights.push(light(c)),
            13 => drop(self.lights.pop()),
            14 => self.rest[0] = format!("background(gray({}))", c.unit()),
            16..=17 => self.objects[at][2] = place(c),
            18 => {
                // Nothing but what is painted on it turns.
                self.objects[at][0] = "sphere(at: [0, 0, 0], r: 1.1".into();
                self.objects[at][2] = format!(" |> rotate(y: {}deg)", c.from(0.0, 90.0));
            }
            15 => self.rest[1] = format!("ambient({})", c.one(&["0", "0.1", "0.5"])),
            _ => self.rest[2] = format!("camera(from: [{}, 2, 9], at: [0, 1, 0], fov: 45deg)", c.from(-1.0, 1.0)),
        }
    }

    fn scene(&self) -> Scene {
        let objects = self.objects.iter().map(|[shape, look, place]| format!("{shape}, mat: {look}){place}\n"));
        let text = objects.chain(self.lights.iter().chain(&self.rest).map(|s| format!("{s}\n"))).collect::<String>();
        let main = Input::Text { name: "edit".into(), bytes: text.clone().into_bytes(), folder: FOLDER.into() };
        let request = Request { main, set: Vec::new(), allow_read: Vec::new(), record_arguments: false };
        match evaluate(&request) {
            Ok(e) => e.scene,
            Err(f) => panic!("{:?}\n{text}", f.diagnostics.iter().map(|d| &d.message).collect::<Vec<_>>()),
        }
    }
}

/// Edits scenes and compares; gives back tiles traced and tiles in all.
fn compare(seeds: std::ops::Range<u64>, edits: usize, options: &Options) -> (usize, usize) {
    let (mut traced, mut all) = (0, 0);
    for seed in seeds {
        let mut c = Chance::new(seed);
        let mut draft = Draft::new(&mut c);
        let mut retracer = Retracer::default();
        for step in 0..=edits {
            let scene = draft.scene();
            let built = retracer.build(&scene, &scene.cameras[0], &NEVER).expect("not cancelled");
            let plan = retracer.plan(&built, options, &NEVER);
            if step > 0 {
                (traced, all) = (traced + plan.traced(), all + plan.tiles());
            }
            let again = retracer.render(built, options, plan, &Silent, &NEVER).expect("not cancelled");
            let world = World::build(&scene, &scene.cameras[0]);
            let whole = render(&world, options, &Silent, &NEVER).expect("not cancelled");
            assert!(*again.film == whole.film, "seed {seed}, edit {step}: {}", {
                let differ = again.film.pixels.iter().zip(&whole.film.pixels).filter(|(a, b)| a != b).count();
                format!("{differ} pixels differ")
            });
            draft.edit(&mut c);
        }
    }
    (traced, all)
}

fn options() -> Options {
    let settings = Options::from_settings(&Scene::empty().settings);
    Options { width: 72, height: 48, tile: 8, max_depth: 3, threads: Some(2), ..settings }
}

#[test]
fn retracing_gives_the_picture_that_tracing_gives() {
    let (traced, all) = compare(0..60, 12, &options());
    assert!(traced * 10 < all * 7 && traced * 10 > all, "{traced} of {all} tiles: neither all nor nothing");
}

#[test]
fn with_several_rays_a_pixel_too() {
    let (traced, all) = compare(1000..1020, 8, &Options { aa: AntiAliasing::Grid(2), ..options() });
    assert!(traced * 10 < all * 7, "{traced} of {all}");
}

#[test]
fn in_32_bits_too() {
    let (traced, all) = compare(2000..2030, 8, &Options { precision: Precision::F32, ..options() });
    assert!(traced * 10 < all * 7, "{traced} of {all}");
}

#[test]
fn another_size_is_another_picture() {
    let mut c = Chance::new(7);
    let scene = Draft::new(&mut c).scene();
    let mut retracer = Retracer::default();
    for (width, expected) in [(72, 54), (72, 0), (40, 30)] {
        let options = Options { width, ..options() };
        let built = retracer.build(&scene, &scene.cameras[0], &NEVER).expect("not cancelled");
        let plan = retracer.plan(&built, &options, &NEVER);
        assert_eq!(plan.traced(), expected);
        let again = retracer.render(built, &options, plan, &Silent, &NEVER).expect("not cancelled");
        let whole = render(&World::build(&scene, &scene.cameras[0]), &options, &Silent, &NEVER).expect("not cancelled");
        assert!(*again.film == whole.film);
    }
}

/// Cancels when so many tiles are finished.
struct Stopper<'c>(AtomicU32, &'c AtomicBool);

impl Progress for Stopper<'_> {
    fn finished(&self, _tile: Crop, _rows: &[&mut [[f32; 3]]]) {
        if self.0.fetch_sub(1, Relaxed) == 1 {
            self.1.store(true, Relaxed);
        }
    }
}

#[test]
fn a_picture_that_was_cancelled_halfway_leaves_no_trace() {
    let mut cancelled = 0;
    for seed in 3000..3020 {
        let mut c = Chance::new(seed);
        let mut draft = Draft::new(&mut c);
        let (mut retracer, options) = (Retracer::default(), options());
        for step in 0..10 {
            let scene = draft.scene();
            let built = retracer.build(&scene, &scene.cameras[0], &NEVER).expect("not cancelled");
            let plan = retracer.plan(&built, &options, &NEVER);
            let cancel = AtomicBool::new(false);
            // Every third picture is finished.
            let tiles = if step % 3 == 0 { u32::MAX } else { 1 + c.below(20) as u32 };
            let stopper = Stopper(AtomicU32::new(tiles), &cancel);
            match retracer.render(built, &options, plan, &stopper, &cancel) {
                None => cancelled += 1,
                Some(again) => {
                    let world = World::build(&scene, &scene.cameras[0]);
                    let whole = render(&world, &options, &Silent, &NEVER).expect("not cancelled");
                    assert!(*again.film == whole.film, "seed {seed}, edit {step}");
                }
            }
            draft.edit(&mut c);
        }
    }
    assert!(cancelled > 40, "{cancelled}");
}
