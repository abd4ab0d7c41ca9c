//! The files of the page, held by the program: no build step, no network, no folder that could be left behind.

/// A file of the page.
pub struct Asset {
    /// Where it is served.
    pub path: &'static str,
    /// Its media type.
    pub media: &'static str,
    /// Its content.
    pub text: &'static str,
}

const HTML: &str = "text/html; charset=utf-8";
const CSS: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";
const SVG: &str = "image/svg+xml";

macro_rules! asset {
    ($path:literal, $media:expr, $file:literal) => {
        Asset { path: $path, media: $media, text: include_str!(concat!("page/", $file)) }
    };
}

/// All of them.
pub const ASSETS: [Asset; 14] = [
    asset!("/", HTML, "page.html"),
    asset!("/page.css", CSS, "page.css"),
    asset!("/controls.css", CSS, "controls.css"),
    asset!("/icon.svg", SVG, "icon.svg"),
    asset!("/page.js", SCRIPT, "page.js"),
    asset!("/feed.js", SCRIPT, "feed.js"),
    asset!("/pictures.js", SCRIPT, "pictures.js"),
    asset!("/view.js", SCRIPT, "view.js"),
    asset!("/gestures.js", SCRIPT, "gestures.js"),
    asset!("/wipe.js", SCRIPT, "wipe.js"),
    asset!("/controls.js", SCRIPT, "controls.js"),
    asset!("/values.js", SCRIPT, "values.js"),
    asset!("/inspector.js", SCRIPT, "inspector.js"),
    asset!("/status.js", SCRIPT, "status.js"),
];
