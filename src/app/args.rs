//! The command line. Values are checked here as far as they can be without the scene.

use crate::film::Depth;
use crate::render::Crop;
use crate::scene::{AntiAliasing, Precision, Settings, range};
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::ffi::OsString;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

/// Pictures written as text: reads a scene and ray-traces its picture.
#[derive(Debug, Parser)]
#[command(name = "rtdsl", version, disable_help_subcommand = true, arg_required_else_help = true)]
#[command(after_help = "Exit codes: 0 done, 1 the scene is wrong, 2 usage, 3 files or system, 4 pictures differ.")]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Make the picture of a scene.
    Render(RenderArgs),
    /// Make the picture again whenever the scene changes, in the terminal and on a live page.
    Watch(WatchArgs),
    /// Make the pictures of a folder of scenes, and pages that show them with their text.
    Gallery(GalleryArgs),
    /// Look for mistakes without making a picture.
    Check(CheckArgs),
    /// Say what the renderer does for a scene and why, or what a pixel sees.
    Explain(ExplainArgs),
    /// List the parameters that `--set` can change.
    Params(ParamsArgs),
    /// Explain a word of the scene language.
    Help(HelpArgs),
    /// Print a completion script for a shell.
    Completions(CompletionsArgs),
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
    /// Rays a pixel: `off` for one, `grid:N` for N x N, N up to 32.
    #[arg(long, value_name = "off|grid:N", value_parser = anti_aliasing)]
    pub aa: Option<AntiAliasing>,
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
    /// Make only this part of the picture, in pixels from its top left corner.
    #[arg(long, value_name = "X,Y,W,H", value_parser = crop, allow_hyphen_values = true)]
    pub crop: Option<Crop>,
    /// Worker threads; never changes the picture. [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// Bits of a channel in a PNG.
    #[arg(long, value_name = "8|16", default_value = "8", value_parser = bits)]
    pub bits: Depth,
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
    /// Rays a pixel: `off` for one, `grid:N` for N x N. [default: the scene's own]
    #[arg(long, value_name = "off|grid:N", value_parser = anti_aliasing)]
    pub aa: Option<AntiAliasing>,
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
    let is_address = |a: &OsString| a.to_str().is_some_and(|a| address(a).is_ok());
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

fn assignment(s: &str) -> Result<(String, String), String> {
    match s.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() => Ok((name.trim().to_string(), value.trim().to_string())),
        _ => Err("write the parameter's name, `=` and its value, as in `count=50`".into()),
    }
}

fn size(s: &str) -> Result<(u32, u32), String> {
    let (w, h) = s.split_once(['x', 'X']).ok_or("write width and height in pixels, as in `1280x720`")?;
    let side = |s: &str| match s.parse::<u64>() {
        Ok(n) if (1..=range::LARGEST_SIDE as u64).contains(&n) => Ok(n as u32),
        _ => Err(format!("a side is a whole number of pixels from 1 to {}, not `{s}`", range::LARGEST_SIDE)),
    };
    let (w, h) = (side(w)?, side(h)?);
    let pixels = w as u64 * h as u64;
    if pixels > range::MOST_PIXELS {
        return Err(format!("that is {pixels} pixels; {} are the most", range::MOST_PIXELS));
    }
    Ok((w, h))
}

fn anti_aliasing(s: &str) -> Result<AntiAliasing, String> {
    if s == "off" {
        return Ok(AntiAliasing::Off);
    }
    let n = s.strip_prefix("grid:").ok_or("write `off`, or `grid:N` as in `grid:2`")?;
    match n.parse() {
        Ok(n) if (1..=AntiAliasing::LARGEST_GRID).contains(&n) => Ok(AntiAliasing::Grid(n)),
        _ => Err(format!("the grid is a whole number from 1 to {}, not `{n}`", AntiAliasing::LARGEST_GRID)),
    }
}

fn precision(s: &str) -> Result<Precision, String> {
    match s {
        "f64" => Ok(Precision::F64),
        "f32" => Ok(Precision::F32),
        _ => Err("write `f64` or `f32`".into()),
    }
}

/// `8000`, `127.0.0.1`, `[::1]:8000`, `localhost:8000`.
fn address(s: &str) -> Result<SocketAddr, String> {
    let here = std::net::Ipv4Addr::LOCALHOST;
    let s = s.replace("localhost", "127.0.0.1");
    if let Ok(port) = s.parse::<u16>() {
        return Ok((here, port).into());
    }
    if let Ok(ip) = s.parse::<std::net::IpAddr>() {
        return Ok((ip, 0).into());
    }
    s.parse().map_err(|_| "write an address and a port, as in `127.0.0.1:8000`, or one of them".into())
}

fn poll_interval(s: &str) -> Result<Duration, String> {
    match s.parse::<f64>() {
        // A tenth of a second is as fast as anyone saves; a day is a typing mistake.
        Ok(x) if (0.1..=86_400.0).contains(&x) => Ok(Duration::from_secs_f64(x)),
        _ => Err("write seconds from 0.1 up, as in `2`".into()),
    }
}

fn glob_pattern(s: &str) -> Result<glob::Pattern, String> {
    glob::Pattern::new(s).map_err(|e| e.msg.to_string())
}

fn bits(s: &str) -> Result<Depth, String> {
    match s {
        "8" => Ok(Depth::Eight),
        "16" => Ok(Depth::Sixteen),
        _ => Err("a PNG has 8 or 16 bits a channel".into()),
    }
}

fn crop(s: &str) -> Result<Crop, String> {
    let [x, y, width, height] =
        whole_numbers(s).ok_or("write four whole numbers: left, top, width, height, as in `100,50,320,200`")?;
    if width == 0 || height == 0 {
        return Err("a part of no pixels can't be made".into());
    }
    Ok(Crop { x, y, width, height })
}

fn pixel(s: &str) -> Result<(u32, u32), String> {
    let [x, y] = whole_numbers(s).ok_or("write two whole numbers: column and row, as in `640,360`")?;
    Ok((x, y))
}

fn whole_numbers<const N: usize>(s: &str) -> Option<[u32; N]> {
    let numbers: Option<Vec<u32>> = s.split(',').map(|n| n.trim().parse().ok()).collect();
    numbers?.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
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
    }

    #[test]
    fn values() {
        assert_eq!(size("1280x720"), Ok((1280, 720)));
        for wrong in ["0x5", "5", "-1x4", "1000000000x1", "65536x65536", "5x", "1.5x2", ""] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
        assert_eq!(anti_aliasing("grid:32"), Ok(AntiAliasing::Grid(32)));
        for wrong in ["grid:0", "grid:33", "grid", "on", "grid:-1"] {
            assert!(anti_aliasing(wrong).is_err(), "{wrong}");
        }
        assert_eq!(crop("1, 2,3,4"), Ok(Crop { x: 1, y: 2, width: 3, height: 4 }));
        assert!(crop("1,2,0,4").is_err() && crop("1,2,3").is_err() && crop("-1,2,3,4").is_err());
        assert_eq!(pixel("640,360"), Ok((640, 360)));
        assert_eq!(assignment("a = b=c"), Ok(("a".into(), "b=c".into())));
        let at = |s| address(s).map(|a| a.to_string()).ok();
        assert_eq!(at("8000").as_deref(), Some("127.0.0.1:8000"));
        assert_eq!(at("localhost:80").as_deref(), Some("127.0.0.1:80"));
        assert_eq!(at("::1").as_deref(), Some("[::1]:0"));
        assert_eq!((at("a.scene"), at("70000"), at("")), (None, None, None));
        assert!(poll_interval("0").is_err() && poll_interval("NaN").is_err() && poll_interval("0.5").is_ok());
        assert!(assignment("=1").is_err() && assignment("a").is_err());
    }
}
