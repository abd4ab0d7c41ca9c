//! Crossings with shapes of extreme proportions, kept to their boxes.
//!
//! A kernel's error grows with the proportions of its shape: on a cone of radius 1 and height 1e-17 it may see a crossing far from
//! where the cone is. Then it would depend on the other rays of a tile, and on the order in which boxes are looked at, whether
//! that is tested at all. So of such shapes a ray's crossings are where the ray is in the shape's box, or nowhere: whatever else
//! is skipped for lying elsewhere changes nothing.

use super::bounds::{Bounds, larger, smaller};
use super::shape::Visit;
use super::slabs::Slabs;
use crate::math::real::splat3;
use crate::math::{Affine, Real};

/// Extents whose largest is this many times the smallest, or more, are extreme. Well within what the kernels are right for, so that none
/// whose error could matter is left out, and beyond what most shapes are, which pay nothing.
const EXTREME: f64 = 256.0;

/// Whether kernels may see crossings with a shape far from its box: its half sizes in its frame, and the map of that to the world.
pub fn is_extreme(half: [f64; 3], world_from_local: &Affine) -> bool {
    let m = world_from_local.linear_f64();
    let columns: [f64; 3] = std::array::from_fn(|c| largest(m.map(|row| row[c])));
    let is_moderate = |sizes: [f64; 3]| {
        let least = sizes.into_iter().filter(|s| *s != 0.0).fold(f64::INFINITY, smaller); // a disc is flat for certain
        largest(sizes) < EXTREME * least
    };
    !(is_moderate(half) && is_moderate(std::array::from_fn(|i| half[i] * columns[i])) && !is_thin(m, largest(columns)))
}

fn largest(v: [f64; 3]) -> f64 {
    v.into_iter().map(f64::abs).fold(0.0, larger)
}

/// Whether a map, the magnitude of whose largest number is `size`, makes a thin thing of a cube: its inverse is that much longer then.
fn is_thin(m: [[f64; 3]; 3], size: f64) -> bool {
    let m = m.map(|row| row.map(|x| x / size));
    let minor = |r: usize, c: usize| {
        let (r1, r2, c1, c2) = ((r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3);
        m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1]
    };
    let minors: [[f64; 3]; 3] = std::array::from_fn(|r| std::array::from_fn(|c| minor(r, c)));
    let determinant: f64 = (0..3).map(|c| m[0][c] * minors[0][c]).sum();
    // A rotation's are all of the same size; NaN is thin, too.
    !(largest(minors.map(largest)) < EXTREME * determinant.abs())
}

/// Shows only crossings of some rays, and only within a box.
pub struct Confined<'v, R: Real, V> {
    visit: &'v mut V,
    /// The rays. What a kernel makes of others doesn't count: whether it is asked depends on the rays beside them.
    met: R::Mask,
    /// From which t to which; the first above the second where the box is missed. `None` where nothing is confined.
    stay: Option<(R, R)>,
}

impl<'v, R: Real, V: Visit<R>> Confined<'v, R, V> {
    /// Crossings of the rays of `met`, from `o` along `d`, within `bounds`, if there are any.
    #[inline(always)]
    pub fn new(met: R::Mask, bounds: Option<&Bounds>, (o, d): ([R; 3], [R; 3]), visit: &'v mut V) -> Self {
        // No `Option::map`: its closure may be compiled without the lanes' instructions.
        let mut stay = None;
        if let Some(b) = bounds {
            stay = Some(Slabs::narrow(o, d).stay_near([splat3(b.lo), splat3(b.hi)]));
        }
        Confined { visit, met, stay }
    }
}

impl<R: Real, V: Visit<R>> Visit<R> for Confined<'_, R, V> {
    #[inline(always)]
    fn crossing(&mut self, t: R, part: R, valid: R::Mask) {
        let valid = valid & self.met;
        match self.stay {
            None => self.visit.crossing(t, part, valid),
            // Not left out where it is before or after its stay: a hole would be worse than a rounding error.
            Some((enter, leave)) => self.visit.crossing(t.max(enter).min(leave), part, valid & enter.le(leave)),
        }
    }
    #[inline(always)]
    fn needs_further(&self, t: R, valid: R::Mask) -> R::Mask {
        match self.stay {
            None => self.visit.needs_further(t, valid & self.met),
            Some(_) => self.met, // what is shown is another t
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn proportions_are_extreme_however_they_came_about() {
        let scaled = |x: f64, y: f64, z: f64| Affine::scaling(DVec3::new(x, y, z));
        assert!(!is_extreme([1.0, 0.0, 1.0], &Affine::IDENTITY), "a disc");
        assert!(!is_extreme([1.0, 100.0, 1.0], &scaled(1e-140, 1e-140, 1e-140)));
        assert!(is_extreme([1.0, 1e3, 1.0], &Affine::IDENTITY));
        assert!(is_extreme([1.0; 3], &scaled(1.0, 1e-38, 2.0)));
        assert!(is_extreme([1.0, 1e3, 1.0], &scaled(1.0, 1e-3, 1.0)), "the frame of it is thin");
        assert!(is_extreme([1.0; 3], &scaled(1.0, 1e-3, 1.0).compose(&Affine::rotation(0, 45.0))), "sheared");
        assert!(!is_extreme([1.0; 3], &Affine::rotation(0, 37.0).compose(&scaled(5.0, 1.0, -0.1))));
    }

    #[test]
    fn a_crossing_is_where_its_box_is_or_nowhere() {
        use crate::math::real::Bool;
        let bounds = Bounds { lo: [-1.0, -1.0, 4.0], hi: [1.0, 1.0, 6.0] };
        let seen = |d: [f64; 3], t: f64| {
            let mut seen = Vec::new();
            let mut visit = |t: f64, _: f64, valid: Bool| seen.push((t, valid.0));
            Confined::new(Bool(true), Some(&bounds), ([0.0; 3], d), &mut visit).crossing(t, 0.0, Bool(true));
            seen[0]
        };
        assert_eq!(seen([0.0, 0.0, 1.0], 5.0), (5.0, true));
        assert!((seen([0.0, 0.0, 1.0], 1.0).0 - 4.0).abs() < 1e-12, "too early");
        assert!((seen([0.0, 0.0, 1.0], 1e9).0 - 6.0).abs() < 1e-12, "too late");
        assert!(!seen([0.0, 1.0, 0.0], 5.0).1, "the box is missed");
    }
}
