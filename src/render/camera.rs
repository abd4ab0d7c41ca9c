//! From pixels to rays.

use super::bounds::{larger, smaller};
use super::cull::Frustum;
use super::options::Options;
use super::place::unit;
use crate::math::Real;
use crate::math::fun::tan_deg;
use crate::math::real::{each3, three};
use crate::scene::{Camera, Projection};
use glam::DVec3;

/// The camera's axes, and how much of space it sees. The camera stands at the origin.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraFrame {
    right: [f64; 3],
    up: [f64; 3],
    forward: [f64; 3],
    /// Perspective: half the picture's height at distance 1. Orthographic: half its height in space.
    half_height: f64,
    parallel: bool,
}

/// The camera for a picture of a given size: pixel (x, y) looks along `forward + right·sx + up·sy`, with
/// sx = (x − width/2)·step and sy = (height/2 − y)·step, one rounding each before the product.
#[derive(Clone, Debug)]
pub struct PixelGrid<'c> {
    camera: &'c CameraFrame,
    half_width: f64,
    half_height: f64,
    step: f64,
}

impl CameraFrame {
    /// The frame of a scene's camera: right-handed, y up, looking along −z when nothing is turned.
    pub fn new(camera: &Camera) -> CameraFrame {
        let forward = unit(camera.at - camera.from);
        let right = unit(forward.cross(unit(camera.up)));
        let up = right.cross(forward);
        let (half_height, parallel) = match camera.projection {
            Projection::Perspective { fov } => (tan_deg(fov * 0.5), false),
            Projection::Orthographic { height } => (height * 0.5, true),
        };
        CameraFrame { right: exact(right), up: exact(up), forward: exact(forward), half_height, parallel }
    }

    /// Whether every ray starts exactly at the origin.
    pub fn at_eye(&self) -> bool {
        !self.parallel
    }

    /// Laid over a picture.
    pub fn grid(&self, options: &Options) -> PixelGrid<'_> {
        PixelGrid {
            camera: self,
            half_width: 0.5 * options.width as f64,
            half_height: 0.5 * options.height as f64,
            step: 2.0 * self.half_height / options.height as f64,
        }
    }
}

/// -0 is 0: a camera that isn't turned has exact axes.
fn exact(v: DVec3) -> [f64; 3] {
    v.to_array().map(|x| x + 0.0)
}

impl PixelGrid<'_> {
    /// How far right the picture's column `x` looks.
    #[inline(always)]
    pub fn across<R: Real>(&self, x: R) -> R {
        (x - R::splat(self.half_width)) * R::splat(self.step)
    }

    /// How far up the picture's row `y` looks.
    #[inline(always)]
    fn up<R: Real>(&self, y: R) -> R {
        (R::splat(self.half_height) - y) * R::splat(self.step)
    }

    /// What rays through row `y` have in common: (`right`, `base`) such that one that looks `sx` to the right (see
    /// [`across`](PixelGrid::across)) is right·sx + base, its direction, or its origin where rays are parallel.
    #[inline(always)]
    pub fn row(&self, y: f64) -> ([f64; 3], [f64; 3]) {
        let (c, sy) = (self.camera, self.up(y));
        let from = if c.parallel { [0.0; 3] } else { c.forward };
        (c.right, three!(i => c.up[i].mul_add(sy, from[i])))
    }

    /// The direction that all rays have where they are parallel.
    pub fn forward(&self) -> [f64; 3] {
        self.camera.forward
    }

    /// Origin and direction of the ray through the point (x, y) of the picture, in pixels from its upper left corner.
    #[inline(always)]
    pub fn ray<R: Real>(&self, x: R, y: R) -> ([R; 3], [R; 3]) {
        let (c, sx, sy) = (self.camera, self.across(x), self.up(y));
        let from = if c.parallel { [0.0; 3] } else { c.forward };
        let to = three!(i => R::splat(c.right[i]).mul_add(sx, R::splat(c.up[i]).mul_add(sy, R::splat(from[i]))));
        if c.parallel { (to, each3!(c.forward, x => R::splat(x))) } else { ([R::zero(); 3], to) }
    }

    /// The region that rays through the rectangle from (x0, y0) to (x1, y1) stay in.
    pub fn frustum(&self, [x0, y0, x1, y1]: [f64; 4], margin: f64) -> Frustum {
        let c = self.camera;
        let corner = |x: f64, y: f64| self.ray::<f64>(x, y);
        let v = DVec3::from_array;
        let (right, up, forward) = (v(c.right), v(c.up), v(c.forward));
        let side = |(o, d): ([f64; 3], [f64; 3]), along: DVec3, inward: DVec3| {
            // Spanned by the corner's ray and the picture's edge; turned to the side that looks inwards.
            let n = v(d).cross(along);
            let n = if n.dot(inward) < 0.0 { -n } else { n };
            (unit(n).to_array(), o)
        };
        Frustum::new(
            [
                side(corner(x0, y0), up, right),
                side(corner(x1, y0), up, -right),
                side(corner(x0, y0), right, -up),
                side(corner(x0, y1), right, up),
                (forward.to_array(), [0.0; 3]),
            ],
            margin,
        )
    }

    /// Whether a ray through the rectangle may meet the plane n·p = offset, n of unit length.
    pub fn may_meet_plane(&self, [x0, y0, x1, y1]: [f64; 4], n: [f64; 3], offset: f64, margin: f64) -> bool {
        let dot = |a: [f64; 3]| a[0] * n[0] + a[1] * n[1] + a[2] * n[2];
        // Height above the plane and its change along the ray are linear over the picture: their extremes lie at corners.
        let (mut height, mut change) = ([f64::INFINITY, f64::NEG_INFINITY], [f64::INFINITY, f64::NEG_INFINITY]);
        let mut size = offset.abs();
        let mut longest = 0.0;
        for (x, y) in [(x0, y0), (x1, y0), (x0, y1), (x1, y1)] {
            let (o, d) = self.ray::<f64>(x, y);
            let (h, s) = (dot(o) - offset, dot(d));
            height = [smaller(h, height[0]), larger(h, height[1])];
            change = [smaller(s, change[0]), larger(s, change[1])];
            size = larger(size, o.iter().map(|x| x.abs()).sum());
            longest = larger(longest, d.iter().map(|x| x.abs()).sum());
        }
        let (above, below) = (height[0] > margin * size, height[1] < -margin * size);
        !((above && change[0] > margin * longest) || (below && change[1] < -margin * longest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Settings;

    fn grid_of(camera: &Camera) -> (CameraFrame, Options) {
        let options = Options::from_settings(&Settings { width: 4, height: 2, ..Settings::default() });
        (CameraFrame::new(camera), options)
    }

    #[test]
    fn the_middle_looks_at_the_target_and_up_is_up() {
        let camera = Camera {
            from: DVec3::ZERO,
            at: DVec3::new(0.0, 0.0, -5.0),
            projection: Projection::Perspective { fov: 90.0 },
            ..Camera::default()
        };
        let (frame, options) = grid_of(&camera);
        let grid = frame.grid(&options);
        assert_eq!(grid.ray::<f64>(2.0, 1.0), ([0.0; 3], [0.0, 0.0, -1.0]));
        assert_eq!(grid.ray::<f64>(2.0, 0.0).1, [0.0, 1.0, -1.0], "90 degrees from top to bottom");
        assert_eq!(grid.ray::<f64>(4.0, 1.0).1, [2.0, 0.0, -1.0]);
    }

    #[test]
    fn parallel_rays_start_on_the_picture() {
        let camera = Camera {
            from: DVec3::new(7.0, 0.0, 0.0),
            at: DVec3::new(7.0, 0.0, -5.0),
            projection: Projection::Orthographic { height: 10.0 },
            ..Camera::default()
        };
        let (frame, options) = grid_of(&camera);
        assert_eq!(frame.grid(&options).ray::<f64>(4.0, 2.0), ([10.0, -5.0, 0.0], [0.0, 0.0, -1.0]));
    }
}
