//! The hits of one run, and what shading keeps of each between its passes.

use super::batch::{Column, Column3, HitColumns, RayBatch};
use super::material::Surfacing;
use super::pattern_point::Rows;
use super::run::LaneGroup;
use super::shape::{Kind, Mesh};
use super::surface_pattern::PatternFrame;
use super::world::World;
use crate::math::real::{Mask, select3};
use crate::math::{Elem, Lane};

/// The hits of one run.
#[derive(Clone, Copy)]
pub struct Hits<'a, E: Elem> {
    /// The primitive that stands for all that were met.
    pub flock: u32,
    /// The one surface that all of them met, or [`MANY`].
    pub only: u32,
    /// The rays.
    pub rays: &'a RayBatch<E>,
    /// What they met.
    pub hits: &'a HitColumns<E>,
    /// Which of the rays.
    pub groups: &'a [LaneGroup],
    /// How many they are.
    pub count: usize,
}

/// A run and what all its hits have in common.
pub struct RunOfHits<'a, E: Elem> {
    /// What is looked at.
    pub world: &'a World,
    /// The material.
    pub surfacing: &'a Surfacing,
    /// Where its patterns stand.
    pub frame: PatternFrame<'a>,
    /// The maps from there to their spaces.
    pub spaces: &'a [Rows],
    /// Whether shading normals may differ from geometric ones.
    pub bent: bool,
    /// The hits.
    pub hits: Hits<'a, E>,
    /// The mesh, where that is what was met.
    pub mesh: Option<&'a Mesh>,
}

impl<'a, E: Elem> RunOfHits<'a, E> {
    /// Looks up what `hits` have in common; `spaces` gives room for their patterns' maps.
    pub fn new(world: &'a World, hits: Hits<'a, E>, spaces: &'a mut Vec<Rows>) -> Self {
        let (primitive, surfacing) = (world.primitive(hits.flock), world.surfacing(hits.flock));
        let frame = PatternFrame::new(world, primitive, surfacing, spaces);
        let bent = surfacing.bump.is_some() || primitive.kind.may_be_smooth();
        let mesh = match primitive.kind {
            Kind::Mesh(i) => world.meshes.get(i as usize),
            _ => None,
        };
        RunOfHits { world, surfacing, frame, spaces, bent, hits, mesh }
    }
}

/// Where rays met surfaces, at the rays' own places.
#[derive(Default)]
pub struct Surfaces<E: Elem> {
    /// Points.
    pub p: Column3<E>,
    /// Geometric normals on the viewer's side.
    pub n: Column3<E>,
    /// Shading normals; only where they are others.
    pub ns: Column3<E>,
    /// Points in the shapes' own frames; only where a pattern asks.
    pub local: Column3<E>,
    /// How far along the normal a new ray starts.
    pub offset: Column<E>,
    /// 1 where the ray comes from inside.
    pub inside: Column<E>,
    /// Whether all come from outside.
    pub all_outside: bool,
}

impl<E: Elem> Surfaces<E> {
    /// Shading normals, of hits that are `bent` or not.
    #[inline(always)]
    pub fn shading_normals(&self, bent: bool) -> &Column3<E> {
        if bent { &self.ns } else { &self.n }
    }
}

/// Turns normals to the viewer's side, and back.
pub struct FacedBy<M> {
    /// Where the viewer is inside.
    pub inside: M,
}

impl<M: Mask> FacedBy<M> {
    /// The normal `n` turned where the viewer is inside.
    #[inline(always)]
    pub fn face<L: Lane<Mask = M>>(&self, n: [L; 3]) -> [L; 3] {
        select3(self.inside, [-n[0], -n[1], -n[2]], n)
    }
}
