//! Progress on a terminal, and nothing anywhere else.

use crate::render::{Crop, Progress};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{self, IsTerminal};
use std::time::Duration;

/// The bar; gone when dropped. None where nobody would see it.
pub struct Bar(Option<ProgressBar>);

impl Bar {
    /// A bar for `pixels` pixels on standard error, if it is a terminal; none when `quiet`.
    pub fn new(pixels: u64, quiet: bool) -> Bar {
        if quiet || !io::stderr().is_terminal() {
            return Bar(None);
        }
        let bar = ProgressBar::with_draw_target(Some(pixels), ProgressDrawTarget::stderr());
        // The plain bar serves if the template weren't understood.
        let style = ProgressStyle::with_template("{wide_bar:.cyan} {percent:>3} %  {elapsed} passed, {eta} left");
        Bar(Some(bar.clone().with_style(style.unwrap_or_else(|_| bar.style()))))
    }

    /// Adds `pixels` pixels to those that are to be made.
    pub fn lengthen(&self, pixels: u64) {
        if let Some(bar) = &self.0 {
            bar.inc_length(pixels);
        }
    }

    /// Prints something else without the bar in its way.
    pub fn pause(&self, print: impl FnOnce()) {
        match &self.0 {
            Some(bar) => bar.suspend(print),
            None => print(),
        }
    }

    /// Takes it off the terminal.
    pub fn clear(&self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}

impl Progress for Bar {
    fn finished(&self, tile: Crop, _rows: &[&mut [[f32; 3]]]) {
        if let Some(bar) = &self.0 {
            bar.inc(tile.width as u64 * tile.height as u64);
        }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.clear();
    }
}

/// A bar for work in named steps, of which nobody knows how long each takes; clones are the same bar.
#[derive(Clone)]
pub struct Steps(ProgressBar);

impl Steps {
    /// A bar for `steps` steps on standard error, if it is a terminal.
    pub fn new(steps: u64) -> Steps {
        let bar = ProgressBar::with_draw_target(Some(steps), ProgressDrawTarget::stderr());
        let style = ProgressStyle::with_template("{spinner} {msg}: {pos} of {len} done, {elapsed} passed");
        Steps(bar.clone().with_style(style.unwrap_or_else(|_| bar.style())))
    }

    /// So many steps more are to be done.
    pub fn lengthen(&self, steps: u64) {
        self.0.inc_length(steps);
    }

    /// A step begins.
    pub fn begin(&self, name: &'static str) {
        self.0.set_message(name);
        // Often enough to be seen to move.
        self.0.enable_steady_tick(Duration::from_millis(200));
    }

    /// A step is done.
    pub fn end(&self) {
        self.0.inc(1);
    }

    /// Prints something else without the bar in its way.
    pub fn pause<T>(&self, print: impl FnOnce() -> T) -> T {
        self.0.suspend(print)
    }

    /// Takes it off the terminal.
    pub fn clear(&self) {
        self.0.finish_and_clear();
    }
}
