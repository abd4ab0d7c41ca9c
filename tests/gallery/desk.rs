//! A project with scenes, and the program run in it.

use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::SystemTime;
use tempfile::TempDir;

/// A red ball; 16 x 12 pixels.
pub const BALL: &str = "\
rtdsl 1
// Ball: a first scene.
// It has `radius` and <nothing> else.

param radius: 1 in 0.1..=2 \"of the ball\"
sphere(r: radius, mat: phong(color: #f00))
light(at: [0, 0, 50])
camera(from: [0, 0, 5], at: [0, 0, 0], fov: 40deg)
render(size: [16, 12])
";
/// A scene that imports a function and shows a picture file.
pub const POST: &str = "\
import \"../lib/parts.scene\" { post }
post(0.5)
sphere(at: [1, 0, 0], r: 0.5, mat: matte(image(\"../dot.png\")))
light(at: [0, 5, 50])
camera(from: [0, 0, 5], at: [0, 0, 0], fov: 40deg)
render(size: [20, 10])
";
pub const PARTS: &str =
    "// Parts, to be imported.\nexport fn post(r) = cylinder(from: [0, -1, 0], to: [0, 1, 0], r: r)\n";

/// A project with three scenes in `scenes`, gone when dropped.
pub struct Desk(pub TempDir);

impl Desk {
    pub fn new() -> Desk {
        let desk = Desk::empty();
        desk.write("scenes/ball.scene", BALL);
        desk.write("scenes/sub/post.scene", POST);
        desk.write("scenes/lib/parts.scene", PARTS);
        desk.dot([10, 200, 30]);
        desk
    }
    pub fn empty() -> Desk {
        Desk(tempfile::tempdir().unwrap())
    }
    pub fn dot(&self, color: [u8; 3]) {
        image::RgbImage::from_pixel(2, 2, image::Rgb(color)).save(self.path("scenes/dot.png")).unwrap();
    }
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
    pub fn write(&self, name: &str, text: &str) {
        fs::create_dir_all(self.path(name).parent().unwrap()).unwrap();
        fs::write(self.path(name), text).unwrap();
    }
    pub fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }
    pub fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rtdsl"));
        command.args(arguments.split_whitespace()).current_dir(self.0.path());
        command
    }
    pub fn run(&self, arguments: &str) -> Output {
        self.command(arguments).output().unwrap()
    }
    /// Makes the gallery of `scenes` in `out` with these arguments besides, expects `exit`, gives both outputs.
    pub fn gallery(&self, exit: i32, arguments: &str) -> (String, String) {
        let out = self.run(&format!("gallery scenes -o out {arguments}"));
        let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
        let (stdout, stderr) = (text(&out.stdout), text(&out.stderr));
        assert_eq!(out.status.code(), Some(exit), "gallery {arguments}\n{stdout}{stderr}");
        (stdout, stderr)
    }
    /// Makes it and gives the scenes of each status.
    pub fn statuses(&self, exit: i32, arguments: &str) -> BTreeMap<String, Vec<String>> {
        let summary: Value = serde_json::from_str(&self.gallery(exit, &format!("{arguments} --json")).0).unwrap();
        let mut found: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for line in summary["scenes"].as_array().unwrap() {
            let text = |key: &str| line[key].as_str().unwrap().to_string();
            found.entry(text("status")).or_default().push(text("scene"));
        }
        found
    }
    /// The scenes that a run made; it must succeed.
    pub fn made(&self, arguments: &str) -> Vec<String> {
        self.statuses(0, arguments).remove("made").unwrap_or_default()
    }
    /// Every file in `out` with its bytes and the time of its last change.
    pub fn snapshot(&self) -> BTreeMap<PathBuf, (Vec<u8>, SystemTime)> {
        let mut all = BTreeMap::new();
        for path in files_in(&self.path("out")) {
            let time = fs::metadata(&path).unwrap().modified().unwrap();
            all.insert(path.clone(), (fs::read(&path).unwrap(), time));
        }
        all
    }
}

pub fn files_in(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => found.extend(files_in(&path)),
            false => found.push(path),
        }
    }
    found.sort();
    found
}
