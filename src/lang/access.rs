//! What a value holds: items, fields, and copies with changes.

use super::catalog;
use super::code::*;
use super::fault::{Fault, Outcome};
use super::machine::{Frame, Machine};
use super::suggest::{did_you_mean, nearest, nearest_property};
use super::value::Value;
use super::word::{described, kind_of};
use crate::diag::Span;
use ecow::EcoString;
use std::sync::Arc;

impl Machine<'_> {
    pub(super) fn index(&mut self, of: &Value, index: &Value, ab: &(Node, Node)) -> Outcome {
        let span = ab.1.span;
        let Some(n) = of.length().filter(|_| matches!(of, Value::List(_) | Value::Vec3(_) | Value::Range(_))) else {
            let got = described(of, &self.build);
            return Err(self.fail(Fault::new(format!("`[…]` takes an item of a list, got {got}")), ab.0.span));
        };
        let Value::Number(i) = index.clone() else {
            let got = described(index, &self.build);
            return Err(self.fail(Fault::new(format!("an index must be a whole number, got {got}")), span));
        };
        if i.fract() != 0.0 {
            let got = described(index, &self.build);
            return Err(self.fail(Fault::new(format!("an index must be a whole number, got {got}")), span));
        }
        if i >= 0.0 && (i as u64) < n {
            return Ok(of.item(i as u64).unwrap_or(Value::None));
        }
        let i = index.show(40);
        let fault = match n {
            0 => Fault::new("the list is empty"),
            _ => {
                let fault = Fault::new(format!("the list has no item {i}"));
                fault.note(format!("its {n} items are numbered from 0 to {}", n - 1))
            }
        };
        Err(self.fail(fault, span))
    }

    pub(super) fn field(&mut self, of: &Value, name: &EcoString, span: Span) -> Outcome {
        let axis = |n: &str| ["x", "y", "z"].iter().position(|a| *a == n);
        let names: Vec<&str> = match of {
            Value::Record(r) => match r.get(name) {
                Some(v) => return self.present(v, span),
                None => r.keys().map(EcoString::as_str).collect(),
            },
            Value::Vec3(_) | Value::List(_) => {
                let item = axis(name).and_then(|i| of.item(i as u64));
                if let Some(v) = item {
                    return Ok(v);
                }
                vec!["x", "y", "z"]
            }
            Value::Color(c) => match ["r", "g", "b"].iter().position(|a| *a == name) {
                Some(i) => return Ok(Value::Number(c.0[i])),
                None => vec!["r", "g", "b"],
            },
            Value::Material(id) => match self.build.slot(*id, name) {
                Some(v) => return Ok(v),
                None => catalog::material_slots().iter().map(|p| p.name).collect(),
            },
            _ => Vec::new(),
        };
        let end = Span { start: span.end - (name.len() as u32).min(span.end), ..span };
        let what = kind_of(of, &self.build);
        let counted = !matches!(of, Value::Record(_)) && of.length().is_some();
        if counted && matches!(name.as_str(), "length" | "len" | "size" | "count") {
            let fault = Fault::new(format!("{what} has no `.{name}`")).label("write `len(…)`");
            return Err(self.fail(fault.note("as in `len([10, 20, 30])`"), end));
        }
        let best = nearest(name, names.iter().copied());
        let fault = Fault::new(format!("{what} has no `.{name}`")).label(did_you_mean(best));
        let fault = if names.is_empty() { fault } else { fault.note(format!("it has: {}", names.join(", "))) };
        Err(self.fail(fault, end))
    }

    pub(super) fn with(&mut self, of: &Node, args: &[ArgCode], span: Span, frame: Frame<'_>) -> Outcome {
        let value = self.eval(of, frame)?;
        match value {
            Value::Record(mut record) => {
                for a in args {
                    let name = a.name.clone().unwrap_or_default();
                    let value = self.eval(&a.value, frame)?;
                    if !record.contains_key(&name) {
                        let best = nearest(&name, record.keys().map(EcoString::as_str));
                        let keys: Vec<&str> = record.keys().map(EcoString::as_str).collect();
                        let fault = Fault::new(format!("the record has no `{name}`"))
                            .label(did_you_mean(best))
                            .note(format!("it has: {}", keys.join(", ")));
                        return Err(self.fail(fault, a.name_span));
                    }
                    self.hold(&value, span)?;
                    Arc::make_mut(&mut record).insert(name, value);
                }
                Ok(Value::Record(record))
            }
            Value::Material(id) => {
                let mut m = self.build.scene.material(id).clone();
                let slots = catalog::material_slots();
                for a in args {
                    let name = a.name.clone().unwrap_or_default();
                    let value = self.eval(&a.value, frame)?;
                    let Some(p) = slots.iter().find(|p| p.name == name) else {
                        let best = nearest_property(&name, slots.iter().map(|p| p.name));
                        let names: Vec<&str> = slots.iter().map(|p| p.name).collect();
                        let fault = Fault::new(format!("a material has no `{name}`"))
                            .label(did_you_mean(best))
                            .note(format!("it has: {}", names.join(", ")));
                        return Err(self.fail(fault, a.name_span));
                    };
                    let absent = matches!(value, Value::None) && p.default == super::word::Default::Absent;
                    if !absent {
                        p.check(&value, &self.build).map_err(|f| self.fail(f, a.value.span))?;
                    }
                    self.build.set_slot(&mut m, &name, &value);
                }
                self.here = span;
                m.place = Some(super::word::Host::place(self));
                self.build.material(m).map_err(|f| self.fail(f, span))
            }
            other => {
                let got = kind_of(&other, &self.build);
                Err(self.fail(Fault::new(format!("`.with` changes a record or a material, got {got}")), of.span))
            }
        }
    }
}
