//! What a picture took: `--stats`.

use super::accuracy;
use super::args::StatsForm;
use crate::render::certify::Certificate;
use crate::render::{Crop, RayCounts};
use serde::Serialize;

/// The measurements of one run; field names are those of the JSON form.
#[derive(Clone, Debug, Serialize)]
pub struct Stats {
    /// Width and height of the picture that was made, in pixels.
    pub size: [u32; 2],
    /// Threads that traced.
    pub threads: usize,
    /// `"f64"` or `"f32"`.
    pub precision: &'static str,
    /// `"box"`, `"mitchell"` or `"gauss"`.
    pub filter: &'static str,
    /// Camera rays a pixel; with a stated error, on average.
    pub samples_per_pixel: f64,
    /// What can be said of the picture's error, where that was asked for.
    pub accuracy: Option<AccuracyStats>,
    /// Rays traced.
    pub rays: Rays,
    /// Wall-clock seconds.
    pub seconds: Seconds,
    /// Most memory that the process ever held, in bytes; `None` where the system doesn't tell.
    pub peak_memory_bytes: Option<u64>,
    /// Abilities of the renderer that the scene required.
    pub features: Vec<&'static str>,
    /// [`Film::hash`](crate::film::Film::hash): the same for the same picture everywhere.
    pub image_hash: String,
}

/// How good a picture is.
#[derive(Clone, Debug, Serialize)]
pub struct AccuracyStats {
    /// All of it in one line.
    pub line: String,
    /// The error asked for, as a share of white; `None` for the least that the time allows.
    pub asked_error: Option<f64>,
    /// Seconds that were allowed.
    pub asked_time: Option<f64>,
    /// Probability with which a bounded pixel keeps the error.
    pub confidence: f64,
    /// The error that all pixels but open ones keep, as a share of white.
    pub reached: f64,
    /// Pixels that keep it for certain.
    pub proved: usize,
    /// Pixels that keep it with that probability.
    pub bounded: usize,
    /// Pixels that keep it as far as samples tell.
    pub estimated: usize,
    /// Pixels that don't, or of which it isn't known.
    pub open: usize,
    /// The largest error that any pixel but an open one may have, as a share of white.
    pub worst: f64,
    /// Where that is: column and row of the picture.
    pub worst_pixel: Option<[u32; 2]>,
    /// The largest error that an open pixel may have, as far as anything is known of it; as a share of white.
    pub worst_open: Option<f64>,
    /// Regions of the picture that were bounded.
    pub evaluations: u64,
    /// Rays from the camera.
    pub samples: u64,
}

impl AccuracyStats {
    /// What `c` says of a picture of which `part` was made.
    pub fn of(c: &Certificate, part: &Crop) -> AccuracyStats {
        let s = &c.summary;
        let worst = s.worst.iter().flatten().max_by(|a, b| a.codes.total_cmp(&b.codes));
        let place = |at: usize| [part.x + at as u32 % part.width, part.y + at as u32 / part.width];
        let open = c.pixels.iter().filter(|p| !p.keeps(c.reached)).map(|p| p.codes / 255.0).max_by(f64::total_cmp);
        // Of what nothing is known may be as far off as black is from white.
        let worst_open = if c.pixels.is_empty() && s.open > 0 { Some(1.0) } else { open };
        AccuracyStats {
            line: accuracy::line(c),
            asked_error: c.accuracy.error,
            asked_time: c.accuracy.time,
            confidence: c.accuracy.confidence,
            reached: c.reached / 255.0,
            proved: s.proved,
            bounded: s.bounded,
            estimated: s.estimated,
            open: s.open,
            worst: s.worst_codes() / 255.0,
            worst_pixel: worst.map(|w| place(w.at)),
            worst_open,
            evaluations: c.summary.evaluations,
            samples: c.summary.samples,
        }
    }
}

/// Rays by kind.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Rays {
    /// From the camera.
    pub camera: u64,
    /// Towards lights.
    pub shadow: u64,
    /// Mirrored.
    pub reflected: u64,
    /// Gone through a surface.
    pub transmitted: u64,
    /// All of them.
    pub total: u64,
}

/// Seconds by phase.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Seconds {
    /// Text to syntax.
    pub parse: f64,
    /// Syntax to scene, images included.
    pub evaluate: f64,
    /// Scene to world.
    pub world: f64,
    /// World to pixels; those of a PNG are encoded meanwhile.
    pub render: f64,
    /// What is left to do for the file.
    pub encode: f64,
    /// From the start of the command to its end.
    pub total: f64,
}

impl From<RayCounts> for Rays {
    fn from(r: RayCounts) -> Rays {
        let total = r.camera + r.shadow + r.reflected + r.transmitted;
        Rays { camera: r.camera, shadow: r.shadow, reflected: r.reflected, transmitted: r.transmitted, total }
    }
}

impl Stats {
    /// The report, ending in a newline.
    pub fn print(&self, form: StatsForm) -> String {
        match form {
            // Numbers, texts and lists always have a JSON form.
            StatsForm::Json => serde_json::to_string(self).unwrap_or_default() + "\n",
            StatsForm::Text => self.text(),
        }
    }

    fn text(&self) -> String {
        let [w, h] = self.size;
        let (r, s) = (&self.rays, &self.seconds);
        let lines = [
            ("size", format!("{w}x{h}")),
            ("threads", self.threads.to_string()),
            ("precision", self.precision.to_string()),
            ("filter", self.filter.to_string()),
            ("samples per pixel", self.samples_per_pixel.to_string()),
            ("accuracy", self.accuracy.as_ref().map_or("not asked for".into(), |a| a.line.clone())),
            (
                "rays",
                format!(
                    "{}: {} camera, {} shadow, {} reflected, {} transmitted",
                    r.total, r.camera, r.shadow, r.reflected, r.transmitted
                ),
            ),
            (
                "seconds",
                format!(
                    "{:.4}: {:.4} parse, {:.4} evaluate, {:.4} world, {:.4} render, {:.4} encode",
                    s.total, s.parse, s.evaluate, s.world, s.render, s.encode
                ),
            ),
            ("peak memory", self.peak_memory_bytes.map_or("unknown".into(), |b| format!("{:.1} MB", b as f64 / 1e6))),
            ("features", if self.features.is_empty() { "none".into() } else { self.features.join(", ") }),
            ("image hash", self.image_hash.clone()),
        ];
        lines.map(|(name, value)| format!("{name:<18} {value}\n")).concat()
    }
}

/// The kernel's high-water mark of this process; `None` where there is no `/proc`.
pub fn peak_memory_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms_tell_everything() {
        let stats = Stats {
            size: [4, 3],
            threads: 2,
            precision: "f64",
            filter: "box",
            samples_per_pixel: 4.0,
            accuracy: None,
            rays: RayCounts { camera: 48, shadow: 10, reflected: 2, transmitted: 1 }.into(),
            seconds: Seconds { total: 0.5, ..Seconds::default() },
            peak_memory_bytes: None,
            features: vec!["shadows", "reflection"],
            image_hash: "abc".into(),
        };
        let json: serde_json::Value = serde_json::from_str(&stats.print(StatsForm::Json)).unwrap();
        assert_eq!(json["size"], serde_json::json!([4, 3]));
        assert_eq!(json["rays"]["total"], 61);
        assert_eq!(json["peak_memory_bytes"], serde_json::Value::Null);
        let text = stats.print(StatsForm::Text);
        assert!(text.starts_with("size               4x3\nthreads            2\n"), "{text}");
        assert!(text.contains("features           shadows, reflection\n"));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn memory_is_known_on_linux() {
        assert!(peak_memory_bytes().unwrap() > 1 << 20, "at least the program itself");
    }
}
