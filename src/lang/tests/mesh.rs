//! Meshes from files: every format gives the same triangles, and every fault its message.

use super::*;
use crate::scene::MeshData;

/// Evaluates a scene that shows `bytes` as the file `name`; the mesh, or the first message.
fn shown_as(name: &str, bytes: &[u8]) -> Result<MeshData, String> {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join(name), bytes).unwrap();
    let text = format!("mesh(\"{name}\")");
    let main = Input::Text { name: "m.scene".into(), bytes: text.into_bytes(), folder: dir.path().to_owned() };
    let request = Request { main, set: Vec::new(), allow_read: Vec::new(), record_arguments: false };
    match evaluate(&request) {
        Ok(e) => Ok((*e.scene.meshes[0].data).clone()),
        Err(f) => Err(f.diagnostics[0].message.clone()),
    }
}

/// A file of binary PLY: a square, as one face of four corners and one of three, with directions.
fn ply(big: bool) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let header = format!(
        "ply\nformat binary_{order}_endian 1.0\ncomment a square\nelement vertex 4\nproperty double x\nproperty float y\n\
         property short z\nproperty uchar red\nproperty float nx\nproperty float ny\nproperty float nz\nelement face 2\n\
         property int material\nproperty list uchar int vertex_index\nelement edge 1\nproperty list ushort double of\nend_header\n"
    );
    let mut out = header.into_bytes();
    let mut put = |bytes: &[u8]| {
        let mut own = bytes.to_vec();
        if big {
            own.reverse();
        }
        out.extend(own);
    };
    for [x, y] in [[0.0, 0.0], [1.5, 0.0], [1.5, 1.0], [0.0, 1.0f32]] {
        put(&(x as f64).to_le_bytes());
        put(&y.to_le_bytes());
        put(&(-3i16).to_le_bytes());
        put(&[255]);
        [0.0, 0.5, 2.0f32].iter().for_each(|n| put(&n.to_le_bytes()));
    }
    for face in [&[0, 1, 2, 3][..], &[0, 1, 3]] {
        put(&7i32.to_le_bytes());
        put(&[face.len() as u8]);
        face.iter().for_each(|i: &i32| put(&i.to_le_bytes()));
    }
    put(&2u16.to_le_bytes());
    [1.0, 2.0f64].iter().for_each(|x| put(&x.to_le_bytes()));
    out
}

const TEXT_PLY: &str = "ply\r
format ascii 1.0\r
obj_info of no use\r
element vertex 4\r
property float x\r
property float y\r
property float z\r
property float nx\r
property float ny\r
property float nz\r
element face 2\r
property list uchar uint vertex_indices\r
end_header\r
0 0 -3 0 .5 2\r
1.5 0 -3 0 .5 2\r
1.5 1 -3 0 .5 2
0 1e0 -3 0 .5 2
4 0 1 2 3
3 0 1 3
";

const OBJ: &str = "# a square
mtllib none.mtl
o square
v 0 0 -3
v 1.5 0 -3 0.5 0.5 0.5
v 1.5 1 -3
v 0 1 -3
vt 0 0
vn 0 .5 2
s 1
f 1//1 2//1 3//1 4//1
f -4/1/-1 -3/1/-1 -1/1/-1
";

const TEXT_STL: &str = "solid square with facet vertex in its name
facet normal 0 0 1
  outer loop
    vertex 0 0 -3
    vertex 1.5 0 -3
    VERTEX 1.5 1 -3
    vertex 0 1 -3
  endloop
endfacet
facet normal 0 0 1
  outer loop
    vertex 0 0 -3
    vertex 1.5 0 -3
    vertex 0 1 -3
  endloop
endfacet
endsolid
";

fn binary_stl() -> Vec<u8> {
    let p: [[f32; 3]; 4] = [[0.0, -0.0, -3.0], [1.5, 0.0, -3.0], [1.5, 1.0, -3.0], [0.0, 1.0, -3.0]];
    let mut out = b"solid, says the header, but it is binary".to_vec();
    out.resize(80, b' ');
    out.extend(3u32.to_le_bytes());
    for t in [[0, 1, 2], [0, 2, 3], [0, 1, 3]] {
        out.extend([0; 12]);
        t.iter().for_each(|i: &usize| p[*i].iter().for_each(|x| out.extend(x.to_le_bytes())));
        out.extend([0; 2]);
    }
    out
}

#[test]
fn every_format_gives_the_same_triangles() {
    let files: [(&str, Vec<u8>); 6] = [
        ("little.ply", ply(false)),
        ("big.ply", ply(true)),
        ("text.ply", TEXT_PLY.into()),
        ("square.obj", OBJ.into()),
        ("text.stl", TEXT_STL.into()),
        ("binary.stl", binary_stl()),
    ];
    for (name, bytes) in files {
        let mesh = shown_as(name, &bytes).unwrap_or_else(|e| panic!("{name}: {e}"));
        let points = [[0.0, 0.0, -3.0], [1.5, 0.0, -3.0], [1.5, 1.0, -3.0], [0.0, 1.0, -3.0]];
        assert_eq!(mesh.points, points, "{name}");
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 3]], "{name}");
        let smooth = !name.ends_with("stl");
        for k in 0..3 {
            let directions = mesh.normals_of(k).map(|of| of.map(|i| mesh.normals[i as usize]));
            assert_eq!(directions, smooth.then_some([[0.0, 0.5, 2.0]; 3]), "{name}");
        }
        let [lo, hi] = mesh.bounds.map(|p| p.to_array());
        assert_eq!((lo, hi), ([0.0, 0.0, -3.0], [1.5, 1.0, -3.0]), "{name}");
    }
}

#[test]
fn many_plain_triangles_are_read_at_once() {
    let n = 100_000u32;
    let mut out = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {n}\nproperty list uchar int vertex_indices\nend_header\n",
        n + 2
    )
    .into_bytes();
    (0..n + 2).for_each(|i| [i as f32, (i % 2) as f32, 0.0].iter().for_each(|x| out.extend(x.to_le_bytes())));
    for i in 0..n {
        out.push(3);
        (i..i + 3).for_each(|k| out.extend(k.to_le_bytes()));
    }
    let mesh = shown_as("strip.ply", &out).unwrap();
    assert!(mesh.triangles.iter().zip(0..).all(|(t, i)| *t == [i, i + 1, i + 2]) && mesh.triangles.len() == n as usize);
    let last = out.len() - 4;
    out[last..].copy_from_slice(&(n + 2).to_le_bytes());
    let beyond = format!(
        "can't use `strip.ply`: face {n} names point {}, counted from 0, and there are {} points",
        n + 2,
        n + 2
    );
    assert_eq!(shown_as("strip.ply", &out), Err(beyond));
    out.truncate(last);
    assert_eq!(shown_as("strip.ply", &out), Err("can't use `strip.ply`: it is damaged: it ends too early".into()));
}

#[test]
fn corners_without_directions_are_flat_and_faces_without_area_left_out() {
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nvn 0 0 1\nvn 0 0 0\n\
               f 1//1 2//1 3//1\nf 1 2 3\nf 1 2 4\nf 1 1 3\nf 1//1 2//2 3//1\nf 2//1 1//1 3//1\n";
    let mesh = shown_as("mixed.obj", obj.as_bytes()).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 1, 2], [0, 1, 2], [1, 0, 2]]);
    let smooth: Vec<bool> = (0..4).map(|k| mesh.normals_of(k).is_some()).collect();
    assert_eq!(smooth, [true, false, false, true]);
    let small = "v 0 0 0\nv 1e-130 0 0\nv 0 1e-130 0\nv 1e-300 0 1\nf 1 2 3\nf 4 2 3\n";
    let mesh = shown_as("small.obj", small.as_bytes()).unwrap();
    assert_eq!((mesh.triangles.len(), mesh.points[3]), (2, [0.0, 0.0, 1.0]), "small, but not nothing");
}

#[test]
fn faults_of_mesh_files() {
    let header = |rest: &str| format!("ply\nformat ascii 1.0\n{rest}end_header\n");
    let xyz = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    let face = "element face 1\nproperty list uchar int vertex_indices\n";
    let whole = header(&format!("{xyz}{face}"));
    let stl = |line: &str| format!("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n{line}\nendloop\nendfacet\n");
    let cut = &binary_stl()[..200];
    let cases: [(&str, Vec<u8>, &str); 29] = [
        ("a.ply", header(&format!("{xyz}{xyz}")).into(), "its header has the line `element vertex 3`"),
        ("a.ply", "png".into(), "it is neither a PLY, an OBJ nor an STL file"),
        ("a.obj", "".into(), "it has no triangles"),
        ("a.xyz", "v 0 0 0\nf 1 1 1".into(), "it has no triangles"),
        ("a.xyz", "solution: v 0 0 0".into(), "it is neither a PLY, an OBJ nor an STL file"),
        ("a.stl", cut.into(), "it is damaged: not a complete STL file"),
        ("a.ply", "ply\nformat ascii 1.0\n".into(), "its header doesn't end"),
        ("a.ply", "ply\nend_header\n".into(), "its header has no `format`"),
        ("a.ply", "ply\nformat binary 1.0\nend_header\n".into(), "its header has the line `format binary 1.0`"),
        ("a.ply", header("element face many\n").into(), "its header has the line `element face many`"),
        ("a.ply", header("element face 1\nproperty big x\n").into(), "its header has the line `property big x`"),
        (
            "a.ply",
            header("element vertex 99999999\n").into(),
            "it is too large: it has more than 16777215 triangles or points",
        ),
        ("a.ply", header("element vertex 1\nproperty float x\n").into(), "its points have no `y`"),
        ("a.ply", header(&format!("{xyz}element face 1\n")).into(), "it is damaged: it ends too early"),
        (
            "a.ply",
            (header(&format!("{xyz}element face 1\n")) + "0 0 0 1 0 0 0 1 0").into(),
            "its faces have no list `vertex_indices`",
        ),
        ("a.ply", (whole.clone() + "0 0 0 1 0 0 0 1 0\n3 0 1").into(), "it is damaged: it ends too early"),
        (
            "a.ply",
            (whole.clone() + "0 0 0 1 0 0 0 1 0\n3 0 1 3").into(),
            "face 1 names point 3, counted from 0, and there are 3 points",
        ),
        (
            "a.ply",
            (whole.clone() + "0 0 0 1 0 0 0 1 0\n3 0 1 -1").into(),
            "face 1 names point -1, counted from 0, and there are 3 points",
        ),
        ("a.ply", (whole.clone() + "0 0 0 1 0 0 0 1 0\n-3 0 1 2").into(), "a list can't have -3 items"),
        ("a.ply", (whole.clone() + "0 0 0 1 0 zero 0 1 0\n3 0 1 2").into(), "`zero` is no number"),
        ("a.ply", (whole.clone() + "0 0 0 1 0 nan 0 1 0\n3 0 1 2").into(), "a coordinate of point 2 is not a number"),
        ("a.ply", (whole.clone() + "0 0 0 1 0 0 0 1e200 0\n3 0 1 2").into(), "a coordinate of point 3 is beyond 1e140"),
        ("a.ply", (whole.clone() + "0 0 0 1 0 0 2 0 0\n3 0 1 2").into(), "it has no triangles"),
        ("a.obj", "v 0 0\n".into(), "line 1: a number is missing"),
        ("a.obj", "v 0 0 0\nf 1 1\n".into(), "line 2: a face needs 3 corners at least"),
        ("a.obj", "v 0 0 0\nf 1 1 2\n".into(), "line 2: a face names point 2, and there are 1 point"),
        ("a.obj", "v 0 0 0\nf 1 0 -2\n".into(), "line 2: a face can't have the corner `0`"),
        ("a.stl", stl("vertex 1 1").into(), "line 5: a number is missing"),
        ("a.stl", stl("vortex 1 1 1").into(), "line 5: an STL file has no `vortex`"),
    ];
    for (name, bytes, why) in cases {
        let message = format!("can't use `{name}`: {why}");
        assert_eq!(shown_as(name, &bytes), Err(message), "{}", String::from_utf8_lossy(&bytes));
    }
    assert_eq!(
        shown_as("a.stl", stl("vertex 1 1 1").as_bytes()),
        Err("can't use `a.stl`: line 6: this face has fewer than 3 corners".into())
    );
}

#[test]
fn a_mesh_is_a_file_like_any_other() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("square.obj"), OBJ).unwrap();
    let on = |text: &str, limits: Limits| {
        let main = Input::Text { name: "m.scene".into(), bytes: text.into(), folder: dir.path().to_owned() };
        let request = Request { main, set: Vec::new(), allow_read: Vec::new(), record_arguments: false };
        evaluate_within(&request, limits)
    };
    let read = on(
        "let m = mesh(\"square.obj\")\nm\nm |> move([3, 0, 0])\nmesh(\"square.obj\", smooth: false)",
        Limits::default(),
    );
    let read = read.unwrap();
    assert_eq!((read.scene.meshes.len(), read.files.len()), (1, 1), "read once, and watched");
    assert!(read.files[0].digest.is_some());
    // What nothing shows isn't opened.
    let unused = on("let m = mesh(\"none.ply\")\nbox()", Limits::default()).unwrap();
    assert!(unused.scene.meshes.is_empty() && unused.files.is_empty());
    let message = |text: &str, limits: Limits| on(text, limits).map_err(|f| f.diagnostics[0].message.clone()).err();
    let small = Limits { surfaces: 5, ..Limits::default() };
    assert_eq!(message("mesh(\"square.obj\")", small), None);
    let twice = "mesh(\"square.obj\")\nmesh(\"square.obj\") |> move([1, 0, 0])";
    assert_eq!(message(twice, small), Some("the scene has more than 5 triangles and other surfaces".into()));
    let missing = message("mesh(\"sqare.obj\")", Limits::default());
    assert_eq!(missing, Some("can't read `sqare.obj`: there is no such file".into()));
    let outside = message("mesh(\"../square.obj\")", Limits::default());
    assert!(outside.is_some_and(|m| m.contains("`../square.obj`")), "not beneath the project");
    let far = message("mesh(\"square.obj\") |> scale(1e100) |> scale(1e100)", Limits::default());
    assert_eq!(far, Some("this mesh is scaled beyond all measure".into()));
}

#[test]
fn no_damage_to_a_mesh_file_panics() {
    let files = [ply(false), ply(true), TEXT_PLY.into(), OBJ.into(), TEXT_STL.into(), binary_stl()];
    let mut refused = 0;
    for (i, file) in files.iter().enumerate() {
        for k in 0..300u64 {
            let key = crate::math::hash::KeyedHash::new().with(i as u64).with(k);
            let mut bytes = file.clone();
            let at = (key.with(1).unit() * bytes.len() as f64) as usize;
            match k % 3 {
                0 => bytes.truncate(at),
                1 => bytes[at] = key.with(2).bits() as u8,
                _ => drop(bytes.drain(at / 2..at)),
            }
            refused += crate::lang::mesh::decode(bytes, "", &Limits::default()).is_err() as u32;
        }
    }
    assert!(refused > 300, "{refused}");
}
