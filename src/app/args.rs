//! The command line. Values are checked, in `argument`, as far as they can be without the scene.

use super::accuracy::AccuracyArgs;
use super::argument::{
    address, anti_aliasing, assignment, bits, compression, crop, filter, glob_pattern, max_error, pixel, poll_interval,
    precision, seconds, size,
};
use super::later::Later;
use super::trade::axis::Axis;
use crate::film::{Compression, Depth};
use crate::render::Crop;
use crate::scene::{AntiAliasing, PixelFilter, Precision, Settings, range};
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::ffi::OsString;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

/// Pictures written as text: reads a scene and ray-traces its picture.
#[derive(Debug, Parser)]
#[command(name = "rtdsl", version, disable_help_subcommand = true, arg_required_else_help = true)]
#[command(
    after_help = "Exit codes: 0 done, 1 the scene is wrong, 2 usage, 3 files or system, 4 pictures differ or a bound isn't kept."
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Make the picture of a scene.
    Render(Later<RenderArgs>),
    /// Make the picture again whenever the scene changes, in the terminal and on a live page.
    #[command(mut_arg("file", |file| file.help("Scene file")))]
    Watch(WatchArgs),
    /// Make the pictures of a folder of scenes, and pages that show them with their text.
    Gallery(Later<GalleryArgs>),
    /// Look for mistakes without making a picture.
    Check(Later<CheckArgs>),
    /// Say what the renderer does for a scene and why, or what a pixel sees.
    Explain(Later<ExplainArgs>),
    /// Try out on this machine what rtdsl says of its accuracy.
    Verify(Later<VerifyArgs>),
    /// Measure what accuracy costs: error against time for this scene on this machine.
    Trade(Later<TradeArgs>),
    /// List the parameters that `--set` can change.
    Params(Later<ParamsArgs>),
    /// Explain a word of the scene language.
    Help(Later<HelpArgs>),
    /// Print a completion script for a shell.
    Completions(Later<CompletionsArgs>),
}

/// Which scene, with which parameters.
#[derive(Clone, Debug, Args)]
pub struct SceneArgs {
    /// Scene file; `-` is standard input.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Give a parameter of the scene another value.
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    pub set: Vec<(String, String)>,
    /// Let the scene read files in this folder too.
    #[arg(long, value_name = "DIR")]
    pub allow_read: Vec<PathBuf>,
}

/// How it is looked at; each replaces a setting of the scene.
#[derive(Clone, Debug, Args)]
pub struct ViewArgs {
    /// Width and height in pixels.
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<(u32, u32)>,
    /// Rays a pixel: `off` for one, `grid:N` for N x N (up to 32), `adaptive:N` for one and up to N more where neighbours differ.
    #[arg(long, value_name = "off|grid:N|adaptive:N", value_parser = anti_aliasing)]
    pub aa: Option<AntiAliasing>,
    /// How a pixel's light is weighed: `box`, the mean over its square; `mitchell`, sharp; `gauss`, soft. One ray a pixel is
    /// shown as it is.
    #[arg(long, value_name = "box|mitchell|gauss", value_parser = filter)]
    pub filter: Option<PixelFilter>,
    /// Reflections and transmissions one after another, up to 100.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=Settings::LARGEST_DEPTH as i64))]
    pub max_depth: Option<u32>,
    /// Look through the camera of this name.
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// Arithmetic: `f64`, or `f32` for a draft.
    #[arg(long, value_name = "f64|f32", value_parser = precision)]
    pub precision: Option<Precision>,
}

/// `rtdsl render`.
#[derive(Debug, Args)]
pub struct RenderArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Picture file: .png, .exr (linear) or .hdr (linear); `-` is standard output, as PNG. [default: FILE's name with .png,
    /// in the current folder]
    #[arg(short, long, value_name = "OUT")]
    pub out: Option<PathBuf>,
    /// The view.
    #[command(flatten)]
    pub view: ViewArgs,
    /// The accuracy.
    #[command(flatten)]
    pub accuracy: AccuracyArgs,
    /// Write a picture of each pixel's error: .png (white is the error asked for, red beyond it) or .exr (in shares of white).
    #[arg(long, value_name = "FILE", conflicts_with = "aa")]
    pub error_map: Option<PathBuf>,
    /// Write a picture of how sure each pixel is: proved green, bounded blue, estimated orange, open red.
    #[arg(long, value_name = "FILE", conflicts_with = "aa")]
    pub status_map: Option<PathBuf>,
    /// End with 4 where a pixel doesn't reach the error asked for.
    #[arg(long, conflicts_with = "aa")]
    pub strict: bool,
    /// Make only this part of the picture, in pixels from its top left corner.
    #[arg(long, value_name = "X,Y,W,H", value_parser = crop, allow_hyphen_values = true)]
    pub crop: Option<Crop>,
    /// Worker threads; never changes the picture. [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// Bits of a channel in a PNG.
    #[arg(long, value_name = "8|16", default_value = "8", value_parser = bits)]
    pub bits: Depth,
    /// How a PNG is compressed: `fast`, or `small` for a file a third smaller that takes many times as long.
    #[arg(long, value_name = "fast|small", default_value = "fast", value_parser = compression)]
    pub compression: Compression,
    /// Report rays, times and memory on standard output, as text or as JSON.
    #[arg(long, value_name = "text|json", num_args = 0..=1, default_missing_value = "text", value_enum)]
    pub stats: Option<StatsForm>,
    /// Print errors alone: no progress, no warnings, no summary.
    #[arg(short, long)]
    pub quiet: bool,
}

/// `rtdsl watch`.
#[derive(Debug, Args)]
pub struct WatchArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Picture file: .png, .exr (linear) or .hdr (linear). It only ever holds finished pictures. [default: FILE's name with
    /// .png, in the current folder; none with `--serve`]
    #[arg(short, long, value_name = "OUT")]
    pub out: Option<PathBuf>,
    /// The view.
    #[command(flatten)]
    pub view: ViewArgs,
    /// The accuracy.
    #[command(flatten)]
    pub accuracy: AccuracyArgs,
    /// Show the picture on a live page: at ADDR, or on this machine alone at any free port.
    #[arg(long, value_name = "ADDR", num_args = 0..=1, default_missing_value = "127.0.0.1:0", value_parser = address)]
    pub serve: Option<SocketAddr>,
    /// Open the live page in the browser; serves it too.
    #[arg(long)]
    pub open: bool,
    /// Look at the files every so many seconds instead of waiting for the system to tell: for network file systems.
    #[arg(long, value_name = "SECONDS", value_parser = poll_interval)]
    pub poll: Option<Duration>,
    /// Worker threads; never changes the picture. [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// Bits of a channel in a PNG.
    #[arg(long, value_name = "8|16", default_value = "8", value_parser = bits)]
    pub bits: Depth,
    /// Print an object a line on standard output: what changed, what was made, what is wrong.
    #[arg(long)]
    pub json: bool,
}

/// `rtdsl gallery`.
#[derive(Debug, Args)]
pub struct GalleryArgs {
    /// Folder with scenes; those in folders within it too.
    #[arg(value_name = "DIR", default_value = "examples")]
    pub dir: PathBuf,
    /// Folder for pictures and pages. [default: `gallery`, in the current folder]
    #[arg(short, long, value_name = "OUT")]
    pub out: Option<PathBuf>,
    /// Make nothing in OUT: render, compare with the pictures there, and end with 4 where one differs.
    #[arg(long)]
    pub check: bool,
    /// Folder for pictures that show what `--check` found: what was, what is, and the difference.
    #[arg(long, value_name = "DIR", default_value = "rtdsl-differences", requires = "check")]
    pub differences: PathBuf,
    /// Only scenes whose path in DIR this pattern matches, as in `chess*`.
    #[arg(long, value_name = "GLOB", value_parser = glob_pattern)]
    pub only: Option<glob::Pattern>,
    /// Scenes rendered at the same time. [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub jobs: Option<u32>,
    /// Pixels across of every picture; the height keeps the scene's proportion. [default: the scene's own size]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=range::LARGEST_SIDE as i64))]
    pub width: Option<u32>,
    /// Rays a pixel: `off`, `grid:N` for N x N, `adaptive:N` for one and up to N more where neighbours differ. [default: the scene's own]
    #[arg(long, value_name = "off|grid:N|adaptive:N", value_parser = anti_aliasing)]
    pub aa: Option<AntiAliasing>,
    /// How a pixel's light is weighed. [default: the scene's own]
    #[arg(long, value_name = "box|mitchell|gauss", value_parser = filter)]
    pub filter: Option<PixelFilter>,
    /// Let the scenes read files in this folder too.
    #[arg(long, value_name = "DIR")]
    pub allow_read: Vec<PathBuf>,
    /// Print the summary as JSON on standard output.
    #[arg(long)]
    pub json: bool,
    /// Print errors alone.
    #[arg(short, long)]
    pub quiet: bool,
}

/// `rtdsl check`.
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// Scene files; `-` is standard input.
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    /// Give a parameter another value.
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    pub set: Vec<(String, String)>,
    /// Let the scenes read files in this folder too.
    #[arg(long, value_name = "DIR")]
    pub allow_read: Vec<PathBuf>,
    /// Print the messages as JSON on standard output.
    #[arg(long)]
    pub json: bool,
}

/// `rtdsl explain`.
#[derive(Debug, Args)]
pub struct ExplainArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// A pixel, counted from the top left corner, which is 0,0. Without it: the features that the scene requires.
    #[arg(value_name = "X,Y", value_parser = pixel)]
    pub pixel: Option<(u32, u32)>,
    /// The view.
    #[command(flatten)]
    pub view: ViewArgs,
}

/// `rtdsl verify`.
#[derive(Debug, Args)]
pub struct VerifyArgs {
    /// Scenes whose pictures are put through the laws of pictures; `-` is standard input. [default: three built-in scenes]
    #[arg(value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// As many cases as the stated bounds speak of: minutes instead of seconds.
    #[arg(long)]
    pub extremes: bool,
    /// Only whether pictures keep the errors that are stated of them, with many cases: closed forms, and the pictures of FILE.
    #[arg(long, conflicts_with_all = ["extremes", "only"])]
    pub coverage: bool,
    /// Make this check alone, and others so named.
    #[arg(long, value_name = "NAME")]
    pub only: Vec<String>,
    /// Let the scenes read files in this folder too.
    #[arg(long, value_name = "DIR")]
    pub allow_read: Vec<PathBuf>,
    /// Print the figures as JSON on standard output; docs/verify.md tells of the fields.
    #[arg(long)]
    pub json: bool,
    /// Print the figures as a table in Markdown.
    #[arg(long, conflicts_with = "json")]
    pub markdown: bool,
}

/// `rtdsl trade`.
#[derive(Debug, Args)]
pub struct TradeArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Folder for trade.csv, trade.json, trade.svg and index.html. [default: FILE's name with `-trade`, in the current folder]
    #[arg(short, long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Turn only this dial, and others so named. [default: all]
    #[arg(long, value_enum, value_name = "DIAL", value_delimiter = ',')]
    pub axis: Vec<Axis>,
    /// Time for all of it: what wouldn't fit is left out.
    #[arg(long, value_name = "TIME", default_value = "60s", value_parser = seconds)]
    pub budget: f64,
    /// Say which setting is the cheapest that keeps this error, as in `2/255`; ends with 4 where none does.
    #[arg(long, value_name = "E", value_parser = max_error)]
    pub suggest: Option<f64>,
    /// The setting around which dials are turned.
    #[command(flatten)]
    pub view: ViewArgs,
    /// Worker threads. [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// Print trade.json on standard output; docs/trade.md tells of the fields.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors, and what `--suggest` asks for.
    #[arg(short, long)]
    pub quiet: bool,
}

/// `rtdsl params`.
#[derive(Debug, Args)]
pub struct ParamsArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Print them as JSON.
    #[arg(long)]
    pub json: bool,
}

/// `rtdsl help`.
#[derive(Debug, Args)]
pub struct HelpArgs {
    /// Any word of the scene language, or a command of this program.
    pub topic: Option<String>,
}

/// `rtdsl completions`.
#[derive(Debug, Args)]
pub struct CompletionsArgs {
    /// The shell.
    #[arg(value_enum)]
    pub shell: clap_complete::Shell,
}

/// `--stats`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum StatsForm {
    /// For people.
    Text,
    /// One object, for programs.
    Json,
}

/// `--stats FILE` means `--stats=text FILE`: an optional value must not swallow the argument after it. So `--serve`.
pub fn with_optional_values(arguments: impl IntoIterator<Item = OsString>) -> Vec<OsString> {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let end_of_options = arguments.iter().position(|a| a == "--").unwrap_or(arguments.len());
    let is_form = |a: &OsString| a == "text" || a == "json";
    let is_address =
        |a: &OsString| a.to_str().is_some_and(|a| address(a).is_ok() || (a.contains(':') && !a.contains('.')));
    let mend = |(i, a): (usize, &OsString)| {
        let next = arguments.get(i + 1);
        match a.to_str() {
            Some("--stats") if i < end_of_options && !next.is_some_and(is_form) => "--stats=text".into(),
            Some("--serve") if i < end_of_options && !next.is_some_and(is_address) => "--serve=127.0.0.1:0".into(),
            _ => a.clone(),
        }
    };
    arguments.iter().enumerate().map(mend).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
        let help = |command: &str| Cli::try_parse_from(["rtdsl", command, "--help"]).unwrap_err().to_string();
        assert!(help("render").starts_with("Make the picture of a scene\n"), "{}", help("render"));
        assert!(help("watch").starts_with("Make the picture again whenever"), "{}", help("watch"));
    }

    #[test]
    fn optional_values_never_swallow_the_file() {
        let mended = |s: &str| {
            let v = with_optional_values(s.split(' ').map(OsString::from));
            v.into_iter().map(|a| a.into_string().unwrap()).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(mended("render --stats a.scene"), "render --stats=text a.scene");
        assert_eq!(mended("render a --stats json"), "render a --stats json");
        assert_eq!(mended("render a --stats"), "render a --stats=text");
        assert_eq!(mended("render -- --stats"), "render -- --stats");
        assert_eq!(mended("watch --serve a.scene"), "watch --serve=127.0.0.1:0 a.scene");
        assert_eq!(mended("watch --serve 8000 a.scene"), "watch --serve 8000 a.scene");
        assert_eq!(mended("watch --serve :8000 a.scene"), "watch --serve :8000 a.scene");
    }
}
