//! The triangles of a mesh file.

use glam::DVec3;
use std::path::PathBuf;
use std::sync::Arc;

/// Names a mesh of a [`Scene`](super::Scene).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MeshId(pub u32);

/// A mesh file that a scene shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// The file.
    pub path: PathBuf,
    /// BLAKE3 of the file's bytes: equal digests mean equal triangles.
    pub digest: [u8; 32],
    /// What is in it; shared by all scenes that show the file.
    pub data: Arc<MeshData>,
}

/// Triangles between numbered points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshData {
    /// Every coordinate is finite and [supported](super::range::is_supported).
    pub points: Vec<[f64; 3]>,
    /// The three corners of each triangle, in `points`: at least one triangle, and each has an area.
    pub triangles: Vec<[u32; 3]>,
    /// Directions for a smooth look, of any length but 0; none where the file has none.
    pub normals: Vec<[f32; 3]>,
    /// The normals of each triangle's corners, in `normals`, or [`FLAT`](MeshData::FLAT); empty where they are numbered as the
    /// corners are.
    pub normals_of: Vec<[u32; 3]>,
    /// The smallest and the largest coordinates.
    pub bounds: [DVec3; 2],
}

impl MeshData {
    /// In [`normals_of`](MeshData::normals_of): a corner without a normal. Its triangle looks flat.
    pub const FLAT: u32 = u32::MAX;

    /// Triangles without normals.
    pub fn new(points: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> MeshData {
        let mut all = points.iter().map(|p| DVec3::from_array(*p));
        let first = all.next().unwrap_or_default();
        let bounds = all.fold([first; 2], |[lo, hi], p| [lo.min(p), hi.max(p)]);
        MeshData { points, triangles, bounds, ..MeshData::default() }
    }

    /// The corners of triangle `k`.
    pub fn corners(&self, k: usize) -> [DVec3; 3] {
        self.triangles[k].map(|i| DVec3::from_array(self.points[i as usize]))
    }

    /// The numbers of the normals at the corners of triangle `k`, if it has them all.
    pub fn normals_of(&self, k: usize) -> Option<[u32; 3]> {
        let numbers = match self.normals_of.is_empty() {
            true => self.triangles[k],
            false => self.normals_of[k],
        };
        (!self.normals.is_empty() && !numbers.contains(&MeshData::FLAT)).then_some(numbers)
    }
}
