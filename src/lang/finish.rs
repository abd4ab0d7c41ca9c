//! The last look at a scene: what can only be seen when it is whole. Shapes must keep a supported size where they stand
//! in the world, and the pictures that they show are opened.

use super::build::AssetFile;
use super::load::{Loader, read, reason};
use super::measure::{is_measurable, misplaced, misplaced_light};
use super::{mesh, picture};
use crate::diag::{Diagnostic, Diagnostics};
use crate::math::Affine;
use crate::scene::{Color, Image, ImageId, Material, NodeId, NodeKind, PatternId, PatternKind, Scene, Shape};
use std::collections::{HashMap, HashSet};
use std::ops::ControlFlow;

/// Checks the scene and loads its pictures.
pub fn finish(
    scene: &mut Scene,
    (pictures, mesh_files): (&[AssetFile], &[AssetFile]),
    loader: &mut Loader,
) -> Diagnostics {
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
    if !mesh_files.is_empty() {
        let failed = mesh::load_meshes(scene, mesh_files, loader);
        if !failed.is_empty() || loader.is_cancelled() {
            return failed;
        }
    }
    let mut materials = HashSet::new();
    let mut surfaces = 0u64;
    let mut bad: HashSet<NodeId> = HashSet::new();
    let cancelled = scene.try_for_each_instance(|i| {
        if loader.is_cancelled() {
            return ControlFlow::Break(());
        }
        let node = scene.node(i.node);
        let place = match &node.kind {
            NodeKind::Shape(shape) => {
                materials.insert(i.material);
                surfaces = surfaces.saturating_add(match shape {
                    Shape::Mesh { mesh, .. } => 1 + scene.mesh(*mesh).data.triangles.len() as u64,
                    _ => 1,
                });
                if surfaces > loader.limits.surfaces && !mesh_files.is_empty() {
                    errors.push(mesh::too_many(&loader.limits, node));
                    return ControlFlow::Break(());
                }
                misplaced(scene, shape, &i.world_from_object)
            }
            NodeKind::Light(light) => misplaced_light(light.at, &i.world_from_object),
            _ => None,
        };
        if let Some((why, right)) = place
            && bad.insert(i.node)
            && bad.len() <= 10
        {
            let what = if let NodeKind::Shape(s) = &node.kind { s.word() } else { "light" };
            errors.push(
                Diagnostic::error(format!("this {what} {why}"))
                    .at(node.place.span, "where its groups and transforms put it")
                    .note(right)
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
    errors.extend(unmeasurable(scene, &live));
    errors.extend(load_pictures(scene, pictures, loader, live));
    errors
}

/// Patterns that their transforms, all together, scale or move out of the numbers.
fn unmeasurable(scene: &Scene, live: &[PatternId]) -> Diagnostics {
    let (mut errors, mut bad) = (Vec::new(), HashSet::new());
    let mut seen: HashSet<(PatternId, [u64; 12])> = HashSet::new();
    let mut stack: Vec<(PatternId, Affine)> = live.iter().map(|id| (*id, Affine::IDENTITY)).collect();
    while let Some((id, around)) = stack.pop() {
        let (linear, shift) = (around.linear_f64(), around.shift_f64());
        let bits = |i: usize| linear.as_flattened().iter().chain(&shift).nth(i).map_or(0, |x| x.to_bits());
        if !seen.insert((id, std::array::from_fn(bits))) {
            continue;
        }
        let pattern = scene.pattern(id);
        let mut inside = around;
        if let PatternKind::Transformed { parent_from_child, .. } = &pattern.kind {
            match parent_from_child.inverse().map(|m| m.compose(&around)).filter(is_measurable) {
                Some(map) => inside = map,
                None => {
                    if bad.insert(id) && bad.len() <= 10 {
                        let d = Diagnostic::error("this pattern is scaled or moved beyond all measure");
                        let d = d.note("what counts is all transforms around it together");
                        errors.push(match pattern.span {
                            Some(span) => d.at(span, "here it is too much"),
                            None => d,
                        });
                    }
                    continue;
                }
            }
        }
        stack.extend(pattern.kind.children().into_iter().map(|child| (child, inside)));
    }
    errors
}

fn slots(m: &Material) -> impl Iterator<Item = PatternId> {
    [m.color, m.ambient, m.diffuse, m.specular, m.shininess, m.reflect, m.transmit].into_iter().chain(m.bump)
}

/// Opens the pictures that `live` patterns show. Patterns that nothing shows become black, so that no picture is missing.
fn load_pictures(
    scene: &mut Scene,
    pictures: &[AssetFile],
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

fn open(file: &AssetFile, loader: &mut Loader) -> Result<Image, Diagnostic> {
    let (path, _, dependency) = loader.find(file.file, &file.path, file.span)?;
    let refuse = |why: String| Diagnostic::error(format!("can't show `{}`: {why}", file.path)).at(file.span, "");
    let bytes = read(&path, picture::FILE_BYTES).map_err(|e| refuse(reason(&e)))?;
    let digest = loader.was_read(dependency, &path, &bytes);
    let decode = || picture::decode(&path, bytes, digest, &loader.limits);
    let picture = loader.store.pictures.get(digest, decode).map_err(refuse)?;
    Ok(Image { path, ..picture })
}
