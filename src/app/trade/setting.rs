//! One way of making the picture: a position of every dial.

use crate::app::view::precision_word;
use crate::render::Options;
use crate::scene::{Accuracy, AntiAliasing, Precision};
use serde::Serialize;
use std::fmt::Write as _;

/// What decides how many rays a pixel gets.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Way {
    /// So many along each side of a pixel.
    Grid(u32),
    /// One a pixel, and up to so many where neighbours differ.
    Adaptive(u32),
    /// The error that is asked for, in codes of 8 bits.
    Error(f64),
    /// The same without bounds of regions: samples alone.
    Sampled(f64),
    /// Seconds.
    Time(f64),
}

/// A position of every dial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// How many rays.
    pub way: Way,
    /// Reflections and transmissions one after another.
    pub depth: u32,
    /// Arithmetic.
    pub precision: Precision,
}

impl Setting {
    /// What the options say.
    pub fn of(options: &Options) -> Setting {
        let way = match options.accuracy {
            // Where both are asked for, the error is what is wanted of the picture.
            Some(Accuracy { error: Some(share), .. }) => Way::Error(255.0 * share),
            Some(Accuracy { time: Some(seconds), .. }) => Way::Time(seconds),
            _ => match options.aa {
                AntiAliasing::Adaptive(n) => Way::Adaptive(n),
                aa => Way::Grid(aa.side()),
            },
        };
        Setting { way, depth: options.max_depth, precision: options.precision }
    }

    /// The options changed to this.
    pub fn options(&self, options: &Options) -> Options {
        let aa = match self.way {
            Way::Grid(n) if n > 1 => AntiAliasing::Grid(n),
            Way::Adaptive(n) => AntiAliasing::Adaptive(n),
            _ => AntiAliasing::Off,
        };
        let confidence = options.accuracy.map_or(Accuracy::CONFIDENCE, |a| a.confidence);
        let accuracy = match self.way {
            Way::Grid(_) | Way::Adaptive(_) => None,
            Way::Error(codes) | Way::Sampled(codes) => {
                Some(Accuracy { error: Some(codes / 255.0), time: None, confidence })
            }
            Way::Time(seconds) => Some(Accuracy { error: None, time: Some(seconds), confidence }),
        };
        Options { aa, accuracy, max_depth: self.depth, precision: self.precision, ..options.clone() }
    }

    /// In words: the way, and whatever else isn't as in `base`.
    pub fn words(&self, base: &Setting) -> String {
        let mut words = match self.way {
            Way::Grid(1) => "1 ray a pixel".into(),
            Way::Grid(n) => format!("grid {n}×{n}"),
            Way::Adaptive(n) => format!("adaptive, up to {n} rays"),
            Way::Error(codes) => format!("max error {}/255", number(codes)),
            Way::Sampled(codes) => format!("max error {}/255 by samples alone", number(codes)),
            Way::Time(seconds) => format!("time {} s", number(seconds)),
        };
        if self.depth != base.depth {
            let _ = write!(words, ", depth {}", self.depth);
        }
        if self.precision != base.precision {
            let _ = write!(words, ", {}", precision_word(self.precision));
        }
        words
    }

    /// In a few characters, for a plot.
    pub fn label(&self, base: &Setting) -> String {
        match self.way {
            way if self.depth != base.depth && way != base.way => {
                format!("{}, d {}", Setting { depth: base.depth, ..*self }.label(base), self.depth)
            }
            _ if self.depth != base.depth => format!("depth {}", self.depth),
            _ if self.precision != base.precision => precision_word(self.precision).into(),
            Way::Grid(1) => "off".into(),
            Way::Grid(n) => format!("{n}×{n}"),
            Way::Adaptive(n) => format!("≤ {n}"),
            Way::Error(codes) => format!("{}/255", number(codes)),
            Way::Sampled(codes) => format!("{}/255 sampled", number(codes)),
            Way::Time(seconds) => format!("{} s", number(seconds)),
        }
    }

    /// The arguments that ask `rtdsl render` for it; `None` for what only this sweep does.
    pub fn arguments(&self, base: &Setting) -> Option<String> {
        let mut arguments = match self.way {
            Way::Grid(1) => "--aa off".into(),
            Way::Grid(n) => format!("--aa grid:{n}"),
            Way::Adaptive(n) => format!("--aa adaptive:{n}"),
            Way::Error(codes) => format!("--max-error {}/255", number(codes)),
            Way::Time(seconds) => format!("--time {}s", number(seconds)),
            Way::Sampled(_) => return None,
        };
        if self.depth != base.depth {
            let _ = write!(arguments, " --max-depth {}", self.depth);
        }
        if self.precision != base.precision {
            let _ = write!(arguments, " --precision {}", precision_word(self.precision));
        }
        Some(arguments)
    }
}

/// With three digits behind the point at most, and no zeros at the end.
pub fn number(x: f64) -> String {
    let text = format!("{x:.3}");
    text.trim_end_matches('0').trim_end_matches('.').into()
}

/// Codes, with three digits.
pub fn digits(codes: f64) -> String {
    match codes {
        _ if codes >= 99.95 => format!("{codes:.0}"),
        _ if codes >= 9.995 => format!("{codes:.1}"),
        _ => format!("{codes:.2}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_tell_what_differs() {
        let base = Setting { way: Way::Grid(2), depth: 5, precision: Precision::F64 };
        assert_eq!(base.words(&base), "grid 2×2");
        assert_eq!(base.arguments(&base).as_deref(), Some("--aa grid:2"));
        let other = Setting { way: Way::Error(0.25), depth: 3, precision: Precision::F32 };
        assert_eq!(other.words(&base), "max error 0.25/255, depth 3, f32");
        assert_eq!(other.arguments(&base).as_deref(), Some("--max-error 0.25/255 --max-depth 3 --precision f32"));
        let timed = Setting { way: Way::Time(2.0), ..base };
        assert_eq!((timed.label(&base), timed.arguments(&base)), ("2 s".into(), Some("--time 2s".into())));
        assert_eq!(Setting { way: Way::Sampled(4.0), ..base }.arguments(&base), None);
        let adaptive = Setting { way: Way::Adaptive(16), ..base };
        assert_eq!(adaptive.arguments(&base).as_deref(), Some("--aa adaptive:16"));
        let options = adaptive.options(&Options::from_settings(&Default::default()));
        assert_eq!(Setting::of(&options).way, adaptive.way);
        assert_eq!([0.126, 9.996, 99.97, 146.2].map(digits), ["0.13", "10.0", "100", "146"]);
    }
}
