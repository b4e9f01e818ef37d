//! What control, link and compiler say of a fault, in Chinese.
//!
//! They speak English, with values in it. `assets/tables/sentences.tsv` has their
//! sentences, `{}` where a value stands, and the Chinese, `{1}` for the first value.
//! A value may be a sentence of the table itself.

use std::borrow::Cow;
use std::sync::LazyLock;

use gsk_messages::{Id, Language, Message};

const TABLE: &str = include_str!("../../assets/tables/sentences.tsv");
/// Sentences in sentences.
const DEPTH: u32 = 4;
/// Messages that window and reports show by themselves: nobody hands them on in English,
/// and their single words would be found in other sentences.
const SHOWN_BY_THEMSELVES: [&str; 14] = [
    "bench_",
    "browser_",
    "ladder_",
    "lcd_",
    "link_page_",
    "link_test_",
    "link_twin_",
    "narration_",
    "question_",
    "report_",
    "sample_",
    "scope_",
    "script_",
    "window_",
];

/// A row of the table.
struct Sentence {
    /// The English between the values.
    pieces: Vec<&'static str>,
    chinese: String,
}

/// A sentence in a language; one that the table does not have stays English.
pub fn say(text: &str, language: impl Into<Language>) -> Cow<'_, str> {
    match language.into() {
        Language::Zh => chinese(text, DEPTH).map_or(Cow::Borrowed(text), Cow::Owned),
        Language::En => Cow::Borrowed(text),
    }
}

/// A message in a language; what it quotes is looked up in the table as [`say`] does.
pub fn say_message(message: &Message, language: impl Into<Language>) -> String {
    let language = language.into();
    message.text_by(language, &|text| say(text, language).into_owned())
}

fn chinese(text: &str, depth: u32) -> Option<String> {
    let depth = depth.checked_sub(1)?;
    let found = rows().iter().find_map(|row| Some((row, row.values(text)?)));
    let Some((row, values)) = found else {
        if text.contains("; ") {
            // Several things at once.
            let all: Option<Vec<_>> = text.split("; ").map(|one| chinese(one, depth)).collect();
            return all.map(|all| all.join("; "));
        }
        // A file, and what is wrong with it.
        let (what, rest) = text.split_once(": ")?;
        return Some(format!("{what}: {}", chinese(rest, depth)?));
    };
    let mut said = row.chinese.clone();
    for (number, value) in (1..).zip(values) {
        let inner = chinese(value, depth);
        let inner = inner.as_deref().unwrap_or(value);
        said = said.replacen(&format!("{{{number}}}"), inner, 1);
    }
    Some(said)
}

/// The table; what says most stands first.
fn rows() -> &'static [Sentence] {
    static ROWS: LazyLock<Vec<Sentence>> = LazyLock::new(|| {
        let rows = TABLE.lines().skip(1);
        let rows = rows.filter_map(|line| line.split_once('\t'));
        let mut rows: Vec<Sentence> = rows
            .map(|(english, chinese)| Sentence {
                pieces: english.split("{}").collect(),
                chinese: chinese.to_owned(),
            })
            .chain(messages())
            .collect();
        rows.sort_by_key(|row| core::cmp::Reverse(length(row)));
        rows
    });
    &ROWS
}

fn length(row: &Sentence) -> usize {
    row.pieces.iter().map(|piece| piece.len()).sum()
}

/// The rows of the table of messages, as sentences: one may stand in a text that is
/// put together elsewhere.
fn messages() -> Vec<Sentence> {
    // What has no words of its own, `{field}: {rule}`, would be found in everything.
    let chinese = |letter| ('\u{4e00}'..='\u{9fff}').contains(&letter);
    let spoken = Id::all().iter().zip(gsk_messages::texts());
    let spoken = spoken
        .filter(|(id, _)| {
            !SHOWN_BY_THEMSELVES
                .iter()
                .any(|it| id.name().starts_with(it))
        })
        .filter(|(_, [_, text])| text.contains(chinese));
    let rows = spoken.map(|(_, [english, chinese])| {
        let mut pieces = vec![];
        let mut chinese = chinese.to_owned();
        let mut rest = english;
        while let Some((before, (inside, after))) = rest
            .split_once('{')
            .and_then(|(before, after)| Some((before, after.split_once('}')?)))
        {
            pieces.push(before);
            let (name, _) = inside.split_once(':').unwrap_or((inside, ""));
            let numbered = format!("{{{}}}", pieces.len());
            chinese = chinese.replacen(&format!("{{{name}}}"), &numbered, 1);
            rest = after;
        }
        pieces.push(rest);
        Sentence { pieces, chinese }
    });
    rows.collect()
}

impl Sentence {
    /// The values of a text that is this sentence.
    fn values<'a>(&self, text: &'a str) -> Option<Vec<&'a str>> {
        let (first, others) = self.pieces.split_first()?;
        let mut rest = text.strip_prefix(first)?;
        let Some((last, between)) = others.split_last() else {
            return rest.is_empty().then(Vec::new);
        };
        let mut values = Vec::new();
        for piece in between {
            let (value, after) = rest.split_once(piece)?;
            values.push(value);
            rest = after;
        }
        values.push(rest.strip_suffix(last)?);
        Some(values)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::path::Path;

    use super::*;

    #[test]
    fn values_keep_their_places_and_may_be_sentences() {
        for (english, expected) in [
            (
                "commanded X 5 Z -7 pulses, the board counts X 5 Z -8",
                "指令脉冲 X 5 Z -7, 驱动板计数 X 5 Z -8",
            ),
            (
                "no answer from the board: it says nothing; is it another firmware than \
                 `protocol` of the machine file says, or another `baud`?",
                "驱动板没有可用的应答: 它不发送任何数据; 固件是否与机床文件的 `protocol` 不符, \
                 或 `baud` 不符?",
            ),
            (
                "the board cannot do tapping (G33); nothing of the program was begun",
                "驱动板不能执行攻丝 (G33); 程序尚未开始",
            ),
            (
                "column 9: C is not an address; a chamfer is I or K, a corner arc R, in the \
                 G01 block before the corner",
                "第 9 列: C 不是地址; 倒角用拐角前 G01 段中的 I 或 K, 圆角用 R",
            ),
            (
                "the board cannot cut a thread: $38, pulses of the encoder a turn, is 0; \
                 io.index of the machine file names no pin",
                "驱动板不能加工螺纹: $38 (编码器每转脉冲数) 为 0; 机床文件的 io.index 没有指定引脚",
            ),
            (
                "limit input of Z at the board; machine coordinates X 1.000 Z -2.000 by the \
                 board's count, uncertain: the motors were stopped dead and may have lost steps",
                "驱动板的 Z 轴限位输入; 按驱动板计数, 机床坐标 X 1.000 Z -2.000, \
                 不可靠: 电机被突然停止, 可能失步",
            ),
            ("O0012 exists", "O0012 已存在"),
            ("/a/b.nc: there is no such file", "/a/b.nc: 没有该文件"),
            ("said by nobody", "said by nobody"),
        ] {
            assert_eq!(say(english, Language::Zh), expected);
            assert_eq!(say(english, Language::En), english);
        }
    }

    #[test]
    fn every_value_stands_once_in_the_chinese() {
        for row in rows() {
            let values = row.pieces.len() - 1;
            for number in 1..=values {
                let count = row.chinese.matches(&format!("{{{number}}}")).count();
                assert_eq!(count, 1, "{}", row.chinese);
            }
            assert_eq!(row.chinese.matches('{').count(), values, "{}", row.chinese);
        }
    }

    /// The texts of a source file, `{}` for whatever is put in.
    fn texts(source: &str, into: &mut BTreeSet<String>) {
        let source = source.replace("'\"'", "");
        let mut rest = source.as_str();
        while let Some((_, after)) = rest.split_once('"') {
            let mut text = String::new();
            let mut characters = after.char_indices();
            let mut end = after.len();
            let mut inside = 0;
            while let Some((at, character)) = characters.next() {
                match character {
                    '"' => {
                        end = at + 1;
                        break;
                    }
                    '\\' => match characters.next() {
                        Some((_, '\n')) => {
                            let blanks = characters.as_str();
                            let indent = blanks.len() - blanks.trim_start().len();
                            for _ in 0..indent {
                                characters.next();
                            }
                        }
                        Some((_, escaped)) => text.push(escaped),
                        None => {}
                    },
                    '{' => {
                        inside += 1;
                        text.push('{');
                    }
                    '}' => {
                        inside = 0;
                        text.push('}');
                    }
                    _ if inside > 0 => {}
                    _ => text.push(character),
                }
            }
            into.insert(text);
            rest = &after[end..];
        }
    }

    /// The texts of a file, or of the files in a folder, without those of their tests.
    fn read(path: &Path, into: &mut BTreeSet<String>) {
        let name = path.to_string_lossy();
        if path.is_dir() && !name.ends_with("tests") {
            for entry in std::fs::read_dir(path).unwrap() {
                read(&entry.unwrap().path(), into);
            }
        } else if name.ends_with(".rs") && !name.ends_with("tests.rs") {
            let source = std::fs::read_to_string(path).unwrap();
            let source = source.split("#[cfg(test)]\nmod tests {").next().unwrap();
            let code = source
                .lines()
                .filter(|line| !line.trim_start().starts_with("//"));
            texts(&code.collect::<Vec<_>>().join("\n"), into);
        }
    }

    /// A sentence that nobody says any more harms nobody; many of them mean that the
    /// table has been forgotten.
    #[test]
    fn the_sentences_are_still_said() {
        let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let mut said = BTreeSet::new();
        for folder in [
            "app/src",
            "core/src",
            "link/src",
            "panel/src",
            "plc/src",
            "runner/src",
        ] {
            read(&top.join(folder), &mut said);
        }
        let lost: Vec<String> = rows()
            .iter()
            .map(|row| row.pieces.join("{}"))
            .filter(|english| TABLE.contains(english))
            .filter(|english| !said.contains(english))
            .collect();
        assert!(
            lost.len() * 20 < rows().len(),
            "sentences.tsv has what no source says any more; change its rows too:\n{}",
            lost.join("\n")
        );
    }

    /// What the firmware of a board says of itself is shown as it says it.
    const OF_THE_FIRMWARE: [&str; 8] = [
        "Timer too close",
        "Stepper too far in past",
        "Rescheduled timer in the past",
        "Move queue overflow",
        "Invalid count parameter",
        "Can't reset time when stepper active",
        "Command parser error",
        "Missed scheduling of next",
    ];

    /// Refusals and alarms of links, threads and returns: whoever writes a new one
    /// writes its Chinese as well.
    #[test]
    fn what_is_said_of_boards_is_said_in_chinese() {
        let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let mut said = BTreeSet::new();
        for place in [
            "link/src",
            "core/src/linked.rs",
            "core/src/linked",
            "core/src/operation",
            "core/src/command.rs",
            "core/src/dialect.rs",
            "core/src/cnc",
            "core/src/motion",
            "core/src/spindle",
            "core/src/compensation",
            "core/src/preview",
        ] {
            read(&top.join(place), &mut said);
        }
        let is_sentence = |text: &&String| {
            let words = text
                .split(' ')
                .filter(|word| word.chars().any(char::is_alphabetic));
            // Commands of a board have parameters.
            words.count() > 2 && !text.contains("=%")
        };
        let unsaid: Vec<&String> = said
            .iter()
            .filter(is_sentence)
            .filter(|text| !OF_THE_FIRMWARE.contains(&text.as_str()))
            .filter(|text| chinese(&text.replace("{}", "1"), DEPTH).is_none())
            .collect();
        assert!(said.len() > 100, "the sources are elsewhere now");
        assert!(unsaid.is_empty(), "not in sentences.tsv: {unsaid:#?}");
    }
}
