//! Files that import each other.

use super::*;
use std::fs;

fn project(files: &[(&str, &str)]) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = dir.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    dir
}

fn run(dir: &tempfile::TempDir) -> Result<Evaluated, Failure> {
    let main = Input::File(dir.path().join("main.scene"));
    evaluate(&Request { main, set: Vec::new(), allow_read: Vec::new(), record_arguments: false })
}

fn messages(files: &[(&str, &str)]) -> Vec<String> {
    let dir = project(files);
    run(&dir).unwrap_err().diagnostics.into_iter().map(|d| d.message).collect()
}

#[test]
fn have_their_own_scope_and_relative_paths() {
    let dir = project(&[
        (
            "main.scene",
            "import \"lib/tree.scene\" as tree\nimport \"lib/tree.scene\" { oak, trunk as t }\noak(2)\ntree.oak(t)\nlet size = 99",
        ),
        (
            "lib/tree.scene",
            "import \"leaf.scene\" { leaf }\nlet size = 3\nexport let trunk = size\nexport fn oak(n) = group { for i in 0..n { leaf(size) } }\nsphere()\ncamera()",
        ),
        ("lib/leaf.scene", "export fn leaf(r) = sphere(r: r)"),
    ]);
    let e = run(&dir).unwrap_or_else(|f| panic!("{}", shown(&f)));
    assert_eq!(e.scene.instance_count(), 5, "a module's own shapes aren't added");
    assert_eq!(e.files.len(), 3, "{:?}", e.files);
    assert!(e.files.iter().all(|f| f.digest.is_some()));
}

#[test]
fn report_what_is_wrong() {
    let lib = ("lib.scene", "export let oak = 1\nlet ash = 2");
    assert_eq!(messages(&[("main.scene", "import \"lib.scene\" { oka }\noka"), lib]), ["the module exports no `oka`"]);
    assert_eq!(
        messages(&[("main.scene", "import \"lib.scene\" as l\nlet a = l.ash"), lib]),
        ["the module exports no `ash`"]
    );
    assert_eq!(
        messages(&[("main.scene", "import \"no.scene\" as l\nlet a = l.ash")]),
        ["can't read `no.scene`: there is no such file"]
    );
    let circle = messages(&[("main.scene", "import \"a.scene\" as a"), ("a.scene", "import \"main.scene\" as m")]);
    assert_eq!(circle, ["files import each other in a circle"]);
    let broken = messages(&[
        ("main.scene", "import \"a.scene\" as a\nlet x = a.f(1)"),
        ("a.scene", "export fn f(x) = x +\nexport let g = 1"),
    ]);
    assert_eq!(broken.len(), 1, "{broken:?}");
    assert_eq!(
        messages(&[("main.scene", "import \"../other.scene\" as a")])[0],
        "can't read `../other.scene`: there is no such file"
    );
}

#[test]
fn a_missing_main_file_is_not_the_scene_s_fault() {
    let dir = project(&[]);
    let f = run(&dir).unwrap_err();
    assert!(f.main_unreadable);
}
