//! Materials as the tracer evaluates them, compiled from the scene: constants folded, and only what a live slot shows.

use super::bounds::smaller;
use super::pattern::PatternTable;
use super::pattern_node::PatternNode;
use super::pattern_point::Rows;
use super::texture::Texture;
use crate::math::Affine;
use crate::scene::range::SHINIEST;
use crate::scene::{ImageId, Material, PatternId, PatternKind, Scene};
use std::collections::HashMap;

/// A slot of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Slot {
    /// The same everywhere.
    Constant([f64; 3]),
    /// A pattern of the world.
    Pattern(u32),
}

impl Slot {
    /// Whether it is 0 everywhere.
    pub fn is_zero(self) -> bool {
        self == Slot::Constant([0.0; 3])
    }
    fn pattern(self) -> Option<u32> {
        match self {
            Slot::Pattern(id) => Some(id),
            Slot::Constant(_) => None,
        }
    }
}

/// A material of the world. Slots that can't show are constant.
#[derive(Clone, Debug, PartialEq)]
pub struct Surfacing {
    /// Base colour.
    pub color: Slot,
    /// Share of ambient light, the scene's ambient light not yet included.
    pub ambient: Slot,
    /// Share of direct light.
    pub diffuse: Slot,
    /// Highlight.
    pub specular: Slot,
    /// Exponent of the highlight.
    pub shininess: Slot,
    /// Mirror image.
    pub reflect: Slot,
    /// What lies behind.
    pub transmit: Slot,
    /// Refractive index.
    pub ior: Option<f64>,
    /// Height field and the step, in units of the space in which the shape is made, by which its slope is taken.
    pub bump: Option<(u32, f64)>,
    /// Whether direct light can show: without it there are no shadow rays.
    pub lit: bool,
    /// Whether any slot is a pattern.
    pub patterned: bool,
    /// Whether any slot shows a picture.
    pub pictured: bool,
    /// The spaces that its patterns stand in.
    pub spaces: Box<[u32]>,
}

impl Surfacing {
    /// Whether it sends mirrored rays.
    pub fn mirrors(&self) -> bool {
        !self.reflect.is_zero() || (self.ior.is_some() && self.lets_through())
    }
    /// Whether rays go through it.
    pub fn lets_through(&self) -> bool {
        !self.transmit.is_zero()
    }
}

/// Most spaces that are composed with each shape's frame; patterns beyond them go map by map. A limit on the work a batch of
/// hits begins with, far above what pictures use.
pub const MOST_SPACES: usize = 256;

/// Compiles materials and the patterns that they need.
pub struct MaterialCompiler<'s> {
    scene: &'s Scene,
    table: PatternTable,
    /// What was compiled already, by pattern and the space it stands in.
    done: HashMap<(PatternId, Space), Slot>,
    textures: HashMap<ImageId, u32>,
    /// Feature sizes of the scene's patterns; empty until a bump asks.
    features: Vec<f64>,
}

/// The space that a pattern stands in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Space {
    /// By number in the table; of a bent space, the last straight one around it.
    straight: u32,
    /// Whether a turbulence lies in between.
    bent: bool,
}

impl<'s> MaterialCompiler<'s> {
    /// Nothing compiled yet.
    pub fn new(scene: &'s Scene) -> Self {
        let table = PatternTable { spaces: vec![Affine::IDENTITY], ..PatternTable::default() };
        MaterialCompiler { scene, table, done: HashMap::new(), textures: HashMap::new(), features: Vec::new() }
    }

    /// The patterns of all materials compiled so far.
    pub fn finish(self) -> PatternTable {
        self.table
    }

    /// Compiles one material. `lights` says whether the scene has any.
    pub fn compile(&mut self, m: &Material, lights: bool) -> Surfacing {
        let black = Slot::Constant([0.0; 3]);
        let mut ambient = self.slot(m.ambient);
        if self.scene.ambient.is_black() {
            ambient = black;
        }
        let (mut diffuse, specular) = match lights {
            true => (self.slot(m.diffuse), self.slot(m.specular)),
            false => (black, black),
        };
        let mut color = black;
        if !(ambient.is_zero() && diffuse.is_zero()) {
            color = self.slot(m.color);
        }
        if color.is_zero() {
            (ambient, diffuse) = (black, black);
        }
        let mut shininess = black;
        if !specular.is_zero() {
            shininess = match self.slot(m.shininess) {
                // Arithmetic may have led a pattern out of what exponents may be.
                Slot::Pattern(p) => self.push(PatternNode::Within(p, 0.0, SHINIEST)),
                constant => constant,
            };
        }
        let (reflect, transmit) = (self.slot(m.reflect), self.slot(m.transmit));
        let lit = !(diffuse.is_zero() && specular.is_zero());
        let ior = m.ior.filter(|_| !transmit.is_zero());
        let tilts_something = lit || !reflect.is_zero() || ior.is_some();
        let bump = m.bump.filter(|_| tilts_something).and_then(|id| match self.slot(id) {
            Slot::Constant(_) => None,
            // A thousandth of the smallest feature: the error of a central difference is then a millionth of its curvature.
            Slot::Pattern(p) => Some((p, self.feature_size(id) / 1024.0)),
        });
        let slots = [color, ambient, diffuse, specular, shininess, reflect, transmit];
        let (spaces, pictured) = self.below(slots.into_iter().chain(bump.map(|b| Slot::Pattern(b.0))));
        Surfacing {
            color,
            ambient,
            diffuse,
            specular,
            shininess,
            reflect,
            transmit,
            ior,
            bump,
            lit,
            patterned: bump.is_some() || slots.into_iter().any(|s| s.pattern().is_some()),
            pictured,
            spaces,
        }
    }

    fn slot(&mut self, id: PatternId) -> Slot {
        self.pattern(id, Space { straight: 0, bent: false })
    }

    fn pattern(&mut self, id: PatternId, space: Space) -> Slot {
        if let Some(&slot) = self.done.get(&(id, space)) {
            return slot;
        }
        let scene = self.scene;
        let slot = self.build(&scene.pattern(id).kind, space);
        self.done.insert((id, space), slot);
        slot
    }

    fn build(&mut self, kind: &PatternKind, space: Space) -> Slot {
        use PatternKind as K;
        let node = match kind {
            K::Constant(c) => return Slot::Constant(c.0),
            K::Checker { a, b, size } => {
                return self.two(*a, *b, space, |a, b| PatternNode::Checker(a, b, *size));
            }
            K::Stripes { a, b, axis, size } => {
                return self.two(*a, *b, space, |a, b| PatternNode::Stripes(a, b, *axis, *size));
            }
            K::Rings { a, b, axis, size } => {
                return self.two(*a, *b, space, |a, b| PatternNode::Rings(a, b, *axis, *size));
            }
            K::Gradient { a, b, axis, size } => {
                return self.two(*a, *b, space, |a, b| PatternNode::Gradient(a, b, *axis, *size));
            }
            K::Noise { a, b, octaves, seed } => {
                return self.two(*a, *b, space, |a, b| PatternNode::Noise(a, b, *octaves, *seed));
            }
            K::Cells { a, b, seed } => {
                return self.two(*a, *b, space, |a, b| PatternNode::Cells(a, b, *seed));
            }
            K::Brick { mortar, brick, size, gap } => {
                return self.two(*mortar, *brick, space, |a, b| PatternNode::Brick(a, b, *size, *gap));
            }
            K::Image { image, mapping, filter } => {
                let texture = self.texture(*image);
                let map = self.table.spaces[space.straight as usize];
                let inverse = map.inverse().unwrap_or(Affine::IDENTITY); // maps of a valid scene can be inverted
                let (turn, back) = (map.linear_f64(), inverse.linear_f64());
                let turn_normal = std::array::from_fn(|r| std::array::from_fn(|c| back[c][r]));
                PatternNode::Image { texture, mapping: *mapping, filter: *filter, turn, turn_normal }
            }
            K::Mix { a, b, by } => match self.pattern(*by, space) {
                Slot::Constant([0.0, 0.0, 0.0]) => return self.pattern(*a, space),
                Slot::Constant([1.0, 1.0, 1.0]) => return self.pattern(*b, space),
                by => {
                    let by = self.node(by);
                    return self.two(*a, *b, space, |a, b| PatternNode::Mix(a, b, by));
                }
            },
            K::Blend { stops, by } => {
                let stops: Vec<Slot> = stops.iter().map(|s| self.pattern(*s, space)).collect();
                if let Slot::Constant(_) = stops[0]
                    && stops.iter().all(|s| *s == stops[0])
                {
                    return stops[0];
                }
                let by = self.pattern(*by, space);
                let stops = stops.into_iter().map(|s| self.node(s)).collect();
                PatternNode::Blend(stops, self.node(by))
            }
            K::Transformed { child, parent_from_child } => {
                let inverse = parent_from_child.inverse().unwrap_or(Affine::IDENTITY);
                return self.transformed(*child, &inverse, space);
            }
            K::Turbulence { child, amount, octaves, seed } => {
                match self.pattern(*child, Space { bent: true, ..space }) {
                    constant @ Slot::Constant(_) => return constant,
                    Slot::Pattern(p) => PatternNode::Turbulence(p, *amount, *octaves, *seed),
                }
            }
            K::Add(a, b) | K::Multiply(a, b) => {
                let sum = matches!(kind, K::Add(..));
                match (self.pattern(*a, space), self.pattern(*b, space)) {
                    (Slot::Constant(x), Slot::Constant(y)) => {
                        let f = |i: usize| if sum { x[i] + y[i] } else { x[i] * y[i] };
                        return Slot::Constant(std::array::from_fn(f));
                    }
                    (a, b) => {
                        let (a, b) = (self.node(a), self.node(b));
                        if sum { PatternNode::Add(a, b) } else { PatternNode::Multiply(a, b) }
                    }
                }
            }
        };
        self.push(node)
    }

    /// A pattern that chooses or mixes between two; constant where both are the same constant.
    fn two(&mut self, a: PatternId, b: PatternId, space: Space, make: impl FnOnce(u32, u32) -> PatternNode) -> Slot {
        let (a, b) = (self.pattern(a, space), self.pattern(b, space));
        if a == b {
            return a; // between a pattern and itself there is nothing to choose
        }
        let node = make(self.node(a), self.node(b));
        self.push(node)
    }

    fn transformed(&mut self, child: PatternId, child_from_parent: &Affine, space: Space) -> Slot {
        let around = self.table.spaces[space.straight as usize];
        let map = child_from_parent.compose(&around);
        let known = self.table.spaces.iter().position(|s| *s == map);
        if !space.bent
            && let Some(straight) = known.or_else(|| self.new_space(map))
        {
            let inner = Space { straight: straight as u32, bent: false };
            return match self.pattern(child, inner) {
                constant @ Slot::Constant(_) => constant,
                Slot::Pattern(p) => self.push(PatternNode::InSpace(p, straight as u32)),
            };
        }
        match self.pattern(child, Space { bent: true, ..space }) {
            constant @ Slot::Constant(_) => constant,
            Slot::Pattern(p) => self.push(PatternNode::Mapped(p, Box::new(rows(child_from_parent)))),
        }
    }

    fn new_space(&mut self, map: Affine) -> Option<usize> {
        let n = self.table.spaces.len();
        (n < MOST_SPACES).then(|| {
            self.table.spaces.push(map);
            n
        })
    }

    fn texture(&mut self, image: ImageId) -> u32 {
        let (scene, table) = (self.scene, &mut self.table);
        *self.textures.entry(image).or_insert_with(|| {
            table.textures.push(Texture::new(&scene.images[image.0 as usize]));
            table.textures.len() as u32 - 1
        })
    }

    /// About how small the smallest feature of a pattern is, in the space around it.
    fn feature_size(&mut self, id: PatternId) -> f64 {
        if self.features.is_empty() {
            for pattern in &self.scene.patterns {
                let size = own_feature_size(&pattern.kind, &self.features);
                self.features.push(size);
            }
        }
        self.features[id.0 as usize]
    }

    /// The spaces that these slots' patterns stand in, and whether any of them shows a picture.
    fn below(&self, roots: impl Iterator<Item = Slot>) -> (Box<[u32]>, bool) {
        let mut seen = vec![false; self.table.nodes.len()];
        let mut waiting: Vec<u32> = roots.filter_map(Slot::pattern).collect();
        let (mut spaces, mut pictured) = (vec![0], false);
        while let Some(id) = waiting.pop() {
            if std::mem::replace(&mut seen[id as usize], true) {
                continue;
            }
            let node = &self.table.nodes[id as usize];
            if let PatternNode::InSpace(_, space) = node {
                spaces.push(*space);
            }
            pictured |= matches!(node, PatternNode::Image { .. });
            node.for_each_child(|c| waiting.push(c));
        }
        spaces.sort_unstable();
        spaces.dedup();
        (spaces.into(), pictured)
    }

    fn node(&mut self, slot: Slot) -> u32 {
        match slot {
            Slot::Constant(c) => match self.push(PatternNode::Constant(c)) {
                Slot::Pattern(p) => p,
                Slot::Constant(_) => 0,
            },
            Slot::Pattern(p) => p,
        }
    }

    fn push(&mut self, node: PatternNode) -> Slot {
        self.table.nodes.push(node);
        Slot::Pattern(self.table.nodes.len() as u32 - 1)
    }
}

/// The rows of a map, rounded.
pub fn rows(map: &Affine) -> Rows {
    let (l, s) = (map.linear_f64(), map.shift_f64());
    Rows::new(std::array::from_fn(|r| [l[r][0], l[r][1], l[r][2], s[r]]))
}

/// About how small the smallest feature of a pattern is, given those of the patterns before it.
fn own_feature_size(kind: &PatternKind, before: &[f64]) -> f64 {
    use PatternKind as K;
    let own = match kind {
        K::Noise { octaves, .. } | K::Turbulence { octaves, .. } => 1.0 / (1u64 << octaves) as f64,
        K::Checker { size, .. } | K::Stripes { size, .. } | K::Rings { size, .. } | K::Gradient { size, .. } => *size,
        K::Brick { gap, size, .. } if *gap == 0.0 => smaller(size[0], size[1]),
        K::Brick { gap, .. } => *gap,
        K::Image { .. } => 1.0 / 64.0, // texels lie closer, but their steps aren't the relief that is meant
        K::Cells { .. } => 1.0,
        _ => f64::INFINITY,
    };
    let inner = kind.children().into_iter().fold(own, |m, c| smaller(before[c.0 as usize], m));
    match kind {
        K::Transformed { parent_from_child, .. } => {
            let rows = parent_from_child.linear_f64();
            let column = |c: usize| (0..3).map(|r| rows[r][c] * rows[r][c]).sum::<f64>().sqrt();
            inner * smaller(column(0), smaller(column(1), column(2)))
        }
        _ => inner,
    }
}
