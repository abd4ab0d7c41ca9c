//! Where values go that stand alone: into the scene block or list around, or nowhere.

use super::catalog;
use super::code::*;
use super::fault::{Fault, Outcome, Stop};
use super::machine::{Frame, Machine};
use super::value::Value;
use super::word::{described, kind_of};
use crate::diag::Span;
use crate::scene::NodeKind;
use ecow::EcoVec;

impl Machine<'_> {
    pub(super) fn collect(&mut self, items: &[Node], frame: Frame<'_>) -> Outcome {
        self.lists.push(EcoVec::new());
        for n in items {
            self.eval(n, frame)?;
        }
        Ok(Value::list(self.lists.pop().unwrap_or_default()))
    }

    pub(super) fn push(&mut self, value: Value, span: Span) -> Outcome {
        self.step(span)?;
        self.hold(&value, span)?;
        let most = self.limits.list_length;
        let Some(list) = self.lists.last_mut() else { return Ok(Value::None) };
        if list.len() >= most {
            let note = "usually a loop that runs too often";
            return Err(self.fail(Fault::budget(format!("this list has more than {most} values"), note), span));
        }
        list.push(value);
        Ok(Value::None)
    }

    pub(super) fn discard(&mut self, node: &Node, frame: Frame<'_>) -> Outcome {
        let value = self.eval(node, frame)?;
        let fault = match &value {
            Value::None => return Ok(Value::None),
            Value::Node(_) => {
                let what = kind_of(&value, &self.build);
                Fault::new(format!("this makes {what} that isn't added to anything"))
                    .label("did you mean `group { … }`?")
                    .note("a shape outside a scene block is lost: return it, put it in a list, or collect it in a `group { … }`")
            }
            other => Fault::new("this value isn't used").label(format!("it is {}", described(other, &self.build))),
        };
        Err(self.fail(fault, node.span))
    }

    /// Adds shapes and lights, alone or in lists, to the scene block around.
    pub(super) fn emit(&mut self, value: &Value, span: Span) -> Result<(), Stop> {
        match value {
            Value::None => Ok(()),
            Value::Node(id) => {
                self.collected.last_mut().into_iter().for_each(|c| c.push(*id));
                Ok(())
            }
            Value::List(items) if items.iter().all(|v| matches!(v, Value::Node(_) | Value::List(_))) => {
                self.build.spend(items.len() as u64).map_err(|f| self.fail(f, span))?;
                items.iter().try_for_each(|v| self.emit(v, span))
            }
            other => {
                let got = described(other, &self.build);
                let fault = Fault::new("a scene is made of shapes and lights");
                let odd = |v: &&Value| !matches!(v, Value::Node(_) | Value::List(_));
                let fault = match other {
                    Value::List(items) if let Some(v) = items.iter().find(odd) => {
                        fault.label(format!("this is a list with {} in it", described(v, &self.build)))
                    }
                    _ => fault.label(format!("this is {got}")),
                };
                Err(self.fail(
                    match other {
                        Value::Function(_) | Value::Builtin(_) => {
                            fault.note("to call a function, write `( )` after its name")
                        }
                        Value::Material(_) | Value::Pattern(_) => {
                            fault.note("a material goes on a shape: `sphere(mat: …)`")
                        }
                        _ => fault.note("give a value a name with `let`"),
                    },
                    span,
                ))
            }
        }
    }

    pub(super) fn group(&mut self, args: &[(u16, Node)], body: &Node, span: Span, frame: Frame<'_>) -> Outcome {
        let mut values = [Value::Unset, Value::Unset];
        for (i, node) in args {
            values[usize::from(*i).min(1)] = self.eval(node, frame)?;
        }
        if let Some(id) = catalog::find("group") {
            catalog::word(id).check(&mut values, &self.build).map_err(|f| self.locate(f, span, args))?;
        }
        self.collected.push(Vec::new());
        self.eval(body, frame)?;
        let children = self.collected.pop().unwrap_or_default();
        let [material, name] = values;
        let material = if let Value::Material(id) = material { Some(id) } else { None };
        let name = if let Value::Text(t) = name { Some(t.as_str().into()) } else { None };
        self.here = span;
        let place = super::word::Host::place(self);
        self.build.node(NodeKind::Group(children), material, name, place).map_err(|f| self.fail(f, span))
    }
}
