//! What the painter puts on the live page, where there is one: coarse pictures first, then the picture tile by tile, then the
//! finished one; messages and figures.

use super::canvas::Canvas;
use super::desk::Leash;
use super::encoder::encode;
use super::teller::{Finished, time_of_day};
use crate::app::preview::board::{Message, Report};
use crate::app::preview::{Board, Level, Picture, Posted, Shown};
use crate::app::words;
use crate::diag::{self, Diagnostic, Look, Severity, Sources};
use crate::film::{self, Film, Format, Recipe};
use crate::lang::Evaluated;
use crate::render::{Options, Plan, Silent, World, render};
use crate::scene::AntiAliasing;
use std::io::Cursor;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The live page, if there is one.
#[derive(Clone)]
pub struct Show {
    board: Option<Arc<Board>>,
}

/// What came of the wish to see something soon.
pub enum Coarse {
    /// A coarse picture.
    Shown(Arc<Film>),
    /// Nobody is looking, or the whole picture will be there as soon.
    NotNeeded,
}

/// The form of pictures on pages.
const PNG: Format = Format::PNG;

/// Pixels of a coarse picture's side stand for so many of the full one's: it costs a sixteenth.
const COARSE: u32 = 4;

/// Up to one tile in so many is few: they take about twice as long as a coarse picture.
const FEW: usize = 8;

/// Side of the grid of rays from which on a full-size picture of one ray a pixel comes second: it costs a sixteenth at most.
const FINE_GRID: u32 = 4;

/// How often pages see how far the picture has come: smooth to the eye, and the encoding hardly costs.
const PARTIAL_EVERY: Duration = Duration::from_millis(150);

impl Show {
    /// On `board`, or nowhere.
    pub fn new(board: Option<Arc<Board>>) -> Show {
        Show { board }
    }

    /// Whether there is a page.
    pub fn is_on(&self) -> bool {
        self.board.is_some()
    }

    /// Work on text number `text` begins.
    pub fn begin(&self, text: u64) {
        self.post(|p| (p.text, p.busy, p.progress) = (text, true, 0.0));
    }

    /// The newest text is a scene, with these values given to parameters.
    pub fn evaluated(&self, e: &Evaluated, set: &[(String, String)]) {
        self.post(|p| {
            p.messages = messages(&e.warnings, &e.sources);
            p.params = e.params.iter().map(Into::into).collect();
            p.set_line = set_line(set);
        });
    }

    /// The newest text is none.
    pub fn failed(&self, diagnostics: &[Diagnostic], sources: &Sources) {
        self.post(|p| {
            p.messages = messages(diagnostics, sources);
            p.busy = false;
        });
    }

    /// Shows a coarse picture, where that is sooner than the final one.
    pub fn coarse(&self, world: &World, text: u64, options: &Options, plan: &Plan, leash: &Arc<Leash>) -> Coarse {
        // Where few tiles are traced anew, the picture before with those in it is there as soon.
        if !self.is_on() || plan.traced() * FEW < plan.tiles() {
            return Coarse::NotNeeded;
        }
        let (width, height) = (options.width, options.height);
        let one_ray = Options { aa: AntiAliasing::Off, ..options.clone() };
        let small = Options { width: width.div_ceil(COARSE), height: height.div_ceil(COARSE), ..one_ray.clone() };
        let steps = [Some(small), (options.aa.side() >= FINE_GRID).then_some(one_ray)];
        let mut last = None;
        for step in steps.into_iter().flatten() {
            let Some(rendered) = render(world, &step, &Silent, leash.cancel()) else { break };
            let film = Arc::new(rendered.film);
            // Into memory it can't fail: a film has pixels.
            let Some(Ok(file)) = encode(&film, PNG, &Recipe::new(), leash) else { break };
            self.picture(file, Level::Coarse, (width, height), text, 0.0, leash);
            last = Some(film);
        }
        last.map_or(Coarse::NotNeeded, Coarse::Shown)
    }

    /// Shows every now and then how far `canvas` has come, over what was there `before`, until it ends.
    ///
    /// On a thread that nobody waits for: a picture that is just being encoded mustn't hold up the work on a newer text. What
    /// it shows too late isn't shown.
    pub fn follow(
        &self,
        canvas: &Arc<Canvas>,
        before: impl FnOnce() -> Film + Send + 'static,
        text: u64,
        leash: &Arc<Leash>,
    ) {
        if !self.is_on() {
            return;
        }
        let (show, canvas, leash) = (self.clone(), Arc::clone(canvas), Arc::clone(leash));
        std::thread::spawn(move || {
            let mut film = None;
            let mut before = Some(before);
            let mut pause = PARTIAL_EVERY;
            while !canvas.ends_within(pause) && leash.since_cancelled().is_none() {
                let start = Instant::now();
                let Some(film) = film.get_or_insert_with(|| before.take().map(|b| b())) else { return };
                canvas.copy_to(film);
                let mut file = Cursor::new(Vec::new());
                if film::encode(film, PNG, &Recipe::new(), &mut file).is_ok() {
                    let size = (film.width, film.height);
                    show.picture(file.into_inner(), Level::Partial, size, text, canvas.progress(), &leash);
                }
                // A tenth of one core at most, however large the picture.
                pause = PARTIAL_EVERY.max(start.elapsed() * 10);
            }
        });
    }

    /// The finished picture's file, and what it shows.
    pub fn finished(&self, file: &[u8], (text, e, world, options): (u64, &Arc<Evaluated>, &Arc<World>, &Options)) {
        let Some(board) = &self.board else { return };
        let id = board.keep_picture(file.to_vec());
        let shown = Shown { picture: id, evaluated: Arc::clone(e), world: Arc::clone(world), options: options.clone() };
        board.show(shown);
        self.post(|p| {
            put(p, id, Level::Final, (options.width, options.height), text, 1.0);
            p.busy = p.text != text && p.messages.is_empty();
        });
    }

    /// What it took.
    pub fn report(&self, f: &Finished, bytes: usize) {
        let Finished { parse, evaluate, world, render, rays, tiles, .. } = *f;
        self.post(|p| p.report = Some(Report { parse, evaluate, world, render, rays, tiles, bytes }));
    }

    /// Shows a picture that isn't the last of its text, unless a newer text is known.
    fn picture(&self, file: Vec<u8>, level: Level, size: (u32, u32), text: u64, progress: f64, leash: &Leash) {
        let Some(board) = &self.board else { return };
        let id = board.keep_picture(file);
        self.post(|p| {
            // Asked in here: what a newer text posts comes after its order, and so after the pull.
            if !leash.is_pulled() {
                put(p, id, level, size, text, progress);
            }
        });
        leash.shown();
    }

    fn post(&self, change: impl FnOnce(&mut Posted)) {
        if let Some(board) = &self.board {
            board.post(change);
        }
    }
}

/// Puts a picture on show, and how much of its text's last one is finished, unless that is there already.
fn put(p: &mut Posted, id: u64, level: Level, (width, height): (u32, u32), text: u64, progress: f64) {
    if let Some(old) = &p.picture {
        if old.text > text || (old.text == text && old.level == Level::Final && level != Level::Final) {
            return; // too late
        }
        if old.level == Level::Final && old.text < text {
            p.previous = Some(old.clone());
        }
    }
    p.picture = Some(Picture { id, level, width, height, text, made: time_of_day() });
    p.progress = progress;
}

fn messages(diagnostics: &[Diagnostic], sources: &Sources) -> Vec<Message> {
    let message = |d: &Diagnostic| Message {
        severity: if d.severity == Severity::Error { "error" } else { "warning" },
        message: d.message.clone(),
        text: diag::print(std::slice::from_ref(d), sources, Look::Plain),
        place: d.span().map_or(String::new(), |s| sources.location(s)),
    };
    diagnostics.iter().map(message).collect()
}

/// The `--set` arguments for a shell.
fn set_line(set: &[(String, String)]) -> String {
    let one = |(name, value): &(String, String)| format!("--set {}", words::quoted(&format!("{name}={value}")));
    set.iter().map(one).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_comes_too_late_changes_nothing() {
        let mut p = Posted::default();
        put(&mut p, 1, Level::Coarse, (8, 8), 1, 0.0);
        put(&mut p, 2, Level::Final, (8, 8), 1, 1.0);
        put(&mut p, 3, Level::Partial, (8, 8), 1, 0.5);
        assert_eq!((p.picture.as_ref().map(|p| p.id), p.progress), (Some(2), 1.0));
        // Finished again, since its file couldn't be written before: pages must know of the one that can be asked about.
        put(&mut p, 4, Level::Final, (8, 8), 1, 1.0);
        put(&mut p, 5, Level::Coarse, (8, 8), 2, 0.0);
        put(&mut p, 6, Level::Final, (8, 8), 1, 1.0);
        assert_eq!((p.picture.map(|p| p.id), p.previous.map(|p| p.id), p.progress), (Some(5), Some(4), 0.0));
    }

    #[test]
    fn set_lines_survive_a_shell() {
        let line = |set: &[(&str, &str)]| {
            set_line(&set.iter().map(|(n, v)| (n.to_string(), v.to_string())).collect::<Vec<_>>())
        };
        assert_eq!(line(&[]), "");
        assert_eq!(line(&[("count", "50"), ("turn", "30deg")]), "--set count=50 --set turn=30deg");
        assert_eq!(line(&[("color", "#ff0000")]), "--set 'color=#ff0000'");
        assert_eq!(line(&[("title", "it's \"so\"")]), r#"--set 'title=it'\''s "so"'"#);
    }
}
