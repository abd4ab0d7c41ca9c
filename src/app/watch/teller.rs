//! What a watching terminal shows: a line a picture, and messages as `rtdsl check` prints them; or, for programs, an object a
//! line.

use crate::app::stop::print_diagnostics;
use crate::app::words;
use crate::diag::{Diagnostic, Report, Sources};
use serde::Serialize;
use serde_json::{Value, json};
use std::io::{self, Write};
use std::time::{SystemTime, UNIX_EPOCH};

/// Tells what happens.
#[derive(Clone, Copy, Debug)]
pub struct Teller {
    /// Whether in objects for programs.
    pub json: bool,
}

/// A finished picture.
#[derive(Clone, Debug, Serialize)]
pub struct Finished {
    /// Number of the text that it shows.
    pub text: u64,
    /// Why it was made, in words.
    pub why: String,
    /// Seconds parsing.
    pub parse: f64,
    /// Seconds evaluating.
    pub evaluate: f64,
    /// Seconds preparing the world.
    pub world: f64,
    /// Seconds tracing.
    pub render: f64,
    /// Seconds from the notice of the change to the picture's last byte.
    pub total: f64,
    /// Rays traced.
    pub rays: u64,
    /// Tiles traced, of how many.
    pub tiles: (usize, usize),
    /// Pixels across and down.
    pub size: [u32; 2],
    /// What can be said of its error, where that was asked for.
    pub accuracy: Option<String>,
    /// The file, where there is one.
    pub out: Option<String>,
}

impl Teller {
    /// The live page can be opened.
    pub fn serving(&self, url: &str) {
        match self.json {
            true => self.object("serving", json!({ "url": url })),
            false => self.line(&format!("live page: {url}")),
        }
    }

    /// Something that the user should know.
    pub fn note(&self, text: &str) {
        match self.json {
            true => self.object("note", json!({ "text": text })),
            false => self.line(text),
        }
    }

    /// A picture with fewer pixels can be seen on the page.
    pub fn coarse(&self, text: u64) {
        if self.json {
            self.object("coarse", json!({ "text": text }));
        }
    }

    /// A picture was given up for a newer text, so many seconds after that was known.
    pub fn cancelled(&self, text: u64, after: f64) {
        if self.json {
            self.object("cancelled", json!({ "text": text, "after": after }));
        }
    }

    /// A picture is finished.
    pub fn finished(&self, f: &Finished) {
        if self.json {
            return self.object("picture", serde_json::to_value(f).unwrap_or_default());
        }
        let ms = |s: f64| if s < 1.0 { format!("{:.1} ms", s * 1e3) } else { format!("{s:.2} s") };
        let tiles = match f.tiles {
            (traced, all) if traced == all => String::new(),
            (traced, all) => format!(" in {traced} of {all} tiles"),
        };
        let [w, h] = f.size;
        let out = f.out.as_ref().map_or(String::new(), |o| format!("  {o}"));
        let (parse, evaluate, render) = (ms(f.parse), ms(f.evaluate), ms(f.world + f.render));
        self.line(&format!(
            "{}: parse {parse}, evaluate {evaluate}, render {render}, {} rays{tiles}, {w}x{h}{out}",
            f.why,
            words::thousands(f.rays)
        ));
        if let Some(accuracy) = &f.accuracy {
            self.line(accuracy);
        }
    }

    /// What is wrong with the newest text, or worth a look.
    pub fn messages(&self, text: u64, diagnostics: &[Diagnostic], sources: &Sources) {
        if diagnostics.is_empty() {
            return;
        }
        if self.json {
            let reports: Vec<Report> = diagnostics.iter().map(|d| Report::new(d, sources)).collect();
            return self.object("messages", json!({ "text": text, "diagnostics": reports }));
        }
        print_diagnostics(diagnostics, sources);
    }

    /// There is no picture of the newest text.
    pub fn failed(&self, why: &str, last_good: Option<&str>) {
        if !self.json {
            let rest = match last_good {
                Some(time) => format!("the picture stays that of {time}"),
                None => "there is no picture yet".to_string(),
            };
            self.line(&format!("{why}: {rest}"));
        }
    }

    fn line(&self, text: &str) {
        // Where standard error is closed nobody wants to know.
        let _ = writeln!(io::stderr(), "{}  {text}", time_of_day());
    }

    fn object(&self, event: &str, mut object: Value) {
        object["event"] = event.into();
        object["time"] = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |d| d.as_secs_f64()).into();
        let mut out = io::stdout().lock();
        let _ = writeln!(out, "{object}").and_then(|()| out.flush());
    }
}

/// `14:03:22`, where the user lives.
pub fn time_of_day() -> String {
    jiff::Zoned::now().strftime("%H:%M:%S").to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times() {
        let time = time_of_day();
        assert!(time.len() == 8 && time.split(':').all(|p| p.parse::<u8>().is_ok_and(|n| n < 60)), "{time}");
    }
}
