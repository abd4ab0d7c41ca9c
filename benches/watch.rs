//! How soon a saved change is seen: `cargo bench --bench watch` saves a scene again and again while `rtdsl watch` runs, in turn
//! with bare `rtdsl render`s, and prints medians and their ratios. No thresholds; figures of one run compare only with each
//! other, for machines drift.

use rtdsl::app::watch::follower::QUIET;
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Saves of each kind; even, so that each leaves the scene as it was.
const ROUNDS: usize = 20;

/// What the pictures may take, in bare renders: the debounce comes on top.
const COARSE_BOUND: f64 = 0.15;
const FINAL_BOUND: f64 = 1.1;

/// What is changed, and how: every second save takes it back.
const CHANGES: [(&str, &str, &str); 5] = [
    ("camera", "from: [0, 0, 0], at: [0, 0, -1]", "from: [0.1, 0, 0], at: [0.1, 0, -1]"),
    ("light", "light(at: [30, 45, 20])", "light(at: [31, 45, 20])"),
    ("one color", "linear(0.8, 0.2, 0.2)", "linear(0.2, 0.8, 0.2)"),
    ("one place", "from: [-12, -15, -78]", "from: [-12.1, -15, -78]"),
    ("a comment", "// A mirror ball", "// A mirror  ball"),
];

/// A scene whose world alone takes far longer to prepare than giving up may.
const MANY: &str = "for i in 0..200000 { sphere(at: [i % 500 * 0.1 - 25, floor(i / 500) * 0.1 - 20, -60], r: 0.04) }
light(at: [30, 45, 20])
render(size: [1280, 720])
";

struct Watch {
    child: Child,
    said: Receiver<Value>,
}

impl Watch {
    fn start(folder: &Path, arguments: &[&str]) -> Watch {
        let mut child = Command::new(env!("CARGO_BIN_EXE_rtdsl"))
            .args(["watch", "--json", "--serve"])
            .args(arguments)
            .current_dir(folder)
            .stdout(Stdio::piped())
            .spawn()
            .expect("rtdsl starts");
        let out = BufReader::new(child.stdout.take().expect("its output"));
        let (tell, said) = channel();
        std::thread::spawn(move || {
            for line in out.lines().map_while(Result::ok) {
                let told = serde_json::from_str(&line).is_ok_and(|v| tell.send(v).is_ok());
                if !told {
                    break;
                }
            }
        });
        Watch { child, said }
    }

    /// Everything said until the next event of this kind.
    fn until(&self, event: &str) -> Vec<Value> {
        let mut all = Vec::new();
        while all.last().is_none_or(|v: &Value| v["event"] != event) {
            all.push(self.said.recv_timeout(Duration::from_secs(60)).expect("it comes"));
        }
        all
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn main() {
    let folder = tempfile::tempdir().expect("a folder");
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    copy(&examples, folder.path());
    saves(folder.path());
    cancels(folder.path());
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).expect("made");
    for entry in std::fs::read_dir(from).expect("a folder").flatten() {
        let target = to.join(entry.file_name());
        match entry.path().is_dir() {
            true => copy(&entry.path(), &target),
            false => drop(std::fs::copy(entry.path(), target).expect("copied")),
        }
    }
}

/// From a save while a picture is being made to the moment when all threads have let go of it.
fn cancels(folder: &Path) {
    println!("\nms from the news of a save to the end of the work on the picture before; {ROUNDS} saves each");
    println!("{:<10} {:>8} {:>8}", "scene", "median", "longest");
    std::fs::write(folder.join("many.scene"), MANY).expect("written");
    for name in ["cosc363", "glass", "shell", "forest", "sea", "patterns", "many"] {
        let file = format!("{name}.scene");
        let scene = folder.join(&file);
        let text = std::fs::read_to_string(&scene).expect("read");
        // Fine enough that no picture is finished in time.
        let watch = Watch::start(folder, &["--aa", "grid:32", &file]);
        watch.until("coarse");
        let mut after = Vec::new();
        for round in 0..ROUNDS {
            std::thread::sleep(Duration::from_millis(100 + 37 * round as u64 % 300));
            std::fs::write(&scene, format!("{text}// {round}\n")).expect("written");
            let last = watch.until("cancelled").pop().expect("it came");
            after.push(last["after"].as_f64().expect("seconds") * 1e3);
        }
        println!("{name:<10} {:>8.2} {:>8.2}", median(&mut after), after.last().expect("several"));
    }
}

/// From a save to the pictures.
fn saves(folder: &Path) {
    let scene = folder.join("cosc363.scene");
    let text = std::fs::read_to_string(&scene).expect("read");
    let watch = Watch::start(folder, &["-o", "watched.png", "cosc363.scene"]);
    watch.until("picture");

    println!(
        "cosc363.scene, 1280x720; medians of {ROUNDS} saves in ms, from before the save; in turn with bare renders"
    );
    println!(
        "{:<10} {:>7} {:>7} {:>7} {:>12} {:>9} {:>11} {:>12} {:>11}",
        "change", "tiles", "coarse", "final", "bare render", "inner", "inner/bare", "coarse/bare", "final/bare"
    );
    for (name, from, to) in CHANGES {
        let (mut coarse, mut last, mut bare, mut inner, mut tiles) = (vec![], vec![], vec![], vec![], 0);
        for round in 0..ROUNDS {
            let changed = if round % 2 == 0 { text.replace(from, to) } else { text.clone() };
            assert!(round % 2 == 1 || changed != text, "{name} changes nothing");
            std::thread::sleep(Duration::from_millis(50));
            let start = SystemTime::now().duration_since(UNIX_EPOCH).expect("after 1970").as_secs_f64();
            std::fs::write(&scene, changed).expect("written");
            for event in watch.until("picture") {
                let after = (event["time"].as_f64().expect("a time") - start) * 1e3;
                match event["event"].as_str() {
                    Some("coarse") => coarse.push(after),
                    Some("picture") => {
                        last.push(after);
                        inner.push(event["total"].as_f64().expect("seconds") * 1e3);
                        tiles = event["tiles"][0].as_u64().expect("tiles");
                    }
                    _ => {}
                }
            }
            let start = Instant::now();
            let done = Command::new(env!("CARGO_BIN_EXE_rtdsl"))
                .args(["render", "cosc363.scene", "-o", "bare.png"])
                .current_dir(folder)
                .status();
            assert!(done.is_ok_and(|s| s.success()));
            bare.push(start.elapsed().as_secs_f64() * 1e3);
            let same = std::fs::read(folder.join("bare.png")).ok() == std::fs::read(folder.join("watched.png")).ok();
            assert!(same, "{name}: other bytes than `rtdsl render`'s");
        }
        let shown = |v: &mut Vec<f64>| if v.is_empty() { "-".into() } else { format!("{:.1}", median(v)) };
        println!(
            "{name:<10} {tiles:>7} {:>7} {:>7} {:>12} {:>9} {:>11.2} {:>12} {:>11}",
            shown(&mut coarse),
            shown(&mut last),
            shown(&mut bare),
            shown(&mut inner),
            median(&mut inner) / median(&mut bare),
            less_quiet(&mut coarse, &mut bare),
            less_quiet(&mut last, &mut bare),
        );
    }
    println!("the last two without the debounce; wanted: coarse at most {COARSE_BOUND}, final at most {FINAL_BOUND}");
}

/// The median without the debounce, in bare renders.
fn less_quiet(v: &mut [f64], bare: &mut [f64]) -> String {
    match v.is_empty() {
        true => "-".into(),
        false => format!("{:.2}", (median(v) - QUIET.as_secs_f64() * 1e3) / median(bare)),
    }
}

fn median(v: &mut [f64]) -> f64 {
    v.sort_by(f64::total_cmp);
    v[v.len() / 2]
}
