//! The live page: what `rtdsl watch --serve` shows in a browser. The [`board`] holds what there is to show; the watching loop
//! posts on it and reads what pages ask for.

pub mod board;

pub use board::{Ask, Board, Level, Picture, Posted, Shown};
