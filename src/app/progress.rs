//! A progress bar on a terminal, and nothing anywhere else.

use crate::render::{Crop, Progress};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// The bar; gone when dropped.
pub struct Bar(ProgressBar);

impl Bar {
    /// A bar for `pixels` pixels on standard error, if it is a terminal; none when `quiet`.
    pub fn new(pixels: u64, quiet: bool) -> Bar {
        let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(pixels), target);
        // The plain bar serves if the template weren't understood.
        let style = ProgressStyle::with_template("{wide_bar:.cyan} {percent:>3} %  {elapsed} passed, {eta} left");
        Bar(bar.clone().with_style(style.unwrap_or_else(|_| bar.style())))
    }

    /// Adds `pixels` pixels to those that are to be made.
    pub fn lengthen(&self, pixels: u64) {
        self.0.inc_length(pixels);
    }

    /// Prints something else without the bar in its way.
    pub fn pause(&self, print: impl FnOnce()) {
        self.0.suspend(print);
    }

    /// Takes it off the terminal.
    pub fn clear(&self) {
        self.0.finish_and_clear();
    }
}

impl Progress for Bar {
    fn finished(&self, tile: Crop, _rows: &[&mut [[f32; 3]]]) {
        self.0.inc(tile.width as u64 * tile.height as u64);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.clear();
    }
}
