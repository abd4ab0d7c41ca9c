//! The colour spaces of FLIP: opponent axes in which blurring is linear, and one in which distances are even.

use crate::math::fun;
use glam::{DMat3, DVec3};

/// XYZ of linear RGB with the primaries of sRGB, from their chromaticities (ITU-R BT.709, D65) as exact fractions: column by
/// column.
const XYZ_FROM_RGB: DMat3 = DMat3::from_cols(
    DVec3::new(10_135_552.0 / 24_577_794.0, 2_613_072.0 / 12_288_897.0, 1_425_312.0 / 73_733_382.0),
    DVec3::new(8_788_810.0 / 24_577_794.0, 8_788_810.0 / 12_288_897.0, 8_788_810.0 / 73_733_382.0),
    DVec3::new(4_435_075.0 / 24_577_794.0, 887_015.0 / 12_288_897.0, 70_074_185.0 / 73_733_382.0),
);

/// The spaces, with what they share.
pub struct Spaces {
    /// RGB to XYZ in units of the white.
    relative: DMat3,
    /// The way back.
    rgb: DMat3,
}

impl Spaces {
    /// For the white of sRGB.
    pub fn new() -> Spaces {
        let white = XYZ_FROM_RGB * DVec3::ONE;
        let relative = DMat3::from_diagonal(DVec3::ONE / white) * XYZ_FROM_RGB;
        Spaces { relative, rgb: relative.inverse() }
    }

    /// YyCxCz of linear RGB: luminance, red against green, yellow against blue. Linear, so that it may be blurred.
    pub fn opponent(&self, rgb: DVec3) -> DVec3 {
        axes(self.relative * rgb)
    }

    /// Linear RGB of YyCxCz.
    pub fn rgb(&self, opponent: DVec3) -> DVec3 {
        let y = (opponent.x + 16.0) / 116.0;
        self.rgb * DVec3::new(y + opponent.y / 500.0, y, y - opponent.z / 200.0)
    }

    /// CIE L*a*b* of linear RGB, with colours that are paler where it is dark (Hunt 1952), as FLIP has it.
    pub fn hunt(&self, rgb: DVec3) -> DVec3 {
        let xyz = self.relative * rgb;
        let lab = axes(DVec3::new(bend(xyz.x), bend(xyz.y), bend(xyz.z)));
        DVec3::new(lab.x, 0.01 * lab.x * lab.y, 0.01 * lab.x * lab.z)
    }
}

fn axes(xyz: DVec3) -> DVec3 {
    DVec3::new(116.0 * xyz.y - 16.0, 500.0 * (xyz.x - xyz.y), 200.0 * (xyz.y - xyz.z))
}

/// The curve of L*a*b* (CIE 15): a cube root, and its tangent where it would be too steep.
fn bend(v: f64) -> f64 {
    const KNEE: f64 = 6.0 / 29.0;
    if v > KNEE * KNEE * KNEE { fun::cbrt(v) } else { v / (3.0 * KNEE * KNEE) + 4.0 / 29.0 }
}

/// HyAB: how far two colours are apart when they are far apart (Abasi, Tehran & Fairchild, *Distance metrics for very large
/// color differences*, 2020).
pub fn hyab(a: DVec3, b: DVec3) -> f64 {
    let d = a - b;
    d.x.abs() + (d.y * d.y + d.z * d.z).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_is_white_and_all_come_back() {
        let spaces = Spaces::new();
        assert!((spaces.opponent(DVec3::ONE) - DVec3::new(100.0, 0.0, 0.0)).length() < 1e-12);
        assert!((spaces.hunt(DVec3::ONE) - DVec3::new(100.0, 0.0, 0.0)).length() < 1e-12);
        assert!(spaces.hunt(DVec3::ZERO).length() < 1e-12);
        let color = DVec3::new(0.2, 0.7, 0.05);
        assert!((spaces.rgb(spaces.opponent(color)) - color).length() < 1e-14);
    }
}
