//! Balls that share a leaf: up to eight side by side, so that one instruction does the same to all of them.
//!
//! A node of boxes around single balls, and a table of the balls, say twice where these are. Here a ball is four numbers, in the
//! tree's units ([`Fit`](super::node::Fit)), and a ray that misses it is told at once. What is left is for the kernels: these balls
//! are a little larger than what they stand for.

use super::node::{Box4, WIDE};
use super::split::Item;
use super::walk::Registers;
use crate::math::real::{dot, three};
use crate::math::{Lane, Mask};

/// Balls and the primitives that they hold.
#[derive(Clone, Debug)]
#[repr(C, align(32))]
pub struct Swarm {
    centre: [[f32; WIDE]; 3],
    /// Wider by [`SLACK`] times the centre's distance from the origin.
    radius: [f32; WIDE],
    ids: [u32; WIDE],
}

/// What roundings may move a ball, or a ray beside it, by, as a share of how far they are from the tree's origin. In units of 2^-24,
/// the unit roundoff of `f32`: the ball's centre 4; the ray's origin 1, its direction 25, for its numbers are a beam's; their
/// difference and cross product 5; the kernels in `f32` some more.
pub const SLACK: f32 = 128.0 / (1 << 24) as f32;

impl Swarm {
    /// Of up to eight items whose boxes are those of balls.
    pub fn of(items: &[Item]) -> Swarm {
        let mut swarm = Swarm { centre: [[0.0; WIDE]; 3], radius: [0.0; WIDE], ids: [0; WIDE] };
        for (k, item) in items.iter().take(WIDE).enumerate() {
            let Box4 { lo, hi } = item.bounds;
            let (mut radius, mut away) = (0.0, 0.0);
            for i in 0..3 {
                swarm.centre[i][k] = 0.5 * (lo[i] + hi[i]);
                let half = 0.5 * (hi[i] - lo[i]);
                radius = if half > radius { half } else { radius };
                away += swarm.centre[i][k].abs();
            }
            swarm.radius[k] = radius + SLACK * (radius + away);
            swarm.ids[k] = item.id();
        }
        swarm
    }

    /// The primitives; those beyond the leaf's number mean nothing.
    #[inline(always)]
    pub fn ids(&self) -> &[u32; WIDE] {
        &self.ids
    }

    /// Those `kept`, a bit each, with their new numbers.
    pub fn renumbered(&self, kept: u32, number: impl Fn(u32) -> u32) -> Swarm {
        let mut swarm = self.clone();
        for (to, from) in (0..WIDE).filter(|k| kept >> k & 1 == 1).enumerate() {
            (0..3).for_each(|i| swarm.centre[i][to] = self.centre[i][from]);
            swarm.radius[to] = self.radius[from];
            swarm.ids[to] = number(self.ids[from]);
        }
        swarm
    }

    /// The box around a ball.
    #[inline(always)]
    pub fn box_of(&self, k: usize) -> Box4 {
        let mut b = Box4::EMPTY;
        for i in 0..3 {
            b.lo[i] = self.centre[i][k % WIDE] - self.radius[k % WIDE];
            b.hi[i] = self.centre[i][k % WIDE] + self.radius[k % WIDE];
        }
        b
    }

    /// One bit for each ball that rays meet before `t_max`. `W` is a register of up to eight.
    #[inline(always)]
    pub fn meet<W: Lane<Elem = f32>>(&self, beam: &Registers<W>, t_max: f32) -> u32 {
        let mut met = 0;
        let t_max = W::splat(t_max as f64);
        for k in 0..WIDE / W::WIDTH {
            let at = k * W::WIDTH;
            let radius = W::load(&self.radius[at..]);
            let here = match &beam.line {
                Some(line) => {
                    let to = three!(i => W::load(&self.centre[i][at..]) - line.o[i]);
                    let d = line.d;
                    let beside = three!(i => {
                        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                        to[j].mul_sub(d[k], to[k] * d[j])
                    });
                    let reach = (radius + line.slack) * line.length;
                    let along = dot(to, d);
                    dot(beside, beside).le(reach * reach)
                        & (W::zero() - reach).le(along)
                        & along.le(t_max.mul_add(line.square, reach))
                }
                None => {
                    let (mut near, mut far) = (W::zero(), t_max);
                    for i in 0..3 {
                        let centre = W::load(&self.centre[i][at..]);
                        let (lower, upper) = (centre - radius, centre + radius);
                        let (enter, leave) = if beam.near_row[i] == i { (lower, upper) } else { (upper, lower) };
                        let enter = (enter - beam.near_from[i]) * beam.near_inverse[i];
                        let leave = (leave - beam.far_from[i]) * beam.far_inverse[i];
                        (near, far) = (enter.max(near), leave.min(far));
                    }
                    near.le(far)
                }
            };
            met |= here.bits() << at;
        }
        met
    }
}

/// The only ray of a beam, in registers.
pub struct Line<W> {
    o: [W; 3],
    d: [W; 3],
    /// How far beside it the ray may be, in all.
    slack: W,
    /// Of the direction, and its square.
    length: W,
    square: W,
}

impl<W: Lane<Elem = f32>> Line<W> {
    /// The ray whose origin lies between two places, and the inverse of whose direction does.
    #[inline(always)]
    pub fn between(from: [[f32; 3]; 2], inverse: [[f32; 3]; 2]) -> Line<W> {
        let (mut slack, mut square) = (0.0f32, 0.0f32);
        let (mut o, mut d) = ([0.0f32; 3], [0.0f32; 3]);
        for i in 0..3 {
            o[i] = 0.5 * (from[0][i] + from[1][i]);
            d[i] = 2.0 / (inverse[0][i] + inverse[1][i]);
            slack += 0.5 * (from[0][i] - from[1][i]).abs() + SLACK * o[i].abs();
            square += d[i] * d[i];
        }
        let splat = |x: f32| W::splat(x as f64);
        Line {
            o: three!(i => splat(o[i])),
            d: three!(i => splat(d[i])),
            slack: splat(slack),
            length: splat(square.sqrt() * (1.0 + SLACK)),
            square: splat(square * (1.0 + SLACK)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::hash::KeyedHash;
    use crate::math::real::minus;
    use crate::render::bounds::Bounds;
    use crate::render::bvh::{Bvh, Company};
    use std::sync::atomic::AtomicBool;

    fn random(i: u64, k: u64) -> f64 {
        KeyedHash::new().with(i).with(k).unit()
    }

    fn balls(n: u64, away: f64) -> Vec<([f64; 3], f64)> {
        (0..n).map(|i| (three!(k => away + random(i, k as u64)), 0.02 * random(i, 3) * random(i, 4) + 1e-9)).collect()
    }

    fn tree_of(balls: &[([f64; 3], f64)]) -> Bvh {
        let leaves = balls.iter().zip(0..).map(|((c, r), id)| (id, Bounds::around(*c, [*r; 3]))).collect();
        Bvh::build_unless(leaves, |_| Company::Balls, &AtomicBool::new(false)).expect("built")
    }

    #[test]
    fn no_ball_is_passed_over_that_a_ray_meets() {
        let (mut met, mut tested) = (0, 0);
        for away in [0.0, -0.5, 1e4, -1e12] {
            let all = balls(3000, away);
            let tree = tree_of(&all);
            assert!(tree.swarms.len() > 300 && tree.len() == all.len());
            for i in 0..500 {
                // From within, from afar, at the very edge of a ball; some along an axis.
                let far = if i % 3 == 0 { 1e5 } else { 2.0 };
                let o = three!(k => away + far * (random(i, 20 + k as u64) - 0.4));
                let (centre, r) = all[(random(i, 30) * all.len() as f64) as usize];
                let aim = three!(k => centre[k] + if k as u64 == i % 3 { 0.999 * r } else { 0.0 });
                let mut d = minus(aim, o);
                let o = if i % 5 == 0 { three!(k => if k as u64 == i % 3 { o[k] } else { aim[k] }) } else { o };
                if i % 5 == 0 {
                    d = three!(k => if k as u64 == i % 3 { d[k] } else { 0.0 });
                }
                let mut found = Vec::new();
                tree.traverse(o, d, f64::INFINITY, |id| {
                    found.push(id);
                    f64::INFINITY
                });
                let near = away.abs() < 1.0;
                tested += if near { found.len() } else { 0 };
                for ((c, r), id) in all.iter().zip(0..) {
                    let to = minus(*c, o);
                    let (along, square) = (dot(to, d), dot(d, d));
                    let beside = minus(to, three!(k => along / square * d[k]));
                    // Surely, not just by what rounding makes of it here.
                    let sure = 1e-13 * (dot(*c, *c) + dot(o, o)).sqrt();
                    if along > 0.0 && dot(beside, beside).sqrt() + sure < *r {
                        met += near as usize;
                        assert!(found.contains(&id), "{o:?} {d:?}: {c:?}, {r}");
                    }
                }
            }
        }
        assert!(met > 1_000, "{met}");
        assert!(tested < 2 * met, "{tested} for {met}: balls are tested, not boxes");
    }

    #[test]
    fn what_is_gone_is_taken_out_and_the_rest_is_in_its_place() {
        let all = balls(200, 0.0);
        let tree = tree_of(&all);
        let renumbered: Vec<u32> = (0..200).map(|id| if id % 7 == 3 { u32::MAX } else { id + 1000 }).collect();
        let next = tree.grafted(&renumbered, Vec::new()).expect("little changed");
        let mut kept: Vec<u32> = next.leaves().map(|l| l.0).collect();
        kept.sort();
        assert!(kept.iter().copied().eq((0..200).filter(|id| id % 7 != 3).map(|id| id + 1000)));
        let near = |region: &Bounds| {
            let mut found = Vec::new();
            next.gather(
                usize::MAX,
                |b| b.overlaps(region),
                |id| {
                    found.push(id);
                    true
                },
            );
            found
        };
        for id in kept {
            let (c, r) = all[id as usize - 1000];
            assert!(near(&Bounds::around(c, [0.1 * r; 3])).contains(&id));
        }
    }
}
