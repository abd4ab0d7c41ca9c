//! The rays that a filtered pixel is made of, where every pixel has a grid of them: its own and its neighbours', each with its
//! weight. Rays are shared, so a pixel of a 4 × 4 grid is made of up to 16 × 16.

use super::filter::Kernel;
use super::options::{Crop, Options};

/// The weights of a grid, by the number of the ray along an axis within its pixel.
pub struct Taps {
    each: Vec<Tap>,
}

/// The rays of one number along an axis: of neighbours one after another.
pub struct Tap {
    /// How many pixels on the first of them is, negative before.
    pub first: i32,
    /// Their weights; those of all numbers together are 1.
    pub weights: Vec<f64>,
}

impl Taps {
    /// For a grid of `side` rays along each side of a pixel.
    pub fn new(kernel: &Kernel, side: u32) -> Taps {
        let reach = kernel.radius().ceil() as i32;
        // From the pixel's middle: exact, and as far to both sides, for every grid whose side is a power of two.
        let at = |number: u32, pixel: i32| kernel.at(pixel as f64 + ((number as f64 + 0.5) / side as f64 - 0.5));
        let all: f64 = (0..side).map(|k| (-reach..=reach).map(|p| at(k, p)).sum::<f64>()).sum();
        let tap = |k: u32| {
            let counts: Vec<i32> = (-reach..=reach).filter(|p| at(k, *p) != 0.0).collect();
            let first = counts.first().copied().unwrap_or(0);
            let last = counts.last().copied().unwrap_or(0);
            Tap { first, weights: (first..=last).map(|p| at(k, p) / all).collect() }
        };
        Taps { each: (0..side).map(tap).collect() }
    }

    /// Those of ray number `k`.
    pub fn of(&self, k: u32) -> &Tap {
        &self.each[k as usize]
    }

    /// Those of a picture; `None` where pixels have no rays of others: with the box, or of one ray each.
    pub fn of_picture(options: &Options) -> Option<Taps> {
        let side = options.aa.side();
        Kernel::of(options.filter).filter(|_| side > 1).map(|kernel| Taps::new(&kernel, side))
    }

    /// The rectangle in which all rays of a tile's pixels lie: left, top, right, bottom.
    pub fn rect(&self, tile: Crop) -> [f64; 4] {
        let [before, behind] = self.reach().map(f64::from);
        let (x, y) = (tile.x as f64, tile.y as f64);
        [x - before, y - before, x + (tile.width as f64 + behind), y + (tile.height as f64 + behind)]
    }

    /// The pixels whose rays (sx, sy) a tile's pixels are made of: left and top of the first, columns and rows.
    pub fn patch(&self, tile: Crop, [sx, sy]: [u32; 2]) -> ([f64; 2], [usize; 2]) {
        let (across, down) = (self.of(sx), self.of(sy));
        let at = [tile.x as f64 + across.first as f64, tile.y as f64 + down.first as f64];
        let size = [(tile.width, across), (tile.height, down)].map(|(own, tap)| own as usize + tap.weights.len() - 1);
        (at, size)
    }

    /// By how many pixels rays lie before and behind.
    fn reach(&self) -> [u32; 2] {
        let before = self.each.iter().map(|t| -t.first).max().unwrap_or(0);
        let behind = self.each.iter().map(|t| t.first + t.weights.len() as i32 - 1).max().unwrap_or(0);
        [before, behind].map(|n| n.max(0) as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::certify::tests::every_shape;
    use crate::render::certify::{Target, certify, code};
    use crate::render::{Instructions, Silent, World, render};
    use crate::scene::*;
    use glam::DVec3;
    use std::sync::atomic::AtomicBool;

    #[test]
    fn weights_are_one_together_and_symmetric() {
        for (filter, reach) in [(PixelFilter::Mitchell, 2), (PixelFilter::Gauss, 1)] {
            let kernel = Kernel::of(filter).unwrap();
            for side in 2..=32 {
                let taps = Taps::new(&kernel, side);
                assert_eq!(taps.reach(), [reach; 2], "{filter:?} {side}");
                let all: f64 = taps.each.iter().flat_map(|t| &t.weights).sum();
                assert!((all - 1.0).abs() < 1e-14);
                for k in 0..side {
                    let (a, b) = (taps.of(k), taps.of(side - 1 - k));
                    assert_eq!(a.first, -(b.first + b.weights.len() as i32 - 1), "{filter:?} {side} {k}");
                    assert!(a.weights.iter().zip(b.weights.iter().rev()).all(|(a, b)| (a - b).abs() < 1e-15));
                }
            }
        }
    }

    #[test]
    fn a_ramp_stays_where_it_is() {
        let kernel = Kernel::of(PixelFilter::Mitchell).unwrap();
        let taps = Taps::new(&kernel, 4);
        let place = |k: u32, i: usize| (taps.of(k).first + i as i32) as f64 + (k as f64 + 0.5) / 4.0 - 0.5;
        let sum = |f: &dyn Fn(f64) -> f64| {
            let of = |k: u32| taps.of(k).weights.iter().enumerate().map(move |(i, w)| (place(k, i), *w));
            (0..4).flat_map(of).map(|(u, w)| f(u) * w).sum::<f64>()
        };
        assert!(sum(&|u| u).abs() < 1e-15);
        // As wide as the cubic itself: B/3 of its third of blur.
        assert!((sum(&|u| u * u) - 1.0 / 9.0).abs() < 1e-2, "{}", sum(&|u| u * u));
    }

    static NEVER: AtomicBool = AtomicBool::new(false);

    fn picture(scene: &Scene, options: &Options) -> Vec<[f32; 3]> {
        let world = World::build(scene, &scene.cameras[0]);
        render(&world, options, &Silent, &NEVER).unwrap().film.pixels
    }

    fn filtered(scene: &Scene, filter: PixelFilter, aa: AntiAliasing) -> Options {
        Options { width: 40, height: 24, aa, filter, threads: Some(1), ..Options::from_settings(&scene.settings) }
    }

    const WAYS: [AntiAliasing; 3] = [AntiAliasing::Grid(2), AntiAliasing::Grid(5), AntiAliasing::Adaptive(20)];

    #[test]
    fn tiles_threads_parts_and_instructions_change_no_bit() {
        let scene = every_shape();
        for filter in [PixelFilter::Mitchell, PixelFilter::Gauss] {
            for aa in WAYS {
                let base = filtered(&scene, filter, aa);
                let whole = picture(&scene, &base);
                for tile in [1, 3, 7] {
                    assert!(whole == picture(&scene, &Options { tile, ..base.clone() }), "{filter:?} {aa:?} {tile}");
                }
                assert!(whole == picture(&scene, &Options { threads: Some(3), ..base.clone() }));
                assert!(whole == picture(&scene, &Options { instructions: Instructions::Common, ..base.clone() }));
                for (x, y) in [(0, 0), (11, 5), (23, 13)] {
                    let crop = Crop { x, y, width: 17, height: 11 };
                    let part = picture(&scene, &Options { crop: Some(crop), ..base.clone() });
                    let rows = whole.chunks(40).skip(y as usize).take(11);
                    let expected: Vec<_> = rows.flat_map(|row| &row[x as usize..][..17]).copied().collect();
                    assert!(part == expected, "{filter:?} {aa:?} from ({x}, {y})");
                }
            }
        }
    }

    #[test]
    fn one_ray_a_pixel_is_shown_as_it_is_and_the_box_is_the_mean() {
        let scene = every_shape();
        for aa in [AntiAliasing::Off, AntiAliasing::Grid(1)] {
            let plain = picture(&scene, &filtered(&scene, PixelFilter::Box, aa));
            assert!(plain == picture(&scene, &filtered(&scene, PixelFilter::Mitchell, aa)));
        }
        for aa in WAYS {
            let plain = picture(&scene, &filtered(&scene, PixelFilter::Box, aa));
            assert!(plain != picture(&scene, &filtered(&scene, PixelFilter::Gauss, aa)));
        }
    }

    #[test]
    fn what_is_the_same_everywhere_stays_so() {
        let mut scene = Scene::empty();
        scene.background = Color([0.1, 0.7, 1.0 / 3.0]);
        for filter in [PixelFilter::Mitchell, PixelFilter::Gauss] {
            for aa in WAYS {
                for precision in [Precision::F64, Precision::F32] {
                    let options = Options { precision, ..filtered(&scene, filter, aa) };
                    let wanted = scene.background.0.map(|x| x as f32);
                    assert!(picture(&scene, &options).iter().all(|p| *p == wanted), "{filter:?} {aa:?} {precision:?}");
                }
            }
        }
        // A wall that fills the picture.
        scene.materials[0].ambient = scene.materials[0].color;
        scene.ambient = Color([0.9, 0.3, 0.2]);
        let place = crate::diag::Place::new(crate::diag::Span::new(crate::diag::FileId(0), 0..1));
        let wall = Shape::Plane { through: DVec3::new(0.0, 0.0, -5.0), normal: DVec3::Z };
        scene.nodes.push(Node { kind: NodeKind::Shape(wall), material: None, name: None, place });
        scene.roots.push(NodeId(0));
        scene.cameras[0] = Camera { from: DVec3::ZERO, at: -DVec3::Z, ..Camera::default() };
        let one = picture(&scene, &filtered(&scene, PixelFilter::Box, AntiAliasing::Off))[0];
        for filter in [PixelFilter::Mitchell, PixelFilter::Gauss] {
            for aa in WAYS {
                let all = picture(&scene, &filtered(&scene, filter, aa));
                assert!(all.iter().all(|p| *p == all[0]), "{filter:?} {aa:?}");
                assert!((0..3).all(|c| (all[0][c] - one[c]).abs() <= f32::EPSILON * one[c]), "{:?} {one:?}", all[0]);
            }
        }
    }

    #[test]
    fn a_mirrored_scene_gives_the_mirrored_picture() {
        // A cylinder along the view and a ball above it, on both sides of the middle.
        let mut scene = every_shape();
        scene.roots.clear();
        scene.nodes.clear();
        for (x, y, r) in [(4.0, 0.0, 2.0), (-4.0, 0.0, 2.0), (0.0, 2.0, 1.5)] {
            let place = crate::diag::Place::new(crate::diag::Span::new(crate::diag::FileId(0), 0..1));
            let ball = Shape::Sphere { at: DVec3::new(x, y, -30.0), r };
            scene.nodes.push(Node { kind: NodeKind::Shape(ball), material: None, name: None, place });
            scene.roots.push(NodeId(scene.nodes.len() as u32 - 1));
        }
        for filter in [PixelFilter::Mitchell, PixelFilter::Gauss] {
            for n in [2, 3, 4] {
                let all = picture(&scene, &filtered(&scene, filter, AntiAliasing::Grid(n)));
                let mut edges = 0;
                for row in all.chunks(40) {
                    for (a, b) in row.iter().zip(row.iter().rev()) {
                        // Sums in another order.
                        assert!(
                            (0..3).all(|c| (a[c] - b[c]).abs() <= 4.0 * f32::EPSILON),
                            "{filter:?} {n}: {a:?} {b:?}"
                        );
                        edges += (a != &row[0]) as u32;
                    }
                }
                assert!(edges > 100);
            }
        }
    }

    #[test]
    fn many_rays_come_to_the_filtered_value() {
        let scene = every_shape();
        let world = World::build(&scene, &scene.cameras[0]);
        for filter in [PixelFilter::Mitchell, PixelFilter::Gauss] {
            let options = filtered(&scene, filter, AntiAliasing::Grid(16));
            let truth = certify(&world, &options, &Target { quantum: 0.0, samples: 4096, ..Target::new(1.0) });
            let off = |aa| {
                let pixels = picture(&scene, &filtered(&scene, filter, aa));
                let each = pixels.iter().zip(&truth).map(|(p, t)| {
                    let off = |c: usize| code(p[c] as f64) - code(t.value[c]);
                    (0..3).map(|c| off(c) * off(c)).sum::<f64>()
                });
                (each.sum::<f64>() / (3 * truth.len()) as f64).sqrt()
            };
            let [two, sixteen, adaptive] =
                [AntiAliasing::Grid(2), AntiAliasing::Grid(16), AntiAliasing::Adaptive(1024)].map(off);
            // The truth is one to a code itself.
            assert!(sixteen < 0.2 * two && sixteen < 1.0, "{filter:?}: {two} {sixteen}");
            assert!(adaptive < 0.3 * two, "{filter:?}: {two} {adaptive}");
        }
    }
}
