//! `rtdsl watch`: makes the picture again whenever the text changes, and shows it on a live page.
//!
//! Three threads share the work. The [`follower`] tells when a file's content is no longer what was read; this loop turns
//! that, and what pages ask for, into orders and lays them on the [`desk`]; the [`painter`] makes the pictures, one at a
//! time, and stops within a batch of rays when a newer text is known.

pub mod canvas;
pub mod desk;
pub mod encoder;
pub mod follower;
pub mod interrupt;
pub mod painter;
pub mod show;
pub mod teller;

use super::args::WatchArgs;
use super::load::shown_name;
use super::picture::format_of;
use super::preview::{self, Ask, Board};
use super::{Exit, Stop};
use crate::diag::Diagnostic;
use crate::film::{Compression, Format, OutputFile};
use desk::{Desk, Order, Urgency};
use follower::Follower;
use interrupt::{AtEnd, Unwhole};
use painter::Painter;
use show::Show;
use std::io;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use teller::Teller;

/// What the loop waits for.
enum News {
    /// The content of these files changed.
    Files(Vec<PathBuf>),
    /// A page asks for something.
    Asked(Ask),
    /// The user wants to stop, or the painter can't go on.
    Stop,
}

/// Where the live page is if no address is given: on this machine alone, at a port that is free.
const ANY_PORT: SocketAddr = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 0);

/// Runs the command until it is interrupted.
///
/// # Errors
/// The arguments don't fit together, a file can't be written, or the page's address can't be had.
pub fn run(args: &WatchArgs) -> Result<Exit, Stop> {
    let address = args.serve.or(args.open.then_some(ANY_PORT));
    let output = output(args, address.is_some())?;
    let teller = Teller { json: args.json };
    let (news, waiting) = channel();
    let unwhole = Unwhole::default();
    let to_end = news.clone();
    // Where it can't be sent, the loop has ended.
    let stop = move || drop(to_end.send(News::Stop));
    ctrlc::set_handler(interrupt::handler(stop.clone(), unwhole.clone()))
        .map_err(|e| Stop::system("interruptions can't be noticed", io::Error::other(e)))?;
    let told = news.clone();
    // Whether anyone still listens shows in the loop, not here.
    let follower = Follower::new(args.poll, move |paths| drop(told.send(News::Files(paths))))
        .map_err(|e| Stop::system("changes of files can't be noticed", e))?;
    let board = address.map(|_| Arc::new(board(args, news)));
    let _server = match (&board, address) {
        (Some(board), Some(address)) => {
            let fault = |e| Stop::system(format!("the live page can't be served at {address}"), e);
            let server = preview::serve(Arc::clone(board), address).map_err(fault)?;
            teller.serving(&server.url());
            if !address.ip().is_loopback() {
                teller.note("other machines can see this page and change the scene's parameters");
            }
            if args.open && open::that_detached(server.url()).is_err() {
                teller.note("no browser could be opened");
            }
            Some(server)
        }
        _ => None,
    };
    let desk = Desk::default();
    std::thread::scope(|scope| {
        let painter = Painter::new(args, output, unwhole, &follower, Show::new(board.clone()), teller);
        let desk = &desk;
        scope.spawn(move || {
            let _at_end = AtEnd(stop); // also where it panics, which then comes out of this scope
            painter.work(desk);
        });
        watch(args, desk, &waiting);
        desk.close();
    });
    Ok(Exit::Done)
}

/// Turns news into orders until it is time to stop.
fn watch(args: &WatchArgs, desk: &Desk, news: &Receiver<News>) {
    let mut asked: Vec<(String, Option<String>)> = Vec::new();
    let order = |asked: &[(String, Option<String>)]| {
        let is_own = |s: &&(String, String)| !asked.iter().any(|a| a.0 == s.0);
        let own = args.scene.set.iter().filter(is_own).cloned();
        let page = asked.iter().filter_map(|(name, value)| Some((name.clone(), value.clone()?)));
        let from_page = asked.iter().map(|a| a.0.clone()).collect();
        Order { set: own.chain(page).collect(), from_page, ..Order::default() }
    };
    desk.put(order(&asked), Urgency::Now);
    while let Ok(news) = news.recv() {
        match news {
            News::Files(paths) => {
                let changed = paths.iter().map(|p| short_name(p)).collect();
                desk.put(Order { changed, ..order(&asked) }, Urgency::Now);
            }
            News::Asked(Ask::Set(values)) => {
                let names = values.iter().map(|v| v.0.clone()).collect();
                for (name, value) in values {
                    asked.retain(|a| a.0 != name);
                    asked.push((name, value));
                }
                desk.put(Order { asked: names, ..order(&asked) }, Urgency::AfterOnePicture);
            }
            News::Stop => return,
        }
    }
}

/// A path as the user would write it in the current folder.
fn short_name(path: &Path) -> String {
    let here = std::env::current_dir().unwrap_or_default();
    path.strip_prefix(&here).unwrap_or(path).display().to_string()
}

/// Where finished pictures go; nowhere where only a page shows them.
fn output(args: &WatchArgs, is_served: bool) -> Result<Option<(PathBuf, Format)>, Stop> {
    let name = shown_name(&args.scene.file);
    if args.scene.file == Path::new("-") {
        let d = Diagnostic::error("standard input can't be watched");
        return Err(Stop::usage(d.note("save the scene in a file, and watch that")));
    }
    let path = match &args.out {
        Some(path) => path.clone(),
        None if is_served => return Ok(None),
        None => match args.scene.file.file_stem() {
            Some(stem) => PathBuf::from(stem).with_added_extension("png"),
            None => return Err(Stop::usage(Diagnostic::error(format!("`{name}` names no file")))),
        },
    };
    let format = format_of(&path, (args.bits, Compression::Fast))?;
    OutputFile::new(&path).map_err(|e| Stop::system(format!("`{}` can't be written", path.display()), e))?;
    Ok(Some((path, format)))
}

fn board(args: &WatchArgs, news: Sender<News>) -> Board {
    // The moment of the start tells one run from another.
    let run = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
    Board::new(format!("{:x}", run.as_nanos()), shown_name(&args.scene.file), move |ask| {
        news.send(News::Asked(ask)).is_ok()
    })
}
