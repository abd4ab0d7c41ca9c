//! A picture that is asked for by its accuracy: what the command line adds to the scene, and the one line that is said of it.

use super::Stop;
use super::argument::{confidence, max_error, seconds};
use crate::diag::Diagnostic;
use crate::film::{Depth, Format};
use crate::render::Options;
use crate::render::certify::Certificate;
use crate::scene::{Accuracy, Precision};
use clap::{Args, ValueEnum};

/// How close to the truth the picture has to come, instead of how many rays a pixel.
#[derive(Clone, Debug, Default, Args)]
pub struct AccuracyArgs {
    /// Largest error of any pixel, as in `2/255`; as many rays as it takes, and none where it is proved without.
    #[arg(long, value_name = "E", value_parser = max_error, conflicts_with = "aa")]
    pub max_error: Option<f64>,
    /// Named errors: draft is 16/255, good 4/255, fine 1/255.
    #[arg(long, value_enum, conflicts_with_all = ["aa", "max_error"])]
    pub quality: Option<Quality>,
    /// Time for tracing, as in `2s`: the picture gets as good as it can meanwhile, and says how good that is.
    #[arg(long, value_name = "TIME", value_parser = seconds, conflicts_with = "aa")]
    pub time: Option<f64>,
    /// Probability of keeping the error, for a pixel where it is bounded and not proved. [default: 0.999]
    #[arg(long, value_name = "P", value_parser = confidence, conflicts_with = "aa")]
    pub confidence: Option<f64>,
}

/// `--quality`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Quality {
    /// 16/255.
    Draft,
    /// 4/255.
    Good,
    /// 1/255.
    Fine,
}

impl Quality {
    /// The error that it names.
    pub fn max_error(self) -> f64 {
        match self {
            Quality::Draft => 16.0 / 255.0,
            Quality::Good => 4.0 / 255.0,
            Quality::Fine => 1.0 / 255.0,
        }
    }
}

impl AccuracyArgs {
    /// Puts what is asked for into `options`, which are the scene's, for a file of `format`. `asks_f32` says that the command
    /// line itself asks for 32 bits.
    ///
    /// # Errors
    /// Not all of it can be had together.
    pub fn apply(&self, options: &mut Options, format: Format, asks_f32: bool) -> Result<(), Stop> {
        let error = self.max_error.or(self.quality.map(|q| q.max_error()));
        let given = options.accuracy;
        // Either of them replaces both of the scene's.
        let (error, time) = match (error, self.time) {
            (None, None) => given.map_or((None, None), |a| (a.error, a.time)),
            given => given,
        };
        if error.is_none() && time.is_none() {
            return match self.confidence {
                None => Ok(()),
                Some(_) => {
                    let d = Diagnostic::error("`--confidence` is for pictures with a stated error");
                    Err(Stop::usage(d.note("say which: `--max-error 2/255`")))
                }
            };
        }
        if asks_f32 {
            let d = Diagnostic::error("a picture with a stated error needs 64 bits");
            return Err(Stop::usage(d.note("what 32 bits lose isn't known: leave out `--precision f32`")));
        }
        let confidence = self.confidence.or(given.map(|a| a.confidence)).unwrap_or(Accuracy::CONFIDENCE);
        options.accuracy = Some(Accuracy { error, time, confidence });
        options.precision = Precision::F64;
        options.quantum = match format {
            Format::Png(Depth::Eight, _) => 1.0 / 255.0,
            Format::Png(Depth::Sixteen, _) => 1.0 / 65_535.0,
            Format::Exr => 0.0,
            Format::Hdr => {
                let d = Diagnostic::error("an `.hdr` file can't keep a stated error");
                let note = "its colours share an exponent, which costs the darker channels their precision";
                return Err(Stop::usage(d.note(note).note("write a `.png` or an `.exr`")));
            }
        };
        match error {
            Some(error) if error <= 0.5 * options.quantum => {
                let d =
                    Diagnostic::error(format!("{} is less than this file's colours can tell apart", fraction(error)));
                let note = format!("rounding alone is up to {}", fraction(0.5 * options.quantum));
                Err(Stop::usage(d.note(note).note("`--bits 16` or an `.exr` file round less")))
            }
            _ => Ok(()),
        }
    }
}

/// An error in codes of 8 bits: `2/255`.
pub fn fraction(error: f64) -> String {
    let codes = error * 255.0;
    // Four digits, but none behind whole numbers: 2/255 isn't exactly two codes.
    let text = format!("{codes:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    match text {
        "0" => format!("{codes:.1e}/255"),
        text => format!("{text}/255"),
    }
}

/// `max error 2/255: 93.3 % proved, 6.5 % bounded at 99.9 %, 0.2 % estimated, 0 open`.
pub fn line(c: &Certificate) -> String {
    let s = &c.summary;
    let of = |n: usize| share(n, s.pixels());
    let bounded = match s.bounded {
        0 => "0 bounded".to_string(),
        n => format!("{} bounded at {} %", of(n), trimmed(100.0 * c.accuracy.confidence, 7)),
    };
    if s.open == s.pixels() {
        return "no error can be stated: the time was too short, and all pixels are open".into();
    }
    let (error, proved) = (fraction(c.reached / 255.0), of(s.proved));
    format!("max error {error}: {proved} proved, {bounded}, {} estimated, {} open", of(s.estimated), of(s.open))
}

/// So many of so many, in per cent; never rounded to none or to all.
fn share(n: usize, all: usize) -> String {
    let percent = 100.0 * n as f64 / all.max(1) as f64;
    match n {
        0 => "0".into(),
        n if n == all => "100 %".into(),
        _ if percent < 0.001 => "under 0.001 %".into(),
        // Downwards above a half, so that 99.96 isn't all.
        _ if percent > 50.0 => format!("{} %", trimmed((percent * 100.0).floor() / 100.0, 2)),
        _ => format!("{} %", trimmed(percent, 3)),
    }
}

/// With so many decimals, but no zeros at the end.
fn trimmed(x: f64, decimals: usize) -> String {
    let text = format!("{x:.decimals$}");
    text.trim_end_matches('0').trim_end_matches('.').to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Compression;
    use crate::render::certify::{Pixel, Status, Summary};
    use crate::scene::Settings;

    #[test]
    fn the_line_neither_hides_nor_rounds_away() {
        let mut pixels = vec![Pixel { status: Status::Proved, codes: 1.0, ..Pixel::unknown() }; 100_000];
        let certificate = |pixels: &[Pixel]| Certificate {
            accuracy: Accuracy { error: None, time: None, confidence: 0.999 },
            reached: 2.0,
            summary: Summary::of(pixels, 2.0),
            pixels: pixels.to_vec(),
        };
        let all = "max error 2/255: 100 % proved, 0 bounded, 0 estimated, 0 open";
        assert_eq!(line(&certificate(&pixels)), all);
        pixels[7].status = Status::Open;
        pixels[9].status = Status::Bounded;
        let some = "max error 2/255: 99.99 % proved, 0.001 % bounded at 99.9 %, 0 estimated, 0.001 % open";
        assert_eq!(line(&certificate(&pixels)), some);
        assert_eq!([2.0, 0.25, 16.0, 1e-4].map(|c| fraction(c / 255.0)), ["2/255", "0.25/255", "16/255", "1.0e-4/255"]);
    }

    #[test]
    fn the_command_line_replaces_the_scene() {
        let of_scene = Accuracy { error: Some(0.1), time: Some(3.0), confidence: 0.999 };
        let settings = Settings { accuracy: Some(of_scene), precision: Precision::F32, ..Settings::default() };
        let apply = |args: AccuracyArgs, format| {
            let mut options = Options::from_settings(&settings);
            args.apply(&mut options, format, false).map(|()| options)
        };
        let plain = apply(AccuracyArgs::default(), Format::PNG).unwrap();
        assert_eq!((plain.accuracy, plain.precision), (Some(of_scene), Precision::F64));
        let time = apply(AccuracyArgs { time: Some(1.0), ..AccuracyArgs::default() }, Format::Exr).unwrap();
        assert_eq!(time.accuracy, Some(Accuracy { error: None, time: Some(1.0), confidence: 0.999 }));
        assert_eq!(time.quantum, 0.0);
        let tight = || AccuracyArgs { max_error: Some(0.4 / 255.0), ..AccuracyArgs::default() };
        assert!(apply(tight(), Format::PNG).is_err() && apply(tight(), Format::Hdr).is_err());
        assert!(apply(tight(), Format::Png(Depth::Sixteen, Compression::Fast)).is_ok());
    }
}
