//! What every command does that makes a picture: `render`, `watch` and `gallery` give the same bytes because they share this.

use super::Stop;
use super::accuracy;
use super::args::ViewArgs;
use super::view::settings_line;
use crate::diag::Diagnostic;
use crate::film::{Compression, Depth, Format, Recipe, recipe};
use crate::lang::Evaluated;
use crate::render::certify::Certificate;
use crate::render::{Options, World};
use crate::scene::{Camera, Precision};
use std::path::Path;

/// The form of a picture file, by its name; `png` for the one that ends in `.png`.
///
/// # Errors
/// The name's ending is no picture's, or what `png` asks for isn't for this form.
pub fn format_of(path: &Path, png: (Depth, Compression)) -> Result<Format, Stop> {
    let png = Format::Png(png.0, png.1);
    let Some(format) = Format::from_path(path, png) else {
        let d = Diagnostic::error(format!("what kind of picture shall `{}` be?", path.display()));
        return Err(Stop::usage(d.note("its name must end in `.png`, `.exr` or `.hdr`")));
    };
    if format != png && png != Format::PNG {
        let option = if matches!(png, Format::Png(Depth::Sixteen, _)) { "--bits" } else { "--compression" };
        let d = Diagnostic::error(format!("`{option}` is for `.png` files"));
        return Err(Stop::usage(d.note("`.exr` and `.hdr` hold linear light in a form of their own")));
    }
    Ok(format)
}

/// Which camera looks at the scene, and how its picture is traced.
///
/// # Errors
/// The scene has no camera of that name.
pub fn look<'e>(evaluated: &'e Evaluated, view: &ViewArgs) -> Result<(&'e Camera, Options), Stop> {
    let camera = view.camera(&evaluated.scene)?;
    Ok((camera, view.options(&evaluated.scene)))
}

/// Whether the arithmetic asked for can hold the world.
///
/// # Errors
/// It is to be traced in 32 bits, and a shape's size or place is beyond them.
pub fn fits(world: &World, evaluated: &Evaluated, options: &Options) -> Result<(), Stop> {
    if options.precision == Precision::F32
        && let Some(node) = world.beyond_f32()
    {
        let place = evaluated.scene.node(node).place.clone();
        let d = Diagnostic::error("this shape is too large, too small or too far away for 32-bit numbers")
            .at(place.span, "leave out `precision: \"f32\"` or `--precision f32`")
            .note("with 32 bits, sizes and distances from the camera are 0 or from 1e-18 to 1e18")
            .from_place(place);
        return Err(Stop::scene(d, &evaluated.sources));
    }
    Ok(())
}

/// What the picture is made from and how good it is, as it is written into it.
pub fn recipe_of(
    evaluated: &Evaluated,
    options: &Options,
    camera: &Camera,
    certificate: Option<&Certificate>,
) -> Recipe {
    let recipe = Recipe::new()
        .with("rtdsl:scene", recipe::scene_digest(&evaluated.sources))
        .with("rtdsl:settings", settings_line(options, camera))
        .with("rtdsl:parameters", parameters_line(evaluated));
    with_accuracy(recipe, certificate)
}

/// Adds what can be said of the picture's error, where that was asked for.
pub fn with_accuracy(recipe: Recipe, certificate: Option<&Certificate>) -> Recipe {
    match certificate {
        Some(c) => recipe.with("rtdsl:accuracy", accuracy::line(c)),
        None => recipe,
    }
}

/// Every parameter's value, as `--set` takes it.
fn parameters_line(evaluated: &Evaluated) -> String {
    let values: Vec<String> = evaluated.params.iter().map(|p| format!("{}={}", p.name, p.value)).collect();
    values.join("; ")
}
