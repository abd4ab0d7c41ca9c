//! What it makes, and what it makes again.

use crate::desk::{BALL, Desk, PARTS, files_in};
use crate::link::broken_links;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

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
        "16 × 12 pixels",
        "4 (2 × 2)",
        "id=\"L9\"",
        "../scenes/ball.scene",
        "spheres",
    ] {
        assert!(page.contains(part), "{part} in {page}");
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
    fs::write(desk.path("out/ball.png"), &picture[..picture.len() - 30]).unwrap();
    assert_eq!(desk.made(""), [ball], "it was cut off");
    assert!(fs::read(desk.path("out/ball.png")).unwrap() == picture);
    fs::remove_file(desk.path("out/sub/post.png")).unwrap();
    assert_eq!(desk.made(""), [post]);
    desk.write("scenes/new.scene", BALL);
    assert_eq!(desk.made(""), ["new.scene"]);
    let scribbled = desk.read("out/index.html").replace("new.scene.html", "nowhere.html");
    desk.write("out/index.html", &scribbled);
    assert!(desk.made("").is_empty());
    assert!(desk.read("out/index.html").contains("new.scene.html"), "pages are mended too");
    let whole = desk.read("out/gallery.json");
    for damaged in ["", "{", "<<<<<<< HEAD\n", &format!("<<<<<<< HEAD\n{whole}"), &whole[..whole.len() / 2]] {
        desk.write("out/gallery.json", damaged);
        assert_eq!(desk.made("").len(), 3, "a damaged manifest costs time, nothing else: {damaged}");
        assert!(desk.made("").is_empty(), "{damaged}");
    }
    assert_eq!(broken_links(&desk.path("out")), Vec::<String>::new());
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
