//! What modules give to those that import them.

use super::{Export, Exports, Resolver};
use crate::diag::Diagnostic;
use crate::lang::ast::*;
use crate::lang::scope::{At, Kind, Level};
use crate::lang::suggest::{did_you_mean, nearest};

impl Resolver {
    pub(super) fn import(&mut self, names: &ImportNames, module: Option<usize>) {
        match names {
            ImportNames::Module(name) => {
                let kind = module.map_or(Kind::Broken, Kind::Module);
                self.bind(name, kind, At::Global(0), true);
            }
            ImportNames::Some(names) => {
                for (there, here) in names {
                    let found = module.map(|m| self.export(m, there));
                    match found {
                        Some(Some(e)) if !e.broken => {
                            let kind = e.function.map_or(Kind::Let, Kind::Function);
                            self.bind(here, kind, At::Global(e.slot), true);
                        }
                        _ => self.bind(here, Kind::Broken, At::Global(0), true),
                    }
                }
            }
        }
    }

    /// What a module exports under a name, or an error.
    pub(super) fn export(&mut self, module: usize, name: &Ident) -> Option<Export> {
        let exports = &self.exports[module];
        if let Some(e) = exports.names.iter().find(|e| e.name == name.name) {
            return Some(e.clone());
        }
        let d = Diagnostic::error(format!("the module exports no `{}`", name.name));
        let d = if exports.private.contains(&name.name) {
            d.at(name.span, "it isn't exported")
                .note(format!("write `export` before it there: `export let {} = …`", name.name))
        } else {
            let best = nearest(&name.name, exports.names.iter().map(|e| e.name.as_str()));
            let d = d.at(name.span, did_you_mean(best));
            match &exports.names[..] {
                [] => d.note("it exports nothing"),
                names => d.note(format!(
                    "it exports: {}",
                    names.iter().map(|e| e.name.as_str()).collect::<Vec<_>>().join(", ")
                )),
            }
        };
        self.errors.push(d);
        None
    }

    pub(super) fn export_quietly(&self, module: usize, name: &str) -> Option<Export> {
        self.exports[module].names.iter().find(|e| e.name == name).cloned()
    }
}

/// What a file exports, and what it keeps.
pub(super) fn exports(statements: &[Statement], level: &Level) -> Exports {
    let bindings = level.blocks.first().map_or(&[][..], |b| &b[..]);
    let mut out = Exports::default();
    for b in bindings {
        let exported = statements.iter().any(|s| match &s.kind {
            StatementKind::Let { name, export, .. } | StatementKind::Fn { name, export, .. } => {
                *export && name.span == b.span
            }
            // It may have been exported; another error about it would only confuse.
            StatementKind::Broken { name: Some(name) } => *name == b.name,
            _ => false,
        });
        let At::Global(slot) = b.at else { continue };
        if exported {
            let function = if let Kind::Function(id) = b.kind { Some(id) } else { None };
            out.names.push(Export { name: b.name.clone(), slot, function, broken: b.kind == Kind::Broken });
        } else {
            out.private.push(b.name.clone());
        }
    }
    out
}
