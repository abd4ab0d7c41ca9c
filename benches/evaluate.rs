//! What the language costs: `cargo bench --bench evaluate` prints a line a program, with the time of one statement or turn.
//! No thresholds; figures of one run compare only with each other, for machines drift.

use rtdsl::lang::{Input, Request, evaluate};
use std::fmt::Write;
use std::path::PathBuf;

/// Each program is run this often and its shortest times are kept.
const RUNS: usize = 9;

/// A program, and how many statements or turns its time is divided by.
struct Program {
    name: &'static str,
    text: String,
    count: u32,
}

/// One that makes something in every turn of a loop.
fn turns(name: &'static str, count: u32, body: &str) -> Program {
    Program { name, text: format!("var s = 0\nfor i in 0..{count} {{ {body} }}\nsphere()"), count }
}

/// One of many lines; `line` gives each.
fn lines(name: &'static str, count: u32, line: impl Fn(&mut String, f64)) -> Program {
    let mut text = String::from("let m = matte(red)\n");
    (0..count).for_each(|i| line(&mut text, f64::from(i)));
    Program { name, text, count }
}

fn programs() -> Vec<Program> {
    let peers = Program { name: "peers/loop", text: include_str!("peers/loop.scene").into(), count: 1_000_000 };
    let loop_of_spheres = include_str!("peers/spheres_loop.scene").into();
    vec![
        peers,
        turns("arithmetic", 300_000, "s += (i + 1) * 2 / 3 - i % 5"),
        turns("vectors", 300_000, "let p = [i, 2 * i, 1] * 0.5 + [1, 2, 3]; s += p.x"),
        turns("conditions", 300_000, "if i % 3 == 0 and i > 5 { s += 1 } else { s += 2 }"),
        turns("lists", 300_000, "let l = [i, i]; s += l[1] + len(l)"),
        Program { name: "spheres, loop", text: loop_of_spheres, count: 100_000 },
        lines("spheres, lines", 100_000, |text, i| {
            let _ = writeln!(text, "sphere(at: [{}, {}, {}], r: 0.5, mat: m)", i * 0.25, -i * 0.125, i);
        }),
        lines("lines, each its own", 3_000, |text, i| {
            let _ = writeln!(text, "let a{i} = sphere(at: [{i}, 2 * {i}, 1], r: 0.5, mat: m)\na{i} |> move([1, 2, 3])");
        }),
    ]
}

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    println!("{:<22} {:>9} {:>12} {:>14}", "program", "parse ms", "evaluate ms", "ns a statement");
    for Program { name, text, count } in programs() {
        if !wanted.is_empty() && !wanted.iter().any(|w| name.contains(w.as_str())) {
            continue;
        }
        let main = Input::Text { name: name.into(), bytes: text.into_bytes(), folder: PathBuf::from(".") };
        let request = Request { main, set: Vec::new(), allow_read: Vec::new(), record_arguments: false };
        let times = (0..RUNS).filter_map(|_| evaluate(&request).ok()).map(|e| (e.parse_seconds, e.evaluate_seconds));
        let Some((parse, run)) = times.reduce(|a, b| (a.0.min(b.0), a.1.min(b.1))) else {
            println!("{name:<22} is wrong");
            continue;
        };
        let ns = (parse + run) * 1e9 / f64::from(count);
        println!("{name:<22} {:>9.2} {:>12.2} {ns:>14.0}", parse * 1e3, run * 1e3);
    }
}
