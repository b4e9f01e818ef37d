//! Checks the help: every symbol of the control has a topic with a separate text in both
//! languages.

use gsk_core::alarm;
use gsk_core::memory;
use gsk_core::model::ModelId;
use gsk_help::{Subject, article, search, subject_name, topic, topic_at, topics};
use gsk_messages::Language;
use gsk_panel::emulator::{Emulator, WaitCondition};
use gsk_panel::keys::{KEYS, STRIP};
use gsk_panel::pages::{PAGES, PageId};
use gsk_panel::signals;

const LANGUAGES: [Language; 2] = [Language::Zh, Language::En];

#[test]
fn every_symbol_has_a_text_of_its_own() {
    let record = ModelId::Gsk980td.record();
    let g = (0..100).filter(|code| record.g_code(*code).is_some());
    let m = (0..100).filter(|code| record.m_function(*code).is_some());
    let g = g.map(|code| format!("G{code:02}"));
    let codes: Vec<String> = g.chain(m.map(|code| format!("M{code:02}"))).collect();
    let mut subjects: Vec<Subject<'_>> = codes.iter().map(|code| Subject::Code(code)).collect();
    subjects.extend(KEYS.iter().map(|row| Subject::Key(row.id)));
    let fitted = STRIP.iter().filter(|row| row.fitted);
    subjects.extend(fitted.map(|row| Subject::Lamp(row.id)));
    subjects.extend(PAGES.iter().map(|row| Subject::Page(row.name)));
    subjects.extend(memory::parameter_rows().iter().map(|row| match row.bit {
        Some(bit) => Subject::Bit(row.number, bit),
        None => Subject::Parameter(row.number),
    }));
    subjects.extend(alarm::rows().iter().map(|row| Subject::Alarm(row.number)));
    let signals = signals::rows().iter();
    subjects.extend(signals.map(|row| Subject::Signal(row.address)));
    assert!(subjects.len() > 1000);
    let silent = |subject: &&Subject<'_>| {
        topic(**subject).is_none_or(|topic| topic.rule(Language::En).is_empty())
    };
    let missing: Vec<String> = (subjects.iter().filter(silent))
        .map(ToString::to_string)
        .collect();
    assert!(missing.is_empty(), "no text about {}", missing.join(", "));
}

#[test]
fn facts_of_the_tables_are_shown_with_the_text() {
    for row in memory::parameter_rows() {
        let subject = match row.bit {
            Some(bit) => Subject::Bit(row.number, bit),
            None => Subject::Parameter(row.number),
        };
        for language in LANGUAGES {
            let text = article(topic(subject).expect("a topic"), language).to_string();
            assert!(row.state || text.contains(&row.range.to_string()), "{text}");
        }
    }
    for row in alarm::rows() {
        let topic = topic(Subject::Alarm(row.number)).expect("a topic");
        let text = article(topic, Language::En).to_string();
        assert!(text.contains(row.cause_en), "{text}");
    }
    for row in signals::rows() {
        let topic = topic(Subject::Signal(row.address)).expect("a topic");
        let text = article(topic, Language::Zh).to_string();
        assert!(text.contains(row.text_zh), "{text}");
        // Its source and destination have no English word in the Chinese text.
        let ways = text.lines().filter(|line| line.starts_with("方向: "));
        for way in ways {
            let small = way.chars().any(|it| it.is_ascii_lowercase());
            assert!(!small, "{way}");
        }
    }
}

#[test]
fn every_text_says_more_than_the_name_in_its_own_language() {
    let chinese = |text: &str| {
        let written = |it: &char| ('\u{4e00}'..'\u{a000}').contains(it);
        text.chars().filter(written).count()
    };
    let latin = |text: &str| text.bytes().filter(u8::is_ascii_lowercase).count();
    for topic in topics()
        .iter()
        .filter(|topic| !topic.rule(Language::En).is_empty())
    {
        for language in LANGUAGES {
            let rule = topic.rule(language);
            let name = subject_name(topic.subject, language);
            assert_ne!(
                rule.trim_end_matches(['.', '。']),
                name,
                "{}",
                topic.subject
            );
            let written = match language {
                Language::Zh => chinese(rule),
                Language::En => latin(rule),
            };
            assert!(written >= 3, "{}: {rule}", topic.subject);
        }
    }
}

/// Each line of the tables of texts has six fields, and no line is lost.
#[test]
fn every_line_of_a_text_is_a_topic() {
    for file in ["codes.tsv", "fields.tsv", "panel.tsv"] {
        let path = gsk_tests::repository().join("assets/help").join(file);
        let table = std::fs::read_to_string(path).expect("a table");
        for line in table.lines() {
            let fields: Vec<&str> = line.split('\t').collect();
            assert_eq!(fields.len(), 6, "{line}");
            assert!(
                fields.iter().all(|field| !field.trim().is_empty()),
                "{line}"
            );
        }
        let texts = table
            .lines()
            .skip(1)
            .filter_map(|line| line.split('\t').nth(1));
        for text in texts {
            let known = topics()
                .iter()
                .any(|topic| topic.rule(Language::En) == text);
            assert!(known, "{text}");
        }
    }
}

#[test]
fn no_topic_exists_twice() {
    for pair in topics().windows(2) {
        assert_ne!(pair[0].subject, pair[1].subject);
    }
}

#[test]
fn questions_find_what_they_mean() {
    let first = |question: &str| search(question).first().map(|it| it.subject.to_string());
    for (question, subject) in [
        ("G71", "G71"),
        ("g1", "G01"),
        ("004.3", "No. 004.3"),
        ("alarm 7", "alarm 007"),
        ("key cs", "key CS"),
        ("x0.5", "X0.5"),
        ("page oft", "page oft"),
        // The captions of the headings, in both languages.
        ("报警 7", "alarm 007"),
        ("参数 004.3", "No. 004.3"),
        ("按键 CS", "key CS"),
        ("诊断 008", "DGN 008"),
        ("diagnosis 008", "DGN 008"),
        ("编程速率（液晶屏）", "field 编程速率 PRG.FEED"),
    ] {
        assert_eq!(first(question).as_deref(), Some(subject), "{question}");
    }
    let both: Vec<String> = search("31")
        .iter()
        .map(|it| it.subject.to_string())
        .collect();
    assert!(both.contains(&"alarm 031".to_owned()) && both.contains(&"No. 031".to_owned()));
    assert!(search("").is_empty() && search("xyzzy plugh").is_empty());
}

#[test]
fn words_under_the_pointer_on_the_lcd_are_found() {
    let mut emulator = Emulator::new(gsk_core::setup::Setup::default());
    emulator.run_until(&WaitCondition::SelfTestOver, 10_000);
    for (page, row, column, subject) in [
        (PageId::ParBit, 5, 3, "No. 004"),
        (PageId::ParBit, 5, 11, "No. 004.3"),
        (PageId::ParData, 9, 12, "No. 022"),
        (PageId::PlcBits, 2, 10, "X0.5"),
        (PageId::Dgn, 2, 3, "DGN 000"),
        (PageId::Dgn, 0, 3, "page dgn"),
        (PageId::Oft, 0, 3, "page oft"),
        (PageId::Oft, 5, 30, "field oft R"),
        (PageId::Oft, 10, 3, "field 现在位置 POSITION"),
        (PageId::PosRel, 11, 3, "field 实际速率 ACT.FEED"),
        (PageId::PosRel, 10, 30, "G00"),
        (PageId::ParBit, 11, 10, "No. 001.4"),
        (PageId::Mdi, 4, 6, "field mdi U"),
        (PageId::PosAll, 9, 30, "field 余移动量 (TO GO)"),
        (PageId::GraphPar, 9, 8, "field graph-par X最小值 X MIN"),
        (PageId::Prg, 14, 22, "key MDI"),
        (PageId::Prg, 0, 30, "field O"),
    ] {
        emulator.show_page(page);
        let screen = emulator.screen();
        let found = topic_at(ModelId::default(), page, &screen, row, column)
            .map(|it| it.subject.to_string());
        assert_eq!(
            found.as_deref(),
            Some(subject),
            "{page:?} {}",
            screen.row(row)
        );
    }
}

#[test]
fn letters_of_a_comment_on_the_lcd_are_no_words() {
    let mut setup = gsk_core::setup::Setup::default();
    let text = "O0001;\nG99 (ROUGHING) G96;\nM30;\n";
    setup.memory.programs.store(text).expect("room");
    let first = gsk_core::command::ProgramId::Stored(1);
    setup.memory.programs.select(first);
    let mut emulator = Emulator::new(setup);
    emulator.run_until(&WaitCondition::SelfTestOver, 10_000);
    emulator.show_page(PageId::Prg);
    let screen = emulator.screen();
    let topic_of_text = |text: &str| {
        let rows = (1..12).filter_map(|row| Some((row, screen.row(row).find(text)?)));
        let (row, column) = rows.into_iter().next().expect("on the page");
        let found = topic_at(ModelId::default(), PageId::Prg, &screen, row, column);
        found.map(|it| it.subject.to_string())
    };
    assert_eq!(topic_of_text("G99").as_deref(), Some("G99"));
    assert_eq!(topic_of_text("GHING").as_deref(), Some("page prg"));
    assert_eq!(topic_of_text("G96").as_deref(), Some("G96"));
}

/// Every word of every page, in both languages, has a topic with more than the purpose of the
/// page. Its title and the words on the pages of a program's name are exceptions.
#[test]
fn every_field_of_every_page_has_its_topic() {
    let mut setup = gsk_core::setup::Setup::default();
    let text = "O0001;\nN10 G00 X50 Z2 M03 S500 T0101;\n/G71 U2 R0.5 F100;\nM30;\n";
    setup.memory.programs.store(text).expect("room");
    let first = gsk_core::command::ProgramId::Stored(1);
    setup.memory.programs.select(first);
    let mut emulator = Emulator::new(setup);
    emulator.run_until(&WaitCondition::SelfTestOver, 10_000);
    let mut silent = Vec::new();
    let mut words = 0;
    for row in &PAGES {
        emulator.show_page(row.page);
        for screen in [emulator.screen(), emulator.translated_screen()] {
            for at in 0..gsk_panel::screen::ROWS {
                let mut columns = 0..gsk_panel::screen::COLUMNS;
                if at == 0 {
                    columns.start = 28;
                }
                let mut before = ' ';
                for column in columns {
                    let character = screen.cell(at, column).character;
                    let begins = before == ' ' && !matches!(character, ' ' | '_' | '\0');
                    before = match character {
                        '\0' | '_' => before,
                        character => character,
                    };
                    if !begins {
                        continue;
                    }
                    words += 1;
                    let found = topic_at(ModelId::default(), row.page, &screen, at, column);
                    if found.is_none_or(|it| matches!(it.subject, Subject::Page(_))) {
                        let row_text = screen.row(at);
                        silent.push(format!("{} {at}:{column} {row_text}", row.name));
                    }
                }
            }
        }
    }
    assert!(words > 1500, "{words}");
    assert!(silent.is_empty(), "no topic:\n{}", silent.join("\n"));
}

#[test]
fn teach_in_of_the_nc_b08_and_macro_b_are_explained() {
    let mut setup = gsk_core::setup::Setup::default();
    setup.memory.model = gsk_core::model::ControlModel::new(ModelId::Ncb08);
    let mut emulator = Emulator::new(setup);
    emulator.run_until(&WaitCondition::SelfTestOver, 10_000);
    emulator.press(gsk_panel::keys::Key::Jog);
    emulator.show_page(PageId::Teach);
    for screen in [emulator.screen(), emulator.translated_screen()] {
        for row in [1, 2, 11, 12] {
            let found = topic_at(ModelId::Ncb08, PageId::Teach, &screen, row, 14);
            let found = found.map(|it| it.subject);
            assert_eq!(found, Some(Subject::Notion("teaching")), "{row}");
        }
    }
    for question in ["teaching", "macro B", "teach-in", "DNC"] {
        assert!(!search(question).is_empty(), "{question}");
    }
}

/// Demonstrations belong to existing topics, and every key that acts on this lathe has one.
#[test]
fn demonstrations_belong_to_topics_and_every_key_has_one() {
    use gsk_lesson::demonstrations;
    let families: std::collections::BTreeSet<&str> = topics()
        .iter()
        .filter_map(|topic| topic.subject.family())
        .collect();
    for shown in demonstrations() {
        for name in &shown.topics {
            let known = topics().iter().any(|it| it.subject.to_string() == *name);
            let name = name.as_str();
            assert!(
                known || families.contains(name),
                "{}: {name}",
                shown.lesson.name
            );
        }
    }
    let shown = |name: &str| {
        demonstrations()
            .iter()
            .any(|it| it.topics.iter().any(|topic| topic == name))
    };
    for family in families {
        assert!(shown(family), "{family}");
    }
    for page in &PAGES {
        assert!(shown(&format!("page {}", page.name)), "{}", page.name);
    }
    // Not fitted; and OUT sends files, which a practice machine does not have.
    let without = ["HY", "YM", "YP", "OUT"];
    for key in KEYS.iter().filter(|key| !without.contains(&key.id)) {
        assert!(shown(&format!("key {}", key.id)), "key {}", key.id);
    }
}
