//! What no other setting beats: the Pareto front of time and error, its knee, and how steeply an axis buys accuracy.

use crate::math::fun;

/// Seconds and error of a setting.
pub type Place = (f64, f64);

/// Whether `a` is no worse than `b` in both and better in one.
pub fn dominates(a: Place, b: Place) -> bool {
    a.0 <= b.0 && a.1 <= b.1 && (a.0 < b.0 || a.1 < b.1)
}

/// The numbers of the places that none dominates, from the fastest to the most exact. Of equal ones, the first stands for all.
pub fn front(places: &[Place]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..places.len()).collect();
    order.sort_by(|&i, &j| {
        places[i].0.total_cmp(&places[j].0).then(places[i].1.total_cmp(&places[j].1)).then(i.cmp(&j))
    });
    let mut front: Vec<usize> = Vec::new();
    for i in order {
        // From the fastest on: only a smaller error earns a place.
        if front.last().is_none_or(|&last| places[i].1 < places[last].1) {
            front.push(i);
        }
    }
    front
}

/// The place on a front behind which accuracy gets dearer: the one furthest below the line between its ends, both in logarithms
/// (as Satopää, Albrecht, Irwin & Raghavan find it, *Finding a "Kneedle" in a Haystack*, 2011). `None` where no place lies below
/// that line, as on a front of two.
pub fn knee(places: &[Place], front: &[usize]) -> Option<usize> {
    let at = |i: usize| (fun::ln(places[i].0), fun::ln(positive(places[i].1)));
    let (first, last) = (at(*front.first()?), at(*front.last()?));
    let (width, height) = (last.0 - first.0, last.1 - first.1);
    let below = |i: usize| {
        let (x, y) = at(i);
        first.1 + height * (x - first.0) / width - y
    };
    let mut knee = None;
    let mut deepest = 1e-9; // what rounding makes of a place on the line
    for &i in front {
        let depth = below(i);
        if depth > deepest {
            (knee, deepest) = (Some(i), depth);
        }
    }
    knee
}

/// The slope of the straight line of least squares through the logarithms of the places: -1/2 where twice the accuracy costs four
/// times the time. `None` for fewer than three places, or where all took the same time.
pub fn slope(places: &[Place]) -> Option<f64> {
    if places.len() < 3 {
        return None;
    }
    let logs: Vec<Place> = places.iter().map(|p| (fun::ln(p.0), fun::ln(positive(p.1)))).collect();
    let n = logs.len() as f64;
    let (x, y) = logs.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let (xx, xy) = logs.iter().fold((0.0, 0.0), |(xx, xy), p| (xx + (p.0 - x) * (p.0 - x), xy + (p.0 - x) * (p.1 - y)));
    // A spread of a millionth is rounding, not a sweep.
    (xx > 1e-6 * n).then(|| xy / xx)
}

/// An error of which there is a logarithm: no smaller than a thousandth of a code, far below what any picture shows.
pub fn positive(error: f64) -> f64 {
    if error > 1e-3 { error } else { 1e-3 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn none_on_the_front_is_dominated_and_all_others_are() {
        let places = [
            (1.0, 9.0),
            (2.0, 9.5),
            (2.0, 4.0),
            (3.0, 4.0),
            (5.0, 1.0),
            (4.0, 6.0),
            (9.0, 0.5),
            (1.0, 9.0),
            (9.0, 0.7),
        ];
        let front = front(&places);
        assert_eq!(front, [0, 2, 4, 6]);
        for i in 0..places.len() {
            let beaten = places.iter().any(|p| dominates(*p, places[i]));
            let stands_for = front.iter().any(|&f| places[f] == places[i]);
            assert_eq!(stands_for, !beaten, "{i}");
        }
        assert!(super::front(&[]).is_empty());
    }

    #[test]
    fn the_knee_is_the_corner() {
        let places = [(1.0, 100.0), (2.0, 10.0), (4.0, 2.0), (64.0, 1.0)];
        let all = front(&places);
        assert_eq!(knee(&places, &all), Some(2));
        let line = [(1.0, 8.0), (2.0, 4.0), (4.0, 2.0)];
        assert_eq!(knee(&line, &front(&line)), None, "a straight front has none");
        assert_eq!(knee(&places, &all[..1]), None);
        assert_eq!(knee(&[], &[]), None);
    }

    #[test]
    fn slopes_are_those_of_powers() {
        let places: Vec<Place> = [1.0f64, 4.0, 9.0, 100.0].iter().map(|t| (*t, 7.0 / t.sqrt())).collect();
        assert!((slope(&places).unwrap() + 0.5).abs() < 1e-12);
        assert_eq!(slope(&places[..2]), None);
        assert_eq!(slope(&[(1.0, 1.0), (1.0, 2.0), (1.0, 3.0)]), None);
    }
}
