//! Statements that are run as copies of one before them: they give what they would give if they were parsed.

use super::*;
use crate::lang::parse::parse;

/// Evaluates a text twice: with blanks in place of each `@@@@`, and with comments there, which are always parsed. Gives how many
/// statements were not parsed the first time.
fn same(text: &str) -> usize {
    let [quick, slow] = ["    ", "/**/"].map(|mark| text.replace("@@@@", mark));
    let likes = |text: &str| parse(FileId(0), text, &AtomicBool::new(false)).likes.len();
    assert_eq!(likes(&slow), 0, "{text}");
    match (evaluate(&request(&quick)), evaluate(&request(&slow))) {
        (Ok(a), Ok(b)) => {
            assert!(a.scene == b.scene, "{text}");
            assert_eq!(a.warnings, b.warnings, "{text}");
        }
        (Err(a), Err(b)) => assert_eq!(a.diagnostics, b.diagnostics, "{text}"),
        (Ok(_), Err(f)) | (Err(f), Ok(_)) => panic!("{text}\n{}", shown(&f)),
    }
    likes(&quick)
}

/// A statement with each of some lists of numbers in the places of `?`.
fn with_numbers(statement: &str) -> String {
    let numbers = ["1", "22.5", "0", "-3.25", "100", "0.125", "7", "-0", "2"];
    let mut all = String::new();
    for start in 0..12 {
        let mut next = numbers.iter().cycle().skip(start);
        let filled = statement.split('?').map(str::to_owned).reduce(|a, b| a + next.next().unwrap_or(&"1") + &b);
        all += &(filled.unwrap_or_default() + "\n");
    }
    all
}

#[test]
fn copies_give_what_their_text_says() {
    let before = "let m = matte(red)\nlet ms = [m, m, m]\nfn ball(x, r: 1) = sphere(at: [x, 0, 0], r: 1 + r * r)\n";
    let statements = [
        "sphere(at: [?, ?, ?],@@@@ r: 1)",
        "sphere(at: [?, ?,?],@@@@r: 0.5, mat: m)",
        "sphere(at: [ ? , ?, 1]@@@@, mat: ms[1])",
        "box(size: [2, 1, 1], at: [?, ?, ?]@@@@)",
        "ball(?@@@@)",
        "ball(@@@@?, r: ?)",
        "sphere(@@@@) |> move([?, ?, ?]) |> rotate(y: 30deg) |> scale(2)",
        "sphere(at: [?, sqrt(4), abs(?)]@@@@)",
        "sphere(at: [? + 1, -x(?), 0]@@@@)",
        "group { sphere(at: [?, ?, ?]@@@@) }",
        "sphere(at: [?, 0, 0], name: \"ball\"@@@@)",
    ];
    let mut likes = 0;
    for s in statements {
        let x = "fn x(a) = a * 2\n";
        likes += same(&format!("{before}{x}{}", with_numbers(s)));
    }
    assert!(likes > 80, "{likes}");
    let mixed: String = statements[..6].iter().map(|s| with_numbers(s)).collect();
    assert_eq!(same(&format!("{before}{mixed}{mixed}")), 6 * 24 - 6);
}

#[test]
fn their_mistakes_stand_where_they_are() {
    for s in [
        "sphere(r: ?@@@@)",
        "sphere(at: [?, ?, ?], raduis: ?@@@@)",
        "spere(r: ?@@@@)",
        "sphere(at: [?, ?],@@@@ r: 1)",
        "sphere(at: [1, ?, ?], r: [?]@@@@)",
        "sphere(r: sqrt(?)@@@@)",
        "bad(?, ?@@@@)",
        "?@@@@",
        "log(?@@@@)",
        "sphere(r: [1, 2, 3][?]@@@@)",
        "camera(from: [?, 0, 9],@@@@ at: [0, 0, 0])",
    ] {
        same(&format!("fn bad(a, b) = sphere(r: inner(a, b))\nfn inner(a, b) = a / b\n{}sphere()", with_numbers(s)));
    }
    let far = "sphere(at: [?, 0, 0], r: 0.000000000000000000001@@@@)";
    same(&with_numbers(far));
    same(
        "sphere(r:@@@@ 1)\nsphere(r:@@@@ 2)\nsphere(r:@@@@ 3e400)\nsphere(r:@@@@ 4.)\nsphere(r:@@@@ 0x5)\nsphere(r:@@@@ 6_0)",
    );
    same(&format!("sphere(r:@@@@ 1)\nsphere(r:@@@@ {})", "9".repeat(400)));
}

#[test]
fn what_names_mean_is_looked_up_again() {
    let gold = "sphere(at: [1, 0, 0]@@@@, mat: matte(gold))\n";
    for between in [
        "let gold = red\n",
        "var gold = red\n",
        "fn gold(x) = x\n",
        "import \"no.scene\" { gold }\n",
        "let gold = 1 2\n",
    ] {
        assert_eq!(same(&format!("{gold}{gold}{between}{gold}{gold}")), 2, "{between}");
    }
    assert_eq!(same("var n = 1\nsphere(r: n,@@@@ at: [1, 2, 3])\nn = 2\nsphere(r: n,@@@@ at: [4, 5, 6])"), 0);
    assert_eq!(same("sphere(r: 1@@@@)\nfor i in 0..2 { sphere(r: 2@@@@) }\nsphere(r: 3@@@@)"), 1);
}
