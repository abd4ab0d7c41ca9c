//! The first pass of shading: where the rays of a run met surfaces, and how these stand to them.

use super::batch::{load3, put3, store3};
use super::bounds::Bounds;
use super::known::{Known, with_known};
use super::run::LaneGroup;
use super::run_of_hits::{FacedBy, RunOfHits, Surfaces};
use super::shape::{Mesh, Surface};
use super::span::Span;
use super::surface_pattern::bumped;
use crate::math::real::{Mask, dot};
use crate::math::{Elem, Lane};

impl<E: Elem> RunOfHits<'_, E> {
    /// Points, normals and offsets of all hits; gives a box around the points, where light is looked for from them.
    #[inline(always)]
    pub fn surfaces<L: Lane<Elem = E>, const AT_EYE: bool>(&self, s: &mut Surfaces<E>) -> Bounds {
        s.all_outside = true;
        // Asked once for all, where there is one surface: see `known`.
        match self.world.primitives.get(self.hits.only as usize) {
            Some(primitive) => with_known!(primitive, known => self.surfaces_of::<L, AT_EYE, _>(known, s)),
            None => self.surfaces_of_many::<L, AT_EYE>(s),
        }
        let mut points = Span::<L>::new();
        if self.surfacing.lit {
            let all = L::Mask::splat(true).bits();
            for group in self.hits.groups {
                let p = load3::<L>(&s.p, group.place());
                match group.bits == all {
                    true => points.hold_all(p),
                    false => points.hold(L::Mask::from_bits(group.bits), p),
                }
            }
        }
        points.bounds()
    }

    /// The same of hits that all lie on one `primitive`.
    #[inline(always)]
    fn surfaces_of<L: Lane<Elem = E>, const AT_EYE: bool, S: Known>(&self, primitive: S, s: &mut Surfaces<E>) {
        let (rays, hits, tables) = (self.hits.rays, self.hits.hits, self.world.tables());
        for group in self.hits.groups {
            let g = group.place();
            let d = load3::<L>(&rays.d, g);
            let o = if AT_EYE { [L::zero(); 3] } else { load3::<L>(&rays.o, g) };
            let at = (L::load(&hits.t[g..]), L::load(&hits.part[g..]));
            let surface = primitive.surface::<L, AT_EYE>(tables, (o, d), at);
            self.keep(group, d, &surface, s);
        }
    }

    /// The same of hits on one surface or on several.
    #[inline(always)]
    fn surfaces_of_many<L: Lane<Elem = E>, const AT_EYE: bool>(&self, s: &mut Surfaces<E>) {
        let (rays, hits) = (self.hits.rays, self.hits.hits);
        for group in self.hits.groups {
            let g = group.place();
            let d = load3::<L>(&rays.d, g);
            let o = if AT_EYE { [L::zero(); 3] } else { load3::<L>(&rays.o, g) };
            let at = (L::load(&hits.t[g..]), L::load(&hits.part[g..]));
            let ids = L::load(&hits.id[g..]);
            let live = L::Mask::from_bits(group.bits);
            if let Some(mesh) = self.mesh {
                let ids = L::select(live, ids, L::splat(mesh.first as f64));
                let surface = surface_of_mesh(mesh, ids, (o, d));
                self.keep(group, d, &surface, s);
                continue;
            }
            let id = hits.id[g + group.bits.trailing_zeros() as usize];
            let surface = self.world.surface::<L, AT_EYE>(id.to_f64() as u32, (o, d), at);
            self.keep(group, d, &surface, s);
            // Mostly that is all; the surfaces of others are put over it, one after another.
            let mut rest = group.bits & !ids.same(L::splat(id.to_f64())).bits();
            while rest != 0 {
                let id = hits.id[g + rest.trailing_zeros() as usize].to_f64();
                let here = ids.same(L::splat(id));
                self.keep_another(g, id as u32, (o, d), at, here, s);
                rest &= !here.bits();
            }
        }
    }

    /// Keeps the surfaces that the rays of `group`, along `d`, met.
    #[inline(always)]
    fn keep<L: Lane<Elem = E>>(&self, group: &LaneGroup, d: [L; 3], surface: &Surface<L>, s: &mut Surfaces<E>) {
        let g = group.place();
        let inside = L::zero().lt(dot(surface.n, d));
        let faced = FacedBy { inside };
        store3(&mut s.p, g, surface.p);
        let mut n = surface.n;
        if inside.any() {
            n = faced.face(n); // mostly nothing is seen from within
        }
        store3(&mut s.n, g, n);
        if self.bent {
            let mut ns = surface.ns;
            if self.frame.has_bump() {
                ns = bumped(&self.frame, self.spaces, surface.local, surface.n, ns);
            }
            store3(&mut s.ns, g, faced.face(ns));
        }
        if self.surfacing.patterned {
            store3(&mut s.local, g, surface.local);
        }
        surface.offset.store(&mut s.offset[g..]);
        L::select(inside, L::one(), L::zero()).store(&mut s.inside[g..]);
        s.all_outside &= inside.bits() & group.bits == 0;
    }

    /// Keeps surface `id` in the lanes of `here`; in a function of its own, for kernels are large. Such runs have no pattern, and
    /// so no bump.
    #[inline(always)]
    fn keep_another<L: Lane<Elem = E>>(
        &self,
        g: usize,
        id: u32,
        ray: ([L; 3], [L; 3]),
        at: (L, L),
        here: L::Mask,
        s: &mut Surfaces<E>,
    ) {
        L::vectorize(
            #[inline(always)]
            || {
                let surface = self.world.surface::<L, false>(id, ray, at);
                let inside = L::zero().lt(dot(surface.n, ray.1));
                let faced = FacedBy { inside };
                put3(&mut s.p, g, here, surface.p);
                put3(&mut s.n, g, here, faced.face(surface.n));
                put3(&mut s.ns, g, here, faced.face(surface.ns));
                s.all_outside &= !(inside & here).any();
                let inside = L::select(inside, L::one(), L::zero());
                L::select(here, surface.offset, L::load(&s.offset[g..])).store(&mut s.offset[g..]);
                L::select(here, inside, L::load(&s.inside[g..])).store(&mut s.inside[g..]);
            },
        );
    }
}

/// The surfaces where rays meet triangles of `mesh`, each lane its own; in a function of its own, for it is large.
#[inline(always)]
fn surface_of_mesh<L: Lane>(mesh: &Mesh, ids: L, ray: ([L; 3], [L; 3])) -> Surface<L> {
    L::vectorize(
        #[inline(always)]
        || mesh.surfaces(ids - L::splat(mesh.first as f64), ray),
    )
}
