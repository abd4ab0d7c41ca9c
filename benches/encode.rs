//! What it costs to make a file of a picture, and a picture of a file: `cargo bench --bench encode` prints a line a step. No
//! thresholds; figures of one run compare only with each other, for machines drift.

use rtdsl::film::{Compression, Depth, Developer, Film, Format, Recipe, encode, read};
use std::hint::black_box;
use std::io::Cursor;
use std::path::Path;
use std::time::Instant;

/// Each step is repeated this often: its shortest time and its median are printed.
const RUNS: usize = 15;

/// Pixels of the picture.
const SIZE: (u32, u32) = (1280, 720);
/// Side of the tiles in which pixels come from the tracer.
const TILE: usize = 16;

fn main() {
    let film = picture();
    let tiles: Vec<Vec<[f32; 3]>> = tiles(&film);
    println!("a picture of {} x {}\n{:<28} {:>9} {:>9} {:>10}", SIZE.0, SIZE.1, "", "least ms", "median ms", "bytes");
    for depth in [Depth::Eight, Depth::Sixteen] {
        let developer = Developer::of(depth);
        let mut codes = Vec::new();
        step(&format!("develop, {} bits", 8 * depth.bytes()), || {
            for tile in &tiles {
                codes.clear();
                developer.develop(tile, &mut codes);
                black_box(&codes);
            }
            film.pixels.len() * 3 * depth.bytes()
        });
    }
    let png = |depth, compression| Format::Png(depth, compression);
    for (name, format) in [
        ("PNG, 8 bits, fast", png(Depth::Eight, Compression::Fast)),
        ("PNG, 8 bits, small", png(Depth::Eight, Compression::Small)),
        ("PNG, 16 bits, fast", png(Depth::Sixteen, Compression::Fast)),
        ("PNG, 16 bits, small", png(Depth::Sixteen, Compression::Small)),
        ("OpenEXR", Format::Exr),
        ("Radiance", Format::Hdr),
    ] {
        step(name, || {
            let mut file = Cursor::new(Vec::new());
            match encode(&film, format, &Recipe::new(), &mut file) {
                Ok(()) => black_box(file).into_inner().len(),
                Err(_) => 0,
            }
        });
    }
    let earth = std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/assets/earth.png"));
    if let Ok(file) = earth {
        step("reading assets/earth.png", || {
            read(file.clone(), |_, _| true).map_or(0, |picture| 3 * picture.texels.count())
        });
    }
    step("the hash", || film.hash().len());
}

/// Half of it one color, the rest as uneven as pictures are: a checked floor with distance, and soft spots.
fn picture() -> Film {
    let (width, height) = (SIZE.0 as usize, SIZE.1 as usize);
    let mut film = Film::new(SIZE.0, SIZE.1);
    for (i, pixel) in film.pixels.iter_mut().enumerate() {
        let (x, y) = ((i % width) as f32 / width as f32 - 0.5, (i / width) as f32 / height as f32 - 0.5);
        *pixel = [0.45, 0.6, 0.8];
        if y > 0.0 {
            let (across, away) = (x / y, 1.0 / y);
            let light = if (across.floor() as i32 + away.floor() as i32) % 2 == 0 { 0.8 } else { 0.3 };
            *pixel = [light * (1.0 - x * x), light * (0.9 - y * y), light * (0.85 + 0.1 * x)];
        }
        let spot = 0.04 - (x - 0.1) * (x - 0.1) - y * y;
        if spot > 0.0 {
            *pixel = [0.1 + 20.0 * spot, 0.1 + 5.0 * spot, 0.3 + 9.0 * spot * spot];
        }
    }
    film
}

/// The pixels of each tile.
fn tiles(film: &Film) -> Vec<Vec<[f32; 3]>> {
    let width = film.width as usize;
    let band = |rows: &[[f32; 3]]| -> Vec<Vec<[f32; 3]>> {
        let row = |x: usize| rows.chunks(width).flat_map(move |row| &row[x..x + TILE]).copied().collect();
        (0..width / TILE).map(|x| row(x * TILE)).collect()
    };
    film.pixels.chunks(width * TILE).flat_map(band).collect()
}

/// Does `work`, which tells how many bytes it made, again and again, and prints what it took.
fn step(name: &str, mut work: impl FnMut() -> usize) {
    let mut bytes = 0;
    let mut times: Vec<f64> = (0..RUNS)
        .map(|_| {
            let start = Instant::now();
            bytes = work();
            start.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    times.sort_by(f64::total_cmp);
    println!("{name:<28} {:>9.3} {:>9.3} {bytes:>10}", times[0], times[RUNS / 2]);
}
