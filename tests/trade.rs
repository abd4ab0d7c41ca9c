//! `rtdsl trade` as its user meets it: a process, a tiny scene, the files that it leaves. Nothing here looks at how long things
//! took, only at what is said of it.

use serde_json::Value;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};
use tempfile::TempDir;

/// A mirror and a matte ball on a checkered floor; 40 x 30 pixels.
const SCENE: &str = "\
camera(from: [0, 1, 5], at: [0, 0.5, 0], fov: 40deg)
background(#88aacc)
light(at: [3, 6, 5])
plane(y: 0, mat: matte(checker(#ffffff, #204060)))
sphere(at: [-0.7, 0.7, 0], r: 0.7, mat: mirror())
sphere(at: [0.8, 0.5, 0.3], r: 0.5, mat: matte(#cc3322))
render(size: [40, 30], aa: grid(2), depth: 3)
";

/// A folder with the scene, gone when dropped.
struct Desk(TempDir);

impl Desk {
    fn new() -> Desk {
        let desk = Desk(tempfile::tempdir().expect("a folder"));
        fs::write(desk.path("a.scene"), SCENE).expect("written");
        desk
    }
    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
    fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rtdsl"));
        command.args(arguments.split_whitespace()).current_dir(self.0.path());
        command
    }
    /// Runs it, expects `exit`, gives both outputs.
    fn expect(&self, exit: i32, arguments: &str) -> (String, String) {
        let Output { status, stdout, stderr } = self.command(arguments).output().expect("it runs");
        let text = |bytes| String::from_utf8(bytes).expect("text");
        let (stdout, stderr) = (text(stdout), text(stderr));
        assert_eq!(status.code(), Some(exit), "rtdsl {arguments}\n{stdout}{stderr}");
        (stdout, stderr)
    }
    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).expect(name)
    }
    fn report(&self, name: &str) -> Value {
        serde_json::from_str(&self.read(name)).expect("JSON")
    }
}

fn number(v: &Value) -> f64 {
    v.as_f64().expect("a number")
}

fn list(v: &Value) -> &[Value] {
    v.as_array().expect("a list")
}

/// What holds of every report.
fn check(report: &Value) {
    let points = list(&report["points"]);
    let place = |i: usize| (number(&points[i]["seconds"]), number(&points[i]["max"][0]));
    let front: Vec<usize> = list(&report["front"]).iter().map(|i| i.as_u64().expect("a number") as usize).collect();
    assert!(!front.is_empty());
    for i in 0..points.len() {
        let beaten = (0..points.len()).any(|j| {
            let (a, b) = (place(j), place(i));
            a.0 <= b.0 && a.1 <= b.1 && a != b
        });
        assert!(!(front.contains(&i) && beaten), "{} is dominated", points[i]);
        assert_eq!(points[i]["front"], Value::Bool(front.contains(&i)));
        for error in ["max", "p99", "rmse"] {
            let [value, least, most] = [0, 1, 2].map(|k| number(&points[i][error][k]));
            assert!(0.0 <= least && least <= value && value <= most, "{}", points[i]);
        }
        assert!(number(&points[i]["max"][0]) >= number(&points[i]["p99"][0]));
        assert!(number(&points[i]["max"][0]) >= number(&points[i]["rmse"][0]));
        assert!((0.0..=1.0).contains(&number(&points[i]["flip"])));
        // What is promised is kept, or the exit code would be another.
        assert_eq!(points[i]["broken"][0], 0, "{}", points[i]);
    }
}

#[test]
fn all_dials_are_measured_and_written_down() {
    let desk = Desk::new();
    let (stdout, stderr) = desk.expect(0, "trade a.scene --budget 20s --suggest 100/255");
    assert!(stdout.contains("reference: ") && stderr.is_empty(), "{stdout}{stderr}");
    let last = stdout.lines().last().expect("a line");
    assert!(last.starts_with("for 100/255: ") && last.contains("a margin of"), "{last}");

    let report = desk.report("a-trade/trade.json");
    check(&report);
    let points = list(&report["points"]);
    assert_eq!((&report["size"], &report["interrupted"]), (&serde_json::json!([40, 30]), &Value::Bool(false)));
    assert_eq!(points[0]["setting"], "grid 2×2", "the scene's own comes first");
    let names: Vec<&str> = points.iter().map(|p| p["setting"].as_str().expect("a name")).collect();
    for name in ["max error 4/255", "1 ray a pixel", "grid 8×8", "grid 2×2, depth 0", "grid 2×2, f32", "time 0.05 s"]
    {
        assert!(names.contains(&name), "{name} of {names:?}");
    }
    // Costs that no clock has a part in.
    let of = |name: &str| points.iter().find(|p| p["setting"] == name).expect("measured");
    assert_eq!(of("1 ray a pixel")["camera_rays"], 40 * 30);
    assert_eq!(of("grid 8×8")["camera_rays"], 40 * 30 * 64);
    assert!(number(&of("max error 4/255")["bounds"]) > 0.0 && of("grid 8×8")["bounds"] == 0);
    assert!(number(&of("max error 4/255")["max"][1]) <= 4.0, "it keeps what it says");
    assert!(number(&of("grid 2×2, depth 0")["change"]) > 10.0 && points[0]["change"] == 0.0, "mirrors are seen");
    // More rays, less error.
    assert!(number(&of("grid 8×8")["rmse"][0]) < number(&of("1 ray a pixel")["rmse"][0]));
    let suggested = &points[report["suggestions"][0]["point"].as_u64().expect("a number") as usize];
    assert!(number(&suggested["max"][2]) <= 100.0);

    let docs = include_str!("../docs/trade.md");
    for object in
        [&report, &points[0], &report["reference"], &report["suggestions"][0], &of("max error 4/255")["claim"]]
    {
        for field in object.as_object().into_iter().flat_map(|o| o.keys()) {
            assert!(docs.contains(&format!("`{field}`")), "docs/trade.md doesn't tell of `{field}`");
        }
    }

    let csv = desk.read("a-trade/trade.csv");
    let columns = csv.lines().next().expect("a head").split(',').count();
    assert!(csv.lines().count() == points.len() + 1 && columns == 28, "{csv}");
    let svg = desk.read("a-trade/trade.svg");
    assert!(svg.starts_with("<svg xmlns=") && svg.ends_with("</svg>\n"));
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    assert_eq!(svg.matches("<g ").count(), svg.matches("</g>").count());
    let html = desk.read("a-trade/index.html");
    assert!(html.contains("data:image/png;base64,") && html.contains("grid 8×8"));
    let elsewhere = ["src=\"http", "href=\"http", "url("].map(|link| html.contains(link));
    assert_eq!(elsewhere, [false; 3], "it needs no other file");
}

#[test]
fn one_dial_and_no_answer() {
    let desk = Desk::new();
    let (stdout, _) = desk.expect(4, "trade a.scene --axis samples --budget 5s --suggest 0.1/255 -q -o out");
    assert!(stdout.starts_with("for 0.1/255: none of these settings surely keeps it"), "{stdout}");
    let report = desk.report("out/trade.json");
    check(&report);
    assert!(report["suggestions"][0]["point"].is_null());
    let axes = list(&report["axes"]);
    assert!(axes.len() == 1 && axes[0][0] == "samples");
    let rays: Vec<u64> = list(&axes[0][1])
        .iter()
        .map(|i| report["points"][i.as_u64().expect("one") as usize]["camera_rays"].as_u64().expect("rays"))
        .collect();
    assert!(rays.len() > 4 && rays.is_sorted(), "{rays:?}");
}

#[test]
fn json_on_standard_output_is_the_file() {
    let desk = Desk::new();
    let (stdout, _) = desk.expect(0, "trade a.scene --axis precision,depth --budget 5s --json --size 20x15");
    assert_eq!(stdout, desk.read("a-trade/trade.json"));
    let report = desk.report("a-trade/trade.json");
    assert_eq!(report["schema"], 1);
    assert_eq!(report["size"], serde_json::json!([20, 15]));
}

#[test]
fn what_makes_no_sense_is_said() {
    let desk = Desk::new();
    let (_, stderr) = desk.expect(2, "trade -");
    assert!(stderr.contains("-o DIR"), "{stderr}");
    for wrong in ["--axis speed", "--budget 0s", "--budget soon", "--suggest 2", "--suggest 0/255"] {
        desk.expect(2, &format!("trade a.scene {wrong}"));
    }
    fs::write(desk.path("wrong.scene"), "spere()\n").expect("written");
    desk.expect(1, "trade wrong.scene");
    desk.expect(3, "trade missing.scene");
    fs::write(desk.path("file"), "").expect("written");
    desk.expect(3, "trade a.scene -o file");
    assert!(!desk.path("wrong-trade").exists(), "nothing is left of it");
}

/// Ends it after longer and longer times, until it was after the first points and before the last: what was measured is there.
#[cfg(unix)]
#[test]
fn an_interrupted_run_writes_what_it_has() {
    // The reference has a third of the budget, and the largest grids would take all of the rest.
    for seconds in [4, 5, 6, 7] {
        let desk = Desk::new();
        let mut child =
            desk.command("trade a.scene --axis samples --size 640x480 --budget 9s -q").spawn().expect("it runs");
        std::thread::sleep(std::time::Duration::from_secs(seconds));
        let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
        let ended = child.wait().expect("it ends");
        if !desk.path("a-trade/trade.json").exists() {
            assert!(sent.success() && ended.code() == Some(3), "{ended}");
            continue;
        }
        let report = desk.report("a-trade/trade.json");
        check(&report);
        assert_eq!((&report["interrupted"], ended.code()), (&Value::Bool(true), Some(3)));
        return;
    }
    panic!("nothing was ever written");
}
