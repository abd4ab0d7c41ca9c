//! What a run did, for people and for programs.

use super::difference::{Difference, Numbers};
use crate::app::words::{duration, thousands};
use crate::app::{Exit, Stop};
use crate::diag::{Diagnostic, Report};
use serde::Serialize;
use std::path::Path;

/// What became of a scene. The words are those of the JSON form.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// Its picture was made.
    Made,
    /// Its picture still held.
    Unchanged,
    /// It only exports.
    Library,
    /// It wasn't asked for.
    Left,
    /// Checked: the picture is the one that is there.
    Same,
    /// Checked: it isn't.
    Differs,
    /// Checked: there is none.
    Missing,
    /// Checked: there is one, and no scene that makes it.
    Extra,
    /// Something is wrong with it.
    Broken,
    /// Its picture can't be read or written.
    Failed,
}

/// What became of one scene.
#[derive(Debug, Serialize)]
pub struct Line {
    /// Its path in the folder.
    pub scene: String,
    /// In a word.
    pub status: Status,
    /// Why it was made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub why: Option<String>,
    /// Seconds that making it took.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
    /// How the pictures differ.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub difference: Option<DifferenceJson>,
    /// The picture that shows both.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub panels: Option<String>,
    /// What is wrong with it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub diagnostics: Vec<Report>,
}

/// A difference as JSON; which fields it has depends on `kind`.
#[derive(Debug, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum DifferenceJson {
    /// What is there is no picture.
    Unreadable,
    /// They have other sizes.
    Size {
        /// Width and height of the picture that is there.
        was: [u32; 2],
        /// Width and height of the new one.
        is: [u32; 2],
    },
    /// The same pixels, another recipe.
    Recipe {
        /// The entries that differ.
        entries: Vec<String>,
    },
    /// Pixels differ.
    Pixels {
        /// How many.
        differing: u64,
        /// Of how many.
        all: u64,
        /// By how much at most, of 255.
        largest: u8,
        /// Root of the mean square, of 255.
        rmse: f64,
    },
}

/// What a run did.
#[derive(Debug, Serialize)]
pub struct Summary {
    /// The gallery's folder.
    pub folder: String,
    /// Every scene.
    pub scenes: Vec<Line>,
    /// Pages that were written anew.
    pub pages: usize,
    /// Files that were removed because their scenes are gone.
    pub removed: Vec<String>,
    /// Seconds of the whole run.
    pub seconds: f64,
}

impl Line {
    /// A line without anything to tell.
    pub fn new(scene: &str, status: Status) -> Line {
        Line {
            scene: scene.into(),
            status,
            why: None,
            seconds: None,
            difference: None,
            panels: None,
            diagnostics: Vec::new(),
        }
    }

    /// The line of a scene that couldn't be made, for the reason that `stop` gives.
    pub fn stopped(scene: &str, status: Status, stop: &Stop) -> Line {
        Line { diagnostics: stop.reports(), ..Line::new(scene, status) }
    }
}

impl Summary {
    /// How many scenes have this status.
    pub fn count(&self, status: Status) -> usize {
        self.scenes.iter().filter(|l| l.status == status).count()
    }

    /// A broken scene comes first: what it would look like can't be judged. Then files; then pictures that differ.
    pub fn exit(&self) -> Exit {
        let any = |all: &[Status]| all.iter().any(|s| self.count(*s) > 0);
        if any(&[Status::Broken]) {
            Exit::Scene
        } else if any(&[Status::Failed]) {
            Exit::System
        } else if any(&[Status::Differs, Status::Missing, Status::Extra]) {
            Exit::Unmet
        } else {
            Exit::Done
        }
    }

    /// What was done, in lines: the scenes that were made, and the count of the rest.
    pub fn text(&self) -> String {
        let made: Vec<&Line> = self.scenes.iter().filter(|l| l.status == Status::Made).collect();
        let width = made.iter().map(|l| l.scene.chars().count()).max().unwrap_or(0);
        let mut out = String::new();
        for line in made {
            let time = duration((line.seconds.unwrap_or(0.0) * 1e6) as u64);
            out += &format!("made  {:<width$}  {time:>7}  {}\n", line.scene, line.why.as_deref().unwrap_or(""));
        }
        for name in &self.removed {
            out += &format!("removed  {name}\n");
        }
        let words = [
            (Status::Made, "made"),
            (Status::Unchanged, "unchanged"),
            (Status::Left, "not asked for"),
            (Status::Same, "the same"),
            (Status::Differs, "different"),
            (Status::Missing, "missing"),
            (Status::Extra, "too many"),
            (Status::Broken, "broken"),
            (Status::Failed, "failed"),
        ];
        let counts = words.iter().map(|(s, word)| (self.count(*s), word)).filter(|(n, _)| *n > 0);
        let counts: Vec<String> = counts.map(|(n, word)| format!("{n} {word}")).collect();
        let counts = if counts.is_empty() { "nothing to make".into() } else { counts.join(", ") };
        let broken: Vec<&str> =
            self.scenes.iter().filter(|l| l.status == Status::Broken).map(|l| l.scene.as_str()).collect();
        let broken = if broken.is_empty() { String::new() } else { format!(" ({})", broken.join(", ")) };
        out + &format!("{}: {counts}{broken}; {}\n", self.folder, duration((self.seconds * 1e6) as u64))
    }
}

impl From<&Difference> for DifferenceJson {
    fn from(d: &Difference) -> DifferenceJson {
        match d {
            Difference::Unreadable => DifferenceJson::Unreadable,
            Difference::Size(was, is) => DifferenceJson::Size { was: *was, is: *is },
            Difference::Recipe(entries) => DifferenceJson::Recipe { entries: entries.clone() },
            Difference::Pixels(Numbers { differing, all, largest, rmse }) => {
                DifferenceJson::Pixels { differing: *differing, all: *all, largest: *largest, rmse: *rmse }
            }
        }
    }
}

/// The message about a picture that isn't the one that is there.
pub fn message(picture: &Path, difference: &Difference, panels: Option<(&Path, &str)>) -> Diagnostic {
    let numbers = match difference {
        Difference::Unreadable => "what is there isn't a picture".to_string(),
        Difference::Size([w, h], [w2, h2]) => format!("it is {w}x{h} pixels, and would be {w2}x{h2}"),
        Difference::Recipe(entries) => match entries.join(", ").as_str() {
            "" => "the pixels are the same, the file isn't: it was written in another form".to_string(),
            entries => format!("the pixels are the same, but it was made by another recipe: {entries}"),
        },
        Difference::Pixels(n) => format!(
            "{} of {} pixels differ, by {} of 255 at most; root mean square {:.3}",
            thousands(n.differing),
            thousands(n.all),
            n.largest,
            n.rmse
        ),
    };
    let d = Diagnostic::error(format!("`{}` isn't what its scene makes now", picture.display())).note(numbers);
    match panels {
        Some((path, legend)) => d.note(format!("{legend}: {}", path.display())),
        None => d,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_decides() {
        let exit = |all: &[Status]| {
            let scenes = all.iter().map(|s| Line::new("a.scene", *s)).collect();
            Summary { folder: "g".into(), scenes, pages: 0, removed: Vec::new(), seconds: 0.0 }.exit()
        };
        assert_eq!(exit(&[Status::Made, Status::Library, Status::Left]), Exit::Done);
        assert_eq!(exit(&[Status::Same, Status::Extra]), Exit::Unmet);
        assert_eq!(exit(&[Status::Differs, Status::Broken, Status::Failed]), Exit::Scene);
    }
}
