//! The links of a site, followed as a browser does.

use crate::desk::files_in;
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Links of all pages in a folder that lead nowhere, or out of this machine.
pub fn broken_links(site: &Path) -> Vec<String> {
    let mut broken = Vec::new();
    let mut links = 0;
    for page in files_in(site).into_iter().filter(|p| p.extension().is_some_and(|e| e == "html")) {
        let html = fs::read_to_string(&page).unwrap();
        for attribute in ["href=\"", "src=\""] {
            for (at, _) in html.match_indices(attribute) {
                let link = html[at + attribute.len()..].split('"').next().unwrap();
                let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
                let target = if file.is_empty() { page.clone() } else { page.parent().unwrap().join(decoded(file)) };
                let anchored = |p: &Path| {
                    anchor.is_empty() || fs::read_to_string(p).is_ok_and(|h| h.contains(&format!("id=\"{anchor}\"")))
                };
                let lexical = tidied(&target);
                if link.contains(':') || !lexical.is_file() || !anchored(&lexical) {
                    broken.push(format!("{}: {link}", page.display()));
                }
                links += 1;
            }
        }
    }
    assert!(links > 10, "links were found");
    broken
}

/// As a browser takes `..` back: by the text alone.
fn tidied(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => drop(out.pop()),
            part => out.push(part),
        }
    }
    out
}

fn decoded(link: &str) -> String {
    let mut bytes = Vec::new();
    let mut rest = link.as_bytes();
    while let Some((&b, after)) = rest.split_first() {
        rest = after;
        if b == b'%' {
            bytes.push(u8::from_str_radix(std::str::from_utf8(&after[..2]).unwrap(), 16).unwrap());
            rest = &after[2..];
        } else {
            bytes.push(b);
        }
    }
    String::from_utf8(bytes).unwrap()
}
