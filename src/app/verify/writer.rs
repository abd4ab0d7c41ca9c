//! Writes scenes that nobody would: numbers from the edges of what there is, shapes that touch, coincide and nest.

use crate::math::fun::pow;
use crate::math::hash::KeyedHash;

/// Draws numbers, the same for the same case.
pub struct Dice {
    key: KeyedHash,
    drawn: u64,
}

impl Dice {
    /// The draws of one case.
    pub fn new(seed: u64, case: u64) -> Dice {
        Dice { key: KeyedHash::new().with(seed).with(case), drawn: 0 }
    }
    /// Uniform in 0..1.
    pub fn unit(&mut self) -> f64 {
        self.drawn += 1;
        self.key.with(self.drawn).unit()
    }
    /// Uniform in -1..1.
    fn even(&mut self) -> f64 {
        self.unit() * 2.0 - 1.0
    }
    /// Whether something of this probability happens.
    pub fn chance(&mut self, p: f64) -> bool {
        self.unit() < p
    }
    /// One of `n`.
    fn below(&mut self, n: usize) -> usize {
        (self.unit() * n as f64) as usize
    }
    /// A power of ten, up or down by as many as `most` decades.
    fn decade(&mut self, most: f64) -> f64 {
        pow(10.0, (self.even() * most).trunc())
    }
    fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }
}

/// Texts of numbers at which programs break. Some are errors wherever they stand.
const NASTY: [&str; 25] = [
    "0",
    "-0",
    "0.0",
    "1",
    "-1",
    "0.5",
    "2",
    "1e-140",
    "-1e-140",
    "1e140",
    "-1e140",
    "1.0000000000000002",
    "0.9999999999999999",
    "9007199254740993",
    "1e-141",
    "1e141",
    "5e-324",
    "2.3e-308",
    "1e-310",
    "1e308",
    "0/0",
    "1/0",
    "1e300*1e300",
    "1e-200*1e-200",
    "3e-140*0.4",
];
/// How many of them are lengths.
const SUPPORTED: usize = 14;

/// A scene under way.
pub struct Writer {
    dice: Dice,
    /// How often a number is one of [`NASTY`], or of those of them that are supported.
    wild: f64,
    nasty: &'static [&'static str],
    /// How large the scene is.
    scale: f64,
    /// Numbers and points used before: what makes shapes coincide.
    numbers: Vec<String>,
    points: Vec<String>,
}

/// A scene's text: statements whose order must not matter, and those before them.
pub struct Written {
    /// Camera and settings.
    pub head: Vec<String>,
    /// Shapes and lights.
    pub things: Vec<String>,
}

impl Written {
    /// The text.
    pub fn text(&self) -> String {
        self.head.iter().chain(&self.things).map(|s| format!("{s}\n")).collect()
    }
    /// The text with its shapes and lights in reverse order.
    pub fn reversed(&self) -> String {
        self.head.iter().chain(self.things.iter().rev()).map(|s| format!("{s}\n")).collect()
    }
}

impl Writer {
    /// The scene of a case.
    pub fn scene(seed: u64, case: u64) -> Written {
        let mut dice = Dice::new(seed, case);
        let wild = dice.one_of(&[0.0, 0.0, 0.02, 0.1, 0.4]);
        let nasty = if dice.chance(0.5) { &NASTY[..SUPPORTED] } else { &NASTY[..] };
        let scale = match dice.below(4) {
            0 => dice.decade(139.0),
            1 => dice.decade(9.0),
            _ => 1.0,
        };
        let mut w = Writer { dice, wild, nasty, scale, numbers: Vec::new(), points: vec!["[0, 0, 0]".into()] };
        let mut things = Vec::new();
        for _ in 0..1 + w.dice.below(5) {
            things.push(w.thing(2));
        }
        for _ in 0..w.dice.below(4) {
            things.push(w.light());
        }
        if w.dice.chance(0.2) {
            let again = w.dice.below(things.len());
            things.push(things[again].clone());
        }
        let head = w.head();
        Written { head, things }
    }

    fn head(&mut self) -> Vec<String> {
        let depth = self.dice.one_of(&[0, 1, 2, 4, 6]);
        let aa = self.dice.one_of(&["", ", aa: grid(2)"]);
        let precision = if self.dice.chance(0.15) { ", precision: \"f32\"" } else { "" };
        let mut head = vec![format!("render(size: [8, 6], depth: {depth}{aa}{precision})")];
        if self.dice.chance(0.9) {
            // Towards something, as a rule.
            let at = self.point();
            let from = if self.dice.chance(0.6) {
                let away = [(); 3].map(|()| self.dice.even() * 8.0 * self.scale);
                format!("{at} + [{:e}, {:e}, {:e}]", away[0], away[1], away[2])
            } else {
                self.point()
            };
            let up = if self.dice.chance(0.3) { format!(", up: {}", self.direction()) } else { String::new() };
            let lens = match self.dice.below(5) {
                0 => format!(", height: {}", self.length()),
                1 => format!(
                    ", fov: {}deg",
                    self.one(&["1e-140", "5e-324", "1e-9", "179.99999999999997", "179", "90", "0"])
                ),
                2 => format!(", fov: {}deg", (self.dice.unit() * 180.0)),
                _ => String::new(),
            };
            head.push(format!("camera(from: {from}, at: {at}{up}{lens})"));
        }
        if self.dice.chance(0.6) {
            head.push(format!("background({})", self.color()));
        }
        if self.dice.chance(0.4) {
            head.push(format!("ambient({})", self.level()));
        }
        head
    }

    fn one(&mut self, all: &[&str]) -> String {
        self.dice.one_of(all).to_owned()
    }

    /// A coordinate, of the scene's scale as a rule.
    fn number(&mut self) -> String {
        if self.dice.chance(self.wild) {
            return self.one(self.nasty);
        }
        if !self.numbers.is_empty() && self.dice.chance(0.3) {
            let i = self.dice.below(self.numbers.len());
            return self.numbers[i].clone();
        }
        let x = match self.dice.below(12) {
            0 => 0.0,
            1 => self.dice.decade(12.0) * self.dice.even(),
            2..6 => (self.dice.even() * 4.0).round(),
            _ => self.dice.even() * 4.0,
        };
        let x = x * self.scale;
        let x = match self.dice.below(30) {
            0 => x.next_up(),
            1 => x.next_down(),
            2 => -x,
            _ => x,
        };
        let text = if x != 0.0 && x.abs() < 1e-300 { "0".into() } else { format!("{x:e}") };
        self.numbers.push(text.clone());
        text
    }

    /// A number above 0, as a rule.
    fn length(&mut self) -> String {
        let text = self.number();
        if self.dice.chance(self.wild) {
            return text;
        }
        let text = text.trim_start_matches('-').to_owned();
        if matches!(text.as_str(), "0e0" | "0" | "0.0") { format!("{:e}", self.scale) } else { text }
    }

    fn point(&mut self) -> String {
        if self.dice.chance(0.3) {
            let i = self.dice.below(self.points.len());
            return self.points[i].clone();
        }
        let text = format!("[{}, {}, {}]", self.number(), self.number(), self.number());
        self.points.push(text.clone());
        text
    }

    fn direction(&mut self) -> String {
        match self.dice.below(3) {
            0 => self.one(&[
                "[1, 0, 0]",
                "[0, 1, 0]",
                "[0, 0, -1]",
                "[0, -1, -0]",
                "[1e-140, 1e140, 0]",
                "[1, 1e-20, 0]",
            ]),
            _ => self.point(),
        }
    }

    /// An amount of light, or a share.
    fn level(&mut self) -> String {
        if self.dice.chance(self.wild) {
            return self.one(self.nasty);
        }
        match self.dice.below(8) {
            0 => self.one(&["0", "1", "-0", "100", "1e-30", "1e6", "1e7"]),
            _ => format!("{:e}", self.dice.unit()),
        }
    }

    fn color(&mut self) -> String {
        match self.dice.below(6) {
            0 => self.one(&["white", "black", "#f80", "skyblue"]),
            1 => format!("linear({}, {}, {})", self.level(), self.level(), self.level()),
            2 => format!("white * {}", self.level()),
            _ => format!("linear({})", self.level()),
        }
    }

    fn pattern(&mut self, deep: usize, of_numbers: bool) -> String {
        if deep == 0 || self.dice.chance(0.2) {
            return if of_numbers { self.level() } else { self.color() };
        }
        let a = self.pattern(deep - 1, of_numbers);
        let b = self.pattern(deep - 1, of_numbers);
        let axis = self.one(&["x", "y", "z"]);
        let p = match self.dice.below(12) {
            0 => format!("checker({a}, {b}, size: {})", self.length()),
            1 => format!("stripes({a}, {b}, axis: \"{axis}\", size: {})", self.length()),
            2 => format!("rings({a}, {b}, axis: \"{axis}\", size: {})", self.length()),
            3 => format!("gradient({a}, {b}, axis: \"{axis}\", size: {})", self.length()),
            4 => format!("noise({a}, {b}, octaves: {})", 1 + self.dice.below(16)),
            5 => format!("cells({a}, {b})"),
            6 => format!("brick({a}, {b}, size: [{}, {}], gap: {})", self.length(), self.length(), self.length()),
            7 => format!("mix({a}, {b}, noise())"),
            8 => format!("blend([{a}, {b}, {a}], by: gradient())"),
            9 => format!("(checker({a}, {b}) + noise({b}, {a}))"),
            10 => format!("(checker({a}, {b}) * stripes({b}, {a}))"),
            _ if of_numbers => format!("cells({b}, {a}, seed: 3)"),
            _ => {
                let map = self.one(&["spherical", "planar", "cylindrical", "normal"]);
                format!("image(\"earth.png\", map: \"{map}\")")
            }
        };
        let p = if self.dice.chance(0.2) { format!("{p} |> turbulence({})", self.length()) } else { p };
        if self.dice.chance(0.4) { format!("{p} |> {}", self.transform()) } else { p }
    }

    fn material(&mut self) -> String {
        match self.dice.below(9) {
            0 => format!("mirror(reflect: {})", self.level()),
            1 => format!("glass(ior: {})", self.one(&["1", "1.5", "1.0000000000000002", "10", "1.33"])),
            2 => format!("glass(tint: {})", self.pattern(1, false)),
            3 => format!("metal({})", self.color()),
            4 => format!("matte({})", self.pattern(2, false)),
            5 => format!(
                "phong(color: {}, specular: {}, shininess: {}, reflect: {}, transmit: {}, bump: {})",
                self.pattern(2, false),
                self.pattern(1, false),
                self.pattern(1, true),
                self.pattern(1, true),
                self.pattern(1, true),
                self.pattern(2, true)
            ),
            6 => format!("phong(color: {}, transmit: 0.5, ior: 1.5, bump: {})", self.color(), self.pattern(2, true)),
            7 => format!("phong(specular: {}, shininess: {})", self.level(), self.length()),
            _ => format!("plastic({})", self.color()),
        }
    }

    fn transform(&mut self) -> String {
        match self.dice.below(8) {
            0 => format!("scale({})", self.factor()),
            1 => format!("scale([{}, {}, {}])", self.factor(), self.factor(), self.factor()),
            2 => format!(
                "rotate({}: {}deg)",
                self.one(&["x", "y", "z"]),
                self.one(&["90", "30", "1e-9", "-0", "45", "180"])
            ),
            3 => format!("rotate(axis: {}, angle: {}deg)", self.direction(), self.dice.even() * 400.0),
            4 => format!("rotate(y: {}deg)", self.number()),
            _ => format!("move({})", self.point()),
        }
    }

    fn factor(&mut self) -> String {
        match self.dice.below(8) {
            0 => self.number(),
            1 => format!("{:e}", self.dice.decade(60.0)),
            2 => self.one(&["1", "-1", "2", "0.5", "1e-20", "1e20"]),
            _ => format!("{:e}", self.dice.unit() * 2.0 + 0.1),
        }
    }

    fn thing(&mut self, deep: usize) -> String {
        let thing = if deep > 0 && self.dice.chance(0.25) {
            let inner: Vec<String> = (0..self.dice.below(3)).map(|_| self.thing(deep - 1)).collect();
            let mat = if self.dice.chance(0.3) { format!("(mat: {})", self.material()) } else { String::new() };
            format!("group{mat} {{ {} }}", inner.join("; "))
        } else {
            self.shape()
        };
        let mut out = thing;
        while self.dice.chance(0.35) {
            out = format!("{out} |> {}", self.transform());
        }
        out
    }

    fn shape(&mut self) -> String {
        let mat = if self.dice.chance(0.7) { format!(", mat: {}", self.material()) } else { String::new() };
        let caps = self.one(&["true", "false"]);
        let d = match self.dice.below(14) {
            0 | 1 => format!("sphere(at: {}, r: {}", self.point(), self.length()),
            2 => format!("plane({}: {}", self.one(&["x", "y", "z"]), self.number()),
            3 => format!("plane(through: {}, normal: {}", self.point(), self.direction()),
            4 => format!("box(from: {}, to: {}", self.point(), self.point()),
            5 => format!("box(at: {}, size: [{}, {}, {}]", self.point(), self.length(), self.length(), self.length()),
            6 => {
                let (r, hole) = (self.length(), if self.dice.chance(0.5) { self.length() } else { "0".into() });
                format!("disc(at: {}, normal: {}, r: {r}, hole: {hole}", self.point(), self.direction())
            }
            7 => format!("cylinder(from: {}, to: {}, r: {}, caps: {caps}", self.point(), self.point(), self.length()),
            8 | 9 => {
                let top = if self.dice.chance(0.5) { self.length() } else { "0".into() };
                format!(
                    "cone(from: {}, to: {}, r: {}, top: {top}, caps: {caps}",
                    self.point(),
                    self.point(),
                    self.length()
                )
            }
            10 => {
                let r = self.length();
                let tube = match self.dice.below(3) {
                    0 => self.length(),
                    _ => format!("{r} * {}", self.one(&["0.25", "0.9999999999999999", "1e-9", "0.5", "1e-17"])),
                };
                format!("torus(at: {}, r: {r}, tube: {tube}, axis: {}", self.point(), self.direction())
            }
            11 => {
                let normals = if self.dice.chance(0.3) {
                    format!(", normals: [{}, {}, {}]", self.direction(), self.direction(), self.direction())
                } else {
                    String::new()
                };
                format!("triangle(points: [{}, {}, {}]{normals}", self.point(), self.point(), self.point())
            }
            12 => {
                format!("tetrahedron(points: [{}, {}, {}, {}]", self.point(), self.point(), self.point(), self.point())
            }
            _ => format!("tetrahedron(at: {}, size: {}", self.point(), self.length()),
        };
        format!("{d}{mat})")
    }

    fn light(&mut self) -> String {
        let extra = match self.dice.below(3) {
            0 => format!(", power: {}", self.level()),
            1 => format!(", color: {}", self.color()),
            _ => String::new(),
        };
        format!("light(at: {}{extra})", self.point())
    }
}
