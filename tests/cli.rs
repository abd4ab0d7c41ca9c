//! The program from outside: exit codes, standard input and output, files, and the forms that other programs read.

use serde_json::Value;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// A red ball before a blue sky, lit from the eye; 16 x 12 pixels.
const BALL: &str = "\
param radius: 1 in 0.1..=2 \"of the ball\"
camera(from: [0, 0, 5], at: [0, 0, 0], fov: 40deg)
camera(\"top\", from: [0, 5, 0], at: [0, 0, 0], up: [0, 0, -1], fov: 40deg)
background(linear(0, 0, 1))
light(at: [0, 0, 50])
sphere(at: [0, 0, 0], r: radius, mat: phong(color: linear(1, 0, 0)))
render(size: [16, 12])
";
/// Two independent mistakes.
const WRONG: &str = "sphere(at: [0, 0, 0], raduis: 1)\nsphere(at: [0, 0, 0], r: unknown)\n";

/// A folder with both scenes, gone when dropped.
struct Desk(TempDir);

impl Desk {
    fn new() -> Desk {
        let desk = Desk(tempfile::tempdir().unwrap());
        fs::write(desk.path("ball.scene"), BALL).unwrap();
        fs::write(desk.path("wrong.scene"), WRONG).unwrap();
        desk
    }
    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
    /// Runs the program here with `arguments`, divided at spaces.
    fn run(&self, arguments: &str) -> Output {
        self.run_with(arguments, b"")
    }
    fn run_with(&self, arguments: &str, input: &[u8]) -> Output {
        let mut child = Command::new(env!("CARGO_BIN_EXE_rtdsl"))
            .args(arguments.split_whitespace())
            .current_dir(self.0.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // A program that doesn't read its input may have closed it already.
        let _ = child.stdin.take().unwrap().write_all(input);
        child.wait_with_output().unwrap()
    }
    /// Runs it, expects `exit`, gives both outputs as text.
    fn expect(&self, exit: i32, arguments: &str) -> (String, String) {
        let out = self.run(arguments);
        let (stdout, stderr) = (text(&out.stdout), text(&out.stderr));
        assert_eq!(out.status.code(), Some(exit), "rtdsl {arguments}\n{stdout}{stderr}");
        (stdout, stderr)
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

fn pixels(path: &Path) -> image::RgbImage {
    image::open(path).unwrap().to_rgb8()
}

#[test]
fn a_picture_and_nothing_else() {
    let desk = Desk::new();
    let (stdout, stderr) = desk.expect(0, "render ball.scene");
    assert_eq!((stdout.as_str(), stderr.as_str()), ("", ""), "not on a terminal: no bar, no summary");
    assert_eq!(desk.names(), ["ball.png", "ball.scene", "wrong.scene"]);
    let picture = pixels(&desk.path("ball.png"));
    assert_eq!(picture.dimensions(), (16, 12));
    assert_eq!(picture.get_pixel(0, 0).0, [0, 0, 255], "the sky");
    let middle = picture.get_pixel(8, 6).0;
    assert!(middle[0] > 200 && middle[1] == 0 && middle[2] == 0, "the ball: {middle:?}");
}

#[test]
fn wrong_scenes_write_nothing() {
    let desk = Desk::new();
    let (stdout, stderr) = desk.expect(1, "render wrong.scene");
    assert_eq!(stdout, "");
    assert!(stderr.contains("wrong.scene:1:") && stderr.contains("wrong.scene:2:"), "both mistakes: {stderr}");
    assert!(stderr.ends_with("\n2 errors\n"), "{stderr}");
    assert_eq!(desk.names(), ["ball.scene", "wrong.scene"]);
    fs::write(desk.path("wrong.png"), "old").unwrap();
    desk.expect(1, "render wrong.scene");
    assert_eq!(fs::read(desk.path("wrong.png")).unwrap(), b"old");
}

#[test]
fn usage_errors() {
    let desk = Desk::new();
    for arguments in [
        "",
        "paint ball.scene",
        "render",
        "render ball.scene --size 0x4",
        "render ball.scene --size 1000000000x1000000000",
        "render ball.scene --size 65536x65536",
        "render ball.scene --size 4",
        "render ball.scene --aa grid:0",
        "render ball.scene --aa grid:33",
        "render ball.scene --filter sinc",
        "render ball.scene --max-depth 101",
        "render ball.scene --threads 0",
        "render ball.scene --precision f16",
        "render ball.scene --bits 12",
        "render ball.scene --bits 16 -o x.exr",
        "render ball.scene --compression zip",
        "render ball.scene --compression small -o x.exr",
        "render ball.scene --set radius",
        "render ball.scene --crop 0,0,0,5",
        "render ball.scene --crop 10,0,7,1",
        "render ball.scene --camera tpo",
        "render ball.scene -o x.jpg",
        "render ball.scene -o x",
        "explain ball.scene 16,0",
        "explain ball.scene 1",
        "help no-such-word",
        "verify --only no-such-check",
        "verify --only energy ball.scene",
        "verify --json --markdown",
    ] {
        let (stdout, stderr) = desk.expect(2, arguments);
        assert!(stdout.is_empty() && !stderr.is_empty(), "rtdsl {arguments}");
    }
    assert_eq!(desk.names(), ["ball.scene", "wrong.scene"]);
    let (_, stderr) = desk.expect(2, "render ball.scene --camera tpo");
    assert!(stderr.contains("did you mean `top`?") && stderr.contains("it has: top"), "{stderr}");
    let (_, stderr) = desk.expect(2, "render ball.scene -o x.jpg");
    assert!([".png", ".exr", ".hdr"].iter().all(|e| stderr.contains(e)), "{stderr}");
}

#[test]
fn system_errors() {
    let desk = Desk::new();
    for arguments in ["render missing.scene", "check missing.scene", "render ball.scene -o no/such/folder.png"] {
        let (stdout, stderr) = desk.expect(3, arguments);
        assert!(stdout.is_empty() && stderr.starts_with("error: "), "{stderr}");
    }
    fs::create_dir(desk.path("folder.png")).unwrap();
    desk.expect(3, "render ball.scene -o folder.png");
    assert_eq!(desk.names(), ["ball.scene", "folder.png", "wrong.scene"]);
}

#[test]
fn inputs_are_never_overwritten() {
    let desk = Desk::new();
    fs::rename(desk.path("ball.scene"), desk.path("ball.png")).unwrap();
    desk.expect(2, "render ball.png");
    assert_eq!(fs::read_to_string(desk.path("ball.png")).unwrap(), BALL);
}

#[test]
fn pipes() {
    let desk = Desk::new();
    let out = desk.run_with("render - -o -", BALL.as_bytes());
    assert_eq!(out.status.code(), Some(0), "{}", text(&out.stderr));
    desk.expect(0, "render ball.scene -o file.png");
    let file = fs::read(desk.path("file.png")).unwrap();
    assert_eq!(out.stdout, file, "the same bytes by both ways");
    let out = desk.run_with("render -", BALL.as_bytes());
    assert_eq!(out.stdout, file, "standard output unless it is a terminal");
    let out = desk.run_with("render - -o - --stats json", BALL.as_bytes());
    assert_eq!(out.stdout, file, "standard output is the picture's");
    assert!(serde_json::from_slice::<Value>(&out.stderr).unwrap()["rays"].is_object());
    let out = desk.run_with("check -", b"sphere(r: )");
    assert_eq!(out.status.code(), Some(1));
    assert!(text(&out.stderr).contains("<stdin>:1:"));
}

/// `rtdsl … | head -c 0`: no message, no panic.
#[test]
fn closed_pipes_are_quiet() {
    let desk = Desk::new();
    for arguments in ["render ball.scene -o -", "help", "params ball.scene", "check ball.scene", "completions bash"] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let out = Command::new(env!("CARGO_BIN_EXE_rtdsl"))
            .args(arguments.split_whitespace())
            .current_dir(desk.0.path())
            .stdout(writer)
            .stderr(Stdio::piped())
            .output()
            .unwrap();
        assert_eq!((out.status.code(), text(&out.stderr).as_str()), (Some(3), ""), "rtdsl {arguments}");
    }
}

#[test]
fn stats_json_has_every_field() {
    let desk = Desk::new();
    let (stdout, _) = desk.expect(0, "render --stats json ball.scene --threads 2 --aa grid:2");
    let stats: Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!(stats["size"], serde_json::json!([16, 12]));
    assert_eq!(stats["threads"], 1, "one tile is work for one");
    assert_eq!((&stats["precision"], &stats["filter"]), (&"f64".into(), &"box".into()));
    assert_eq!(stats["samples_per_pixel"], 4.0);
    assert_eq!(stats["rays"]["camera"], 16 * 12 * 4);
    for phase in ["parse", "evaluate", "world", "render", "encode", "total"] {
        assert!(stats["seconds"][phase].as_f64().unwrap() >= 0.0, "{phase}");
    }
    assert!(stats["features"].is_array());
    assert_eq!(stats["image_hash"].as_str().unwrap().len(), 64);
    if cfg!(target_os = "linux") {
        assert!(stats["peak_memory_bytes"].as_u64().unwrap() > 0);
    }
    let (stdout, _) = desk.expect(0, "render --stats ball.scene");
    assert!(stdout.starts_with("size               16x12\n"), "{stdout}");
}

#[test]
fn the_same_picture_for_any_threads_and_part() {
    let desk = Desk::new();
    for (name, more) in [("one", "--threads 1"), ("three", "--threads 3"), ("part", "--crop 5,3,7,4")] {
        desk.expect(0, &format!("render ball.scene -o {name}.png {more}"));
    }
    let whole = pixels(&desk.path("one.png"));
    assert_eq!(fs::read(desk.path("one.png")).unwrap(), fs::read(desk.path("three.png")).unwrap());
    let part = image::imageops::crop_imm(&whole, 5, 3, 7, 4).to_image();
    assert_eq!(pixels(&desk.path("part.png")), part);
}

#[test]
fn the_command_line_wins() {
    let desk = Desk::new();
    desk.expect(0, "render ball.scene -o small.png --set radius=0.2 --size 31x31");
    let picture = pixels(&desk.path("small.png"));
    assert_eq!(picture.dimensions(), (31, 31));
    let red = picture.pixels().filter(|p| p.0[0] > 0).count();
    // 31 pixels see 2·5·tan 20° = 3.64 units: a radius of 1.7 pixels, an area of 9.
    assert!((5..15).contains(&red), "a small ball: {red} pixels");
    desk.expect(1, "render ball.scene --set radius=3");
    desk.expect(1, "render ball.scene --set raduis=1");
    std::fs::write(desk.path("far.scene"), "sphere(at: [0, 0, 1e30], r: 1e29)\nlight(at: [0, 1, 0])\n").unwrap();
    desk.expect(0, "render far.scene --size 4x3");
    let (_, stderr) = desk.expect(1, "render far.scene --size 4x3 --precision f32");
    assert!(stderr.contains("32-bit") && stderr.contains("far.scene:1:1"), "{stderr}");
    desk.expect(0, "render ball.scene --camera top --precision f32 --max-depth 0 --aa grid:3 -o top.png");
}

#[test]
fn filters_from_the_text_and_the_command_line() {
    let desk = Desk::new();
    let hash = |arguments: &str, filter: &str| {
        let (stdout, _) = desk.expect(0, &format!("render --stats json ball.scene -o f.png {arguments}"));
        let stats: Value = serde_json::from_str(&stdout).unwrap();
        assert_eq!(stats["filter"], filter, "{arguments}");
        stats["image_hash"].as_str().unwrap().to_owned()
    };
    let plain = hash("--aa grid:3", "box");
    assert_eq!(hash("--aa grid:3 --filter box", "box"), plain);
    let sharp = hash("--aa grid:3 --filter mitchell", "mitchell");
    let file = fs::File::open(desk.path("f.png")).unwrap();
    let reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().unwrap();
    let recipe = &reader.info().uncompressed_latin1_text;
    let settings = recipe.iter().find(|t| t.keyword == "rtdsl:settings").unwrap();
    assert!(settings.text.contains(" aa=grid:3 filter=mitchell "), "{}", settings.text);
    let soft = hash("--aa grid:3 --filter gauss", "gauss");
    assert!(plain != sharp && plain != soft && sharp != soft);
    assert_eq!(hash("--aa off --filter gauss", "gauss"), hash("--aa off", "box"), "one ray is shown as it is");
    let stated = hash("--max-error 8/255 --filter gauss --threads 1", "gauss");
    assert_eq!(hash("--max-error 8/255 --filter gauss --threads 3", "gauss"), stated);
    assert_ne!(hash("--max-error 8/255", "box"), stated);
}

#[test]
fn formats_and_recipes() {
    let desk = Desk::new();
    desk.expect(0, "render ball.scene --bits 16 --set radius=0.5 -o a.png");
    let file = fs::File::open(desk.path("a.png")).unwrap();
    let reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().unwrap();
    assert_eq!(reader.info().bit_depth, png::BitDepth::Sixteen);
    let recipe = &reader.info().uncompressed_latin1_text;
    let of = |key: &str| recipe.iter().find(|t| t.keyword == key).map(|t| t.text.as_str()).unwrap();
    assert!(of("Software").starts_with("rtdsl "));
    assert_eq!(of("rtdsl:scene").len(), 64);
    assert!(of("rtdsl:settings").starts_with("size=16x12 aa=off max-depth="));
    assert_eq!(of("rtdsl:parameters"), "radius=0.5");
    // However it is compressed, it is the same picture.
    for compression in ["fast", "small"] {
        desk.expect(0, &format!("render ball.scene --size 90x70 --compression {compression} -o {compression}.png"));
    }
    let picture = |name: &str| image::open(desk.path(name)).unwrap().to_rgb8();
    let length = |name: &str| fs::metadata(desk.path(name)).unwrap().len();
    assert!(picture("fast.png") == picture("small.png") && length("small.png") < length("fast.png"));
    for name in ["a.exr", "a.hdr"] {
        desk.expect(0, &format!("render ball.scene -o {name}"));
        let picture = image::open(desk.path(name)).unwrap().to_rgb32f();
        assert_eq!(picture.get_pixel(0, 0).0, [0.0, 0.0, 1.0], "linear");
    }
}

#[test]
fn check_reads_many_and_tells_the_worst() {
    let desk = Desk::new();
    let (stdout, stderr) = desk.expect(0, "check ball.scene");
    assert_eq!((stdout.as_str(), stderr.as_str()), ("ball.scene: ok\n", ""));
    let (stdout, _) = desk.expect(1, "check ball.scene wrong.scene");
    assert_eq!(stdout, "ball.scene: ok\n");
    desk.expect(3, "check wrong.scene missing.scene ball.scene");
    // A file for others to import shows nothing, which is no mistake.
    fs::write(desk.path("lib.scene"), "export let leaf = sphere()\n").unwrap();
    let (stdout, stderr) = desk.expect(0, "check lib.scene");
    assert_eq!((stdout.as_str(), stderr.as_str()), ("lib.scene: ok\n", ""));
    let (stdout, stderr) = desk.expect(1, "check --json ball.scene wrong.scene");
    assert_eq!(stderr, "");
    let all: Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!((&all[0]["ok"], &all[1]["ok"]), (&Value::Bool(true), &Value::Bool(false)));
    let first = &all[1]["diagnostics"][0];
    assert_eq!((&first["severity"], &first["file"]), (&"error".into(), &"wrong.scene".into()));
    assert_eq!((&first["line"], &first["column"], &first["end_column"]), (&1.into(), &23.into(), &29.into()));
    assert!(first["message"].as_str().unwrap().contains("raduis"));
}

#[test]
fn params_as_text_and_json() {
    let desk = Desk::new();
    let (stdout, _) = desk.expect(0, "params ball.scene --set radius=1.5");
    assert_eq!(stdout, "radius = 1.5 (default 1)  number from 0.1 to 2  of the ball\n");
    let (stdout, _) = desk.expect(0, "params ball.scene --json");
    let params: Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!((&params[0]["name"], &params[0]["kind"]), (&"radius".into(), &"number".into()));
    assert_eq!(params[0]["range"], serde_json::json!([0.1, 2.0]));
    assert_eq!(params[0]["place"], "ball.scene:1:7");
    desk.expect(1, "params wrong.scene");
}

#[test]
fn explain_the_scene_and_a_pixel() {
    let desk = Desk::new();
    let (stdout, _) = desk.expect(0, "explain ball.scene");
    assert!(stdout.starts_with("ball.scene: 16x12, 1 ray a pixel\n"), "{stdout}");
    assert!(stdout.contains("Required by this scene") && stdout.contains("Not required"), "{stdout}");
    let (stdout, _) = desk.expect(0, "explain ball.scene 0,0");
    assert_eq!(stdout, "pixel 0,0 sees the background\n");
    let (stdout, _) = desk.expect(0, "explain ball.scene 8,6");
    assert!(stdout.starts_with("pixel 8,6 sees sphere\n  made at      ball.scene:6:1  sphere("), "{stdout}");
    assert!(stdout.contains("ball.scene:5:1"), "the light's line: {stdout}");
}

#[test]
fn help_knows_words_and_commands() {
    let desk = Desk::new();
    let (stdout, _) = desk.expect(0, "help");
    assert!(stdout.contains("Usage: rtdsl") && stdout.contains("torus"), "{stdout}");
    let (stdout, _) = desk.expect(0, "help sphere");
    assert!(stdout.contains("sphere") && stdout.contains("r:"), "{stdout}");
    let (stdout, _) = desk.expect(0, "help render");
    assert!(stdout.contains("rtdsl render --help"), "a word and a command: {stdout}");
    let (_, stderr) = desk.expect(2, "help spere");
    assert!(stderr.contains("did you mean `sphere`?"), "{stderr}");
    desk.expect(0, "--version");
}

#[test]
fn verify_as_text_json_and_markdown() {
    let desk = Desk::new();
    let (stdout, stderr) = desk.expect(0, "verify --only treeless --only energy ball.scene");
    assert_eq!(stderr, "", "not on a terminal: no bar");
    assert!(stdout.starts_with("rtdsl ") && stdout.contains("; quick programme\n"), "{stdout}");
    assert!(
        stdout.contains("\nenergy: ") && stdout.contains("\ntreeless: "),
        "in the order of the programme: {stdout}"
    );
    assert!(stdout.contains("All figures of 2 checks are within their bounds"), "{stdout}");
    assert!(!stdout.contains('\u{1b}'), "no colours for a pipe");

    let (stdout, _) = desk.expect(0, "verify --only treeless --only energy --json ball.scene");
    let report: Value = serde_json::from_str(&stdout).unwrap();
    // The fields are those that docs/verify.md tells of, and all of those.
    let docs = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/verify.md")).unwrap();
    let tables: Vec<&str> = docs.split("| field | what it is |").skip(1).collect();
    assert_eq!(tables.len(), 3);
    let check = &report["checks"][0];
    for (object, table) in [&report, check, &check["figures"][0]].into_iter().zip(tables) {
        let rows = table.lines().filter_map(|l| l.strip_prefix("| `")?.split_once(" |")).map(|(names, _)| names);
        let mut told: Vec<&str> = rows.flat_map(|names| names.split("`, `")).map(|n| n.trim_matches('`')).collect();
        told.sort_unstable();
        let fields: Vec<&String> = object.as_object().unwrap().keys().collect();
        assert_eq!(fields, told);
    }
    assert_eq!((&report["schema"], &report["size"], &report["kept"]), (&1.into(), &"quick".into(), &true.into()));
    assert_eq!(report["scenes"], serde_json::json!(["ball.scene"]));
    assert_eq!((&check["name"], &report["checks"][1]["name"]), (&"energy".into(), &"treeless".into()));
    let bins = check["figures"][0]["histogram"].as_array().unwrap();
    assert_eq!(bins.iter().map(|b| b[1].as_u64().unwrap()).sum::<u64>(), 4_000, "every case of the first form");
    assert_eq!(bins.last().unwrap()[0], Value::Null);

    let (stdout, _) = desk.expect(0, "verify --only treeless --markdown ball.scene");
    assert!(stdout.contains("\n| check | figure | value | bound | kept | spread |\n|---|"), "{stdout}");

    let (_, stderr) = desk.expect(2, "verify --only treless");
    assert!(stderr.contains("did you mean `treeless`?") && stderr.contains("the checks are: quadrics"), "{stderr}");
    desk.expect(1, "verify --only treeless wrong.scene");
    desk.expect(3, "verify --only treeless missing.scene");
}
