//! The live page: what `rtdsl watch --serve` shows in a browser. The [`board`] holds what there is to show; the watching loop
//! posts on it and reads what pages ask for. [`server`] answers pages from it, `guard` says which requests may come in,
//! `asset` holds the files of the page itself (`page/`).

mod asset;
pub mod board;
mod guard;
pub mod listener;
mod route;
pub mod server;

pub use board::{Ask, Board, Level, Picture, Posted, Shown};
pub use server::{Server, serve};
