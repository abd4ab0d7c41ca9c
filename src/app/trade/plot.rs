//! Error against time as an SVG: both logarithmic, every dial with a mark and a colour of its own, the front as a staircase.
//! Readable on light and dark ground: it brings its own.

use super::axis::Axis;
use super::front::positive;
use super::report::{Report, Row};
use super::scale::Scale;
use super::setting::number;
use std::fmt::Write as _;

/// Size of the plot, in pixels at its natural size.
const WIDTH: f64 = 1180.0;
const HEIGHT: f64 = 560.0;
/// Where a panel's field lies in it: left, top, width, height.
const FIELD: [f64; 4] = [62.0, 64.0, 500.0, 400.0];
/// From one panel to the next.
const STEP: f64 = 590.0;

/// One of the panels.
struct Panel<'r> {
    title: &'static str,
    /// The error, its least and its most.
    error: fn(&Row) -> [f64; 3],
    front: &'r [usize],
    /// What rounding to codes of 8 bits alone makes of it.
    rounding: f64,
    left: f64,
}

/// Colours, on light ground and on dark; of the dials in the order of [`Axis::ALL`]. After Okabe & Ito, *Color Universal Design*,
/// 2008, made darker or lighter for the ground.
const DIALS: [[&str; 2]; 8] = [
    ["#0072b2", "#56b4e9"],
    ["#c65102", "#ff9248"],
    ["#5d6770", "#aab4bd"],
    ["#00805d", "#3ccf9f"],
    ["#7a52c7", "#b79cf2"],
    ["#8f6a00", "#e6c04a"],
    ["#b5145a", "#f27ba8"],
    ["#23262b", "#e4e5e7"],
];
/// Grounds, texts, lesser texts, lines.
const PLAIN: [(&str, [&str; 2]); 4] = [
    ("paper", ["#ffffff", "#1d2024"]),
    ("ink", ["#23262b", "#e4e5e7"]),
    ("soft", ["#62666e", "#9ba1aa"]),
    ("grid", ["#e3e0d8", "#2e3238"]),
];

/// The whole plot: largest error on the left, RMSE on the right.
pub fn svg(report: &Report) -> String {
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"trade-plot\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" width=\"{WIDTH}\" \
         height=\"{HEIGHT}\" font-family=\"system-ui, sans-serif\" font-size=\"12\" role=\"img\">\n<title>{}: error against \
         time</title>\n{}<rect class=\"paper\" width=\"{WIDTH}\" height=\"{HEIGHT}\" rx=\"8\"/>\n",
        escaped(&report.scene),
        style()
    );
    let verdict = &report.verdict;
    let panels = [
        Panel {
            title: "largest error of any pixel, in codes (1/255)",
            error: |row| row.max,
            front: &verdict.front,
            rounding: 0.5,
            left: FIELD[0],
        },
        Panel {
            title: "RMSE, in codes (1/255)",
            error: |row| row.rmse,
            front: &verdict.front_rmse,
            // Of an even spread over one code.
            rounding: (1.0f64 / 12.0).sqrt(),
            left: FIELD[0] + STEP,
        },
    ];
    for panel in &panels {
        panel.draw(report, &mut out);
    }
    legend(report, &mut out);
    out + "</svg>\n"
}

fn style() -> String {
    let mut text = String::from("<style>\n");
    for ground in 0..2 {
        if ground == 1 {
            text += "@media (prefers-color-scheme: dark) {\n";
        }
        for (name, colors) in PLAIN {
            let what = if name == "grid" { "stroke" } else { "fill" };
            let _ = writeln!(text, ".trade-plot .{name} {{ {what}: {}; }}", colors[ground]);
        }
        for (i, colors) in DIALS.iter().enumerate() {
            let _ = writeln!(text, ".trade-plot .d{i} {{ fill: {0}; stroke: {0}; }}", colors[ground]);
        }
        let _ = writeln!(text, ".trade-plot .line {{ fill: none; }}");
        let _ = writeln!(text, ".trade-plot .front {{ fill: none; stroke: {}; }}", PLAIN[1].1[ground]);
        let _ = writeln!(text, ".trade-plot .halo {{ stroke: {}; }}", PLAIN[0].1[ground]);
    }
    text + "}\n</style>\n"
}

impl Panel<'_> {
    fn draw(&self, report: &Report, out: &mut String) {
        let [_, top, width, height] = FIELD;
        let (left, right, bottom) = (self.left, self.left + width, top + height);
        let points = &report.points;
        let x = Scale::over(points.iter().map(|p| p.cost.seconds), [left, right]);
        let y = Scale::over(points.iter().map(|p| positive((self.error)(p)[0])), [bottom, top]);
        let _ = writeln!(
            out,
            "<text class=\"ink\" x=\"{left}\" y=\"{}\" font-weight=\"600\">{}</text>",
            top - 14.0,
            self.title
        );
        for tick in x.ticks(50.0) {
            let at = x.at(tick);
            let _ = writeln!(out, "<path class=\"grid\" d=\"M{at:.1} {top}V{bottom}\"/>");
            let label = if tick < 1.0 { format!("{} ms", short(tick * 1e3)) } else { format!("{} s", short(tick)) };
            let _ = writeln!(
                out,
                "<text class=\"soft\" x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{label}</text>",
                bottom + 17.0
            );
        }
        for tick in y.ticks(18.0) {
            let at = y.at(tick);
            let _ = writeln!(out, "<path class=\"grid\" d=\"M{left} {at:.1}H{right}\"/>");
            let _ = writeln!(
                out,
                "<text class=\"soft\" x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                left - 7.0,
                at + 4.0,
                short(tick)
            );
        }
        let rounding = y.at(self.rounding);
        if rounding > top && rounding < bottom {
            let _ = writeln!(
                out,
                "<path class=\"front\" stroke-dasharray=\"2 4\" opacity=\".6\" d=\"M{left} {rounding:.1}H{right}\"/>\
                 <text class=\"soft\" x=\"{}\" y=\"{:.1}\" font-size=\"11\">rounding to 8 bits alone</text>",
                left + 5.0,
                rounding - 4.0
            );
        }
        let at = |i: usize| (x.at(points[i].cost.seconds), y.at(positive((self.error)(&points[i])[0])));
        for (axis, row) in report.axes.iter().filter(|(axis, row)| axis.is_a_budget() && row.len() > 1) {
            let corners: Vec<String> = row.iter().map(|&i| at(i)).map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
            let _ = writeln!(
                out,
                "<polyline class=\"d{} line\" opacity=\".45\" points=\"{}\"/>",
                number_of(*axis),
                corners.join(" ")
            );
        }
        self.staircase(&at, right, out);
        for (i, point) in points.iter().enumerate() {
            let [_, least, most] = (self.error)(point);
            let (px, py) = at(i);
            let class = point.axes.first().map_or("front".into(), |a| format!("d{}", number_of(*a)));
            let (low, high) = (y.at(least), y.at(most));
            if low - high > 2.0 {
                let _ = writeln!(out, "<path class=\"{class}\" opacity=\".7\" d=\"M{px:.1} {low:.1}V{high:.1}\"/>");
            }
            let about = format!("{}: {}", point.setting, number((self.error)(point)[0]));
            let shape = mark(point.axes.first().map_or(1, |a| number_of(*a)), px, py);
            let _ = writeln!(out, "<g class=\"{class}\"><title>{}</title>{shape}</g>", escaped(&about));
            if i == 0 {
                let _ = writeln!(out, "<circle class=\"front\" cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"9\"/>");
            }
        }
        self.labels(report, &at, [left, right], out);
    }

    fn staircase(&self, at: &dyn Fn(usize) -> (f64, f64), right: f64, out: &mut String) {
        let mut path = String::new();
        for (k, &i) in self.front.iter().enumerate() {
            let (px, py) = at(i);
            let _ = if k == 0 { write!(path, "M{px:.1} {py:.1}") } else { write!(path, "H{px:.1}V{py:.1}") };
        }
        if !path.is_empty() {
            let _ = writeln!(out, "<path class=\"front\" stroke-width=\"1.6\" d=\"{path}H{right}\"/>");
        }
    }

    /// Names beside the points of the front, the knee and the scene's own setting, where there is room for them.
    fn labels(&self, report: &Report, at: &dyn Fn(usize) -> (f64, f64), [left, right]: [f64; 2], out: &mut String) {
        let marks: Vec<[f64; 4]> =
            (0..report.points.len()).map(at).map(|(x, y)| [x - 5.0, y - 5.0, x + 5.0, y + 5.0]).collect();
        let mut taken = marks;
        let named = report.verdict.knee.into_iter().chain([0]).chain(self.front.iter().copied());
        let mut done = Vec::new();
        for i in named {
            if done.contains(&i) {
                continue;
            }
            done.push(i);
            let mut name = report.points[i].label.clone();
            if report.verdict.knee == Some(i) {
                name += " (knee)";
            }
            let (px, py) = at(i);
            // Near enough for a sans-serif of this size.
            let (w, h) = (6.6 * name.chars().count() as f64, 13.0);
            let places =
                [(8.0, -7.0), (8.0, 15.0), (-8.0 - w, -7.0), (-8.0 - w, 15.0), (-0.5 * w, -13.0), (-0.5 * w, 22.0)];
            let free = |(dx, dy): &(f64, f64)| {
                let this = [px + dx, py + dy - h + 3.0, px + dx + w, py + dy + 3.0];
                let clear = |t: &[f64; 4]| t[2] <= this[0] || t[0] >= this[2] || t[3] <= this[1] || t[1] >= this[3];
                (this[0] > left && this[2] < right + 8.0 && taken.iter().all(clear)).then_some((this, *dx, *dy))
            };
            if let Some((place, dx, dy)) = places.iter().find_map(free) {
                taken.push(place);
                let _ = writeln!(
                    out,
                    "<text class=\"ink halo\" stroke-width=\"3\" paint-order=\"stroke\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
                    px + dx,
                    py + dy,
                    escaped(&name)
                );
            }
        }
    }
}

/// A mark of the dial's own form.
fn mark(dial: usize, x: f64, y: f64) -> String {
    match dial {
        0 => format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4.5\"/>"),
        1 => format!("<rect x=\"{:.1}\" y=\"{:.1}\" width=\"8\" height=\"8\"/>", x - 4.0, y - 4.0),
        2 => format!("<path d=\"M{x:.1} {:.1}l5 -9h-10z\"/>", y + 5.0),
        3 => format!("<path d=\"M{x:.1} {:.1}l5 9h-10z\"/>", y - 5.0),
        4 => format!("<path d=\"M{x:.1} {:.1}l5.5 5.5l-5.5 5.5l-5.5 -5.5z\"/>", y - 5.5),
        5 => format!("<path stroke-width=\"3\" d=\"M{:.1} {y:.1}h10M{x:.1} {:.1}v10\"/>", x - 5.0, y - 5.0),
        6 => format!("<path stroke-width=\"3\" d=\"M{:.1} {:.1}l8 8m0 -8l-8 8\"/>", x - 4.0, y - 4.0),
        _ => format!("<path stroke-width=\"3\" d=\"M{:.1} {y:.1}h10\"/>", x - 5.0),
    }
}

fn number_of(axis: Axis) -> usize {
    Axis::ALL.iter().position(|a| *a == axis).unwrap_or(0)
}

fn legend(report: &Report, out: &mut String) {
    let (mut x, y) = (FIELD[0], HEIGHT - 26.0);
    for (axis, row) in &report.axes {
        if row.is_empty() {
            continue;
        }
        let i = number_of(*axis);
        let _ = writeln!(out, "<g class=\"d{i}\">{}</g>", mark(i, x + 5.0, y - 4.0));
        let _ = writeln!(out, "<text class=\"ink\" x=\"{:.1}\" y=\"{y}\">{}</text>", x + 16.0, axis.word());
        x += 34.0 + 7.0 * axis.word().len() as f64;
    }
    let _ = writeln!(out, "<path class=\"front\" stroke-width=\"1.6\" d=\"M{x} {0}h7v7h7\"/>", y - 8.0);
    let _ = writeln!(out, "<text class=\"ink\" x=\"{}\" y=\"{y}\">front</text>", x + 20.0);
    let _ = writeln!(out, "<circle class=\"front\" cx=\"{}\" cy=\"{}\" r=\"6\"/>", x + 74.0, y - 4.0);
    let _ = writeln!(out, "<text class=\"ink\" x=\"{}\" y=\"{y}\">the scene's own setting</text>", x + 86.0);
    let _ = writeln!(
        out,
        "<text class=\"soft\" x=\"{}\" y=\"{y}\" text-anchor=\"end\">wall-clock time; bars: the reference's uncertainty</text>",
        WIDTH - 28.0
    );
}

/// A round number without zeros that say nothing.
fn short(x: f64) -> String {
    if x >= 1000.0 { format!("{:.0}k", x / 1000.0) } else { number(x) }
}

/// Text as XML has it.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
