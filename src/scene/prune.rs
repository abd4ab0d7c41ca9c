//! What no root leads to is let go of: shapes, materials and patterns that the text makes and doesn't use cost a picture nothing.

use super::{Material, MaterialId, NodeId, NodeKind, PatternId, Scene};

impl Scene {
    /// Lets go of unused nodes, materials and patterns. The others keep their order; the default grey is used always.
    pub fn prune(&mut self) {
        let nodes = self.used_nodes();
        let mut materials = vec![false; self.materials.len()];
        materials.iter_mut().take(1).for_each(|grey| *grey = true);
        for (node, _) in self.nodes.iter().zip(&nodes).filter(|(_, used)| **used) {
            node.material.into_iter().for_each(|id| materials[id.0 as usize] = true);
        }
        let patterns = self.used_patterns(&materials);
        if [&nodes, &materials, &patterns].iter().all(|used| used.iter().all(|u| *u)) {
            return;
        }
        let (node, material, pattern) = (renumbered(&nodes), renumbered(&materials), renumbered(&patterns));
        retain(&mut self.nodes, &nodes);
        retain(&mut self.materials, &materials);
        retain(&mut self.patterns, &patterns);
        self.roots.iter_mut().for_each(|id| *id = NodeId(node[id.0 as usize]));
        for n in &mut self.nodes {
            n.material = n.material.map(|id| MaterialId(material[id.0 as usize]));
            match &mut n.kind {
                NodeKind::Group(children) => children.iter_mut().for_each(|id| *id = NodeId(node[id.0 as usize])),
                NodeKind::Transformed { child, .. } => *child = NodeId(node[child.0 as usize]),
                NodeKind::Shape(_) | NodeKind::Light(_) => {}
            }
        }
        let number = |id: &mut PatternId| *id = PatternId(pattern[id.0 as usize]);
        self.materials.iter_mut().flat_map(slots_mut).for_each(number);
        self.patterns.iter_mut().flat_map(|p| p.kind.children_mut()).for_each(number);
    }

    /// Children have smaller numbers than their parents, so one look at each is enough, from the last to the first.
    fn used_nodes(&self) -> Vec<bool> {
        let mut used = vec![false; self.nodes.len()];
        self.roots.iter().for_each(|id| used[id.0 as usize] = true);
        for (i, node) in self.nodes.iter().enumerate().rev() {
            match &node.kind {
                NodeKind::Group(children) if used[i] => children.iter().for_each(|id| used[id.0 as usize] = true),
                NodeKind::Transformed { child, .. } if used[i] => used[child.0 as usize] = true,
                _ => {}
            }
        }
        used
    }

    /// Likewise with patterns.
    fn used_patterns(&self, materials: &[bool]) -> Vec<bool> {
        let mut used = vec![false; self.patterns.len()];
        for (m, _) in self.materials.iter().zip(materials).filter(|(_, used)| **used) {
            slots(m).for_each(|id| used[id.0 as usize] = true);
        }
        for (i, pattern) in self.patterns.iter().enumerate().rev() {
            if used[i] {
                pattern.kind.children().into_iter().for_each(|id| used[id.0 as usize] = true);
            }
        }
        used
    }
}

/// The patterns of a material.
fn slots(m: &Material) -> impl Iterator<Item = PatternId> {
    [m.color, m.ambient, m.diffuse, m.specular, m.shininess, m.reflect, m.transmit].into_iter().chain(m.bump)
}

fn slots_mut(m: &mut Material) -> impl Iterator<Item = &mut PatternId> {
    let Material { color, ambient, diffuse, specular, shininess, reflect, transmit, bump, .. } = m;
    [color, ambient, diffuse, specular, shininess, reflect, transmit].into_iter().chain(bump)
}

/// New numbers, by the old; those of unused things mean nothing.
fn renumbered(used: &[bool]) -> Vec<u32> {
    let mut next = 0;
    let number = |used: &bool| {
        next += u32::from(*used);
        next.saturating_sub(1)
    };
    used.iter().map(number).collect()
}

fn retain<T>(all: &mut Vec<T>, used: &[bool]) {
    let mut used = used.iter();
    all.retain(|_| used.next().is_some_and(|u| *u));
    all.shrink_to_fit();
}
