//! Whether a picture is what it was, and where not.

use super::mark::entries;
use crate::film::{Recipe, read};
use crate::scene::range::MOST_PIXELS;
use std::io::{self, Cursor};

/// How a committed picture and a new one differ.
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    /// What is there can't be read as a picture.
    Unreadable,
    /// They have other sizes: was, is.
    Size([u32; 2], [u32; 2]),
    /// Every pixel is the same; the recipe or the form of the file isn't. The entries of the recipe that differ.
    Recipe(Vec<String>),
    /// Pixels differ.
    Pixels(Numbers),
}

/// By how much pixels differ. A code is one of the 256 steps of a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Numbers {
    /// Pixels that differ.
    pub differing: u64,
    /// All pixels.
    pub all: u64,
    /// The largest difference of a channel, in codes.
    pub largest: u8,
    /// The root of the mean square of all channels' differences, in codes.
    pub rmse: f64,
}

/// How the picture files `was` and `is` differ, and both as panels beside each other, with their difference where they have
/// the same size. `None` if they don't.
pub fn compare(was: &[u8], is: &[u8]) -> Option<(Difference, Option<Panels>)> {
    if was == is {
        return None;
    }
    let (Some(old), Some(new)) = (decoded(was), decoded(is)) else { return Some((Difference::Unreadable, None)) };
    let size = |p: &Picture| [p.width, p.height];
    if size(&old) != size(&new) {
        let panels = Panels::of(&[&old, &new], "was, is");
        return Some((Difference::Size(size(&old), size(&new)), Some(panels)));
    }
    let numbers = numbers(&old, &new);
    if numbers.differing == 0 {
        return Some((Difference::Recipe(changed_entries(was, is)), None));
    }
    let factor = u8::MAX / numbers.largest;
    let off = |(a, b): (&[u8; 3], &[u8; 3])| std::array::from_fn(|c| a[c].abs_diff(b[c]) * factor);
    let texels = old.texels.iter().zip(new.texels.iter()).map(off).collect();
    let difference = Picture { texels, ..new };
    let panels = Panels::of(&[&old, &new, &difference], &format!("was, is, difference x {factor}"));
    Some((Difference::Pixels(numbers), Some(panels)))
}

/// The picture file `is` as the only panel; `None` if it isn't one.
pub fn alone(is: &[u8]) -> Option<Panels> {
    decoded(is).map(|new| Panels::of(&[&new], "is"))
}

/// A picture whose texels are compared.
struct Picture {
    width: u32,
    height: u32,
    texels: Vec<[u8; 3]>,
}

/// The picture in a file, as large as any that this program makes.
fn decoded(file: &[u8]) -> Option<Picture> {
    let may_be = |width: u32, height: u32| u64::from(width) * u64::from(height) <= MOST_PIXELS;
    let picture = read(file.to_vec(), may_be).ok()?;
    Some(Picture { width: picture.width, height: picture.height, texels: picture.texels.into_colors() })
}

fn numbers(old: &Picture, new: &Picture) -> Numbers {
    let (mut differing, mut largest, mut squares) = (0, 0, 0u64);
    for (a, b) in old.texels.iter().zip(new.texels.iter()) {
        let off = [0, 1, 2].map(|c| a[c].abs_diff(b[c]));
        differing += u64::from(off != [0; 3]);
        largest = off.into_iter().fold(largest, u8::max);
        squares += off.iter().map(|&d| d as u64 * d as u64).sum::<u64>();
    }
    let all = old.texels.len() as u64;
    Numbers { differing, all, largest, rmse: (squares as f64 / (3 * all) as f64).sqrt() }
}

/// The names of the recipe's entries that aren't the same.
fn changed_entries(was: &[u8], is: &[u8]) -> Vec<String> {
    let (was, is) = (entries(Cursor::new(was)), entries(Cursor::new(is)));
    let mut names: Vec<String> = was.iter().chain(&is).map(|(name, _)| name.clone()).collect();
    names.sort();
    names.dedup();
    names.retain(|n| was.iter().find(|e| e.0 == *n) != is.iter().find(|e| e.0 == *n));
    names
}

/// Pictures beside each other.
#[derive(Clone, Debug)]
pub struct Panels {
    width: u32,
    height: u32,
    pixels: Vec<[u8; 3]>,
    /// What they are, from left to right.
    pub legend: String,
}

/// Pixels between panels, and their gray: enough to see where one ends.
const GAP: u32 = 8;
const GAP_GRAY: u8 = 128;

/// The entry of a panel picture that tells what it is, and tells it apart from pictures of scenes.
const LEGEND: &str = "rtdsl:panels";

impl Panels {
    fn of(pictures: &[&Picture], legend: &str) -> Panels {
        let width: u32 = pictures.iter().map(|p| p.width + GAP).sum::<u32>() - GAP;
        let height = pictures.iter().map(|p| p.height).max().unwrap_or(0);
        let mut pixels = vec![[GAP_GRAY; 3]; width as usize * height as usize];
        let mut x = 0;
        for p in pictures {
            let across = p.width as usize;
            for (row, texels) in pixels.chunks_exact_mut(width as usize).zip(p.texels.chunks_exact(across)) {
                row[x..x + across].copy_from_slice(texels);
            }
            x += across + GAP as usize;
        }
        Panels { width, height, pixels, legend: legend.to_string() }
    }

    /// The PNG file.
    ///
    /// # Errors
    /// Those of the encoder.
    pub fn file(&self) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        for (name, value) in Recipe::new().with(LEGEND, &self.legend).entries() {
            encoder.add_text_chunk(name.into(), value.into())?;
        }
        encoder.write_header()?.write_image_data(self.pixels.as_flattened())?;
        Ok(bytes)
    }
}

/// Whether a file is a panel picture.
pub fn is_panels(file: &[u8]) -> bool {
    entries(Cursor::new(file)).iter().any(|(name, _)| name == LEGEND)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::gallery::maker::png;
    use crate::film::Film;

    fn file(width: u32, value: f32, recipe: &str) -> Vec<u8> {
        let mut film = Film::new(width, 2);
        film.pixels[0] = [value, 1.0, 0.0];
        png(&film, &Recipe::new().with("rtdsl:scene", recipe)).unwrap()
    }

    #[test]
    fn every_kind_of_difference() {
        let of = |was: &[u8], is: &[u8]| compare(was, is).map(|(d, _)| d);
        let white = file(4, 1.0, "a");
        assert_eq!(of(&white, &white), None);
        assert_eq!(of(&white, &file(4, 1.0, "b")), Some(Difference::Recipe(vec!["rtdsl:scene".into()])));
        assert_eq!(of(&white, &file(3, 1.0, "a")), Some(Difference::Size([4, 2], [3, 2])));
        assert_eq!(of(b"PNG", &white), Some(Difference::Unreadable));
        // 0.5 of linear light is code 188: 67 less than white, in one of 24 channels.
        let rmse = (67.0f64 * 67.0 / 24.0).sqrt();
        let expected = Numbers { differing: 1, all: 8, largest: 67, rmse };
        assert_eq!(of(&white, &file(4, 0.5, "a")), Some(Difference::Pixels(expected)));
    }

    #[test]
    fn panels_show_all_three() {
        let (_, panels) = compare(&file(4, 1.0, "a"), &file(4, 0.5, "a")).unwrap();
        let panels = panels.unwrap();
        assert_eq!(panels.legend, "was, is, difference x 3");
        let file = panels.file().unwrap();
        assert!(is_panels(&file) && !is_panels(&super::tests::file(4, 1.0, "a")));
        let picture = decoded(&file).unwrap();
        assert_eq!((picture.width, picture.height), (3 * 4 + 2 * GAP, 2));
        let at = |x: u32| picture.texels[x as usize];
        assert_eq!(
            [at(0), at(4), at(4 + GAP), at(2 * (4 + GAP))],
            [[255, 255, 0], [GAP_GRAY; 3], [188, 255, 0], [67 * 3, 0, 0]]
        );
    }
}
