//! The ways in which programs save.

use super::*;
use std::collections::BTreeSet;
use std::io::Write;

/// Puts `text` in place as a certain program does.
type Save = fn(&Desk, &str);

const SAVES: [(&str, Save); 6] = [
    ("truncate and write: VS Code, nano", |desk, text| desk.write("a", text)),
    ("temporary file renamed over it: helix, git, atomic writers", |desk, text| {
        desk.write("a.tmp", text);
        desk.rename("a.tmp", "a");
    }),
    ("old file renamed to a backup, new file: vim", |desk, text| {
        desk.write("4913", ""); // vim tries whether it may create files
        fs::remove_file(desk.path("4913")).unwrap();
        desk.rename("a", "a~");
        desk.write("a", text);
        fs::remove_file(desk.path("a~")).unwrap();
    }),
    ("lock beside it, backup that stays: emacs", |desk, text| {
        desk.write(".#a", "");
        let _ = fs::remove_file(desk.path("a~"));
        desk.rename("a", "a~");
        desk.write("a", text);
        fs::remove_file(desk.path(".#a")).unwrap();
    }),
    ("removed and written anew", |desk, text| {
        fs::remove_file(desk.path("a")).unwrap();
        desk.write("a", text);
    }),
    ("within the file", |desk, text| {
        let mut file = fs::File::options().write(true).open(desk.path("a")).unwrap();
        file.write_all(text.as_bytes()).unwrap();
        file.set_len(text.len() as u64).unwrap();
    }),
];

#[test]
fn every_way_of_saving_is_one_change() {
    let mut desk = Desk::new();
    desk.write("a", "old");
    desk.follow(&["a"]);
    for round in 0..2 {
        for (way, save) in SAVES {
            save(&desk, &format!("{way} {round}"));
            assert_eq!(desk.report(), ["a"], "{way}");
        }
    }
    desk.only_sentinel_after_a_blink();
}

#[test]
fn many_files_at_once_are_one_change() {
    let mut desk = Desk::new();
    let names: Vec<String> = (0..20).map(|i| format!("part{i}")).collect();
    for name in &names {
        desk.write(name, "master");
    }
    desk.follow(&names.iter().map(String::as_str).collect::<Vec<_>>());
    for name in &names {
        fs::remove_file(desk.path(name)).unwrap();
        desk.write(name, "branch");
    }
    // A machine may well stop for longer than the debounce between two of them; then they are told in parts.
    let mut told = BTreeSet::new();
    while told.len() < names.len() {
        told.extend(desk.report());
    }
    desk.only_sentinel_after_a_blink();
    assert_eq!(told, names.into_iter().collect());
}

#[test]
fn a_save_in_pieces_ends_as_what_was_written_last() {
    let mut desk = Desk::new();
    desk.write("a", "old");
    desk.follow(&["a"]);
    let mut file = fs::File::create(desk.path("a")).unwrap();
    for piece in ["one ", "two ", "three"] {
        thread::sleep(QUIET * 3 / 2);
        file.write_all(piece.as_bytes()).unwrap();
    }
    drop(file);
    // Whoever is late may be told of states that are past already; of the last one in any case.
    let (mut read, end) = (None, dependency(&desk.path("a")).digest);
    while read != end {
        desk.changed("a");
        read = dependency(&desk.path("a")).digest;
    }
    desk.only_sentinel_after_a_blink();
}

#[test]
fn an_endless_stream_of_writes_is_told_of() {
    let mut desk = Desk::new();
    desk.write("a", "old");
    desk.follow(&["a"]);
    let start = Instant::now();
    let mut file = fs::File::create(desk.path("a")).unwrap();
    let told = loop {
        file.write_all(b"more ").unwrap();
        match desk.told.recv_timeout(Duration::from_millis(5)) {
            Ok(paths) => break paths,
            Err(_) => assert!(start.elapsed() < PATIENCE, "it is never told of"),
        }
    };
    assert_eq!(told, [desk.path("a")]);
}

#[test]
fn saves_in_a_row_are_all_found_though_size_and_time_hardly_differ() {
    let mut desk = Desk::new();
    desk.write("a", "0");
    desk.follow(&["a"]);
    for i in 1..6 {
        desk.write("a", &i.to_string());
        desk.changed("a");
    }
}
