//! From text to scene: grammar, evaluation, vocabulary, and the messages when something is wrong.
//!
//! The way of a text: `load` reads files and has them `parse`d, statement by statement, into the `ast`; `resolve` turns
//! names into slots and makes the `code` that `eval` runs; [`catalog`] is the vocabulary; `build` holds the scene
//! meanwhile; `finish` takes the last look. Mistakes of all phases come out together, in the order of the text.

mod access;
mod args;
mod ast;
mod build;
mod call;
pub mod catalog;
mod code;
mod collect;
mod eval;
mod expected;
mod fault;
mod finish;
mod flow;
mod formula;
pub mod highlight;
mod limits;
mod load;
mod machine;
mod measure;
mod memory;
mod mesh;
mod operation;
mod ops;
mod param;
mod parse;
mod picture;
mod property;
mod reference;
mod repeat;
pub mod request;
mod resolve;
mod running;
mod scalar;
mod scan;
mod scope;
mod suggest;
mod syntax;
#[cfg(test)]
mod tests;
mod ty;
mod value;
mod values;
pub mod word;

pub use highlight::{Token, TokenClass, highlight};
pub use memory::Memory;
pub use picture::FILE_BYTES as LARGEST_FILE;
pub use reference::{chapter, chapter_topics, chapters, help, parameters, topics};
pub use request::{Dependency, Evaluated, Failure, Input, Param, ParamKind, Request};

use crate::diag::{Diagnostic, Diagnostics, FileId, Source, Sources, Span};
use ast::StatementKind;
use build::Build;
use code::Node;
use limits::Limits;
use load::Loader;
use machine::{Machine, SetValue};
use memory::{Done, Store};
use resolve::Resolver;
use running::Running;
use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Instant;
use value::Value;

/// Reads, evaluates and checks a scene. Every independent mistake is reported; nothing is written and nothing is printed.
pub fn evaluate(request: &Request) -> Result<Evaluated, Failure> {
    evaluate_within(request, Limits::default())
}

/// As [`evaluate`], with what earlier evaluations left in `memory`. `None`, within some milliseconds, where `cancel` is set
/// meanwhile.
pub fn evaluate_again(
    request: &Request,
    memory: &mut Memory,
    cancel: &AtomicBool,
) -> Option<Result<Evaluated, Failure>> {
    // Two at once would need the space of two, and many cancelled one after the other more and more.
    if let Some(left) = memory.left.take() {
        match left.wait(cancel) {
            Ok((_, store)) => memory.store = store,
            Err(left) => {
                memory.left = Some(left);
                return None;
            }
        }
    }
    let running = match start(request, Limits::default(), std::mem::take(&mut memory.store)) {
        Ok(running) => running,
        Err(failure) => return Some(Err(failure)),
    };
    match running.wait(cancel) {
        Ok((result, store)) => {
            memory.store = store;
            Some(result)
        }
        Err(left) => {
            memory.left = Some(left);
            None
        }
    }
}

fn evaluate_within(request: &Request, limits: Limits) -> Result<Evaluated, Failure> {
    start(request, limits, Store::default())?.join().0
}

/// Evaluates on a thread of its own.
fn start(request: &Request, limits: Limits, mut store: Store) -> Result<Running<Done>, Failure> {
    let request = request.clone();
    let work = move |cancel: &AtomicBool| {
        let mut result = run(&request, limits, &mut store, cancel);
        if cancel.load(Relaxed) {
            result = Err(nothing("cancelled"));
        }
        store.end(result.is_ok());
        (result, store)
    };
    Running::start(work).map_err(|e| nothing(&format!("can't start evaluating: {}", load::reason(&e))))
}

/// A failure before anything was read.
fn nothing(why: &str) -> Failure {
    let diagnostics = vec![Diagnostic::error(why)];
    Failure { diagnostics, sources: Sources::new(), files: Vec::new(), main_unreadable: true }
}

/// Whatever it gives where `cancel` is set meanwhile, it isn't to be shown.
fn run(request: &Request, limits: Limits, store: &mut Store, cancel: &AtomicBool) -> Result<Evaluated, Failure> {
    let start = Instant::now();
    let (mut loader, read) = Loader::load(request, limits, store, cancel);
    if let Err(d) = read {
        return Err(Failure {
            diagnostics: vec![d],
            sources: loader.sources,
            files: loader.files,
            main_unreadable: true,
        });
    }
    let mut errors = std::mem::take(&mut loader.errors);
    let main = loader.modules.last().map_or(FileId(0), |m| m.file);
    if errors.is_empty() && loader.modules.last().is_some_and(|m| m.parsed.statements.is_empty()) {
        let d = Diagnostic::error("the scene is empty").at(Span::new(main, 0..0), "");
        errors.push(d.note("a scene needs something to show: `sphere()`"));
    }

    let mut resolver = Resolver::default();
    let last = loader.modules.len().saturating_sub(1);
    for (i, m) in loader.modules.iter().enumerate() {
        resolver.file(m, &loader.sources.get(m.file).text, i == last, cancel);
    }
    let nodes = set_nodes(request, &mut loader.sources, &mut resolver);
    errors.append(&mut resolver.errors);
    errors.extend(unknown_params(&loader, &nodes));
    let parse_seconds = start.elapsed().as_secs_f64();

    let start = Instant::now();
    let program = resolver.program;
    let set = nodes
        .iter()
        .map(|(name, raw, span, node)| {
            let node = node.as_ref().map_err(Diagnostic::clone);
            (name.clone(), SetValue { raw: raw.clone(), span: *span, node })
        })
        .collect::<HashMap<_, _>>();
    let mut build = Build::new(limits, cancel);
    // Most of the statements that are like others make a node each, and room that grows step by step leaves holes as large.
    let likes = loader.modules.iter().map(|m| m.parsed.likes.len()).sum::<usize>();
    build.scene.nodes.reserve(likes.min(limits.objects));
    let mut machine = Machine {
        program: &program,
        build,
        limits,
        globals: vec![Value::Unset; program.globals as usize],
        stack: Vec::new(),
        calls: Vec::new(),
        nesting: 0,
        other: Ok(Value::None),
        collected: Vec::new(),
        lists: Vec::new(),
        text_bytes: 0,
        containers: 0,
        here: Span::new(main, 0..0),
        argument: Span::new(main, 0..0),
        set,
        params: Vec::new(),
        record_arguments: request.record_arguments,
        errors: Vec::new(),
        sources: &loader.sources,
    };
    for (i, m) in program.modules.iter().enumerate() {
        if !machine.run(m, i == last) {
            break;
        }
    }
    let Machine { build: Build { mut scene, pictures, mesh_files, .. }, params, errors: failed, .. } = machine;
    errors.extend(failed);
    if errors.is_empty() {
        errors = finish::finish(&mut scene, (&pictures, &mesh_files), &mut loader);
    }
    let exports = resolver.exports.last().is_some_and(|e| !e.names.is_empty());
    let Loader { sources, files, .. } = loader;
    if !errors.is_empty() {
        return Err(Failure { diagnostics: in_order(errors, limits.errors), sources, files, main_unreadable: false });
    }
    let mut warnings = Vec::new();
    let is_empty = scene.is_empty();
    let is_library = is_empty && exports;
    if is_empty {
        let d = Diagnostic::warning("there is nothing to show").at(Span::new(main, 0..0), "");
        warnings.push(match is_library {
            true => d.note("this file only exports: import it from a scene"),
            false => d.note("the scene has no shapes: add one, such as `sphere()`"),
        });
    }
    scene.prune();
    let evaluate_seconds = start.elapsed().as_secs_f64();
    Ok(Evaluated { scene, sources, params, warnings, is_library, files, parse_seconds, evaluate_seconds })
}

type SetNode = (String, String, Span, Result<Node, Diagnostic>);

/// The values of `--set` as expressions, each in a text of its own.
fn set_nodes(request: &Request, sources: &mut Sources, resolver: &mut Resolver) -> Vec<SetNode> {
    let mut out: Vec<SetNode> = Vec::new();
    for (name, raw) in &request.set {
        let text = format!("{name}={raw}");
        let value = name.len() + 1..text.len();
        // The name is blanked, not cut off, so that places are those in the whole.
        let blanked = format!("{:1$}{raw}", "", value.start);
        let file = sources.add(Source { name: "--set".into(), path: None, text });
        let span = Span::new(file, value);
        let before = resolver.errors.len();
        let node = parse::parse_expression(file, &blanked).map(|e| resolver.lone_expression(&e));
        // An unknown word is a mistake only where the parameter doesn't take any text.
        let node = match resolver.errors.drain(before..).next() {
            Some(d) => Err(d),
            None => node,
        };
        out.retain(|(n, ..)| n != name); // the last one wins, as on every command line
        out.push((name.clone(), raw.clone(), span, node));
    }
    out
}

fn unknown_params(loader: &Loader, nodes: &[SetNode]) -> Diagnostics {
    let declared: Vec<&str> = loader
        .modules
        .last()
        .into_iter()
        .flat_map(|m| &m.parsed.statements)
        .filter_map(|s| match &s.kind {
            StatementKind::Param(p) => Some(p.name.name.as_str()),
            StatementKind::Broken { name: Some(name) } => Some(name.as_str()),
            _ => None,
        })
        .collect();
    let unknown = nodes.iter().filter(|(name, ..)| !declared.contains(&name.as_str()));
    unknown
        .map(|(name, _, span, _)| {
            let best = suggest::nearest(name, declared.iter().copied());
            let here = Span { start: 0, end: name.len() as u32, ..*span };
            let d =
                Diagnostic::error(format!("the scene has no parameter `{name}`")).at(here, suggest::did_you_mean(best));
            match &declared[..] {
                [] => d.note("it has no parameters"),
                some => d.note(format!("its parameters: {}", some.join(", "))),
            }
        })
        .collect()
}

/// In the order of the texts, without repetitions; at most `most`.
fn in_order(mut errors: Diagnostics, most: usize) -> Diagnostics {
    errors.sort_by_key(|d| d.span().map_or((FileId(0), 0), |s| (s.file, s.start)));
    errors.dedup_by(|a, b| a.message == b.message && a.span() == b.span());
    if errors.len() > most {
        errors.truncate(most);
        errors.push(Diagnostic::error(format!("there are more mistakes; these are the first {most}")));
    }
    errors
}
