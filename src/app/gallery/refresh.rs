//! Making a gallery: the pictures whose cause changed, then the pages, then the manifest; at last what is left of scenes that
//! are gone is removed. Interrupted anywhere, what is there is whole, and the next run goes on.

use super::crew::{cores, each};
use super::maker::{Made, Maker};
use super::manifest::{Entry, Manifest, digest};
use super::project::Project;
use super::scene_file::SceneFile;
use super::site::Site;
use super::summary::{Line, Status, Summary};
use crate::app::args::GalleryArgs;
use crate::app::progress::Bar;
use crate::app::{Exit, Stop};
use std::collections::BTreeSet;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// What is to be done about a scene.
enum Plan {
    /// Nothing: its picture holds.
    Keep,
    /// Nothing: it wasn't asked for. Whether its picture holds.
    Leave(bool),
    /// Its picture, for this reason.
    Make(String),
}

/// What became of it.
struct Outcome {
    /// For the summary.
    line: Line,
    /// What is known of it from now on.
    entry: Option<Entry>,
    /// Files that belong to it, with digests.
    files: Vec<(String, String)>,
    /// Why it wasn't made.
    stop: Option<Stop>,
}

/// Makes the gallery and says what was done.
///
/// # Errors
/// A page or the manifest can't be written, or the run was interrupted.
pub fn refresh(project: &Project, args: &GalleryArgs, cancel: &AtomicBool) -> Result<Summary, Stop> {
    // What can't be written in the end is found out before anything is rendered.
    project.shelf.hold_manifest()?;
    Site::names(project).try_for_each(|name| project.shelf.claim(&name))?;
    let asked: Vec<(&SceneFile, bool)> = project.scenes.iter().zip(project.asked.iter().copied()).collect();
    let plans = each(&asked, cores(), |(scene, asked)| plan(project, scene, *asked));
    let mut work: Vec<(&SceneFile, &Plan)> = project.scenes.iter().zip(&plans).collect();
    let to_make = plans.iter().filter(|p| matches!(p, Plan::Make(_))).count();
    let hands = args.jobs.map_or(cores(), |n| n as usize).min(to_make.max(1));

    // The longest first, so that no long one is left for the end; those never made might be long.
    let time = |s: &SceneFile| project.entry(s).and_then(|e| e.figures.as_ref()).map_or(u64::MAX, |f| f.times.total());
    work.sort_by_key(|(scene, _)| std::cmp::Reverse(time(scene)));
    let bar = Bar::new(0, args.quiet || to_make == 0);
    let maker = Maker { project, threads: (cores() / hands).max(1), bar: &bar, cancel, quiet: args.quiet };
    let mut results = each(&work, hands, |(scene, plan)| one(&maker, scene, plan));
    drop(bar);
    results.sort_by(|a, b| a.line.scene.cmp(&b.line.scene));

    let mut fresh = Manifest::new(project.old.folder.clone());
    let mut lines = Vec::new();
    for result in results {
        if let Some(stop) = result.stop {
            stop.print();
        }
        fresh.scenes.extend(result.entry.map(|entry| (result.line.scene.clone(), entry)));
        fresh.files.extend(result.files);
        lines.push(result.line);
    }
    if cancel.load(Relaxed) {
        return Err(interrupted(project, fresh));
    }
    let pages = pages(project, &plans, &mut fresh)?;
    let removed = project.shelf.clear(&fresh.files.keys().cloned().collect())?;
    project.shelf.put_manifest(&fresh)?;
    Ok(Summary { folder: project.out.display().to_string(), scenes: lines, pages, removed, seconds: 0.0 })
}

fn plan(project: &Project, scene: &SceneFile, asked: bool) -> Plan {
    let Some(entry) = project.entry(scene) else {
        return if asked { Plan::Make("it is new".into()) } else { Plan::Leave(true) };
    };
    let holds = project.holds(entry);
    if !asked {
        return Plan::Leave(holds);
    }
    if !holds {
        return Plan::Make(project.reason(entry));
    }
    let file_changed = |name: String| (!project.shelf.is_intact(&name)).then_some(name);
    let changed = entry.figures.as_ref().and_then(|f| {
        let thumbnail = f.thumbnail.and_then(|_| file_changed(scene.thumbnail()));
        file_changed(scene.picture()).or(thumbnail)
    });
    match changed {
        Some(name) => Plan::Make(format!("`{name}` is missing or isn't what was made")),
        None if entry.figures.as_ref().is_some_and(|f| f.thumbnail.is_some() && !project.has_thumbnail(scene)) => {
            Plan::Make("another scene took the name of its small picture".into())
        }
        None => Plan::Keep,
    }
}

/// Does what is planned for one scene.
fn one(maker: &Maker<'_>, scene: &SceneFile, plan: &Plan) -> Outcome {
    let project = maker.project;
    let old = project.entry(scene).cloned();
    let reason = match plan {
        Plan::Make(reason) if !maker.cancel.load(Relaxed) => reason,
        Plan::Keep => {
            // It holds, so nothing is wrong with it, whatever was in between.
            let entry = old.map(|e| Entry { broken: None, ..e });
            let library = entry.as_ref().is_some_and(|e| e.figures.is_none());
            return kept(project, scene, if library { Status::Library } else { Status::Unchanged }, entry);
        }
        Plan::Make(_) | Plan::Leave(_) => return kept(project, scene, Status::Left, old),
    };
    match make(maker, scene, reason) {
        Ok(Some(result)) => result,
        Ok(None) => kept(project, scene, Status::Left, old),
        Err((status, stop)) => {
            let broken = (status == Status::Broken).then(|| stop.text());
            let entry = Entry { broken, ..old.unwrap_or_default() };
            let line = Line::stopped(&scene.name, status, &stop);
            Outcome { line, stop: Some(stop), ..kept(project, scene, status, Some(entry)) }
        }
    }
}

/// The result of a scene whose picture stays as it is. A picture that is gone isn't shown any more.
fn kept(project: &Project, scene: &SceneFile, status: Status, entry: Option<Entry>) -> Outcome {
    let lost = |name: &str| project.shelf.lacks(name);
    let entry = entry.map(|mut e| {
        if e.figures.is_some() && lost(&scene.picture()) {
            (e.key, e.figures) = (String::new(), None);
        }
        if let Some(f) = &mut e.figures
            && lost(&scene.thumbnail())
        {
            f.thumbnail = None;
        }
        e
    });
    let figures = entry.as_ref().and_then(|e| e.figures.as_ref());
    let mut names: Vec<String> = figures.iter().map(|_| scene.picture()).collect();
    names.extend(figures.and_then(|f| f.thumbnail).map(|_| scene.thumbnail()));
    let files = names.into_iter().filter_map(|n| project.shelf.listed(&n).cloned().map(|digest| (n, digest)));
    Outcome { line: Line::new(&scene.name, status), files: files.collect(), entry, stop: None }
}

/// Makes one picture and writes it; `None` where the run was interrupted.
fn make(maker: &Maker<'_>, scene: &SceneFile, reason: &str) -> Result<Option<Outcome>, (Status, Stop)> {
    let project = maker.project;
    let failed = |stop| (Status::Failed, stop);
    project.shelf.claim(&scene.picture()).map_err(failed)?;
    // Nothing is wrong with a scene whose picture only needs another place.
    let status = |stop: &Stop| if stop.exit == Exit::Usage { Status::Failed } else { Status::Broken };
    let made = maker.make(scene).map_err(|stop| (status(&stop), stop))?;
    let (used, picture) = match made {
        Made::Nothing => return Ok(None),
        Made::Library(used) => (used, None),
        Made::Picture(p) => (p.used.clone(), Some(p)),
    };
    let key = project.key(used.iter().map(|u| (u.path.as_str(), u.digest.clone())));
    let mut entry = Entry { key, files: used, figures: None, broken: None };
    let mut line = Line::new(&scene.name, Status::Library);
    let mut files = Vec::new();
    if let Some(p) = picture {
        let mut put = |name: String, bytes: &[u8]| -> Result<(), (Status, Stop)> {
            project.shelf.put(&name, bytes).map_err(failed)?;
            files.push((name, digest(bytes)));
            Ok(())
        };
        put(scene.picture(), &p.file)?;
        if let Some(thumbnail) = &p.thumbnail {
            put(scene.thumbnail(), thumbnail)?;
        }
        let mut figures = p.figures;
        let old = project.entry(scene).and_then(|e| e.figures.as_ref());
        if let Some(old) = old.filter(|old| old.image_hash == figures.image_hash && old.rays == figures.rays) {
            figures.times = old.times;
        }
        entry.figures = Some(figures);
        line = Line { status: Status::Made, why: Some(reason.into()), seconds: Some(p.seconds), ..line };
    }
    Ok(Some(Outcome { line, entry: Some(entry), files, stop: None }))
}

/// Writes the pages that changed; how many. Notes them in the manifest.
fn pages(project: &Project, plans: &[Plan], fresh: &mut Manifest) -> Result<usize, Stop> {
    let scenes = project.scenes.iter().zip(plans);
    let changed: BTreeSet<String> =
        scenes.filter(|(_, p)| matches!(p, Plan::Leave(false))).map(|(s, _)| s.name.clone()).collect();
    let site = Site { project, entries: &fresh.scenes, changed: &changed };
    let digest_now = site.digest();
    let is_page = |name: &str| name.ends_with(".html") || name.ends_with(".css");
    let old: Vec<(&String, &String)> = project.old.files.iter().filter(|(name, _)| is_page(name)).collect();
    let intact = || each(&old, cores(), |(name, _)| project.shelf.is_intact(name)).into_iter().all(|x| x);
    let stays = digest_now == project.old.site && intact();
    let mut written = 0;
    if stays {
        fresh.files.extend(old.into_iter().map(|(name, digest)| (name.clone(), digest.clone())));
    } else {
        for (name, bytes) in site.files()? {
            written += usize::from(project.shelf.put(&name, &bytes)?);
            fresh.files.insert(name, digest(&bytes));
        }
    }
    fresh.site = digest_now;
    Ok(written)
}

/// Keeps what was made so far for the next run.
fn interrupted(project: &Project, mut fresh: Manifest) -> Stop {
    for (name, digest) in &project.old.files {
        fresh.files.entry(name.clone()).or_insert_with(|| digest.clone());
    }
    fresh.site.clear();
    match project.shelf.put_manifest(&fresh) {
        Ok(()) => Stop::system("the gallery wasn't finished", io::ErrorKind::Interrupted.into()),
        Err(stop) => stop,
    }
}
