//! From what somebody asks to the topics he may mean.

use gsk_core::model::ModelId;
use gsk_messages::Language;

use crate::article;
use crate::facts::{facts, name};
use crate::models::topics_of;
use crate::subject::Subject;
use crate::table::{Topic, topics};

/// Topics for a question, the best first: the one that is called so, those that have the
/// number, those that have all its words in their name, then those that have them in
/// their text. Capital and small letters are the same, and so are `G1` and `G01`, `31`
/// and `031`.
pub fn ask(question: &str) -> Vec<&'static Topic> {
    ask_among(question, |_| true)
}

/// The same of a model.
pub fn ask_of(model: ModelId, question: &str) -> Vec<&'static Topic> {
    find(topics_of(model), question, |_| true)
}

/// The same among some subjects.
pub fn ask_among(question: &str, among: impl Fn(Subject<'_>) -> bool) -> Vec<&'static Topic> {
    find(topics(), question, among)
}

fn find(
    all: &'static [Topic],
    question: &str,
    among: impl Fn(Subject<'_>) -> bool,
) -> Vec<&'static Topic> {
    let words: Vec<String> = question.split_whitespace().map(folded).collect();
    if words.is_empty() {
        return Vec::new();
    }
    let asked = words.join(" ");
    let number = asked.parse().ok();
    let mut found: Vec<(u8, &Topic)> = all
        .iter()
        .filter(|topic| among(topic.subject))
        .filter_map(|topic| Some((distance(topic, &asked, number, &words)?, topic)))
        .collect();
    // Who names a topic wants no other.
    if found.iter().any(|(distance, _)| *distance == 0) {
        found.retain(|(distance, _)| *distance == 0);
    }
    found.sort_by_key(|(distance, _)| *distance);
    found.into_iter().map(|(_, topic)| topic).collect()
}

/// How far a topic is from what was asked; none when it is something else.
fn distance(topic: &Topic, asked: &str, number: Option<u16>, words: &[String]) -> Option<u8> {
    let called = folded(&topic.subject.to_string());
    let headed = |language| folded_words(&article::called(topic.subject, language)) == asked;
    if [Language::Zh, Language::En].into_iter().any(headed) {
        return Some(0);
    }
    if called == asked || called.strip_prefix("no. ") == Some(asked) && number.is_none() {
        return Some(0);
    }
    if number.is_some() {
        return (topic.subject.number() == number).then_some(1);
    }
    let names =
        [Language::Zh, Language::En].map(|language| name(topic.subject, language).to_lowercase());
    let all = |text: &str| words.iter().all(|word| text.contains(word.as_str()));
    if all(&called) || names.iter().any(|name| all(name)) {
        return Some(2);
    }
    let texts = [Language::Zh, Language::En].map(|language| {
        let facts = facts(topic.subject, language).concat();
        [topic.rule(language), topic.example(language), &facts].concat()
    });
    (texts.iter().any(|text| all(&text.to_lowercase()))).then_some(3)
}

/// Words of a text, each folded.
fn folded_words(text: &str) -> String {
    let words: Vec<String> = text.split_whitespace().map(folded).collect();
    words.join(" ")
}

/// Small letters; a code or a number as its table writes it.
fn folded(text: &str) -> String {
    let text = text.to_lowercase();
    let letters = text.len()
        - text
            .trim_start_matches(|it: char| it.is_ascii_lowercase())
            .len();
    let (letter, digits) = text.split_at(letters);
    let (number, bit) = digits.split_once('.').unwrap_or((digits, ""));
    let is_number = !number.is_empty() && number.bytes().all(|it| it.is_ascii_digit());
    match (letter, is_number, bit.is_empty()) {
        ("g" | "m" | "h", true, true) => format!("{letter}{number:0>2}"),
        ("", true, true) => format!("{number:0>3}"),
        ("", true, false) => format!("{number:0>3}.{bit}"),
        _ => text,
    }
}
