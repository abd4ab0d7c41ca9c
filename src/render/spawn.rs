//! The rays that leave a surface: mirrored and transmitted.

use super::batch::RayBatch;
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
            push(self.mirrored, hit, spawn_point(hit.p, hit.n, hit.offset), d, back, outside, live);
        }
        if m.lets_through() {
            let live = live & dot(onward, hit.n).lt(L::zero());
            push(self.transmitted, hit, spawn_point(hit.p, hit.n, -hit.offset), onward, through, hit.inside, live);
        }
    }
}

/// Appends those of `live` that carry any weight: from `o` along `d`, with a share of `w`. `outward` is 1 where they leave to the
/// outside.
#[inline(always)]
fn push<L: Lane>(
    batch: &mut RayBatch<L::Elem>,
    hit: &Leaving<L>,
    o: [L; 3],
    d: [L; 3],
    w: [L; 3],
    outward: L,
    live: L::Mask,
) {
    let zero = L::zero();
    // Mirrors that amplify, face to face, would leave the range of numbers.
    let most = L::splat(BRIGHTEST);
    let w = three!(c => (hit.weight[c] * w[c]).min(most).max(-most));
    let nothing = w[0].same(zero) & w[1].same(zero) & w[2].same(zero);
    let live = live & !nothing;
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
