//! What it writes over and removes, and what it leaves alone.

use crate::desk::{BALL, Desk};
use crate::link::broken_links;
use std::fs;

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

#[test]
fn a_hostile_manifest_reaches_nothing() {
    let desk = Desk::new();
    desk.gallery(0, "");
    desk.write("mine.html", "mine");
    desk.write("out/mine.txt", "mine");
    let digest = blake3::hash(b"mine").to_hex().to_string();
    let manifest = desk.read("out/gallery.json");
    let listed = format!("\"files\": {{\n\"../mine.html\": \"{digest}\",\n\"mine.txt\": \"{digest}\",\n");
    let hostile = manifest.replace("\"files\": {\n", &listed);
    assert_ne!(hostile, manifest);
    desk.write("out/gallery.json", &hostile);
    let (stdout, _) = desk.gallery(0, "");
    assert!(!stdout.contains("removed"), "{stdout}");
    assert_eq!((desk.read("mine.html"), desk.read("out/mine.txt")), ("mine".into(), "mine".into()));
}

#[cfg(unix)]
#[test]
fn links_lead_nowhere_else() {
    let desk = Desk::new();
    desk.gallery(0, "");
    // The folder moves away, and a link to it stays.
    fs::rename(desk.path("out/sub"), desk.path("elsewhere")).unwrap();
    std::os::unix::fs::symlink(desk.path("elsewhere"), desk.path("out/sub")).unwrap();
    let before = fs::read(desk.path("elsewhere/post.png")).unwrap();
    let scene = desk.read("scenes/sub/post.scene");
    desk.write("scenes/sub/post.scene", &scene.replace("[20, 10]", "[10, 10]"));
    assert!(desk.gallery(2, "").1.contains("lies outside the gallery's folder"));
    fs::remove_dir_all(desk.path("scenes/sub")).unwrap();
    desk.gallery(0, "");
    assert!(fs::read(desk.path("elsewhere/post.png")).unwrap() == before, "neither overwritten nor removed");
}

#[test]
fn what_can_t_be_written_is_found_out_first() {
    let desk = Desk::new();
    for name in ["gallery.json", "index.html", "sub/post.scene.html"] {
        desk.write(&format!("out/{name}"), "{\"name\": \"of another program\"}");
        assert!(desk.gallery(2, "").1.contains(&format!("{name}` wasn't made by rtdsl")), "{name}");
        assert!(!desk.path("out/ball.png").exists(), "{name}");
        fs::remove_file(desk.path("out").join(name)).unwrap();
    }
    desk.gallery(0, "");
}

#[test]
fn a_scene_keeps_the_picture_that_it_reads() {
    let desk = Desk::empty();
    desk.write("all/a.scene", BALL);
    assert_eq!(desk.run("gallery all -o all").status.code(), Some(0));
    let picture = fs::read(desk.path("all/a.png")).unwrap();
    desk.write("all/a.scene", &BALL.replace("phong(color: #f00)", "matte(image(\"a.png\"))"));
    let run = desk.run("gallery all -o all");
    assert_eq!(run.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&run.stderr).contains("a.png`, which the scene reads"));
    assert!(fs::read(desk.path("all/a.png")).unwrap() == picture);
}
