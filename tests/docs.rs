//! The documentation, checked against the program: its samples run, what they say comes out comes out, its messages are
//! the program's, and the generated parts of the reference are up to date.
//!
//! `RTDSL_BLESS=1 cargo test --test docs` writes the generated parts and the messages anew.

use rtdsl::diag::{Look, print};
use rtdsl::lang::{self, Evaluated, Failure, Input, Request};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Held while a test reads and perhaps rewrites the documents.
static DOCUMENTS: Mutex<()> = Mutex::new(());

/// A fenced block: what stands after the opening fence, its lines' byte range, and the line on which it starts.
struct Fence {
    info: String,
    start: usize,
    end: usize,
    line: usize,
}

fn fences(text: &str) -> Vec<Fence> {
    let (mut out, mut open, mut at) = (Vec::new(), None, 0);
    for (i, line) in text.split_inclusive('\n').enumerate() {
        if let Some(info) = line.strip_prefix("```") {
            match open.take() {
                None => open = Some((info.trim().to_owned(), at + line.len(), i + 2)),
                Some((info, start, line)) => out.push(Fence { info, start, end: at, line }),
            }
        }
        at += line.len();
    }
    assert!(open.is_none(), "a fence isn't closed");
    out
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn is_blessing() -> bool {
    std::env::var_os("RTDSL_BLESS").is_some()
}

/// The README and everything in `docs`.
fn documents() -> Vec<PathBuf> {
    let mut out: Vec<PathBuf> = Some(root().join("README.md")).into_iter().filter(|p| p.exists()).collect();
    let mut folders = vec![root().join("docs")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "md") {
                out.push(path);
            }
        }
    }
    out
}

/// Samples stand in the folder of the examples, whose pictures and modules they use.
fn evaluate(text: &str) -> Result<Evaluated, Failure> {
    let main =
        Input::Text { name: "try.scene".into(), bytes: text.as_bytes().to_vec(), folder: root().join("examples") };
    lang::evaluate(&Request { main, set: Vec::new(), allow_read: Vec::new(), record_arguments: false })
}

/// `let name = … // → value`: names and values.
fn promises(text: &str) -> Vec<(&str, &str)> {
    let promise = |line| {
        let (left, value): (&str, &str) = str::split_once(line, "// →")?;
        let name = left.strip_prefix("let ")?.split_once(" =")?.0;
        Some((name, value.trim()))
    };
    let found: Vec<_> = text.lines().filter_map(promise).collect();
    assert_eq!(found.len(), text.matches("// →").count(), "a value is promised by `let name = … // → value`:\n{text}");
    found
}

/// Runs a sample that must be right; what is wrong otherwise.
fn run(text: &str) -> Result<(), String> {
    let promises = promises(text);
    let mut checked = text.to_owned();
    for (name, _) in &promises {
        checked += &format!("\nparam __{name}: \"{{{name}}}\"");
    }
    let found = evaluate(&checked).map_err(|f| print(&f.diagnostics, &f.sources, Look::Plain))?;
    for (name, value) in promises {
        let param = found.params.iter().find(|p| p.name == format!("__{name}"));
        let is = param.map_or("", |p| p.value.as_str()).trim_matches('"');
        if is != value.trim_matches('"') {
            return Err(format!("`{name}` is {is}, not {value}"));
        }
    }
    Ok(())
}

#[test]
fn every_sample_runs_and_every_message_is_the_program_s() {
    let _alone = DOCUMENTS.lock();
    let mut wrong = Vec::new();
    let mut samples = 0;
    for path in documents() {
        let mut text = fs::read_to_string(&path).unwrap();
        let all = fences(&text);
        let mut blessed = Vec::new();
        for (i, fence) in all.iter().enumerate() {
            let place = format!("{}:{}", path.display(), fence.line);
            let sample = &text[fence.start..fence.end];
            match fence.info.as_str() {
                "scene" => samples += 1,
                // A text that is shown as the content of a file.
                info if info.starts_with("scene ") => {
                    let file = info.trim_start_matches("scene ").trim();
                    if fs::read_to_string(root().join(file)).ok().as_deref() != Some(sample) {
                        wrong.push(format!("{place}: this isn't what {file} holds"));
                    }
                    continue;
                }
                info if info.contains("scene") => {
                    wrong.push(format!("{place}: `{info}` is neither `scene` nor `scene FILE`"));
                    continue;
                }
                _ => continue,
            }
            let message = all.get(i + 1).filter(|f| f.info == "text" && text[f.start..].starts_with("error"));
            match (message, evaluate(sample)) {
                (None, _) => {
                    if let Err(why) = run(sample) {
                        wrong.push(format!("{place}: {why}"));
                    }
                }
                (Some(_), Ok(_)) => wrong.push(format!("{place}: this sample should be wrong and isn't")),
                (Some(f), Err(failure)) => {
                    let is = print(&failure.diagnostics, &failure.sources, Look::Plain);
                    if is.trim_end() != text[f.start..f.end].trim_end() {
                        blessed.push((f.start, f.end, format!("{}\n", is.trim_end())));
                        if !is_blessing() {
                            wrong.push(format!("{place}: the message is\n{is}"));
                        }
                    }
                }
            }
        }
        if is_blessing() && !blessed.is_empty() {
            for (start, end, message) in blessed.into_iter().rev() {
                text.replace_range(start..end, &message);
            }
            fs::write(&path, text).unwrap();
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
    assert!(samples > 100, "{samples}");
}

/// `text` with what stands between `<!-- chapter: TITLE -->` and `<!-- end -->` replaced by those chapters, and the titles.
fn generated(text: &str) -> (String, Vec<String>) {
    let (mut out, mut titles, mut rest) = (String::new(), Vec::new(), text);
    while let Some((before, after)) = rest.split_once("<!-- chapter: ") {
        let (title, after) = after.split_once(" -->\n").expect("the marker's end");
        let (_, after) = after.split_once("<!-- end -->").expect("the chapter's end");
        let chapter = lang::chapter(title).unwrap_or_else(|| panic!("there is no chapter `{title}`"));
        out += &format!("{before}<!-- chapter: {title} -->\n\n{}\n\n<!-- end -->", chapter.trim_end());
        titles.push(title.to_owned());
        rest = after;
    }
    (out + rest, titles)
}

#[test]
fn the_reference_is_up_to_date() {
    let _alone = DOCUMENTS.lock();
    let path = root().join("docs/language.md");
    let text = fs::read_to_string(&path).unwrap();
    let (fresh, titles) = generated(&text);
    if is_blessing() {
        fs::write(&path, &fresh).unwrap();
    }
    let mut expected: Vec<&str> = lang::chapters();
    let mut found: Vec<&str> = titles.iter().map(String::as_str).collect();
    expected.sort_unstable();
    found.sort_unstable();
    assert_eq!(found, expected, "every chapter stands in the reference once");
    assert!(is_blessing() || fresh == text, "docs/language.md is stale: RTDSL_BLESS=1 cargo test --test docs");
}

#[test]
fn links_lead_somewhere() {
    for path in documents() {
        let text = fs::read_to_string(&path).unwrap();
        let folder = path.parent().unwrap_or(Path::new(""));
        for (i, _) in text.match_indices("](") {
            let target = text[i + 2..].split(')').next().unwrap_or("");
            let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
            if target.starts_with("http") || target.contains(char::is_whitespace) {
                continue;
            }
            let other = if file.is_empty() { path.clone() } else { folder.join(file) };
            assert!(other.exists(), "{}: `{target}` doesn't exist", path.display());
            let heading = |l: &str| l.trim_start_matches('#').trim().to_lowercase().replace(' ', "-");
            let there = || fs::read_to_string(&other).unwrap_or_default();
            let found = anchor.is_empty() || there().lines().any(|l| l.starts_with('#') && heading(l) == anchor);
            assert!(found, "{}: `{target}` has no such heading", path.display());
        }
    }
}
