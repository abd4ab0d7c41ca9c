//! Links on the way to a file.

use super::*;
use std::os::unix::fs::symlink;

impl Desk {
    fn link(&self, target: &str, name: &str) {
        symlink(target, self.path(name)).unwrap();
    }

    /// Points a link elsewhere in one step, as `ln -sfn` and deployments do.
    fn point(&self, target: &str, name: &str) {
        self.link(target, "link.tmp");
        self.rename("link.tmp", name);
    }

    fn folders(&self, names: &[&str]) {
        for name in names {
            fs::create_dir_all(self.path(name)).unwrap();
            self.write(&format!("{name}/a"), name);
        }
    }
}

#[test]
fn the_file_may_be_a_link() {
    let mut desk = Desk::new();
    desk.folders(&["v1", "v2"]);
    desk.link("v1/a", "a");
    desk.follow(&["a"]);
    desk.write("v1/a", "edited");
    desk.changed("a");
    desk.write("v1/new", "replaced");
    desk.rename("v1/new", "v1/a");
    desk.changed("a");
    desk.point("v2/a", "a");
    desk.changed("a");
    desk.write("v1/a", "of no interest now");
    desk.only_sentinel();
    desk.write("v2/a", "edited");
    desk.changed("a");
    desk.write("a.tmp", "no longer a link");
    desk.rename("a.tmp", "a");
    desk.changed("a");
}

#[test]
fn a_link_to_the_same_content_is_no_change() {
    let mut desk = Desk::new();
    desk.folders(&["v1", "v2"]);
    desk.write("v2/a", "v1");
    desk.link("v1/a", "a");
    desk.follow(&["a"]);
    desk.point("v2/a", "a");
    desk.only_sentinel();
    desk.write("v2/a", "edited");
    desk.changed("a");
}

#[test]
fn a_folder_on_the_way_may_be_a_link() {
    let mut desk = Desk::new();
    desk.folders(&["releases/v1/deep", "releases/v2/deep"]);
    desk.link("releases/v1", "current");
    desk.follow(&["current/deep/a"]);
    desk.write("releases/v1/deep/a", "edited");
    desk.changed("current/deep/a");
    desk.point("releases/v2", "current");
    desk.changed("current/deep/a");
    desk.write("releases/v2/deep/a", "edited too");
    desk.changed("current/deep/a");
    desk.rename("releases", "elsewhere");
    desk.changed("current/deep/a");
    desk.point("elsewhere/v2", "current");
    desk.changed("current/deep/a");
    desk.write("elsewhere/v2/deep/a", "at its new place");
    desk.changed("current/deep/a");
}

#[test]
fn mounted_configurations_are_followed() {
    let mut desk = Desk::new();
    desk.folders(&["..v1", "..v2"]);
    desk.link("..v1", "..data");
    desk.link("..data/a", "a");
    desk.follow(&["a"]);
    desk.point("..v2", "..data");
    fs::remove_dir_all(desk.path("..v1")).unwrap();
    desk.changed("a");
    desk.folders(&["..v3"]);
    desk.point("..v3", "..data");
    fs::remove_dir_all(desk.path("..v2")).unwrap();
    desk.changed("a");
}

#[test]
fn every_link_of_a_chain_counts() {
    let mut desk = Desk::new();
    desk.folders(&["x", "y", "z", "other"]);
    fs::remove_file(desk.path("x/a")).unwrap();
    fs::remove_file(desk.path("y/a")).unwrap();
    desk.link("../y/a", "x/a");
    desk.link(desk.path("z/a").to_str().unwrap(), "y/a");
    desk.follow(&["x/a"]);
    desk.write("z/a", "edited");
    desk.changed("x/a");
    desk.point("../other/a", "y/a");
    desk.changed("x/a");
    desk.write("other/a", "edited too");
    desk.changed("x/a");
    desk.point("../z/a", "x/a");
    desk.changed("x/a");
}

#[test]
fn a_link_to_nothing_is_awaited() {
    let mut desk = Desk::new();
    desk.link("not/yet", "a");
    desk.follow(&["a"]);
    fs::create_dir(desk.path("not")).unwrap();
    desk.only_sentinel();
    desk.write("not/yet", "here");
    desk.changed("a");
}

#[test]
fn a_folder_moved_with_a_link_left_behind_is_followed() {
    let mut desk = Desk::new();
    desk.folders(&["x"]);
    desk.follow(&["x/a"]);
    desk.rename("x", "moved");
    desk.link("moved", "x");
    desk.only_sentinel_after_a_blink();
    desk.write("moved/a", "edited");
    desk.changed("x/a");
}
