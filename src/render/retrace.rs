//! Renders one scene after another and traces again only the tiles in which the change can have moved a pixel. The picture
//! is the same, bit for bit, as if all of it had been traced: `tests/retrace.rs` holds that over random edits.

use super::camera::PixelGrid;
use super::census::{Change, PrimitiveKey};
use super::certify::Certificate;
use super::cull::{Shaft, margin};
use super::dispatch::{render, render_tiles};
use super::footprint::Footprint;
use super::material::MOST_SPACES;
use super::options::{Crop, Options, Progress, RayCounts, Rendered};
use super::taps::Taps;
use super::world::World;
use crate::film::Film;
use crate::math::Real;
use crate::scene::{Camera, Precision, Scene};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// A world, and what its primitives are known by in the next.
pub struct Built {
    world: Arc<World>,
    keys: Vec<PrimitiveKey>,
}

impl Built {
    /// The world.
    pub fn world(&self) -> &Arc<World> {
        &self.world
    }
}

/// Keeps the last picture and what its tiles depended on.
#[derive(Default)]
pub struct Retracer {
    before: Option<Before>,
}

struct Before {
    built: Built,
    options: Options,
    film: Arc<Film>,
    /// One a tile.
    footprints: Vec<Footprint>,
    /// Tiles into which another picture was traced that wasn't finished.
    spoilt: Vec<bool>,
}

/// A finished picture, of which some tiles may be those of the picture before.
#[derive(Clone, Debug)]
pub struct Retraced {
    /// Linear light.
    pub film: Arc<Film>,
    /// Rays traced for it.
    pub rays: RayCounts,
    /// What can be said of its error, where that was asked for.
    pub certificate: Option<Box<Certificate>>,
}

/// What has to be traced for a picture.
pub struct Plan {
    /// Whether each tile is traced.
    tiles: Vec<bool>,
    /// The picture before, where tiles of it stay.
    film: Option<Arc<Film>>,
    /// What the tiles that stay depend on, in the new world's numbers.
    footprints: Vec<Footprint>,
}

impl Plan {
    /// Tiles to trace.
    pub fn traced(&self) -> usize {
        self.tiles.iter().filter(|t| **t).count()
    }
    /// All tiles.
    pub fn tiles(&self) -> usize {
        self.tiles.len()
    }
    /// Pixels to trace.
    pub fn pixels(&self, options: &Options) -> u64 {
        let pixels = |(t, _): (Crop, &bool)| t.width as u64 * t.height as u64;
        options.tiles().into_iter().zip(&self.tiles).filter(|t| *t.1).map(pixels).sum()
    }
    /// The picture before, of which some tiles stay; `None` where there is none of this view.
    pub fn film(&self) -> Option<&Arc<Film>> {
        self.film.as_ref()
    }
}

impl Retracer {
    /// Prepares `scene` as seen by `camera`; `None` where `cancel` was set meanwhile. What is as it was in the last picture
    /// keeps its tree.
    pub fn build(&self, scene: &Scene, camera: &Camera, cancel: &AtomicBool) -> Option<Built> {
        let before = self.before.as_ref().map(|b| (&*b.built.world, &b.built.keys[..]));
        let (world, keys) = World::build_keyed(scene, camera, before, cancel)?;
        Some(Built { world: Arc::new(world), keys })
    }

    /// Finds out what has to be traced for the picture of `built`. Where `cancel` is set meanwhile it ends soon, with more to
    /// trace than needs be.
    pub fn plan(&self, built: &Built, options: &Options, cancel: &AtomicBool) -> Plan {
        let tiles = options.tiles();
        let from = self.before.as_ref().filter(|b| {
            let (old, new) = (&b.built.world, &built.world);
            // The number of threads doesn't matter.
            let same_options = Options { threads: options.threads, ..b.options.clone() } == *options;
            // Beyond that limit, how a pattern is evaluated depends on the other materials.
            let own_spaces = |w: &World| w.patterns.spaces.len() < MOST_SPACES;
            same_options && old.eye == new.eye && old.camera == new.camera && own_spaces(old) && own_spaces(new)
        });
        let Some(before) = from else {
            let n = tiles.len();
            return Plan { tiles: vec![true; n], film: None, footprints: vec![Footprint::default(); n] };
        };
        let change = Change::between(&before.built.keys, &built.keys, &built.world);
        let difference = Difference::new(&before.built.world, built, &change, options);
        let of_before = before.footprints.iter().zip(&before.spoilt);
        let moves = |(tile, (f, spoilt)): (&Crop, (&Footprint, &bool))| {
            *spoilt || cancel.load(Relaxed) || difference.moves(*tile, f)
        };
        let moved: Vec<bool> = tiles.iter().zip(of_before).map(moves).collect();
        let renumber = |ids: &[u32]| {
            let mut ids: Box<[u32]> = ids.iter().map(|&id| change.renumbered[id as usize]).collect();
            ids.sort_unstable();
            ids
        };
        let keep = |(moved, f): (&bool, &Footprint)| match moved {
            true => Footprint::default(),
            false => Footprint { seen: renumber(&f.seen), shading: renumber(&f.shading), ..f.clone() },
        };
        let footprints = moved.iter().zip(&before.footprints).map(keep).collect();
        Plan { tiles: moved, film: Some(Arc::clone(&before.film)), footprints }
    }

    /// Traces what `plan` says, which was made for the same `built` and `options`; `None` where `cancel` was set meanwhile.
    pub fn render(
        &mut self,
        built: Built,
        options: &Options,
        plan: Plan,
        progress: &dyn Progress,
        cancel: &AtomicBool,
    ) -> Option<Retraced> {
        if !options.is_by_tiles() {
            // No tile of it is kept: what a pixel depended on isn't recorded.
            let Rendered { film, rays, certificate, .. } = render(&built.world, options, progress, cancel)?;
            return Some(Retraced { film: Arc::new(film), rays, certificate });
        }
        let Plan { tiles, film, mut footprints } = plan;
        let part = options.crop_or_all();
        let mut film = match film {
            Some(film) => {
                // Ours is the last hold on it, unless it is still looked at: then it is copied.
                self.before.iter_mut().for_each(|b| b.film = Arc::new(Film::new(0, 0)));
                Arc::unwrap_or_clone(film)
            }
            None => Film::new(part.width, part.height),
        };
        let rays = render_tiles(&built.world, options, (progress, cancel), &mut film, &tiles, &mut footprints);
        let film = Arc::new(film);
        match (rays, &mut self.before) {
            (Some(rays), _) => {
                let spoilt = vec![false; tiles.len()];
                let options = options.clone();
                self.before = Some(Before { built, options, film: Arc::clone(&film), footprints, spoilt });
                Some(Retraced { film, rays, certificate: None })
            }
            (None, Some(before)) if before.film.pixels.is_empty() => {
                before.film = film;
                before.spoilt.iter_mut().zip(&tiles).for_each(|(spoilt, traced)| *spoilt |= traced);
                None
            }
            (None, _) => None,
        }
    }
}

/// The difference between two worlds that the same camera sees.
struct Difference<'w> {
    change: &'w Change,
    world: &'w World,
    grid: PixelGrid<'w>,
    /// What of other pixels' rays a tile's are made of.
    taps: Option<Taps>,
    margin: f64,
    nothing: bool,
    /// Everything seen looks different.
    ambient: bool,
    /// Everything that lights reach looks different.
    lights: bool,
    background: bool,
}

impl<'w> Difference<'w> {
    fn new(old: &World, new: &'w Built, change: &'w Change, options: &Options) -> Difference<'w> {
        let world = &*new.world;
        let same_light = |(a, b): (&_, &_)| light(a) == light(b);
        let lights = old.lights.len() != world.lights.len() || !old.lights.iter().zip(&world.lights).all(same_light);
        let unit_roundoff = match options.precision {
            Precision::F64 => <f64 as Real>::UNIT_ROUNDOFF,
            Precision::F32 => <f32 as Real>::UNIT_ROUNDOFF,
        };
        let background = old.background != world.background;
        // Without any light, materials don't ask for shadow rays at all.
        let ambient = old.ambient != world.ambient || old.lights.is_empty() != world.lights.is_empty();
        Difference {
            nothing: change.is_nothing() && !lights && !ambient && !background,
            change,
            world,
            grid: world.camera.grid(options),
            taps: Taps::of_picture(options),
            margin: margin(unit_roundoff),
            ambient,
            lights,
            background,
        }
    }

    /// Whether it can move a pixel of a tile with this footprint.
    fn moves(&self, tile: Crop, f: &Footprint) -> bool {
        if self.nothing {
            return false;
        }
        let c = self.change;
        (self.background && f.background)
            || (self.ambient && !f.seen.is_empty())
            || (self.lights && !f.lit.is_empty())
            || f.seen.iter().any(|&id| c.removed[id as usize] || c.painted[id as usize])
            || f.shading.iter().any(|&id| c.removed[id as usize])
            || (!c.adds_nothing() && self.may_meet_added(tile, f))
    }

    /// Whether a ray of the tile may meet what was added: asked of the same regions by which the tracer culls.
    fn may_meet_added(&self, tile: Crop, f: &Footprint) -> bool {
        let (c, w) = (self.change, self.world);
        let planes = || w.unbounded.iter().filter(|p| c.added_planes.contains(&p.id));
        let some = |keep: &dyn Fn(&super::bounds::Bounds) -> bool| {
            let mut found = false;
            c.added.gather(usize::MAX, keep, |_| {
                found = true;
                false
            });
            found
        };
        let (x, y) = (tile.x as f64, tile.y as f64);
        let own = [x, y, x + tile.width as f64, y + tile.height as f64];
        let rect = self.taps.as_ref().map_or(own, |taps| taps.rect(tile));
        let frustum = self.grid.frustum(rect, self.margin);
        if some(&|b| frustum.may_meet(b))
            || planes().any(|p| self.grid.may_meet_plane(rect, p.n, p.offset, self.margin))
        {
            return true;
        }
        let reached = f.beams.iter().any(|beam| {
            let cone = beam.cone(self.margin);
            some(&|b| cone.may_meet(b)) || planes().any(|p| cone.may_reach(&beam.origins, p.n, p.offset))
        });
        reached
            || f.lit.iter().any(|points| {
                w.lights.iter().any(|light| {
                    let shaft = Shaft::new(points, light.at, self.margin);
                    some(&|b| shaft.may_meet(b)) || planes().any(|p| shaft.may_cross(points, p.n, p.offset))
                })
            })
    }
}

/// What of a light changes a picture.
fn light(l: &super::world::PointLight) -> ([f64; 3], [f64; 3]) {
    (l.at, l.color)
}
