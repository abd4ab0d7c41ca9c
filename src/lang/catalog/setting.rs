//! Settings of the whole picture: at the top level of the main file, once each.

use crate::diag::Span;
use crate::lang::build::Build;
use crate::lang::fault::{Fault, Outcome};
use crate::lang::value::Value;
use crate::lang::word::{Args, Default, Host, Kind, Run, Ty, Word, optional, required};
use crate::scene::{Accuracy, AntiAliasing, Camera, PixelFilter, Precision, Projection, Settings, range};

pub const WORDS: &[Word] = &[
    Word {
        name: "camera",
        kind: Kind::Setting,
        params: &[
            optional("name", Ty::Text, Default::Absent, "the name of an alternative, for `--camera`").by_position(),
            optional("from", Ty::Point, Default::Vec3([0.0, 2.0, 8.0]), "where the eye is"),
            optional("at", Ty::Point, Default::Vec3([0.0; 3]), "what is in the middle of the picture"),
            optional("up", Ty::Direction, Default::Vec3([0.0, 1.0, 0.0]), "what points up in the picture"),
            optional("fov", Ty::Angle, Default::Absent, "the vertical angle of view, 40deg unless given")
                .between(0.0, 180.0),
            optional(
                "height",
                Ty::Length,
                Default::Absent,
                "instead of `fov`: parallel rays, and the height of what is seen",
            )
            .above(0.0),
        ],
        doc: "Where the picture is taken from; further, named cameras are alternatives.",
        example: "sphere()\ncamera(from: [4, 3, 8], at: [0, 0, 0], fov: 30deg)\ncamera(\"top\", from: [0, 9, 0], up: [0, 0, -1], height: 4)\nlight(at: [4, 8, 6])",
        run: Run::Call(camera),
    },
    Word {
        name: "background",
        kind: Kind::Setting,
        params: &[required("color", Ty::Color, "what a ray sees that meets nothing").light()],
        doc: "The color behind everything, black unless given.",
        example: "sphere()\nbackground(skyblue)\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| {
            once(host, "background")?;
            host.build().scene.background = a.color(0);
            Ok(Value::None)
        }),
    },
    Word {
        name: "ambient",
        kind: Kind::Setting,
        params: &[required("level", Ty::Level, "a linear amount of light, or its color").at_least(0.0).light()],
        doc: "Light that reaches every point, shadows included; 0.1 unless given.",
        example: "sphere()\nambient(0.2)\nlight(at: [4, 8, 6])",
        run: Run::Call(|host, a| {
            once(host, "ambient")?;
            host.build().scene.ambient = a.level(0);
            Ok(Value::None)
        }),
    },
    Word {
        name: "render",
        kind: Kind::Setting,
        params: &[
            optional("size", Ty::Pair, Default::Absent, "width and height in pixels, [640, 480] unless given")
                .within(1.0, range::LARGEST_SIDE as f64),
            optional(
                "aa",
                Ty::AntiAliasing,
                Default::Absent,
                "`off`: one ray a pixel; `grid(n)`: n × n rays, averaged; `adaptive(n)`: one, and up to n more where neighbours differ",
            ),
            optional("depth", Ty::Whole, Default::Number(8.0), "how many mirrors and glasses a ray may go through; glass sends two rays on from each surface, so each level may double the time")
                .within(0.0, Settings::LARGEST_DEPTH as f64),
            optional("error", Ty::Number, Default::Absent, "instead of `aa`: the largest error of a pixel, as in `2/255`; as many rays are sent as it takes")
                .within(Accuracy::LEAST_ERROR, Accuracy::LARGEST_ERROR),
            optional("time", Ty::Number, Default::Absent, "instead of `aa`: seconds; the picture gets as good as it can meanwhile, and says how good that is")
                .within(Accuracy::LEAST_TIME, Accuracy::LONGEST_TIME),
            optional("precision", Ty::Choice(&["f64", "f32"]), Default::Text("f64"), "the arithmetic: 64 or 32 bits; 32 bits hold lengths from 1e-18 to 1e18"),
            optional("filter", Ty::Choice(&["box", "mitchell", "gauss"]), Default::Text("box"), "how a pixel's light is weighed: alike all over its square; sharp, from 4 × 4 pixels; or soft, from 3 × 3. One ray a pixel is shown as it is"),
        ],
        doc: "How large and how good the picture is.",
        example: "sphere()\nlight(at: [4, 8, 6])\nrender(size: [320, 200], aa: grid(2), depth: 5)",
        run: Run::Call(render),
    },
    Word {
        name: "off",
        kind: Kind::Constant,
        params: &[],
        doc: "No anti-aliasing: one ray through the middle of each pixel.",
        example: "sphere()\nlight(at: [4, 8, 6])\nrender(aa: off)",
        run: Run::Constant(|| Value::AntiAliasing(AntiAliasing::Off)),
    },
    Word {
        name: "grid",
        kind: Kind::Setting,
        params: &[
            required("n", Ty::Whole, "rays along one side of a pixel").within(1.0, AntiAliasing::LARGEST_GRID as f64)
        ],
        doc: "Anti-aliasing by a regular grid of n × n rays a pixel, averaged.",
        example: "sphere()\nlight(at: [4, 8, 6])\nrender(aa: grid(3))",
        run: Run::Call(|_, a| Ok(Value::AntiAliasing(AntiAliasing::Grid(a.number(0) as u32)))),
    },
    Word {
        name: "adaptive",
        kind: Kind::Setting,
        params: &[
            required("n", Ty::Whole, "most further rays of a pixel").within(2.0, AntiAliasing::MOST_RAYS as f64)
        ],
        doc: "Anti-aliasing where it is seen: one ray a pixel, and up to n more where neighbours differ, on a lattice. Much quicker than a grid for as smooth a picture; what lies between all first rays is missed.",
        example: "sphere()\nlight(at: [4, 8, 6])\nrender(aa: adaptive(16))",
        run: Run::Call(|_, a| Ok(Value::AntiAliasing(AntiAliasing::Adaptive(a.number(0) as u32)))),
    },
];

/// Notes that a setting has been made; a second time is an error that shows both places.
fn once(host: &mut dyn Host, what: &str) -> Result<(), Box<Fault>> {
    let span = host.place().span;
    note(host.build(), what, span)
}

fn note(build: &mut Build, what: &str, span: Span) -> Result<(), Box<Fault>> {
    if let Some((_, first)) = build.settings.iter().find(|(name, _)| name == what) {
        return Err(Fault::new(format!("`{what}` is set twice"))
            .label("the second time")
            .and_at(*first, "the first time"));
    }
    build.settings.push((what.to_owned(), span));
    Ok(())
}

fn camera(host: &mut dyn Host, a: &[Value]) -> Outcome {
    let name = a.given(0).then(|| a.text(0).to_owned());
    once(host, &name.as_ref().map_or("camera".to_owned(), |n| format!("camera(\"{n}\")")))?;
    let (from, at, up) = (a.vec3(1), a.vec3(2), a.vec3(3));
    let view = at - from;
    let size = view.abs().max_element();
    if size == 0.0 {
        return Err(Fault::new("the camera looks at itself: `from` and `at` are the same point").on(2).into());
    }
    if !range::is_supported(size) {
        let how = if size > range::LARGEST { "far apart" } else { "close together" };
        return Err(Fault::new(format!("`from` and `at` of the camera are too {how}"))
            .note("their distance is from 1e-140 to 1e140")
            .on(2)
            .into());
    }
    let across = (view / size).normalize().cross((up / up.abs().max_element()).normalize());
    // The rounding of the two directions: below it, nothing is left of a sideways direction.
    if across.length() <= 8.0 * f64::EPSILON {
        let fault = Fault::new("the camera looks along its `up` direction");
        return Err(fault.note("give another `up`, such as `up: [0, 0, -1]`").into());
    }
    let projection = match (a.given(4), a.given(5)) {
        (true, true) => return Err(Fault::new("a camera has a `fov` or a `height`, not both").on(5).into()),
        (_, true) => Projection::Orthographic { height: a.number(5) },
        (true, false) => Projection::Perspective { fov: a.number(4) },
        _ => Camera::default().projection,
    };
    let place = Some(host.place());
    let build = host.build();
    let camera = Camera { name, from, at, up, projection, place };
    if !build.has_camera {
        build.scene.cameras.clear();
        build.has_camera = true;
    }
    // The one without a name is the default wherever it stands.
    let index = if camera.name.is_none() { 0 } else { build.scene.cameras.len() };
    build.scene.cameras.insert(index, camera);
    Ok(Value::None)
}

fn render(host: &mut dyn Host, a: &[Value]) -> Outcome {
    once(host, "render")?;
    let settings = &mut host.build().scene.settings;
    if let Some(Value::List(size)) = a.first() {
        let (w, h) = (size.as_slice().number(0), size.as_slice().number(1));
        if w * h > range::MOST_PIXELS as f64 {
            let most = range::MOST_PIXELS;
            return Err(Fault::new(format!("a picture has at most {most} pixels, this one has {}", w * h))
                .on(0)
                .into());
        }
        (settings.width, settings.height) = (w as u32, h as u32);
    }
    if let Some(Value::AntiAliasing(aa)) = a.get(1) {
        settings.aa = *aa;
    }
    settings.max_depth = a.number(2) as u32;
    let given = |i: usize| a.given(i).then(|| a.number(i));
    let (error, time) = (given(3), given(4));
    if error.is_some() || time.is_some() {
        let (asked, word) = if error.is_some() { (3, "an `error`") } else { (4, "a `time`") };
        if a.given(1) {
            let fault = Fault::new(format!("a picture has {word} or an `aa`, not both"));
            return Err(fault
                .note("it sends as many rays as it takes, more of them where they are needed")
                .on(1)
                .into());
        }
        if a.text(5) == "f32" {
            let fault = Fault::new(format!("a picture with {word} needs 64 bits"));
            return Err(fault.note("what 32 bits lose isn't known").on(asked).into());
        }
        settings.accuracy = Some(Accuracy { error, time, confidence: Accuracy::CONFIDENCE });
    }
    settings.filter = PixelFilter::named(a.text(6)).unwrap_or_default();
    settings.precision = if a.text(5) == "f32" { Precision::F32 } else { Precision::F64 };
    Ok(Value::None)
}
