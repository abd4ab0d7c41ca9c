//! Tokens of every class, of the examples, and of texts that are damaged.

use super::*;
use crate::lang::parse::parse;
use std::sync::atomic::AtomicBool;

/// Tokens as `class:text`, blanks left out.
fn shown(text: &str) -> Vec<String> {
    let tokens = highlight(text);
    let some = tokens.iter().filter(|t| t.class != Class::Blank);
    some.map(|t| format!("{:?}:{}", t.class, &text[t.range.clone()])).collect()
}

/// Whether the tokens are the text, piece by piece.
fn covers(text: &str) -> bool {
    let mut at = 0;
    for t in highlight(text) {
        if t.range.start != at || t.range.is_empty() || text.get(t.range.clone()).is_none() {
            return false;
        }
        at = t.range.end;
    }
    at == text.len()
}

#[test]
fn tokens_of_every_class() {
    assert_eq!(
        shown("rtdsl 1 // x\nlet a = sphere(r: 2.5e1deg, mat: matte(#f80)) |> move([-.5, 0..3, 50%])"),
        [
            "Keyword:rtdsl",
            "Number:1",
            "Comment:// x",
            "Keyword:let",
            "Name:a",
            "Sign:=",
            "Word:sphere",
            "Sign:(",
            "Argument:r",
            "Sign::",
            "Number:2.5e1deg",
            "Sign:,",
            "Argument:mat",
            "Sign::",
            "Word:matte",
            "Sign:(",
            "Color:#f80",
            "Sign:)",
            "Sign:)",
            "Sign:|>",
            "Word:move",
            "Sign:(",
            "Sign:[",
            "Sign:-",
            "Number:.5",
            "Sign:,",
            "Number:0",
            "Sign:..",
            "Number:3",
            "Sign:,",
            "Number:50%",
            "Sign:]",
            "Sign:)",
        ]
    );
}

#[test]
fn texts_are_parted_by_their_values() {
    assert_eq!(
        shown("f(\"a // {b + \"c\"} \\\" d\", 1)"),
        [
            "Name:f",
            "Sign:(",
            "Text:\"a // ",
            "Sign:{",
            "Name:b",
            "Sign:+",
            "Text:\"c\"",
            "Sign:}",
            "Text: \\\" d\"",
            "Sign:,",
            "Number:1",
            "Sign:)",
        ]
    );
    assert_eq!(shown("\"{a}{b}\""), ["Text:\"", "Sign:{", "Name:a", "Sign:}", "Sign:{", "Name:b", "Sign:}", "Text:\""]);
    assert_eq!(shown("let a = \"open\nlet b = 1")[3..5], ["Text:\"open", "Keyword:let"]);
}

#[test]
fn names_of_the_file_hide_words() {
    assert_eq!(
        shown("let box = std.box()\nbox"),
        ["Keyword:let", "Name:box", "Sign:=", "Name:std", "Sign:.", "Word:box", "Sign:(", "Sign:)", "Name:box"]
    );
    let class = |text: &str, word: &str| {
        let token = highlight(text).into_iter().rfind(|t| &text[t.range.clone()] == word);
        token.map(|t| t.class)
    };
    for text in [
        "fn f(sphere, b: 2) = sphere",
        "map(a, sphere => sphere)",
        "fold(a, (x, sphere) => sphere)",
        "import \"a.scene\" { x, sphere }\nsphere",
        "import \"a.scene\" { x as sphere }\nsphere",
        "for sphere in 0..2 { sphere }",
        "param sphere: 1\nsphere",
        "a.sphere",
    ] {
        assert_eq!(class(text, "sphere"), Some(Class::Name), "{text}");
    }
    assert_eq!(class("f((sphere))", "sphere"), Some(Class::Word));
    assert_eq!(class("param a: \"x\" of [\"x\"]", "of"), Some(Class::Keyword));
    assert_eq!(class("let of = 1", "of"), Some(Class::Name));
    assert_eq!(class("f(group: 1)", "group"), Some(Class::Keyword));
}

#[test]
fn every_byte_is_in_one_token_of_any_text() {
    for text in
        ["", "\n", "ä = #ggg \u{301} “x”", "/* /* */", "\"a{", "\"{\"{\"", "}}]", "1.2.3.4", "0x1F", "\\", "\r\n\t"]
    {
        assert!(covers(text), "{text:?}");
    }
    assert!(covers(&"(".repeat(10_000)));
    assert!(covers(&format!("{}// é", "a=>".repeat(10_000))));
    assert!(covers(&"9".repeat(10_000)));
    assert!(covers(&"1+".repeat(10_000)));
}

/// The examples whole, and cut and changed at places all over.
#[test]
fn every_byte_of_the_examples_and_of_damaged_ones() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let mut seen = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "scene") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(covers(&text), "{}", path.display());
        seen += 1;
        for at in (0..text.len()).step_by(97).filter(|&at| text.is_char_boundary(at)) {
            let (head, tail) = text.split_at(at);
            for damaged in [head.to_owned(), tail.to_owned(), format!("{head}\"{tail}"), format!("{head}{{/*é{tail}")]
            {
                assert!(covers(&damaged), "{} at {at}", path.display());
            }
        }
        agrees_with_the_grammar(&text);
    }
    assert!(seen > 10);
}

#[test]
fn brackets_without_end_take_no_square_of_time() {
    // Looked at anew for each bracket, any of these would keep a machine busy for the best part of an hour.
    for unit in ["(", "[", "{", "([{", "(a,", ")"] {
        let text = unit.repeat((1 << 20) / unit.len());
        assert_eq!(highlight(&text).len(), text.len(), "{unit}");
    }
}

#[test]
fn names_are_bound_by_the_right_brackets() {
    // Each of these hides a word of the catalogue, in brackets within brackets too, and where the text breaks off.
    for text in [
        "fn f(a, sphere) = sphere",
        "let f = ([1, (2, 3)], sphere) => sphere",
        "((a, sphere) => sphere",
        "import \"x.scene\" { a, sphere } sphere",
        "fn f(sphere, a: [",
    ] {
        assert!(!shown(text).contains(&"Word:sphere".to_string()), "{text}");
    }
    // None of these does.
    for text in ["f(a, sphere)", "([sphere]) => 1", "(a) + (sphere, 1)", "{ a, sphere }"] {
        assert!(shown(text).contains(&"Word:sphere".to_string()), "{text}");
    }
}

/// Comments and texts left out, a right text stays right; with the quotes of its texts lost, each is a mistake: so what is
/// shown as a comment is none to the grammar, and what is shown as a text is one.
fn agrees_with_the_grammar(text: &str) {
    let file = FileId(0);
    let tokens = highlight(text);
    let with = |change: &dyn Fn(&Token, &str) -> String| -> String {
        tokens.iter().map(|t| change(t, &text[t.range.clone()])).collect()
    };
    let parse = |text: &str| {
        let parsed = parse(file, text, &AtomicBool::new(false));
        (parsed.statements, parsed.errors)
    };
    let (whole, errors) = parse(text);
    assert!(errors.is_empty());
    let blank = |b: u8| if b == b'\n' { '\n' } else { ' ' };
    let lines = |t: &str| t.bytes().map(blank).collect::<String>();
    let bare = with(&|t, s| if t.class == Class::Comment { lines(s) } else { s.to_owned() });
    assert!(!bare.contains("//") || text.contains("\"//"), "a comment wasn't found");
    let (parsed, errors) = parse(&bare);
    assert!(errors.is_empty() && parsed.len() == whole.len());
    let places = |s: &[crate::lang::ast::Statement]| s.iter().map(|s| s.span).collect::<Vec<_>>();
    assert_eq!(places(&parsed), places(&whole), "only comments were taken out");
    // Whatever stands in a text, it stays one statement.
    let filled = with(&|t, s| match (t.class, s.len()) {
        (Class::Text, n) if n > 1 && s.starts_with('"') && s.ends_with('"') => format!("\"{}\"", "/".repeat(n - 2)),
        _ => s.to_owned(),
    });
    let (parsed, errors) = parse(&filled);
    assert!(errors.is_empty(), "{errors:?}");
    assert_eq!(places(&parsed), places(&whole), "only texts were filled");
}
