//! Files that come and go, and their folders.

use super::*;

#[test]
fn a_missing_file_is_found_when_it_appears_and_when_it_goes() {
    let mut desk = Desk::new();
    desk.follow(&["a"]);
    desk.write("a", "here");
    desk.changed("a");
    fs::remove_file(desk.path("a")).unwrap();
    desk.changed("a");
    desk.write("a.new", "again");
    desk.rename("a.new", "a");
    desk.changed("a");
}

#[test]
fn a_missing_folder_is_found_when_it_appears() {
    let mut desk = Desk::new();
    desk.follow(&["x/y/z/a"]);
    fs::create_dir_all(desk.path("x/y/z")).unwrap();
    desk.write("x/y/z/a", "here");
    desk.changed("x/y/z/a");
    desk.write("x/y/z/a", "edited");
    desk.changed("x/y/z/a");
}

#[test]
fn a_missing_folder_is_found_when_it_appears_step_by_step() {
    let mut desk = Desk::new();
    desk.follow(&["x/y/a"]);
    fs::create_dir(desk.path("x")).unwrap();
    desk.only_sentinel();
    fs::create_dir(desk.path("x/y")).unwrap();
    desk.only_sentinel();
    desk.write("x/y/a", "here");
    desk.changed("x/y/a");
}

#[test]
fn a_folder_removed_and_made_again_is_followed() {
    let mut desk = Desk::new();
    fs::create_dir_all(desk.path("x/y")).unwrap();
    desk.write("x/y/a", "master");
    desk.follow(&["x/y/a"]);
    for round in 0..2 {
        fs::remove_dir_all(desk.path("x")).unwrap();
        desk.changed("x/y/a");
        fs::create_dir_all(desk.path("x/y")).unwrap();
        desk.write("x/y/a", &format!("branch {round}"));
        desk.changed("x/y/a");
        desk.write("x/y/a", &format!("edited {round}"));
        desk.changed("x/y/a");
    }
}

#[test]
fn a_folder_made_again_at_once_is_followed() {
    let mut desk = Desk::new();
    fs::create_dir(desk.path("x")).unwrap();
    desk.write("x/a", "0");
    desk.follow(&["x/a"]);
    for round in 1..4 {
        fs::remove_dir_all(desk.path("x")).unwrap();
        fs::create_dir(desk.path("x")).unwrap();
        desk.write("x/a", &round.to_string());
        desk.changed("x/a");
        desk.write("x/a", &format!("{round} edited"));
        desk.changed("x/a");
    }
}

#[test]
fn a_folder_renamed_away_and_back_is_followed() {
    let mut desk = Desk::new();
    fs::create_dir_all(desk.path("x/y/z")).unwrap();
    desk.write("x/y/z/a", "one");
    desk.follow(&["x/y/z/a"]);
    for folder in ["x", "x/y", "x/y/z"] {
        desk.rename(folder, "away");
        desk.changed("x/y/z/a");
        desk.rename("away", folder);
        desk.changed("x/y/z/a");
        desk.write("x/y/z/a", folder);
        desk.changed("x/y/z/a");
    }
}

#[test]
fn another_folder_in_its_place_is_followed_and_the_old_one_is_not() {
    let mut desk = Desk::new();
    for folder in ["x", "new"] {
        fs::create_dir(desk.path(folder)).unwrap();
        desk.write(&format!("{folder}/a"), folder);
    }
    desk.follow(&["x/a"]);
    desk.rename("x", "old");
    desk.rename("new", "x");
    desk.changed("x/a");
    desk.write("old/a", "edited");
    desk.only_sentinel();
    desk.write("x/a", "edited");
    desk.changed("x/a");
}

#[test]
fn a_folder_in_place_of_the_file_is_no_content() {
    let mut desk = Desk::new();
    desk.write("a", "file");
    desk.follow(&["a"]);
    fs::remove_file(desk.path("a")).unwrap();
    fs::create_dir(desk.path("a")).unwrap();
    desk.changed("a");
    fs::remove_dir(desk.path("a")).unwrap();
    desk.only_sentinel();
    desk.write("a", "file");
    desk.changed("a");
}

#[test]
fn a_file_in_place_of_a_folder_is_no_end() {
    let mut desk = Desk::new();
    desk.write("x", "a file");
    desk.follow(&["x/y/a"]);
    fs::remove_file(desk.path("x")).unwrap();
    fs::create_dir_all(desk.path("x/y")).unwrap();
    desk.write("x/y/a", "here");
    desk.changed("x/y/a");
}

#[cfg(unix)]
#[test]
fn what_may_not_be_read_is_no_content_until_it_may() {
    use std::os::unix::fs::PermissionsExt;
    let mut desk = Desk::new();
    fs::create_dir(desk.path("x")).unwrap();
    desk.write("x/a", "text");
    desk.follow(&["x/a"]);
    let allow = |name, mode| fs::set_permissions(desk.path(name), fs::Permissions::from_mode(mode)).unwrap();
    for (name, usual) in [("x/a", 0o644), ("x", 0o755)] {
        allow(name, 0);
        // The system's administrator reads everything; for them nothing has changed.
        if fs::read(desk.path("x/a")).is_err() {
            desk.changed("x/a");
            allow(name, usual);
            desk.changed("x/a");
        } else {
            desk.only_sentinel();
            allow(name, usual);
        }
        desk.write("x/a", name);
        desk.changed("x/a");
    }
}

#[test]
fn relative_paths_are_those_of_the_current_folder() {
    // The tests run in the package's folder, beneath which only this file is looked for.
    let (tell, told) = mpsc::channel();
    let follower = Follower::start(None, NEVER, notice::system, Box::new(move |paths| drop(tell.send(paths)))).unwrap();
    let path = PathBuf::from("src/../Cargo.toml");
    follower.follow(&[Dependency { path: path.clone(), digest: None, found: false }]);
    assert_eq!(told.recv_timeout(PATIENCE), Ok(vec![path]));
}
