//! One page: what a template is given.

use super::manifest::{Figures, ParamRow, Times};
use crate::app::words::{duration, thousands};
use minijinja::value::Serde;
use minijinja::{Environment, Value};
use serde::Serialize;

/// The page of a text.
#[derive(Default, Serialize)]
pub struct ScenePage {
    /// What it is called, as plain text.
    pub title: String,
    /// The same as HTML.
    pub heading: String,
    /// Its path in the folder of the scenes.
    pub name: String,
    /// As HTML.
    pub description: String,
    /// The way to the gallery's folder; empty for a page that lies there.
    pub root: String,
    /// The file itself.
    pub source: Option<String>,
    /// The words of the command that makes the picture, as a shell takes them.
    pub command: Vec<String>,
    /// The picture.
    pub picture: Option<Picture>,
    /// The scene's parameters.
    pub params: Vec<ParamRow>,
    /// What the picture is like: names and values.
    pub figures: Vec<(&'static str, String)>,
    /// What it took.
    pub times: Vec<(&'static str, String)>,
    /// What tells the picture apart from every other.
    pub image_hash: String,
    /// Files that the scene reads.
    pub files: Vec<FileLink>,
    /// Scenes that import it.
    pub users: Vec<PageLink>,
    /// The text as HTML.
    pub listing: String,
    /// Whether the text changed since the picture was made.
    pub changed: bool,
    /// What is wrong with the text.
    pub broken: Option<String>,
    /// The scene before it.
    pub previous: Option<PageLink>,
    /// The scene after it.
    pub next: Option<PageLink>,
}

/// A picture on a page.
#[derive(Clone, Debug, Serialize)]
pub struct Picture {
    /// The link to it.
    pub file: String,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
}

/// A link to another page.
#[derive(Serialize)]
pub struct PageLink {
    /// The link.
    pub page: String,
    /// Its short name.
    pub name: String,
    /// Its title; may be empty.
    pub title: String,
}

/// A link to a file.
#[derive(Serialize)]
pub struct FileLink {
    /// Its path.
    pub name: String,
    /// The link; `None` where there is no way to it.
    pub link: Option<String>,
    /// Whether it is a picture.
    pub image: bool,
}

/// The page of all scenes.
#[derive(Serialize)]
pub struct IndexPage {
    /// The name of the folder of the scenes.
    pub folder: String,
    /// The scenes.
    pub cards: Vec<Card>,
    /// Texts without pictures.
    pub modules: Vec<PageLink>,
}

/// A scene on the index.
#[derive(Serialize)]
pub struct Card {
    /// What it is called, as plain text.
    pub title: String,
    /// The same as HTML.
    pub heading: String,
    /// Its path in the folder of the scenes.
    pub name: String,
    /// As HTML.
    pub description: String,
    /// The link to its page.
    pub page: String,
    /// The link to its small picture.
    pub image: Option<String>,
    /// Pixels across of the small picture.
    pub width: u32,
    /// Pixels down of the small picture.
    pub height: u32,
    /// Whether something is wrong with its text.
    pub broken: bool,
}

impl Picture {
    /// The picture behind a link.
    pub fn new(file: String, [width, height]: [u32; 2]) -> Picture {
        Picture { file, width, height }
    }
}

/// The pages' forms.
pub struct Templates(Environment<'static>);

impl Templates {
    /// Those of the program. Their names end in `.html`, by which values in them are escaped.
    ///
    /// # Errors
    /// One isn't well-formed.
    pub fn new() -> Result<Templates, minijinja::Error> {
        let mut env = Environment::new();
        env.add_template("index.html", include_str!("templates/index.html"))?;
        env.add_template("scene.html", include_str!("templates/scene.html"))?;
        Ok(Templates(env))
    }

    /// The page of all scenes.
    ///
    /// # Errors
    /// The template doesn't fit.
    pub fn index(&self, page: &IndexPage) -> Result<String, minijinja::Error> {
        self.page("index.html", page)
    }

    /// The page of one text.
    ///
    /// # Errors
    /// The template doesn't fit.
    pub fn scene(&self, page: &ScenePage) -> Result<String, minijinja::Error> {
        self.page("scene.html", page)
    }

    fn page(&self, template: &str, page: impl Serialize) -> Result<String, minijinja::Error> {
        Ok(self.0.get_template(template)?.render(Value::from(Serde(page)))? + "\n")
    }
}

/// What a picture is like, in words.
pub fn figures(f: &Figures) -> Vec<(&'static str, String)> {
    let [width, height] = f.size;
    let [camera, shadow, reflected, transmitted] = f.rays;
    let a_pixel = match (f.adaptive, f.grid) {
        (Some(most), _) => format!("1 to {most}, more where neighbours differ"),
        (None, 1) => "1".into(),
        (None, n) => format!("{} ({n} × {n})", n * n),
    };
    let mut rows = vec![("size", format!("{width} × {height} pixels")), ("rays a pixel", a_pixel)];
    rows.extend(f.filter.iter().map(|filter| ("filter", filter.clone())));
    rows.extend([
        ("depth", f.max_depth.to_string()),
        ("arithmetic", f.precision.clone()),
        ("rays", thousands(camera + shadow + reflected + transmitted)),
    ]);
    let kinds = [
        ("… from the camera", camera),
        ("… to lights", shadow),
        ("… mirrored", reflected),
        ("… gone through", transmitted),
    ];
    rows.extend(kinds.into_iter().filter(|(_, n)| *n > 0).map(|(name, n)| (name, thousands(n))));
    if !f.features.is_empty() {
        rows.push(("features", f.features.join(", ")));
    }
    rows
}

/// What a picture took, in words.
pub fn times(t: &Times) -> Vec<(&'static str, String)> {
    let threads = if t.threads == 1 { "1 thread".into() } else { format!("{} threads", t.threads) };
    vec![
        ("text", duration(t.parse + t.evaluate)),
        ("preparing", duration(t.world)),
        ("tracing", format!("{}, {threads}", duration(t.render))),
        ("writing", duration(t.encode)),
        ("together", duration(t.total())),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_escaped() {
        let page = ScenePage { title: "<script>\"&".into(), ..ScenePage::default() };
        let html = Templates::new().unwrap().scene(&page).unwrap();
        assert!(html.contains("<title>&lt;script&gt;&quot;&amp;</title>"), "{html}");
    }
}
