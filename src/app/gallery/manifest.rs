//! What the gallery's folder holds and what it was made of: `gallery.json`. By it the next run knows what still holds, and
//! which files are its own.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The manifest's name in the gallery's folder.
pub const FILE: &str = "gallery.json";

/// Who makes it.
const MADE_BY: &str = "rtdsl gallery";

/// Of the manifest's form; another number's isn't understood.
const FORMAT: u32 = 1;

/// The manifest. Everything is sorted and of whole numbers, so that the same content is the same bytes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    format: u32,
    /// Tells the file apart from others of its name.
    made_by: String,
    /// The way from here to the folder of the scenes.
    pub folder: String,
    /// Digest of everything that the pages show; empty where they must be made anew.
    pub site: String,
    /// What is known of each scene, by its name.
    pub scenes: BTreeMap<String, Entry>,
    /// BLAKE3 of every other file that the gallery made, by its name in the gallery's folder.
    pub files: BTreeMap<String, String>,
}

/// What is known of a scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Digest of all that decides the picture: the files below, the options, the renderer.
    pub key: String,
    /// Every file that was read, the scene itself first.
    pub files: Vec<Used>,
    /// The picture; `None` where there is none: the file only exports, or was never right.
    pub figures: Option<Figures>,
    /// What is wrong with the scene as it is now; the rest is from when it was right.
    pub broken: Option<String>,
}

/// A file that a picture depends on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Used {
    /// Its path, from the folder of the scenes.
    pub path: String,
    /// BLAKE3 of its bytes.
    pub digest: String,
    /// Whether it is a text of the language; a picture otherwise.
    pub text: bool,
}

/// What a picture took and what it is like.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// Pixels across and down.
    pub size: [u32; 2],
    /// What to tell `rtdsl render` besides the scene to get this very picture.
    pub view: Vec<String>,
    /// Pixels across and down of the small picture; `None` where the picture is small itself.
    pub thumbnail: Option<[u32; 2]>,
    /// Rays a pixel, along one side of their grid; 1 is a single ray.
    pub grid: u32,
    /// The most rays a pixel where only those get more that differ from their neighbours.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub adaptive: Option<u32>,
    /// How a pixel's light is weighed, where that isn't the box.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub filter: Option<String>,
    /// Reflections and transmissions one after another.
    pub max_depth: u32,
    /// `f64` or `f32`.
    pub precision: String,
    /// Rays from the camera, towards lights, mirrored, gone through.
    pub rays: [u64; 4],
    /// Abilities of the renderer that the scene required.
    pub features: Vec<String>,
    /// [`Film::hash`](crate::film::Film::hash).
    pub image_hash: String,
    /// The scene's parameters.
    pub params: Vec<ParamRow>,
    /// What the picture took when it was made. A picture that comes out the same when it is made again keeps its times.
    pub times: Times,
}

/// A parameter, in words.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParamRow {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: String,
    /// Which values it takes.
    pub allowed: String,
    /// What it is for.
    pub description: String,
}

/// Microseconds of wall-clock time by phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Times {
    /// Text to syntax.
    pub parse: u64,
    /// Syntax to scene.
    pub evaluate: u64,
    /// Scene to world.
    pub world: u64,
    /// World to film.
    pub render: u64,
    /// Film to file.
    pub encode: u64,
    /// Threads that traced.
    pub threads: usize,
}

impl Manifest {
    /// That of a gallery that doesn't exist yet, of the scenes in `folder`.
    pub fn new(folder: String) -> Manifest {
        Manifest {
            format: FORMAT,
            made_by: MADE_BY.into(),
            folder,
            site: String::new(),
            scenes: BTreeMap::new(),
            files: BTreeMap::new(),
        }
    }

    /// The manifest that `bytes` hold. `Ok(None)` where it is lost: there is nothing, or something damaged (as a merge leaves
    /// it), or another version's. That costs time, nothing else.
    ///
    /// # Errors
    /// They are something else, of another program.
    pub fn read(bytes: &[u8]) -> Result<Option<Manifest>, Foreign> {
        let Ok(value) = serde_json::from_slice::<serde_json::Value>(bytes) else { return Ok(None) };
        if value.get("made_by").is_none_or(|by| by != MADE_BY) {
            return Err(Foreign);
        }
        Ok(serde_json::from_slice(bytes).ok().filter(|m: &Manifest| m.format == FORMAT))
    }

    /// The file's bytes.
    pub fn bytes(&self) -> Vec<u8> {
        // Texts, numbers, lists and maps of them always have a JSON form.
        let mut bytes = serde_json::to_vec_pretty(self).unwrap_or_default();
        bytes.push(b'\n');
        bytes
    }
}

/// A file of the manifest's name that another program made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Foreign;

impl Times {
    /// All phases together.
    pub fn total(&self) -> u64 {
        self.parse + self.evaluate + self.world + self.render + self.encode
    }
}

/// BLAKE3 of `bytes`, in hexadecimal.
pub fn digest(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

/// BLAKE3 of several texts, of which none can run into the next.
pub fn digest_of<'a>(parts: impl IntoIterator<Item = &'a str>) -> String {
    let mut hasher = blake3::Hasher::new();
    for part in parts {
        hasher.update(&(part.len() as u64).to_le_bytes());
        hasher.update(part.as_bytes());
    }
    hasher.finalize().to_hex().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comes_back_the_same() {
        let mut m = Manifest::new("../examples".into());
        for name in ["b", "a"] {
            m.scenes.insert(name.into(), Entry::default());
        }
        let bytes = m.bytes();
        let read = Manifest::read(&bytes).unwrap().unwrap();
        assert_eq!((read.bytes(), read), (bytes, m.clone()));
        m.format += 1;
        assert_eq!(Manifest::read(&m.bytes()), Ok(None), "of a later version");
        for lost in ["", "{", "<<<<<<< HEAD\n{}", "{\"made_by\": \"rtdsl gallery\"}"] {
            assert_eq!(Manifest::read(lost.as_bytes()), Ok(None), "{lost}");
        }
        for foreign in ["{}", "[]", "1", "{\"made_by\": \"another\", \"folder\": \"x\"}"] {
            assert_eq!(Manifest::read(foreign.as_bytes()), Err(Foreign), "{foreign}");
        }
    }

    #[test]
    fn parts_don_t_run_together() {
        assert_ne!(digest_of(["ab", "c"]), digest_of(["a", "bc"]));
    }
}
