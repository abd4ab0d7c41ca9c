//! `rtdsl watch` as its user meets it: a process, files that change, and the picture file. The waits are generous and end as
//! soon as what is waited for has come.
#![cfg(unix)]

use serde_json::Value;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// Nothing here takes a tenth of this, but machines can be busy.
const PATIENCE: Duration = Duration::from_secs(30);

const SCENE: &str =
    "param size: 1 in 0.1..=3\nsphere(r: size, mat: matte(#cc3322))\nlight(at: [4, 6, 5])\nrender(size: [96, 64])\n";

/// A project in a folder of its own.
struct Project(tempfile::TempDir);

impl Project {
    fn new(files: &[(&str, &str)]) -> Project {
        let project = Project(tempfile::tempdir().expect("a folder"));
        files.iter().for_each(|(name, text)| project.write(name, text));
        project
    }
    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
    fn write(&self, name: &str, text: &str) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        fs::write(path, text).expect("written");
    }
    /// As many editors save: a new file takes the place of the old.
    fn replace(&self, name: &str, text: &str) {
        self.write("new~", text);
        fs::rename(self.path("new~"), self.path(name)).expect("renamed");
    }
    fn rtdsl(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rtdsl"));
        command.args(arguments).current_dir(self.0.path());
        command
    }
    /// The bytes that `rtdsl render` makes.
    fn rendered(&self, arguments: &[&str]) -> Vec<u8> {
        let out = tempfile::tempdir().expect("a folder");
        let picture = out.path().join("x.png");
        let done = self.rtdsl(&["render"]).args(arguments).arg("-o").arg(&picture).status().expect("it runs");
        assert!(done.success());
        fs::read(picture).expect("a picture")
    }
    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).expect("a folder");
        let mut names: Vec<String> =
            entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

/// A running watch, and what it says.
struct Watch {
    child: Child,
    said: Receiver<Value>,
}

impl Watch {
    fn start(project: &Project, arguments: &[&str]) -> Watch {
        let mut child = project
            .rtdsl(&["watch", "--json"])
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("it starts");
        let (tell, said) = channel();
        let out = BufReader::new(child.stdout.take().expect("its output"));
        std::thread::spawn(move || {
            for line in out.lines().map_while(Result::ok) {
                let value = serde_json::from_str(&line).unwrap_or_else(|e| panic!("{line}: {e}"));
                if tell.send(value).is_err() {
                    break;
                }
            }
        });
        Watch { child, said }
    }

    /// The next event of this kind.
    fn next(&self, event: &str) -> Value {
        let start = Instant::now();
        loop {
            let left = PATIENCE.saturating_sub(start.elapsed());
            match self.said.recv_timeout(left) {
                Ok(v) if v["event"] == event => return v,
                Ok(_) => {}
                Err(e) => panic!("no `{event}` came: {e}"),
            }
        }
    }

    /// Interrupts it as Ctrl-C does; its exit code.
    fn stop(mut self) -> Option<i32> {
        let killed = Command::new("kill").args(["-INT", &self.child.id().to_string()]).status();
        assert!(killed.expect("`kill` runs").success());
        self.child.wait().expect("it ends").code()
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn every_save_makes_the_picture_that_render_makes() {
    let p = Project::new(&[("a.scene", SCENE)]);
    let watch = Watch::start(&p, &["a.scene"]);
    assert_eq!(watch.next("picture")["out"], "a.png");
    assert_eq!(fs::read(p.path("a.png")).unwrap(), p.rendered(&["a.scene"]));
    p.write("a.scene", &SCENE.replace("#cc3322", "#22cc33"));
    assert_eq!(watch.next("picture")["text"], 2);
    assert_eq!(fs::read(p.path("a.png")).unwrap(), p.rendered(&["a.scene"]));
    p.replace("a.scene", &SCENE.replace("#cc3322", "#2233cc"));
    watch.next("picture");
    assert_eq!(fs::read(p.path("a.png")).unwrap(), p.rendered(&["a.scene"]));
    assert_eq!(watch.stop(), Some(0));
    assert_eq!(p.names(), ["a.png", "a.scene"], "nothing is left behind");
}

#[test]
fn a_broken_text_costs_nothing() {
    let p = Project::new(&[("a.scene", SCENE)]);
    let watch = Watch::start(&p, &["a.scene", "-o", "out.png"]);
    watch.next("picture");
    let good = fs::read(p.path("out.png")).unwrap();
    p.write("a.scene", &SCENE.replace("sphere", "sphree"));
    let messages = watch.next("messages");
    assert_eq!(messages["diagnostics"][0]["message"], "`sphree` is unknown");
    assert_eq!(fs::read(p.path("out.png")).unwrap(), good);
    p.write("a.scene", SCENE);
    watch.next("picture");
    assert_eq!(fs::read(p.path("out.png")).unwrap(), good);
    assert_eq!(watch.stop(), Some(0));
}

#[test]
fn imports_and_files_that_appear_later_count() {
    let main = "import \"lib/ball.scene\" { ball }\nball(0.8)\nlight(at: [4, 6, 5])\nrender(size: [48, 32])\n";
    let p = Project::new(&[("a.scene", main)]);
    let watch = Watch::start(&p, &["a.scene"]);
    watch.next("messages");
    assert!(!p.path("a.png").exists());
    p.write("lib/ball.scene", "export fn ball(r) = sphere(r: r)\n");
    watch.next("picture");
    assert_eq!(fs::read(p.path("a.png")).unwrap(), p.rendered(&["a.scene"]));
    p.write("lib/ball.scene", "export fn ball(r) = box(from: [-r, -r, -r], to: [r, r, r])\n");
    watch.next("picture");
    assert_eq!(fs::read(p.path("a.png")).unwrap(), p.rendered(&["a.scene"]));
    assert_eq!(watch.stop(), Some(0));
}

#[test]
fn the_scene_itself_may_come_later() {
    let p = Project::new(&[]);
    let watch = Watch::start(&p, &["a.scene", "--set", "size=2", "--size", "30x20"]);
    watch.next("messages");
    p.write("a.scene", SCENE);
    assert_eq!(watch.next("picture")["size"], serde_json::json!([30, 20]));
    let same = ["a.scene", "--set", "size=2", "--size", "30x20"];
    assert_eq!(fs::read(p.path("a.png")).unwrap(), p.rendered(&same));
    assert_eq!(watch.stop(), Some(0));
}

#[test]
fn what_is_the_same_is_not_rendered_again() {
    let p = Project::new(&[("a.scene", SCENE)]);
    let watch = Watch::start(&p, &["a.scene"]);
    watch.next("picture");
    p.replace("a.scene", SCENE);
    p.write("a.scene", &SCENE.replace("cc3322", "cc3323"));
    let second = watch.next("picture");
    assert_eq!(second["text"], 2, "the first save changed nothing");
    assert_eq!(watch.stop(), Some(0));
}

#[test]
fn polling_notices_too() {
    let p = Project::new(&[("a.scene", SCENE)]);
    let watch = Watch::start(&p, &["a.scene", "--poll", "0.1"]);
    watch.next("picture");
    p.write("a.scene", &SCENE.replace("#cc3322", "#22cc33"));
    watch.next("picture");
    assert_eq!(fs::read(p.path("a.png")).unwrap(), p.rendered(&["a.scene"]));
    assert_eq!(watch.stop(), Some(0));
}

#[test]
fn interrupted_in_the_middle_it_leaves_nothing_half_written() {
    // About a minute of work.
    let slow = SCENE.replace("[96, 64]", "[1920, 1080], aa: grid(8)").replace("matte(#cc3322)", "glass()");
    let many = "for i in 0..40 { sphere(at: [i * 0.1 - 2, 0, 0], r: 0.5, mat: glass()) }\n";
    let p = Project::new(&[("a.scene", SCENE)]);
    let watch = Watch::start(&p, &["a.scene"]);
    watch.next("picture");
    let good = fs::read(p.path("a.png")).unwrap();
    p.write("a.scene", &(slow + many));
    std::thread::sleep(Duration::from_millis(500));
    assert_eq!(watch.stop(), Some(0));
    assert_eq!(fs::read(p.path("a.png")).unwrap(), good);
    assert_eq!(p.names(), ["a.png", "a.scene"]);
}

#[test]
fn arguments_that_do_not_fit_are_refused() {
    let p = Project::new(&[("a.scene", SCENE)]);
    let refused = |arguments: &[&str]| {
        let done = p.rtdsl(&["watch"]).args(arguments).output().expect("it runs");
        (done.status.code(), String::from_utf8_lossy(&done.stderr).lines().next().unwrap_or_default().to_string())
    };
    assert_eq!(refused(&["-"]), (Some(2), "error: standard input can't be watched".into()));
    assert_eq!(refused(&["a.scene", "-o", "a.gif"]).0, Some(2));
    assert_eq!(refused(&["a.scene", "-o", "no/such/folder.png"]).0, Some(3));
    assert_eq!(refused(&["a.scene", "--serve", "256.0.0.1:1"]).0, Some(2));
    assert!(Path::new(&p.path("a.scene")).exists());
}
