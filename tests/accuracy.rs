//! Pictures that are asked for by their error, from outside: is it kept, is it told, is it the same each time?

use serde_json::Value;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};
use tempfile::TempDir;

/// Edges of all kinds, a checker that runs to the horizon, a mirror, a pane, a shadow; small, for debug builds too.
const TABLE: &str = "\
camera(from: [0, 2, 8], at: [0, 0.6, 0], fov: 40deg)
background(linear(0.4, 0.6, 0.9))
light(at: [6, 9, 7])
plane(y: 0, mat: phong(color: checker(white, green)))
sphere(at: [-1, 1, 0], r: 1, mat: phong(color: red, reflect: 0.3))
cylinder(from: [1.4, 0, 1], to: [1.4, 1.5, 1], r: 0.5, mat: phong(color: blue, transmit: 0.5))
";

struct Desk(TempDir);

impl Desk {
    fn new() -> Desk {
        let desk = Desk(tempfile::tempdir().unwrap());
        fs::write(desk.path("table.scene"), format!("{TABLE}render(size: [48, 32])\n")).unwrap();
        fs::write(desk.path("asks.scene"), format!("{TABLE}render(size: [48, 32], error: 8/255)\n")).unwrap();
        desk
    }
    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
    fn run(&self, arguments: &str) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rtdsl"));
        command.args(arguments.split_whitespace()).current_dir(self.0.path()).output().unwrap()
    }
    /// What `--stats json` says of a picture's accuracy, and what was said on standard error.
    fn accuracy(&self, exit: i32, arguments: &str) -> (Value, String) {
        let out = self.run(&format!("render {arguments} --stats json"));
        let said = String::from_utf8(out.stderr).unwrap();
        assert_eq!(out.status.code(), Some(exit), "{arguments}: {said}");
        let stats: Value = serde_json::from_slice(&out.stdout).unwrap();
        (stats["accuracy"].clone(), said)
    }
    fn usage_error(&self, arguments: &str) -> String {
        let out = self.run(&format!("render {arguments}"));
        assert_eq!(out.status.code(), Some(2), "{arguments}");
        String::from_utf8(out.stderr).unwrap()
    }
    fn codes(&self, name: &str) -> Vec<f64> {
        let image = image::open(self.path(name)).unwrap();
        image.into_rgb16().iter().map(|c| *c as f64 / 257.0).collect()
    }
}

fn count(accuracy: &Value, of: &str) -> u64 {
    accuracy[of].as_u64().unwrap()
}

#[test]
fn the_error_asked_for_is_kept_and_told() {
    let desk = Desk::new();
    let (fine, _) = desk.accuracy(0, "table.scene --max-error 0.5/255 --bits 16 -o fine.png");
    assert_eq!(count(&fine, "open"), 0, "{fine}");
    for (codes, argument) in [(16.0, "--quality draft"), (4.0, "--max-error 4/255"), (2.0, "--max-error 2/255")] {
        let (a, said) = desk.accuracy(0, &format!("table.scene {argument} --strict -o picture.png"));
        let kinds = ["proved", "bounded", "estimated", "open"].map(|k| count(&a, k));
        assert_eq!(kinds.iter().sum::<u64>(), 48 * 32, "{a}");
        assert!(kinds[3] == 0 && kinds[0] * 10 > 48 * 32 * 9, "{a}");
        assert!(
            a["worst"].as_f64().unwrap() <= codes / 255.0 && a["reached"].as_f64().unwrap() == codes / 255.0,
            "{a}"
        );
        let line = a["line"].as_str().unwrap();
        assert!(line.starts_with(&format!("max error {codes}/255: ")) && line.ends_with(", 0 open"), "{line}");
        assert_eq!(said.trim_end(), line);
        // In the file, too.
        let file = fs::read(desk.path("picture.png")).unwrap();
        assert!(String::from_utf8_lossy(&file).contains(line));
        let (picture, fine) = (desk.codes("picture.png"), desk.codes("fine.png"));
        let worst =
            picture.iter().zip(&fine).map(|(a, b)| (a - b).abs()).fold(0.0, |m: f64, e| if e > m { e } else { m });
        assert!(worst <= codes + 0.5, "{argument}: {worst}");
        // A picture of fewer codes than were asked for would be luck: the bound isn't idle.
        assert!(worst > 0.5, "{argument}: {worst}");
    }
}

#[test]
fn threads_and_instructions_change_no_byte() {
    let desk = Desk::new();
    for (name, threads) in [("one.png", 1), ("three.png", 3)] {
        desk.accuracy(0, &format!("table.scene --max-error 4/255 --threads {threads} -o {name}"));
    }
    assert_eq!(fs::read(desk.path("one.png")).unwrap(), fs::read(desk.path("three.png")).unwrap());
    // The scene may ask for the same; then only the recipe is another.
    let (a, _) = desk.accuracy(0, "asks.scene -o asks.png");
    let (b, _) = desk.accuracy(0, "table.scene --max-error 8/255 -o told.png");
    assert_eq!((&a, desk.codes("asks.png")), (&b, desk.codes("told.png")));
    // And rays a pixel on the command line replace it.
    assert_eq!(desk.accuracy(0, "asks.scene --aa off -o off.png").0, Value::Null);
    let (finer, _) = desk.accuracy(0, "asks.scene --max-error 4/255 -o finer.png");
    assert_eq!(finer["asked_error"], 4.0 / 255.0);
}

#[test]
fn limited_time_says_what_it_reached() {
    let desk = Desk::new();
    // More than enough for the last round.
    let (all, _) = desk.accuracy(0, "table.scene --time 10min --strict -o all.png");
    assert_eq!((count(&all, "open"), all["reached"].as_f64()), (0, Some(1.0 / 255.0)), "{all}");
    // Not enough for the first: every pixel is there, and told to be open.
    let big = "table.scene --size 1200x800 --time 1ms";
    let (none, said) = desk.accuracy(0, &format!("{big} -o none.png"));
    assert!(count(&none, "open") > 0 && said.contains("open"), "{none}");
    let kinds = ["proved", "bounded", "estimated", "open"].map(|k| count(&none, k));
    assert_eq!(kinds.iter().sum::<u64>(), 1200 * 800);
    let (lit, all) = (desk.codes("none.png").chunks(3).filter(|c| c.iter().any(|v| *v > 0.0)).count(), 1200 * 800);
    assert!(lit * 10 > all * 9, "{lit} of {all} pixels show something");
    desk.accuracy(4, &format!("{big} --strict -o strict.png"));
    assert!(desk.path("strict.png").exists(), "the picture is made all the same");
}

#[test]
fn maps_show_error_and_status() {
    let desk = Desk::new();
    let maps = "--error-map e.png --status-map s.png";
    let (a, _) = desk.accuracy(0, &format!("table.scene --max-error 4/255 --crop 8,4,30,20 {maps} -o p.png"));
    let status = image::open(desk.path("s.png")).unwrap().into_rgb8();
    assert_eq!(status.dimensions(), (30, 20));
    let green = status.pixels().filter(|p| p.0 == [0, 158, 115]).count() as u64;
    assert_eq!(green, count(&a, "proved"));
    let error = image::open(desk.path("e.png")).unwrap().into_luma8();
    let brightest = error.pixels().map(|p| p.0[0]).max().unwrap() as f64;
    let worst = a["worst"].as_f64().unwrap() * 255.0 / 4.0;
    assert!((brightest / 255.0 - worst).abs() < 0.01, "{brightest} {worst}");
    // Numbers for programs; every pixel keeps what it is told to keep.
    desk.accuracy(0, "table.scene --max-error 4/255 --error-map e.exr -o p.png");
    let numbers = image::open(desk.path("e.exr")).unwrap().into_rgb32f();
    assert!(numbers.iter().all(|e| (0.0..=4.0 / 255.0 + 1e-6).contains(e)));
    assert!(numbers.iter().any(|e| *e > 1.0 / 255.0));
}

#[test]
fn what_cant_be_had_together_is_told() {
    let desk = Desk::new();
    for (arguments, words) in [
        ("table.scene --max-error 2/255 --aa grid:2", "cannot be used with"),
        ("table.scene --max-error 2/255 --quality fine", "cannot be used with"),
        ("table.scene --max-error 2/255 -o p.hdr", "an `.hdr` file can't keep a stated error"),
        ("table.scene --max-error 2/255 --precision f32", "a picture with a stated error needs 64 bits"),
        ("table.scene --max-error 0.4/255", "less than this file's colours can tell apart"),
        ("table.scene --max-error 2", "an error is a share of white"),
        ("table.scene --strict", "`--strict` is for pictures with a stated error"),
        ("table.scene --error-map e.png", "`--error-map` is for pictures with a stated error"),
        ("table.scene --confidence 0.9", "`--confidence` is for pictures with a stated error"),
        ("table.scene --max-error 2/255 -o p.png --status-map p.png", "`--status-map` needs a file of its own"),
        ("table.scene --time 2days", "`days` is no unit of time here"),
    ] {
        let said = desk.usage_error(arguments);
        assert!(said.contains(words), "{arguments}: {said}");
    }
    let left: Vec<_> = fs::read_dir(desk.0.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(left.len(), 2, "only the scenes: {left:?}");
}
