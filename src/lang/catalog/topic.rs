//! Keywords, operators and signs of the language as topics of help and of the reference. What they do is in the grammar
//! and the evaluator; here it is said.

/// A part of the language that isn't a word of the catalogue.
#[derive(Debug)]
pub struct Topic {
    /// What it is asked for by; the first is its heading.
    pub names: &'static [&'static str],
    /// How it is written.
    pub form: &'static str,
    /// One or a few sentences.
    pub doc: &'static str,
    /// A complete program.
    pub example: &'static str,
    /// Other topics.
    pub see: &'static [&'static str],
}

/// All of them, in the order of the reference.
pub const TOPICS: &[Topic] = &[
    Topic {
        names: &["rtdsl"],
        form: "rtdsl 1",
        doc: "The first line may say which edition of the language the file is written in.",
        example: "rtdsl 1\nsphere()\nlight(at: [4, 8, 6])",
        see: &["//"],
    },
    Topic {
        names: &["//", "/*", "*/", "///"],
        form: "// to the end of the line      /* also over several lines */      /// about what follows",
        doc: "Comments; `/* */` may stand within each other, and `///` is for the reader of what follows.",
        example: "/// A marble: everything is round here.\nfn marble(at) = sphere(at: at, r: 0.5) // half a unit\nmarble([0, 0, 0])\nlight(at: [4, 8, 6])",
        see: &["rtdsl"],
    },
    Topic {
        names: &["number"],
        form: "12      0.5      .5      1_000_000      2e-3      50%",
        doc: "A number; `50%` is 0.5. Every number is a 64-bit float, and a calculation whose result isn't a finite number is an error.",
        example: "let half = 50%        // → 0.5\nlet million = 1_000_000       // → 1000000\nsphere(r: 1.5)\nlight(at: [4, 8, 6])",
        see: &["units", "+", "abs", "floor", "pi"],
    },
    Topic {
        names: &["units", "angle", "deg", "rad", "turn"],
        form: "90deg      0.25turn      1.57rad",
        doc: "An angle carries its unit; a bare number is none. Angles add to angles, scale by numbers, and divided by each other give a number. A length has no unit: it is in scene units.",
        example: "let right = 0.25turn      // → 90deg\nlet degrees = right / 1deg        // → 90\nlet tilt = 30 * 1deg      // → 30deg\nbox() |> rotate(y: tilt)\nlight(at: [4, 8, 6])",
        see: &["number", "sin", "atan2", "rotate"],
    },
    Topic {
        names: &["text", "\""],
        form: "\"any characters\"      \"with {a value} in it\"",
        doc: "A text; what stands in `{ }` is evaluated. `\\n` is a new line, `\\t` a tab, and `\\\"`, `\\\\`, `\\{`, `\\}` are those characters.",
        example: "let n = 3\nlet label = \"{n} balls, {n * n} pairs\"        // → \"3 balls, 9 pairs\"\nfor i in 0..n { sphere(at: [2.5 * i, 0, 0], name: \"ball {i}\") }\nlight(at: [4, 8, 6])",
        see: &["join", "contains", "len"],
    },
    Topic {
        names: &["#", "#rrggbb"],
        form: "#f80      #ff8800",
        doc: "A color by its sRGB code, as in HTML. `.r`, `.g` and `.b` give a color's linear channels.",
        example: "sphere(mat: matte(#ff8800))\nlight(at: [4, 8, 6])",
        see: &["rgb", "linear", "hsv", "oklch", "gray", "mix"],
    },
    Topic {
        names: &["list", "[", "]", "[]"],
        form: "[1, 2, 3]      list[0]      [for x in list { … }]",
        doc: "A list. Its values are counted from 0; `for` and `if` in the brackets add what their blocks give. Lists of numbers add, subtract, multiply and divide item by item, and scale by a number.",
        example: "let squares = [for i in 0..5 { i * i }]       // → [0, 1, 4, 9, 16]\nlet nine = squares[3]     // → 9\nlet moved = [1, 2, 3] + 2 * [1, 0, 0]     // → [3, 2, 3]",
        see: &["vector", "for", "..", "map", "len"],
    },
    Topic {
        names: &["vector", ".x", ".y", ".z"],
        form: "[x, y, z]      v.x      v.y      v.z",
        doc: "A point, direction or size is a list of three numbers: x to the right, y up, z towards the viewer.",
        example: "let p = [1, 2, 3]\nlet height = p.y      // → 2\nsphere(at: p * 0.5 + [0, 1, 0])\nlight(at: [4, 8, 6])",
        see: &["list", "length", "dot", "cross", "move"],
    },
    Topic {
        names: &[".", "with", ".with"],
        form: "value.name      record.with(name: value)      material.with(slot: value)",
        doc: "A part of a record, material, vector, color or module; and a copy of a record or material with some parts changed.",
        example: "let shiny = phong(specular: 0.5, shininess: 60)\nsphere(mat: shiny.with(color: tomato))\nsphere(at: [2.5, 0, 0], mat: shiny.with(color: teal, reflect: shiny.specular / 2))\nlight(at: [4, 8, 6])",
        see: &["record", "phong", "import"],
    },
    Topic {
        names: &["+", "-", "*", "/"],
        form: "a + b      a - b      a * b      a / b      -a",
        doc: "Arithmetic on numbers, angles, lists, colors and patterns. Colors are calculated with in linear light; a pattern with a number, color or pattern makes a pattern.",
        example: "let seven = 1 + 2 * 3     // → 7\nlet soft = checker(0.2, 0.8) * 0.5 + 0.1\nsphere(mat: phong(color: orange * 0.8, reflect: soft))\nlight(at: [4, 8, 6])",
        see: &["%", "^", "number", "units"],
    },
    Topic {
        names: &["%"],
        form: "a % b      50%",
        doc: "The remainder of a division, with the sign of b, so that it goes on evenly below 0. Directly after a number, and with no value after it, `%` means hundredths.",
        example: "let one = 7 % 3       // → 1\nlet two = -1 % 3      // → 2\nlet quarter = 25%     // → 0.25",
        see: &["+", "floor"],
    },
    Topic {
        names: &["^"],
        form: "a ^ b",
        doc: "a to the power of b. It binds more strongly than a sign and groups to the right.",
        example: "let eight = 2 ^ 3     // → 8\nlet below = -2 ^ 2    // → -4",
        see: &["pow", "sqrt", "exp"],
    },
    Topic {
        names: &["==", "!=", "<", "<=", ">", ">="],
        form: "a == b      a != b      a < b      a <= b      a > b      a >= b",
        doc: "Comparisons: true or false. Anything but functions can be equal; numbers, angles and texts have an order.",
        example: "let yes = 1 < 2 and [1, 2] == [1, 2]      // → true",
        see: &["and", "if"],
    },
    Topic {
        names: &["and", "or", "not"],
        form: "a and b      a or b      not a",
        doc: "True or false from true or false; the right side of `and` and `or` is looked at only when it matters.",
        example: "for i in 0..12 if i % 2 == 0 or not i > 6 { sphere(at: [i, 0, 0], r: 0.4) }\ncamera(from: [5, 2, 14], at: [5, 0, 0])\nlight(at: [4, 8, 6])",
        see: &["==", "if", "true"],
    },
    Topic {
        names: &["true", "false"],
        form: "true      false",
        doc: "The two truth values.",
        example: "let hollow = true\ncylinder(to: [0, 2, 0], caps: not hollow)\nlight(at: [4, 8, 6])",
        see: &["and", "if"],
    },
    Topic {
        names: &["..", "..="],
        form: "from..to      from..=to",
        doc: "The range of numbers from one number to another in steps of 1; `..` leaves out the end, `..=` includes it. It goes wherever a list does.",
        example: "let three = len(0..3)     // → 3\nfor i in 1..=5 { sphere(at: [2 * i, 0, 0], r: i / 6) }\ncamera(from: [6, 2, 14], at: [6, 0, 0])\nlight(at: [4, 8, 6])",
        see: &["for", "steps", "list"],
    },
    Topic {
        names: &["|>"],
        form: "x |> f(y)      which is      f(x, y)",
        doc: "Passes a value on as the first argument of a function, so that what is done is read in the order in which it is done.",
        example: "box(size: [2, 1, 1])\n  |> rotate(z: 30deg)\n  |> move([0, 1, 0])\nlight(at: [4, 8, 6])",
        see: &["move", "rotate", "scale", "map", "fn"],
    },
    Topic {
        names: &["let"],
        form: "let name = value",
        doc: "Gives a value a name, for good: binding the same name twice in one block is an error.",
        example: "let size = 0.5\nsphere(r: size)\nsphere(at: [2, 0, 0], r: 2 * size)\nlight(at: [4, 8, 6])",
        see: &["var", "fn", "param", "export"],
    },
    Topic {
        names: &["var", "=", "+=", "-=", "*=", "/="],
        form: "var name = value      name = value      name += value",
        doc: "A name whose value may change, in the block in which it stands and in loops there; functions can't see it.",
        example: "var height = 0\nfor i in 0..5 {\n  let r = 1 - 0.15 * i\n  sphere(at: [0, height, 0], r: r)\n  height += 1.5 * r\n}\ncamera(from: [0, 4, 12], at: [0, 2.5, 0])\nlight(at: [4, 8, 6])",
        see: &["let", "for", "while", "fold"],
    },
    Topic {
        names: &["fn"],
        form: "fn name(a, b: 2) = value      fn name(a) { … }",
        doc: "A function. Parameters without a default go by position or by name, those with one by name; the last expression of a block is its value.",
        example: "fn pawn(x, z, height: 2) = group {\n  cone(from: [x, 0, z], to: [x, height, z], r: 0.6)\n  sphere(at: [x, height, z], r: 0.4)\n}\nfor i in 0..4 { pawn(2 * i, 0, height: 1.5 + 0.5 * i) }\ncamera(from: [3, 4, 12], at: [3, 1, 0])\nlight(at: [4, 8, 6])",
        see: &["=>", "|>", "let"],
    },
    Topic {
        names: &["=>"],
        form: "x => value      (x, y) => value",
        doc: "A function without a name, to be passed to another.",
        example: "let squares = map(0..4, x => x * x)       // → [0, 1, 4, 9]",
        see: &["fn", "map", "filter", "fold"],
    },
    Topic {
        names: &["{", "}", "block"],
        form: "{ let a = 2; a * a }",
        doc: "A block: statements, one a line or parted by `;`. Its names end with it; its last expression is its value.",
        example: "let area = {\n  let r = 3\n  pi * r ^ 2\n}\nlet rounded = round(area)     // → 28",
        see: &["fn", "if", "for", "group"],
    },
    Topic {
        names: &["if", "else"],
        form: "if condition { … } else if condition { … } else { … }",
        doc: "A choice. As a value it needs an `else`; among shapes and in lists it may do without.",
        example: "for i in 0..8 {\n  let skin = if i % 2 == 0 { matte(tomato) } else { mirror() }\n  sphere(at: [2.2 * i, 0, 0], mat: skin)\n  if i == 4 { box(at: [2.2 * i, 2, 0]) }\n}\ncamera(from: [8, 3, 20], at: [8, 0, 0])\nlight(at: [4, 8, 6])",
        see: &["and", "==", "for"],
    },
    Topic {
        names: &["for", "in"],
        form: "for name in list { … }      for name in list if condition { … }",
        doc: "Does something with each value of a list or range: among shapes it adds shapes, in a list's brackets it adds values.",
        example: "for x in -2..=2 {\n  for z in -2..=2 if x != z { sphere(at: [x, 0, z], r: 0.4) }\n}\nlight(at: [4, 8, 6])",
        see: &["..", "while", "map", "list"],
    },
    Topic {
        names: &["while"],
        form: "while condition { … }",
        doc: "Repeats a block as long as a condition holds. It is for calculating with `var`s and adds no shapes.",
        example: "var n = 0\nvar r = 1\nwhile r > 0.05 {\n  r *= 0.7\n  n += 1\n}\nlet steps_taken = n      // → 9\nfor i in 0..n { sphere(at: [2 * i, 0, 0], r: 0.7 ^ i) }\ncamera(from: [7, 3, 18], at: [7, 0, 0])\nlight(at: [4, 8, 6])",
        see: &["for", "var"],
    },
    Topic {
        names: &["param", "of"],
        form: "param name: default in 1..=9 \"what it is\"      param name: \"a\" of [\"a\", \"b\"]",
        doc: "A value that can be set from outside: `--set name=value` on the command line, within the range or list that it names. `rtdsl params FILE` lists them.",
        example: "param count: 12 in 1..=99 \"how many balls\"\nparam style: \"matte\" of [\"matte\", \"mirror\"]\nlet skin = if style == \"matte\" { matte(tomato) } else { mirror() }\nfor i in 0..count { sphere(at: 3 * [cos(i * 1turn / count), 0, sin(i * 1turn / count)], r: 0.5, mat: skin) }\nlight(at: [4, 8, 6])",
        see: &["let"],
    },
    Topic {
        names: &["import", "as"],
        form: "import \"file.scene\" { name, name as other }      import \"file.scene\" as module",
        doc: "Takes what another file exports. The path starts at the folder of the importing file; the other file's own shapes and settings are left out.",
        example: "import \"lib/trees.scene\" { oak, fir as pine }\noak(1)\npine(2) |> move([2, 0, 0])\nlight(at: [4, 8, 6])",
        see: &["export", "."],
    },
    Topic {
        names: &["export"],
        form: "export let name = value      export fn name(…) = value",
        doc: "Lets other files import a name of this one.",
        example: "export let brass = metal(#c8a24a)\nexport fn bead(at) = sphere(at: at, r: 0.2, mat: brass)",
        see: &["import", "let", "fn"],
    },
    Topic {
        names: &["std"],
        form: "std.sphere",
        doc: "The built-in words, even where a name of the scene hides one.",
        example: "let box = std.box(size: [1, 2, 1])\nbox\nbox |> move([2, 0, 0])\nlight(at: [4, 8, 6])",
        see: &["let"],
    },
];
