//! How soon an evaluation ends once it is cancelled: `cargo bench --bench cancel` prints the longest wait of each of some
//! programs that mean harm, cancelled at many moments. No thresholds; a busy machine adds its own waits.

use rtdsl::lang::{Input, Memory, Request, evaluate_again};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::{Duration, Instant};

/// Each is cancelled so many times, at even distances.
const MOMENTS: u32 = 24;

fn main() {
    let numbers = "1234.5, ".repeat(1_000_000);
    let programs: Vec<(&str, String, u64)> = vec![
        ("loop", "while true { }".into(), 200),
        ("calls", "fn f(n) = if n == 0 { 0 } else { f(n - 1) + f(n - 1) }\nlet a = f(60)".into(), 400),
        ("list, sum, sort", "let a = [for i in 0..9999999 { i }]\nlet b = a * 2 + a\nlet c = sort(b)".into(), 4000),
        ("map, reverse, shuffle", "let a = reverse(0..9999999) |> map(x => x)\nlet b = shuffle(a, 1)".into(), 4000),
        (
            "texts",
            "let a = join([for i in 0..100000 { \"{i}, {i}\" }])\nlet b = [for i in 0..200 { \"{a}\" }]".into(),
            300,
        ),
        ("scatter", "let a = scatter([0, 0, 0], [100, 100, 100], 0.01)".into(), 3000),
        ("shared lists", "var a = [1, 2]\nfor i in 0..60 { a = [a, a] }\nlet b = a * 2".into(), 2000),
        ("four million shapes", "for i in 0..3999000 { sphere(at: [i, 0, 0]) }".into(), 4000),
        (
            "eight million places",
            "fn d(s) = group { s; s |> move([1, 0, 0]) }\nvar g = sphere()\nfor i in 0..23 { g = d(g) }\ng".into(),
            2000,
        ),
        (
            "many statements",
            "let a = [1, 2 + 3]\nsphere(r: 2)\n".repeat(100_000).replace("let a", "box()\nlet a"),
            2000,
        ),
        ("one long statement", format!("let a = [{numbers}]"), 4000),
        ("many texts with mistakes", "let b = 2 +\n".repeat(300_000), 2000),
    ];
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    println!("{:<26} {:>10} {:>10}", "program", "longest ms", "median ms");
    for (name, text, milliseconds) in programs {
        if !wanted.is_empty() && !wanted.iter().any(|w| name.contains(w.as_str())) {
            continue;
        }
        let folder = std::path::PathBuf::from(".");
        let main = Input::Text { name: "text".into(), bytes: text.into_bytes(), folder };
        let request = Request { main, set: Vec::new(), allow_read: Vec::new(), record_arguments: false };
        let mut waits: Vec<f64> =
            (1..=MOMENTS).filter_map(|k| wait(&request, milliseconds * u64::from(k) / u64::from(MOMENTS))).collect();
        waits.sort_by(f64::total_cmp);
        let (Some(longest), Some(median)) = (waits.last(), waits.get(waits.len() / 2)) else { continue };
        println!("{name:<26} {longest:>10.1} {median:>10.1}");
    }
}

/// Milliseconds from the cancelling, so late, to the end; `None` where it ended before.
fn wait(request: &Request, after: u64) -> Option<f64> {
    let cancel = AtomicBool::new(false);
    let mut memory = Memory::default();
    let (set, ended) = std::thread::scope(|scope| {
        let set = scope.spawn(|| {
            std::thread::sleep(Duration::from_millis(after));
            cancel.store(true, Relaxed);
            Instant::now()
        });
        drop(evaluate_again(request, &mut memory, &cancel));
        let ended = Instant::now();
        (set.join(), ended)
    });
    ended.checked_duration_since(set.ok()?).map(|d| d.as_secs_f64() * 1e3)
}
