//! The scene while it is being made: arenas that only grow, and what the settings have said so far.

use super::fault::Fault;
use super::limits::Limits;
use super::value::{Value, number_text};
use super::values::Values;
use crate::diag::{FileId, Place, Span};
use crate::scene::{
    Color, ImageId, Material, MaterialId, Node, NodeId, NodeKind, Pattern, PatternId, PatternKind, Scene, range,
};
use ecow::EcoString;
use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// A scene under construction.
pub struct Build<'c> {
    /// What there is so far.
    pub scene: Scene,
    /// What is known of each pattern, by its id.
    traits: Vec<PatternTraits>,
    constants: HashMap<([u64; 3], bool), PatternId>,
    /// Picture files that patterns name, by image id; opened at the end, and only those that are shown.
    pub pictures: Vec<PictureFile>,
    /// Where each setting was made, to refuse a second one.
    pub settings: Vec<(String, Span)>,
    /// Whether the scene's own default camera has been replaced.
    pub has_camera: bool,
    /// Budgets.
    pub limits: Limits,
    steps: u64,
    cancel: &'c AtomicBool,
}

#[derive(Clone, Copy)]
struct PatternTraits {
    /// Of numbers, not colours.
    number: bool,
    /// Patterns within it, itself included.
    depth: u32,
    /// Patterns that are evaluated for it, itself included.
    size: u64,
    /// The least and the most that any channel of it can be.
    values: Values,
}

/// A picture file as a scene names it.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureFile {
    /// As written.
    pub path: EcoString,
    /// The text that names it; paths start at its folder.
    pub file: FileId,
    /// The `image(…)` expression.
    pub span: Span,
}

impl<'c> Build<'c> {
    /// An empty scene, given up when `cancel` is set.
    pub fn new(limits: Limits, cancel: &'c AtomicBool) -> Build<'c> {
        let scene = Scene::empty();
        let default = scene.materials[0].clone();
        let traits = (0..scene.patterns.len() as u32)
            .map(|i| PatternTraits {
                number: PatternId(i) != default.color,
                depth: 1,
                size: 1,
                values: Values::of_pattern(&scene.patterns[i as usize].kind, |_| Values::UNIT),
            })
            .collect();
        Build {
            scene,
            traits,
            constants: HashMap::new(),
            pictures: Vec::new(),
            settings: Vec::new(),
            has_camera: false,
            limits,
            steps: 0,
            cancel,
        }
    }

    /// Uses up `n` of the budget of steps. Whatever can take long does so again and again, with `n` = 0 where it isn't to
    /// be paid for: here an evaluation is cancelled too.
    #[inline]
    pub fn spend(&mut self, n: u64) -> Result<(), Box<Fault>> {
        self.steps += n;
        if self.steps > self.limits.steps || self.is_cancelled() { Err(self.out_of_steps()) } else { Ok(()) }
    }

    #[cold]
    fn out_of_steps(&self) -> Box<Fault> {
        Fault::budget(
            format!("the scene takes more than {} steps to make", self.limits.steps),
            "a step is a call or a turn of a loop; usually a loop doesn't end, or runs too often",
        )
    }

    /// Whether nobody waits for the scene any more: whatever comes of it is thrown away.
    #[inline]
    pub fn is_cancelled(&self) -> bool {
        self.cancel.load(Relaxed)
    }

    /// Stores a node.
    pub fn node(
        &mut self,
        kind: NodeKind,
        material: Option<MaterialId>,
        name: Option<Box<str>>,
        place: Place,
    ) -> Result<Value, Box<Fault>> {
        self.check_count(self.scene.nodes.len(), "shapes, lights and groups")?;
        self.scene.nodes.push(Node { kind, material, name, place });
        Ok(Value::Node(NodeId(self.scene.nodes.len() as u32 - 1)))
    }

    /// Stores a material.
    pub fn material(&mut self, material: Material) -> Result<Value, Box<Fault>> {
        self.check_count(self.scene.materials.len(), "materials")?;
        self.scene.materials.push(material);
        Ok(Value::Material(MaterialId(self.scene.materials.len() as u32 - 1)))
    }

    /// Stores a pattern; it is one of numbers if all its children are.
    pub fn pattern(&mut self, kind: PatternKind, span: Span) -> Result<Value, Box<Fault>> {
        self.check_count(self.scene.patterns.len(), "patterns")?;
        let number = !matches!(kind, PatternKind::Image { .. });
        let values = Values::of_pattern(&kind, |id| self.values(id));
        let mut traits = PatternTraits { number, depth: 1, size: 1, values };
        for child in kind.children() {
            let child = self.traits[child.0 as usize];
            traits.number &= child.number;
            traits.depth = traits.depth.max(child.depth + 1);
            traits.size = traits.size.saturating_add(child.size);
        }
        let most = self.limits.pattern_depth;
        if traits.depth > most {
            return Err(Fault::new(format!("patterns are nested more than {most} deep"))
                .note("usually a loop that wraps a pattern in itself"));
        }
        let most = self.limits.pattern_size;
        if traits.size > most {
            return Err(Fault::new(format!("this pattern is made of more than {most} patterns"))
                .note("each counts as often as it is used: a pattern of two that are of two is made of seven"));
        }
        let (most, largest) = (values.size(), range::LARGEST);
        if !(most <= largest) {
            return Err(Fault::new(format!("the values of this pattern can reach {}", number_text(most)))
                .note(format!("they are at most {} in size", number_text(largest))));
        }
        self.scene.patterns.push(Pattern { kind, span: Some(span) });
        self.traits.push(traits);
        Ok(Value::Pattern(PatternId(self.scene.patterns.len() as u32 - 1)))
    }

    /// The pattern that is the same colour everywhere; equal ones are stored once.
    pub fn constant(&mut self, color: Color, number: bool) -> PatternId {
        let color = color + Color::BLACK; // -0 is 0
        let key = (color.0.map(f64::to_bits), number);
        if let Some(id) = self.constants.get(&key) {
            return *id;
        }
        self.scene.patterns.push(Pattern::constant(color));
        self.traits.push(PatternTraits { number, depth: 1, size: 1, values: Values::of_color(color) });
        let id = PatternId(self.scene.patterns.len() as u32 - 1);
        self.constants.insert(key, id);
        id
    }

    /// A number, colour or pattern as a pattern.
    pub fn paint(&mut self, value: &Value) -> Option<PatternId> {
        match value {
            Value::Number(n) => Some(self.constant(Color::linear_gray(*n), true)),
            Value::Color(c) => Some(self.constant(*c, false)),
            Value::Pattern(p) => Some(*p),
            _ => None,
        }
    }

    /// A pattern as a value: a constant one as the number or colour that it was made of.
    pub fn unpaint(&self, id: PatternId) -> Value {
        match self.scene.pattern(id).kind {
            PatternKind::Constant(Color([n, ..])) if self.is_number(id) => Value::Number(n),
            PatternKind::Constant(c) => Value::Color(c),
            _ => Value::Pattern(id),
        }
    }

    /// Whether a pattern is of numbers.
    pub fn is_number(&self, id: PatternId) -> bool {
        self.traits[id.0 as usize].number
    }

    /// What the channels of a pattern can be.
    pub fn values(&self, id: PatternId) -> Values {
        self.traits[id.0 as usize].values
    }

    /// The largest size of a channel of a number, colour or pattern; 0 of other values.
    pub fn size_of_channels(&self, value: &Value) -> f64 {
        match value {
            Value::Number(n) => n.abs(),
            Value::Color(c) => Values::of_color(*c).size(),
            Value::Pattern(id) => self.values(*id).size(),
            _ => 0.0,
        }
    }

    /// What a node is, in a word.
    pub fn node_word(&self, mut id: NodeId) -> &'static str {
        loop {
            match &self.scene.node(id).kind {
                NodeKind::Shape(_) => return "shape",
                NodeKind::Light(_) => return "light",
                NodeKind::Group(_) => return "group",
                NodeKind::Transformed { child, .. } => id = *child,
            }
        }
    }

    /// The image that stands for a picture file.
    pub fn image(&mut self, file: PictureFile) -> ImageId {
        let known = self.pictures.iter().position(|p| p.path == file.path && p.file == file.file);
        let index = known.unwrap_or_else(|| {
            self.pictures.push(file);
            self.pictures.len() - 1
        });
        ImageId(index as u32)
    }

    /// The value of a material's slot, by name.
    pub fn slot(&self, id: MaterialId, name: &str) -> Option<Value> {
        let m = self.scene.material(id);
        let pattern = match name {
            "color" => m.color,
            "ambient" => m.ambient,
            "diffuse" => m.diffuse,
            "specular" => m.specular,
            "shininess" => m.shininess,
            "reflect" => m.reflect,
            "transmit" => m.transmit,
            "ior" => return Some(m.ior.map_or(Value::None, Value::Number)),
            "bump" => return Some(m.bump.map_or(Value::None, |p| self.unpaint(p))),
            _ => return None,
        };
        Some(self.unpaint(pattern))
    }

    /// Sets a material's slot to a value that its type has been checked for.
    pub fn set_slot(&mut self, m: &mut Material, name: &str, value: &Value) {
        if name == "ior" {
            m.ior = if let Value::Number(n) = value { Some(*n) } else { None };
            return;
        }
        let paint = self.paint(value);
        if name == "bump" {
            m.bump = paint;
            return;
        }
        let Some(paint) = paint else { return };
        match name {
            "color" => m.color = paint,
            "ambient" => m.ambient = paint,
            "diffuse" => m.diffuse = paint,
            "specular" => m.specular = paint,
            "shininess" => m.shininess = paint,
            "reflect" => m.reflect = paint,
            "transmit" => m.transmit = paint,
            _ => {}
        }
    }

    fn check_count(&self, count: usize, what: &str) -> Result<(), Box<Fault>> {
        let most = self.limits.objects;
        if count < most {
            return Ok(());
        }
        Err(Fault::budget(format!("the scene makes more than {most} {what}"), "usually a loop that runs too often"))
    }
}
