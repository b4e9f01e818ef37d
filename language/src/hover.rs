//! Describes the word under the pointer.

use gsk_core::memory::Variables;
use gsk_core::model::ModelId;
use gsk_core::program::limits;
use gsk_help::{Subject, Topic, article, topic_of};
use gsk_messages::{Language, say};

use crate::Reader;
use crate::leads::Aim;
use crate::meaning::{letter, of_model};
use crate::refer::{Under, definition, leading_to, under};
use crate::structure::Structure;
use crate::text::{Place, Position, Text};
use crate::words::{Kind, Span, Word, spans, word_of};

/// Greatest number of program or profile lines shown.
const MOST_LINES: usize = 16;

/// The description of a word.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hover {
    /// The word.
    pub place: Place,
    /// The description in Markdown.
    pub markdown: String,
}

/// Describes the word at a position. Returns `None` for blanks and comments. `program` returns
/// the text of programs in other files.
pub fn hover(
    text: &Text,
    structure: &Structure,
    at: Position,
    reader: Reader,
    program: &dyn Fn(u16) -> Option<String>,
) -> Option<Hover> {
    let line = text.line(at.line);
    let spans = spans(line);
    let byte = at.byte as usize;
    let span = (spans.iter().find(|it| it.range.contains(&byte)))
        .or_else(|| spans.iter().find(|it| it.range.end == byte))?;
    if matches!(span.kind, Kind::Comment | Kind::Mark) {
        return None;
    }
    let mut parts = Vec::new();
    parts.extend(variable(line, span, byte, reader));
    if parts.is_empty() {
        parts.extend(word_of(line, span).and_then(|word| of_word(line, &spans, &word, reader)));
    }
    parts.extend(of_lead(text, structure, at, reader.language, program));
    (!parts.is_empty()).then(|| Hover {
        place: Place::new(at.line, &span.range),
        markdown: parts.join("\n\n---\n\n"),
    })
}

/// The article of a word, or one line with its meaning and range.
fn of_word(line: &str, spans: &[Span], word: &Word<'_>, reader: Reader) -> Option<String> {
    let language = reader.language;
    let number = word.number();
    match (word.address, number) {
        (address @ ('G' | 'M'), Some(number)) => {
            let Some(said) = of_model(address, number, reader.model) else {
                let model = reader.model.name();
                return Some(say::hover_no_code(word_text(word), model).text(language));
            };
            let said = said.text(language);
            Some(match code_topic(reader.model, address, number) {
                Some(topic) => shown(topic, Some(&said), language),
                None => escaped(&said),
            })
        }
        ('H', Some(number)) if has(line, spans, 'G', 65) => {
            let name = format!("G65 H{number:02}");
            let topic = topic_of(reader.model, Subject::Code(&name));
            let topic = topic.or_else(|| code_topic(reader.model, 'G', 65))?;
            Some(shown(topic, None, language))
        }
        // Ranges and articles are those of lathes.
        (address, _) if reader.model.is_mill() => {
            let said = match (address, word.value.as_ref()) {
                ('G', "54.1") => say::mill_additional_zeros(),
                _ => letter(address, reader.model)?,
            };
            Some(escaped(&said.text(language)))
        }
        (address @ ('S' | 'T' | 'F'), _) => {
            let name = address.to_string();
            let said = letter(address, reader.model)?.text(language);
            let topic = topic_of(reader.model, Subject::Code(&name));
            let article = topic.map(|it| shown(it, Some(&said), language));
            Some(format!(
                "{}\n\n{}",
                article.unwrap_or(said),
                range(address, language)
            ))
        }
        (address, _) => {
            let said = letter(address, reader.model)?.text(language);
            Some(format!(
                "{}\n\n{}",
                escaped(&said),
                range(address, language)
            ))
        }
    }
}

fn word_text(word: &Word<'_>) -> String {
    format!("{}{}", word.address, word.value)
}

fn has(line: &str, spans: &[Span], address: char, number: u32) -> bool {
    let mut words = spans.iter().filter_map(|span| word_of(line, span));
    words.any(|word| word.address == address && word.number() == Some(number))
}

/// Returns the help topic of a G or M code of a model.
pub(crate) fn code_topic(model: ModelId, address: char, number: u32) -> Option<&'static Topic> {
    topic_of(model, Subject::Code(&format!("{address}{number:02}")))
}

/// Returns the range of an address's numbers as a sentence in Markdown.
pub(crate) fn range(address: char, language: Language) -> String {
    let (low, high) = limits(address as u8);
    escaped(&say::help_range(format!("{low} … {high}")).text(language))
}

/// The article of a topic in Markdown, with `said` as its heading where that says more.
fn shown(topic: &Topic, said: Option<&str>, language: Language) -> String {
    let article = article(topic, language);
    let heading = said.unwrap_or(&article.heading);
    let mut parts = vec![format!("**{}**", escaped(heading))];
    if !article.rule.is_empty() {
        parts.push(escaped(article.rule));
    }
    let facts = article
        .facts
        .iter()
        .map(|fact| format!("- {}", escaped(fact)));
    let facts = facts.collect::<Vec<_>>().join("\n");
    parts.extend(Some(facts).filter(|facts| !facts.is_empty()));
    if !article.example.is_empty() {
        parts.push(format!("> {}", escaped(article.example)));
    }
    if !article.source.is_empty() {
        parts.push(format!("*{}*", escaped(&article.source)));
    }
    parts.join("\n\n")
}

/// Escapes the characters that Markdown interprets.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        if matches!(
            character,
            '\\' | '`' | '*' | '_' | '[' | ']' | '<' | '>' | '#' | '|' | '~'
        ) {
            out.push('\\');
        }
        out.push(character);
    }
    out
}

/// Removes the Markdown that [`hover`] writes, for an editor that does not display it.
pub fn without_markup(markdown: &str) -> String {
    let mut out = String::with_capacity(markdown.len());
    let mut listed = false;
    for line in markdown.lines() {
        if line.starts_with(FENCE) {
            listed = !listed;
            continue;
        }
        if listed {
            out.push_str(line);
        } else if line != "---" {
            let mut characters = line.trim_start_matches("> ").chars();
            while let Some(character) = characters.next() {
                match character {
                    '\\' => out.extend(characters.next()),
                    '*' => {}
                    other => out.push(other),
                }
            }
        }
        out.push('\n');
    }
    out.truncate(out.trim_end().len());
    out
}

/// The marks around program lines.
const FENCE: &str = "````";

/// Describes the variable under the pointer.
fn variable(line: &str, span: &Span, byte: usize, reader: Reader) -> Option<String> {
    let text = line.get(span.range.clone())?;
    let within = byte.checked_sub(span.range.start)?;
    let hashes = text.match_indices('#').map(|(at, _)| at);
    let number = hashes.filter(|at| *at <= within).find_map(|at| {
        let digits = &text[at + 1..];
        let length = digits.bytes().take_while(u8::is_ascii_digit).count();
        let touched = length > 0 && within <= at + 1 + length;
        touched.then(|| digits[..length].parse::<u16>().ok())?
    })?;
    let said = match number {
        1..=33 if reader.macro_b => say::variable_is_local(number),
        100..=199 if reader.macro_b => say::variable_is_common(number),
        _ if Variables::has(number) => say::variable_is_kept(number),
        500..=999 if reader.macro_b => say::variable_is_kept(number),
        1000..=1015 | 1032 => say::variable_is_input(number),
        1100..=1115 | 1132 | 1133 => say::variable_is_output(number),
        1000.. if reader.macro_b => say::variable_is_system(number),
        _ => say::variable_unknown(number),
    };
    Some(escaped(&said.text(reader.language)))
}

/// Shows the blocks that a word refers to, or the blocks that refer to a numbered block.
fn of_lead(
    text: &Text,
    structure: &Structure,
    at: Position,
    language: Language,
    program: &dyn Fn(u16) -> Option<String>,
) -> Option<String> {
    match under(structure, at)? {
        Under::Lead(lead) => {
            let cycle = structure
                .cycles
                .iter()
                .find(|it| it.place.line == at.line && matches!(lead.aim, Aim::Block(_)));
            if let Some(cycle) = cycle {
                let line = |number| {
                    let found = structure.in_part(number, cycle.part).next();
                    found.map(|block| block.digits.line)
                };
                let (first, last) = (line(cycle.profile.0)?, line(cycle.profile.1)?);
                return listing((first..=last.max(first)).map(|it| text.line(it)));
            }
            let led = definition(structure, at);
            if let Some(number) = led.program {
                return match program(number) {
                    Some(other) => listing(other.lines()),
                    None => Some(say::hover_no_program(format!("{number:04}")).text(language)),
                };
            }
            let place = led.blocks.first()?;
            match lead.aim {
                Aim::Program(_) => {
                    let part = structure.parts.get(structure.part_of(place.line))?;
                    listing((part.from..part.to).map(|it| text.line(it)))
                }
                _ => listing(core::iter::once(text.line(place.line))),
            }
        }
        Under::Block(block) => {
            let leads = leading_to(structure, block);
            let mut lines: Vec<u32> = leads.map(|lead| lead.digits.line).collect();
            lines.dedup();
            listing(lines.into_iter().map(|it| text.line(it)))
        }
        Under::Program(_) | Under::Loop(_) => None,
    }
}

/// Program lines as a Markdown code block, or `None` if there are none.
fn listing<'a>(lines: impl Iterator<Item = &'a str>) -> Option<String> {
    let mut lines = lines.map(str::trim_end).filter(|line| !line.is_empty());
    let mut shown: Vec<&str> = lines.by_ref().take(MOST_LINES).collect();
    if lines.next().is_some() {
        shown.push("…");
    }
    // The fence is longer than any in a comment.
    (!shown.is_empty()).then(|| format!("{FENCE}gsk980td\n{}\n{FENCE}", shown.join("\n")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::READER;
    use gsk_core::model::ModelId;

    fn said(text: &str, line: u32, byte: u32, reader: Reader) -> Option<String> {
        let text = Text::new(text);
        let structure = Structure::read(&text);
        let at = Position { line, byte };
        let program = |number| (number == 31).then(|| "O0031\nG01 U-1\nM99\n".to_owned());
        hover(&text, &structure, at, reader, &program).map(|it| it.markdown)
    }

    #[test]
    fn a_code_is_explained_by_its_article() {
        let text = "N10 G71 U2 R1 (rough)\nG71 P10 Q30\nN30 M98 P31\nM61 G5\nG65 H01 P#200 Q5\n";
        let told = |line, byte| said(text, line, byte, READER).unwrap_or_default();
        let g71 = told(0, 5);
        assert!(g71.starts_with("**G71: roughing along Z"), "{g71}");
        assert!(g71.contains("Δd is the depth of each pass"), "{g71}");
        assert!(told(0, 9).contains("9999.999"), "{}", told(0, 9));
        assert!(told(3, 5).contains("GSK980TD"), "{}", told(3, 5));
        assert!(told(2, 10).contains("G01 U-1"), "{}", told(2, 10));
        assert!(
            told(1, 5).contains("````gsk980td\nN10 G71"),
            "{}",
            told(1, 5)
        );
        assert!(told(2, 1).contains("G71 P10 Q30"), "{}", told(2, 1));
        assert!(told(4, 10).contains("\\#200"), "{}", told(4, 10));
        assert_eq!(said(text, 0, 16, READER), None);
        let chinese = Reader {
            language: Language::Zh,
            ..READER
        };
        assert!(said(text, 0, 5, chinese).is_some_and(|it| it.contains("粗车")));
    }

    #[test]
    fn an_editor_without_markdown_gets_the_text_alone() {
        let text = "N10 G65 H01 P#200 Q5\nN20 M98 P31\n";
        let plain = |line, byte| {
            let said = said(text, line, byte, READER).unwrap_or_default();
            without_markup(&said)
        };
        assert!(plain(0, 15).starts_with("#200: "), "{}", plain(0, 15));
        let call = plain(1, 10);
        assert!(call.contains("\nO0031\nG01 U-1\nM99"), "{call}");
        for marks in ["\\", "**", "````", "---"] {
            assert!(!call.contains(marks), "{call}");
        }
    }

    #[test]
    fn words_of_a_mill_are_its_own() {
        let mill = Reader {
            model: ModelId::Gsk980mdi,
            macro_b: true,
            ..READER
        };
        let told = |byte| said("G43 H1 Y5 G54.1 P2 G71\n", 0, byte, mill).unwrap_or_default();
        assert!(told(1).contains("length"), "{}", told(1));
        assert!(told(4).contains("length"), "{}", told(4));
        assert!(told(7).starts_with("Y: end point"), "{}", told(7));
        assert!(told(10).contains("P1 to P48"), "{}", told(10));
        assert!(told(20).contains("GSK980MDi"), "{}", told(20));
    }

    #[test]
    fn codes_of_another_model_are_its_own() {
        let reader = Reader {
            model: ModelId::Hx31,
            ..READER
        };
        let own = said("G84 Z-10\n", 0, 1, reader);
        assert!(own.is_some_and(|it| !it.contains("no code")));
        let there = said("G84 Z-10\n", 0, 1, READER);
        assert!(there.is_some_and(|it| it.contains("GSK980TD")));
    }
}
