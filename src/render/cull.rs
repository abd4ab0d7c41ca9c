//! Regions of space that a batch of rays stays in: what lies outside needs no test. Every test errs on the side of keeping, so
//! culling never changes a pixel.

use super::bounds::{Bounds, larger};

/// Relative margin of every comparison here: 2^-40, thousands of roundings of `f64`, and nothing to the sizes of boxes.
const MARGIN: f64 = 1.0 / (1u64 << 40) as f64;

/// The same for batches traced in `f32`, whose directions are off by up to 2^-23.
const MARGIN_F32: f64 = 1.0 / (1u64 << 16) as f64;

/// The margin for a precision's unit roundoff.
pub fn margin(unit_roundoff: f64) -> f64 {
    if unit_roundoff > f64::EPSILON { MARGIN_F32 } else { MARGIN }
}

/// A convex region bounded by planes n·p ≥ offset.
#[derive(Clone, Debug)]
pub struct Frustum {
    planes: [([f64; 3], f64); 5],
    margin: f64,
}

impl Frustum {
    /// The region between planes given by an inward normal and a point of each.
    pub fn new(planes: [([f64; 3], [f64; 3]); 5], margin: f64) -> Frustum {
        Frustum { planes: planes.map(|(n, p)| (n, dot(n, p))), margin }
    }
    /// Whether the box may reach into it.
    #[inline]
    pub fn may_meet(&self, b: &Bounds) -> bool {
        self.planes.iter().all(|&(n, offset)| {
            // A face near by is no better than the far one of the same box: a kernel's numbers are centre and size.
            let size = size_along(b, n) + offset.abs();
            dot(n, b.support(n)) - offset >= -self.margin * size
        })
    }
}

/// All segments from points of a box to one point: what can stand between a light and a batch of hits.
#[derive(Clone, Debug)]
pub struct Shaft {
    hull: Bounds,
    cone: Cone,
    /// No point of the box is further from the light.
    reach: f64,
    margin: f64,
}

impl Shaft {
    /// From the light to every point of `points`.
    pub fn new(points: &Bounds, light: [f64; 3], margin: f64) -> Shaft {
        let to = minus(points.centre(), light);
        let (distance, radius) = (length(to), points.radius());
        // A ray's start and direction are rounded: one from far away misses the light by as much, and may meet what is beside it.
        let astray = margin * (distance + radius + length(light));
        let cone = Cone::around(light, astray, to, radius, margin);
        let hull = widened(points.with(light), margin);
        let hull = Bounds { lo: hull.lo.map(|x| x - astray), hi: hull.hi.map(|x| x + astray) };
        Shaft { hull, cone, reach: (distance + radius) * (1.0 + margin), margin }
    }
    /// Whether the box may reach into it.
    #[inline]
    pub fn may_meet(&self, b: &Bounds) -> bool {
        if !self.hull.overlaps(&widened(*b, self.margin)) {
            return false;
        }
        let (to, radius) = (minus(b.centre(), self.cone.apex), b.radius());
        let furthest = self.reach + radius;
        // The distance's square is as good to compare, by twice the margin.
        dot(to, to) * (1.0 - 2.0 * self.margin) <= furthest * furthest && self.cone.may_meet_ball(to, radius)
    }
    /// Whether the plane n·p = offset may come between the light and a point of the box.
    pub fn may_cross(&self, points: &Bounds, n: [f64; 3], offset: f64) -> bool {
        let light = dot(n, self.cone.apex) - offset;
        let (lo, hi) = plane_range(points, n, offset);
        let slack = self.margin * (size_along(points, n) + size_of_dot(n, self.cone.apex) + offset.abs());
        !((light > slack && lo > slack) || (light < -slack && hi < -slack))
    }
}

/// A cone of directions from anywhere in a ball: the rays of a batch that was mirrored or refracted.
#[derive(Clone, Debug)]
pub struct Cone {
    apex: [f64; 3],
    /// Radius of the ball around `apex` that rays start in.
    origin_radius: f64,
    axis: [f64; 3],
    /// Cosine and sine of the half-angle; (-1, 0) for all directions.
    cos: f64,
    sin: f64,
    margin: f64,
}

impl Cone {
    /// Rays from the ball around `apex` whose directions make a cosine of at least `cos` with the unit vector `axis`.
    pub fn of_directions(apex: [f64; 3], origin_radius: f64, axis: [f64; 3], cos: f64, margin: f64) -> Cone {
        let cos = cos - margin;
        if !(cos > -1.0) || !(length(axis) > 0.5) {
            return Cone { apex, origin_radius, axis: [0.0; 3], cos: -1.0, sin: 0.0, margin };
        }
        Cone { apex, origin_radius, axis, cos, sin: larger(1.0 - cos * cos, 0.0).sqrt(), margin }
    }

    /// From `apex` to every point of the ball of `radius` around `apex + to`.
    fn around(apex: [f64; 3], origin_radius: f64, to: [f64; 3], radius: f64, margin: f64) -> Cone {
        let distance = length(to);
        if !(radius < distance) {
            return Cone::of_directions(apex, origin_radius, [0.0; 3], -1.0, margin);
        }
        let s = radius / distance;
        Cone::of_directions(apex, origin_radius, to.map(|x| x / distance), larger(1.0 - s * s, 0.0).sqrt(), margin)
    }

    fn is_everything(&self) -> bool {
        self.cos <= -1.0
    }

    /// Whether a ray of it may reach the ball of `radius` around `apex + to`: the angle between axis and ball must be at most
    /// the sum of both half-angles.
    #[inline]
    fn may_meet_ball(&self, to: [f64; 3], radius: f64) -> bool {
        let (square, reach) = (dot(to, to), (radius + self.origin_radius) * (1.0 + self.margin));
        if self.is_everything() || !(reach * reach < square) {
            return true;
        }
        // Cosine and sine of the ball's half-angle, times its distance: no quotient, and one root.
        let (cos, sin) = ((square - reach * reach).sqrt(), reach);
        // The sum of the angles passes half a turn where the sine of it turns negative.
        if self.sin * cos + self.cos * sin < 0.0 {
            return true;
        }
        let at_least_distance = to[0].abs() + to[1].abs() + to[2].abs();
        dot(self.axis, to) >= self.cos * cos - self.sin * sin - self.margin * at_least_distance
    }

    /// Whether a ray of it may reach the box.
    #[inline]
    pub fn may_meet(&self, b: &Bounds) -> bool {
        self.may_meet_ball(minus(b.centre(), self.apex), b.radius())
    }

    /// Whether a ray of it that starts in `origins` may reach the plane n·p = offset, n of unit length.
    pub fn may_reach(&self, origins: &Bounds, n: [f64; 3], offset: f64) -> bool {
        if self.is_everything() {
            return true;
        }
        let (lo, hi) = plane_range(origins, n, offset);
        let slack = self.margin * (size_along(origins, n) + offset.abs());
        let along = dot(self.axis, n);
        let across = larger(1.0 - along * along, 0.0).sqrt();
        // Smallest and largest n·d over the cone, where it stays on one side of the plane's direction.
        let (least, most) = (along * self.cos - across * self.sin, along * self.cos + across * self.sin);
        let narrow = self.cos > self.margin;
        let leaves_above = lo > slack && narrow && least > self.margin && along > 0.0;
        let leaves_below = hi < -slack && narrow && most < -self.margin && along < 0.0;
        !(leaves_above || leaves_below)
    }
}

fn plane_range(b: &Bounds, n: [f64; 3], offset: f64) -> (f64, f64) {
    (dot(n, b.support(n.map(|x| -x))) - offset, dot(n, b.support(n)) - offset)
}

fn size_along(b: &Bounds, n: [f64; 3]) -> f64 {
    (0..3).map(|i| n[i].abs() * larger(b.lo[i].abs(), b.hi[i].abs())).sum()
}

fn size_of_dot(n: [f64; 3], p: [f64; 3]) -> f64 {
    (0..3).map(|i| (n[i] * p[i]).abs()).sum()
}

#[inline]
fn widened(b: Bounds, margin: f64) -> Bounds {
    let reach: [f64; 3] = std::array::from_fn(|i| margin * larger(b.lo[i].abs(), b.hi[i].abs()));
    Bounds { lo: std::array::from_fn(|i| b.lo[i] - reach[i]), hi: std::array::from_fn(|i| b.hi[i] + reach[i]) }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::hash::KeyedHash;

    fn random(i: u64, k: u64) -> f64 {
        KeyedHash::new().with(i).with(k).unit() * 20.0 - 10.0
    }
    fn point(i: u64, k: u64) -> [f64; 3] {
        [random(i, k), random(i, k + 1), random(i, k + 2)]
    }

    #[test]
    fn a_shaft_keeps_every_box_that_a_segment_touches() {
        let (mut kept, mut dropped) = (0, 0);
        for i in 0..4000 {
            let points = Bounds::around(point(i, 0), [1.0; 3]);
            let light = point(i, 10);
            let shaft = Shaft::new(&points, light, MARGIN);
            let b = Bounds::around(point(i, 20), [0.3; 3]);
            let touched = (0..200).any(|k| {
                let on = |a: usize| {
                    points.lo[a] + (points.hi[a] - points.lo[a]) * (random(i, 100 + 5 * k + a as u64) + 10.0) / 20.0
                };
                let s = (random(i, 104 + 5 * k) + 10.0) / 20.0;
                let p: [f64; 3] = std::array::from_fn(|a| light[a] + s * (on(a) - light[a]));
                b.overlaps(&Bounds { lo: p, hi: p })
            });
            assert!(!touched || shaft.may_meet(&b), "case {i}");
            if shaft.may_meet(&b) { kept += 1 } else { dropped += 1 }
        }
        assert!(kept > 50 && dropped > 2000, "{kept} {dropped}");
    }

    #[test]
    fn a_ray_from_far_away_may_miss_the_light_by_its_rounding() {
        for far in [1e3, 1e9, 1e15] {
            let shaft = Shaft::new(&Bounds::around([far; 3], [0.0; 3]), [1.0; 3], MARGIN);
            let beside = |by: f64| Bounds::around([1.0 + by, 1.0 - by, 1.0], [0.0; 3]);
            assert!(shaft.may_meet(&beside(8.0 * f64::EPSILON * far)), "{far}");
            assert!(!shaft.may_meet(&beside(1e-8 * far)), "{far}: no more than that");
        }
    }

    #[test]
    fn a_cone_keeps_every_box_that_a_ray_meets() {
        let mut dropped = 0;
        for i in 0..4000 {
            let axis = point(i, 0);
            let axis = axis.map(|x| x / length(axis));
            let cos = 0.2 + 0.8 * (random(i, 4) + 10.0) / 20.0;
            let cone = Cone::of_directions(point(i, 5), 0.5, axis, cos, MARGIN);
            let b = Bounds::around(point(i, 20), [0.5; 3]);
            let met = (0..100).any(|k| {
                let d = point(i, 1000 + 10 * k);
                let d: [f64; 3] = std::array::from_fn(|a| axis[a] + 0.08 * d[a]);
                let d = d.map(|x| x / length(d));
                if dot(d, axis) < cos {
                    return false;
                }
                (0..60).any(|s| {
                    let p: [f64; 3] = std::array::from_fn(|a| cone.apex[a] + d[a] * s as f64 * 0.4);
                    b.overlaps(&Bounds { lo: p, hi: p })
                })
            });
            assert!(!met || cone.may_meet(&b), "case {i}");
            dropped += !cone.may_meet(&b) as u32;
        }
        assert!(dropped > 1000, "{dropped}");
    }
}
