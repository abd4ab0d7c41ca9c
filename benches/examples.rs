//! What the examples cost: `cargo bench` prints a line a scene. No thresholds; figures of one run compare only with each
//! other, for machines drift.

use rtdsl::lang::{Input, Request, evaluate};
use rtdsl::render::{Options, Silent, World, render};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// Each phase is repeated this often and its shortest time kept.
const RUNS: u32 = 5;

/// The shortest of several runs, in milliseconds, and the last result.
fn shortest<T>(mut work: impl FnMut() -> T) -> (f64, T) {
    let mut timed = || {
        let start = Instant::now();
        let value = work();
        (start.elapsed().as_secs_f64() * 1e3, value)
    };
    (1..RUNS).fold(timed(), |best, _| {
        let next = timed();
        if next.0 < best.0 { next } else { (best.0, next.1) }
    })
}

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let mut scenes: Vec<_> = std::fs::read_dir(&folder).into_iter().flatten().flatten().map(|e| e.path()).collect();
    scenes.retain(|p| p.extension().is_some_and(|e| e == "scene"));
    scenes.sort();
    println!("{:<12} {:>9} {:>9} {:>9} {:>10} {:>9}", "scene", "text ms", "world ms", "trace ms", "rays", "ns a ray");
    for path in scenes {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if !wanted.is_empty() && !wanted.contains(&name) {
            continue;
        }
        let main = Input::File(path);
        let request = Request { main, set: Vec::new(), allow_read: Vec::new(), record_arguments: false };
        let (text, Ok(evaluated)) = shortest(|| evaluate(&request)) else {
            println!("{name:<12} is wrong");
            continue;
        };
        let (prepare, world) = shortest(|| World::build(&evaluated.scene, &evaluated.scene.cameras[0]));
        // One thread, one ray a pixel, a fifth of a megapixel: the cost of rays, not of spreading them.
        let settings = Options::from_settings(&evaluated.scene.settings);
        let height = 540 * settings.height / settings.width.max(settings.height);
        let aa = rtdsl::scene::AntiAliasing::Off;
        let options = Options { width: 540, height: height.max(1), aa, threads: Some(1), ..settings };
        let (trace, Some(done)) = shortest(|| render(&world, &options, &Silent, &AtomicBool::new(false))) else {
            continue;
        };
        let r = done.rays;
        let rays = r.camera + r.shadow + r.reflected + r.transmitted;
        println!(
            "{name:<12} {text:>9.2} {prepare:>9.2} {trace:>9.1} {rays:>10} {:>9.0}",
            trace * 1e6 / rays.max(1) as f64
        );
    }
}
