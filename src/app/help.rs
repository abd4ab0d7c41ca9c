//! `rtdsl help`: any word of the language, from the same table that the language itself uses; or a command.

use super::args::{Cli, HelpArgs};
use super::view::nearest;
use super::{Exit, Stop};
use crate::diag::Diagnostic;
use crate::lang;
use clap::CommandFactory;
use std::io::{self, Write};

/// Runs the command.
///
/// # Errors
/// There is no such word, or standard output fails.
pub fn run(args: &HelpArgs) -> Result<Exit, Stop> {
    let text = match &args.topic {
        None => overview(),
        Some(topic) => about(topic)?,
    };
    io::stdout().write_all(text.as_bytes())?;
    Ok(Exit::Done)
}

fn overview() -> String {
    let mut text = Cli::command().render_help().to_string();
    text += "\nThe scene language; `rtdsl help WORD` tells of each of these, and of every color name of CSS:\n";
    for chapter in lang::chapters() {
        let topics = lang::chapter_topics(chapter);
        if !topics.is_empty() {
            text += &format!("\n{chapter}:\n{}", columns(&topics));
        }
    }
    text
}

/// A word of the language, a command, or both.
fn about(topic: &str) -> Result<String, Stop> {
    let mut cli = Cli::command();
    let command = cli.find_subcommand_mut(topic);
    match (lang::help(topic), command) {
        (Some(word), None) => Ok(word),
        (Some(word), Some(_)) => Ok(format!("{word}\n`rtdsl {topic} --help` tells of the command of that name.\n")),
        (None, Some(command)) => {
            let command = command.clone().bin_name(format!("rtdsl {topic}"));
            Ok(command.clone().render_long_help().to_string())
        }
        (None, None) => Err(unknown(topic)),
    }
}

fn unknown(topic: &str) -> Stop {
    let cli = Cli::command();
    let mut words = lang::topics();
    words.extend(lang::parameters());
    words.extend(cli.get_subcommands().map(|c| c.get_name()));
    let mut d = Diagnostic::error(format!("`{topic}` is neither a word of the scene language nor a command"));
    if let Some(near) = nearest(topic, &words) {
        d = d.note(format!("did you mean `{near}`?"));
    }
    Stop::usage(d.note("`rtdsl help` lists the words"))
}

/// `words` in lines of 80 columns.
fn columns(words: &[&str]) -> String {
    let width = words.iter().map(|w| w.chars().count()).max().unwrap_or(0) + 2;
    let in_a_line = (78 / width).max(1);
    let line = |words: &[&str]| words.iter().map(|w| format!("{w:<width$}")).collect::<String>();
    words.chunks(in_a_line).map(|c| format!("  {}\n", line(c).trim_end())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_topics() {
        assert!(about("explain").unwrap().contains("--max-depth"));
        let both = about("render").unwrap();
        assert!(both.contains("grid(2)") && both.contains("rtdsl render --help"), "{both}");
        assert!(about("no such word").is_err());
        let filter = about("filter").unwrap();
        assert!(filter.contains("filter(list, f)") && filter.contains("mitchell"), "function, and setting: {filter}");
        let shininess = about("shininess").unwrap();
        assert!(matches!(about("shinines"), Err(stop) if format!("{stop:?}").contains("did you mean `shininess`?")));
        assert!(shininess.starts_with("`shininess: …` is given to:\n\n  phong"), "{shininess}");
        let all = overview();
        assert!(["explain", "torus", "|>", "scatter"].iter().all(|w| all.contains(w)), "{all}");
        assert!(about("tomato").is_ok() && !all.contains("tomato"));
    }

    #[test]
    fn columns_stay_narrow() {
        let words = vec!["abcdefgh"; 20];
        let text = columns(&words);
        assert_eq!(text.lines().count(), 3);
        assert!(text.lines().all(|l| l.len() <= 80 && l.trim_end() == l));
    }
}
