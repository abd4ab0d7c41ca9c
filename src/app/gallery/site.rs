//! All pages of the gallery: which there are, what they show of which scene, and how they lead to each other.

use super::link::{between, href, slashed, tidy, way};
use super::listing::{Listing, prose};
use super::manifest::{Entry, digest, digest_of};
use super::page::{Card, FileLink, IndexPage, PageLink, Picture, ScenePage, Templates, figures, times};
use super::project::{PAGES, Project};
use super::scene_file::SceneFile;
use super::title::{Title, title};
use crate::app::Stop;
use crate::app::words::quoted;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// What the pages are made from.
pub struct Site<'a> {
    /// The folders and scenes.
    pub project: &'a Project,
    /// What is known of each scene.
    pub entries: &'a BTreeMap<String, Entry>,
    /// Scenes that changed and weren't made again, because others were asked for.
    pub changed: &'a BTreeSet<String>,
}

/// A text that has a page.
#[derive(Default)]
struct Text {
    /// From the folder of the scenes.
    path: String,
    /// Its page's name in the gallery's folder.
    page: String,
    /// It is the text of a picture; otherwise it only exports, or lies outside the folder.
    is_scene: bool,
    text: String,
    title: Title,
}

/// The page that lists all others, and how all look.
const INDEX: &str = "index.html";
const STYLE: &str = "style.css";

impl Site<'_> {
    /// The files of a site that are known before any scene was looked at.
    pub fn names(project: &Project) -> impl Iterator<Item = String> {
        [INDEX, STYLE].map(String::from).into_iter().chain(project.scenes.iter().map(SceneFile::page))
    }

    /// A digest of all that the pages show. While it stays, so do they.
    pub fn digest(&self) -> String {
        // Maps of texts and numbers always have a JSON form.
        let entries = serde_json::to_string(self.entries).unwrap_or_default();
        let mut parts = vec![PAGES.to_string(), self.folder_name(), self.allowed().join("\n"), entries];
        let scenes = self.project.scenes.iter().map(|s| s.name.clone());
        for path in scenes.chain(self.outside()) {
            let changed = self.changed.contains(&path);
            parts.push(format!("{path} {changed} {:?}", self.project.digest(&path)));
        }
        digest_of(parts.iter().map(String::as_str))
    }

    /// Every page and the style sheet, by its name in the gallery's folder.
    ///
    /// # Errors
    /// A template doesn't fit what it shows.
    pub fn files(&self) -> Result<BTreeMap<String, Vec<u8>>, Stop> {
        let templates = Templates::new().map_err(broken)?;
        let listing = Listing::of_catalog();
        let texts = self.texts();
        let scenes: Vec<&Text> = texts.iter().filter(|t| t.is_scene).collect();
        let mut files = BTreeMap::new();
        for text in &texts {
            let at = scenes.iter().position(|s| s.path == text.path);
            let neighbour = |i: Option<usize>| i.and_then(|i| scenes.get(i)).map(|t| link_to(text, t));
            let page = ScenePage {
                previous: neighbour(at.and_then(|i| i.checked_sub(1))),
                next: neighbour(at.map(|i| i + 1)),
                listing: listing.html(&text.text),
                ..self.page(text, &texts)
            };
            files.insert(text.page.clone(), templates.scene(&page).map_err(broken)?.into_bytes());
        }
        let index = Text { page: INDEX.into(), ..Text::default() };
        let page = IndexPage {
            folder: self.folder_name(),
            cards: scenes.iter().map(|t| self.card(t)).collect(),
            modules: texts.iter().filter(|t| !t.is_scene).map(|t| link_to(&index, t)).collect(),
        };
        let html = templates.index(&page).map_err(broken)?;
        files.insert(index.page, html.into_bytes());
        files.insert(STYLE.into(), include_bytes!("templates/style.css").to_vec());
        Ok(files)
    }

    /// All texts that get a page: the scenes, and what they import from elsewhere.
    fn texts(&self) -> Vec<Text> {
        let make = |path: String, page: String, is_scene: bool| {
            let text = self.project.text(&path);
            let title = title(&text);
            Text { path, page, is_scene, text, title }
        };
        let here = self.project.scenes.iter().map(|s| make(s.name.clone(), s.page(), !self.is_library(s)));
        let outside = self.outside().into_iter().map(|path| {
            // Their names could be anything, and `..` leads out of the gallery.
            let name = path.rsplit('/').next().unwrap_or("text");
            let page = format!("outside/{}-{name}.html", &digest(path.as_bytes())[..8]);
            make(path.clone(), page, false)
        });
        here.chain(outside).collect()
    }

    /// It makes no picture, and nothing is wrong with it.
    fn is_library(&self, scene: &SceneFile) -> bool {
        self.entries.get(&scene.name).is_some_and(|e| e.figures.is_none() && e.broken.is_none() && !e.files.is_empty())
    }

    /// Texts that are imported and aren't among the scenes.
    fn outside(&self) -> BTreeSet<String> {
        let used = self.entries.values().flat_map(|e| &e.files).filter(|f| f.text).map(|f| f.path.clone());
        used.filter(|path| !self.project.scenes.iter().any(|s| s.name == *path)).collect()
    }

    fn page(&self, text: &Text, texts: &[Text]) -> ScenePage {
        let entry = self.entries.get(&text.path).cloned().unwrap_or_default();
        let scene = self.project.scenes.iter().find(|s| s.name == text.path);
        let shown = entry.figures.as_ref().zip(scene);
        let page_of = |path: &str| texts.iter().find(|t| t.path == path).map(|t| between(&text.page, &t.page));
        let files = entry.files.iter().skip(1).map(|f| {
            let page = if f.text { page_of(&f.path) } else { None };
            FileLink { name: f.path.clone(), link: page.or_else(|| self.source(text, &f.path)), image: !f.text }
        });
        let imports = |e: &Entry| e.files.iter().skip(1).any(|f| f.path == text.path);
        let users = texts.iter().filter(|t| self.entries.get(&t.path).is_some_and(imports));
        ScenePage {
            title: shown_title(text).replace('`', ""),
            heading: prose(&shown_title(text)),
            name: text.path.clone(),
            description: prose(&text.title.description),
            root: "../".repeat(text.page.matches('/').count()),
            source: self.source(text, &text.path),
            command: shown.map_or(Vec::new(), |(f, _)| self.command(&text.path, &f.view)),
            picture: shown.map(|(f, s)| Picture::new(between(&text.page, &s.picture()), f.size)),
            params: shown.map_or(Vec::new(), |(f, _)| f.params.clone()),
            figures: shown.map_or(Vec::new(), |(f, _)| figures(f)),
            times: shown.map_or(Vec::new(), |(f, _)| times(&f.times)),
            image_hash: shown.map_or(String::new(), |(f, _)| f.image_hash.clone()),
            files: files.collect(),
            users: users.map(|t| link_to(text, t)).collect(),
            changed: self.changed.contains(&text.path),
            broken: entry.broken,
            ..ScenePage::default()
        }
    }

    fn card(&self, text: &Text) -> Card {
        let entry = self.entries.get(&text.path);
        let scene = self.project.scenes.iter().find(|s| s.name == text.path);
        let picture = entry.and_then(|e| e.figures.as_ref()).zip(scene).map(|(f, s)| match f.thumbnail {
            Some(size) => Picture::new(href(&s.thumbnail()), size),
            None => Picture::new(href(&s.picture()), f.size),
        });
        Card {
            title: shown_title(text).replace('`', ""),
            heading: prose(&shown_title(text)),
            name: text.path.clone(),
            description: prose(&text.title.description),
            page: href(&text.page),
            width: picture.as_ref().map_or(0, |p| p.width),
            height: picture.as_ref().map_or(0, |p| p.height),
            image: picture.map(|p| p.file),
            broken: entry.is_some_and(|e| e.broken.is_some()),
        }
    }

    /// The link from a page to the file at `path`, where there is a way.
    fn source(&self, page: &Text, path: &str) -> Option<String> {
        let out = self.project.out.canonicalize().ok()?;
        let file = self.project.folder.join(path);
        // A browser takes `..` back by itself; where that leads elsewhere, because of links, only the real path will do.
        let direct = tidy(Path::new(path)) == Path::new(path);
        let file = if direct { tidy(&file) } else { file.canonicalize().ok()? };
        let way = way(&out, &file).and_then(|w| slashed(&w))?;
        Some(between(&page.page, &way))
    }

    /// The command that makes a picture, for a shell in the folder above that of the scenes.
    fn command(&self, path: &str, view: &[String]) -> Vec<String> {
        let file = format!("{}/{path}", self.folder_name());
        let view = view.iter().cloned();
        let allowed = self.allowed().into_iter().flat_map(|folder| ["--allow-read".to_string(), folder]);
        let words = ["rtdsl".to_string(), "render".into(), file].into_iter().chain(view).chain(allowed);
        words.map(|w| quoted(&w)).collect()
    }

    /// The folders that scenes may read besides, from the folder above that of the scenes.
    fn allowed(&self) -> Vec<String> {
        let above = self.project.folder.parent();
        let name = |folder: &PathBuf| {
            let way = folder.canonicalize().ok().zip(above).and_then(|(folder, above)| way(above, &folder));
            way.and_then(|w| slashed(&w)).unwrap_or_else(|| folder.display().to_string())
        };
        self.project.allow_read.iter().map(name).collect()
    }

    fn folder_name(&self) -> String {
        self.project.folder.file_name().map_or("scenes".into(), |n| n.to_string_lossy().into_owned())
    }
}

fn link_to(from: &Text, to: &Text) -> PageLink {
    let name = to.path.rsplit('/').next().unwrap_or("").trim_end_matches(".scene");
    let name = if to.is_scene { name.to_string() } else { to.path.clone() };
    PageLink { page: between(&from.page, &to.page), name, title: to.title.title.replace('`', "") }
}

/// A text without a title is called by its path.
fn shown_title(text: &Text) -> String {
    if text.title.title.is_empty() { text.path.clone() } else { text.title.title.clone() }
}

/// The templates are the program's own: this is a fault of the program, told like any other.
fn broken(e: minijinja::Error) -> Stop {
    Stop::system("a page can't be made", std::io::Error::other(e.to_string()))
}
