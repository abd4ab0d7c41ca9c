//! What the channels of a pattern can be, found from what it is made of: so that one whose values leave the numbers, or are
//! no amounts of light, is an error of the text and not a hole in the picture.

use crate::math::Real;
use crate::scene::{Color, PatternId, PatternKind};

/// All values from `least` to `most`. Rounding isn't counted: the limits that it is held against are round numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Values {
    /// The smallest.
    pub least: f64,
    /// The largest.
    pub most: f64,
}

impl Values {
    /// From 0 to 1.
    pub const UNIT: Values = Values { least: 0.0, most: 1.0 };

    /// The channels of a colour.
    pub fn of_color(color: Color) -> Values {
        let [r, g, b] = color.0.map(|x| Values { least: x, most: x });
        r.or(g).or(b)
    }

    /// The channels of a pattern, given those of its children.
    pub fn of_pattern(kind: &PatternKind, of: impl Fn(PatternId) -> Values) -> Values {
        use PatternKind as K;
        match kind {
            K::Constant(c) => Values::of_color(*c),
            K::Image { .. } => Values::UNIT,
            K::Mix { a, b, by } => of(*a).mixed(of(*b), of(*by)),
            K::Add(a, b) => of(*a).plus(of(*b)),
            K::Multiply(a, b) => of(*a).times(of(*b)),
            K::Blend { stops, .. } => stops.iter().map(|s| of(*s)).reduce(Values::or).unwrap_or(Values::UNIT),
            K::Transformed { child, .. } | K::Turbulence { child, .. } => of(*child),
            K::Checker { a, b, .. }
            | K::Stripes { a, b, .. }
            | K::Rings { a, b, .. }
            | K::Gradient { a, b, .. }
            | K::Noise { a, b, .. }
            | K::Cells { a, b, .. }
            | K::Brick { mortar: a, brick: b, .. } => of(*a).or(of(*b)),
        }
    }

    /// The largest size of any of them.
    pub fn size(self) -> f64 {
        Real::max(-self.least, self.most)
    }

    fn or(self, o: Values) -> Values {
        Values { least: Real::min(self.least, o.least), most: Real::max(self.most, o.most) }
    }
    fn plus(self, o: Values) -> Values {
        Values { least: self.least + o.least, most: self.most + o.most }
    }
    fn times(self, o: Values) -> Values {
        let product = |x: f64, y: f64| Values { least: x * y, most: x * y };
        let with_least = product(self.least, o.least).or(product(self.least, o.most));
        with_least.or(product(self.most, o.least)).or(product(self.most, o.most))
    }
    /// (1 − by)·self + by·o.
    fn mixed(self, o: Values, by: Values) -> Values {
        if by.least >= 0.0 && by.most <= 1.0 {
            return self.or(o); // nothing beyond the two
        }
        let rest = Values { least: 1.0 - by.most, most: 1.0 - by.least };
        rest.times(self).plus(by.times(o))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(least: f64, most: f64) -> Values {
        Values { least, most }
    }

    #[test]
    fn arithmetic_holds_the_extremes() {
        let (a, b) = (values(-2.0, 3.0), values(-5.0, 1.0));
        assert_eq!(a.times(b), values(-15.0, 10.0));
        assert_eq!(a.plus(b), values(-7.0, 4.0));
        assert_eq!((a.size(), b.size()), (3.0, 5.0));
        assert_eq!(a.mixed(b, Values::UNIT), values(-5.0, 3.0), "a share from 0 to 1 stays between");
        assert_eq!(values(1.0, 1.0).mixed(values(3.0, 3.0), values(2.0, 2.0)), values(5.0, 5.0), "beyond the end");
        assert_eq!(values(1e200, 1e200).times(values(1e200, 1e200)).size(), f64::INFINITY);
    }
}
