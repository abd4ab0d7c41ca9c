//! Points scattered at a least distance from each other: Poisson-disc sampling after Bridson (SIGGRAPH 2007 sketches), by
//! keys instead of a random stream.

use super::random::{hash_of, on_sphere};
use crate::lang::fault::{Fault, Outcome};
use crate::lang::value::Value;
use crate::lang::word::{Args, Default, Host, Kind, Run, Ty, Word, optional, required};
use crate::math::fun::{cbrt, cos_deg, sin_deg, sqrt};
use crate::math::hash::KeyedHash;
use ecow::EcoVec;
use std::collections::HashMap;

pub const WORDS: &[Word] = &[Word {
    name: "scatter",
    kind: Kind::Random,
    params: &[
        required("from", Ty::Point, "one corner of the region"),
        required("to", Ty::Point, "the opposite corner; where a coordinate is the same, the region is flat"),
        required("distance", Ty::Length, "how near two points may be").above(0.0),
        optional("key", Ty::Any, Default::Number(0.0), "another arrangement"),
    ],
    doc: "A list of random points that fill a box or rectangle, no two nearer than a distance and none much farther from the next.",
    example: "for p in scatter([-5, 0, -5], [5, 0, 5], 0.8, key: \"pebbles\") {\n  sphere(at: p, r: 0.15 + 0.25 * rand(p))\n}\nplane(y: 0, mat: matte(beige))\ncamera(from: [4, 6, 10])\nlight(at: [4, 8, 6])",
    run: Run::Call(scatter),
}];

/// Tries around each point before it counts as surrounded: Bridson's number.
const TRIES: u64 = 30;

fn scatter(host: &mut dyn Host, a: &[Value]) -> Outcome {
    let (from, to, distance) = (a.vec3(0).to_array(), a.vec3(1).to_array(), a.number(2));
    let hash = hash_of(host, a, 3)?;
    let low: [f64; 3] = std::array::from_fn(|i| if from[i] < to[i] { from[i] } else { to[i] });
    let high: [f64; 3] = std::array::from_fn(|i| if from[i] < to[i] { to[i] } else { from[i] });
    let axes: Vec<usize> = (0..3).filter(|i| low[*i] < high[*i]).collect();
    // Beyond 2^53 cells along an axis, neighbours can't be told apart.
    if axes.iter().any(|&i| (high[i] - low[i]) / distance > 1e15) {
        return Err(Fault::new("`distance` is too small for this region").on(2).into());
    }
    let mut region = Region { low, high, axes, distance, points: Vec::new(), cells: HashMap::new() };
    region.add(std::array::from_fn(|i| {
        let u = hash.with(i as u64).unit();
        (1.0 - u) * low[i] + u * high[i]
    }));
    let most = host.build().limits.list_length;
    // Points are surrounded in the order in which they were found: no stack to disturb, and every run the same.
    let mut next = 0;
    while let Some(center) = region.points.get(next).copied() {
        let around = hash.with(3).with(next as u64);
        for k in 0..TRIES {
            host.spend(1)?;
            let p = region.near(center, around.with(k));
            if region.is_free(p) {
                region.add(p);
            }
        }
        if region.points.len() > most {
            let message = format!("this list has more than {most} values");
            return Err(Fault::budget(message, "choose a larger `distance`").into());
        }
        next += 1;
    }
    Ok(Value::list(region.points.into_iter().map(Value::Vec3).collect::<EcoVec<Value>>()))
}

/// The box and the points in it so far.
struct Region {
    low: [f64; 3],
    high: [f64; 3],
    /// Along which it has a size.
    axes: Vec<usize>,
    distance: f64,
    points: Vec<[f64; 3]>,
    /// Points by cells of side `distance`; only ever looked up, so its order doesn't matter.
    cells: HashMap<[i64; 3], Vec<u32>>,
}

impl Region {
    fn cell(&self, p: [f64; 3]) -> [i64; 3] {
        std::array::from_fn(|i| ((p[i] - self.low[i]) / self.distance).floor() as i64)
    }

    fn add(&mut self, p: [f64; 3]) {
        let cell = self.cell(p);
        self.cells.entry(cell).or_default().push(self.points.len() as u32);
        self.points.push(p);
    }

    /// A point at one to two distances from another, uniform over that shell.
    fn near(&self, p: [f64; 3], h: KeyedHash) -> [f64; 3] {
        let u = h.unit();
        let mut q = p;
        match self.axes[..] {
            [] => {}
            [i] => q[i] += (if h.with(1).unit() < 0.5 { -1.0 } else { 1.0 }) * (1.0 + u) * self.distance,
            [i, j] => {
                let (r, turn) = (sqrt(1.0 + 3.0 * u) * self.distance, 360.0 * h.with(1).unit());
                q[i] += r * cos_deg(turn);
                q[j] += r * sin_deg(turn);
            }
            _ => {
                let (r, v) = (cbrt(1.0 + 7.0 * u) * self.distance, on_sphere(h));
                q = std::array::from_fn(|i| p[i] + r * v[i]);
            }
        }
        q
    }

    fn is_free(&self, p: [f64; 3]) -> bool {
        if self.axes.is_empty() || (0..3).any(|i| p[i] < self.low[i] || p[i] > self.high[i]) {
            return false;
        }
        let cell = self.cell(p);
        let far = |q: [f64; 3]| {
            let d2: f64 = (0..3).map(|i| (p[i] - q[i]) * (p[i] - q[i])).sum();
            d2 >= self.distance * self.distance
        };
        (0..27).all(|k| {
            let c = [cell[0] + k % 3 - 1, cell[1] + k / 3 % 3 - 1, cell[2] + k / 9 - 1];
            self.cells.get(&c).is_none_or(|near| near.iter().all(|&n| far(self.points[n as usize])))
        })
    }
}
