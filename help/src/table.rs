//! Combines the control's tables and the help texts into the list of topics.

use std::sync::LazyLock;

use gsk_core::model::ModelId;
use gsk_core::{alarm, memory};
use gsk_messages::{HelpColumns, Language};
use gsk_panel::keys::{KEYS, STRIP};
use gsk_panel::pages::PAGES;
use gsk_panel::signals;

use crate::subject::Subject;

/// Parses the subject in a line of a help table; `None` if it is invalid.
pub(crate) type ParseSubject = fn(&'static str) -> Option<Subject<'static>>;

/// The tables of texts alone, each with the parser of its subjects. Alarms, parameters and
/// signals have their texts in their own tables.
const TEXTS: [(&str, ParseSubject); 3] = [
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
];

/// All topics of the GSK980TD, sorted by subject.
static TOPICS: LazyLock<Vec<Topic>> = LazyLock::new(|| {
    let mut topics: Vec<Topic> = TEXTS
        .iter()
        .flat_map(|(table, parse_subject)| parse_topics(table, *parse_subject))
        .collect();
    topics.extend(table_topics());
    // Topics with a text come before those without one.
    topics.sort_by_key(|topic| topic.subject);
    topics.dedup_by_key(|topic| topic.subject);
    topics
});

/// Returns a topic for every row of the control's own tables, without text for keys, lamps and
/// pages.
fn table_topics() -> impl Iterator<Item = Topic> {
    let alarms = alarm::rows()
        .iter()
        .map(|row| Topic::new(Subject::Alarm(row.number), row.help));
    let parameters = memory::parameter_rows().iter().map(|row| {
        let subject = match row.bit {
            Some(bit) => Subject::Bit(row.number, bit),
            None => Subject::Parameter(row.number),
        };
        Topic::new(subject, row.help)
    });
    let signals = signals::rows()
        .iter()
        .map(|row| Topic::new(Subject::Signal(row.address), row.help));
    let keys = KEYS.iter().map(|row| Subject::Key(row.id));
    let fitted = STRIP.iter().filter(|row| row.fitted);
    let lamps = fitted.map(|row| Subject::Lamp(row.id));
    let pages = PAGES.iter().map(|row| Subject::Page(row.name));
    let bare =
        (keys.chain(lamps).chain(pages)).map(|subject| Topic::new(subject, HelpColumns::default()));
    (alarms.chain(parameters).chain(signals)).chain(bare)
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
    /// The item that the topic explains.
    pub subject: Subject<'static>,
    texts: HelpColumns,
    /// The only model that the topic is about. `None` for a topic of the GSK980TD, which other
    /// models can share.
    pub model: Option<ModelId>,
}

impl Topic {
    const fn new(subject: Subject<'static>, texts: HelpColumns) -> Self {
        Self {
            subject,
            texts,
            model: None,
        }
    }

    /// Creates a topic without text about `subject`.
    pub(crate) const fn bare(subject: Subject<'static>) -> Self {
        Self::new(subject, HelpColumns::from_rule(["", ""]))
    }

    /// Creates a topic about `subject` with a rule in Chinese and English.
    pub(crate) const fn with_text(subject: Subject<'static>, rule: [&'static str; 2]) -> Self {
        Self::new(subject, HelpColumns::from_rule(rule))
    }

    /// Returns the topic marked as one that only `model` has.
    pub(crate) const fn for_model(self, model: ModelId) -> Self {
        Self {
            model: Some(model),
            ..self
        }
    }

    fn parse(line: &'static str, parse_subject: ParseSubject) -> Option<Self> {
        let mut fields = line.split('\t');
        let subject = parse_subject(fields.next()?)?;
        let texts = HelpColumns::read(&mut fields)?;
        fields.next().is_none().then(|| Self::new(subject, texts))
    }

    /// Returns what the subject is for, what it does and what surprises users. Empty if the
    /// tables contain everything.
    pub const fn rule(&self, language: Language) -> &'static str {
        self.texts.rule(language)
    }

    /// Returns a worked example; empty if there is none.
    pub const fn example(&self, language: Language) -> &'static str {
        self.texts.example(language)
    }

    /// Returns the section of the manual that describes the subject; empty if none does.
    pub const fn source(&self) -> &'static str {
        self.texts.source
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
