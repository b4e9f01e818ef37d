//! Searches topics by a user's words.

use gsk_core::model::ModelId;
use gsk_messages::Language;

use crate::article;
use crate::facts::{facts, name};
use crate::models::topics_of;
use crate::subject::Subject;
use crate::table::{Topic, topics};

/// Returns the topics that match a query, the best first. An exact designation returns that
/// topic alone. A number returns the topics with that number. Other words return the topics
/// with all words in the name, then those with all words in the text. Case is ignored, `G1`
/// equals `G01`, and `31` equals `031`.
pub fn ask(question: &str) -> Vec<&'static Topic> {
    ask_among(question, |_| true)
}

/// Searches the topics of a model as [`ask`] does.
pub fn ask_of(model: ModelId, question: &str) -> Vec<&'static Topic> {
    find(topics_of(model), question, |_| true)
}

/// Searches the topics whose subject `among` accepts, as [`ask`] does.
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
    // An exact designation excludes all other topics.
    if found.iter().any(|(distance, _)| *distance == 0) {
        found.retain(|(distance, _)| *distance == 0);
    }
    found.sort_by_key(|(distance, _)| *distance);
    found.into_iter().map(|(_, topic)| topic).collect()
}

/// Rank of a topic for a query, 0 for an exact match, or `None` if it does not match.
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

/// Folds each word of a text.
fn folded_words(text: &str) -> String {
    let words: Vec<String> = text.split_whitespace().map(folded).collect();
    words.join(" ")
}

/// Returns a word in lower case, with codes and numbers padded as in the tables.
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
