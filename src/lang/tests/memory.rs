//! Evaluations with a memory give what fresh ones give, and cancelled ones nothing.

use super::*;
use std::fs;
use std::path::Path;

fn file(path: &Path) -> Request {
    Request { main: Input::File(path.to_owned()), set: Vec::new(), allow_read: Vec::new(), record_arguments: false }
}

fn again(request: &Request, memory: &mut Memory) -> Result<Evaluated, Failure> {
    evaluate_again(request, memory, &AtomicBool::new(false)).expect("not cancelled")
}

/// A fresh evaluation and one with a memory differ in their times only.
fn same(request: &Request, memory: &mut Memory) {
    let texts = |s: &Sources| s.iter().map(|(_, s)| format!("{s:?}")).collect::<Vec<_>>();
    let equal = match (evaluate(request), again(request, memory)) {
        (Ok(a), Ok(b)) => {
            assert_eq!(texts(&a.sources), texts(&b.sources));
            assert_eq!(a.files, b.files);
            (a.scene == b.scene) & (a.params == b.params) & (a.warnings == b.warnings) & (a.is_library == b.is_library)
        }
        (Err(a), Err(b)) => {
            assert_eq!(texts(&a.sources), texts(&b.sources));
            assert_eq!(a.files, b.files);
            (a.diagnostics == b.diagnostics) & (a.main_unreadable == b.main_unreadable)
        }
        _ => false,
    };
    assert!(equal, "{:?}", request.main);
}

#[test]
fn it_changes_no_example_and_no_message() {
    for folder in ["examples", "tests/errors"] {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
        let mut memory = Memory::default();
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            // Those that run into a budget take seconds; what they read is nothing special.
            let slow = path.file_name().is_some_and(|n| n.to_string_lossy().starts_with("limit_"));
            if path.extension().is_some_and(|e| e == "scene") && !slow {
                same(&file(&path), &mut memory);
                same(&file(&path), &mut memory);
            }
        }
    }
}

#[test]
fn it_follows_edits_that_change_the_order_of_files() {
    let dir = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(dir.path().join(name), text).unwrap();
    image::RgbImage::new(3, 2).save(dir.path().join("p.png")).unwrap();
    write("a.scene", "export fn a() = sphere(mat: matte(image(\"p.png\")))");
    write("b.scene", "import \"c.scene\" { c }\nexport fn b() = c(2)");
    write("c.scene", "export fn c(r) = sphere(r: r)");
    let main = dir.path().join("main.scene");
    let mut memory = Memory::default();
    let imports = "import \"a.scene\" { a }\nimport \"b.scene\" { b }\n";
    for text in [
        format!("{imports}a()\nb()"),
        "import \"b.scene\" { b }\nimport \"a.scene\" { a }\na()\nb()".into(),
        format!("{imports}a()\nb("),
        format!("{imports}a()\nb(1)"),
        "import \"c.scene\" { c }\nc(-1)".into(),
        format!("import \"c.scene\" {{ c }}\n{imports}a()\nb()\nc(1)"),
        "import \"gone.scene\" { c }\nimport \"a.scene\" { a }\na()".into(),
        format!("{imports}a()\nb()"),
    ] {
        write("main.scene", &text);
        same(&file(&main), &mut memory);
        write("c.scene", "export fn c(r) = box()\nexport let unused = 1");
        same(&file(&main), &mut memory);
        image::RgbImage::new(4, 4).save(dir.path().join("p.png")).unwrap();
        same(&file(&main), &mut memory);
        write("c.scene", "export fn c(r) = sphere(r: r)");
        image::RgbImage::new(3, 2).save(dir.path().join("p.png")).unwrap();
        same(&file(&main), &mut memory);
    }
}

#[test]
fn it_keeps_what_is_used_and_what_a_failure_did_not_reach() {
    let dir = tempfile::tempdir().unwrap();
    image::RgbImage::new(3, 2).save(dir.path().join("p.png")).unwrap();
    fs::write(dir.path().join("lib.scene"), "export let r = 2").unwrap();
    let main = dir.path().join("main.scene");
    let mut memory = Memory::default();
    let mut texels = |text: &str| {
        fs::write(&main, text).unwrap();
        let result = again(&file(&main), &mut memory);
        (result.ok().and_then(|e| e.scene.images.first().map(|i| i.texels.clone())), memory.sizes())
    };
    let shows = "import \"lib.scene\" { r }\nsphere(r: r, mat: matte(image(\"p.png\")))";
    let (first, sizes) = texels(shows);
    assert_eq!(sizes, (2, 1));
    for i in 0..5 {
        let (none, sizes) = texels(&format!("sphere(r: -{i}"));
        assert!(none.is_none());
        assert_eq!(sizes, (3, 1), "the good text's, and the newest");
    }
    let (second, sizes) = texels(&format!("{shows}\nbox()"));
    assert!(std::sync::Arc::ptr_eq(&first.unwrap(), &second.unwrap()), "decoded once");
    assert_eq!(sizes, (2, 1));
    assert_eq!(texels("box()").1, (1, 0));
}

#[test]
fn what_can_not_be_decoded_has_been_read() {
    let dir = tempfile::tempdir().unwrap();
    let digest = |bytes: &[u8]| Some(*blake3::hash(bytes).as_bytes());
    fs::write(dir.path().join("p.png"), b"nothing").unwrap();
    fs::write(dir.path().join("l.scene"), b"\xFFx").unwrap();
    let main = dir.path().join("main.scene");
    let found = |text: &str| {
        fs::write(&main, text).unwrap();
        let f = evaluate(&file(&main)).unwrap_err();
        f.files.into_iter().map(|f| f.digest).collect::<Vec<_>>()
    };
    let picture = "sphere(mat: matte(image(\"p.png\")))";
    assert_eq!(found(picture), [digest(picture.as_bytes()), digest(b"nothing")]);
    let library = "import \"l.scene\" { x }";
    assert_eq!(found(library), [digest(library.as_bytes()), digest(b"\xFFx")]);
    let gone = "import \"gone.scene\" { x }\nimport \".\" as y";
    assert_eq!(found(gone), [digest(gone.as_bytes()), None, None]);
}

#[test]
fn a_text_may_end_with_a_replacement_character() {
    let e = scene("sphere() // \u{FFFD}");
    assert_eq!(e.scene.instance_count(), 1);
}

/// Programs that would take seconds, or for ever, without a budget of steps.
const ENDLESS: [&str; 6] = [
    "while true { }",
    "let a = [for i in 0..10000000 { i }]\nlet b = sort(a * 2 + a)",
    "fn f(n) = if n == 0 { 0 } else { f(n - 1) + f(n - 1) }\nlet a = f(60)",
    "fn d(s) = group { s; s |> move([1, 0, 0]) }\nvar g = sphere()\nfor i in 0..23 { g = d(g) }\ng",
    "let a = scatter([0, 0, 0], [100, 100, 100], 0.01)",
    "var a = [1, 2]\nvar b = [1, 2]\nfor i in 0..60 { a = [a, a]; b = [b, b] }\nlet c = a == b",
];

#[test]
fn cancelled_evaluations_give_nothing() {
    let mut memory = Memory::default();
    for text in ENDLESS.into_iter().chain(["sphere()", "sphere(", ""]) {
        assert!(evaluate_again(&request(text), &mut memory, &AtomicBool::new(true)).is_none(), "{text}");
        // A test can't know how far it came; whenever it is, nothing is given.
        let cancel = AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                std::thread::sleep(std::time::Duration::from_millis(20));
                cancel.store(true, Relaxed);
            });
            let result = evaluate_again(&request(text), &mut memory, &cancel);
            assert!(result.is_none() || !ENDLESS.contains(&text), "{text}");
        });
    }
    assert!(again(&request("sphere()"), &mut memory).is_ok());
}

#[test]
fn what_multiplies_ends() {
    let doubled = |inner: &str, end: &str| format!("var a = {inner}\nfor i in 0..60 {{ a = [a, a] }}\n{end}");
    let steps = ["the scene takes more than 50000000 steps to make"];
    assert_eq!(errors(&doubled("sphere()", "a")), steps);
    assert_eq!(errors(&doubled("[1, 2]", "let b = a * 2")), steps);
    assert_eq!(errors(&doubled("[1, 2]", "let b = rand(a)")), steps);
    assert_eq!(errors(ENDLESS[5]), steps);
    // Groups of nothing, 2^60 of them.
    let e = scene("var a = group { }\nfor i in 0..60 { let b = a; a = group { b; b } }\na\nsphere()");
    assert_eq!(e.scene.instance_count(), 1);
}

#[test]
fn long_lists_are_sorted_too() {
    let list = "0..30000 |> map(i => i * 7919 % 30000)";
    assert_eq!(value(&format!("sort({list}) == (0..30000 |> map(i => i))")), "true");
    // Equal ones keep their order: of each hundred, the places rise.
    let sorted = format!("sort(enumerate({list}), by: e => floor(e[1] / 100))");
    let falls = "(i => s[i][0] > s[i + 1][0] and floor(s[i][1] / 100) == floor(s[i + 1][1] / 100))";
    let text = format!("let s = {sorted}\nparam n: len(0..29999 |> filter({falls}))");
    assert_eq!(scene(&text).params[0].value, "0");
}
