//! `rtdsl watch` as its user meets it: a process, files that change, and the picture file. The waits are generous and end as
//! soon as what is waited for has come.
#![cfg(unix)]

use serde_json::Value;
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
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
    // Ten times as long as a change is held back: so that the two saves are two.
    std::thread::sleep(Duration::from_millis(400));
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
    // Many seconds of work, and few enough rays a pixel that only the small coarse picture comes before.
    let slow = SCENE.replace("[96, 64]", "[1920, 1080], aa: grid(3)").replace("matte(#cc3322)", "glass()");
    let many = "for i in 0..40 { sphere(at: [i * 0.1 - 2, 0, 0], r: 0.5, mat: glass()) }\n";
    let p = Project::new(&[("a.scene", SCENE)]);
    let watch = Watch::start(&p, &["a.scene", "--serve", "127.0.0.1:0", "-o", "a.png"]);
    watch.next("picture");
    let good = fs::read(p.path("a.png")).unwrap();
    p.write("a.scene", &(slow + many));
    assert_eq!(watch.next("coarse")["text"], 2);
    assert_eq!(watch.stop(), Some(0));
    assert_eq!(fs::read(p.path("a.png")).unwrap(), good);
    assert_eq!(p.names(), ["a.png", "a.scene"]);
}

#[test]
fn a_second_interruption_ends_it_whatever_it_is_doing() {
    // A message that is longer than any pipe holds, and nobody reads it: it is stuck in writing it.
    let name = "x".repeat(300_000);
    let p = Project::new(&[("a.scene", &format!("{name}()\n"))]);
    let mut child =
        p.rtdsl(&["watch", "--json", "a.scene"]).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let mut first = [0];
    child.stdout.as_mut().expect("its output").read_exact(&mut first).expect("it begins to write");
    let start = Instant::now();
    let code = loop {
        // Again and again, since the system takes two that come at once for one.
        let killed = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
        std::thread::sleep(Duration::from_millis(50));
        if let Some(status) = child.try_wait().expect("it can be asked") {
            break status.code();
        }
        assert!(killed.expect("`kill` runs").success());
        if start.elapsed() > PATIENCE {
            child.kill().expect("it ends");
            panic!("it didn't end");
        }
    };
    assert_eq!(code, Some(0));
    assert_eq!(p.names(), ["a.scene"]);
}

#[test]
fn a_picture_that_a_broken_text_interrupts_is_finished() {
    let slow = SCENE.replace("[96, 64]", "[320, 240], aa: grid(4)");
    let p = Project::new(&[("a.scene", SCENE), ("slow.scene", &slow)]);
    let watch = Watch::start(&p, &["a.scene", "--serve", "127.0.0.1:0", "-o", "a.png"]);
    watch.next("picture");
    p.write("a.scene", &slow);
    assert_eq!(watch.next("coarse")["text"], 2);
    p.write("a.scene", &slow.replace("sphere", "sphree"));
    assert_eq!(watch.next("picture")["text"], 2);
    assert_eq!(watch.stop(), Some(0));
    let picture = |name: &str| image::open(p.path(name)).expect("a picture").into_rgb8();
    assert!(p.rtdsl(&["render", "slow.scene"]).status().expect("it runs").success());
    assert!(picture("a.png") == picture("slow.png"));
}

#[test]
fn what_a_page_set_goes_with_the_parameter() {
    let p = Project::new(&[("a.scene", SCENE)]);
    let watch = Watch::start(&p, &["a.scene", "--serve", "127.0.0.1:0"]);
    let url = watch.next("serving")["url"].as_str().expect("an address").to_owned();
    let host = url.trim_start_matches("http://").trim_end_matches('/');
    watch.next("picture");
    let body = r#"{"size":"2"}"#;
    let head = format!("POST /set HTTP/1.1\r\nHost: {host}\r\nContent-Type: application/json\r\n");
    let mut stream = TcpStream::connect(host).expect("it listens");
    write!(stream, "{head}Connection: close\r\nContent-Length: {}\r\n\r\n{body}", body.len()).expect("sent");
    let mut answer = String::new();
    stream.read_to_string(&mut answer).expect("an answer");
    assert!(answer.starts_with("HTTP/1.1 204"), "{answer}");
    assert_eq!(watch.next("picture")["text"], 2);
    p.write("a.scene", &SCENE.replace("param size: 1 in 0.1..=3\n", "").replace("r: size", "r: 1.5"));
    loop {
        let v = watch.said.recv_timeout(PATIENCE).expect("a picture");
        assert_ne!(v["event"], "messages", "{v}");
        if v["event"] == "picture" {
            break assert_eq!(v["text"], 3);
        }
    }
    assert_eq!(watch.stop(), Some(0));
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
