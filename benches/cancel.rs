//! How soon an evaluation ends once it is cancelled: `cargo bench --bench cancel` prints the longest waits of some
//! programs that mean harm, cancelled at many moments: until it is given up, and until its thread is over and the next
//! one done. No thresholds; a busy machine adds its own waits.

use rtdsl::lang::{Input, Memory, Request, evaluate_again};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::{Duration, Instant};

/// Each is cancelled so many times, at even distances.
const MOMENTS: u64 = 12;

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
    println!("{:<26} {:>12} {:>12} {:>12}", "longest, in milliseconds", "given up", "over", "median over");
    for (name, text, milliseconds) in programs {
        if !wanted.is_empty() && !wanted.iter().any(|w| name.contains(w.as_str())) {
            continue;
        }
        let moments = (1..=MOMENTS).map(|k| milliseconds * k / MOMENTS);
        let waits: Vec<[f64; 2]> = moments.filter_map(|after| wait(&request(&text), after)).collect();
        let mut over: Vec<f64> = waits.iter().map(|w| w[1]).collect();
        over.sort_by(f64::total_cmp);
        let given_up = waits.iter().map(|w| w[0]).fold(0.0, rtdsl::math::Real::max);
        let (Some(longest), Some(median)) = (over.last(), over.get(over.len() / 2)) else { continue };
        println!("{name:<26} {given_up:>12.1} {longest:>12.1} {median:>12.1}");
    }
}

fn request(text: &str) -> Request {
    let main = Input::Text { name: "text".into(), bytes: text.as_bytes().to_vec(), folder: ".".into() };
    Request { main, set: Vec::new(), allow_read: Vec::new(), record_arguments: false }
}

/// Milliseconds from the cancelling, so late, until it is given up and until another one is done; `None` where it ended
/// before.
fn wait(wanted: &Request, after: u64) -> Option<[f64; 2]> {
    let cancel = AtomicBool::new(false);
    let mut memory = Memory::default();
    std::thread::scope(|scope| {
        let set = scope.spawn(|| {
            std::thread::sleep(Duration::from_millis(after));
            cancel.store(true, Relaxed);
            Instant::now()
        });
        let result = evaluate_again(wanted, &mut memory, &cancel);
        let given_up = Instant::now();
        let set = set.join().ok()?;
        if result.is_some() {
            return None;
        }
        drop(evaluate_again(&request("sphere()"), &mut memory, &AtomicBool::new(false)));
        Some([given_up, Instant::now()].map(|t| t.duration_since(set).as_secs_f64() * 1e3))
    })
}
