//! Collects the topics of a model: its own codes and parameters, and the GSK980TD's topics that
//! are valid for it.

use std::sync::LazyLock;

use gsk_core::model::{ModelId, ModelRecord};
use gsk_messages::{Language, Message, say};
use gsk_panel::face::face_of;
use gsk_panel::keys::Key;

use crate::subject::Subject;
use crate::table::{Topic, parse_topics, topics};

/// Help tables about codes that exist in one model only or have another meaning in it.
const OWN_TEXTS: [(ModelId, &str); 3] = [
    (
        ModelId::Gsk980mdi,
        include_str!("../../assets/help/models/gsk980mdi.tsv"),
    ),
    (
        ModelId::Hx31,
        include_str!("../../assets/help/models/hx31.tsv"),
    ),
    (
        ModelId::Ncb08,
        include_str!("../../assets/help/models/ncb08.tsv"),
    ),
];

/// Returns all topics of a model, sorted by subject.
pub fn topics_of(model: ModelId) -> &'static [Topic] {
    // Each is collected on first use, because a run usually has one model.
    static MODELS: [LazyLock<Vec<Topic>>; 3] = [
        LazyLock::new(|| collect_topics(ModelId::Gsk980mdi)),
        LazyLock::new(|| collect_topics(ModelId::Hx31)),
        LazyLock::new(|| collect_topics(ModelId::Ncb08)),
    ];
    match model {
        ModelId::Gsk980td => topics(),
        ModelId::Gsk980mdi => &MODELS[0],
        ModelId::Hx31 => &MODELS[1],
        ModelId::Ncb08 => &MODELS[2],
    }
}

/// Returns the topic of a model about a subject; `None` if the model has none.
pub fn topic_of(model: ModelId, subject: Subject<'_>) -> Option<&'static Topic> {
    let all = topics_of(model);
    let at = all.binary_search_by(|topic| topic.subject.cmp(&subject));
    all.get(at.ok()?)
}

fn collect_topics(model: ModelId) -> Vec<Topic> {
    let record = model.record();
    let table = OWN_TEXTS.iter().find(|(of, _)| *of == model);
    let table = table.map_or("", |(_, table)| *table);
    let own = parse_topics(table, |written| {
        let of_panel = written.starts_with("key ") || written.starts_with("page ");
        match of_panel {
            true => Subject::parse_panel(written),
            false => Some(Subject::parse_program_word(written)),
        }
    });
    let mut all: Vec<Topic> = own.map(|topic| topic.for_model(model)).collect();
    all.extend(codes(record).map(|topic| topic.for_model(model)));
    all.extend(parameters(record).map(|topic| topic.for_model(model)));
    all.extend(panel_topics(model).map(|topic| topic.for_model(model)));
    all.extend(
        topics()
            .iter()
            .filter(|topic| is_valid_for(topic, record))
            .copied(),
    );
    // Topics with a text of the model come before those without one, and before the GSK980TD's.
    all.sort_by_key(|topic| topic.subject);
    all.dedup_by_key(|topic| topic.subject);
    all
}

/// Returns whether a topic of the GSK980TD is valid for the model: its code has the same
/// meaning, its key or page is on the model's panel.
fn is_valid_for(topic: &Topic, record: &ModelRecord) -> bool {
    let face = face_of(record.id());
    match topic.subject {
        Subject::Key(id) => return Key::from_id(id).is_none_or(|key| face.key(key).is_some()),
        Subject::Page(name) | Subject::Field(name, _) if name != "*" && name != "power-on" => {
            return face.page_named(name).is_some();
        }
        _ => {}
    }
    let Subject::Code(name) = topic.subject else {
        return true;
    };
    let main = ModelId::default().record();
    // `G65 H01` belongs to G65.
    let code = name.split(' ').next().unwrap_or(name);
    let number = |letter| {
        code.strip_prefix(letter)
            .and_then(|it| it.parse::<u8>().ok())
    };
    if let Some(number) = number('G') {
        let meaning = main.g_code(number.into());
        return meaning.is_some() && meaning == record.g_code(number.into());
    }
    if let Some(number) = number('M') {
        let does = |record: &ModelRecord| record.m_function(number).map(|it| it.meaning);
        return does(main).is_some() && does(main) == does(record);
    }
    true
}

/// Returns topics for the codes of a model without a help text. They contain the code's
/// meaning.
fn codes(record: &'static ModelRecord) -> impl Iterator<Item = Topic> {
    let main = ModelId::default().record();
    let g = record
        .g
        .iter()
        .filter(|(number, meaning)| main.g_code(i64::from(**number)) != Some(**meaning));
    let g = g.map(|(number, meaning)| (format!("G{number:02}"), meaning.text()));
    let m = record.m.iter().filter(|(number, function)| {
        main.m_function(**number)
            .is_none_or(|it| it.meaning != function.meaning)
    });
    let m = m.map(|(number, function)| (format!("M{number:02}"), function.meaning.text()));
    g.chain(m).map(|(code, meaning)| {
        let message = say::help_code_of_model(&code, meaning, record.name());
        Topic::with_text(Subject::Code(code.leak()), in_both_languages(&message))
    })
}

/// Returns topics without text for the keys and pages that only this model has.
fn panel_topics(model: ModelId) -> impl Iterator<Item = Topic> {
    let (face, main) = (face_of(model), face_of(ModelId::default()));
    let keys = face.keys().filter(|row| main.key(row.key).is_none());
    let keys = keys.map(|row| Subject::Key(row.id));
    let pages = face.pages.iter();
    let pages = pages.filter(|row| main.page(row.page).is_none());
    let pages = pages.map(|row| Subject::Page(row.name));
    keys.chain(pages).map(Topic::bare)
}

/// Returns topics for the parameters that only this model has.
fn parameters(record: &'static ModelRecord) -> impl Iterator<Item = Topic> {
    record.parameters().iter().map(|(number, parameter)| {
        let (low, high) = parameter.range;
        let rule = [Language::Zh, Language::En].map(|language| {
            let name = parameter.name(language);
            let message = say::help_parameter_of_model(name, low, high, &parameter.unit);
            &*message.text(language).leak()
        });
        Topic::with_text(Subject::Notion(format!("P{number}").leak()), rule)
    })
}

fn in_both_languages(message: &Message) -> [&'static str; 2] {
    [Language::Zh, Language::En].map(|language| &*message.text(language).leak())
}
