//! The rays that leave a surface: mirrored and transmitted.

use super::batch::{PADDING, RayBatch};
use super::material::Surfacing;
use super::optics::{dielectric, mirrored};
use super::shape::primitive::spawn_point;
use crate::math::real::{Mask, dot, each3, select3, three};
use crate::math::{Elem, Lane};
use crate::scene::range::BRIGHTEST;

/// Where rays go that leave the surface.
pub struct Children<'a, E: Elem> {
    /// Mirrored ones.
    pub mirrored: &'a mut RayBatch<E>,
    /// Those that go through.
    pub transmitted: &'a mut RayBatch<E>,
    /// Whether the recursion may go on.
    pub spawn: bool,
    /// What becomes of rays that carry next to nothing.
    pub faint: &'a mut Faint,
}

/// Rays that aren't followed, because all that they could see would change next to nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Faint {
    /// The largest weight of such a ray, in every channel; 0 leaves out those alone that carry nothing.
    pub most: f64,
    /// The sum of their weights, of the largest channel of each, in units of 2⁻³²: a whole number is the same in whatever order
    /// rays are traced.
    pub lost: u64,
}

impl Faint {
    /// Units of the sum in a weight of 1.
    pub const UNIT: f64 = (1u64 << 32) as f64;

    /// Adds the weights of a register's rays that aren't followed.
    #[inline(never)] // few are, and none where nothing is asked for
    fn lose<E: Elem>(&mut self, weights: &[E], which: u32) {
        for (_, w) in (0..).zip(weights).filter(|(i, _)| which >> i & 1 != 0) {
            self.lost = self.lost.saturating_add((w.to_f64() * Faint::UNIT).ceil() as u64);
        }
    }
}

/// Hits of one register, as the rays that leave them see them.
pub struct Leaving<L> {
    /// Directions in which they were met.
    pub d: [L; 3],
    /// Points.
    pub p: [L; 3],
    /// Geometric normals on the viewer's side.
    pub n: [L; 3],
    /// Shading normals.
    pub ns: [L; 3],
    /// How far along the normal a new ray starts.
    pub offset: L,
    /// 1 where the ray came from inside.
    pub inside: L,
    /// Weights of the rays that met them.
    pub weight: [L; 3],
    /// Numbers of the surfaces.
    pub id: L,
    /// Parts of them.
    pub part: L,
    /// Pixels of the tile.
    pub slot: L,
}

impl<E: Elem> Children<'_, E> {
    /// Whether surfaces of this kind have any.
    #[inline(always)]
    pub fn any(&self, m: &Surfacing) -> bool {
        self.spawn && (m.mirrors() || m.lets_through())
    }

    /// Adds the rays that leave the hits of `live`: `back` is what the material mirrors, `through` what it lets through.
    #[inline(always)]
    pub fn spawn<L: Lane<Elem = E>>(
        &mut self,
        m: &Surfacing,
        hit: &Leaving<L>,
        mut back: [L; 3],
        mut through: [L; 3],
        live: L::Mask,
    ) {
        let mut onward = hit.d;
        let outside = L::one() - hit.inside;
        if let Some(ior) = m.ior {
            let bent = dielectric(hit.d, hit.ns, ior, hit.inside.same(L::one()));
            back = three!(c => through[c].mul_add(bent.reflectance, back[c]));
            through = each3!(through, x => x * (L::one() - bent.reflectance));
            onward = bent.direction;
        }
        if m.mirrors() {
            // A tilted normal may send the mirrored ray into the surface; then the true normal decides.
            let tilted = mirrored(hit.d, hit.ns);
            let out = L::zero().lt(dot(tilted, hit.n));
            let d = select3(out, tilted, mirrored(hit.d, hit.n));
            push(self.mirrored, hit, spawn_point(hit.p, hit.n, hit.offset), d, (back, self.faint), outside, live);
        }
        if m.lets_through() {
            let live = live & dot(onward, hit.n).lt(L::zero());
            let o = spawn_point(hit.p, hit.n, -hit.offset);
            push(self.transmitted, hit, o, onward, (through, self.faint), hit.inside, live);
        }
    }
}

/// Appends those of `live` that carry more than `faint` weight: from `o` along `d`, with a share of `w`. `outward` is 1 where they leave
/// to the outside.
#[inline(always)]
fn push<L: Lane>(
    batch: &mut RayBatch<L::Elem>,
    hit: &Leaving<L>,
    o: [L; 3],
    d: [L; 3],
    (w, faint): ([L; 3], &mut Faint),
    outward: L,
    live: L::Mask,
) {
    // Mirrors that amplify, face to face, would leave the range of numbers.
    let most = L::splat(BRIGHTEST);
    let w = three!(c => (hit.weight[c] * w[c]).min(most).max(-most));
    let size = w[0].abs().max(w[1].abs()).max(w[2].abs());
    let left = live & size.le(L::splat(faint.most));
    if faint.most > 0.0 && left.any() {
        let mut lanes = [L::Elem::default(); PADDING];
        size.store(&mut lanes);
        faint.lose(&lanes, left.bits());
    }
    let live = live & !left;
    let count = live.bits().count_ones() as usize;
    if count == 0 {
        return;
    }
    let at = batch.len;
    for c in 0..3 {
        o[c].compress(live, &mut batch.o[c][at..]);
        d[c].compress(live, &mut batch.d[c][at..]);
        w[c].compress(live, &mut batch.weight[c][at..]);
    }
    hit.slot.compress(live, &mut batch.slot[at..]);
    hit.id.compress(live, &mut batch.source[at..]);
    hit.part.compress(live, &mut batch.source_part[at..]);
    outward.compress(live, &mut batch.outward[at..]);
    batch.len += count;
}
