//! Reads mesh files: PLY, OBJ and STL, known by their content. A format has a reader of its own; what the readers have in common,
//! checking what they read and leaving out what has no area, stands here.

mod obj;
mod ply;
mod stl;
mod words;

use super::build::AssetFile;
use super::limits::Limits;
use super::load::{Loader, read, reason};
use crate::diag::{Diagnostic, Diagnostics};
use crate::scene::{Mesh, MeshData, MeshId, Node, NodeKind, Scene, Shape, range};
use glam::DVec3;
use rayon::prelude::*;
use std::sync::Arc;

/// Largest mesh file: more than one of the most triangles.
const FILE_BYTES: usize = 2 << 30;

/// What a file says, not yet checked.
#[derive(Debug, Default)]
struct Raw {
    points: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    /// As in [`MeshData`].
    normals: Vec<[f32; 3]>,
    normals_of: Vec<[u32; 3]>,
}

/// Opens the mesh files that the scene shows. Meshes that nothing shows become empty groups, so that no mesh is missing.
pub fn load_meshes(scene: &mut Scene, files: &[AssetFile], loader: &mut Loader) -> Diagnostics {
    let mut errors = Vec::new();
    let mut opened: Vec<Option<Option<MeshId>>> = vec![None; files.len()];
    for (i, is_shown) in shown(scene).into_iter().enumerate() {
        let kind = &mut scene.nodes[i].kind;
        let NodeKind::Shape(Shape::Mesh { mesh, .. }) = kind else { continue };
        let (true, Some(file)) = (is_shown, files.get(mesh.0 as usize)) else {
            *kind = NodeKind::Group(Vec::new());
            continue;
        };
        let known = &mut opened[mesh.0 as usize];
        if known.is_none() && !loader.is_cancelled() {
            let number = MeshId(scene.meshes.len() as u32);
            *known = Some(match open(file, loader) {
                Ok(read) => {
                    scene.meshes.push(read);
                    Some(number)
                }
                Err(d) => {
                    errors.push(d);
                    None
                }
            });
        }
        match *known {
            Some(Some(number)) => *mesh = number,
            _ => *kind = NodeKind::Group(Vec::new()),
        }
    }
    errors
}

/// Which nodes are part of the scene.
fn shown(scene: &Scene) -> Vec<bool> {
    let mut is_shown = vec![false; scene.nodes.len()];
    scene.roots.iter().for_each(|r| is_shown[r.0 as usize] = true);
    // Children have smaller numbers than their parents.
    for (i, node) in scene.nodes.iter().enumerate().rev() {
        match &node.kind {
            NodeKind::Group(children) if is_shown[i] => children.iter().for_each(|c| is_shown[c.0 as usize] = true),
            NodeKind::Transformed { child, .. } if is_shown[i] => is_shown[child.0 as usize] = true,
            _ => {}
        }
    }
    is_shown
}

/// The message that there are more surfaces than numbers for them; `node` is the first beyond.
pub fn too_many(limits: &Limits, node: &Node) -> Diagnostic {
    let most = limits.surfaces;
    Diagnostic::error(format!("the scene has more than {most} triangles and other surfaces"))
        .at(node.place.span, "with this one they are too many")
        .note("the triangles of a mesh count at every place where it stands")
        .from_place(node.place.clone())
}

fn open(file: &AssetFile, loader: &mut Loader) -> Result<Mesh, Diagnostic> {
    let (path, _, dependency) = loader.find(file.file, &file.path, file.span)?;
    let refuse = |why: String| Diagnostic::error(format!("can't use `{}`: {why}", file.path)).at(file.span, "");
    let bytes = read(&path, FILE_BYTES).map_err(|e| refuse(reason(&e)))?;
    let digest = loader.was_read(dependency, &path, &bytes);
    let limits = loader.limits;
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
    let decode =
        || decode(bytes, &ending, &limits).map(|data| Mesh { path: path.clone(), digest, data: Arc::new(data) });
    let mesh = loader.store.meshes.get(digest, decode).map_err(refuse)?;
    Ok(Mesh { path, ..mesh })
}

/// The mesh that `bytes` are, of a file whose name ends in `ending`; why they are none, in words, otherwise.
pub fn decode(bytes: Vec<u8>, ending: &str, limits: &Limits) -> Result<MeshData, String> {
    let begins = |word: &[u8]| bytes.trim_ascii_start().starts_with(word);
    let has_points = || words::lines(&bytes).any(|(_, l)| l.starts_with(b"v ") || l.starts_with(b"v\t"));
    let raw = if begins(b"ply\n") || begins(b"ply\r") {
        ply::read(bytes.trim_ascii_start(), limits)?
    } else if stl::is_binary(&bytes) {
        stl::read_binary(&bytes, limits)?
    } else if begins(b"solid") && !bytes.contains(&0) {
        stl::read_text(&bytes, limits)?
    } else if ending == "stl" {
        return Err("it is damaged: not a complete STL file".into());
    } else if ending == "obj" || (!bytes.contains(&0) && has_points()) {
        obj::read(&bytes, limits)?
    } else {
        return Err("it is neither a PLY, an OBJ nor an STL file".into());
    };
    drop(bytes);
    checked(raw)
}

/// Items that a thread takes at once: some tens of microseconds.
const AT_ONCE: usize = 1 << 13;

fn checked(mut raw: Raw) -> Result<MeshData, String> {
    let supported = |x: &f64| x.abs() <= range::LARGEST; // which a NaN isn't
    if let Some(i) = raw.points.par_iter().with_min_len(AT_ONCE).position_first(|p| !p.iter().all(supported)) {
        let odd = raw.points[i].iter().find(|x| !supported(x)).copied().unwrap_or_default();
        let what = if odd.is_finite() { "beyond 1e140" } else { "not a number" };
        return Err(format!("a coordinate of point {} is {what}", i + 1));
    }
    // What is left of 0 by rounding elsewhere.
    let tiny = |x: &mut f64| {
        if !range::is_supported(*x) {
            *x = 0.0;
        }
    };
    raw.points.par_iter_mut().with_min_len(AT_ONCE).for_each(|p| p.iter_mut().for_each(tiny));
    if let Some(i) = raw.normals.iter().position(|n| !n.iter().all(|x| x.is_finite())) {
        return Err(format!("direction {} at a corner isn't a number", i + 1));
    }
    if raw.normals.contains(&[0.0; 3]) {
        let number = |i: u32| if raw.normals[i as usize] == [0.0; 3] { MeshData::FLAT } else { i };
        let of = if raw.normals_of.is_empty() { &raw.triangles } else { &raw.normals_of };
        raw.normals_of = of.iter().map(|t| t.map(|i| if i == MeshData::FLAT { i } else { number(i) })).collect();
    }
    let corner = |i: u32| DVec3::from_array(raw.points[i as usize]);
    let has_area = |t: &[u32; 3]| has_area(t.map(corner));
    if !raw.triangles.par_iter().with_min_len(AT_ONCE).all(has_area) {
        let kept: Vec<bool> = raw.triangles.iter().map(has_area).collect();
        for list in [&mut raw.triangles, &mut raw.normals_of] {
            let mut kept = kept.iter();
            list.retain(|_| kept.next() == Some(&true));
        }
    }
    if raw.triangles.is_empty() {
        return Err("it has no triangles".into());
    }
    let Raw { points, triangles, normals, normals_of } = raw;
    Ok(MeshData { normals, normals_of, ..MeshData::new(points, triangles) })
}

/// Whether the corners of a triangle aren't on one line.
fn has_area([a, b, c]: [DVec3; 3]) -> bool {
    let (e1, e2) = (b - a, c - a);
    if e1.cross(e2) != DVec3::ZERO {
        return true;
    }
    // Perhaps it is only so small that its area is below all numbers.
    let size = e1.abs().max(e2.abs()).max_element();
    size > 0.0 && (e1 / size).cross(e2 / size) != DVec3::ZERO
}

/// The number of a point, of which there are `count`, by its place in the file.
fn point_number(x: f64, count: usize, face: usize) -> Result<u32, String> {
    if x >= 0.0 && x < count as f64 && x.fract() == 0.0 {
        return Ok(x as u32);
    }
    Err(format!("face {face} names point {x}, counted from 0, and there are {}", plural(count, "point")))
}

fn plural(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

/// Whether what was read so far is within the limits.
fn check_size(raw: &Raw, limits: &Limits) -> Result<(), String> {
    let largest = raw.triangles.len().max(raw.points.len()) as u64;
    if largest > limits.surfaces { Err(too_large(limits)) } else { Ok(()) }
}

fn too_large(limits: &Limits) -> String {
    format!("it is too large: it has more than {} triangles or points", limits.surfaces)
}
