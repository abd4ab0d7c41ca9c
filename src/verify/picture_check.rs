//! The laws of whole pictures as checks: each law in many cases, on every scene that it is given.

use super::picture::{Difference, Law, beside, compare, picture, steady};
use super::reach::reach;
use super::{Bound, Figure, Outcome, Size};
use crate::film::Film;
use crate::render::{Crop, Instructions, Options, World};
use crate::scene::{AntiAliasing, Precision, Scene};
use glam::DVec3;

/// A scene whose pictures are checked.
#[derive(Clone, Debug)]
pub struct Subject {
    /// How reports name it.
    pub name: String,
    /// The scene.
    pub scene: Scene,
    /// The [`hash`](Film::hash) of its small picture, if it is known beforehand: the same on every machine.
    pub hash: Option<&'static str>,
}

/// A check of pictures.
#[derive(Clone, Copy, Debug)]
pub struct PictureCheck {
    /// A short word for it, for the command line and for tests.
    pub name: &'static str,
    /// What it shows, in one line.
    pub what: &'static str,
    /// Tries it out on every scene.
    pub run: fn(&[Subject], Size) -> Outcome,
}

/// All of them.
pub const ALL: [PictureCheck; 9] = [
    PictureCheck { name: "powers", what: "all lengths times a power of two: the same bits", run: powers },
    PictureCheck { name: "scales", what: "all lengths times another factor: the same picture", run: scales },
    PictureCheck { name: "moves", what: "everything moved, up to 2^40 away: the same bits", run: moves },
    PictureCheck { name: "mirrored", what: "everything mirrored: the same bits, mirrored", run: mirrored },
    PictureCheck { name: "turned", what: "everything turned by 90 degrees: the same picture", run: turned },
    PictureCheck { name: "order", what: "objects in another order, or within an instance: the same bits", run: order },
    PictureCheck { name: "treeless", what: "every ray tested against every surface: the same bits", run: treeless },
    PictureCheck { name: "parts", what: "other threads, tiles and crops: the same bits", run: parts },
    PictureCheck {
        name: "instructions",
        what: "with and without fused multiply-add, in 64 and 32 bits: the same bits",
        run: instructions,
    },
];

/// How to trace `scene` in a picture `width` pixels across, in its own proportions, with one ray through each pixel's middle.
fn options(scene: &Scene, width: u32) -> Options {
    let s = &scene.settings;
    let height = (width as u64 * s.height as u64).div_ceil(s.width.max(1) as u64).clamp(1, 2 * width as u64) as u32;
    Options { width, height, aa: AntiAliasing::Off, ..Options::from_settings(s) }
}

/// The pictures of one law, counted.
#[derive(Default)]
struct Comparisons {
    outcome: Outcome,
    /// Pixels whose bits differ.
    bits: u64,
    /// Pictures that the law says nothing of.
    silent: u64,
}

impl Comparisons {
    /// Counts one comparison; `bad` says whether it breaks the law.
    fn add(
        &mut self,
        what: impl FnOnce() -> String,
        difference: Option<Difference>,
        bad: impl Fn(&Difference) -> bool,
    ) {
        let Some(d) = difference else {
            self.silent += 1;
            return;
        };
        self.outcome.cases += 1;
        self.bits += d.bits as u64;
        if bad(&d) && self.outcome.first_failure.is_none() {
            let (x, y) = d.first.unwrap_or_default();
            let of = format!("{} of {} pixels differ, {} visibly", d.bits, d.pixels, d.visible);
            self.outcome.first_failure = Some(format!("{}: {of}, the first at {x},{y}", what()));
        }
    }

    /// The outcome of a law that leaves every bit.
    fn same_bits(mut self) -> Outcome {
        self.outcome.figures.push(Figure::none_of("pixels with other bits", self.bits));
        if self.silent > 0 {
            let what = "pictures left out: the camera can't be moved so without rounding";
            self.outcome.figures.push(Figure::new(what, self.silent as f64, "", Bound::None));
        }
        self.outcome
    }
}

/// Whether any bit differs.
fn any(d: &Difference) -> bool {
    !d.is_none()
}

/// Tries `laws`, each of which leaves every bit, on pictures `width` pixels across.
fn same_bits(
    subjects: &[Subject],
    width: u32,
    prepared: fn(&Scene) -> Scene,
    laws: impl Fn(&Scene, &Options) -> Vec<Law>,
) -> Outcome {
    let mut done = Comparisons::default();
    for subject in subjects {
        let scene = prepared(&subject.scene);
        let options = options(&scene, width);
        let before = picture(&scene, &options);
        for law in laws(&scene, &options) {
            done.add(|| format!("{}, {law:?}", subject.name), law.difference(&scene, &options, &before), any);
        }
    }
    done.same_bits()
}

/// Pixels across of a picture of which every bit is compared.
fn width(size: Size) -> u32 {
    size.pick(96, 192) as u32
}

fn powers(subjects: &[Subject], size: Size) -> Outcome {
    let exponents: Vec<i32> = match size {
        Size::Quick => vec![-400, -131, -20, -1, 1, 33, 400],
        Size::Long => (-400..=400).filter(|k| *k != 0).collect(),
    };
    same_bits(subjects, size.pick(96, 128) as u32, Scene::clone, |scene, _| {
        let reach = reach(scene);
        exponents.iter().copied().filter(|k| reach.contains(k)).map(Law::PowerOfTwo).collect()
    })
}

fn moves(subjects: &[Subject], size: Size) -> Outcome {
    let far = (1u64 << 40) as f64;
    let mut by =
        vec![DVec3::X, DVec3::new(1024.0, 0.0, -3.0), DVec3::new(-4096.0, 512.0, 65536.0), DVec3::new(3.0, far, -far)];
    if size == Size::Long {
        for k in 0..=40 {
            let far = (1u64 << k) as f64;
            by.extend([DVec3::X * far, DVec3::new(-far, far, 1.0), DVec3::new(5.0, -1.0, far)]);
        }
    }
    same_bits(subjects, width(size), steady, |_, _| by.iter().copied().map(Law::Moved).collect())
}

fn mirrored(subjects: &[Subject], size: Size) -> Outcome {
    same_bits(subjects, width(size), Scene::clone, |_, _| vec![Law::Mirrored(0), Law::Mirrored(1), Law::Mirrored(2)])
}

fn order(subjects: &[Subject], size: Size) -> Outcome {
    let lots = 0..size.pick(3, 40);
    same_bits(subjects, width(size), Scene::clone, |_, _| {
        lots.clone().map(Law::Shuffled).chain([Law::Instanced]).collect()
    })
}

fn treeless(subjects: &[Subject], size: Size) -> Outcome {
    same_bits(subjects, width(size), Scene::clone, |_, _| vec![Law::Treeless])
}

fn parts(subjects: &[Subject], size: Size) -> Outcome {
    same_bits(subjects, width(size), Scene::clone, |_, o| {
        let threads: &[usize] = if size == Size::Long { &[1, 2, 3, 4, 7, 16, 64] } else { &[1, 3] };
        let tiles: &[u32] = if size == Size::Long { &[1, 2, 3, 5, 7, 8, 11, 17, 31, 32] } else { &[1, 7] };
        let (w, h) = (o.width, o.height);
        let thirds = Crop { x: w / 3, y: h / 3, width: w.div_ceil(3), height: h.div_ceil(3) };
        let one = Crop { x: w / 2, y: h / 2, width: 1, height: 1 };
        let strip = Crop { x: 0, y: h - 1, width: w, height: 1 };
        let threads = threads.iter().copied().map(Law::Threads);
        threads.chain(tiles.iter().copied().map(Law::Tiles)).chain([thirds, one, strip].map(Law::Cropped)).collect()
    })
}

/// Share of pixels that may differ visibly where every coordinate is rounded anew.
const VISIBLE: f64 = 1e-4;

/// Tries one law on all scenes, whose pictures it may change by rounding: by more than 1/255 where all lengths stay what they are,
/// by more than 2/255 where they are rounded, in a few pixels.
fn same_picture(done: &mut Comparisons, subjects: &[Subject], width: u32, what: &str, law: Law) {
    let (most, beyond): (u32, fn(&Difference) -> usize) = match law {
        Law::Turned(_) => (1, |d| d.beyond_one),
        _ => (2, |d| d.visible),
    };
    let (mut changed, mut pixels) = (0, 0);
    for subject in subjects {
        let scene = beside(&subject.scene);
        let options = options(&scene, width);
        let before = picture(&scene, &options);
        let difference = law.difference(&scene, &options, &before);
        if let Some(d) = &difference {
            (changed, pixels) = (changed + beyond(d), pixels + d.pixels);
        }
        let is_broken = |d: &Difference| beyond(d) as f64 > VISIBLE * d.pixels as f64;
        done.add(|| format!("{}, {law:?}", subject.name), difference, is_broken);
    }
    let share = changed as f64 / pixels.max(1) as f64;
    let what = format!("{what}: pixels that differ by more than {most}/255");
    done.outcome.figures.push(Figure::new(what, 100.0 * share, "%", Bound::AtMost(100.0 * VISIBLE)));
}

fn scales(subjects: &[Subject], size: Size) -> Outcome {
    let mut done = Comparisons::default();
    for s in [1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9] {
        let what = format!("times {s:e}");
        same_picture(&mut done, subjects, size.pick(160, 640) as u32, &what, Law::Scaled(s));
    }
    done.outcome
}

fn turned(subjects: &[Subject], size: Size) -> Outcome {
    let mut done = Comparisons::default();
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let what = format!("about {name}");
        same_picture(&mut done, subjects, size.pick(160, 640) as u32, &what, Law::Turned(axis as u8));
    }
    done.outcome
}

/// Pixels across of the picture whose hash is known beforehand.
pub const HASHED_WIDTH: u32 = 192;

/// The small picture of a scene whose hash is known beforehand.
pub fn hashed(scene: &Scene) -> Film {
    picture(scene, &options(scene, HASHED_WIDTH))
}

fn instructions(subjects: &[Subject], _: Size) -> Outcome {
    let mut done = Comparisons::default();
    let (mut known, mut others) = (0, 0);
    for Subject { name, scene, hash } in subjects {
        for precision in [Precision::F64, Precision::F32] {
            // What is out of reach of 32 bits isn't asked for in them.
            if precision == Precision::F32 && World::build(scene, &scene.cameras[0]).beyond_f32().is_some() {
                continue;
            }
            let best = Options { precision, ..options(scene, HASHED_WIDTH) };
            let film = picture(scene, &best);
            for instructions in [Instructions::Narrow, Instructions::Common] {
                let other = picture(scene, &Options { instructions, ..best.clone() });
                done.add(|| format!("{name}, {precision:?}, {instructions:?}"), Some(compare(&film, &other)), any);
            }
        }
        if let Some(hash) = hash {
            let is = hashed(scene).hash();
            known += 1;
            others += (is != *hash) as u64;
            if is != *hash && done.outcome.first_failure.is_none() {
                done.outcome.first_failure = Some(format!("{name}: its picture has the hash {is}, not {hash}"));
            }
        }
    }
    let mut outcome = done.same_bits();
    if known > 0 {
        let what = format!("pictures with another hash than on the machine they were made on, of {known}");
        outcome.figures.push(Figure::none_of(what, others));
    }
    outcome
}
