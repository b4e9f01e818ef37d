//! Translates the command line to Chinese with the texts of
//! `assets/tables/command-line.tsv`. A row holds the English text of a command or option
//! (`text`), the name of a value (`value`), or a sentence of clap with `{}` for its variable
//! parts (`clap`). The table is parsed only if a Chinese text is shown, so that other starts
//! pay nothing for it.

use std::collections::BTreeMap;
use std::error::Error as _;
use std::ffi::OsString;

use clap::builder::{PossibleValue, Str, StyledStr};
use clap::{Arg, Command, CommandFactory, Error};
use gsk_host::network::class::class_address::ClassAddressError;
use gsk_host::network::mqtt::MqttOptionError;
use gsk_host::network::mtconnect::AgentOptionError;
use gsk_host::setup_args::OptionValueError;
use gsk_messages::{Language, Message};
use gsk_plot::InvalidPictureSize;
use gsk_transfer::FileNameError;

use super::CommandLine;

static TABLE_TEXT: &str = include_str!("../../../assets/tables/command-line.tsv");

/// Map from the English texts of the command line to their Chinese translations.
type Texts = BTreeMap<&'static str, &'static str>;

/// The rows of the translation table, by the kind in their first column.
struct ChineseTexts {
    texts: Texts,
    values: Texts,
    clap: Texts,
}

impl ChineseTexts {
    fn read() -> Self {
        let rows_of_kind = |wanted: &str| {
            let rows = TABLE_TEXT.lines().skip(1).filter_map(|line| {
                let (kind, texts) = line.split_once('\t')?;
                texts.split_once('\t').filter(|_| kind == wanted)
            });
            rows.collect()
        };
        Self {
            texts: rows_of_kind("text"),
            values: rows_of_kind("value"),
            clap: rows_of_kind("clap"),
        }
    }

    /// Translates a text of a command or option line by line. A line that the table lacks
    /// stays English.
    fn translate_text(&self, english: &StyledStr) -> String {
        let translate = |line: &str| {
            let text = line.trim_start();
            let indent = &line[..line.len() - text.len()];
            format!("{indent}{}", self.texts.get(text).unwrap_or(&text))
        };
        let english = english.to_string();
        english
            .lines()
            .map(translate)
            .collect::<Vec<_>>()
            .join("\n")
    }

    /// Translates the sentences that clap has added to a text.
    fn translate_rendered(&self, rendered: &str) -> String {
        let mut out = String::new();
        for line in rendered.lines() {
            let line = self.clap.iter().fold(line.to_owned(), |line, (en, zh)| {
                replace_sentence(&line, en, zh).unwrap_or(line)
            });
            out.push_str(&line);
            out.push('\n');
        }
        out
    }

    /// Translates all texts of a command and of its subcommands.
    fn translate_command(&self, command: Command) -> Command {
        let about = command.get_about().map(|text| self.translate_text(text));
        let long_about = command
            .get_long_about()
            .map(|text| self.translate_text(text));
        let after = command
            .get_after_help()
            .map(|text| self.translate_text(text));
        let mut command = command
            .mut_subcommands(|subcommand| self.translate_command(subcommand))
            .mut_args(|argument| self.translate_argument(argument))
            .subcommand_value_name(self.values.get("COMMAND").copied());
        if let Some(text) = about {
            command = command.about(text);
        }
        if let Some(text) = long_about {
            command = command.long_about(text);
        }
        match after {
            Some(text) => command.after_help(text),
            None => command,
        }
    }

    fn translate_argument(&self, argument: Arg) -> Arg {
        let short = argument.get_help().map(|text| self.translate_text(text));
        let long = argument
            .get_long_help()
            .map(|text| self.translate_text(text));
        let heading = argument.get_help_heading();
        let heading = heading.and_then(|text| self.texts.get(text).copied());
        let names = argument.get_value_names().unwrap_or_default().iter();
        let names: Vec<Str> = names
            .map(|name| {
                self.values
                    .get(name.as_str())
                    .map_or(name.clone(), Str::from)
            })
            .collect();
        let values = argument.get_possible_values();
        let lists_values = !values.is_empty() && argument.get_action().takes_values();
        let mut argument = argument.hide_possible_values(true);
        if !names.is_empty() {
            argument = argument.value_names(names);
        }
        if let Some(heading) = heading {
            argument = argument.help_heading(heading);
        }
        let Some(short) = short else {
            return argument;
        };
        let long = long.unwrap_or_else(|| short.clone());
        // The list of clap could break over two lines: write it here.
        if lists_values {
            let names = values.iter().map(PossibleValue::get_name);
            let names = names.collect::<Vec<_>>().join(", ");
            let lines = values.iter().map(|value| self.format_possible_value(value));
            let list = lines.collect::<String>();
            argument
                .help(format!("{short} [可用值: {names}]"))
                .long_help(format!("{long}\n\n可用值:{list}"))
        } else {
            argument.help(short).long_help(long)
        }
    }

    /// Formats one line of the list of possible values of an option.
    fn format_possible_value(&self, value: &PossibleValue) -> String {
        let name = value.get_name();
        match value.get_help() {
            Some(help) => format!("\n- {name}: {}", self.translate_text(help)),
            None => format!("\n- {name}"),
        }
    }
}

/// Replaces the English sentence of clap in a line by the Chinese one; `None` if the line does
/// not contain it.
fn replace_sentence(line: &str, english: &str, chinese: &str) -> Option<String> {
    let mut parts = english.split("{}");
    let first = parts.next()?;
    let begin = line.find(first)?;
    let mut at = begin + first.len();
    let mut values = Vec::new();
    for part in parts {
        let length = match part.is_empty() {
            true => line.len() - at,
            false => line[at..].find(part)?,
        };
        values.push(&line[at..at + length]);
        at += length + part.len();
    }
    let mut out = line[..begin].to_owned();
    let mut values = values.into_iter();
    for (number, part) in chinese.split("{}").enumerate() {
        if number > 0 {
            out.push_str(values.next()?);
        }
        out.push_str(part);
    }
    out.push_str(&line[at..]);
    Some(out)
}

/// The reason why a value is invalid, as the English text in the error and as a message;
/// `None` if no parser of this program reported it.
fn find_reason(error: &Error) -> Option<(String, Message)> {
    let source = error.source()?;
    let word = || source.downcast_ref().map(OptionValueError::message);
    let name = || source.downcast_ref().map(FileNameError::message);
    let size = || source.downcast_ref().map(InvalidPictureSize::message);
    let agent = || source.downcast_ref().map(AgentOptionError::message);
    let broker = || source.downcast_ref().map(MqttOptionError::message);
    let message = word().or_else(name).or_else(size);
    let class = || source.downcast_ref().map(ClassAddressError::message);
    let message = message.or_else(agent).or_else(broker).or_else(class)?;
    Some((source.to_string(), message))
}

/// Returns the command line parser with all texts in Chinese.
pub fn chinese_command() -> Command {
    let mut command = CommandLine::command();
    // Options are built when their command is called.
    command.build();
    ChineseTexts::read().translate_command(command)
}

/// Translates the sentences of clap in a rendered text of [`chinese_command`].
pub fn translate_clap_text(rendered: &str) -> String {
    ChineseTexts::read().translate_rendered(rendered)
}

/// Parses the command line `words` and returns the Chinese error, or the Chinese help if
/// requested; `None` if the command line is correct. `hint` adds a usage hint to an error.
pub fn translate_error(words: &[OsString], hint: fn(Error, Language) -> Error) -> Option<Error> {
    let error = chinese_command().try_get_matches_from_mut(words).err()?;
    let error = hint(error, Language::Zh);
    let mut rendered = error.render().ansi().to_string();
    if let Some((english, message)) = find_reason(&error) {
        rendered = rendered.replacen(&english, &message.text(Language::Zh), 1);
    }
    // An overridden help text: clap prints it where it would have printed its own, in
    // colours if the terminal has them.
    let text = StyledStr::from(translate_clap_text(&rendered));
    let mut command = Command::new("gsk980td").override_help(text);
    match error.use_stderr() {
        true => {
            command = command.arg_required_else_help(true);
            command.try_get_matches_from(["gsk980td"]).err()
        }
        false => command.try_get_matches_from(["gsk980td", "--help"]).err(),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    /// Texts that are the same in both languages: names and lines of scripts.
    const NAMES: [&str; 10] = [
        "CR",
        "CR LF",
        "FluidNC",
        "GSK980MDi",
        "GSK980TD",
        "Grbl 1.1h",
        "LF",
        "NC-B08",
        "grblHAL",
        "press AUTO",
    ];

    /// Collects the visible commands, each with the words that call it.
    fn collect_commands(command: &Command, words: &str, out: &mut Vec<(String, Command)>) {
        out.push((words.to_owned(), command.clone()));
        for subcommand in command.get_subcommands().filter(|it| !it.is_hide_set()) {
            let words = format!("{words} {}", subcommand.get_name());
            collect_commands(subcommand, words.trim(), out);
        }
    }

    fn all_commands(mut program: Command) -> Vec<(String, Command)> {
        program.build();
        let mut out = Vec::new();
        collect_commands(&program, "", &mut out);
        out
    }

    /// Returns all lines of the help texts of a command and its options.
    fn help_lines(command: &Command) -> BTreeSet<String> {
        let mut texts = vec![
            command.get_about(),
            command.get_long_about(),
            command.get_after_help(),
        ];
        let mut lines = BTreeSet::new();
        let visible = command.get_arguments().filter(|it| !it.is_hide_set());
        let arguments: Vec<&Arg> = visible.collect();
        let values: Vec<_> = arguments
            .iter()
            .filter(|it| it.get_action().takes_values())
            .flat_map(|it| it.get_possible_values())
            .collect();
        texts.extend(values.iter().map(|it| it.get_help()));
        for argument in arguments {
            texts.extend([argument.get_help(), argument.get_long_help()]);
            lines.extend(argument.get_help_heading().map(str::to_owned));
        }
        for text in texts.into_iter().flatten() {
            let text = text.to_string();
            lines.extend(text.lines().map(|line| line.trim().to_owned()));
        }
        lines.remove("");
        lines
    }

    #[test]
    fn every_command_and_option_has_a_chinese_text_and_no_row_is_unused() {
        let table = ChineseTexts::read();
        let forms = gsk_panel::script::FORMS;
        let example = ["press CS", "wait idle 10m", "expect alarm none"];
        let same = |line: &str| {
            NAMES.contains(&line) || example.contains(&line) || forms.iter().any(|it| it.1 == line)
        };
        let mut used = BTreeSet::new();
        let mut names = BTreeSet::from(["COMMAND".to_owned()]);
        let mut missing = BTreeSet::new();
        for (words, command) in all_commands(CommandLine::command()) {
            for line in help_lines(&command).into_iter().filter(|line| !same(line)) {
                if !table.texts.contains_key(&*line) {
                    missing.insert(format!("{words}: {line}"));
                }
                used.insert(line);
            }
            let visible = command.get_arguments().filter(|it| !it.is_hide_set());
            for argument in visible.filter(|it| it.get_action().takes_values()) {
                for name in argument.get_value_names().unwrap_or_default() {
                    let capital = |letter: char| !letter.is_ascii_uppercase();
                    let word = name.split(capital).any(|word| word.len() > 2);
                    if word && !table.values.contains_key(name.as_str()) {
                        missing.insert(format!("{words}: {name}"));
                    }
                    names.insert(name.to_string());
                }
            }
        }
        assert!(missing.is_empty(), "{missing:#?}");
        let text = table.texts.keys().filter(|row| !used.contains(**row));
        let value = table.values.keys().filter(|row| !names.contains(**row));
        let unused: Vec<_> = text.chain(value).collect();
        assert!(unused.is_empty(), "{unused:#?}");
    }

    #[test]
    fn the_table_is_sorted_and_its_texts_differ() {
        let rows: Vec<&str> = TABLE_TEXT.lines().skip(1).collect();
        assert!(rows.is_sorted_by(|a, b| a < b));
        for row in rows {
            let fields: Vec<&str> = row.split('\t').collect();
            let [kind, en, zh] = fields[..] else {
                panic!("{row}");
            };
            assert!(["clap", "text", "value"].contains(&kind), "{row}");
            assert!(!en.is_empty() && en != zh, "{row}");
            assert_eq!(en.matches("{}").count(), zh.matches("{}").count(), "{row}");
            assert!(!zh.is_ascii(), "{row}");
        }
    }

    /// The first line of `text` that contains an English word of clap, which lines of scripts
    /// do not; `None` if there is none.
    fn find_english(text: &str) -> Option<&str> {
        let words = [
            "Usage",
            "Options",
            "Arguments",
            "Commands",
            "default:",
            "possible",
            "error:",
            "tip:",
            "For more",
            "OPTIONS",
            "COMMAND]",
            "Print",
            "subcommand",
            "argument",
            "required",
            "invalid",
            "unexpected",
            "provided",
        ];
        text.lines()
            .find(|line| words.iter().any(|word| line.contains(word)))
    }

    #[test]
    fn help_is_chinese_from_the_first_line_to_the_last() {
        for (words, command) in all_commands(chinese_command()) {
            for help in [
                command.clone().render_help(),
                command.clone().render_long_help(),
            ] {
                let help = translate_clap_text(&help.to_string());
                assert_eq!(find_english(&help), None, "{words}:\n{help}");
                assert!(help.contains("用法："), "{help}");
            }
        }
    }

    fn error_texts(line: &str) -> [String; 2] {
        let words: Vec<OsString> = line.split(' ').map(OsString::from).collect();
        let english = CommandLine::command().try_get_matches_from(&words);
        let chinese = translate_error(&words, |error, _| error).expect(line);
        [english.expect_err(line), chinese].map(|it| it.to_string())
    }

    #[test]
    fn every_sentence_of_clap_has_a_chinese_text() {
        let table = ChineseTexts::read();
        let mut used = BTreeSet::new();
        for line in [
            "gsk980td check",
            "gsk980td check --frmat x",
            "gsk980td check a --json=1",
            "gsk980td check a --format x",
            "gsk980td check a --format githob",
            "gsk980td check a --json --json",
            "gsk980td check a --json --format human",
            "gsk980td check a --format",
            "gsk980td check a -- --x --y -z --wrong=5 --format=x --json --lang=zh --part --most-moves=0",
            "gsk980td check a --most-moves=0",
            "gsk980td check a --most-moves=99999999999999999999",
            "gsk980td check a --most-moves=x",
            "gsk980td check a --most-moves=",
            "gsk980td check a --frmat",
            "gsk980td check a --m",
            "gsk980td check a --jobs",
            "gsk980td chek a",
            "gsk980td s",
            "gsk980td sc",
            "gsk980td pro",
            "gsk980td --first-start on",
            "gsk980td nothing-like-it",
            "gsk980td --data x check a",
            "gsk980td plot a -o b.png --solid --whole",
            "gsk980td plot a -o b.png --solid --whole --labels",
            "gsk980td help --list --document x",
            "gsk980td link",
            "gsk980td link --log off",
            "gsk980td check a --zzz",
            "gsk980td link lst",
            "gsk980td mill gear --counts 5 --lead x",
            "gsk980td mill gear --counts 5 --lead=",
            "gsk980td mill gear --counts 5 --lead 5 --increment",
            "gsk980td ladder check a b",
            "gsk980td run a --parts",
            "gsk980td project new a --model gsk980",
        ] {
            let words: Vec<OsString> = line.split(' ').map(OsString::from).collect();
            if CommandLine::command().try_get_matches_from(&words).is_ok() {
                continue;
            }
            let [en, zh] = error_texts(line);
            let matching = table.clap.iter();
            let matching = matching
                .filter(|(row, zh)| en.lines().any(|it| replace_sentence(it, row, zh).is_some()));
            used.extend(matching.map(|(row, _)| *row));
            assert_eq!(find_english(&zh), None, "{line}:\n{en}\n{zh}");
        }
        for (_, mut command) in all_commands(CommandLine::command()) {
            let help = format!("{}{}", command.render_help(), command.render_long_help());
            let matching = table.clap.iter();
            let matching = matching.filter(|(row, zh)| {
                help.lines()
                    .any(|it| replace_sentence(it, row, zh).is_some())
            });
            used.extend(matching.map(|(row, _)| *row));
        }
        let unused: Vec<_> = table
            .clap
            .keys()
            .filter(|row| !used.contains(**row))
            .collect();
        assert!(unused.is_empty(), "{unused:#?}");
    }

    #[test]
    fn reasons_of_this_program_are_chinese() {
        for (line, wanted) in [
            ("gsk980td check a --start 5", "写成 X,Z，例如 300,300"),
            ("gsk980td plot a -o b.png --size 5", "图片"),
            ("gsk980td transfer delete a.b.c", "名称"),
            ("gsk980td mill backlash 2", "写八位"),
            ("gsk980td check a --log loud", "不是日志级别"),
            ("gsk980td transfer list --partition x", "分区只能是"),
        ] {
            let [_, zh] = error_texts(line);
            assert!(zh.contains("错误：") && zh.contains(wanted), "{zh}");
        }
    }

    #[test]
    fn a_sentence_is_replaced_within_its_line() {
        let zh = replace_sentence(
            "  x: invalid value 'a' for '--b <C>': d",
            "invalid value '{}' for '{}'",
            "'{}' 给 '{}'",
        );
        assert_eq!(zh.as_deref(), Some("  x: 'a' 给 '--b <C>': d"));
        assert_eq!(replace_sentence("nothing", "some {}", "{}"), None);
        assert_eq!(
            replace_sentence("only: 3 is not in 1..2", "{} is not in {}", "{} 超出 {}").as_deref(),
            Some("only: 3 超出 1..2")
        );
    }
}
