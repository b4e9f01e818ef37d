//! Combines the control's tables and the help texts into the list of topics.

use std::sync::LazyLock;

use gsk_core::model::ModelId;
use gsk_core::{alarm, memory};
use gsk_messages::Language;
use gsk_panel::keys::{KEYS, STRIP};
use gsk_panel::pages::PAGES;
use gsk_panel::signals;

use crate::subject::Subject;

/// Number of fields in a line of a help table.
const FIELDS: usize = 6;

/// Parses the subject in a line of a help table; `None` if it is invalid.
pub(crate) type ParseSubject = fn(&'static str) -> Option<Subject<'static>>;

/// The help tables, each with the parser of its subjects.
const TEXTS: [(&str, ParseSubject); 6] = [
    (
        include_str!("../../assets/help/alarms.tsv"),
        Subject::parse_alarm,
    ),
    (include_str!("../../assets/help/codes.tsv"), |written| {
        Some(Subject::parse_program_word(written))
    }),
    (
        include_str!("../../assets/help/fields.tsv"),
        Subject::parse_panel,
    ),
    (
        include_str!("../../assets/help/panel.tsv"),
        Subject::parse_panel,
    ),
    (
        include_str!("../../assets/help/parameters.tsv"),
        Subject::parse_parameter,
    ),
    (include_str!("../../assets/help/signals.tsv"), |written| {
        Some(Subject::Signal(written))
    }),
];

/// All topics of the GSK980TD, sorted by subject.
static TOPICS: LazyLock<Vec<Topic>> = LazyLock::new(|| {
    let mut topics: Vec<Topic> = TEXTS
        .iter()
        .flat_map(|(table, parse_subject)| parse_topics(table, *parse_subject))
        .collect();
    topics.extend(table_subjects().map(Topic::without_text));
    // Topics with a text come before those without one.
    topics.sort_by_key(|topic| topic.subject);
    topics.dedup_by_key(|topic| topic.subject);
    topics
});

/// Returns every subject that the control's own tables contain.
fn table_subjects() -> impl Iterator<Item = Subject<'static>> {
    let alarms = alarm::rows().iter().map(|row| Subject::Alarm(row.number));
    let parameters = memory::parameter_rows().iter().map(|row| match row.bit {
        Some(bit) => Subject::Bit(row.number, bit),
        None => Subject::Parameter(row.number),
    });
    let keys = KEYS.iter().map(|row| Subject::Key(row.id));
    let fitted = STRIP.iter().filter(|row| row.fitted);
    let lamps = fitted.map(|row| Subject::Lamp(row.id));
    let pages = PAGES.iter().map(|row| Subject::Page(row.name));
    let signals = signals::rows()
        .iter()
        .map(|row| Subject::Signal(row.address));
    (alarms.chain(parameters).chain(keys))
        .chain(lamps)
        .chain(pages)
        .chain(signals)
}

/// Returns the topics in the lines of a help table. Skips invalid lines.
pub(crate) fn parse_topics(
    table: &'static str,
    parse_subject: ParseSubject,
) -> impl Iterator<Item = Topic> {
    let lines = table.lines().skip(1);
    lines.filter_map(move |line| Topic::parse(line, parse_subject))
}

/// A help topic: a subject and the texts about it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Topic {
    /// What the topic is about.
    pub subject: Subject<'static>,
    rule: [&'static str; 2],
    example: [&'static str; 2],
    /// The section of the manual that describes the subject; empty if none does.
    pub source: &'static str,
    /// The only model that the topic is about. `None` for a topic of the GSK980TD, which other
    /// models can share.
    pub model: Option<ModelId>,
}

impl Topic {
    const fn without_text(subject: Subject<'static>) -> Self {
        Self {
            subject,
            rule: [""; 2],
            example: [""; 2],
            source: "",
            model: None,
        }
    }

    /// Creates a topic about `subject` with a rule in Chinese and English.
    pub(crate) const fn with_text(subject: Subject<'static>, rule: [&'static str; 2]) -> Self {
        Self {
            rule,
            ..Self::without_text(subject)
        }
    }

    /// Returns the topic marked as one that only `model` has.
    pub(crate) const fn for_model(self, model: ModelId) -> Self {
        Self {
            model: Some(model),
            ..self
        }
    }

    fn parse(line: &'static str, parse_subject: ParseSubject) -> Option<Self> {
        let fields: Vec<&str> = line.split('\t').collect();
        let fields: [&str; FIELDS] = fields.try_into().ok()?;
        let present = |text: &'static str| if text == "-" { "" } else { text };
        let [written, rule_en, rule_zh, example_en, example_zh, source] = fields;
        Some(Self {
            subject: parse_subject(written)?,
            rule: [rule_zh, rule_en],
            example: [example_zh, example_en].map(present),
            source: present(source),
            model: None,
        })
    }

    /// Returns what the subject is for, what it does and what surprises users. Empty if the
    /// tables contain everything.
    pub const fn rule(&self, language: Language) -> &'static str {
        self.rule[column(language)]
    }

    /// Returns a worked example; empty if there is none.
    pub const fn example(&self, language: Language) -> &'static str {
        self.example[column(language)]
    }
}

const fn column(language: Language) -> usize {
    match language {
        Language::Zh => 0,
        Language::En => 1,
    }
}

/// Returns all topics of the GSK980TD, sorted by subject.
pub fn topics() -> &'static [Topic] {
    &TOPICS
}

/// Returns the GSK980TD's topic about a subject; `None` if there is none.
pub fn topic(subject: Subject<'_>) -> Option<&'static Topic> {
    let at = TOPICS
        .binary_search_by(|topic| topic.subject.cmp(&subject))
        .ok()?;
    TOPICS.get(at)
}
