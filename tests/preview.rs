//! The server of the live page, spoken to over plain sockets: what it tells, and whom it refuses.

use rtdsl::app::preview::board::Setting;
use rtdsl::app::preview::{Ask, Board, Level, Picture, Server, Shown, serve};
use rtdsl::lang::{self, Evaluated, Input, Request};
use rtdsl::render::{Options, World};
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::sync::mpsc::{self, Receiver};
use std::sync::{Arc, OnceLock};
use std::time::Duration;

/// A server that doesn't answer is a fault; without an end the test would hang.
const PATIENCE: Duration = Duration::from_secs(60);

/// A served board, and what pages ask of it.
struct Page {
    board: Arc<Board>,
    asks: Receiver<Ask>,
    server: Server,
}

impl Page {
    fn new() -> Page {
        let (send, asks) = mpsc::channel();
        let board = Arc::new(Board::new("run 1".into(), "a.scene".into(), move |ask| send.send(ask).is_ok()));
        let server = serve(Arc::clone(&board), "127.0.0.1:0".parse().unwrap()).unwrap();
        Page { board, asks, server }
    }

    fn host(&self) -> String {
        self.server.address().to_string()
    }

    /// Sends `head` (with `HOST` for the server's own address) and `body`, and reads the answer.
    fn send(&self, head: &str, body: &str) -> Answer {
        let mut stream = self.connect();
        let head = head.replace("HOST", &self.host());
        stream.write_all(format!("{head}\r\nConnection: close\r\n\r\n{body}").as_bytes()).unwrap();
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).unwrap();
        Answer::new(&bytes)
    }

    fn get(&self, path: &str) -> Answer {
        self.send(&format!("GET {path} HTTP/1.1\r\nHost: HOST"), "")
    }

    fn set(&self, values: &str) -> Answer {
        let length = values.len();
        let head = "POST /set HTTP/1.1\r\nHost: HOST\r\nContent-Type: application/json";
        self.send(&format!("{head}\r\nContent-Length: {length}"), values)
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(self.server.address()).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        stream
    }

    fn follow(&self) -> Follower {
        let mut stream = self.connect();
        write!(stream, "GET /events HTTP/1.1\r\nHost: {}\r\n\r\n", self.host()).unwrap();
        Follower { lines: BufReader::new(stream) }
    }
}

struct Answer {
    status: u16,
    head: String,
    body: Vec<u8>,
}

impl Answer {
    fn new(bytes: &[u8]) -> Answer {
        let end = bytes.windows(4).position(|w| w == b"\r\n\r\n").expect("a head");
        let head = String::from_utf8(bytes[..end].to_vec()).unwrap();
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        Answer { status, head: head.to_lowercase(), body: bytes[end + 4..].to_vec() }
    }

    fn text(&self) -> String {
        String::from_utf8(self.body.clone()).unwrap()
    }
}

/// Reads the stream of events.
struct Follower {
    lines: BufReader<TcpStream>,
}

impl Follower {
    /// The next event; `None` when the connection has ended.
    fn next(&mut self) -> Option<Value> {
        loop {
            let mut line = String::new();
            match self.lines.read_line(&mut line) {
                Ok(0) => return None,
                Ok(_) => {}
                Err(e) if e.kind() == ErrorKind::ConnectionReset => return None,
                Err(e) => panic!("no event came: {e}"),
            }
            if let Some(data) = line.strip_prefix("data: ") {
                return Some(serde_json::from_str(data).unwrap());
            }
        }
    }

    /// The first event that holds, from the next one on: of changes in quick succession, the newest alone may come.
    fn until(&mut self, holds: impl Fn(&Value) -> bool) -> Value {
        loop {
            let event = self.next().expect("the connection lasts");
            if holds(&event) {
                return event;
            }
        }
    }
}

fn evaluated() -> Arc<Evaluated> {
    static SCENE: OnceLock<Arc<Evaluated>> = OnceLock::new();
    let text = "param r: 1 in 0.5..=2 \"size\"\nfn ball() { sphere(at: [0, 0, 0], r: r, name: \"sun\") }\nball()\n\
                light(at: [0, 0, 9])\ncamera(from: [0, 0, 5], at: [0, 0, 0])\nrender(size: [8, 6])\n";
    let make = || {
        let main = Input::Text { name: "a.scene".into(), bytes: text.into(), folder: ".".into() };
        let request = Request { main, set: Vec::new(), allow_read: Vec::new(), record_arguments: true };
        Arc::new(lang::evaluate(&request).expect("the scene is right"))
    };
    Arc::clone(SCENE.get_or_init(make))
}

fn picture(id: u64) -> Picture {
    Picture { id, level: Level::Final, width: 8, height: 6, text: 1, made: "14:03:22".into() }
}

#[test]
fn the_page_comes_with_all_its_files() {
    let page = Page::new();
    assert_eq!(page.server.url(), format!("http://{}/", page.host()));
    let html = page.get("/");
    assert_eq!(html.status, 200);
    assert!(html.head.contains("content-type: text/html; charset=utf-8"), "{}", html.head);
    let html = html.text();
    let linked: Vec<&str> = html.split(['"']).filter(|s| s.starts_with('/') && s.contains('.')).collect();
    assert!(linked.len() >= 3, "{linked:?}");
    for path in linked {
        assert_eq!(page.get(path).status, 200, "{path}");
    }
    // Every script that a script imports is there.
    let imports = |script: &str| -> Vec<String> {
        script.split("from \"./").skip(1).map(|s| s.split('"').next().unwrap().to_string()).collect()
    };
    for script in imports(&page.get("/page.js").text()) {
        let answer = page.get(&format!("/{script}"));
        assert_eq!(answer.status, 200, "{script}");
        assert!(answer.head.contains("content-type: text/javascript"), "{script}");
        for script in imports(&answer.text()) {
            assert_eq!(page.get(&format!("/{script}")).status, 200, "{script}");
        }
    }
}

#[test]
fn every_answer_is_safe() {
    let page = Page::new();
    for answer in [page.get("/"), page.get("/nothing"), page.send("GET / HTTP/1.1\r\nHost: example.com", "")] {
        for header in [
            "content-security-policy: default-src 'self';",
            "frame-ancestors 'none'",
            "x-content-type-options: nosniff",
            "referrer-policy: no-referrer",
            "cache-control: no-store",
        ] {
            assert!(answer.head.contains(header), "{header} in {}", answer.head);
        }
        assert!(!answer.head.contains("access-control"), "{}", answer.head);
    }
}

#[test]
fn foreign_hosts_and_sites_are_refused() {
    let page = Page::new();
    let port = page.server.address().port();
    let with = |headers: &str| page.send(&format!("GET / HTTP/1.1\r\n{headers}"), "");
    for ours in [
        "Host: HOST".to_string(),
        format!("Host: localhost:{port}"),
        format!("Host: [::1]:{port}"),
        "Host: HOST\r\nOrigin: http://HOST".into(),
        "Host: HOST\r\nSec-Fetch-Site: same-origin".into(),
        "Host: HOST\r\nSec-Fetch-Site: none".into(),
        "Host: HOST\r\nSec-Fetch-Site: cross-site\r\nSec-Fetch-Mode: navigate\r\nSec-Fetch-Dest: document".into(),
    ] {
        assert_eq!(with(&ours).status, 200, "{ours}");
    }
    for foreign in [
        "Host: example.com".to_string(),
        format!("Host: example.com:{port}"),
        format!("Host: 192.168.1.2:{port}"),
        "Host: 127.0.0.1:1".into(),
        "Host: ".into(),
        "Host: HOST\r\nHost: example.com".into(),
        "Host: HOST\r\nOrigin: http://example.com".into(),
        "Host: HOST\r\nOrigin: https://HOST".into(),
        format!("Host: HOST\r\nOrigin: http://localhost:{port}"),
        "Host: HOST\r\nOrigin: null".into(),
        "Host: HOST\r\nSec-Fetch-Site: cross-site".into(),
        "Host: HOST\r\nSec-Fetch-Site: same-site".into(),
        "Host: HOST\r\nSec-Fetch-Site: cross-site\r\nSec-Fetch-Mode: navigate\r\nSec-Fetch-Dest: iframe".into(),
    ] {
        let answer = with(&foreign);
        assert_eq!(answer.status, 403, "{foreign}");
        assert!(answer.text().len() > 10, "it says why: {foreign}");
    }
    // Without a host (HTTP/1.0), and where a followed link has no business.
    assert_eq!(page.send("GET / HTTP/1.0", "").status, 403);
    let link = "Host: HOST\r\nSec-Fetch-Site: cross-site\r\nSec-Fetch-Mode: navigate\r\nSec-Fetch-Dest: document";
    assert_eq!(page.send(&format!("GET /events HTTP/1.1\r\n{link}"), "").status, 403);
}

#[test]
fn only_what_is_there_is_served() {
    let page = Page::new();
    for path in [
        "/nothing",
        "/page/page.js",
        "/../Cargo.toml",
        "/..%2f..%2fetc%2fpasswd",
        "/picture/../page.js",
        "/picture/%2e%2e%2fpage.js",
        "/picture/1",
        "/picture/1.png",
        "/picture/-1.png",
        "/picture/18446744073709551616.png",
        "/picture/",
        "/page.js/",
        "//page.js",
    ] {
        assert_eq!(page.get(path).status, 404, "{path}");
    }
    let method = |line: &str| page.send(&format!("{line} HTTP/1.1\r\nHost: HOST\r\nContent-Length: 0"), "").status;
    for line in
        ["POST /", "DELETE /page.js", "GET /set", "PUT /set", "OPTIONS /set", "POST /events", "POST /picture/1.png"]
    {
        assert_eq!(method(line), 405, "{line}");
    }
}

#[test]
fn what_is_too_long_is_refused() {
    let page = Page::new();
    let long = "x".repeat(2000);
    assert_eq!(page.get(&format!("/{long}")).status, 414);
    assert_eq!(page.get(&format!("/?{long}")).status, 414);
    // By what it announces, before it comes; and without announcing, when it has.
    let head = "POST /set HTTP/1.1\r\nHost: HOST\r\nContent-Type: application/json";
    assert_eq!(page.send(&format!("{head}\r\nContent-Length: 65537"), "").status, 413);
    let chunk = format!("10001\r\n{}", " ".repeat(65537));
    assert_eq!(page.send(&format!("{head}\r\nTransfer-Encoding: chunked"), &chunk).status, 413);
    assert!(page.asks.try_recv().is_err());
}

#[test]
fn followers_are_told_everything() {
    let page = Page::new();
    page.board.post(|p| p.text = 7);
    let (mut one, mut two) = (page.follow(), page.follow());
    for follower in [&mut one, &mut two] {
        let first = follower.next().expect("at once");
        assert_eq!((&first["run"], &first["file"], &first["text"]), (&json!("run 1"), &json!("a.scene"), &json!(7)));
    }
    let id = page.board.keep_picture(b"not really a picture".to_vec());
    page.board.post(|p| {
        p.picture = Some(picture(id));
        p.params = evaluated().params.iter().map(Setting::from).collect();
    });
    for follower in [&mut one, &mut two] {
        let event = follower.until(|e| e["picture"]["id"] == id);
        assert_eq!(event["picture"]["level"], "final");
        assert_eq!(event["params"][0]["range"], json!([0.5, 2.0]));
    }
    // One leaves, the other is still told.
    drop(one);
    page.board.post(|p| p.text = 8);
    two.until(|e| e["text"] == 8);
}

#[test]
fn pictures_by_their_number() {
    let page = Page::new();
    let id = page.board.keep_picture(vec![0x89, b'P', 0, 255]);
    let answer = page.get(&format!("/picture/{id}.png"));
    assert_eq!((answer.status, answer.body.as_slice()), (200, [0x89, b'P', 0, 255].as_slice()));
    assert!(answer.head.contains("content-type: image/png"), "{}", answer.head);
    assert!(answer.head.contains("immutable"), "{}", answer.head);
    // A browser that remembers another run's picture of this number doesn't mix them up.
    assert_eq!(page.get(&format!("/picture/{id}.png?run=run%201")).status, 200);
    assert_eq!(page.get(&format!("/picture/{id}.png?run=run%202")).status, 404);
}

#[test]
fn a_pixel_is_explained() {
    let page = Page::new();
    assert_eq!(page.get("/explain?x=1&y=1").status, 404, "nothing is finished yet");
    let evaluated = evaluated();
    let world = Arc::new(World::build(&evaluated.scene, &evaluated.scene.cameras[0]));
    let options = Options::from_settings(&evaluated.scene.settings);
    page.board.show(Shown { picture: 5, evaluated, world, options });
    let pixel = |x: u32, y: u32| -> Value {
        let answer = page.get(&format!("/explain?x={x}&y={y}"));
        assert_eq!(answer.status, 200);
        serde_json::from_str(&answer.text()).unwrap()
    };
    let middle = pixel(4, 3);
    assert_eq!((&middle["picture"], &middle["x"], &middle["y"]), (&json!(5), &json!(4), &json!(3)));
    let sight = &middle["sight"];
    assert_eq!(sight["what"], "sphere \"sun\"");
    assert!(sight["made_at"].as_str().unwrap().starts_with("a.scene:2:13  sphere(at: [0, 0, 0]"), "{sight}");
    assert_eq!(sight["calls"].as_array().unwrap().len(), 1, "{sight}");
    assert_eq!(sight["lights"], json!(["a.scene:4:1 reaches it"]));
    assert_eq!(pixel(0, 0)["sight"], Value::Null, "the background");
    assert_eq!(page.get("/explain?x=8&y=0").status, 404, "outside");
    for wrong in ["/explain", "/explain?x=1", "/explain?x=-1&y=0", "/explain?x=a&y=0", "/explain?x=4294967296&y=0"] {
        assert_eq!(page.get(wrong).status, 400, "{wrong}");
    }
}

#[test]
fn parameters_are_asked_for() {
    let page = Page::new();
    page.board.post(|p| p.params = evaluated().params.iter().map(Setting::from).collect());
    assert_eq!(page.set(r#"{"r": "1.5"}"#).status, 204);
    assert_eq!(page.asks.recv().unwrap(), Ask::Set(vec![("r".into(), Some("1.5".into()))]));
    assert_eq!(page.set(r#"{"r": null}"#).status, 204);
    assert_eq!(page.asks.recv().unwrap(), Ask::Set(vec![("r".into(), None)]));

    for wrong in ["", "[]", "{", r#"{"r": 1}"#, r#"{"r": {}}"#, r#"{"other": "1"}"#, "\u{0}"] {
        assert_eq!(page.set(wrong).status, 400, "{wrong}");
    }
    // What a form of another site may send without asking first.
    for media in ["", "\r\nContent-Type: text/plain", "\r\nContent-Type: application/x-www-form-urlencoded"] {
        let head = format!("POST /set HTTP/1.1\r\nHost: HOST\r\nContent-Length: 9{media}");
        assert_eq!(page.send(&head, r#"{"r":"1"}"#).status, 415, "{media}");
    }
    assert!(page.asks.try_recv().is_err(), "nothing of that went through");
    drop(page.asks);
    let page = Page { asks: mpsc::channel().1, ..page };
    assert_eq!(page.set(r#"{"r": "1"}"#).status, 503, "the loop has ended");
}

#[test]
fn a_taken_address_is_reported() {
    let page = Page::new();
    let board = Arc::new(Board::new(String::new(), String::new(), |_| false));
    assert!(serve(board, page.server.address()).is_err_and(|e| e.kind() == ErrorKind::AddrInUse));
}

#[test]
fn a_dropped_server_ends_and_its_address_is_free() {
    let page = Page::new();
    let mut follower = page.follow();
    follower.next().expect("it follows");
    let idle = page.connect();
    let address = page.server.address();
    drop(page.server);
    assert_eq!(follower.next(), None, "the connection has ended");
    assert!(TcpStream::connect(address).is_err(), "nobody listens");
    drop(idle);
    let again = serve(page.board, address).unwrap();
    assert_eq!(again.address(), address);
}

#[test]
fn idle_connections_hold_their_places_for_a_while_only() {
    use axum::serve::Listener;
    use rtdsl::app::preview::listener::Limited;
    use std::time::Duration;
    use tokio::io::{AsyncRead, ReadBuf};
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    runtime.block_on(async {
        let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.unwrap();
        let address = listener.local_addr().unwrap();
        let mut limited = Limited::new(listener, 1, Duration::from_millis(20));
        let _clients = [(); 2].map(|()| std::net::TcpStream::connect(address).unwrap());
        let (mut first, _) = limited.accept().await;
        let second = tokio::time::timeout(Duration::from_millis(100), limited.accept()).await;
        assert!(second.is_err(), "there is one place");
        let mut bytes = [0; 8];
        let read =
            std::future::poll_fn(|cx| std::pin::Pin::new(&mut first).poll_read(cx, &mut ReadBuf::new(&mut bytes)));
        assert_eq!(read.await.unwrap_err().kind(), ErrorKind::TimedOut);
        drop(first);
        limited.accept().await;
    });
}
