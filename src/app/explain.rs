//! `rtdsl explain`: what the renderer does for a scene and which line made it, or what one pixel sees.

use super::args::ExplainArgs;
use super::load::{load, request, shown_name};
use super::sight::Sight;
use super::{Exit, Stop};
use crate::diag::{Diagnostic, Sources};
use crate::render::{self, Feature, Options, World};
use crate::scene::{AntiAliasing, Camera, PixelFilter};
use std::fmt::Write as _;
use std::io::{self, Write as _};

/// Runs the command.
///
/// # Errors
/// The scene is wrong or can't be read, the pixel lies outside, or standard output fails.
pub fn run(args: &ExplainArgs) -> Result<Exit, Stop> {
    let mut request = request(&args.scene.file, &args.scene.set, &args.scene.allow_read)?;
    request.record_arguments = args.pixel.is_some();
    let evaluated = load(&request, false)?;
    let camera = args.view.camera(&evaluated.scene)?;
    let options = args.view.options(&evaluated.scene);
    if let Some((x, y)) = args.pixel
        && (x >= options.width || y >= options.height)
    {
        let d = Diagnostic::error(format!("the pixel {x},{y} lies outside the picture"));
        let (right, bottom) = (options.width - 1, options.height - 1);
        return Err(Stop::usage(d.note(format!("its columns are 0 to {right}, its rows 0 to {bottom}"))));
    }
    let world = World::build(&evaluated.scene, camera);
    let text = match args.pixel {
        None => {
            let head = heading(&shown_name(&args.scene.file), camera, &options);
            head + &features(&world.features(&evaluated.scene), world.memory_bytes(), &evaluated.sources)
        }
        Some((x, y)) => match render::probe(&world, &options, x, y) {
            None => format!("pixel {x},{y} sees the background\n"),
            Some(probe) => format!("pixel {x},{y} sees {}", Sight::new(&probe, &evaluated).text()),
        },
    };
    io::stdout().write_all(text.as_bytes())?;
    Ok(Exit::Done)
}

fn heading(name: &str, camera: &Camera, options: &Options) -> String {
    let camera = camera.name.as_ref().map_or(String::new(), |n| format!(", camera `{n}`"));
    let rays = match options.aa {
        AntiAliasing::Adaptive(n) => format!("1 to {n} rays a pixel"),
        aa if aa.side() == 1 => "1 ray a pixel".to_string(),
        aa => format!("{} rays a pixel", aa.side() * aa.side()),
    };
    let rays = match options.filter {
        // One ray a pixel is shown as it is.
        filter if filter == PixelFilter::Box || options.takes_one_ray() => rays,
        filter => format!("{rays}, filter {}", filter.name()),
    };
    let instructions = render::instructions(options.instructions);
    let at_a_time = match render::rays_at_a_time(options.instructions, options.precision) {
        1 => "one ray at a time".to_string(),
        n => format!("{n} rays at a time"),
    };
    let size = (options.width, options.height);
    format!("{name}: {}x{}, {rays}{camera}\ntraced {at_a_time}, with {instructions} instructions\n", size.0, size.1)
}

/// The features in use with the lines that forced them, then the others.
fn features(all: &[Feature], memory_bytes: usize, sources: &Sources) -> String {
    let width = all.iter().map(|f| f.name.chars().count()).max().unwrap_or(0);
    let mut text = String::new();
    for (title, in_use) in [("Required by this scene", true), ("Not required, so not done", false)] {
        let mut rows = all.iter().filter(|f| f.in_use == in_use).peekable();
        if rows.peek().is_some() {
            let _ = writeln!(text, "\n{title}");
        }
        for f in rows {
            let mut row = format!("  {:<width$}  ", f.name);
            if let Some(place) = &f.required_by {
                let _ = write!(row, "{}: ", sources.location(place.span));
            }
            let _ = writeln!(text, "{}", (row + &f.detail).trim_end());
        }
    }
    let _ = writeln!(text, "\n{:.1} kB held for tracing", memory_bytes as f64 / 1e3);
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diag::{Place, Source, Span};

    #[test]
    fn features_in_two_lists() {
        let mut sources = Sources::new();
        let text = "light(at: [1, 2, 3])\n";
        let file = sources.add(Source { name: "a.scene".into(), path: None, text: text.into() });
        let place = Place::new(Span::new(file, 0..20));
        let feature = |name, place: Option<&Place>, in_use, detail: &str| Feature {
            name,
            required_by: place.cloned(),
            in_use,
            detail: detail.into(),
        };
        let all = [
            feature("reflection", None, false, "no mirrored rays"),
            feature("shadows", Some(&place), true, "one ray a light"),
        ];
        let expected = "
Required by this scene
  shadows     a.scene:1:1: one ray a light

Not required, so not done
  reflection  no mirrored rays

2.5 kB held for tracing
";
        assert_eq!(features(&all, 2500, &sources), expected);
    }
}
