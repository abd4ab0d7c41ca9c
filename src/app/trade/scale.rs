//! Logarithmic scales of a plot.

use crate::math::fun;

/// From values to places along an axis of the plot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Logarithms of the values at the ends.
    from: f64,
    to: f64,
    /// Places of the ends, in the plot's units.
    start: f64,
    end: f64,
}

impl Scale {
    /// Wide enough for all values, which are positive; a little more, so that no mark lies on an edge.
    pub fn over(values: impl Iterator<Item = f64>, [start, end]: [f64; 2]) -> Scale {
        let logs = values.filter(|v| *v > 0.0 && v.is_finite()).map(fun::log10);
        let ends = logs.fold(None, |ends: Option<[f64; 2]>, x| {
            let [a, b] = ends.unwrap_or([x, x]);
            Some([if x < a { x } else { a }, if x > b { x } else { b }])
        });
        let [from, to] = ends.unwrap_or([0.0, 0.0]);
        // A tenth of the width on each side, but a factor of 1.5 at least, or a single value would have no scale.
        let room = 0.08 * (to - from) + 0.12;
        Scale { from: from - room, to: to + room, start, end }
    }

    /// The place of a value; values beyond the ends, and 0, are at the ends.
    pub fn at(&self, value: f64) -> f64 {
        let log = if value > 0.0 { fun::log10(value) } else { self.from };
        let share = ((log - self.from) / (self.to - self.from)).clamp(0.0, 1.0);
        self.start + share * (self.end - self.start)
    }

    /// Values that are marked, at least `gap` from each other: powers of ten, with numbers between them where there is room.
    pub fn ticks(&self, gap: f64) -> Vec<f64> {
        let decade = (self.end - self.start).abs() / (self.to - self.from);
        let steps: &[f64] = match decade {
            // The nearest neighbours are 1 and 2, or 1 and 3.
            d if d * fun::log10(2.0) >= gap => &[1.0, 2.0, 5.0],
            d if d * fun::log10(3.0) >= gap => &[1.0, 3.0],
            _ => &[1.0],
        };
        let decades = self.from.floor() as i32..=self.to.ceil() as i32;
        let all = decades.flat_map(|d| steps.iter().map(move |s| s * fun::pow(10.0, d as f64)));
        all.filter(|v| (self.from..=self.to).contains(&fun::log10(*v))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decades_are_even() {
        let scale = Scale::over([0.1, 10.0].into_iter(), [0.0, 100.0]);
        let (a, b, c) = (scale.at(0.1), scale.at(1.0), scale.at(10.0));
        assert!((b - 50.0).abs() < 1e-9 && ((c - b) - (b - a)).abs() < 1e-9 && a > 0.0 && c < 100.0);
        assert_eq!((scale.at(0.0), scale.at(1e9)), (0.0, 100.0));
        let ticks = scale.ticks(5.0);
        assert!(ticks.len() == 7 && (ticks[0] - 0.1).abs() < 1e-12, "{ticks:?}");
        assert_eq!((scale.ticks(15.0).len(), scale.ticks(30.0).len()), (5, 3));
    }

    #[test]
    fn one_value_is_in_the_middle_and_none_is_no_fault() {
        let one = Scale::over([3.0].into_iter(), [0.0, 10.0]);
        assert!((one.at(3.0) - 5.0).abs() < 1e-9);
        assert!(Scale::over([0.0, f64::INFINITY].into_iter(), [0.0, 1.0]).at(1.0).is_finite());
    }
}
