//! What pages see: the newest picture, messages, parameters and figures, posted by the watching loop and read by any number
//! of pages.

use crate::film::{Depth, Developer};
use crate::lang::{Evaluated, Param};
use crate::render::{Options, Probe, World, probe};
use crate::scene::Color;
use serde::Serialize;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::watch;

/// What pages see at one moment; its JSON form is what they are sent. Field names are the protocol.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Posted {
    /// Differs in every run of the program: a page that was open before the program started again notices.
    pub run: String,
    /// Grows with every post.
    pub serial: u64,
    /// The scene file, as the command line names it.
    pub file: String,
    /// Number of the newest text (a change of a file or of a parameter makes a new one), from 1.
    pub text: u64,
    /// Whether the newest text's picture is being made.
    pub busy: bool,
    /// Share of the picture that is finished, 0 to 1.
    pub progress: f64,
    /// The picture to show.
    pub picture: Option<Picture>,
    /// The last finished picture of an earlier text, to compare with.
    pub previous: Option<Picture>,
    /// Errors and warnings of the newest text. Errors: the picture is that of an earlier text.
    pub messages: Vec<Message>,
    /// The parameters of the newest text that could be evaluated.
    pub params: Vec<Setting>,
    /// The `--set` arguments that make the values of now, ready for a shell; empty when all are the scene's own.
    pub set_line: String,
    /// What the last finished picture took.
    pub report: Option<Report>,
}

/// A picture that can be fetched by its number.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Picture {
    /// Its number; another picture never gets the same.
    pub id: u64,
    /// How far it has come.
    pub level: Level,
    /// Pixels across, when finished.
    pub width: u32,
    /// Pixels down, when finished.
    pub height: u32,
    /// The text that it shows, by [`Posted::text`].
    pub text: u64,
    /// Time of day at which it was made, as `14:03:22`.
    pub made: String,
}

/// How far a picture has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Level {
    /// All of it, with fewer pixels than it will have: to be drawn enlarged.
    Coarse,
    /// Some of its tiles are final, others coarse or of the picture before.
    Partial,
    /// The very pixels that `rtdsl render` makes.
    Final,
}

/// A message about the text.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Message {
    /// `"error"` or `"warning"`.
    pub severity: &'static str,
    /// What is wrong, in a line.
    pub message: String,
    /// The whole message with the excerpt of the text, as `rtdsl check` prints it, without colours.
    pub text: String,
    /// `file:line:column`; empty where there is no place.
    pub place: String,
}

/// A parameter and its value.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Setting {
    /// Its name.
    pub name: String,
    /// What it is for.
    pub description: Option<String>,
    /// `"number" "choice" "switch" "color" "text" "other"`.
    pub kind: &'static str,
    /// Smallest and largest number.
    pub range: Option<(f64, f64)>,
    /// Whether only whole numbers are allowed.
    pub whole: bool,
    /// `""` or `"deg"`.
    pub unit: &'static str,
    /// The values of a choice, as text of the language.
    pub choices: Vec<String>,
    /// The scene's own value, as text of the language.
    pub default: String,
    /// The value now, as text of the language.
    pub value: String,
    /// The number (in `unit`) that `value` is, for a slider; `None` for other kinds.
    pub number: Option<f64>,
    /// The colour that `value` is, as `#rrggbb`; `None` for other kinds.
    pub color: Option<String>,
}

/// What a finished picture took.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Seconds parsing.
    pub parse: f64,
    /// Seconds evaluating.
    pub evaluate: f64,
    /// Seconds preparing the world.
    pub world: f64,
    /// Seconds tracing.
    pub render: f64,
    /// Rays traced for it.
    pub rays: u64,
    /// Tiles that were traced again, of how many.
    pub tiles: (usize, usize),
    /// Bytes of the finished picture, as a PNG of 8 bits.
    pub bytes: usize,
}

/// What a page asks of the watching loop.
#[derive(Clone, Debug, PartialEq)]
pub enum Ask {
    /// Give parameters these values, as text of the language; `None` gives back the scene's own.
    Set(Vec<(String, Option<String>)>),
}

/// The scene behind the newest finished picture, for questions about its pixels.
pub struct Shown {
    /// The number of its picture.
    pub picture: u64,
    /// The scene.
    pub evaluated: Arc<Evaluated>,
    /// The world traced.
    pub world: Arc<World>,
    /// How it was traced.
    pub options: Options,
}

impl Shown {
    /// What pixel (x, y) sees; `None` for the background and for pixels outside.
    pub fn probe(&self, x: u32, y: u32) -> Option<Probe> {
        let inside = x < self.options.width && y < self.options.height;
        inside.then(|| probe(&self.world, &self.options, x, y)).flatten()
    }
}

/// Where the watching loop posts and pages read.
pub struct Board {
    posted: watch::Sender<Arc<Posted>>,
    kept: Mutex<Kept>,
    hand_on: HandOn,
}

/// Takes what a page asks for; whether anyone listens.
type HandOn = Box<dyn Fn(Ask) -> bool + Send + Sync>;

#[derive(Default)]
struct Kept {
    /// The newest pictures' files, oldest first.
    pictures: Vec<(u64, Arc<[u8]>)>,
    next: u64,
    shown: Option<Arc<Shown>>,
}

/// How many pictures can be fetched: that on show and the one before it, and some that pages may still be asking for.
const PICTURES_KEPT: usize = 8;

impl Board {
    /// An empty board; what pages ask for goes to `hand_on`, which tells whether anyone listens.
    pub fn new(run: String, file: String, hand_on: impl Fn(Ask) -> bool + Send + Sync + 'static) -> Board {
        let posted = Posted { run, file, ..Posted::default() };
        Board {
            posted: watch::Sender::new(Arc::new(posted)),
            kept: Mutex::new(Kept { next: 1, ..Kept::default() }),
            hand_on: Box::new(hand_on),
        }
    }

    /// Changes what is posted, and tells all pages.
    pub fn post(&self, change: impl FnOnce(&mut Posted)) {
        self.posted.send_modify(|posted| {
            let posted = Arc::make_mut(posted);
            change(posted);
            posted.serial += 1;
        });
    }

    /// Keeps a picture file for pages to fetch; its number. Those that are posted are kept, of the others the newest.
    pub fn keep_picture(&self, file: Vec<u8>) -> u64 {
        let now = self.now();
        let posted = |id: u64| [&now.picture, &now.previous].into_iter().flatten().any(|p| p.id == id);
        let mut kept = self.kept();
        let id = kept.next;
        kept.next += 1;
        kept.pictures.push((id, file.into()));
        while kept.pictures.len() > PICTURES_KEPT
            && let Some(oldest) = kept.pictures.iter().position(|p| !posted(p.0))
        {
            kept.pictures.remove(oldest);
        }
        id
    }

    /// The file of picture number `id`, as PNG.
    pub fn picture(&self, id: u64) -> Option<Arc<[u8]>> {
        self.kept().pictures.iter().find(|p| p.0 == id).map(|p| Arc::clone(&p.1))
    }

    /// Puts the scene behind a picture on show.
    pub fn show(&self, shown: Shown) {
        self.kept().shown = Some(Arc::new(shown));
    }

    /// The scene behind the newest finished picture.
    pub fn shown(&self) -> Option<Arc<Shown>> {
        self.kept().shown.clone()
    }

    /// What is posted now.
    pub fn now(&self) -> Arc<Posted> {
        Arc::clone(&self.posted.borrow())
    }

    /// Follows what is posted.
    pub fn follow(&self) -> watch::Receiver<Arc<Posted>> {
        self.posted.subscribe()
    }

    /// Hands what a page asks for to the watching loop; whether it still runs.
    pub fn ask(&self, ask: Ask) -> bool {
        (self.hand_on)(ask)
    }

    fn kept(&self) -> MutexGuard<'_, Kept> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl From<&Param> for Setting {
    fn from(p: &Param) -> Setting {
        use crate::lang::ParamKind as K;
        let (kind, range, whole, unit, choices) = match &p.kind {
            K::Number { range, whole, unit } => ("number", *range, *whole, *unit, Vec::new()),
            K::Choice(all) => ("choice", None, false, "", all.clone()),
            K::Switch => ("switch", None, false, "", Vec::new()),
            K::Color => ("color", None, false, "", Vec::new()),
            K::Text => ("text", None, false, "", Vec::new()),
            K::Other => ("other", None, false, "", Vec::new()),
        };
        Setting {
            name: p.name.clone(),
            description: p.description.clone(),
            kind,
            range,
            whole,
            unit,
            choices,
            default: p.default.clone(),
            value: p.value.clone(),
            number: p.number,
            color: p.color.map(hex),
        }
    }
}

/// `#rrggbb`, the nearest that a screen shows.
fn hex(color: Color) -> String {
    let table = Developer::of(Depth::Eight);
    let code = |v: f64| table.code(v as f32);
    let [r, g, b] = color.0.map(code);
    format!("#{r:02x}{g:02x}{b:02x}")
}
