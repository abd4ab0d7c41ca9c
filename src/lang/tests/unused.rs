//! What a text makes and doesn't use leaves nothing in the scene.

use super::*;

/// How many nodes, materials, patterns and pictures a scene has.
fn size(text: &str) -> [usize; 4] {
    let s = scene(text).scene;
    [s.nodes.len(), s.materials.len(), s.patterns.len(), s.images.len()]
}

#[test]
fn unused_things_leave_nothing() {
    let used = "let m = matte(checker(red, noise(white, gold) |> scale(2)))\n\
        group(mat: m) { sphere() |> move([1, 2, 3]); group { box() } }\n\
        sphere(mat: m.with(bump: noise()))\nlight(at: [4, 5, 6])\n";
    let unused = "let w = blend([red, m.color, stripes(red, gold)], by: noise())\nlet s = sphere(mat: matte(w)) |> move([0, 1, 0])\n\
        let g = group { s; light(at: [1, 1, 1]) }\nlet p = matte(image(\"assets/none.png\"))\nfn f(x) = sphere(r: x)\nlet l = f(2)\n";
    let lets: String = (0..10_000).map(|i| format!("let a{i} = [{i}, {i}, {i}]\n")).collect();
    let (bare, more) = (scene(used).scene, scene(&format!("{used}{unused}{lets}")).scene);
    assert!(bare == more);
    // In front, they change the places in the text, but nothing else.
    assert_eq!(size(used), size(&format!("let m2 = matte(teal)\nlet s2 = sphere(mat: m2)\n{used}")));
    let first = "let unused = sphere(mat: matte(teal))\n";
    let a = scene(&format!("// {}\n{used}", "x".repeat(first.len() - 4))).scene;
    assert!(a == scene(&format!("{first}{used}")).scene);
}
