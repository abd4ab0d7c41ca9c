//! The scene's settings with the command line's changes: which camera, what size, how many rays.

use super::Stop;
use super::args::ViewArgs;
use crate::diag::Diagnostic;
use crate::render::{Crop, Options};
use crate::scene::{Accuracy, AntiAliasing, Camera, PixelFilter, Precision, Scene};

impl ViewArgs {
    /// How to trace `scene`.
    pub fn options(&self, scene: &Scene) -> Options {
        let mut options = Options::from_settings(&scene.settings);
        (options.width, options.height) = self.size.unwrap_or((options.width, options.height));
        if let Some(aa) = self.aa {
            // So many rays, whatever the scene wants them to achieve.
            (options.aa, options.accuracy) = (aa, None);
        }
        options.filter = self.filter.unwrap_or(options.filter);
        options.max_depth = self.max_depth.unwrap_or(options.max_depth);
        options.precision = self.precision.unwrap_or(options.precision);
        options
    }

    /// The camera asked for, or the first.
    ///
    /// # Errors
    /// There is none of that name.
    pub fn camera<'a>(&self, scene: &'a Scene) -> Result<&'a Camera, Stop> {
        let found = match &self.camera {
            None => scene.cameras.first(),
            Some(name) => scene.cameras.iter().find(|c| c.name.as_ref() == Some(name)),
        };
        found.ok_or_else(|| {
            let wanted = self.camera.as_deref().unwrap_or_default();
            let names: Vec<&str> = scene.cameras.iter().filter_map(|c| c.name.as_deref()).collect();
            let mut d = Diagnostic::error(format!("the scene has no camera `{wanted}`"));
            if let Some(near) = nearest(wanted, &names) {
                d = d.note(format!("did you mean `{near}`?"));
            }
            Stop::usage(d.note(match names.as_slice() {
                [] => "none of its cameras has a name".to_string(),
                names => format!("it has: {}", names.join(", ")),
            }))
        })
    }
}

/// `crop`, which must lie within the picture.
///
/// # Errors
/// It sticks out.
pub fn checked_crop(crop: Option<Crop>, options: &Options) -> Result<Option<Crop>, Stop> {
    let inside = |c: &Crop| {
        c.x as u64 + c.width as u64 <= options.width as u64 && c.y as u64 + c.height as u64 <= options.height as u64
    };
    match crop {
        Some(c) if !inside(&c) => {
            let d = Diagnostic::error(format!(
                "the part {},{},{},{} lies outside the picture",
                c.x, c.y, c.width, c.height
            ));
            Err(Stop::usage(d.note(format!("the picture is {}x{} pixels", options.width, options.height))))
        }
        crop => Ok(crop),
    }
}

/// The settings on one line, as a picture's recipe has them.
pub fn settings_line(options: &Options, camera: &Camera) -> String {
    let mut line = format!("size={}x{}", options.width, options.height);
    match &options.accuracy {
        None => line += &format!(" aa={}", aa_word(options.aa)),
        Some(Accuracy { error, time, confidence }) => {
            if let Some(error) = error {
                line += &format!(" max-error={error}");
            }
            if let Some(time) = time {
                line += &format!(" time={time}s");
            }
            line += &format!(" confidence={confidence}");
        }
    }
    if options.filter != PixelFilter::Box {
        line += &format!(" filter={}", options.filter.name());
    }
    line += &format!(" max-depth={} precision={}", options.max_depth, precision_word(options.precision));
    if let Some(name) = &camera.name {
        line += &format!(" camera={name}");
    }
    if let Some(c) = options.crop {
        line += &format!(" crop={},{},{},{}", c.x, c.y, c.width, c.height);
    }
    line
}

/// `off`, `grid:N` or `adaptive:N`.
pub fn aa_word(aa: AntiAliasing) -> String {
    match aa {
        AntiAliasing::Off => "off".to_string(),
        AntiAliasing::Grid(n) => format!("grid:{n}"),
        AntiAliasing::Adaptive(n) => format!("adaptive:{n}"),
    }
}

/// `f64` or `f32`.
pub fn precision_word(p: Precision) -> &'static str {
    match p {
        Precision::F64 => "f64",
        Precision::F32 => "f32",
    }
}

/// The word that `wanted` was probably meant to be: the one with the fewest letters wrong, a third of them at most.
pub fn nearest<'a>(wanted: &str, words: &[&'a str]) -> Option<&'a str> {
    let most = (wanted.chars().count() / 3).max(1);
    let near = words.iter().map(|w| (strsim::damerau_levenshtein(wanted, w), *w));
    near.filter(|(wrong, _)| *wrong <= most).min().map(|(_, w)| w)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Exit;

    const NONE: ViewArgs =
        ViewArgs { size: None, aa: None, filter: None, max_depth: None, camera: None, precision: None };

    #[test]
    fn the_command_line_wins() {
        let scene = Scene::empty();
        assert_eq!(NONE.options(&scene), Options::from_settings(&scene.settings));
        let args = ViewArgs { size: Some((3, 2)), aa: Some(AntiAliasing::Grid(4)), max_depth: Some(0), ..NONE };
        let options = args.options(&scene);
        assert_eq!((options.width, options.height, options.max_depth), (3, 2, 0));
        let line = settings_line(&options, &scene.cameras[0]);
        assert_eq!(line, "size=3x2 aa=grid:4 max-depth=0 precision=f64");
        let sharp = ViewArgs { filter: Some(PixelFilter::Mitchell), ..args }.options(&scene);
        let line = settings_line(&sharp, &scene.cameras[0]);
        assert_eq!(line, "size=3x2 aa=grid:4 filter=mitchell max-depth=0 precision=f64");
    }

    #[test]
    fn cameras_have_names() {
        let mut scene = Scene::empty();
        scene.cameras.push(Camera { name: Some("top".into()), ..Camera::default() });
        let named = |n: &str| ViewArgs { camera: Some(n.into()), ..NONE };
        assert_eq!(NONE.camera(&scene).unwrap().name, None);
        assert_eq!(named("top").camera(&scene).unwrap().name.as_deref(), Some("top"));
        assert_eq!(named("tpo").camera(&scene).unwrap_err().exit, Exit::Usage);
        assert_eq!(nearest("tpo", &["bottom", "top"]), Some("top"));
        assert_eq!(nearest("left", &["bottom", "top"]), None);
    }

    #[test]
    fn crops_stay_inside() {
        let options = Options { width: 10, height: 8, ..NONE.options(&Scene::empty()) };
        let crop = |x, y, width, height| Some(Crop { x, y, width, height });
        assert!(checked_crop(None, &options).is_ok());
        assert!(checked_crop(crop(9, 7, 1, 1), &options).is_ok());
        assert!(checked_crop(crop(9, 7, 2, 1), &options).is_err());
        assert!(checked_crop(crop(1, 0, u32::MAX, 1), &options).is_err());
    }
}
