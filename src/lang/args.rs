//! Checked arguments, as the words' functions read them.

use super::value::Value;
use crate::scene::Color;
use glam::DVec3;

/// Checked arguments, read by type. A wrong type can't come here; it reads as a harmless value all the same. -0 reads as 0,
/// so that nothing in a scene depends on a sign that nobody sees: adding 0 takes it away.
pub(super) trait Args {
    /// A number, or an angle in degrees.
    fn number(&self, i: usize) -> f64;
    /// Three numbers.
    fn vec3(&self, i: usize) -> DVec3;
    /// A text, or an empty one.
    fn text(&self, i: usize) -> &str;
    /// Whether it was given, or has a default.
    fn given(&self, i: usize) -> bool;
    /// True.
    fn is_true(&self, i: usize) -> bool;
    /// A number of a list.
    fn item(&self, i: usize, k: u64) -> f64;
    /// A colour.
    fn color(&self, i: usize) -> Color;
    /// A colour, or a number for a grey.
    fn level(&self, i: usize) -> Color;
    /// `N` points, where they were given.
    fn points<const N: usize>(&self, i: usize) -> Option<[DVec3; N]>;
}

impl Args for [Value] {
    fn number(&self, i: usize) -> f64 {
        match self.get(i) {
            Some(Value::Number(n) | Value::Angle(n)) => *n + 0.0,
            _ => 0.0,
        }
    }
    fn vec3(&self, i: usize) -> DVec3 {
        match self.get(i) {
            Some(Value::Vec3(v)) => DVec3::from_array(*v) + 0.0,
            _ => DVec3::ZERO,
        }
    }
    fn text(&self, i: usize) -> &str {
        match self.get(i) {
            Some(Value::Text(t)) => t,
            _ => "",
        }
    }
    fn given(&self, i: usize) -> bool {
        !matches!(self.get(i), None | Some(Value::Unset))
    }
    fn is_true(&self, i: usize) -> bool {
        matches!(self.get(i), Some(Value::Bool(true)))
    }
    fn item(&self, i: usize, k: u64) -> f64 {
        match self.get(i).and_then(|v| v.item(k)) {
            Some(Value::Number(n)) => n + 0.0,
            _ => 0.0,
        }
    }
    fn color(&self, i: usize) -> Color {
        match self.get(i) {
            Some(Value::Color(c)) => *c + Color::BLACK,
            _ => Color::BLACK,
        }
    }
    fn level(&self, i: usize) -> Color {
        match self.get(i) {
            Some(Value::Number(n)) => Color::linear_gray(n + 0.0),
            _ => self.color(i),
        }
    }
    fn points<const N: usize>(&self, i: usize) -> Option<[DVec3; N]> {
        let Some(Value::List(items)) = self.get(i) else { return None };
        let points: Vec<DVec3> = (0..items.len()).map(|k| items.as_slice().vec3(k)).collect();
        points.try_into().ok()
    }
}
