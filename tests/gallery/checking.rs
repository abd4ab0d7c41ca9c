//! What is wrong: scenes that can't be made, pictures that aren't what scenes make.

use crate::desk::{BALL, Desk, POST};
use crate::link::broken_links;
use serde_json::Value;
use std::fs;

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
    fs::copy(desk.path("out/ball.png"), desk.path("out/other.png")).unwrap();
    desk.gallery(4, "--check --differences found");
    assert!(!desk.path("found/other.png").exists(), "it isn't missing any more");
    fs::remove_file(desk.path("out/other.png")).unwrap();
    desk.write("found/other.png", "mine");
    assert!(desk.gallery(2, "--check --differences found").1.contains("isn't a picture of differences"));
    assert_eq!(desk.read("found/other.png"), "mine");
    desk.write("scenes/other.scene", "sphere(raduis: 1)");
    desk.gallery(1, "--check");
    assert!(desk.snapshot() == before, "nothing was written among the pictures");
    for place in ["out", "out/deep/new", "x/../out/new", "scenes"] {
        let run = desk.run(&format!("gallery scenes -o out --check --differences {place}"));
        assert_eq!(run.status.code(), Some(2), "{place}");
    }
    assert_eq!(desk.run("gallery scenes -o out --differences x").status.code(), Some(2), "only with --check");
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
