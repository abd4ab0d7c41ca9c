//! `rtdsl explain`: what the renderer does for a scene and which line made it, or what one pixel sees.

use super::args::ExplainArgs;
use super::load::{load, request, shown_name};
use super::{Exit, Stop};
use crate::diag::{Diagnostic, Place, Sources};
use crate::lang::Evaluated;
use crate::render::{self, Feature, Options, Probe, World};
use crate::scene::{Camera, NodeKind};
use std::fmt::Write as _;
use std::io::{self, Write as _};

/// Runs the command.
///
/// # Errors
/// The scene is wrong or can't be read, the pixel lies outside, or standard output fails.
pub fn run(args: &ExplainArgs) -> Result<Exit, Stop> {
    let mut request = request(&args.scene.file, &args.scene.set, &args.scene.allow_read)?;
    request.record_arguments = args.pixel.is_some();
    let evaluated = load(&request, false)?;
    let camera = args.view.camera(&evaluated.scene)?;
    let options = args.view.options(&evaluated.scene);
    if let Some((x, y)) = args.pixel
        && (x >= options.width || y >= options.height)
    {
        let d = Diagnostic::error(format!("the pixel {x},{y} lies outside the picture"));
        let (right, bottom) = (options.width - 1, options.height - 1);
        return Err(Stop::usage(d.note(format!("its columns are 0 to {right}, its rows 0 to {bottom}"))));
    }
    let world = World::build(&evaluated.scene, camera);
    let text = match args.pixel {
        None => {
            let head = heading(&shown_name(&args.scene.file), camera, &options);
            head + &features(&world.features(&evaluated.scene), world.memory_bytes(), &evaluated.sources)
        }
        Some((x, y)) => match render::probe(&world, &options, x, y) {
            None => format!("pixel {x},{y} sees the background\n"),
            Some(probe) => format!("pixel {x},{y} sees {}", seen(&probe, &evaluated)),
        },
    };
    io::stdout().write_all(text.as_bytes())?;
    Ok(Exit::Done)
}

fn heading(name: &str, camera: &Camera, options: &Options) -> String {
    let camera = camera.name.as_ref().map_or(String::new(), |n| format!(", camera `{n}`"));
    let rays = match options.aa.side() {
        1 => "1 ray a pixel".to_string(),
        n => format!("{} rays a pixel", n * n),
    };
    format!("{name}: {}x{}, {rays}{camera}\n", options.width, options.height)
}

/// The features in use with the lines that forced them, then the others.
fn features(all: &[Feature], memory_bytes: usize, sources: &Sources) -> String {
    let width = all.iter().map(|f| f.name.chars().count()).max().unwrap_or(0);
    let mut text = String::new();
    for (title, in_use) in [("Required by this scene", true), ("Not required, so not done", false)] {
        let mut rows = all.iter().filter(|f| f.in_use == in_use).peekable();
        if rows.peek().is_some() {
            let _ = writeln!(text, "\n{title}");
        }
        for f in rows {
            let mut row = format!("  {:<width$}  ", f.name);
            if let Some(place) = &f.required_by {
                let _ = write!(row, "{}: ", sources.location(place.span));
            }
            let _ = writeln!(text, "{}", (row + &f.detail).trim_end());
        }
    }
    let _ = writeln!(text, "\n{:.1} kB held for tracing", memory_bytes as f64 / 1e3);
    text
}

/// What was hit and how it is lit.
fn seen(probe: &Probe, evaluated: &Evaluated) -> String {
    let (scene, sources) = (&evaluated.scene, &evaluated.sources);
    let node = scene.node(probe.node);
    let word = match &node.kind {
        NodeKind::Shape(shape) => shape.word(),
        NodeKind::Light(_) => "light",
        NodeKind::Group(_) | NodeKind::Transformed { .. } => "group",
    };
    let mut text = match &node.name {
        Some(name) => format!("{word} \"{name}\"\n"),
        None => format!("{word}\n"),
    };
    row(&mut text, "made at", &made_at(&node.place, sources));
    for call in node.place.call_chain(sources) {
        row(&mut text, "", &call);
    }
    let material = scene.material(probe.material).place.as_ref();
    row(&mut text, "material", &material.map_or("the default".to_string(), |place| made_at(place, sources)));
    row(&mut text, "color there", &format!("linear({})", list(probe.color)));
    row(&mut text, "point", &format!("[{}]", list(probe.point)));
    row(&mut text, "normal", &format!("[{}]", list(probe.normal)));
    row(&mut text, "distance", &significant(probe.distance));
    if probe.lights.is_empty() {
        row(&mut text, "lights", "none in the scene");
    }
    for (i, (light, share)) in probe.lights.iter().enumerate() {
        let at = sources.location(scene.node(*light).place.span);
        let arrives = match share {
            [r, g, b] if r == g && g == b && *r == 1.0 => "reaches it".to_string(),
            [0.0, 0.0, 0.0] => "doesn't reach it".to_string(),
            share => format!("reaches it with a share of [{}]", list(*share)),
        };
        row(&mut text, if i == 0 { "lights" } else { "" }, &format!("{at} {arrives}"));
    }
    text
}

fn row(text: &mut String, name: &str, value: &str) {
    let _ = writeln!(text, "  {name:<11}  {value}");
}

/// The place and the first line of its text.
fn made_at(place: &Place, sources: &Sources) -> String {
    /// Enough to know the thing again.
    const MOST: usize = 60;
    let code = sources.text(place.span);
    let line = code.lines().next().unwrap_or_default();
    let short: String = line.chars().take(MOST).map(|c| if c.is_control() { ' ' } else { c }).collect();
    let more = if short.len() < code.trim_end().len() { " …" } else { "" };
    format!("{}  {}{more}", sources.location(place.span), short.trim_end())
}

fn list(v: [f64; 3]) -> String {
    v.map(significant).join(", ")
}

/// Six digits, as people read numbers: what is very large or small with its power of ten.
fn significant(x: f64) -> String {
    let x: f64 = format!("{x:.5e}").parse().unwrap_or(x);
    match x.abs() {
        0.0 => "0".to_string(),
        1e-4..1e9 => x.to_string(),
        _ => format!("{x:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diag::{Source, Span};
    use crate::scene::{MaterialId, Node, NodeId, Scene, Shape};

    #[test]
    fn numbers_are_short() {
        let cases = [(0.1 + 0.2, "0.3"), (-0.0, "0"), (123456.789, "123457"), (1e140, "1e140"), (-2.5e-7, "-2.5e-7")];
        for (x, s) in cases {
            assert_eq!(significant(x), s);
        }
    }

    fn scene() -> Evaluated {
        let mut sources = Sources::new();
        let text = "light(at: [1, 2, 3])\nsphere(\n  r: 2)\n";
        let file = sources.add(Source { name: "a.scene".into(), path: None, text: text.into() });
        let mut scene = Scene::empty();
        let mut node = |kind, range, name: Option<&str>| {
            let place = Place::new(Span::new(file, range));
            scene.nodes.push(Node { kind, material: None, name: name.map(Into::into), place });
        };
        let light = crate::scene::Light { at: glam::DVec3::ONE, color: crate::scene::Color::WHITE, power: 1.0 };
        node(NodeKind::Light(light), 0..20, None);
        node(NodeKind::Shape(Shape::Sphere { at: glam::DVec3::ZERO, r: 2.0 }), 21..36, Some("ball"));
        Evaluated {
            scene,
            sources,
            params: Vec::new(),
            warnings: Vec::new(),
            is_library: false,
            files: Vec::new(),
            parse_seconds: 0.0,
            evaluate_seconds: 0.0,
        }
    }

    #[test]
    fn a_pixel() {
        let probe = Probe {
            node: NodeId(1),
            material: MaterialId(0),
            point: [0.0, 0.0, 2.0],
            normal: [0.0, 0.0, 1.0],
            distance: 6.25,
            color: [0.5; 3],
            lights: vec![(NodeId(0), [1.0; 3]), (NodeId(0), [0.0; 3]), (NodeId(0), [0.5, 0.5, 1.0])],
        };
        let expected = "\
sphere \"ball\"
  made at      a.scene:2:1  sphere( …
  material     the default
  color there  linear(0.5, 0.5, 0.5)
  point        [0, 0, 2]
  normal       [0, 0, 1]
  distance     6.25
  lights       a.scene:1:1 reaches it
               a.scene:1:1 doesn't reach it
               a.scene:1:1 reaches it with a share of [0.5, 0.5, 1]
";
        assert_eq!(seen(&probe, &scene()), expected);
    }

    #[test]
    fn features_in_two_lists() {
        let e = scene();
        let feature = |name, place: Option<&Place>, in_use, detail: &str| Feature {
            name,
            required_by: place.cloned(),
            in_use,
            detail: detail.into(),
        };
        let all = [
            feature("reflection", None, false, "no mirrored rays"),
            feature("shadows", Some(&e.scene.nodes[0].place), true, "one ray a light"),
        ];
        let expected = "
Required by this scene
  shadows     a.scene:1:1: one ray a light

Not required, so not done
  reflection  no mirrored rays

2.5 kB held for tracing
";
        assert_eq!(features(&all, 2500, &e.sources), expected);
    }
}
