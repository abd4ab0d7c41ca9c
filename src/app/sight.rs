//! What one pixel sees, in words: for `rtdsl explain` and for the pixel inspector of the live page.

use crate::diag::{Place, Sources};
use crate::lang::Evaluated;
use crate::render::Probe;
use crate::scene::NodeKind;
use serde::Serialize;
use std::fmt::Write as _;

/// What was hit and how it is lit, every value ready to be shown; the field names are those of the JSON form.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sight {
    /// The shape's word and its name, as `sphere "ball"`.
    pub what: String,
    /// Where it was made, `file:line:column`, and the first line of that text.
    pub made_at: String,
    /// The calls that led there, innermost first.
    pub calls: Vec<String>,
    /// Where its material was made, in the form of `made_at`.
    pub material: String,
    /// The base colour there, as text of the language.
    pub color: String,
    /// Where the ray meets it, in scene units.
    pub point: String,
    /// The unit normal there, towards the viewer.
    pub normal: String,
    /// Distance from the viewer, in scene units.
    pub distance: String,
    /// Where each light was made, and how much of it arrives.
    pub lights: Vec<String>,
}

impl Sight {
    /// `probe` of a scene in words.
    pub fn new(probe: &Probe, evaluated: &Evaluated) -> Sight {
        let (scene, sources) = (&evaluated.scene, &evaluated.sources);
        let node = scene.node(probe.node);
        let word = match &node.kind {
            NodeKind::Shape(shape) => shape.word(),
            NodeKind::Light(_) => "light",
            NodeKind::Group(_) | NodeKind::Transformed { .. } => "group",
        };
        let light = |(light, share): &(_, [f64; 3])| {
            format!("{} {}", sources.location(scene.node(*light).place.span), arrives(*share))
        };
        let material = scene.material(probe.material).place.as_ref();
        Sight {
            what: node.name.as_ref().map_or(word.to_string(), |name| format!("{word} \"{name}\"")),
            made_at: made_at(&node.place, sources),
            calls: node.place.call_chain(sources),
            material: material.map_or("the default".to_string(), |place| made_at(place, sources)),
            color: format!("linear({})", list(probe.color)),
            point: format!("[{}]", list(probe.point)),
            normal: format!("[{}]", list(probe.normal)),
            distance: significant(probe.distance),
            lights: probe.lights.iter().map(light).collect(),
        }
    }

    /// A line a value, what was hit first.
    pub fn text(&self) -> String {
        let mut text = format!("{}\n", self.what);
        let mut row = |name: &str, value: &str| {
            let _ = writeln!(text, "  {name:<11}  {value}");
        };
        row("made at", &self.made_at);
        self.calls.iter().for_each(|call| row("", call));
        row("material", &self.material);
        row("color there", &self.color);
        row("point", &self.point);
        row("normal", &self.normal);
        row("distance", &self.distance);
        if self.lights.is_empty() {
            row("lights", "none in the scene");
        }
        for (i, light) in self.lights.iter().enumerate() {
            row(if i == 0 { "lights" } else { "" }, light);
        }
        text
    }
}

fn arrives(share: [f64; 3]) -> String {
    match share {
        [1.0, 1.0, 1.0] => "reaches it".to_string(),
        [0.0, 0.0, 0.0] => "doesn't reach it".to_string(),
        share => format!("reaches it with a share of [{}]", list(share)),
    }
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
    use crate::scene::{Light, MaterialId, Node, NodeId, Scene, Shape};

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
        let light = Light { at: glam::DVec3::ONE, color: crate::scene::Color::WHITE, power: 1.0 };
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
        let mut probe = Probe {
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
        let evaluated = scene();
        assert_eq!(Sight::new(&probe, &evaluated).text(), expected);
        probe.lights.clear();
        let dark = Sight::new(&probe, &evaluated).text();
        assert!(dark.ends_with("  lights       none in the scene\n"), "{dark}");
    }
}
