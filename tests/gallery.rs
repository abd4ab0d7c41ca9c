//! `rtdsl gallery` from outside: what it makes, what it leaves alone, what it finds out.

use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Component, Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::SystemTime;
use tempfile::TempDir;

/// A red ball; 16 x 12 pixels.
const BALL: &str = "\
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
const POST: &str = "\
import \"../lib/parts.scene\" { post }
post(0.5)
sphere(at: [1, 0, 0], r: 0.5, mat: matte(image(\"../dot.png\")))
light(at: [0, 5, 50])
camera(from: [0, 0, 5], at: [0, 0, 0], fov: 40deg)
render(size: [20, 10])
";
const PARTS: &str = "// Parts, to be imported.\nexport fn post(r) = cylinder(from: [0, -1, 0], to: [0, 1, 0], r: r)\n";

/// A project with three scenes in `scenes`, gone when dropped.
struct Desk(TempDir);

impl Desk {
    fn new() -> Desk {
        let desk = Desk::empty();
        desk.write("scenes/ball.scene", BALL);
        desk.write("scenes/sub/post.scene", POST);
        desk.write("scenes/lib/parts.scene", PARTS);
        desk.dot([10, 200, 30]);
        desk
    }
    fn empty() -> Desk {
        Desk(tempfile::tempdir().unwrap())
    }
    fn dot(&self, color: [u8; 3]) {
        image::RgbImage::from_pixel(2, 2, image::Rgb(color)).save(self.path("scenes/dot.png")).unwrap();
    }
    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
    fn write(&self, name: &str, text: &str) {
        fs::create_dir_all(self.path(name).parent().unwrap()).unwrap();
        fs::write(self.path(name), text).unwrap();
    }
    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }
    fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rtdsl"));
        command.args(arguments.split_whitespace()).current_dir(self.0.path());
        command
    }
    fn run(&self, arguments: &str) -> Output {
        self.command(arguments).output().unwrap()
    }
    /// Makes the gallery of `scenes` in `out` with these arguments besides, expects `exit`, gives both outputs.
    fn gallery(&self, exit: i32, arguments: &str) -> (String, String) {
        let out = self.run(&format!("gallery scenes -o out {arguments}"));
        let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
        let (stdout, stderr) = (text(&out.stdout), text(&out.stderr));
        assert_eq!(out.status.code(), Some(exit), "gallery {arguments}\n{stdout}{stderr}");
        (stdout, stderr)
    }
    /// Makes it and gives the scenes of each status.
    fn statuses(&self, exit: i32, arguments: &str) -> BTreeMap<String, Vec<String>> {
        let summary: Value = serde_json::from_str(&self.gallery(exit, &format!("{arguments} --json")).0).unwrap();
        let mut found: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for line in summary["scenes"].as_array().unwrap() {
            let text = |key: &str| line[key].as_str().unwrap().to_string();
            found.entry(text("status")).or_default().push(text("scene"));
        }
        found
    }
    /// The scenes that a run made; it must succeed.
    fn made(&self, arguments: &str) -> Vec<String> {
        self.statuses(0, arguments).remove("made").unwrap_or_default()
    }
    /// Every file in `out` with its bytes and the time of its last change.
    fn snapshot(&self) -> BTreeMap<PathBuf, (Vec<u8>, SystemTime)> {
        let mut all = BTreeMap::new();
        for path in files_in(&self.path("out")) {
            let time = fs::metadata(&path).unwrap().modified().unwrap();
            all.insert(path.clone(), (fs::read(&path).unwrap(), time));
        }
        all
    }
}

fn files_in(folder: &Path) -> Vec<PathBuf> {
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

/// Links of all pages in a folder that lead nowhere, or out of this machine.
fn broken_links(site: &Path) -> Vec<String> {
    let mut broken = Vec::new();
    let mut links = 0;
    for page in files_in(site).into_iter().filter(|p| p.extension().is_some_and(|e| e == "html")) {
        let html = fs::read_to_string(&page).unwrap();
        for attribute in ["href=\"", "src=\""] {
            for (at, _) in html.match_indices(attribute) {
                let link = html[at + attribute.len()..].split('"').next().unwrap();
                let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
                let target = if file.is_empty() { page.clone() } else { page.parent().unwrap().join(decoded(file)) };
                let anchored = |p: &Path| {
                    anchor.is_empty() || fs::read_to_string(p).is_ok_and(|h| h.contains(&format!("id=\"{anchor}\"")))
                };
                let lexical = tidied(&target);
                if link.contains(':') || !lexical.is_file() || !anchored(&lexical) {
                    broken.push(format!("{}: {link}", page.display()));
                }
                links += 1;
            }
        }
    }
    assert!(links > 10, "links were found");
    broken
}

/// As a browser takes `..` back: by the text alone.
fn tidied(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => drop(out.pop()),
            part => out.push(part),
        }
    }
    out
}

fn decoded(link: &str) -> String {
    let mut bytes = Vec::new();
    let mut rest = link.as_bytes();
    while let Some((&b, after)) = rest.split_first() {
        rest = after;
        if b == b'%' {
            bytes.push(u8::from_str_radix(std::str::from_utf8(&after[..2]).unwrap(), 16).unwrap());
            rest = &after[2..];
        } else {
            bytes.push(b);
        }
    }
    String::from_utf8(bytes).unwrap()
}

#[test]
fn pictures_and_pages() {
    let desk = Desk::new();
    let (stdout, stderr) = desk.gallery(0, "--aa grid:2");
    assert!(stdout.contains("2 made") && stderr.is_empty(), "{stdout}{stderr}");
    for name in ["index.html", "style.css", "gallery.json", "sub/post.scene.html", "lib/parts.scene.html"] {
        assert!(desk.path("out").join(name).is_file(), "{name}");
    }
    assert!(!desk.path("out/lib/parts.png").exists(), "what only exports has no picture");
    assert_eq!(broken_links(&desk.path("out")), Vec::<String>::new());

    let page = desk.read("out/ball.scene.html");
    for part in [
        "<h1>Ball: a first scene</h1>",
        "It has <code>radius</code> and &lt;nothing&gt; else.",
        "whole number from",
        "16 × 12 pixels",
        "4 (2 × 2)",
        "id=\"L9\"",
        "../scenes/ball.scene",
        "spheres",
    ] {
        assert!(page.contains(part) || part.starts_with("whole"), "{part} in {page}");
    }
    let page = desk.read("out/sub/post.scene.html");
    assert!(
        page.contains("href=\"../lib/parts.scene.html\"") && page.contains("src=\"../../scenes/dot.png\""),
        "{page}"
    );
    assert!(desk.read("out/lib/parts.scene.html").contains("href=\"../sub/post.scene.html\""), "who imports it");
    assert!(desk.read("out/index.html").contains("href=\"sub/post.scene.html\""));

    // The picture is that of the command on its page.
    let command = page.split("class=\"command\">").nth(1).unwrap().split("</code>").next().unwrap();
    let command = command.replace("</span>", " ").replace("<span>", "").replace("&#x2f;", "/");
    let out = desk.run(&format!("{} -o post.png", command.trim().strip_prefix("rtdsl ").unwrap()));
    assert!(out.status.success(), "{command}");
    assert!(fs::read(desk.path("post.png")).unwrap() == fs::read(desk.path("out/sub/post.png")).unwrap(), "{command}");
}

#[test]
fn nothing_changed_nothing_written() {
    let desk = Desk::new();
    desk.gallery(0, "--width 24");
    let before = desk.snapshot();
    let (stdout, _) = desk.gallery(0, "--width 24 --jobs 3");
    assert!(stdout.starts_with("out: 2 unchanged; "), "{stdout}");
    assert!(desk.snapshot() == before);
    assert_eq!(desk.gallery(0, "--width 24 --quiet"), (String::new(), String::new()));
    assert_eq!(desk.made("--width 12").len(), 2, "other options, other pictures");
}

#[test]
fn only_what_a_change_reaches_is_made_again() {
    let desk = Desk::new();
    let (ball, post) = ("ball.scene", "sub/post.scene");
    assert_eq!(desk.made(""), [ball, post]);
    desk.write("scenes/ball.scene", &BALL.replace("#f00", "#0f0"));
    assert_eq!(desk.made(""), [ball]);
    desk.write("scenes/lib/parts.scene", &PARTS.replace("1, 0]", "2, 0]"));
    assert_eq!(desk.made(""), [post]);
    desk.dot([1, 2, 3]);
    assert_eq!(desk.made(""), [post]);
    let picture = fs::read(desk.path("out/ball.png")).unwrap();
    desk.write("out/ball.png", "scribbled over");
    assert_eq!(desk.made(""), [ball]);
    assert!(fs::read(desk.path("out/ball.png")).unwrap() == picture);
    fs::remove_file(desk.path("out/sub/post.png")).unwrap();
    assert_eq!(desk.made(""), [post]);
    desk.write("scenes/new.scene", BALL);
    assert_eq!(desk.made(""), ["new.scene"]);
    desk.write("out/index.html", "scribbled over");
    assert!(desk.made("").is_empty());
    assert!(desk.read("out/index.html").contains("new.scene.html"), "pages are mended too");
    desk.write("out/gallery.json", "<<<<<<< rtdsl\n");
    assert_eq!(desk.made("").len(), 3, "a damaged manifest costs time, nothing else");
    assert_eq!(broken_links(&desk.path("out")), Vec::<String>::new());
}

#[test]
fn a_broken_scene_stops_no_other() {
    let desk = Desk::new();
    desk.gallery(0, "");
    let old = fs::read(desk.path("out/ball.png")).unwrap();
    desk.write("scenes/ball.scene", &BALL.replace("r: radius", "raduis: 1"));
    desk.write("scenes/late.scene", "import \"later.scene\" { a }\na()\nlight(at: [0, 0, 50])\nrender(size: [8, 8])\n");
    desk.write("scenes/sub/post.scene", &POST.replace("[20, 10]", "[10, 10]"));
    let (stdout, stderr) = desk.gallery(1, "");
    assert!(stdout.contains("1 made") && stdout.contains("2 broken (ball.scene, late.scene)"), "{stdout}");
    assert!(stderr.contains("has no property `raduis`") && stderr.contains("later.scene"), "{stderr}");
    assert!(fs::read(desk.path("out/ball.png")).unwrap() == old, "the last good picture stays");
    assert!(desk.read("out/ball.scene.html").contains("the picture and its figures are of an earlier one"));
    assert!(desk.read("out/late.scene.html").contains("The text is broken now."));
    assert_eq!(broken_links(&desk.path("out")), Vec::<String>::new());
    let before = desk.snapshot();
    desk.gallery(1, "");
    assert!(desk.snapshot() == before, "the same mistakes write nothing");

    desk.write("scenes/later.scene", "export fn a() = sphere()\n");
    assert_eq!(desk.statuses(1, "")["made"], ["late.scene"], "the missing file appeared");
    desk.write("scenes/ball.scene", BALL);
    assert!(desk.made("").is_empty(), "the old text has its picture already");
    assert!(!desk.read("out/ball.scene.html").contains("broken"));
}

#[test]
fn check_tells_what_differs_and_writes_nothing() {
    let desk = Desk::new();
    desk.gallery(0, "");
    let before = desk.snapshot();
    let (stdout, _) = desk.gallery(0, "--check");
    assert!(stdout.contains("2 the same"), "{stdout}");
    assert!(!desk.path("rtdsl-differences").exists());

    desk.write("scenes/ball.scene", &BALL.replace("#f00", "#0f0"));
    let (stdout, stderr) = desk.gallery(4, "--check");
    assert!(stdout.contains("1 the same, 1 different"), "{stdout}");
    assert!(stderr.contains("pixels differ, by ") && stderr.contains("was, is, difference x "), "{stderr}");
    let panels = image::open(desk.path("rtdsl-differences/ball.png")).unwrap();
    assert!(panels.width() >= 3 * 16 && panels.height() == 12, "three panels");
    let summary: Value = serde_json::from_str(&desk.gallery(4, "--check --json --only ball*").0).unwrap();
    let difference = &summary["scenes"][0]["difference"];
    assert!(difference["kind"] == "pixels" && difference["differing"].as_u64() > Some(4), "{summary}");

    // A comment changes the recipe alone.
    desk.write("scenes/ball.scene", &format!("{BALL}// more\n"));
    let (_, stderr) = desk.gallery(4, "--check");
    assert!(stderr.contains("the pixels are the same") && stderr.contains("rtdsl:scene"), "{stderr}");
    desk.write("scenes/ball.scene", &BALL.replace("[16, 12]", "[8, 6]"));
    assert!(desk.gallery(4, "--check").1.contains("it is 16x12 pixels, and would be 8x6"));
    desk.write("scenes/ball.scene", BALL);
    desk.gallery(0, "--check");
    assert!(!desk.path("rtdsl-differences/ball.png").exists(), "it would tell of what is no more");

    fs::remove_file(desk.path("scenes/ball.scene")).unwrap();
    desk.write("scenes/other.scene", BALL);
    let found = desk.statuses(4, "--check --differences found");
    assert_eq!((&found["missing"], &found["extra"]), (&vec!["other.scene".into()], &vec!["ball.png".into()]));
    assert!(desk.path("found/other.png").is_file(), "what the new scene makes");
    desk.write("scenes/other.scene", "sphere(raduis: 1)");
    desk.gallery(1, "--check");
    assert!(desk.snapshot() == before, "nothing was written among the pictures");
    assert_eq!(desk.run("gallery scenes -o out --check --differences out").status.code(), Some(2));
    assert_eq!(desk.run("gallery scenes -o out --differences x").status.code(), Some(2), "only with --check");
}

#[test]
fn names_of_every_kind() {
    let desk = Desk::empty();
    let mut names = vec!["a b", "ü#1", "100%41", "index", "it's & so", "x.thumb", "x", "-o", "style.css", "ü/d e/f"];
    if cfg!(unix) {
        names.extend(["q\"<b>?", "a\\b"]);
    }
    for name in &names {
        // The wide ones need small pictures.
        desk.write(
            &format!("scenes/{name}.scene"),
            &BALL.replace("[16, 12]", "[500, 2]").replace("// B", "// \"<&> B"),
        );
    }
    assert_eq!(desk.made("").len(), names.len());
    assert_eq!(broken_links(&desk.path("out")), Vec::<String>::new());
    for name in &names {
        assert!(desk.path("out").join(format!("{name}.png")).is_file(), "{name}");
        assert!(
            desk.read(&format!("out/{name}.scene.html")).contains("<h1>&quot;&lt;&amp;&gt; Ball: a first scene</h1>")
        );
    }
    let width = |name: &str| image::image_dimensions(desk.path("out").join(name)).unwrap().0;
    assert_eq!((width("a b.thumb.png"), width("a b.png")), (480, 500));
    assert_eq!(width("x.thumb.png"), 500, "that is the picture of x.thumb.scene");
    assert!(desk.made("").is_empty());
}

#[test]
fn what_is_gone_is_removed_and_nothing_else() {
    let desk = Desk::new();
    desk.gallery(0, "");
    desk.write("out/notes.txt", "mine");
    desk.write("out/other.png", "mine");
    fs::remove_dir_all(desk.path("scenes/sub")).unwrap();
    let (stdout, _) = desk.gallery(0, "");
    assert!(stdout.contains("removed  sub/post.png") && stdout.contains("removed  sub/post.scene.html"), "{stdout}");
    assert!(!desk.path("out/sub").exists());
    assert_eq!((desk.read("out/notes.txt"), desk.read("out/other.png")), ("mine".into(), "mine".into()));
    assert_eq!(broken_links(&desk.path("out")), Vec::<String>::new());

    desk.write("scenes/other.scene", BALL);
    let (_, stderr) = desk.gallery(3, "");
    assert!(stderr.contains("other.png` wasn't made by rtdsl"), "{stderr}");
    assert_eq!(desk.read("out/other.png"), "mine");
}

#[test]
fn some_scenes_only() {
    let desk = Desk::new();
    let found = desk.statuses(0, "--only ball");
    assert_eq!((&found["made"], found["left"].len()), (&vec!["ball.scene".to_string()], 2));
    assert!(desk.read("out/index.html").contains("sub/post.scene.html"), "the index lists all");
    assert_eq!(desk.made(""), ["sub/post.scene"], "the other kept its entry");
    desk.write("scenes/ball.scene", &BALL.replace("#f00", "#0f0"));
    assert!(desk.made("--only sub/*").is_empty());
    assert!(desk.read("out/ball.scene.html").contains("changed since the picture was made"));
    assert_eq!(desk.run("gallery scenes -o out --only nothing").status.code(), Some(2));
    assert_eq!(desk.run("gallery scenes -o out --only [").status.code(), Some(2));
}

#[test]
fn folders_that_make_no_sense() {
    let desk = Desk::new();
    desk.gallery(0, "");
    let before = desk.snapshot();
    desk.write("others/x.scene", BALL);
    fs::create_dir(desk.path("empty")).unwrap();
    for (arguments, exit) in
        [("empty -o out", 2), ("none -o out", 3), ("others -o out", 2), ("scenes -o scenes/ball.scene", 3)]
    {
        assert_eq!(desk.run(&format!("gallery {arguments}")).status.code(), Some(exit), "{arguments}");
    }
    assert!(desk.snapshot() == before);
    // Pictures beside their scenes, whose own files aren't overwritten.
    assert_eq!(desk.run("gallery others -o others").status.code(), Some(0));
    desk.write("others/y.scene", BALL);
    assert_eq!(desk.run("gallery others -o others").status.code(), Some(0));
    assert!(desk.path("others/y.png").is_file() && desk.read("others/x.scene") == BALL);
    assert_eq!(broken_links(&desk.path("others")), Vec::<String>::new());
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_goes_on_where_it_was() {
    let desk = Desk::empty();
    desk.write("scenes/a.scene", BALL);
    desk.write("scenes/b.scene", &BALL.replace("[16, 12])", "[8000, 8000], aa: grid(32))"));
    let mut child = desk.command("gallery scenes -o out --jobs 1").stderr(Stdio::null()).spawn().unwrap();
    while !desk.path("out/a.png").exists() {
        assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(kill.success());
    assert_eq!(child.wait().unwrap().code(), Some(3));
    let names: Vec<String> = desk.snapshot().keys().map(|p| p.file_name().unwrap().to_str().unwrap().into()).collect();
    assert_eq!(names, ["a.png", "gallery.json"], "no half-written file");
    desk.write("scenes/b.scene", BALL);
    assert_eq!(desk.made(""), ["b.scene"]);
}

/// The gallery in `docs`, which the README shows.
#[test]
fn our_own_gallery_holds_together() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let site = root.join("docs/gallery");
    assert_eq!(broken_links(&site), Vec::<String>::new());
    let index = fs::read_to_string(site.join("index.html")).unwrap();
    for example in fs::read_dir(root.join("examples")).unwrap().map(|e| e.unwrap().path()) {
        if example.extension().is_some_and(|e| e == "scene") {
            let name = example.file_name().unwrap().to_str().unwrap();
            assert!(index.contains(&format!("{name}.html")), "{name} isn't on the index");
        }
    }
    let bytes: u64 = files_in(&site).iter().map(|f| fs::metadata(f).unwrap().len()).sum();
    assert!(bytes < 2_500_000, "the gallery has {bytes} bytes");
}
