//! Describes the word under the pointer.

use gsk_core::memory::Variables;
use gsk_core::model::ModelId;
use gsk_core::program::word_limits;
use gsk_help::{Subject, Topic, article, topic_of};
use gsk_messages::{Language, say};

use crate::ReadingContext;
use crate::hints::{WordContext, tool_parts, word_context};
use crate::meaning::{code_meaning, letter_meaning};
use crate::reference_target::ReferenceTarget;
use crate::references::{CursorTarget, definition, references_to, target_at};
use crate::structure::Structure;
use crate::text::{Position, TextDocument, TextRange};
use crate::words::{ParsedWord, Span, SpanKind, block_at, spans, word_of};

/// Maximum number of lines of a program or profile that a description shows.
const MAX_LINES: usize = 16;

/// The description of the word at a position, shown by an editor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hover {
    /// Range of the described word.
    pub range: TextRange,
    /// The description in Markdown.
    pub markdown: String,
}

/// Describes the word at a position. Returns `None` for blanks and comments. `program` returns
/// the text of programs in other files.
pub fn hover(
    text: &TextDocument,
    structure: &Structure,
    at: Position,
    context: ReadingContext,
    program: &dyn Fn(u16) -> Option<String>,
) -> Option<Hover> {
    let line = text.line(at.line);
    let spans = spans(line);
    let byte = at.byte as usize;
    let span = (spans.iter().find(|it| it.range.contains(&byte)))
        .or_else(|| spans.iter().find(|it| it.range.end == byte))?;
    if matches!(span.kind, SpanKind::Comment | SpanKind::Mark) {
        return None;
    }
    let mut parts = Vec::new();
    parts.extend(describe_variable(line, span, byte, context));
    if parts.is_empty()
        && let Some(word) = word_of(line, span)
    {
        let block = block_at(&spans, line, span.range.start);
        parts.extend(describe_word(text, at.line, &block, &word, context));
    }
    parts.extend(describe_reference(
        text,
        structure,
        at,
        context.language,
        program,
    ));
    (!parts.is_empty()).then(|| Hover {
        range: TextRange::new(at.line, &span.range),
        markdown: parts.join("\n\n---\n\n"),
    })
}

/// The help article of a word, or one line with its meaning and range; `None` if there is
/// neither.
fn describe_word(
    text: &TextDocument,
    index: u32,
    spans: &[Span],
    word: &ParsedWord<'_>,
    context: ReadingContext,
) -> Option<String> {
    let language = context.language;
    let line = text.line(index);
    let number = word.number();
    match (word.address, number) {
        (address @ ('G' | 'M'), Some(number)) => {
            let Some(meaning) = code_meaning(address, number, context.model) else {
                let model = context.model.name();
                return Some(say::hover_no_code(word_text(word), model).text(language));
            };
            let meaning = meaning.text(language);
            Some(match code_topic(context.model, address, number) {
                Some(topic) => article_markdown(topic, Some(&meaning), language),
                None => escape_markdown(&meaning),
            })
        }
        ('H', Some(number)) if has(line, spans, 'G', 65) => {
            let name = format!("G65 H{number:02}");
            let topic = topic_of(context.model, Subject::Code(&name));
            let topic = topic.or_else(|| code_topic(context.model, 'G', 65))?;
            Some(article_markdown(topic, None, language))
        }
        (address, _) if let Some(known) = word_context(text, index, spans, word, context.model) => {
            Some(context_markdown(&known, address, context))
        }
        // Ranges and articles are those of lathes.
        (address, _) if context.model.is_mill() => {
            let meaning = match (address, word.value.as_ref()) {
                ('G', "54.1") => say::mill_additional_zeros(),
                _ => letter_meaning(address, context.model)?,
            };
            Some(escape_markdown(&meaning.text(language)))
        }
        (address @ ('S' | 'T' | 'F'), _) => {
            let name = address.to_string();
            let meaning = letter_meaning(address, context.model)?.text(language);
            let topic = topic_of(context.model, Subject::Code(&name));
            let article = topic.map(|it| article_markdown(it, Some(&meaning), language));
            let parts = tool_parts(word).filter(|_| address == 'T');
            let parts = parts.map(|it| format!("{}\n\n", escape_markdown(&it.text(language))));
            Some(format!(
                "{}{}\n\n{}",
                parts.unwrap_or_default(),
                article.unwrap_or(meaning),
                value_range(address, language)
            ))
        }
        (address, _) => {
            let meaning = letter_meaning(address, context.model)?.text(language);
            Some(format!(
                "{}\n\n{}",
                escape_markdown(&meaning),
                value_range(address, language)
            ))
        }
    }
}

/// The meaning of a word in its block in Markdown, with the help article of S, T and F.
fn context_markdown(known: &WordContext, address: char, context: ReadingContext) -> String {
    let language = context.language;
    let meaning = escape_markdown(&known.meaning.text(language));
    let mut lines = vec![format!("**{}**: {meaning}", known.name)];
    let remarks = known.remarks.iter().map(|it| it.text(language));
    lines.extend(remarks.map(|it| escape_markdown(&it)));
    if matches!(address, 'S' | 'T' | 'F') {
        let topic = topic_of(context.model, Subject::Code(&address.to_string()));
        lines.extend(topic.map(|it| article_markdown(it, None, language)));
    }
    lines.push(value_range(address, language));
    lines.join("\n\n")
}

fn word_text(word: &ParsedWord<'_>) -> String {
    format!("{}{}", word.address, word.value)
}

fn has(line: &str, spans: &[Span], address: char, number: u32) -> bool {
    let mut words = spans.iter().filter_map(|span| word_of(line, span));
    words.any(|word| word.address == address && word.number() == Some(number))
}

/// Returns the help topic of a G or M code (`address`) of a model; `None` if it has no topic.
pub(crate) fn code_topic(model: ModelId, address: char, number: u32) -> Option<&'static Topic> {
    topic_of(model, Subject::Code(&format!("{address}{number:02}")))
}

/// Returns a sentence in Markdown with the least and greatest number of an address.
pub(crate) fn value_range(address: char, language: Language) -> String {
    let (low, high) = word_limits(address as u8);
    escape_markdown(&say::help_range(format!("{low} … {high}")).text(language))
}

/// Returns the help article of a topic in Markdown. `meaning` replaces its heading.
fn article_markdown(topic: &Topic, meaning: Option<&str>, language: Language) -> String {
    let article = article(topic, language);
    let heading = meaning.unwrap_or(&article.heading);
    let mut parts = vec![format!("**{}**", escape_markdown(heading))];
    if !article.rule.is_empty() {
        parts.push(escape_markdown(&article.rule));
    }
    let facts = article
        .facts
        .iter()
        .map(|fact| format!("- {}", escape_markdown(fact)));
    let facts = facts.collect::<Vec<_>>().join("\n");
    parts.extend(Some(facts).filter(|facts| !facts.is_empty()));
    if !article.example.is_empty() {
        parts.push(format!("> {}", escape_markdown(&article.example)));
    }
    if !article.source.is_empty() {
        parts.push(format!("*{}*", escape_markdown(&article.source)));
    }
    parts.join("\n\n")
}

/// Escapes the characters that Markdown interprets.
pub(crate) fn escape_markdown(text: &str) -> String {
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

/// The line that begins and ends a code block of program lines in Markdown.
const FENCE: &str = "````";

/// Describes the variable at `byte` of a line in Markdown; `None` if no variable is there.
fn describe_variable(
    line: &str,
    span: &Span,
    byte: usize,
    context: ReadingContext,
) -> Option<String> {
    let text = line.get(span.range.clone())?;
    let offset = byte.checked_sub(span.range.start)?;
    let hashes = text.match_indices('#').map(|(at, _)| at);
    let number = hashes.filter(|at| *at <= offset).find_map(|at| {
        let digits = &text[at + 1..];
        let length = digits.bytes().take_while(u8::is_ascii_digit).count();
        let touched = length > 0 && offset <= at + 1 + length;
        touched.then(|| digits[..length].parse::<u16>().ok())?
    })?;
    let meaning = match number {
        1..=33 if context.macro_b => say::variable_is_local(number),
        100..=199 if context.macro_b => say::variable_is_common(number),
        _ if Variables::has_integer(number) => say::variable_is_kept(number),
        500..=999 if context.macro_b => say::variable_is_kept(number),
        1000..=1015 | 1032 => say::variable_is_input(number),
        1100..=1115 | 1132 | 1133 => say::variable_is_output(number),
        1000.. if context.macro_b => say::variable_is_system(number),
        _ => say::variable_unknown(number),
    };
    Some(escape_markdown(&meaning.text(context.language)))
}

/// Shows the blocks that the word at a position refers to, or the blocks that refer to the
/// numbered block there, in Markdown. `None` if there is no reference.
fn describe_reference(
    text: &TextDocument,
    structure: &Structure,
    at: Position,
    language: Language,
    program: &dyn Fn(u16) -> Option<String>,
) -> Option<String> {
    match target_at(structure, at)? {
        CursorTarget::Reference(reference) => {
            let cycle = structure.cycles.iter().find(|it| {
                it.range.line == at.line && matches!(reference.target, ReferenceTarget::Block(_))
            });
            if let Some(cycle) = cycle {
                let line = |number| {
                    let found = structure.blocks_in_part(number, cycle.part).next();
                    found.map(|block| block.digits.line)
                };
                let (first, last) = (line(cycle.profile.0)?, line(cycle.profile.1)?);
                return listing((first..=last.max(first)).map(|it| text.line(it)));
            }
            let definition = definition(structure, at);
            if let Some(number) = definition.program {
                return match program(number) {
                    Some(other) => listing(other.lines()),
                    None => Some(say::hover_no_program(format!("{number:04}")).text(language)),
                };
            }
            let range = definition.blocks.first()?;
            match reference.target {
                ReferenceTarget::Program(_) => {
                    let part = structure.parts.get(structure.part_at_line(range.line))?;
                    listing((part.from..part.to).map(|it| text.line(it)))
                }
                _ => listing(core::iter::once(text.line(range.line))),
            }
        }
        CursorTarget::Block(block) => {
            let references = references_to(structure, block);
            let mut lines: Vec<u32> = references.map(|reference| reference.digits.line).collect();
            lines.dedup();
            listing(lines.into_iter().map(|it| text.line(it)))
        }
        CursorTarget::Program(_) | CursorTarget::Loop(_) => None,
    }
}

/// Returns program lines as a Markdown code block; `None` if there are none.
fn listing<'a>(lines: impl Iterator<Item = &'a str>) -> Option<String> {
    let mut lines = lines.map(str::trim_end).filter(|line| !line.is_empty());
    let mut shown: Vec<&str> = lines.by_ref().take(MAX_LINES).collect();
    if lines.next().is_some() {
        shown.push("…");
    }
    // The fence is longer than any in a comment.
    (!shown.is_empty()).then(|| format!("{FENCE}gsk980td\n{}\n{FENCE}", shown.join("\n")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CONTEXT;
    use gsk_core::model::ModelId;

    fn hover_text(text: &str, line: u32, byte: u32, context: ReadingContext) -> Option<String> {
        let text = TextDocument::new(text);
        let structure = Structure::read(&text);
        let at = Position { line, byte };
        let program = |number| (number == 31).then(|| "O0031\nG01 U-1\nM99\n".to_owned());
        hover(&text, &structure, at, context, &program).map(|it| it.markdown)
    }

    #[test]
    fn a_code_is_explained_by_its_article() {
        let text = "N10 G71 U2 R1 (rough)\nG71 P10 Q30\nN30 M98 P31\nM61 G5\nG65 H01 P#200 Q5\n";
        let text_at = |line, byte| hover_text(text, line, byte, CONTEXT).unwrap_or_default();
        let g71 = text_at(0, 5);
        assert!(g71.starts_with("**G71: roughing along Z"), "{g71}");
        assert!(g71.contains("Δd is the depth of each pass"), "{g71}");
        assert!(text_at(0, 9).contains("9999.999"), "{}", text_at(0, 9));
        assert!(text_at(3, 5).contains("GSK980TD"), "{}", text_at(3, 5));
        assert!(text_at(2, 10).contains("G01 U-1"), "{}", text_at(2, 10));
        assert!(
            text_at(1, 5).contains("````gsk980td\nN10 G71"),
            "{}",
            text_at(1, 5)
        );
        assert!(text_at(2, 1).contains("G71 P10 Q30"), "{}", text_at(2, 1));
        assert!(text_at(4, 10).contains("\\#200"), "{}", text_at(4, 10));
        assert_eq!(hover_text(text, 0, 16, CONTEXT), None);
        let chinese = ReadingContext {
            language: Language::Zh,
            ..CONTEXT
        };
        assert!(hover_text(text, 0, 5, chinese).is_some_and(|it| it.contains("粗车")));
    }

    #[test]
    fn an_editor_without_markdown_gets_the_text_alone() {
        let text = "N10 G65 H01 P#200 Q5\nN20 M98 P31\n";
        let plain = |line, byte| {
            let meaning = hover_text(text, line, byte, CONTEXT).unwrap_or_default();
            without_markup(&meaning)
        };
        assert!(plain(0, 15).starts_with("#200: "), "{}", plain(0, 15));
        let call = plain(1, 10);
        assert!(call.contains("\nO0031\nG01 U-1\nM99"), "{call}");
        for marks in ["\\", "**", "````", "---"] {
            assert!(!call.contains(marks), "{call}");
        }
    }

    #[test]
    fn a_word_means_what_its_code_reads() {
        let text = "T0203\nG76 P011060 Q100 R0.1\nG76 X18 Z-30 P974 Q400 F1.5\nG92 X19 Z-9 K2 F2\n\
                    X18.5 K1\nM98 P30031 L2\nG71 U2 R1\nG71 P10 Q20 U0.5\nG99\nG01 X5 F0.2\n\
                    G50 S2000\n";
        let check = |line, byte, wanted: &[&str]| {
            let found = hover_text(text, line, byte, CONTEXT).unwrap_or_default();
            for part in wanted {
                assert!(found.contains(part), "{part}: {found}");
            }
        };
        check(0, 1, &["tool 02 with offset 03"]);
        check(
            1,
            5,
            &["**G76 P**", "1 finishing passes", "1.0 leads", "angle 60"],
        );
        check(2, 15, &["**G76 P**: height of the thread"]);
        check(3, 13, &["**G92 K**: run-out along the long axis"]);
        check(4, 7, &["**G92 K**", "G92 of line 4 is in force"]);
        check(5, 5, &["calls O0031 3 times", "G01 U-1"]);
        check(5, 12, &["write the number of calls before"]);
        check(6, 5, &["**G71 U**: depth of each pass"]);
        check(7, 13, &["**G71 U**: finishing allowance"]);
        check(9, 8, &["**G01 F**: feed", "G99 of line 9 is in force"]);
        check(10, 5, &["**G50 S**: greatest speed"]);
    }

    #[test]
    fn words_of_a_mill_are_its_own() {
        let mill = ReadingContext {
            model: ModelId::Gsk980mdi,
            macro_b: true,
            ..CONTEXT
        };
        let text_at =
            |byte| hover_text("G43 H1 Y5 G54.1 P2 G71\n", 0, byte, mill).unwrap_or_default();
        assert!(text_at(1).contains("length"), "{}", text_at(1));
        assert!(text_at(4).contains("length"), "{}", text_at(4));
        assert!(text_at(7).starts_with("Y: end point"), "{}", text_at(7));
        assert!(text_at(10).contains("P1 to P48"), "{}", text_at(10));
        assert!(text_at(20).contains("GSK980MDi"), "{}", text_at(20));
    }

    #[test]
    fn codes_of_another_model_are_its_own() {
        let context = ReadingContext {
            model: ModelId::Hx31,
            ..CONTEXT
        };
        let own = hover_text("G84 Z-10\n", 0, 1, context);
        assert!(own.is_some_and(|it| !it.contains("no code")));
        let there = hover_text("G84 Z-10\n", 0, 1, CONTEXT);
        assert!(there.is_some_and(|it| it.contains("GSK980TD")));
    }
}
