//! `--check`: whether the pictures that are there are those that the scenes make, to the byte. Nothing in the gallery's
//! folder is written; where a picture differs, one that shows how goes into a folder of its own.

use super::crew::{cores, each};
use super::difference::{Panels, alone, compare, is_panels};
use super::link::tidy;
use super::maker::{Made, Maker, Picture};
use super::project::Project;
use super::scene_file::SceneFile;
use super::summary::{Line, Status, Summary, message};
use crate::app::Stop;
use crate::app::args::GalleryArgs;
use crate::app::progress::Bar;
use crate::app::stop::print_diagnostics;
use crate::diag::{Diagnostic, Sources};
use crate::film::OutputFile;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// What was found about one scene: its line, and the message where there is one.
struct Found {
    line: Line,
    message: Option<Stop>,
    difference: Option<Diagnostic>,
}

/// Compares all pictures that are asked for, and says what was found.
///
/// # Errors
/// A picture of differences can't be written, or the run was interrupted.
pub fn check(project: &Project, args: &GalleryArgs, cancel: &AtomicBool) -> Result<Summary, Stop> {
    apart(&args.differences, project)?;
    let asked: Vec<&SceneFile> =
        project.scenes.iter().zip(&project.asked).filter(|(_, a)| **a).map(|(s, _)| s).collect();
    let hands = args.jobs.map_or(cores(), |n| n as usize).min(asked.len());
    let bar = Bar::new(0, args.quiet);
    let maker = Maker { project, threads: (cores() / hands.max(1)).max(1), bar: &bar, cancel, quiet: args.quiet };
    let found = each(&asked, hands, |scene| one(&maker, scene, &args.differences));
    drop(bar);
    if cancel.load(Relaxed) {
        return Err(Stop::system("not every picture was checked", io::ErrorKind::Interrupted.into()));
    }
    let mut lines = Vec::new();
    for found in found {
        let found = found?;
        if let Some(stop) = found.message {
            stop.print();
        }
        print_diagnostics(found.difference.as_slice(), &Sources::new());
        lines.push(found.line);
    }
    if args.only.is_none() {
        lines.extend(extra(project, &lines));
    }
    Ok(Summary {
        folder: project.out.display().to_string(),
        scenes: lines,
        pages: 0,
        removed: Vec::new(),
        seconds: 0.0,
    })
}

fn one(maker: &Maker<'_>, scene: &SceneFile, differences: &Path) -> Result<Found, Stop> {
    let name = &scene.name;
    let line = |status| Found { line: Line::new(name, status), message: None, difference: None };
    let new = match maker.make(scene) {
        Err(stop) => {
            return Ok(Found {
                line: Line::stopped(name, Status::Broken, &stop),
                message: Some(stop),
                difference: None,
            });
        }
        Ok(Made::Library(_)) => return Ok(line(Status::Library)),
        Ok(Made::Nothing) => return Ok(line(Status::Left)),
        Ok(Made::Picture(new)) => new,
    };
    let mut found = line(Status::Same);
    for (file, is) in files(scene, &new) {
        let path = maker.project.shelf.path(&file);
        let panel_path = differences.join(&file);
        let Ok(was) = fs::read(&path) else {
            show(alone(is), &panel_path)?;
            let d = Diagnostic::error(format!("`{}` is missing", path.display()));
            found.difference.get_or_insert(d.note(format!("what the scene makes: {}", panel_path.display())));
            found.line.status = Status::Missing;
            continue;
        };
        let Some((difference, panels)) = compare(&was, is) else {
            forget(&panel_path);
            continue;
        };
        found.line.status = Status::Differs;
        if found.difference.is_none() {
            let shown = show(panels, &panel_path)?;
            found.difference =
                Some(message(&path, &difference, shown.as_ref().map(|s| (panel_path.as_path(), s.as_str()))));
            found.line.panels = shown.map(|_| panel_path.display().to_string());
            found.line.difference = Some((&difference).into());
        } else {
            forget(&panel_path);
        }
    }
    Ok(found)
}

/// The picture files of a scene, the large one first.
fn files<'p>(scene: &SceneFile, new: &'p Picture) -> Vec<(String, &'p [u8])> {
    let mut files = vec![(scene.picture(), new.file.as_slice())];
    files.extend(new.thumbnail.as_deref().map(|t| (scene.thumbnail(), t)));
    files
}

/// Pictures that the gallery made of scenes that are gone or make none any more.
fn extra(project: &Project, lines: &[Line]) -> Vec<Line> {
    let makes_one = |scene: &&SceneFile| lines.iter().any(|l| l.scene == scene.name && l.status != Status::Library);
    let wanted: Vec<String> =
        project.scenes.iter().filter(makes_one).flat_map(|s| [s.picture(), s.thumbnail()]).collect();
    let listed = project.old.files.keys().filter(|name| name.ends_with(".png") && !wanted.contains(name));
    let there: Vec<&String> = listed.filter(|name| !project.shelf.lacks(name)).collect();
    let lines = there.into_iter().map(|name| {
        let d = Diagnostic::error(format!("`{}` is one too many", project.shelf.path(name).display()));
        print_diagnostics(
            &[d.note("no scene makes it any more; `rtdsl gallery` without `--check` removes it")],
            &Sources::new(),
        );
        Line::new(name, Status::Extra)
    });
    lines.collect()
}

/// Writes the panels; their legend.
fn show(panels: Option<Panels>, path: &Path) -> Result<Option<String>, Stop> {
    let Some(panels) = panels else {
        forget(path);
        return Ok(None);
    };
    write(path, &panels.file()?)?;
    Ok(Some(panels.legend))
}

/// Writes panels where there is nothing, or older ones.
fn write(path: &Path, bytes: &[u8]) -> Result<(), Stop> {
    if path.exists()
        && !fs::metadata(path).is_ok_and(|m| m.is_file() && fs::read(path).is_ok_and(|old| is_panels(&old)))
    {
        let d = Diagnostic::error(format!("`{}` isn't a picture of differences", path.display()));
        return Err(Stop::usage(d.note("it would be overwritten: give another folder with `--differences`")));
    }
    let folder = path.parent().map_or(PathBuf::from("."), Path::to_path_buf);
    let written = fs::create_dir_all(folder)
        .and_then(|()| OutputFile::new(path))
        .and_then(|file| file.write(|out| out.write_all(bytes)));
    written.map_err(|e| Stop::system(format!("`{}` can't be written", path.display()), e))
}

/// Whether pictures of differences in `folder` lie apart from what they are about.
fn apart(folder: &Path, project: &Project) -> Result<(), Stop> {
    let folder = real(folder);
    let (what, note) = if folder.starts_with(real(&project.out)) {
        ("among those of the gallery", "give them a folder outside of it with `--differences`")
    } else if folder == project.folder {
        ("among the scenes", "give them a folder of their own with `--differences`")
    } else {
        return Ok(());
    };
    Err(Stop::usage(Diagnostic::error(format!("pictures of differences would lie {what}")).note(note)))
}

/// `path` with links followed as far as it is there.
fn real(path: &Path) -> PathBuf {
    let path = tidy(&std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf()));
    let there = path.ancestors().find_map(|p| Some(p.canonicalize().ok()?.join(path.strip_prefix(p).ok()?)));
    there.unwrap_or(path)
}

/// Removes the panels of an earlier check: they would tell of a difference that is no more.
fn forget(path: &Path) {
    if fs::read(path).is_ok_and(|old| is_panels(&old)) {
        // If it stays, nothing is lost.
        let _ = fs::remove_file(path);
    }
}
