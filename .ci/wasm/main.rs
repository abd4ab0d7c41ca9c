//! Prints the hash of a scene's linear pixels: `rtdsl WIDTH HEIGHT FILE`. For `.ci/machines`, where `app` can't be.

use rtdsl::lang::{Input, Request, evaluate};
use rtdsl::render::{Options, Silent, World, render};
use std::sync::atomic::AtomicBool;

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let [_, width, height, file] = args.as_slice() else { panic!("WIDTH HEIGHT FILE") };
    let main = Input::File(file.into());
    let request = Request { main, set: Vec::new(), allow_read: Vec::new(), record_arguments: false };
    let scene = evaluate(&request).unwrap_or_else(|failure| panic!("{:?}", failure.diagnostics)).scene;
    let world = World::build(&scene, &scene.cameras[0]);
    let size = |text: &str| text.parse().expect("a number of pixels");
    let options = Options { width: size(width), height: size(height), ..Options::from_settings(&scene.settings) };
    let rendered = render(&world, &options, &Silent, &AtomicBool::new(false)).expect("not cancelled");
    println!("{}", rendered.film.hash());
}
