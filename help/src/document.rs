//! Writes all topics as one self-contained HTML page for reading and printing.

use core::fmt::Write as _;

use gsk_messages::{Language, Message, say};

use crate::article::article;
use crate::subject::Subject;
use crate::table::topics;

/// Style sheet of the page. It suits a screen and A4 paper. A topic is not split between two
/// sheets.
const STYLE: &str = "body{font:11pt/1.4 sans-serif;max-width:48em;margin:auto;padding:1em}\
h2{border-bottom:2px solid;margin-top:2em;break-before:page}h3{margin:1em 0 .2em}p{margin:.2em 0}\
section{break-inside:avoid}.example{border-left:3px solid #888;padding-left:.6em}\
.source,.fact{color:#555;font-size:90%}";

/// A chapter of the page: whether a subject belongs to it, and its heading.
type Chapter = (fn(Subject<'_>) -> bool, fn() -> Message);

const CHAPTERS: [Chapter; 7] = [
    (|it| matches!(it, Subject::Code(_)), say::help_chapter_codes),
    (
        |it| matches!(it, Subject::Key(_) | Subject::Lamp(_)),
        say::help_chapter_panel,
    ),
    (
        |it| matches!(it, Subject::Page(_) | Subject::Field(..)),
        say::help_chapter_pages,
    ),
    (
        |it| matches!(it, Subject::Notion(_)),
        say::help_chapter_notions,
    ),
    (
        |it| matches!(it, Subject::Alarm(_)),
        say::help_chapter_alarms,
    ),
    (
        |it| matches!(it, Subject::Parameter(_) | Subject::Bit(..)),
        say::help_chapter_parameters,
    ),
    (
        |it| matches!(it, Subject::Signal(_) | Subject::Diagnosis(_)),
        say::help_chapter_signals,
    ),
];

/// Returns all topics in a language as the text of an HTML page.
pub fn document(language: Language) -> String {
    let tag = match language {
        Language::Zh => "zh-CN",
        Language::En => "en",
    };
    let title = say::help_document().text(language);
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"{tag}\">\n<head><meta charset=\"utf-8\"><title>{title}</title>\
        <style>{STYLE}</style></head>\n<body>\n<h1>{title}</h1>\n<ul>\n"
    );
    for (at, (_, heading)) in CHAPTERS.iter().enumerate() {
        let heading = escaped(&heading().text(language));
        let _ = writeln!(page, "<li><a href=\"#c{at}\">{heading}</a></li>");
    }
    page.push_str("</ul>\n");
    for (at, (belongs, heading)) in CHAPTERS.iter().enumerate() {
        let heading = escaped(&heading().text(language));
        let _ = writeln!(page, "<h2 id=\"c{at}\">{heading}</h2>");
        for topic in topics().iter().filter(|topic| belongs(topic.subject)) {
            let it = article(topic, language);
            let _ = writeln!(page, "<section><h3>{}</h3>", escaped(&it.heading));
            paragraph(&mut page, "rule", &it.rule);
            for fact in &it.facts {
                paragraph(&mut page, "fact", fact);
            }
            paragraph(&mut page, "example", &it.example);
            paragraph(&mut page, "source", &it.source);
            page.push_str("</section>\n");
        }
    }
    page.push_str("</body>\n</html>\n");
    page
}

fn paragraph(page: &mut String, class: &str, text: &str) {
    if !text.is_empty() {
        let _ = writeln!(page, "<p class=\"{class}\">{}</p>", escaped(text));
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_topic_is_in_one_chapter() {
        for topic in topics() {
            let chapters = CHAPTERS
                .iter()
                .filter(|(belongs, _)| belongs(topic.subject));
            assert_eq!(chapters.count(), 1, "{}", topic.subject);
        }
        for language in [Language::Zh, Language::En] {
            let page = document(language);
            assert_eq!(page.matches("<section>").count(), topics().len());
        }
    }
}
