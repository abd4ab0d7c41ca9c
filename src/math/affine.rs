//! Affine maps of space, composed in double-double so that a chain of them rounds once.

use super::Dd;
use super::fun::{cos_deg, sin_deg};
use glam::DVec3;

/// `p ↦ linear · p + shift`. `linear[r][c]` is row r, column c.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine {
    /// The linear part, by rows.
    pub linear: [[Dd; 3]; 3],
    /// The image of the origin.
    pub shift: [Dd; 3],
}

impl Affine {
    /// The map that changes nothing.
    pub const IDENTITY: Affine = {
        let (o, z) = (Dd::new(1.0), Dd::new(0.0));
        Affine { linear: [[o, z, z], [z, o, z], [z, z, o]], shift: [z, z, z] }
    };

    /// Moves by `by`.
    pub fn translation(by: DVec3) -> Affine {
        Affine { shift: by.to_array().map(Dd::new), ..Affine::IDENTITY }
    }

    /// Stretches along the axes; every factor must be finite and not 0.
    pub fn scaling(by: DVec3) -> Affine {
        let mut a = Affine::IDENTITY;
        for (i, s) in by.to_array().into_iter().enumerate() {
            a.linear[i][i] = Dd::new(s);
        }
        a
    }

    /// Turns about the coordinate axis 0, 1 or 2 (x, y, z) by `degrees`, counter-clockwise seen from the axis' tip.
    /// Exact at multiples of 90°.
    pub fn rotation(axis: usize, degrees: f64) -> Affine {
        let (s, c) = (Dd::new(sin_deg(degrees)), Dd::new(cos_deg(degrees)));
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut a = Affine::IDENTITY;
        a.linear[i][i] = c;
        a.linear[i][j] = -s;
        a.linear[j][i] = s;
        a.linear[j][j] = c;
        a
    }

    /// Turns about the direction `axis` (any length but 0) by `degrees`: Rodrigues' formula. A coordinate axis gives
    /// exactly [`rotation`](Affine::rotation).
    pub fn rotation_about(axis: DVec3, degrees: f64) -> Affine {
        let v = axis.to_array();
        if let [i] = (0..3).filter(|&i| v[i] != 0.0).collect::<Vec<_>>()[..] {
            return Affine::rotation(i, degrees * v[i].signum());
        }
        let u = (axis / axis.abs().max_element()).normalize().to_array();
        let (s, c) = (sin_deg(degrees), cos_deg(degrees));
        let mut a = Affine::IDENTITY;
        for (i, row) in a.linear.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                let cross = match (3 + j - i) % 3 {
                    0 => 0.0,
                    1 => -u[3 - i - j],
                    _ => u[3 - i - j],
                };
                let delta = if i == j { c } else { 0.0 };
                *entry = Dd::new(delta + (1.0 - c) * u[i] * u[j] + s * cross);
            }
        }
        a
    }

    /// First `inner`, then `self`.
    pub fn compose(&self, inner: &Affine) -> Affine {
        let shift = self.apply_dd(inner.shift);
        // Products with 1 and 0 left out, and with them the sign of a 0.
        let plain = |m: &Affine| m.linear.map(|row| row.map(|x| if x.hi == 0.0 { Dd::default() } else { x }));
        if inner.is_translation() {
            return Affine { linear: plain(self), shift };
        }
        if self.is_translation() {
            return Affine { linear: plain(inner), shift };
        }
        let mut out = Affine { linear: [[Dd::default(); 3]; 3], shift };
        for r in 0..3 {
            for c in 0..3 {
                out.linear[r][c] = (0..3).fold(Dd::default(), |s, k| s + self.linear[r][k] * inner.linear[k][c]);
            }
        }
        out
    }

    /// The inverse map, or `None` where the linear part is singular.
    ///
    /// Every row is first brought to unit magnitude by a power of two, which is exact, so that products of three entries stay
    /// in range whatever the scale.
    pub fn inverse(&self) -> Option<Affine> {
        let mut m = self.linear;
        let mut powers = [Dd::new(1.0); 3];
        for (row, power) in m.iter_mut().zip(&mut powers) {
            // A comparison alone would miss a NaN.
            if row.iter().any(|x| !x.hi.is_finite()) {
                return None;
            }
            let largest = row.iter().fold(0.0, |a: f64, x| if x.hi.abs() > a { x.hi.abs() } else { a });
            if largest < f64::MIN_POSITIVE {
                return None;
            }
            *power = Dd::new(reciprocal_power(largest));
            *row = row.map(|x| x * *power);
        }
        // Cofactors, each with its indices in cyclic order so that no sign is needed.
        let cof: [[Dd; 3]; 3] = std::array::from_fn(|r| {
            std::array::from_fn(|c| {
                let (r1, r2, c1, c2) = ((r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3);
                m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1]
            })
        });
        let det = m[0][0] * cof[0][0] + m[0][1] * cof[0][1] + m[0][2] * cof[0][2];
        if det.hi == 0.0 || !det.hi.is_finite() {
            return None;
        }
        let mut out = Affine::IDENTITY;
        for (r, row) in out.linear.iter_mut().enumerate() {
            for (c, entry) in row.iter_mut().enumerate() {
                *entry = cof[c][r] / det * powers[c];
            }
        }
        let back = Affine { shift: [Dd::default(); 3], ..out }.apply_dd(self.shift);
        out.shift = back.map(|x| -x);
        Some(out)
    }

    /// The image of a point, in double-double.
    pub fn apply_dd(&self, p: [Dd; 3]) -> [Dd; 3] {
        std::array::from_fn(|r| (0..3).fold(self.shift[r], |s, k| s + self.linear[r][k] * p[k]))
    }

    /// The image of a point, rounded once.
    pub fn apply(&self, p: DVec3) -> DVec3 {
        DVec3::from_array(self.apply_dd(p.to_array().map(Dd::new)).map(Dd::round))
    }

    /// The image of a direction (the shift left out), rounded once.
    pub fn apply_vector(&self, v: DVec3) -> DVec3 {
        Affine { shift: [Dd::default(); 3], ..*self }.apply(v)
    }

    /// The linear part rounded to `f64`, by rows.
    pub fn linear_f64(&self) -> [[f64; 3]; 3] {
        self.linear.map(|row| row.map(Dd::round))
    }

    /// The shift rounded to `f64`.
    pub fn shift_f64(&self) -> [f64; 3] {
        self.shift.map(Dd::round)
    }

    /// Whether the linear part is exactly the identity.
    pub fn is_translation(&self) -> bool {
        self.linear == Affine::IDENTITY.linear
    }
}

impl Default for Affine {
    fn default() -> Self {
        Affine::IDENTITY
    }
}

/// The power of two whose product with a normal x > 0 lies in 1..2 (a half at the very top of the range), from x's exponent
/// field. Of what isn't finite, the smallest normal number.
pub fn reciprocal_power(x: f64) -> f64 {
    let field = (x.to_bits() >> 52) & 0x7ff;
    f64::from_bits(2046_u64.saturating_sub(field).max(1) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_exact_and_right_handed() {
        let r = Affine::rotation(1, 90.0);
        assert_eq!(r.apply(DVec3::Z), DVec3::X);
        assert_eq!(Affine::rotation(2, 90.0).apply(DVec3::X), DVec3::Y);
        assert_eq!(Affine::rotation_about(DVec3::NEG_Y * 3.0, 90.0).apply(DVec3::X), DVec3::Z);
    }

    #[test]
    fn general_axis_agrees_with_coordinate_axes() {
        let tilted = Affine::rotation_about(DVec3::new(1e-17, 1.0, 1e-17), 30.0).apply(DVec3::new(1.0, 2.0, 3.0));
        assert!(tilted.distance(Affine::rotation(1, 30.0).apply(DVec3::new(1.0, 2.0, 3.0))) < 1e-14);
        let turn = Affine::rotation_about(DVec3::ONE, 120.0).apply(DVec3::X);
        assert!(turn.distance(DVec3::Y) < 1e-15, "{turn}");
    }

    #[test]
    fn inverse_undoes_far_away() {
        let a = Affine::translation(DVec3::new(1e12, -3e9, 7.0))
            .compose(&Affine::rotation_about(DVec3::new(1.0, 2.0, -1.0), 77.0))
            .compose(&Affine::scaling(DVec3::new(3.0, 0.1, -2.0)));
        let p = DVec3::new(0.3, 0.7, -0.2);
        let back = a.inverse().unwrap().compose(&a).apply(p);
        assert!(back.distance(p) < 1e-15, "{back}");
        assert_eq!(Affine::scaling(DVec3::new(1.0, 0.0, 1.0)).inverse(), None);
        let wild = Affine::scaling(DVec3::new(1e130, 1.0, 1e-130));
        let back = wild.inverse().unwrap().apply(wild.apply(p));
        assert!(back.distance(p) < 1e-15, "{back}");
    }
}
