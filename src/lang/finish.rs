//! The last look at a scene: what can only be seen when it is whole. Shapes must keep a supported size where they stand
//! in the world, and the pictures that they show are opened.

use super::build::PictureFile;
use super::load::{Loader, read, reason};
use super::picture;
use super::value::number_text;
use crate::diag::{Diagnostic, Diagnostics};
use crate::scene::{Color, Image, ImageId, Material, NodeId, NodeKind, PatternId, PatternKind, Scene, Shape, range};
use glam::DVec3;
use std::collections::{HashMap, HashSet};
use std::ops::ControlFlow;

/// Checks the scene and loads its pictures.
pub fn finish(scene: &mut Scene, pictures: &[PictureFile], loader: &mut Loader) -> Diagnostics {
    let mut errors = Vec::new();
    let count = scene.instance_count();
    let most = loader.limits.instances;
    if count > most {
        let mut d = Diagnostic::error(format!("the scene has more than {most} shapes and lights"))
            .note("groups within groups multiply; a shape counts at every place where it stands");
        if let Some(root) = scene.roots.last() {
            d = d.at(scene.node(*root).place.span, "").from_place(scene.node(*root).place.clone());
        }
        return vec![d];
    }
    let mut materials = HashSet::new();
    let mut bad: HashSet<NodeId> = HashSet::new();
    let cancelled = scene.try_for_each_instance(|i| {
        if loader.is_cancelled() {
            return ControlFlow::Break(());
        }
        let node = scene.node(i.node);
        let place = match &node.kind {
            NodeKind::Shape(shape) => {
                materials.insert(i.material);
                misplaced(shape, &i.world_from_object)
            }
            NodeKind::Light(light) => {
                let at = i.world_from_object.apply(light.at);
                (at.abs().max_element() > range::LARGEST || !at.is_finite()).then(|| "is too far away".to_owned())
            }
            _ => None,
        };
        if let Some(why) = place
            && bad.insert(i.node)
            && bad.len() <= 10
        {
            let what = if let NodeKind::Shape(s) = &node.kind { s.word() } else { "light" };
            errors.push(
                Diagnostic::error(format!("this {what} {why}"))
                    .at(node.place.span, "where its groups and transforms put it")
                    .note("a length or coordinate is 0, or from 1e-140 to 1e140 in size")
                    .from_place(node.place.clone()),
            );
        }
        ControlFlow::Continue(())
    });
    if cancelled.is_break() {
        return errors;
    }
    let mut live: Vec<PatternId> = Vec::new();
    for id in materials {
        let m = scene.material(id);
        live.extend(slots(m));
    }
    errors.extend(load_pictures(scene, pictures, loader, live));
    errors
}

fn slots(m: &Material) -> impl Iterator<Item = PatternId> {
    [m.color, m.ambient, m.diffuse, m.specular, m.shininess, m.reflect, m.transmit].into_iter().chain(m.bump)
}

/// Opens the pictures that `live` patterns show. Patterns that nothing shows become black, so that no picture is missing.
fn load_pictures(
    scene: &mut Scene,
    pictures: &[PictureFile],
    loader: &mut Loader,
    mut stack: Vec<PatternId>,
) -> Diagnostics {
    let mut errors = Vec::new();
    let mut live = HashSet::new();
    while let Some(id) = stack.pop() {
        if live.insert(id) {
            stack.extend(scene.pattern(id).kind.children());
        }
    }
    let mut opened: HashMap<ImageId, ImageId> = HashMap::new();
    let mut tried = HashSet::new();
    let Scene { patterns, images, .. } = scene;
    for (i, pattern) in patterns.iter_mut().enumerate() {
        let PatternKind::Image { image, .. } = &mut pattern.kind else { continue };
        if live.contains(&PatternId(i as u32))
            && tried.insert(*image)
            && let Some(file) = pictures.get(image.0 as usize)
        {
            if loader.is_cancelled() {
                return errors;
            }
            match open(file, loader) {
                Ok(picture) => {
                    opened.insert(*image, ImageId(images.len() as u32));
                    images.push(picture);
                }
                Err(d) => errors.push(d),
            }
        }
        match opened.get(image) {
            Some(id) => *image = *id,
            None => pattern.kind = PatternKind::Constant(Color::BLACK),
        }
    }
    errors
}

fn open(file: &PictureFile, loader: &mut Loader) -> Result<Image, Diagnostic> {
    let (path, _, dependency) = loader.find(file.file, &file.path, file.span)?;
    let refuse = |why: String| Diagnostic::error(format!("can't show `{}`: {why}", file.path)).at(file.span, "");
    let bytes = read(&path, picture::FILE_BYTES).map_err(|e| refuse(reason(&e)))?;
    let digest = loader.was_read(dependency, &path, &bytes);
    let decode = || picture::decode(&path, &bytes, digest, &loader.limits);
    let picture = loader.memory.pictures.get(digest, decode).map_err(refuse)?;
    Ok(Image { path, ..picture })
}

/// Why a shape can't be traced where it stands.
fn misplaced(shape: &Shape, world_from_object: &crate::math::Affine) -> Option<String> {
    let m = world_from_object.linear_f64();
    let column = |c: usize| DVec3::new(m[0][c], m[1][c], m[2][c]).abs().max_element();
    let (a, b, c) = (column(0), column(1), column(2));
    let (least, most) = (a.min(b).min(c), a.max(b).max(c));
    let usable = |x: f64| x.is_finite() && range::is_supported(x) && x != 0.0;
    if !usable(least) || !usable(most) || world_from_object.inverse().is_none() {
        return Some("is scaled beyond all measure".into());
    }
    let (points, small, large) = extent(shape);
    if small * least < range::SMALLEST {
        return Some(format!("is too small: about {}", number_text(small * least)));
    }
    let far = points.iter().map(|p| world_from_object.apply(*p).abs().max_element()).fold(large * most, f64::max);
    if far > range::LARGEST || !far.is_finite() {
        return Some("is too large or too far away".into());
    }
    None
}

/// Points of a shape, its smallest and its largest size; 1 where it has none.
fn extent(shape: &Shape) -> (Vec<DVec3>, f64, f64) {
    let edges = |p: &[DVec3]| {
        let sizes = p.iter().skip(1).map(|q| (*q - p[0]).abs().max_element());
        sizes.fold((f64::INFINITY, 0f64), |(lo, hi), s| (lo.min(s), hi.max(s)))
    };
    match shape {
        Shape::Sphere { at, r } => (vec![*at], *r, *r),
        Shape::Plane { through, .. } => (vec![*through], 1.0, 1.0),
        Shape::Box { from, to } => (vec![*from, *to], (*to - *from).min_element(), (*to - *from).max_element()),
        Shape::Disc { at, r, .. } => (vec![*at], *r, *r),
        Shape::Cylinder { from, to, r, .. } => (vec![*from, *to], *r, *r),
        Shape::Cone { from, to, r, top, .. } => (vec![*from, *to], r.max(*top), r.max(*top)),
        Shape::Torus { at, r, tube, .. } => (vec![*at], *tube, r + tube),
        Shape::Triangle { points, .. } => {
            let (lo, hi) = edges(points);
            (points.to_vec(), lo, hi)
        }
        Shape::Tetrahedron { points } => {
            let (lo, hi) = edges(points);
            (points.to_vec(), lo, hi)
        }
    }
}
