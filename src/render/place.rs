//! Puts a shape of the scene into the world: finds its frame, its size there, its box, and the way back to the space in
//! which it was made.

use super::bounds::{Bounds, larger};
use super::shape::{Kind, Ring, Tube};
use crate::math::affine::reciprocal_power;
use crate::math::{Affine, Dd};
use crate::scene::{MeshId, Shape};
use glam::DVec3;

/// A shape in its frame, before it has a number.
pub struct Placed {
    /// What it is.
    pub form: Form,
    /// From the shape's frame to the camera-relative world.
    pub world_from_local: Affine,
    /// From the shape's frame before any scaling (for triangles: from (β, 0, γ)) to the space in which it was made.
    pub made_from_local: Affine,
    /// How the frame's lengths were scaled.
    pub rescale: Option<Rescale>,
    /// Its extent in its frame: centre, half size. `None` for what has no end.
    pub extent: Option<[[f64; 3]; 2]>,
}

/// What a placed shape is: a kind with a frame, or a triangle whose corners stand in the world.
pub enum Form {
    /// In its frame.
    Framed(Kind),
    /// Corners in the world, normal and shading normals there.
    Triangle([[f64; 3]; 3], [f64; 3], Option<[[f64; 3]; 3]>),
    /// The triangles of a file, which stand in the frame as they were made, and whether they look smooth.
    Mesh(MeshId, bool),
}

/// Leads from lengths of a scaled frame back to those in which the shape was made. Faces keep their exact coordinates there: a
/// product with 1/s would leave them beside the cell boundaries of patterns on which they were put.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rescale {
    /// 1/s.
    pub inverse: f64,
    /// By axis: coordinates of the two faces across it in the scaled frame, and as made; NaN where there are none.
    pub faces: [[(f64, f64); 2]; 3],
}

impl Rescale {
    fn new(s: f64, kind: &Kind) -> Rescale {
        let mut faces = [[(f64::NAN, f64::NAN); 2]; 3];
        let face = |x: f64| (x * s, x);
        match kind {
            Kind::Cuboid(half) => faces = half.map(|h| [face(-h), face(h)]),
            Kind::Tube(t) => faces[1] = [face(t.bottom), face(t.top)],
            _ => {}
        }
        Rescale { inverse: 1.0 / s, faces }
    }
}

impl Placed {
    /// Moves the frame's origin to `offset` from where `corner` is in the world. What rounding left out of a size is then missing
    /// at the far end, and what stands on a table stands exactly on it: in one place the table is seen, by number.
    fn hang(&mut self, world: &Affine, corner: DVec3, offset: [f64; 3]) {
        let shift = world.apply_dd(corner.to_array().map(Dd::new));
        self.world_from_local.shift = Affine { shift, ..self.world_from_local }.apply_dd(offset.map(Dd::new));
    }

    /// Coordinates of the faces across each axis, in the lengths in which the shape was made; NaN where there are none.
    pub fn faces_as_made(&self) -> [[f64; 2]; 3] {
        let faces = match (&self.rescale, &self.form) {
            (Some(rescale), _) => rescale.faces,
            (None, Form::Framed(kind)) => Rescale::new(1.0, kind).faces,
            (None, Form::Triangle(..) | Form::Mesh(..)) => [[(f64::NAN, f64::NAN); 2]; 3],
        };
        faces.map(|across| across.map(|(_, made)| made))
    }
}

/// Relative size below which an entry of a map is the rounding error of a rotation: 512 roundings.
pub const RESIDUE: f64 = 512.0 * f64::EPSILON;

/// How many primitives a shape is: a tetrahedron is four triangles.
pub fn parts(shape: &Shape) -> usize {
    if let Shape::Tetrahedron { .. } = shape { 4 } else { 1 }
}

/// Puts part number `part` of `shape` into the world.
pub fn place(shape: &Shape, world_from_object: &Affine, part: usize) -> Placed {
    match shape {
        Shape::Sphere { at, r } => sphere(*at, *r, world_from_object),
        Shape::Plane { through, normal } => framed(Kind::Plane, axis_frame(*through, *normal), None, world_from_object),
        Shape::Disc { at, normal, r, hole } => {
            let kind = Kind::Disc { r: *r, hole: *hole };
            framed(kind, axis_frame(*at, *normal), Some([[0.0; 3], [*r, 0.0, *r]]), world_from_object)
        }
        Shape::Box { from, to } => {
            let half = ((*to - *from) * 0.5).to_array();
            // In double-double: a box far out has its middle between two numbers.
            let mut centre = Affine::translation(*from);
            centre.shift = std::array::from_fn(|i| centre.shift[i] + Dd::new(half[i]));
            let mut placed = framed(Kind::Cuboid(half), centre, Some([[0.0; 3], half]), world_from_object);
            if let Form::Framed(Kind::Cuboid(half)) = placed.form {
                placed.hang(world_from_object, *from, half);
            }
            placed
        }
        Shape::Cylinder { from, to, r, caps } => tube(*from, *to, *r, *r, *caps, world_from_object),
        Shape::Cone { from, to, r, top, caps } => tube(*from, *to, *r, *top, *caps, world_from_object),
        Shape::Torus { at, r, tube, axis } => {
            let out = r + tube;
            let kind = Kind::Ring(Ring::new(*r, *tube));
            framed(kind, axis_frame(*at, *axis), Some([[0.0; 3], [out, *tube, out]]), world_from_object)
        }
        Shape::Triangle { points, normals } => triangle(**points, normals.as_deref().copied(), world_from_object),
        Shape::Tetrahedron { points } => {
            let [a, b, c, d] = &**points;
            // Corners of each face go round counter-clockwise seen from outside.
            let outward = (*b - *a).cross(*c - *a).dot(*d - *a) < 0.0;
            let [p, q, r] = [[a, b, c], [a, c, d], [a, d, b], [b, d, c]][part];
            let corners = if outward { [*p, *q, *r] } else { [*p, *r, *q] };
            triangle(corners, None, world_from_object)
        }
        Shape::Mesh { mesh, smooth } => Placed {
            form: Form::Mesh(*mesh, *smooth),
            world_from_local: *world_from_object,
            made_from_local: Affine::IDENTITY,
            rescale: None,
            extent: None,
        },
    }
}

fn sphere(at: DVec3, r: f64, world_from_object: &Affine) -> Placed {
    let centre = Affine::translation(at);
    let Some(s) = similarity(world_from_object) else {
        return framed(Kind::Sphere(r), centre, Some([[0.0; 3], [r; 3]]), world_from_object);
    };
    // A turned sphere is a sphere: only its patterns turn.
    let shift = world_from_object.apply_dd(centre.shift);
    let turn = Affine { shift: [Dd::default(); 3], ..*world_from_object };
    let back = || turn.inverse().unwrap_or(Affine::IDENTITY);
    Placed {
        form: Form::Framed(Kind::Sphere(r * s)),
        world_from_local: Affine { shift, ..Affine::IDENTITY },
        made_from_local: if turn.is_translation() { centre } else { centre.compose(&back()) },
        rescale: None, // the turn's inverse scales back; a curved surface has no faces
        extent: Some([[0.0; 3], [r * s; 3]]),
    }
}

fn tube(from: DVec3, to: DVec3, r: f64, top: f64, caps: bool, world_from_object: &Affine) -> Placed {
    // Along a falling axis the shape is turned over, which spares the frame its signs.
    let d = to - from;
    let falls = d.x + d.y + d.z < 0.0 && d.to_array().iter().filter(|x| **x != 0.0).count() == 1;
    let (from, to, r, top) = if falls { (to, from, top, r) } else { (from, to, r, top) };
    let height = length(to - from);
    let slope = (top - r) / height;
    // A pointed cone is measured from its apex, where its radius is small: anything else would make it a difference.
    let (origin, radius, bottom, upper) = if top == 0.0 { (to, 0.0, -height, 0.0) } else { (from, r, 0.0, height) };
    let kind = Kind::Tube(Tube { radius, slope, bottom, top: upper, caps });
    let widest = if r > top { r } else { top };
    let extent = [[0.0, 0.5 * (bottom + upper), 0.0], [widest, 0.5 * height, widest]];
    let mut placed = framed(kind, axis_frame(origin, to - from), Some(extent), world_from_object);
    if top == 0.0
        && let Form::Framed(Kind::Tube(cone)) = placed.form
    {
        placed.hang(world_from_object, from, [0.0, -cone.bottom, 0.0]);
    }
    placed
}

fn framed(kind: Kind, object_from_local: Affine, extent: Option<[[f64; 3]; 2]>, world: &Affine) -> Placed {
    let world_from_local = world.compose(&object_from_local);
    let Some(s) = similarity(world) else {
        return Placed {
            form: Form::Framed(kind),
            world_from_local,
            made_from_local: object_from_local,
            rescale: None,
            extent,
        };
    };
    // Sizes take the scale, so that the frame is a rotation, often none at all.
    let unit = match s {
        1.0 => Affine::IDENTITY,
        _ => Affine::scaling(DVec3::splat(s)).inverse().unwrap_or(Affine::IDENTITY),
    };
    let grow = |v: [f64; 3]| v.map(|x| x * s);
    let rescale = (s != 1.0).then(|| Rescale::new(s, &kind));
    let kind = match kind {
        Kind::Sphere(r) => Kind::Sphere(r * s),
        Kind::Plane => Kind::Plane,
        Kind::Disc { r, hole } => Kind::Disc { r: r * s, hole: hole * s },
        Kind::Cuboid(half) => Kind::Cuboid(grow(half)),
        Kind::Tube(t) => Kind::Tube(Tube { radius: t.radius * s, bottom: t.bottom * s, top: t.top * s, ..t }),
        Kind::Ring(ring) => Kind::Ring(Ring::new(ring.r / ring.scale * s, ring.tube / ring.scale * s)),
        Kind::Triangle(_) | Kind::Mesh(_) => kind,
    };
    Placed {
        form: Form::Framed(kind),
        world_from_local: world_from_local.compose(&unit),
        made_from_local: object_from_local,
        rescale,
        extent: extent.map(|e| e.map(grow)),
    }
}

fn triangle(points: [DVec3; 3], normals: Option<[DVec3; 3]>, world: &Affine) -> Placed {
    let v = points.map(|p| world.apply(p).to_array());
    let (e1, e2) = (points[1] - points[0], points[2] - points[0]);
    let map = normals_map(world);
    let to_world = |n: DVec3| normal_to_world(&map, n);
    let mut made = Affine::translation(points[0]);
    for (r, (x, y)) in e1.to_array().into_iter().zip(e2.to_array()).enumerate() {
        made.linear[r] = [Dd::new(x), Dd::new(0.0), Dd::new(y)];
    }
    Placed {
        form: Form::Triangle(v, to_world(face_normal(points)), normals.map(|ns| ns.map(to_world))),
        world_from_local: Affine::IDENTITY,
        made_from_local: made,
        rescale: None,
        extent: None,
    }
}

/// A direction straight out of a triangle, on the side from which its corners go round counter-clockwise.
pub fn face_normal(points: [DVec3; 3]) -> DVec3 {
    let (e1, e2) = (points[1] - points[0], points[2] - points[0]);
    let scale = larger(largest(e1), largest(e2));
    (e1 / scale).cross(e2 / scale)
}

/// What takes normals to the world, but for their length: they go by the inverse transposed, so a mirrored shape keeps its
/// outside.
pub fn normals_map(world: &Affine) -> [[f64; 3]; 3] {
    let back = world.inverse().unwrap_or(Affine::IDENTITY).linear_f64();
    std::array::from_fn(|r| std::array::from_fn(|c| back[c][r]))
}

/// The direction `n`, of any length but 0, by a map for normals; of unit length.
#[inline]
pub fn normal_to_world(map: &[[f64; 3]; 3], n: DVec3) -> [f64; 3] {
    let n = unit(n).to_array();
    unit(DVec3::from_array(map.map(|row| (0..3).map(|i| row[i] * n[i]).sum()))).to_array()
}

/// The box of a framed shape's extent in the world.
pub fn world_bounds(extent: [[f64; 3]; 2], world_from_local: &Affine) -> Bounds {
    let [centre, half] = extent;
    let m = world_from_local.linear_f64();
    let c = world_from_local.apply(DVec3::from_array(centre)).to_array();
    Bounds::around(c, std::array::from_fn(|r| (0..3).map(|k| m[r][k].abs() * half[k]).sum()))
}

/// The factor by which a map scales all lengths, or `None` where it stretches.
fn similarity(map: &Affine) -> Option<f64> {
    if map.is_translation() {
        return Some(1.0);
    }
    let m = map.linear_f64();
    let column = |a: usize, b: usize| (0..3).map(|r| m[r][a] * m[r][b]).sum::<f64>();
    let s2 = column(0, 0);
    let close = |x: f64, y: f64| (x - y).abs() <= RESIDUE * s2;
    let even = close(column(1, 1), s2) && close(column(2, 2), s2);
    let square = [(0, 1), (0, 2), (1, 2)].into_iter().all(|(a, b)| close(column(a, b), 0.0));
    if !(even && square) {
        return None;
    }
    // A rotation's rounding error isn't a scale, whatever power of two is its size.
    let s = s2.sqrt();
    let power = 1.0 / reciprocal_power(s);
    let near_power = [power, 2.0 * power].into_iter().find(|p| close(s2, p * p));
    // Nor is that of a turn about a coordinate axis, along which the scale stands alone: a table and what was turned on it
    // keep one and the same level.
    let alone = || (0..3).map(|c| (0..3).map(move |r| m[r][c].abs())).find_map(only_one);
    Some(near_power.or_else(alone).unwrap_or(s))
}

/// The only one of three magnitudes that isn't 0.
fn only_one(x: impl Iterator<Item = f64>) -> Option<f64> {
    let mut others = x.filter(|x| *x != 0.0);
    let one = others.next()?;
    others.next().is_none().then_some(one)
}

/// A right-handed frame at `origin` whose y axis points along `axis`; the world's own axes where one of them does.
fn axis_frame(origin: DVec3, axis: DVec3) -> Affine {
    let v = axis.to_array();
    let mut frame = Affine::translation(origin);
    let along: Vec<usize> = (0..3).filter(|&i| v[i] != 0.0).collect();
    let (x, y, z) = match along[..] {
        [i] => {
            let sign = v[i].signum();
            let e = |k: usize| DVec3::from_array(std::array::from_fn(|j| if j == k % 3 { 1.0 } else { 0.0 }));
            // Cyclic for a rising axis; half a turn about x for a falling one.
            (e(i + 2), e(i) * sign, e(i + 1) * sign)
        }
        _ => {
            let y = unit(axis);
            let a = y.abs();
            let least = if a.x <= a.y && a.x <= a.z {
                DVec3::X
            } else if a.y <= a.z {
                DVec3::Y
            } else {
                DVec3::Z
            };
            let x = unit(least.cross(y));
            (x, y, x.cross(y))
        }
    };
    for (r, row) in frame.linear.iter_mut().enumerate() {
        *row = [Dd::new(x[r]), Dd::new(y[r]), Dd::new(z[r])];
    }
    frame
}

/// Unit vector along `v`, which isn't 0; scaled first, so that no square leaves the range.
pub fn unit(v: DVec3) -> DVec3 {
    let s = v / largest(v);
    s / s.length()
}

fn length(v: DVec3) -> f64 {
    let m = largest(v);
    (v / m).length() * m
}

fn largest(v: DVec3) -> f64 {
    v.abs().max_element()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axis_frames_are_right_handed_rotations() {
        for axis in [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::Y, -DVec3::X, DVec3::new(1.0, -2.0, 3.0)] {
            let f = axis_frame(DVec3::ZERO, axis);
            let (x, y, z) = (f.apply(DVec3::X), f.apply(DVec3::Y), f.apply(DVec3::Z));
            assert!(y.distance(axis.normalize()) < 1e-15);
            assert!(x.cross(y).distance(z) < 1e-15 && (x.length() - 1.0).abs() < 1e-15, "{axis}");
        }
    }

    #[test]
    fn scaling_goes_into_the_size_and_turning_into_the_frame() {
        let world = Affine::rotation(2, 90.0).compose(&Affine::scaling(DVec3::splat(3.0)));
        let placed = place(&Shape::Cylinder { from: DVec3::ZERO, to: DVec3::Y, r: 2.0, caps: true }, &world, 0);
        let Form::Framed(Kind::Tube(t)) = &placed.form else { panic!() };
        assert_eq!((t.radius, t.top), (6.0, 3.0));
        assert_eq!(placed.rescale.unwrap().faces[1], [(0.0, 0.0), (3.0, 1.0)]);
        assert_eq!(placed.made_from_local.apply(DVec3::Y), DVec3::Y);
        assert_eq!(placed.world_from_local.apply(DVec3::new(0.0, 3.0, 0.0)), DVec3::new(-3.0, 0.0, 0.0));
    }

    #[test]
    fn what_was_turned_on_a_table_stands_on_it_at_any_scale() {
        for s in [1.0, 1e-6, 1e-3, 3.7, 1e3, 1e9] {
            let world = Affine::scaling(DVec3::splat(s)).compose(&Affine::translation(DVec3::new(0.1, 0.3, 0.2)));
            let turned = world.compose(&Affine::rotation(1, 28.0));
            let glass = Shape::Box { from: DVec3::new(-0.42, 0.0, -0.42), to: DVec3::new(0.42, 0.7, 0.42) };
            let cone = Shape::Cone { from: DVec3::ZERO, to: DVec3::Y * 0.7, r: 0.3, top: 0.0, caps: true };
            let level =
                place(&Shape::Plane { through: DVec3::ZERO, normal: DVec3::Y }, &world, 0).world_from_local.shift[1];
            for shape in [glass, cone] {
                let placed = place(&shape, &turned, 0);
                assert_eq!(placed.world_from_local.linear_f64()[1], [0.0, 1.0, 0.0], "{s}");
                let lowest = match &placed.form {
                    Form::Framed(Kind::Cuboid(half)) => -half[1],
                    Form::Framed(Kind::Tube(t)) => t.bottom,
                    _ => f64::NAN,
                };
                let off = placed.world_from_local.shift[1] + Dd::new(lowest) - level;
                assert!(off.hi.abs() <= 1e-30 * s, "{s}: {off:?}");
            }
        }
    }

    #[test]
    fn tetrahedron_faces_look_outwards_whatever_the_order_of_corners() {
        let p = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        for points in [p, [p[1], p[0], p[2], p[3]]] {
            for part in 0..4 {
                let face = place(&Shape::Tetrahedron { points: Box::new(points) }, &Affine::IDENTITY, part);
                let Form::Triangle(v, n, _) = face.form else { panic!() };
                let from_middle = DVec3::from_array(v[0]) - DVec3::splat(0.2);
                assert!(from_middle.dot(DVec3::from_array(n)) > 0.0);
            }
        }
    }
}
