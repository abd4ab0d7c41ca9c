//! Filters that are a product of one along rows and one along columns, over pictures that go on at their edges as they end.

use crate::math::fun;
use rayon::prelude::*;

/// A channel of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    /// Pixels across; at least 1.
    pub width: usize,
    /// Row by row.
    pub values: Vec<f64>,
}

impl Plane {
    /// Weighted with `weights`, an odd number of them, along every row.
    pub fn along_rows(&self, weights: &[f64]) -> Plane {
        let (radius, width) = (weights.len() / 2, self.width);
        let mut out = vec![0.0; self.values.len()];
        out.par_chunks_mut(width).zip(self.values.par_chunks(width)).for_each_init(Vec::new, |padded, (out, row)| {
            padded.clear();
            padded.extend(std::iter::repeat_n(row[0], radius));
            padded.extend_from_slice(row);
            padded.extend(std::iter::repeat_n(row[row.len() - 1], radius));
            for (k, weight) in weights.iter().enumerate() {
                add(out, &padded[k..], *weight);
            }
        });
        Plane { width, values: out }
    }

    /// Weighted likewise along every column.
    pub fn along_columns(&self, weights: &[f64]) -> Plane {
        let (radius, width) = (weights.len() / 2, self.width);
        let last = (self.values.len() / width).saturating_sub(1);
        let mut out = vec![0.0; self.values.len()];
        out.par_chunks_mut(width).enumerate().for_each(|(y, out)| {
            for (k, weight) in weights.iter().enumerate() {
                let from = (y + k).saturating_sub(radius).min(last);
                add(out, &self.values[from * width..], *weight);
            }
        });
        Plane { width, values: out }
    }

    /// `a` times this and `b` times another of the same size.
    pub fn mixed(mut self, a: f64, other: &Plane, b: f64) -> Plane {
        self.values.iter_mut().zip(&other.values).for_each(|(x, y)| *x = a * *x + b * y);
        self
    }
}

fn add(out: &mut [f64], row: &[f64], weight: f64) {
    out.iter_mut().zip(row).for_each(|(out, v)| *out += weight * v);
}

/// `f` of the whole numbers from -radius to radius, with positive values that sum to 1 and negative ones that sum to -1.
pub fn normalized(radius: usize, f: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut weights: Vec<f64> = (0..=2 * radius).map(|i| f(i as f64 - radius as f64)).collect();
    let sum = |sign: f64| weights.iter().filter(|w| sign * **w > 0.0).map(|w| w.abs()).sum::<f64>();
    let (positive, negative) = (sum(1.0), sum(-1.0));
    weights.iter_mut().for_each(|w| *w /= if *w < 0.0 { negative } else { positive });
    weights
}

/// exp(-c x²).
pub fn bell(c: f64) -> impl Fn(f64) -> f64 {
    move |x| fun::exp(-c * x * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_go_on_as_they_end() {
        let plane = Plane { width: 3, values: vec![1.0, 2.0, 4.0, 8.0, 16.0, 32.0] };
        let weights = [0.5, 0.0, 0.0, 0.0, 2.0];
        assert_eq!(plane.along_rows(&weights).values, [8.5, 8.5, 8.5, 68.0, 68.0, 68.0]);
        assert_eq!(plane.along_columns(&weights).values, [16.5, 33.0, 66.0, 16.5, 33.0, 66.0]);
        let even = Plane { width: 4, values: vec![3.0; 12] };
        let blurred = even.along_rows(&normalized(7, bell(0.1))).along_columns(&normalized(7, bell(0.1)));
        assert!(blurred.values.iter().all(|v| (v - 3.0).abs() < 1e-14));
    }

    #[test]
    fn weights_of_each_sign_sum_to_one() {
        let weights = normalized(5, |x| x * fun::exp(-x * x / 8.0));
        assert!((weights[6..].iter().sum::<f64>() - 1.0).abs() < 1e-15 && weights[5] == 0.0);
        assert!((weights[..5].iter().sum::<f64>() + 1.0).abs() < 1e-15 && weights[0] < 0.0);
    }
}
