//! What a syntax error says could have stood there.

use super::parse::Rule;

/// What could have stood there, in words; the most telling ones only.
pub fn expectations(rules: &[Rule]) -> Vec<String> {
    let has = |r: Rule| rules.contains(&r);
    let closers: Vec<String> = [
        (Rule::comma, "`,`"),
        (Rule::close_paren, "a closing `)`"),
        (Rule::close_bracket, "a closing `]`"),
        (Rule::close_brace, "a closing `}`"),
    ]
    .into_iter()
    .filter(|(r, _)| has(*r))
    .map(|(_, w)| w.to_owned())
    .collect();
    let value = [Rule::expr, Rule::true_, Rule::prefix, Rule::color, Rule::digits].into_iter().any(has);
    let mut out = Vec::new();
    if value {
        out.push("a value".to_owned());
        if !has(Rule::comma) {
            out.extend(closers);
        }
        return out;
    }
    let others = [
        (Rule::ident, "a name"),
        (Rule::equals, "`=`"),
        (Rule::colon, "`:`"),
        (Rule::kw_let, "`let`"),
        (Rule::kw_fn, "`fn`"),
        (Rule::kw_in, "`in`"),
        (Rule::kw_as, "`as`"),
        (Rule::params, "parameters in `( )`"),
        (Rule::block, "a block in `{ }`"),
        (Rule::import_names, "names in `{ }`"),
        (Rule::text, "a text in quotes"),
    ];
    out.extend(others.into_iter().filter(|(r, _)| has(*r)).map(|(_, w)| w.to_owned()));
    out.extend(closers);
    if has(Rule::kw_as) && has(Rule::open_brace) {
        out.push("names in `{ }`".into());
    }
    if has(Rule::open_brace) && !out.iter().any(|w| w.contains("{ }")) {
        out.push("a block in `{ }`".into());
    }
    if out.is_empty() && (has(Rule::operator) || has(Rule::arrow)) {
        out.push("an operator or the end of the statement".into());
    }
    out
}
