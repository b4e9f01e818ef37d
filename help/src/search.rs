//! Searches topics by a user's words.

use gsk_core::model::ModelId;
use gsk_messages::Language;

use crate::article;
use crate::facts::{facts, subject_name};
use crate::models::topics_of;
use crate::subject::Subject;
use crate::table::{Topic, topics};

/// Returns the topics that match a query, the best first. An exact designation returns that
/// topic alone. A number returns the topics with that number. Other words return the notions
/// and then the topics with all words in the name, then those with all words in the text. Case is ignored, `G1`
/// equals `G01`, and `31` equals `031`.
pub fn search(query: &str) -> Vec<&'static Topic> {
    search_among(query, |_| true)
}

/// Returns the topics of a model that match a query, in the order of [`search()`].
pub fn search_model(model: ModelId, query: &str) -> Vec<&'static Topic> {
    search_topics(topics_of(model), query, |_| true)
}

/// Returns the topics that match a query and whose subject `among` accepts, in the order of
/// [`search()`].
pub fn search_among(query: &str, among: impl Fn(Subject<'_>) -> bool) -> Vec<&'static Topic> {
    search_topics(topics(), query, among)
}

fn search_topics(
    all: &'static [Topic],
    query: &str,
    among: impl Fn(Subject<'_>) -> bool,
) -> Vec<&'static Topic> {
    let words: Vec<String> = query.split_whitespace().map(fold_word).collect();
    if words.is_empty() {
        return Vec::new();
    }
    let folded_query = words.join(" ");
    let number = folded_query.parse().ok();
    let mut found: Vec<(u8, &Topic)> = all
        .iter()
        .filter(|topic| among(topic.subject))
        .filter_map(|topic| Some((match_rank(topic, &folded_query, number, &words)?, topic)))
        .collect();
    // An exact designation excludes all other topics.
    if found.iter().any(|(rank, _)| *rank == 0) {
        found.retain(|(rank, _)| *rank == 0);
    }
    found.sort_by_key(|(rank, _)| *rank);
    found.into_iter().map(|(_, topic)| topic).collect()
}

/// Returns the rank of a topic for a query: 0 for an exact match, greater for a poorer one.
/// Returns `None` if the topic does not match.
fn match_rank(
    topic: &Topic,
    folded_query: &str,
    number: Option<u16>,
    words: &[String],
) -> Option<u8> {
    let designation = fold_word(&topic.subject.to_string());
    let headed =
        |language| fold_words(&article::designation(topic.subject, language)) == folded_query;
    if [Language::Zh, Language::En].into_iter().any(headed) {
        return Some(0);
    }
    if designation == folded_query
        || designation.strip_prefix("no. ") == Some(folded_query) && number.is_none()
    {
        return Some(0);
    }
    if number.is_some() {
        return (topic.subject.number() == number).then_some(1);
    }
    let all = |text: &str| words.iter().all(|word| text.contains(word.as_str()));
    // A notion explains what a learner asks for first.
    if matches!(topic.subject, Subject::Notion(_)) {
        let notion = article::chinese_notion(topic).unwrap_or_default();
        if all(&designation) || all(&notion.to_lowercase()) {
            return Some(1);
        }
    }
    let names = [Language::Zh, Language::En]
        .map(|language| subject_name(topic.subject, language).to_lowercase());
    if all(&designation) || names.iter().any(|name| all(name)) {
        return Some(2);
    }
    let texts = [Language::Zh, Language::En].map(|language| {
        let facts = facts(topic.subject, language).concat();
        [topic.rule(language), topic.example(language), &facts].concat()
    });
    (texts.iter().any(|text| all(&text.to_lowercase()))).then_some(3)
}

/// Returns a text with each word folded for comparison, joined with blanks.
fn fold_words(text: &str) -> String {
    let words: Vec<String> = text.split_whitespace().map(fold_word).collect();
    words.join(" ")
}

/// Returns a word folded for comparison: in lower case, with codes and numbers padded as in
/// the tables.
fn fold_word(text: &str) -> String {
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
