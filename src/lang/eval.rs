//! Evaluates expressions.

use super::ast::Op;
use super::catalog;
use super::code::*;
use super::fault::{Fault, Outcome, Stop};
use super::machine::{Frame, Machine};
use super::ops;
use super::suggest::{did_you_mean, nearest};
use super::value::{Closure, Value};
use super::word::{described, kind_of};
use crate::diag::Span;
use crate::scene::NodeKind;
use ecow::{EcoString, EcoVec};
use std::sync::Arc;

impl<'p> Machine<'p> {
    /// The value of a piece of program.
    pub fn eval(&mut self, node: &'p Node, frame: Frame<'_>) -> Outcome {
        let span = node.span;
        match &node.code {
            Code::Const(v) => Ok(v.clone()),
            Code::Local(i) => self.present(&self.stack[frame.base + *i as usize], span),
            Code::Global(i) => self.present(&self.globals[*i as usize], span),
            Code::Capture(i) => match frame.closure.and_then(|c| c.captures.get(*i as usize)) {
                Some(v) => self.present(v, span),
                None => Err(Stop::Reported),
            },
            Code::Current => frame.closure.map(|c| Value::Function(c.clone())).ok_or(Stop::Reported),
            Code::Failed => Err(Stop::Reported),
            Code::Binary(op, ab) => {
                let a = self.eval(&ab.0, frame)?;
                let b = self.eval(&ab.1, frame)?;
                self.binary(*op, &a, &b, span, ab)
            }
            Code::List(items) => self.list(items, span, frame),
            Code::Block(nodes) => self.block(nodes, frame),
            Code::If { arms, otherwise } => {
                for (condition, body) in arms {
                    if self.condition(condition, frame)? {
                        return self.eval(body, frame);
                    }
                }
                otherwise.as_ref().map_or(Ok(Value::None), |n| self.eval(n, frame))
            }
            Code::SetLocal(slot, value) => {
                let value = self.eval(value, frame)?;
                self.stack[frame.base + *slot as usize] = value;
                Ok(Value::None)
            }
            Code::SetGlobal(slot, value) => {
                let value = self.eval(value, frame)?;
                self.globals[*slot as usize] = value;
                Ok(Value::None)
            }
            Code::CallBuiltin { word, args } => self.call_builtin(*word, args, span, frame),
            Code::Call { function, callee, args } => self.call_known(*function, callee.as_deref(), args, span, frame),
            Code::CallValue { callee, args } => self.call_unknown(callee, args, span, frame),
            Code::For(f) => self.for_(f, frame),
            Code::While(w) => {
                while self.condition(&w.0, frame)? {
                    self.step(span)?;
                    self.eval(&w.1, frame)?;
                }
                Ok(Value::None)
            }
            Code::And(ab) => Ok(Value::Bool(self.condition(&ab.0, frame)? && self.condition(&ab.1, frame)?)),
            Code::Or(ab) => Ok(Value::Bool(self.condition(&ab.0, frame)? || self.condition(&ab.1, frame)?)),
            Code::Not(a) => Ok(Value::Bool(!self.condition(a, frame)?)),
            Code::Negate(a) => {
                let a = self.eval(a, frame)?;
                ops::negate(&a, &mut self.build, span).map_err(|f| self.fail(f, span))
            }
            Code::Index(ab) => {
                let of = self.eval(&ab.0, frame)?;
                let index = self.eval(&ab.1, frame)?;
                self.index(&of, &index, ab)
            }
            Code::Field(of, name) => {
                let value = self.eval(of, frame)?;
                self.field(&value, name, span)
            }
            Code::Closure(function, captures) => {
                let captures: Box<[Value]> = captures.iter().map(|c| self.capture(*c, frame)).collect();
                for v in &captures {
                    self.hold(v, span)?;
                }
                Ok(Value::Function(Arc::new(Closure { function: *function, captures })))
            }
            Code::Discard(value) => self.discard(value, frame),
            Code::Emit(value) => {
                let v = self.eval(value, frame)?;
                self.emit(&v, value.span)?;
                Ok(Value::None)
            }
            Code::Push(value) => {
                let v = self.eval(value, frame)?;
                self.push(v, span)
            }
            Code::Collected(items) => self.collect(items, frame),
            Code::Text(parts) => self.text(parts, span, frame),
            Code::Record(args) => {
                let mut record = super::value::Record::default();
                for a in args {
                    let value = self.eval(&a.value, frame)?;
                    self.hold(&value, span)?;
                    record.insert(a.name.clone().unwrap_or_default(), value);
                }
                Ok(Value::Record(Arc::new(record)))
            }
            Code::Group { args, body } => self.group(args, body, span, frame),
            Code::With(of, args) => self.with(of, args, span, frame),
            Code::Module(slots) => {
                let values = slots.iter().map(|(name, slot)| (name.clone(), self.globals[*slot as usize].clone()));
                Ok(Value::Record(Arc::new(values.collect())))
            }
            Code::Param(p) => self.param(p, frame),
        }
    }

    #[inline]
    fn present(&self, value: &Value, span: Span) -> Outcome {
        if matches!(value, Value::Unset | Value::Poison) {
            return Err(self.missing(value, span));
        }
        Ok(value.clone())
    }

    fn capture(&self, from: CaptureFrom, frame: Frame<'_>) -> Value {
        match from {
            CaptureFrom::Local(i) => self.stack[frame.base + i as usize].clone(),
            CaptureFrom::Capture(i) => {
                frame.closure.and_then(|c| c.captures.get(i as usize)).cloned().unwrap_or(Value::Poison)
            }
            CaptureFrom::Current => frame.closure.map_or(Value::Poison, |c| Value::Function(c.clone())),
        }
    }

    #[inline]
    fn binary(&mut self, op: Op, a: &Value, b: &Value, span: Span, ab: &'p (Node, Node)) -> Outcome {
        if let (Value::Number(x), Value::Number(y)) = (a, b) {
            let fast = match op {
                Op::Add => x + y,
                Op::Subtract => x - y,
                Op::Multiply => x * y,
                Op::Less => return Ok(Value::Bool(x < y)),
                Op::Greater => return Ok(Value::Bool(x > y)),
                _ => f64::NAN,
            };
            if fast.is_finite() {
                return Ok(Value::Number(fast));
            }
        }
        self.spend_on(a, b);
        ops::binary(op, a, b, &mut self.build, span).map_err(|f| {
            let span = if f.argument == Some(1) { ab.1.span } else { span };
            self.fail(f, span)
        })
    }

    /// The value of the last one. What is only added to the scene is independent of what comes after: a mistake in it
    /// doesn't hide theirs.
    fn block(&mut self, nodes: &'p [Node], frame: Frame<'_>) -> Outcome {
        let mut value = Value::None;
        let mut failed = false;
        for n in nodes {
            if let Code::Emit(_) = n.code {
                failed |= self.attempt(n, frame)?.is_none();
            } else {
                value = self.eval(n, frame)?;
            }
        }
        if failed { Err(Stop::Reported) } else { Ok(value) }
    }

    /// Evaluates what others don't depend on: a mistake is reported and the state is as before, so that others are found too.
    /// `None` where there was one.
    pub fn attempt(&mut self, node: &'p Node, frame: Frame<'_>) -> Result<Option<Value>, Stop> {
        let before = (self.stack.len(), self.calls.len(), self.nesting, self.collected.len(), self.lists.len());
        match self.eval(node, frame) {
            Ok(value) => return Ok(Some(value)),
            Err(Stop::Error(d)) if self.errors.len() <= self.limits.errors => self.errors.push(*d),
            Err(Stop::Reported) => {}
            Err(stop) => return Err(stop),
        }
        self.stack.truncate(before.0);
        self.calls.truncate(before.1);
        self.nesting = before.2;
        self.collected.truncate(before.3);
        self.lists.truncate(before.4);
        Ok(None)
    }

    /// Arithmetic on long lists counts as so many steps.
    fn spend_on(&mut self, a: &Value, b: &Value) {
        for v in [a, b] {
            if let Value::List(l) = v {
                self.steps += l.len() as u64 / 4;
            }
        }
    }

    /// Whether a condition holds.
    fn condition(&mut self, node: &'p Node, frame: Frame<'_>) -> Result<bool, Stop> {
        match self.eval(node, frame)? {
            Value::Bool(b) => Ok(b),
            other => {
                let got = described(&other, &self.build);
                let fault = Fault::new(format!("a condition must be true or false, got {got}"));
                let fault = match other {
                    Value::Number(_) => fault.label("compare it with something, as in `n > 0`"),
                    Value::Angle(_) => fault.label("compare it with something, as in `a > 0deg`"),
                    _ => fault,
                };
                Err(self.fail(fault, node.span))
            }
        }
    }

    fn list(&mut self, items: &'p [Node], span: Span, frame: Frame<'_>) -> Outcome {
        if let [x, y, z] = items {
            let (x, y, z) = (self.eval(x, frame)?, self.eval(y, frame)?, self.eval(z, frame)?);
            if let (Value::Number(x), Value::Number(y), Value::Number(z)) = (&x, &y, &z) {
                return Ok(Value::Vec3([*x, *y, *z]));
            }
            for v in [&x, &y, &z] {
                self.hold(v, span)?;
            }
            return Ok(Value::List(EcoVec::from([x, y, z])));
        }
        let mut out = EcoVec::with_capacity(items.len());
        for n in items {
            let v = self.eval(n, frame)?;
            self.hold(&v, span)?;
            out.push(v);
        }
        Ok(Value::List(out))
    }

    fn collect(&mut self, items: &'p [Node], frame: Frame<'_>) -> Outcome {
        self.lists.push(EcoVec::new());
        for n in items {
            self.eval(n, frame)?;
        }
        Ok(Value::list(self.lists.pop().unwrap_or_default()))
    }

    fn push(&mut self, value: Value, span: Span) -> Outcome {
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

    fn for_(&mut self, f: &'p ForCode, frame: Frame<'_>) -> Outcome {
        let over = self.eval(&f.over, frame)?;
        if !matches!(over, Value::Range(_) | Value::List(_) | Value::Vec3(_)) {
            let got = described(&over, &self.build);
            let fault = Fault::new(format!("`for` goes through a list or a range, got {got}"));
            let fault = if let Value::Number(_) = over { fault.label("for a count write `0..n`") } else { fault };
            return Err(self.fail(fault, f.over.span));
        }
        let slot = frame.base + f.slot as usize;
        for i in 0..over.length().unwrap_or(0) {
            self.step(f.over.span)?;
            self.stack[slot] = over.item(i).unwrap_or(Value::None);
            if let Some(guard) = &f.guard
                && !self.condition(guard, frame)?
            {
                continue;
            }
            self.eval(&f.body, frame)?;
        }
        Ok(Value::None)
    }

    fn text(&mut self, parts: &'p [TextCode], span: Span, frame: Frame<'_>) -> Outcome {
        let mut out = EcoString::new();
        let most = self.limits.text_length;
        for p in parts {
            match p {
                TextCode::Literal(s) => out.push_str(s),
                TextCode::Node(n) => out.push_str(&self.eval(n, frame)?.interpolated(most)),
            }
            if out.len() > most {
                let note = "usually a loop that makes a text longer and longer";
                return Err(self.fail(Fault::budget(format!("this text is longer than {most} letters"), note), span));
            }
        }
        self.text_bytes += out.len();
        if self.text_bytes > self.limits.text_total {
            let most = self.limits.text_total;
            let note = "usually a loop that runs too often";
            return Err(
                self.fail(Fault::budget(format!("the scene makes more than {most} letters of text"), note), span)
            );
        }
        Ok(Value::Text(out))
    }

    fn discard(&mut self, node: &'p Node, frame: Frame<'_>) -> Outcome {
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
    fn emit(&mut self, value: &Value, span: Span) -> Result<(), Stop> {
        match value {
            Value::None => Ok(()),
            Value::Node(id) => {
                self.collected.last_mut().into_iter().for_each(|c| c.push(*id));
                Ok(())
            }
            Value::List(items) if items.iter().all(|v| matches!(v, Value::Node(_) | Value::List(_))) => {
                self.steps += items.len() as u64;
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

    fn group(&mut self, args: &'p [(u16, Node)], body: &'p Node, span: Span, frame: Frame<'_>) -> Outcome {
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
        let name = if let Value::Text(t) = name { Some(t.to_string()) } else { None };
        self.here = span;
        let place = super::word::Host::place(self);
        self.build.node(NodeKind::Group(children), material, name, place).map_err(|f| self.fail(f, span))
    }

    fn index(&mut self, of: &Value, index: &Value, ab: &'p (Node, Node)) -> Outcome {
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

    fn field(&mut self, of: &Value, name: &EcoString, span: Span) -> Outcome {
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
        let best = nearest(name, names.iter().copied());
        let fault = Fault::new(format!("{what} has no `.{name}`")).label(did_you_mean(best));
        let fault = if names.is_empty() { fault } else { fault.note(format!("it has: {}", names.join(", "))) };
        Err(self.fail(fault, end))
    }

    fn with(&mut self, of: &'p Node, args: &'p [ArgCode], span: Span, frame: Frame<'_>) -> Outcome {
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
                        let best = super::suggest::nearest_property(&name, slots.iter().map(|p| p.name));
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
