//! Laws of whole pictures: a scene is changed in a way that must not show, traced again, and both pictures are compared.
//!
//! A change is made around the scene, not in its text: every root goes below a transform, and the cameras go along. So the
//! numbers of shapes, materials and patterns stay what they are, whatever the change, and only the renderer is under test.
//!
//! Two laws need pictures of one ray a pixel, through its middle ([`AntiAliasing::Off`](crate::scene::AntiAliasing::Off)):
//! a mirrored picture adds up the other rays of a pixel in another order.

use super::draw::power;
use crate::film::Film;
use crate::math::Affine;
use crate::math::hash::KeyedHash;
use crate::render::bounds::larger;
use crate::render::{Crop, Options, Silent, World, render};
use crate::scene::color::encode_srgb;
use crate::scene::{Camera, Node, NodeId, NodeKind, Projection, Scene};
use glam::DVec3;
use std::sync::atomic::AtomicBool;

/// A change that must not show in a picture, or only as told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// All lengths times 2^k, k from -1000 to 1000: the same bits, as long as all lengths stay within the supported
    /// [`range`](crate::scene::range).
    PowerOfTwo(i32),
    /// All lengths times a positive factor. One that isn't a power of two rounds every coordinate, so single pixels may differ.
    Scaled(f64),
    /// Everything moved: the same bits. Needs cameras that can be moved without rounding; [`steady`] makes them so.
    Moved(DVec3),
    /// Mirrored along the axis 0, 1 or 2, with the camera: the same bits, left and right exchanged.
    Mirrored(u8),
    /// Turned by 90 degrees about the axis 0, 1 or 2, with the camera: sums of products come in another order, so last bits
    /// may differ.
    Turned(u8),
    /// Objects in another order, drawn by lot from the number: the same bits.
    Shuffled(u64),
    /// All objects within a transform that changes nothing: the same bits.
    Instanced,
    /// Every ray tested against every surface, without the tree: the same bits.
    Treeless,
    /// Another number of threads: the same bits.
    Threads(usize),
    /// Tiles of another size: the same bits.
    Tiles(u32),
    /// A part of the picture: the same bits as there in the whole.
    Cropped(Crop),
}

/// How two pictures differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Pixels compared.
    pub pixels: usize,
    /// Pixels that differ in any bit.
    pub bits: usize,
    /// Pixels of which a channel differs by more than 1/255 after the transfer curve.
    pub beyond_one: usize,
    /// Pixels of which a channel differs by more than 2/255 after the transfer curve.
    pub visible: usize,
    /// The largest difference of a channel after the transfer curve, in 255ths.
    pub codes: f64,
    /// The first pixel that differs in any bit: column and row.
    pub first: Option<(u32, u32)>,
}

impl Difference {
    /// Whether both pictures have the same bits.
    pub fn is_none(&self) -> bool {
        self.bits == 0
    }
    /// The share of pixels that differ by more than 2/255.
    pub fn visible_share(&self) -> f64 {
        self.visible as f64 / self.pixels.max(1) as f64
    }
}

impl Law {
    /// How the picture of the changed scene differs from `before`, the [`picture`] of `scene` with `options`; `None` where the
    /// law says nothing: a camera that can't be moved so without rounding.
    pub fn difference(self, scene: &Scene, options: &Options, before: &Film) -> Option<Difference> {
        let again = |scene: &Scene| compare(before, &picture(scene, options));
        Some(match self {
            Law::PowerOfTwo(k) => again(&scaled(scene, power(k.clamp(-1000, 1000)))),
            Law::Scaled(s) => again(&scaled(scene, s)),
            Law::Moved(by) => again(&moved(scene, by)?),
            Law::Mirrored(axis) => compare(before, &flipped(&picture(&mirrored(scene, axis), options))),
            Law::Turned(axis) => again(&turned(scene, axis)),
            Law::Shuffled(lot) => again(&shuffled(scene, lot)),
            Law::Instanced => again(&instanced(scene)),
            Law::Treeless => {
                let world = World::build(scene, &scene.cameras[0]).without_tree();
                compare(before, &traced(&world, options))
            }
            Law::Threads(n) => compare(before, &picture(scene, &Options { threads: Some(n), ..options.clone() })),
            Law::Tiles(tile) => compare(before, &picture(scene, &Options { tile, ..options.clone() })),
            Law::Cropped(crop) => {
                let part = picture(scene, &Options { crop: Some(crop), ..options.clone() });
                compare(&cut_out(before, crop), &part)
            }
        })
    }
}

/// The picture from the scene's first camera.
pub fn picture(scene: &Scene, options: &Options) -> Film {
    traced(&World::build(scene, &scene.cameras[0]), options)
}

fn traced(world: &World, options: &Options) -> Film {
    match render(world, options, &Silent, &AtomicBool::new(false)) {
        Some(done) => done.film,
        None => unreachable!("nothing cancels it"),
    }
}

/// Compares two pictures; of unlike sizes all pixels differ.
pub fn compare(a: &Film, b: &Film) -> Difference {
    let pixels = a.pixels.len();
    if (a.width, a.height) != (b.width, b.height) {
        return Difference {
            pixels,
            bits: pixels,
            beyond_one: pixels,
            visible: pixels,
            codes: 255.0,
            first: Some((0, 0)),
        };
    }
    let code = |x: f32| encode_srgb((x as f64).clamp(0.0, 1.0)) * 255.0;
    let mut difference = Difference { pixels, bits: 0, beyond_one: 0, visible: 0, codes: 0.0, first: None };
    for (i, (p, q)) in a.pixels.iter().zip(&b.pixels).enumerate() {
        if p.map(f32::to_bits) == q.map(f32::to_bits) {
            continue;
        }
        let i = i as u32;
        difference.first = difference.first.or(Some((i % a.width, i / a.width)));
        difference.bits += 1;
        let worst = p.iter().zip(q).fold(0.0, |m: f64, (x, y)| larger((code(*x) - code(*y)).abs(), m));
        difference.beyond_one += (worst > 1.0) as usize;
        difference.visible += (worst > 2.0) as usize;
        difference.codes = larger(worst, difference.codes);
    }
    difference
}

/// The scene with all lengths times `s`, a positive number: exact where `s` is a power of two.
pub fn scaled(scene: &Scene, s: f64) -> Scene {
    let map = Affine::scaling(DVec3::splat(s));
    let mut scene = placed(scene, &map);
    for camera in &mut scene.cameras {
        (camera.from, camera.at) = (camera.from * s, camera.at * s);
        if let Projection::Orthographic { height } = &mut camera.projection {
            *height *= s;
        }
    }
    scene
}

/// The scene moved by `by`; `None` where a camera can't be moved so without rounding.
pub fn moved(scene: &Scene, by: DVec3) -> Option<Scene> {
    let mut scene = placed(scene, &Affine::translation(by));
    for camera in &mut scene.cameras {
        for p in [&mut camera.from, &mut camera.at] {
            let there = *p + by;
            // Exact where both differences give back what was added: then TwoSum's error is 0.
            if there - by != *p || there - *p != by {
                return None;
            }
            *p = there;
        }
    }
    Some(scene)
}

/// The scene with its cameras' coordinates rounded to multiples of 2^-8, on which a move by whole units of up to 2^44 is
/// exact: another picture, from almost the same place. A camera that is nearer than that to what it looks at stays as it is.
pub fn steady(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    let round = |p: DVec3| (p * 256.0).round() / 256.0;
    for camera in &mut scene.cameras {
        let (from, at) = (round(camera.from), round(camera.at));
        if from != at && (at - from).cross(camera.up) != DVec3::ZERO {
            (camera.from, camera.at) = (from, at);
        }
    }
    scene
}

/// The scene seen from a place beside its cameras' own, by a few thousandths of the distance to what they look at. Cameras
/// at round coordinates see edges of patterns through the very middle of pixels, where any rounding decides.
pub fn beside(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    for Camera { from, at, .. } in &mut scene.cameras {
        // Three numbers without meaning.
        *from += (*at - *from).length() * DVec3::new(0.003_141_59, -0.002_718_28, 0.001_618_03);
    }
    scene
}

/// The scene mirrored along the axis 0, 1 or 2, and its cameras with it: they see it [`flipped`].
pub fn mirrored(scene: &Scene, axis: u8) -> Scene {
    let mut sign = DVec3::ONE.to_array();
    sign[axis.min(2) as usize] = -1.0;
    turned_by(scene, &Affine::scaling(DVec3::from_array(sign)))
}

/// The scene turned by 90 degrees about the axis 0, 1 or 2, and its cameras with it: they see what they saw.
pub fn turned(scene: &Scene, axis: u8) -> Scene {
    turned_by(scene, &Affine::rotation(axis.min(2) as usize, 90.0))
}

/// By a map that exchanges axes and signs, which is exact.
fn turned_by(scene: &Scene, map: &Affine) -> Scene {
    let mut scene = placed(scene, map);
    for camera in &mut scene.cameras {
        for v in [&mut camera.from, &mut camera.at, &mut camera.up] {
            *v = map.apply_vector(*v);
        }
    }
    scene
}

/// The scene within a transform that changes nothing.
pub fn instanced(scene: &Scene) -> Scene {
    placed(scene, &Affine::IDENTITY)
}

/// The scene with its roots and the children of every group in another order, drawn by lot.
pub fn shuffled(scene: &Scene, lot: u64) -> Scene {
    let mut scene = scene.clone();
    let shuffle =
        |ids: &mut Vec<NodeId>| ids.sort_by_cached_key(|id| KeyedHash::new().with(lot).with(id.0 as u64).bits());
    shuffle(&mut scene.roots);
    for node in &mut scene.nodes {
        if let NodeKind::Group(children) = &mut node.kind {
            shuffle(children);
        }
    }
    scene
}

/// The picture with left and right exchanged.
pub fn flipped(film: &Film) -> Film {
    let mut film = film.clone();
    film.pixels.chunks_exact_mut(film.width.max(1) as usize).for_each(<[_]>::reverse);
    film
}

/// The scene with every root below `map`.
fn placed(scene: &Scene, map: &Affine) -> Scene {
    let mut scene = scene.clone();
    let roots = std::mem::take(&mut scene.roots);
    for child in roots {
        let place = scene.node(child).place.clone();
        let kind = NodeKind::Transformed { child, parent_from_child: Box::new(*map) };
        scene.nodes.push(Node { kind, material: None, name: None, place });
        scene.roots.push(NodeId(scene.nodes.len() as u32 - 1));
    }
    scene
}

fn cut_out(film: &Film, crop: Crop) -> Film {
    let mut part = Film::new(crop.width, crop.height);
    let rows = film.pixels.chunks_exact(film.width.max(1) as usize).skip(crop.y as usize);
    for (to, from) in part.pixels.chunks_exact_mut(crop.width.max(1) as usize).zip(rows) {
        to.copy_from_slice(&from[crop.x as usize..(crop.x + crop.width) as usize]);
    }
    part
}
