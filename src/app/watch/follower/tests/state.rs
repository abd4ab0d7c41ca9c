//! What counts as a change, and that each is told once.

use super::*;

#[test]
fn what_changed_before_it_was_followed_is_told() {
    let desk = Desk::new();
    desk.write("a", "read");
    let read = dependency(&desk.path("a"));
    desk.write("a", "edited meanwhile");
    desk.follower.follow(&[read]);
    assert_eq!(desk.told.recv_timeout(PATIENCE), Ok(vec![desk.path("a")]));
}

#[test]
fn an_old_text_read_late_is_told_of() {
    let mut desk = Desk::new();
    desk.write("a", "new");
    desk.follow(&["a"]);
    // The file stands still and is known; yet whoever says so read something else of it.
    let half = Dependency { path: desk.path("a"), digest: Some(*blake3::hash(b"half").as_bytes()), found: true };
    desk.follower.follow(&[half]);
    desk.changed("a");
}

#[test]
fn the_same_content_is_no_change() {
    let mut desk = Desk::new();
    desk.write("a", "text");
    desk.follow(&["a"]);
    desk.write("a", "text");
    desk.only_sentinel();
    fs::File::options().write(true).open(desk.path("a")).unwrap().set_modified(std::time::SystemTime::now()).unwrap();
    desk.only_sentinel();
    desk.write("copy", "text");
    desk.rename("copy", "a");
    desk.only_sentinel();
}

#[test]
fn what_was_there_but_not_read_is_told_of_when_it_changes() {
    let desk = Desk::new();
    desk.write("a", "too large, or outside the project");
    let unread = [Dependency { path: desk.path("a"), digest: None, found: true }, dependency(&desk.path("sentinel"))];
    for text in ["1", "2"] {
        desk.follower.follow(&unread[..]);
        desk.write("sentinel", text);
        assert_eq!(
            desk.told.recv_timeout(PATIENCE),
            Ok(vec![desk.path("sentinel")]),
            "not of what it is at first sight"
        );
    }
    desk.write("a", "another");
    assert_eq!(desk.told.recv_timeout(PATIENCE), Ok(vec![desk.path("a")]));
    fs::remove_file(desk.path("a")).unwrap();
    assert_eq!(desk.told.recv_timeout(PATIENCE), Ok(vec![desk.path("a")]));
    // What was missing when it was looked for is told of however early it came.
    desk.write("a", "there now");
    let missing = Dependency { path: desk.path("a"), digest: None, found: false };
    desk.follower.follow(&[missing]);
    assert_eq!(desk.told.recv_timeout(PATIENCE), Ok(vec![desk.path("a")]));
}

#[test]
fn a_change_is_told_once_however_often_the_old_text_is_followed() {
    let mut desk = Desk::new();
    desk.write("a", "old");
    desk.follow(&["a"]);
    let old = [dependency(&desk.path("a")), dependency(&desk.path("sentinel"))];
    desk.write("a", "new");
    assert_eq!(desk.told.recv_timeout(PATIENCE), Ok(vec![desk.path("a")]));
    for _ in 0..3 {
        desk.follower.follow(&old);
        desk.write("sentinel", &format!("{:?}", Instant::now()));
        assert_eq!(desk.told.recv_timeout(PATIENCE), Ok(vec![desk.path("sentinel")]));
    }
    // Whoever was told of the new text must hear that the old one is back.
    desk.write("a", "old");
    assert_eq!(desk.told.recv_timeout(PATIENCE), Ok(vec![desk.path("a")]));
}

#[test]
fn what_is_no_longer_followed_is_not_told_of() {
    let mut desk = Desk::new();
    desk.write("a", "1");
    desk.write("b", "1");
    desk.follow(&["a"]);
    desk.follow(&["b"]);
    desk.write("a", "2");
    desk.only_sentinel();
    desk.write("b", "2");
    desk.changed("b");
    desk.follow(&["a", "b"]);
    desk.write("a", "3");
    desk.changed("a");
}

#[test]
fn other_files_of_the_folder_are_of_no_interest() {
    let mut desk = Desk::new();
    desk.write("a", "text");
    desk.follow(&["a"]);
    for i in 0..500 {
        desk.write(&format!("object{i}"), "built");
    }
    desk.rename("object1", "picture.png");
    desk.only_sentinel();
}

#[test]
fn files_are_told_in_the_order_they_were_given() {
    let mut desk = Desk::new();
    for name in ["c", "a", "b"] {
        desk.write(name, "old");
    }
    desk.follow(&["c", "a", "b", "a"]);
    desk.follower.follow(&[]);
    for name in ["a", "b", "c"] {
        desk.write(name, "new");
    }
    let old = Some(*blake3::hash(b"old").as_bytes());
    let files = ["c", "a", "b"].map(|n| Dependency { path: desk.path(n), digest: old, found: true });
    desk.follower.follow(&files);
    assert_eq!(desk.report(), ["c", "a", "b"]);
}
